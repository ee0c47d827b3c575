//! Lengths that observers at rest measure.

use glam::DVec3;

use super::conformally_flat::ConformallyFlat;
use super::index_field::IndexField;
use super::kerr_newman::KerrNewman;
use super::kind::{SpacetimeKind, SpacetimeVisitor};
use super::mouths::Mouths;
use super::placement::Placement;
use super::side::Side;

impl SpacetimeKind {
    /// Length of a small step `dx` at a world position on a side, measured by observers at rest there; infinite where
    /// nothing can be at rest.
    pub fn proper_length(&self, side: Side, position: DVec3, dx: DVec3) -> f64 {
        self.visit(SmallStep { side, position, dx })
    }
}

/// A small step at a world position on a side.
struct SmallStep {
    side: Side,
    position: DVec3,
    dx: DVec3,
}

impl SmallStep {
    /// Ψ |dx|.
    fn conformal(&self, center: DVec3, medium: impl ConformallyFlat) -> f64 {
        let w = 1.0 / self.position.distance(center);
        medium.index(w) * medium.lapse(w) * self.dx.length()
    }
}

impl SpacetimeVisitor for SmallStep {
    type Output = f64;

    fn flat(self) -> f64 {
        self.dx.length()
    }

    fn spherical<M: ConformallyFlat>(self, center: DVec3, medium: M) -> f64 {
        self.conformal(center, medium)
    }

    fn wormhole<M: ConformallyFlat>(self, mouths: Mouths, medium: M) -> f64 {
        self.conformal(mouths.center(self.side), medium)
    }

    fn spinning(self, placement: Placement, hole: KerrNewman) -> f64 {
        let rotation = placement.rotation();
        // The space at rest has the metric δ + F/(1 − F) N N.
        let (n, potential) = hole.outgoing(rotation * (self.position - placement.center));
        if potential >= 1.0 {
            return f64::INFINITY;
        }
        let along = n.dot(rotation * self.dx);
        (self.dx.length_squared() + potential / (1.0 - potential) * along * along).sqrt()
    }

    fn indexed<F: IndexField>(self, field: &F) -> f64 {
        field.area_scale(self.position).sqrt() * self.dx.length()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_radial_way_is_as_long_as_the_metric_says() {
        // Schwarzschild: areal r = ρ(1 + M/2ρ)² and dl = dr/√(1 − 2M/r).
        let hole = SpacetimeKind::black_hole(DVec3::ZERO, 1.0);
        let (inner, outer, steps) = (1.0, 3.0, 20_000);
        let dx = (outer - inner) / f64::from(steps) * DVec3::X;
        let sum: f64 = (0..steps)
            .map(|i| hole.proper_length(Side::Near, inner * DVec3::X + (f64::from(i) + 0.5) * dx, dx))
            .sum();
        let areal = |rho: f64| rho * (1.0 + 0.25 / rho).powi(2);
        let exact = |r: f64| {
            let x = (r * (r - 1.0)).sqrt();
            x + libm::log(r.sqrt() + (r - 1.0).sqrt())
        };
        let expected = exact(areal(outer)) - exact(areal(inner));
        assert!((sum / expected - 1.0).abs() < 1e-8, "{sum} {expected}");
    }

    #[test]
    fn along_the_principal_direction_of_a_hole_space_is_stretched_by_its_potential() {
        // Without spin F = 2M/r, N is radial, and dl = dr/√(1 − 2M/r); across it nothing is stretched.
        let (placement, hole) = (Placement::from(DVec3::ZERO), KerrNewman::new(1.0, 0.0, 0.0));
        let hole = SpacetimeKind::Spinning { placement, hole };
        let at = DVec3::new(0.0, 4.0, 0.0);
        let length = |dx| hole.proper_length(Side::Near, at, dx);
        assert!((length(DVec3::Y) - 1.0 / 0.75f64.sqrt()).abs() < 1e-12);
        assert!((length(DVec3::X) - 1.0).abs() < 1e-12);
        assert_eq!(hole.proper_length(Side::Near, 0.5 * DVec3::Y, DVec3::Y), f64::INFINITY);
    }
}
