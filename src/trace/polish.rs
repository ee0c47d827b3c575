//! From a crossing of the arc to where the ray itself arrives.

use glam::DVec3;

use super::curved::{Curved, CurvedFlight, CurvedMove, Lane};
use super::transport::{Found, Landing};
use crate::geometry::{Geometry, Line, PrimitiveId, Segment};
use crate::spacetime::ConformallyFlat;

impl<M: ConformallyFlat, R: Lane> Curved<M, R> {
    /// Guesses which part of a step leads to `point`, relative to the centre.
    fn part(&self, flight: &CurvedFlight<R>, step: &CurvedMove<R>, point: DVec3) -> f64 {
        let tangent = (flight.b * flight.h).value();
        let s = if tangent > 1e-3 {
            point.dot(flight.along) / (point.dot(flight.radial) * tangent)
        } else {
            let (way, whole) = (point - flight.position, flight.place(step.end_x, step.end_y));
            let (x, end_x) = (way.dot(flight.radial), step.end_x.value());
            if end_x.abs() > 0.1 * whole.length() {
                // Nearly along the radius w is linear in ξ.
                x / end_x / ((step.w / flight.w).value() * (1.0 + x * flight.w.value()))
            } else {
                way.dot(whole) / whole.length_squared()
            }
        };
        if s.is_finite() { s.clamp(0.0, 1.0) } else { 1.0 }
    }

    /// Moves a crossing from the arc to the curve, where that stays on the primitive and beside nothing else.
    pub(super) fn polish(
        &self,
        geometry: &Geometry,
        flight: &CurvedFlight<R>,
        step: &CurvedMove<R>,
        found: Found,
    ) -> Landing {
        let Found { point, primitive } = found;
        let at = |s: f64| {
            let piece = self.piece(flight, s);
            let [x, y] = piece.displacement();
            let [tx, ty] = piece.end_tangent();
            let direction = flight.place(tx, ty);
            (flight.position + self.center + flight.place(x, y), direction, piece)
        };
        let mut s = self.part(flight, step, point - self.center);
        let (mut position, mut direction, mut piece) = at(s);
        for _ in 0..6 {
            let (height, normal) = geometry.carrier(primitive, position);
            // |dx/dξ| = n c²/w².
            let (b, w, v, c) = (piece.b.value(), piece.end.w.value(), piece.end.v.value(), piece.cos.value());
            let speed = flight.h.value() * v.hypot(b * w) * c * c / (w * w);
            let shift = height / (normal.dot(direction) * speed);
            s -= shift;
            (position, direction, piece) = at(s);
            // Quadratic convergence: what is left, relative to the radius, is the square of this.
            if (shift * speed * w).abs() < 1e-6 {
                break;
            }
        }
        let direction = direction.normalize();
        let moved = position.distance(point);
        if (0.0..=1.0).contains(&s) && moved <= 8.0 * self.arc_tolerance {
            // Both ends lie on the primitive's carrier: what shares that cannot stand between them.
            let shares_carrier = |other: PrimitiveId| {
                let (normal, beside) =
                    (geometry.carrier(primitive, point).1, geometry.carrier(other, point).1);
                normal.cross(beside).length_squared() < 1e-18
            };
            let between = geometry.intersect(&Line { p0: point, p2: position }, primitive);
            if geometry.covers(primitive, position) && between.is_none_or(|hit| shares_carrier(hit.primitive))
            {
                return Landing { position, direction, primitive };
            }
            // The curve passes beside the primitive, across an edge that it shares: its tangent tells what it meets.
            let reach = 2.0 * moved * direction;
            if moved < 0.1 * position.distance(flight.position + self.center) {
                let tangent = Line { p0: position - reach, p2: position + reach };
                if let Some(hit) = geometry.intersect(&tangent, PrimitiveId::NONE) {
                    return Landing { position: tangent.point(hit.s), direction, primitive: hit.primitive };
                }
            }
        }
        let direction = at(self.part(flight, step, point - self.center)).1.normalize();
        Landing { position: point, direction, primitive }
    }
}
