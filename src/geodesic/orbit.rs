//! A null ray of a static, spherically symmetric spacetime as a problem in one dimension.
//!
//! The ray stays in a plane through the centre and keeps its impact parameter b. With w = 1/ρ and the parameter
//! dψ = dσ/ρ², in which the swept angle is exactly φ = b ψ, it obeys Binet's equation
//!
//! ```text
//! w″ + b² w = g(w),  g = ½ dn²/dw,  with  w′² + b² w² = n²(w).
//! ```
//!
//! Nothing in it is singular but the horizon: infinity is w = 0, a radial ray is b = 0, and a ray from 10⁸ r_s takes as
//! many steps as one from 10² r_s. A step is taken in the gnomonic projection ξ = tan(bψ)/b, W = w/cos(bψ), centred on
//! its start, where
//!
//! ```text
//! d²W/dξ² = g(W c) c³,  c = 1/√(1 + b²ξ²):
//! ```
//!
//! straight lines have a right-hand side of 0, so that the error is of the field, not of the angle. After each step
//! w′² + b² w² = n² is restored. What is left is an error along the orbit, which only shifts φ: errors of steps add up
//! without growing, and a ray on one side of the critical impact parameter cannot cross to the other.

use glam::DVec3;

use super::{Stepper, Trial};
use crate::math::cross_exact;
use crate::math::frame;
use crate::math::real::Real;
use crate::spacetime::{ConformallyFlat, Fate};

/// Start of a ray: the plane of its orbit, and the constants that decide its fate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Launch {
    /// Unit vector from the centre to the start.
    pub radial: DVec3,
    /// Unit vector of the orbit's plane across `radial`, in the sense in which the ray moves.
    pub along: DVec3,
    /// Impact parameter.
    pub b: f64,
    /// Inverse radius.
    pub w: f64,
    /// Its rate: minus the radial momentum.
    pub v: f64,
    /// Fate of the ray if nothing is in its way.
    pub fate: Fate,
}

/// Phase of a ray on its orbit.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Phase<R> {
    /// Inverse isotropic radius.
    pub w: R,
    /// dw/dψ, minus the radial momentum.
    pub v: R,
    /// g = ½ dn²/dw.
    pub pull: R,
}

/// A step along an orbit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step<R> {
    /// Impact parameter.
    pub b: R,
    /// Phase at its start.
    pub start: Phase<R>,
    /// Phase at its end.
    pub end: Phase<R>,
    /// Inverse of the index at the end.
    pub per_index: R,
    /// w at the end less what it would be if the ray went straight across the radius at the start, w cos: to its own
    /// rounding.
    pub rise: R,
    /// Length in ξ: the tangent of the swept angle, over b.
    pub h: R,
    /// Cosine of the swept angle.
    pub cos: R,
    /// Sine of the swept angle.
    pub sin: R,
    /// Error of the swept angle that the stepper estimates, radians.
    pub embedded: R,
    /// Error of the swept angle across the orbit, which the constraint shows and which has been undone, radians.
    pub undone: R,
    /// Relative violation of w′² + b² w² = n² before it was undone.
    pub drift: R,
    /// Strain, which must be small beside 1 for the step to make sense at all: the estimated error of w′ relative to n,
    /// the drift, and how far the constraint is from being linear over what was undone.
    pub strain: R,
    /// Displacement of the ray along its orbit by an error, squared, in units of the error itself: large close to the
    /// circular ray, where everything but the angle moves slowly.
    pub leverage: R,
}

/// Least distance of an impact parameter from the critical one, in roundings and relative: closer, rounding would
/// decide where the ray turns.
const CLOSEST: f64 = 64.0;

/// Rounding of w′² + b² w² − n², relative to the terms and to that of one operation.
const ROUNDING: f64 = 16.0;

impl Launch {
    /// The orbit of a ray that starts at `x`, relative to the centre and not 0, in the direction `d`, not 0 and of any
    /// length.
    ///
    /// The impact parameter is good to the last digits even for a ray from far away that is aimed at the centre.
    /// `epsilon` is the rounding of the numbers that the ray will be followed in: b keeps some of that away from the
    /// critical one, so that rounding does not change a fate.
    #[inline(always)]
    pub fn new<M: ConformallyFlat>(medium: &M, x: DVec3, d: DVec3, epsilon: f64) -> Self {
        let (rho, length) = (x.length(), d.length());
        let (w, per_length) = (1.0 / rho, 1.0 / length);
        let radial = x * w;
        let spin = cross_exact::cross(x, d) * (w * per_length);
        let sine = spin.length();
        let turns = sine > 0.0;
        let (across, any) = ((spin * (1.0 / sine)).cross(radial), frame::tangents(radial).0);
        let pick = |across: f64, any: f64| if turns { across } else { any };
        let along = DVec3::new(pick(across.x, any.x), pick(across.y, any.y), pick(across.z, any.z));
        let n = medium.index(w);
        let b = n * rho * sine;
        let cosine = radial.dot(d) * per_length;
        let fate = Fate::of(medium, rho, b, cosine > 0.0);
        // A ray through the centre of a medium without a horizon passes it at a distance that no number can resolve.
        let smallest = if medium.horizon() > 0.0 { 0.0 } else { 1e-30 * rho };
        let (b, v) = apart(medium, (b.at_least(smallest), w, -n * cosine), fate, CLOSEST * epsilon);
        Self { radial, along, b, w, v, fate }
    }

    /// Position, relative to the centre, at the inverse radius `w` and the angle `swept` from the start.
    pub fn position(&self, w: f64, swept: f64) -> DVec3 {
        (self.radial * libm::cos(swept) + self.along * libm::sin(swept)) / w
    }

