//! Step size from error estimates.

use super::stepper::StepErrorModel;
use super::{Phase, PlaneArc, Step, Stepper};
use crate::math::fast_log2;
use crate::math::real::Real;
use crate::spacetime::ConformallyFlat;

/// Step-size control: the tolerances of steps, and how their length follows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Control<R> {
    /// Largest error of a ray's direction, all its steps together, radians.
    tolerance: R,
    /// Inverse of the largest distance between an arc and the curve, scene units.
    per_arc_tolerance: R,
    /// Distance between an arc and the curve, relative to the chord, that is as good as none; squared.
    negligible: R,
    /// Inverse radius of the horizon, or of half the throat of a wormhole, which steps may pass a little; infinite without
    /// either.
    horizon: R,
    /// Inverse radius of the photon sphere; infinite without one.
    photon_sphere: R,
    /// Critical impact parameter.
    critical: R,
    /// Inverse radius of a jump in the index's second derivative, which steps end at; infinite without one.
    seam: R,
    /// Distance from there that a step's end may have.
    seam_margin: R,
    /// Longest way of a step towards the horizon, relative to what is left.
    longest_fall: R,
    /// Longest way of a step away from the horizon, relative to what lies between.
    longest_rise: R,
    /// Least length of a first step before it is limited.
    first: R,
}

/// A step, judged.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepVerdict<R> {
    /// True if the step is good enough to be taken.
    pub accepted: bool,
    /// Length in ξ to try next: from the step's end if it is taken, else from its start.
    pub next_h: R,
    /// Error relative to what is allowed, for the judgement of the next step.
    pub error: R,
}

/// Bounds on how a step may grow or shrink from one to the next.
const GROWTH: (f32, f32) = (0.2, 4.0);
/// A rejected step is at most this long the next time.
const HALVED: f32 = 0.5;
/// Aims a little below the tolerance, so that most steps are accepted.
const SAFETY: f32 = 0.85;
/// Swept angle over which the whole tolerance may be used up, radians: half a turn, and a little for the angle that
/// every step is given whatever it sweeps.
const SWEEP: f64 = 3.5;
/// Angle that a step's share of the tolerance is counted for at least, radians: nearly radial rays sweep next to
/// nothing.
const LEAST_SWEEP: f64 = 0.02;
/// Largest strain of a step: a radial ray keeps its direction whatever the steps do, but must not step out of the
/// chart.
const LARGEST_STRAIN: f64 = 0.02;
/// Largest error of a step along its orbit, radians: close to the circular ray a larger one could hold the ray there.
const LARGEST_SLIP: f64 = 0.02;
/// Largest tangent of the angle that a step sweeps.
const LARGEST_TANGENT: f64 = 3.0;
/// Longest way of a step towards the horizon, relative to what is left.
const LONGEST_FALL: f64 = 0.5;
/// Longest way of a step away from the horizon, relative to what lies between.
const LONGEST_RISE: f64 = 1.0;
/// Length or factor that limits nothing.
const FAR: f64 = 1e30;
/// Relative error of an arc below which the next step is not limited by it.
const FREE: f64 = 1e-4;
/// Tolerance over the strength of the field at which a first step is as long as the field's own scale.
const REACH: f64 = 300.0;
/// Part of the tolerance by which an arc may miss the curve and still stand for it.
const NEGLIGIBLE: f64 = 0.1;
/// Relative change of w over which a jump is looked at.
const SEAM_WIDTH: f64 = 1e-6;
/// Distance from a seam, in units of that at which the error would be half of the tolerance.
const SEAM_SHARE: f64 = 0.01;
/// Least relative distance from a seam, in roundings.
const SEAM_ROUNDING: f64 = 8.0;
/// Smallest tolerance, in roundings: below, steps would be judged by their rounding.
const LEAST_TOLERANCE: f64 = 100.0;

/// Factor from the length of a step to that of the next, given the relative errors of the one before and of this one,
/// whether this one is `accepted`, and the order of the estimate.
///
/// A PI controller \[Söderlind 2003, "Digital filters in adaptive time-stepping", ACM TOMS 29, 1\] with β₁ = ¾, β₂ = −¼.
#[inline(always)]
pub(super) fn growth(order: u32, accepted: bool, previous: f64, error: f64) -> f32 {
    // (e₋₁/e³)^(1/4p) with p rounded to a power of two, in logarithms.
    let log2 = |error: f64| fast_log2::log2(error as f32);
    let halvings = if order > 6 { 5 } else { 4 };
    let factor = SAFETY * fast_log2::exp2((log2(previous) - 3 * log2(error)) >> halvings);
    let most = if accepted { GROWTH.1 } else { HALVED };
    factor.at_most(most).at_least(GROWTH.0)
}

