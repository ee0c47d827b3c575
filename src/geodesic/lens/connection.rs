//! Rays between two places of space.

use std::f64::consts::PI;

use glam::DVec3;

use super::map::{Lens, Site};
use super::track::{Track, oriented};
use crate::math::{frame, half_turn};

/// A ray from one place, x, to another, y.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Connection {
    /// Unit direction at x.
    pub direction: DVec3,
    /// Unit direction of travel at y.
    pub arrival: DVec3,
    /// Angle swept about the centre, radians.
    pub swept: f64,
    /// Impact parameter.
    pub b: f64,
    /// Solid angle at x over the area at y perpendicular to the ray, in the chart; over the solid angle there if y is
    /// at infinity. Infinite where rays of all azimuths meet.
    pub geometry_factor: f64,
    /// |dφ/dα| at x and at y, α the angle between ray and radius at one end and the other place fixed.
    pub swing: [f64; 2],
    /// Length of the straight line between two places on one side of the photon sphere, in the plane of B.
    pub(super) line: f64,
}

/// Angle, radians, that a radial ray is taken to sweep: far below rounding.
pub(super) const RADIAL: f64 = 1e-20;
/// Angle, radians, above which the sine of the swept angle is that of the angle between the places.
pub(super) const AROUND: f64 = 1.0;

impl Lens {
    /// The ray from `x` to `y` that sweeps g, the angle between them (`winding` 0), 2π − g (1), 2π + g (2), and so on;
    /// `None` if the places are the same and it need not leave, or if rounding hides it.
    pub fn connect(&self, x: &Site, y: &Site, winding: u32) -> Option<Connection> {
        let spin = x.radial.cross(y.radial);
        let sin = spin.length();
        let cos = x.radial.dot(y.radial);
        let angle = half_turn::angle(sin, cos);
        let (swept, odd) = swept_by(angle, winding);
        let radial = swept < RADIAL;
        if radial && x.w == y.w && (x.s > 0.0) == (y.s > 0.0) {
            return None;
        }
        let (swept, sine) = if radial { (RADIAL, RADIAL) } else { (swept, sin) };
        // Rays that go around are not guessed by it.
        let track = self.track(x, y, (swept, sine / (1.0 + cos)))?;
        let axis = if sin > 0.0 { spin / sin } else { x.radial.cross(frame::tangents(x.radial).0) };
        let axis = if odd { -axis } else { axis };
        Some(Connection {
            direction: direction_at(x, axis, track.start),
            arrival: direction_at(y, axis, track.end),
            swept,
            b: track.b,
            geometry_factor: geometry_factor(x, y, &track, sine),
            swing: [track.rate / (x.q * track.end[0].abs()), track.rate / (y.q * track.start[0].abs())],
            line: track.distance / (x.q * y.q),
        })
    }

    /// Winding number and [`Connection::geometry_factor`] of a ray that leaves `x` in the unit `direction` and arrives at `y`
    /// travelling in the unit direction `arrival`.
    pub fn classify(&self, x: &Site, direction: DVec3, y: &Site, arrival: DVec3) -> Option<(u32, f64)> {
        let (spin, across) = (x.radial.cross(y.radial), x.radial.cross(direction));
        let (track, sine) = self.track_of((x, direction), (y, arrival))?;
        // g is between 0 and π, and the winding even, if the ray sets out on the short way.
        let turns = track.swept / (2.0 * PI);
        let winding = if spin.dot(across) < 0.0 {
            2.0 * (turns + 0.25).round() - 1.0
        } else {
            2.0 * (turns - 0.25).round()
        };
        Some((winding.max(0.0) as u32, geometry_factor(x, y, &track, sine)))
    }

    /// Widths at `y`, in the chart and across the ray, of a narrow beam from `x` around a ray that leaves in the unit
    /// `direction` and arrives travelling in the unit direction `arrival`, over its angle at `x`: in the plane of its orbit,
    /// and out of that. Their product is one over [`Connection::geometry_factor`].
    pub fn beam_widths(&self, x: &Site, direction: DVec3, y: &Site, arrival: DVec3) -> Option<[f64; 2]> {
        let (track, sine) = self.track_of((x, direction), (y, arrival))?;
        Some([track.rate / (x.q * y.w), sine / (track.b * x.q * y.w)])
    }

    /// The track of a ray that leaves `x` in one unit direction and arrives at `y` in another, and |sin φ| of the angle that
    /// it sweeps.
    fn track_of(&self, (x, direction): (&Site, DVec3), (y, arrival): (&Site, DVec3)) -> Option<(Track, f64)> {
        let b = x.radial.cross(direction).length().max(RADIAL) / x.q;
        let track = if x.is_beyond(y) {
            self.through(x, y, (self.critical - b).max(0.0) / b)
        } else {
            let side = x.s.signum();
            let (near, far) = if y.q > x.q { (y, x) } else { (x, y) };
            let cos = if y.q > x.q { -arrival.dot(y.radial) } else { direction.dot(x.radial) };
            let leaving = (b * near.q).min(1.0);
            let cos = (1.0 - leaving * leaving).sqrt().copysign(side * cos);
            let gamma = half_turn::angle(leaving, cos) - libm::asin((b * far.q).min(1.0));
            self.beside(near, far, gamma.max(RADIAL)).map(|track| oriented(track, y.q > x.q))
        }?;
        let sine =
            if track.swept < AROUND { libm::sin(track.swept) } else { x.radial.cross(y.radial).length() };
        Some((track, sine))
    }
}

/// The angle that a ray with this winding number sweeps between places that are seen under an angle, and true if it goes
/// around the other way.
#[inline(always)]
pub(super) fn swept_by(angle: f64, winding: u32) -> (f64, bool) {
    let (turns, is_odd) = (f64::from(winding) * PI, winding % 2 == 1);
    (turns + if is_odd { PI - angle } else { angle }, is_odd)
}

/// The unit direction at a place that has this cosine and sine to the radius, of a ray whose orbit has this axis.
#[inline(always)]
pub(super) fn direction_at(site: &Site, axis: DVec3, [cos, sin]: [f64; 2]) -> DVec3 {
    // The axis is only as good as the angle between the places is large.
    let along = axis.cross(site.radial).normalize();
    (cos * site.radial + sin * along).normalize()
}

/// [`Connection::geometry_factor`] of a track from `x` to `y`, given |sin φ|.
#[inline(always)]
pub(super) fn geometry_factor(x: &Site, y: &Site, track: &Track, sine: f64) -> f64 {
    let far = if y.w > 0.0 { y.w * y.w } else { 1.0 };
    track.b * x.q * x.q * far / (sine * track.rate)
}
