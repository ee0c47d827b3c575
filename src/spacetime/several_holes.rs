//! Majumdar and Papapetrou's spacetime of several holes at rest: the charge of each balances its mass.
//!
//! ds² = −U⁻² dt² + U² dx², U = 1 + Σ mᵢ/|x − xᵢ|: index n = U². Every horizon is a point xᵢ.
//!
//! Near hole i, U ≈ Uᵢ + mᵢ/ρ with Uᵢ = 1 + Σ_{j≠i} mⱼ/|xᵢ − xⱼ|: its photon sphere is at ρ ≈ mᵢ/Uᵢ. Well inside, all
//! rays that go in are captured: as spirals, whatever their impact parameter.
//!
//! References: Majumdar 1947, Phys. Rev. 72, 390; Papapetrou 1947, Proc. R. Irish Acad. A 51, 191; Hartle, Hawking 1972,
//! Commun. Math. Phys. 26, 87.

use std::sync::Arc;

use glam::DVec3;

use super::index_field::{FieldSurvey, IndexField, Sink, Vectors, Viewpoint, dot};

/// An extremally charged hole.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hole {
    /// World position.
    pub center: DVec3,
    /// Mass, scene units; positive.
    pub mass: f64,
}

/// Holes at rest, at different places.
#[derive(Clone, Debug, PartialEq)]
pub struct SeveralHoles {
    holes: Arc<[Hole]>,
    sinks: Arc<[Sink]>,
    middle: DVec3,
    turning_radius: f64,
}

/// Distance within which a hole captures all that goes in, relative to its photon sphere and to the nearest other hole.
const CAPTURE: f64 = 0.02;
/// Distance down to which a ray is followed if there is anything that near, relative to the photon sphere.
const INNERMOST: f64 = 1e-6;
/// Longest step towards a hole, and away from it, relative to the distance.
const LONGEST: [f64; 2] = [0.75, 2.0];

impl SeveralHoles {
    /// These holes: masses are positive, and no two are at one place.
    pub fn new(holes: &[Hole]) -> Self {
        let mass: f64 = holes.iter().map(|hole| hole.mass).sum();
        let middle = holes.iter().map(|hole| hole.mass * hole.center).sum::<DVec3>() / mass;
        let sink = |(i, hole): (usize, &Hole)| {
            let others = holes.iter().enumerate().filter(|(j, _)| *j != i).map(|(_, other)| other);
            let (mut potential, mut nearest) = (1.0, f64::INFINITY);
            for other in others {
                let distance = hole.center.distance(other.center);
                potential += other.mass / distance;
                nearest = nearest.min(distance);
            }
            let photon_sphere = hole.mass / potential;
            Sink {
                center: hole.center,
                captures: CAPTURE * photon_sphere.min(nearest),
                innermost: INNERMOST * photon_sphere,
                photon_sphere,
                shadow: 4.0 * hole.mass * potential,
            }
        };
        let sinks = holes.iter().enumerate().map(sink).collect();
        Self { holes: holes.into(), sinks, middle, turning_radius: turning_radius(holes, middle, mass) }
    }

    /// The holes.
    pub fn holes(&self) -> &[Hole] {
        &self.holes
    }

    /// U at a place.
    pub fn potential(&self, x: DVec3) -> f64 {
        1.0 + self.holes.iter().map(|hole| hole.mass / x.distance(hole.center)).sum::<f64>()
    }
}

/// Distance R from `middle` beyond which |x − middle|² is convex along every ray.
///
/// Half its second derivative is n² + ½ (x − middle)·∇n² = U³ (U + 2 (x − middle)·∇U), in which
/// U + 2 (x − middle)·∇U ≥ 1 − Σ mᵢ (1/ρᵢ + 2 aᵢ/ρᵢ²), ρᵢ ≥ |x − middle| − aᵢ, aᵢ = |xᵢ − middle|.
fn turning_radius(holes: &[Hole], middle: DVec3, mass: f64) -> f64 {
    let reach = |hole: &Hole| hole.center.distance(middle);
    let spread = holes.iter().map(reach).fold(0.0, f64::max);
    let turns = |radius: f64| {
        let term = |hole: &Hole| {
            let (a, rho) = (reach(hole), radius - reach(hole));
            hole.mass / rho * (1.0 + 2.0 * a / rho)
        };
        holes.iter().map(term).sum::<f64>() > 1.0
    };
    // At the upper end each term is at most mᵢ/4M · (1 + ½).
    let (mut low, mut high) = (spread, spread + 4.0 * mass + 4.0 * spread);
    for _ in 0..60 {
        let radius = 0.5 * (low + high);
        (low, high) = if turns(radius) { (radius, high) } else { (low, radius) };
    }
    high
}