/// Distance in w from the mouth of a cylindrical throat at which the error of a step that passes it is as good as none.
///
/// With the jump j of d ln g/d ln w, the error of its direction is about ½ j (distance/w)².
fn seam_margin<M: ConformallyFlat>(medium: &M, tolerance: f64, epsilon: f64) -> f64 {
    if medium.mouth() == 0.0 {
        return 0.0;
    }
    let (w, pull) = (1.0 / medium.mouth(), medium.pull(1.0 / medium.mouth()));
    let steepness = |change: f64| (medium.pull(w * (1.0 + change)) / pull - 1.0) / change;
    let jump = (steepness(-SEAM_WIDTH) - steepness(SEAM_WIDTH)).abs();
    w * (SEAM_SHARE * (tolerance / jump).sqrt()).max(SEAM_ROUNDING * epsilon)
}

impl<R: Real> Control<R> {
    /// The tolerance to which smaller ones are raised, radians.
    pub fn least_tolerance() -> f64 {
        LEAST_TOLERANCE * R::EPSILON
    }

    /// Control of rays around `medium`: `tolerance` in radians, `arc_tolerance` in scene units.
    pub fn new<M: ConformallyFlat>(medium: &M, tolerance: f64, arc_tolerance: f64) -> Self {
        let tolerance = tolerance.max(Self::least_tolerance());
        Self {
            tolerance: R::of(tolerance),
            negligible: R::of((NEGLIGIBLE * tolerance) * (NEGLIGIBLE * tolerance)),
            per_arc_tolerance: R::of(1.0 / arc_tolerance),
            horizon: R::of(1.0 / medium.horizon().max(0.5 * medium.throat())),
            photon_sphere: R::of(1.0 / medium.photon_sphere()),
            critical: R::of(medium.critical_impact_parameter()),
            seam: R::of(1.0 / medium.mouth()),
            seam_margin: R::of(seam_margin(medium, tolerance, R::EPSILON)),
            longest_fall: R::of(LONGEST_FALL),
            longest_rise: R::of(LONGEST_RISE),
            first: R::of(0.0),
        }
    }

    /// The control of steps that keep within the chart by themselves and know their length before they are taken.
    pub(super) fn without_limits(&self) -> Self {
        let far = R::of(FAR);
        Self { longest_fall: far, longest_rise: far, first: far, ..*self }
    }

    /// True if a step ends on the branch of the orbit on which it starts.
    ///
    /// Above the critical impact parameter a ray stays on its side of the photon sphere, below it keeps its sense. Near
    /// the circular ray both branches come so close that a loose tolerance would let a ray change over.
    #[inline(always)]
    fn keeps_branch(&self, step: &Step<R>) -> bool {
        let side = (step.start.w < self.photon_sphere) == (step.end.w < self.photon_sphere);
        let zero = R::of(0.0);
        let sense = (step.start.v > zero) == (step.end.v > zero);
        if step.b > self.critical { side } else { sense }
    }

    /// Judges `step`, whose arc is off by `arc_error`, after a step whose relative error was `previous`.
    ///
    /// Errors of steps add up to the error of the ray, so each gets a share of the tolerance by the angle that it
    /// sweeps.
    #[inline(always)]
    pub fn judge<S: Stepper>(&self, step: &Step<R>, arc_error: R, previous: R) -> StepVerdict<R> {
        let StepErrorModel { order, embedded, undone } = S::ESTIMATE;
        let share = (step.sin + R::of(LEAST_SWEEP)) * (self.tolerance * R::of(1.0 / SWEEP));
        let own = step.embedded * step.h * self.rate(step.b, &step.start);
        let estimate = R::of(embedded) * own + R::of(undone) * step.undone;
        // The sum, unlike the larger, keeps the NaN of a step that left the chart, and NaN is never accepted.
        let error = estimate / share
            + estimate * estimate * step.leverage * R::of(1.0 / (LARGEST_SLIP * LARGEST_SLIP))
            + step.strain * R::of(1.0 / LARGEST_STRAIN)
            + arc_error * self.per_arc_tolerance;
        let accepted = (error <= R::of(1.0)) & self.keeps_branch(step);
        let bounded = error.at_least(R::of(1e-6)).at_most(R::of(1e6));
        let factor = growth(order, accepted, previous.value(), bounded.value());
        StepVerdict { accepted, next_h: step.h * R::of(f64::from(factor)), error: bounded }
    }

