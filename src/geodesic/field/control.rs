//! Step size in fields of refraction, from error estimates and from how far a step can see.

use super::step::{FieldRays, FieldStep, lane};
use crate::geodesic::control::growth;
use crate::geodesic::{Control, StepErrorModel, Stepper};
use crate::math::fast_log2;
use crate::spacetime::IndexField;
use glam::DVec3;

/// Step-size control of rays in a field.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FieldControl {
    /// Largest error of a ray's direction, all its steps together, radians.
    tolerance: f64,
    /// Sharpness of landings; see [`Self::inverse_scale`].
    sharpness: f64,
    /// Inverse of the largest distance between an arc and the curve, scene units.
    per_arc_tolerance: f64,
    /// Middle of the field.
    pub middle: DVec3,
    /// Distance from the middle outside which there is no geometry and no ray turns back.
    pub outer: f64,
}

/// A step, judged.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FieldVerdict {
    /// True if the step is good enough to be taken.
    pub accepted: bool,
    /// Length in τ to try next: from the step's end if it is taken, else from its start.
    pub next_h: f64,
    /// Error relative to what is allowed, for the judgement of the next step.
    pub error: f64,
}

/// Part of the tolerance that a step may use up.
const SHARE: f64 = 0.1;
/// Largest relative violation of |p|² = n², of a step that makes sense at all.
const LARGEST_DRIFT: f64 = 0.04;
/// Largest tangent of the angle that a step sweeps.
const LARGEST_TANGENT: f64 = 3.0;
/// Distance from the middle at which a step from farther away ends, relative to that of the outermost geometry: so far out
/// that a bent ray is not taken past it.
const EDGE: f64 = 1.4;
/// Longest step in a straight field, relative to the distance from the middle.
const LONGEST: f64 = 8.0;
/// Tolerance over the strength of the field at which a first step is as long as the field's own scale.
const REACH: f64 = 300.0;
/// Part of the tolerance by which a ray may be off where it lands.
const LANDING: f64 = 0.1;
/// Part of the tolerance by which an arc may miss the curve, relative to the chord, and still stand for it.
const NEGLIGIBLE: f64 = 0.1;

impl FieldControl {
    /// Control of rays of `field` around geometry up to `farthest` from its middle: `tolerance` in radians,
    /// `arc_tolerance` in scene units.
    pub fn new(field: &impl IndexField, farthest: f64, tolerance: f64, arc_tolerance: f64) -> Self {
        let tolerance = tolerance.max(Control::<f64>::least_tolerance());
        Self {
            tolerance,
            sharpness: 1.0 / libm::pow(LANDING * tolerance, 1.0 / 6.0),
            per_arc_tolerance: 1.0 / arc_tolerance,
            middle: field.middle(),
            outer: field.turning_radius().max(farthest),
        }
    }

    /// Judges the step of a lane by `h`, whose arc is off by `arc_error`, after a step whose relative error was `previous`.
    #[inline(always)]
    pub fn judge<const L: usize, S: Stepper>(
        &self,
        (step, h): (&FieldStep<L>, f64),
        arc_error: f64,
        previous: f64,
        l: usize,
    ) -> FieldVerdict {
        let StepErrorModel { order, embedded, .. } = S::ESTIMATE;
        let estimate = embedded * step.embedded[l] * step.share[l];
        // The sum keeps the NaN of a step that left the chart, and NaN is never accepted.
        let error = estimate / (SHARE * self.tolerance)
            + step.drift[l] / LARGEST_DRIFT
            + arc_error * self.per_arc_tolerance;
        let accepted = (error <= 1.0) & (step.ahead[l] > 0.0);
        let bounded = if error > 1e-6 { error } else { 1e-6 };
        let bounded = if bounded < 1e6 { bounded } else { 1e6 };
        let factor = f64::from(growth(order, accepted, previous, bounded));
        // τ counts from each start: a length at the end is as long there by (1 + β·y)².
        let scale = if accepted { 1.0 / (step.ahead[l] * step.ahead[l]) } else { 1.0 };
        FieldVerdict { accepted, next_h: h * scale * factor, error: bounded }
    }

