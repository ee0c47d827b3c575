//! Lambertian reflection.

use glam::DVec3;

use crate::math::frame::tangents;
use crate::math::sin_cos_turns;

/// A direction around the unit vector `normal` with density cos θ/π, from two numbers in [0, 1).
///
/// The throughput of a cosine-sampled Lambertian bounce is the albedo alone.
pub fn sample(normal: DVec3, u: f64, v: f64) -> DVec3 {
    let (tangent, bitangent) = tangents(normal);
    let radius = u.sqrt();
    let (sin, cos) = sin_cos_turns::sin_cos(v);
    radius * (cos * tangent + sin * bitangent) + (1.0 - u).sqrt() * normal
}

/// Density of [`sample`] in solid angle.
pub fn density(normal: DVec3, direction: DVec3) -> f64 {
    normal.dot(direction).max(0.0) / std::f64::consts::PI
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_mean_cosine_of_cosine_sampled_directions_is_two_thirds() {
        let normal = DVec3::new(0.48, -0.6, 0.64);
        let n = 200;
        let mut mean = 0.0;
        for i in 0..n * n {
            let (u, v) = ((i / n) as f64 + 0.5, (i % n) as f64 + 0.5);
            let direction = sample(normal, u / n as f64, v / n as f64);
            assert!((direction.length() - 1.0).abs() < 1e-14);
            mean += direction.dot(normal);
        }
        assert!((mean / (n * n) as f64 - 2.0 / 3.0).abs() < 1e-4);
    }
}