    /// Judges `step` once more where the index has a seam: no method is of its order across that, so that one of the step's
    /// ends has to be there. Newton's method finds it from rejected steps.
    #[inline(always)]
    pub fn at_seam<M: ConformallyFlat>(
        &self,
        medium: &M,
        step: &Step<R>,
        verdict: StepVerdict<R>,
    ) -> StepVerdict<R> {
        if medium.mouth() == 0.0 {
            return verdict;
        }
        let (from, to) = (step.start.w - self.seam, step.end.w - self.seam);
        let zero = R::of(0.0);
        let passes = ((from < zero) != (to < zero)) & (from.abs().at_most(to.abs()) > self.seam_margin);
        // A little beyond it, at the root in (0, 1) of a parabola through both ends with the slope at the start.
        let beyond = R::of(0.5) * if from < zero { self.seam_margin } else { -self.seam_margin };
        let (slope, way) = (step.start.v * step.h, from - beyond);
        let root = (slope * slope - R::of(4.0) * (to - from - slope) * way).at_least(zero).sqrt();
        let part = R::of(-2.0) * way / if slope < zero { slope - root } else { slope + root };
        let cut = step.h * part.at_most(R::of(1.0));
        StepVerdict {
            accepted: verdict.accepted & !passes,
            next_h: if passes { cut.at_most(verdict.next_h) } else { verdict.next_h },
            ..verdict
        }
    }

    /// Judges a step of a series, which is as long as its accuracy allows, whose arc is off by `arc_error`.
    #[inline(always)]
    pub(super) fn judge_series(&self, step: &Step<R>, arc_error: R) -> StepVerdict<R> {
        let estimate = step.undone + step.embedded;
        let own = estimate * estimate * step.leverage * R::of(1.0 / (LARGEST_SLIP * LARGEST_SLIP))
            + step.strain * R::of(1.0 / LARGEST_STRAIN);
        let error = own + arc_error * self.per_arc_tolerance;
        let accepted = (error <= R::of(1.0)) & self.keeps_branch(step);
        let bounded = error.at_least(R::of(1e-6)).at_most(R::of(1e6));
        // Arcs are of order 5.
        let root = (fast_log2::log2(bounded.value() as f32) as f32 * -0.2) as i32;
        let factor = (SAFETY * fast_log2::exp2(root)).at_least(GROWTH.0);
        let factor = if accepted { factor } else { factor.at_most(HALVED) };
        let next_h = step.h * R::of(f64::from(factor));
        // What is far below the tolerance tells nothing.
        let is_free = accepted & (error < R::of(FREE));
        StepVerdict { accepted, next_h: if is_free { R::of(FAR) } else { next_h }, error: bounded }
    }

    /// True if an arc is so near the curve that what meets the one meets the other to the accuracy asked for.
    #[inline(always)]
    pub fn is_close(&self, arc: &PlaneArc<R>) -> bool {
        let [x, y] = arc.end;
        arc.error * arc.error <= self.negligible * (x * x + y * y)
    }

    /// Rate that sets the length of a step: the angle swept, and the growth of the index towards the horizon.
    #[inline(always)]
    fn rate(&self, b: R, phase: &Phase<R>) -> R {
        b + phase.index(b) / self.room(phase.w)
    }

    /// Distance of the index from a pole, in inverse radius.
    #[inline(always)]
    fn room(&self, w: R) -> R {
        if self.horizon < R::of(f64::INFINITY) { self.horizon - w } else { w }
    }

    /// A step of at most `h` from `phase` that neither sweeps too much nor changes the index too much.
    #[inline(always)]
    pub fn within(&self, h: R, b: R, phase: &Phase<R>) -> R {
        let n = phase.index(b);
        let longest = if phase.v > R::of(0.0) { self.longest_fall } else { self.longest_rise };
        let h = h.at_most(longest * self.room(phase.w) / n);
        let widest = R::of(LARGEST_TANGENT) / b;
        if h * b > R::of(LARGEST_TANGENT) { widest } else { h }
    }

    /// A first step from `phase`, for a stepper whose estimate is of `order`.
    #[inline(always)]
    pub fn first_step<M: ConformallyFlat>(&self, medium: &M, order: u32, b: R, phase: &Phase<R>) -> R {
        let (rate, room) = (self.rate(b, phase).value(), self.room(phase.w).value());
        let (b, w, v) = (b.value(), phase.w.value(), phase.v.value());
        // A straight continuation comes this near, within the step.
        let ahead = w + if v > 0.0 { v / rate } else { 0.0 };
        let nearest = ahead.at_most(w + LONGEST_FALL * room);
        let pull = medium.pull(nearest).abs();
        let strength = b * pull / ((v * v + (b * w) * (b * w)).sqrt() * rate * rate);
        // The root of that order, with the exponent rounded up to 64ths, so that small roots are not too large.
        let exponent = 64u32.div_ceil(order.max(1)) as i32;
        let log2 = fast_log2::log2((REACH * self.tolerance.value() / strength) as f32);
        let reach = f64::from(fast_log2::exp2((log2 >> 6) * exponent));
        let first = R::of(reach.at_most(LARGEST_TANGENT) / rate).at_least(self.first);
        self.within(first, R::of(b), phase)
    }
}
