//! Sensitivity of a ray's end to its start, by differences of rays beside each other.

use glam::DVec3;

use crate::math::frame;

/// Angles between a ray and those beside it, radians: the first, and the least.
const ANGLES: [f64; 2] = [1e-5, 1e-13];
/// Largest difference of ends beside each other of which the derivative is taken.
const LARGEST_DIFFERENCE: f64 = 1e-3;

/// Largest singular value of the derivative of the `end` of a ray, position over `unit` or direction (or momentum), by the unit
/// `direction` at its start; at least 1.
pub(super) fn sensitivity(direction: DVec3, unit: f64, end: impl Fn(DVec3) -> Option<(DVec3, DVec3)>) -> f64 {
    let (across, up) = frame::tangents(direction);
    let [mut angle, least] = ANGLES;
    loop {
        let slope = |way: DVec3| {
            let turned = |angle: f64| end((direction + angle * way).normalize());
            let ((x1, d1), (x0, d0)) = (turned(angle)?, turned(-angle)?);
            let per = 0.5 / angle;
            Some([per / unit * (x1 - x0), per * (d1 - d0)])
        };
        let found = slope(across)
            .zip(slope(up))
            .map(|([x, d], [x_up, d_up])| largest_singular(x, x_up).max(largest_singular(d, d_up)).max(1.0));
        match found {
            Some(sens) if sens * angle <= LARGEST_DIFFERENCE || angle <= least => return sens,
            None if angle <= least => return 1.0 / least,
            _ => angle = (0.01 * angle).max(least),
        }
    }
}

/// Larger singular value of a matrix of two columns.
fn largest_singular(a: DVec3, b: DVec3) -> f64 {
    let (aa, bb, ab) = (a.length_squared(), b.length_squared(), a.dot(b));
    let half = 0.5 * (aa - bb);
    (0.5 * (aa + bb) + (half * half + ab * ab).sqrt()).sqrt()
}