    /// Unit direction of travel there, given the rate `v` = dw/dψ.
    pub fn direction(&self, w: f64, v: f64, swept: f64) -> DVec3 {
        self.place(w, v, swept).1
    }

    /// Position, relative to the centre, and unit direction of travel at the inverse radius `w`, the rate `v` = dw/dψ and
    /// the angle `swept` from the start.
    pub fn place(&self, w: f64, v: f64, swept: f64) -> (DVec3, DVec3) {
        let (sin, cos) = libm::sincos(swept);
        let (outwards, across) = (-v, self.b * w);
        let direction =
            self.radial * (outwards * cos - across * sin) + self.along * (outwards * sin + across * cos);
        ((self.radial * cos + self.along * sin) / w, direction.normalize())
    }
}

/// Impact parameter b and rate v of a ray that is `closest` or farther from the critical impact parameter, relative to
/// it, and meets the same fate.
#[inline(always)]
fn apart<M: ConformallyFlat>(medium: &M, (b, w, v): (f64, f64, f64), fate: Fate, closest: f64) -> (f64, f64) {
    let critical = medium.critical_impact_parameter();
    let is_near = (b - critical).abs() < closest * critical;
    let n2 = medium.index_squared(w);
    let rate = |b: f64| n2 - (b * w) * (b * w);
    // A ray that goes where it ends is as well one that does not turn; one that turns first has to be outside the gap
    // that b leaves around the photon sphere.
    let (below, above) = (critical * (1.0 - closest), critical * (1.0 + closest));
    let escapes = fate == Fate::Escapes;
    let turns = ((v < 0.0) != escapes) & (rate(above) > closest * n2);
    let moved = if turns { above } else { below };
    let speed = rate(moved).sqrt();
    let inwards = turns == escapes;
    let pick = |moved: f64, kept: f64| if is_near { moved } else { kept };
    (pick(moved, b), pick(if inwards { speed } else { -speed }, v))
}

impl<R: Real> Phase<R> {
    /// The phase at `w` and `v`.
    #[inline(always)]
    pub fn new<M: ConformallyFlat>(medium: &M, w: R, v: R) -> Self {
        Self { w, v, pull: medium.pull(w) }
    }

    /// The index n, which w′ and b w make up.
    #[inline(always)]
    pub fn index(&self, b: R) -> R {
        (self.v.squared() + (b * self.w).squared()).sqrt()
    }

    /// Momentum outwards and across: as long as the index, in the direction of travel.
    #[inline(always)]
    pub fn momentum(&self, b: R) -> [R; 2] {
        [-self.v, b * self.w]
    }
}

impl<R: Real> Phase<R> {
    /// The phase of a ray at a throat in the chart of the other side: there the orbit goes on in the same plane, outwards
    /// as fast as it came inwards.
    pub fn beyond_throat(self) -> Self {
        Self { v: -self.v, ..self }
    }
}

impl<R: Real> Step<R> {
    /// One step of length `h` in ξ; shorter steps from the same start are its dense output, of the method's own order.
    #[inline(always)]
    pub fn new<M: ConformallyFlat>(medium: &M, stepper: &impl Stepper, b: R, start: Phase<R>, h: R) -> Self {
        let one = R::of(1.0);
        let b2 = b * b;
        let secant2 = |xi: R| one + b2 * xi * xi;
        let force = |xi: R, [position]: [R; 1]| [medium.projected_pull(position, secant2(xi))];
        let Trial {
            gain: [gain],
            velocity: [velocity],
            position_error: [position_error],
            velocity_error: [v_error],
        } = stepper.step(force, [[start.w], [start.v], [start.pull]], h);
        let secant2 = secant2(h);
        // The root and the quotient do not wait for each other.
        let secant = secant2.sqrt();
        let c = secant * (one / secant2);
        let position = start.w + gain;
        let sin = b * h * c;
        let (w, v) = (position * c, velocity * secant - position * (b * sin));
        let (n2, pull) = (medium.index_squared(w), medium.pull(w));
        // One step of Newton's method towards the constraint, along its gradient in units of w and n.
        let excess = v * v + b2 * w * w - n2;
        let (slope_w, slope_v) = ((b2 * w - pull) * w, v);
        let scale = R::of(0.5) / (slope_w * slope_w + slope_v * slope_v * n2);
        let (across_w, across_v) = (slope_w * w, slope_v * n2);
        let shift = excess * scale;
        let end = Phase { w: w - shift * across_w, v: v - shift * across_v, pull };
        // Of the medium, not of the end: that of a step out of the chart may be anything.
        let per_n = one / medium.index(w);
        let per_n2 = per_n * per_n;
        let (per_w, per_v) = (b * per_n, b * w.abs() * per_n2);
        let angle = |w_error: R, v_error: R| w_error.abs() * per_w + v_error.abs() * per_v;
        let v_error = v_error * secant;
        // Differences that may be rounding count neither as an error, which it would look like near the circular ray,
        // where both slopes vanish, nor as a way, which would move rays about far from the centre. Near the horizon it
        // is that of w.
        let rounding = R::of(ROUNDING * R::EPSILON) * (n2 + pull.abs() * w);
        let known = (excess.abs() - rounding).at_least(R::of(0.0));
        let known_shift = known * scale;
        let undone = if excess > R::of(0.0) { known_shift } else { -known_shift };
        Self {
            b,
            start,
            rise: gain * c - undone * across_w,
            end,
            per_index: per_n,
            h,
            cos: c,
            sin,
            embedded: angle(position_error * c, v_error),
            undone: known_shift * angle(across_w, across_v),
            drift: excess.abs() / n2,
            strain: known_shift * n2 + known * per_n2 + v_error.abs() * per_n,
            leverage: (scale + scale) * n2 * n2,
        }
    }
}