impl IndexField for SeveralHoles {
    #[inline(always)]
    fn survey<const L: usize>(&self, x: &Vectors<L>, p: &Vectors<L>) -> FieldSurvey<L> {
        let (mut potential, mut weight) = ([1.0; L], [0.0; L]);
        let (mut slope, mut lean) = ([[0.0; L]; 3], [[0.0; L]; 3]);
        let (mut room, mut reach) = ([f64::INFINITY; L], [f64::INFINITY; L]);
        for &Hole { center, mass } in &*self.holes {
            let center = center.to_array();
            for l in 0..L {
                let away = [x[0][l] - center[0], x[1][l] - center[1], x[2][l] - center[2]];
                let rho2 = away[0] * away[0] + away[1] * away[1] + away[2] * away[2];
                let rho = rho2.sqrt();
                let share = mass / rho;
                let per_rho2 = 1.0 / rho2;
                let pull = share * per_rho2;
                // Projective about the hole itself when near it, about the middle of all when far away.
                let nearness = pull * rho;
                potential[l] += share;
                weight[l] += nearness;
                for k in 0..3 {
                    slope[k][l] -= pull * away[k];
                    lean[k][l] += nearness * per_rho2 * away[k];
                }
                let outwards = away[0] * p[0][l] + away[1] * p[1][l] + away[2] * p[2][l];
                let longest = rho * if outwards < 0.0 { LONGEST[0] } else { LONGEST[1] };
                room[l] = if rho < room[l] { rho } else { room[l] };
                reach[l] = if longest < reach[l] { longest } else { reach[l] };
            }
        }
        let (mut index_squared, mut force) = ([0.0; L], [[0.0; L]; 3]);
        for l in 0..L {
            let squared = potential[l] * potential[l];
            index_squared[l] = squared * squared;
            let per_weight = 1.0 / weight[l];
            for k in 0..3 {
                force[k][l] = 2.0 * squared * potential[l] * slope[k][l];
                lean[k][l] *= per_weight;
            }
        }
        FieldSurvey { index_squared, force, lean, room, reach }
    }

    /// With q = 1 − β·Y and D = q (x₀ − xᵢ) + Y, which is (x − xᵢ) q, the force of each hole is
    /// −2U³ mᵢ (x₀ − xᵢ + Y (1 − β·(x₀ − xᵢ)))/|D|³: regular at infinity.
    #[inline(always)]
    fn acceleration<const L: usize>(&self, from: &Viewpoint<L>, y: &Vectors<L>) -> Vectors<L> {
        let Viewpoint { x, lean, .. } = from;
        let leaning = dot(lean, y);
        let (mut potential, mut pull) = ([0.0; L], [[0.0; L]; 3]);
        for &Hole { center, mass } in &*self.holes {
            let center = center.to_array();
            for l in 0..L {
                let q = 1.0 - leaning[l];
                let away = [x[0][l] - center[0], x[1][l] - center[1], x[2][l] - center[2]];
                let d = [q * away[0] + y[0][l], q * away[1] + y[1][l], q * away[2] + y[2][l]];
                let per_d2 = 1.0 / (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
                let share = mass * per_d2.sqrt();
                let strength = share * per_d2;
                let kept = 1.0 - (lean[0][l] * away[0] + lean[1][l] * away[1] + lean[2][l] * away[2]);
                potential[l] += share;
                for k in 0..3 {
                    pull[k][l] -= strength * (away[k] + kept * y[k][l]);
                }
            }
        }
        for l in 0..L {
            let u = 1.0 + (1.0 - leaning[l]) * potential[l];
            let factor = 2.0 * u * u * u;
            for component in &mut pull {
                component[l] *= factor;
            }
        }
        pull
    }

    fn area_scale(&self, x: DVec3) -> f64 {
        self.potential(x).powi(2)
    }

    fn middle(&self) -> DVec3 {
        self.middle
    }

    fn turning_radius(&self) -> f64 {
        self.turning_radius
    }

    fn sinks(&self) -> &[Sink] {
        &self.sinks
    }
}