    /// A length of at most `h` for the next step of a lane: not past what it cannot see, and from far outside to the edge
    /// of the geometry in one step.
    #[inline(always)]
    pub fn within<const L: usize>(&self, h: f64, rays: &FieldRays<L>, l: usize) -> f64 {
        let (x, p, lean) = (lane(&rays.x, l) - self.middle, lane(&rays.p, l), lane(&rays.lean, l));
        let n = p.length();
        let (edge, distance2, outwards) = (EDGE * self.outer, x.length_squared(), x.dot(p) / n);
        // The straight continuation.
        let across2 = distance2 - outwards * outwards;
        let meets = (outwards < 0.0) & (across2 < edge * edge);
        let way_in = -outwards - (edge * edge - across2).sqrt();
        let far = distance2 > edge * edge;
        let free = LONGEST * (distance2.sqrt() + edge);
        let passing = if meets { way_in } else { free };
        let reach = rays.reach[l];
        let longest = if far & (passing > reach) { passing } else { reach };
        let longest = if longest < free { longest } else { free };
        let shortest_rate = n / longest + lean.dot(p);
        let sweep_rate = lean.cross(p).length() / LARGEST_TANGENT;
        let rate = if shortest_rate > sweep_rate { shortest_rate } else { sweep_rate };
        if h * rate > 1.0 { 1.0 / rate } else { h }
    }

    /// A first step of a lane, for a stepper whose estimate is of `order`.
    #[inline(always)]
    pub fn first_step<const L: usize>(&self, order: u32, rays: &FieldRays<L>, l: usize) -> f64 {
        let (p, force, room) = (lane(&rays.p, l), lane(&rays.force, l), rays.room[l]);
        let x = lane(&rays.x, l) - self.middle;
        let (n2, edge, distance2) = (p.length_squared(), EDGE * self.outer, x.length_squared());
        // A straight continuation from far outside comes this near.
        let outwards = x.dot(p);
        let across = (distance2 - outwards * outwards / n2).sqrt();
        let ahead = if across > edge { across } else { edge };
        let far = (distance2 > edge * edge) & (outwards < 0.0) & (ahead < room);
        let nearest = if far { ahead } else { room };
        let strength = force.length() * room * room / (nearest * n2);
        let exponent = 64u32.div_ceil(order.max(1)) as i32;
        let log2 = fast_log2::log2((REACH * self.tolerance / strength) as f32);
        let reach = f64::from(fast_log2::exp2((log2 >> 6) * exponent));
        let h = (if reach < 1.0 { reach } else { 1.0 }) * room * room / (nearest * n2.sqrt());
        self.within(h, rays, l)
    }

    /// True if a ray with this position and momentum leaves: nothing is in its way any more.
    #[inline(always)]
    pub fn leaves(&self, x: DVec3, p: DVec3) -> bool {
        let away = x - self.middle;
        (away.length_squared() >= self.outer * self.outer) & (away.dot(p) > 0.0)
    }

    /// True if `x` is farther out than `y`: a ray that leaves may still go around the holes, but comes no nearer.
    #[inline(always)]
    pub(super) fn is_beyond(&self, x: DVec3, y: DVec3) -> bool {
        x.distance_squared(self.middle) >= y.distance_squared(self.middle)
    }

    /// True if a step between two positions with their momenta keeps outside the geometry: it does not turn in between.
    #[inline(always)]
    pub fn keeps_outside(&self, start: (DVec3, DVec3), end: (DVec3, DVec3)) -> bool {
        let at = |(x, p): (DVec3, DVec3)| {
            let away = x - self.middle;
            (away.length_squared() > self.outer * self.outer, away.dot(p) < 0.0)
        };
        let ((starts_outside, starts_inwards), (ends_outside, ends_inwards)) = (at(start), at(end));
        starts_outside & ends_outside & (starts_inwards == ends_inwards)
    }

    /// Inverse length that tells how far a circle stands for a ray of this curvature, in a field that changes over `room`:
    /// over a distance d the ray turns off the circle by ½ d² κ/room, and a circle is taken for it where the cube of d
    /// times this is a tenth of the tolerance.
    #[inline(always)]
    pub fn inverse_scale(&self, curvature: f64, room: f64) -> f64 {
        self.sharpness * (0.5 * curvature / room).sqrt()
    }

    /// True if an arc with this chord is so near the curve that what meets the one meets the other to the accuracy asked
    /// for.
    #[inline(always)]
    pub fn is_close(&self, chord: DVec3, arc_error: f64) -> bool {
        let negligible = NEGLIGIBLE * self.tolerance;
        arc_error * arc_error <= negligible * negligible * chord.length_squared()
    }
}
