//! Rays in isotropic coordinates: of flat space and of static, spherical spacetimes.

use std::f64::consts::TAU;
use std::marker::PhantomData;

use glam::DVec3;

use super::super::input_error::{Input, InputError};
use super::super::lengths::Lengths;
use super::super::table::Cell;
use super::table_form::other_chart;
use super::{Accuracy, Arrival, Cells, FreeRayEnd, SphereCrossing, TableForm, Traced};
use crate::geodesic::{
    ArealJourney, ArealQuadrature, ArealSeries, Control, Launch, OrbitEnd, OrbitStepper, Passage, Phase,
    Stepper, UsePowers, elapsed, follow, with_powers,
};
use crate::math::cross_exact;
use crate::math::dual::Dual;
use crate::math::real::Real;
use crate::scene::{Precision, StepperKind};
use crate::spacetime::{
    ConformallyFlat, Fate, IndexField, KerrNewman, Mouths, Placement, ReissnerNordstrom, SpacetimeKind,
    SpacetimeVisitor, StaticHole,
};
use crate::trace::steppers::{UseStepper, with_stepper};

/// Columns of a ray's start, of its direction, of any length, and of the isotropic radius of its sphere.
const START: [&str; 3] = ["x0", "y0", "z0"];
const DIRECTION: [&str; 3] = ["dx0", "dy0", "dz0"];
const SPHERE: [&str; 1] = ["r_out"];

/// Form of the tables.
pub(super) static FORM: TableForm = TableForm {
    needed: &["x0", "y0", "z0", "dx0", "dy0", "dz0", "r_out"],
    optional: &[],
    results: &[
        "x1", "y1", "z1", "dx1", "dy1", "dz1", "t", "phi", "revs", "b", "eps", "r_min", "sens", "drift_h",
        "drift_l",
    ],
    crossing: ["x1", "y1", "z1", "dx1", "dy1", "dz1", "sens"],
    steppers: &StepperKind::AROUND_A_HOLE,
    stepper: Some(StepperKind::Quadrature),
    radius: |_, cells| cells.last(),
    trace: |spacetime, cells, accuracy| Ok(trace(spacetime, &FreeRay::of(cells), accuracy)?.traced()),
    arrive: |spacetime, cells, accuracy| arrive(spacetime, &FreeRay::of(cells), accuracy),
};

/// A ray to be followed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FreeRay {
    /// Start, in the chart.
    pub start: DVec3,
    /// Direction of travel at the start; of any length.
    pub direction: DVec3,
    /// Isotropic radius of the sphere on which it is to arrive, outwards.
    pub r_out: f64,
}

/// A ray, followed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Exit {
    /// Status at its end.
    pub status: FreeRayEnd,
    /// Crossing of the sphere, if it escaped.
    pub crossing: Option<Crossing>,
    /// Impact parameter L/E, a length.
    pub b: f64,
    /// Distance from the critical impact parameter, relative to that, if there is one.
    pub eps: Option<f64>,
    /// Isotropic radius of the point nearest to the centre, if the ray passed one.
    pub r_min: Option<f64>,
    /// True if the ray passed a throat. Its crossing is then as if the other side were glued on without inversion: it is
    /// to be turned by half a turn about the centre.
    pub passes: bool,
    /// Steps tried.
    pub steps: u32,
}

/// The state in which a ray crosses its sphere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crossing {
    /// Position, in the chart.
    pub position: DVec3,
    /// Unit direction of travel.
    pub direction: DVec3,
    /// Coordinate time since the start, in the unit of length.
    pub time: f64,
    /// Angle swept about the centre, radians.
    pub swept: f64,
    /// Radians at the end, of position as seen from the centre or of direction, per radian of the starting direction
    /// in the orbit's plane; at least 1.
    pub sens: f64,
    /// (|p|² − n²)/n² there.
    pub drift_h: f64,
    /// Change of |x × p| from start to end, of the states as they are in the chart, relative to b; none if that is 0.
    pub drift_l: Option<f64>,
}

impl FreeRay {
    fn of(cells: &Cells) -> Self {
        let ray = &cells.needed;
        Self { start: DVec3::from_slice(&ray[0..3]), direction: DVec3::from_slice(&ray[3..6]), r_out: ray[6] }
    }
}

impl Exit {
    fn traced(&self) -> Traced {
        let crossing = self.crossing.as_ref();
        let at = |value: fn(&Crossing) -> f64| Cell::from(crossing.map(value));
        let cells = vec![
            at(|c| c.position.x),
            at(|c| c.position.y),
            at(|c| c.position.z),
            at(|c| c.direction.x),
            at(|c| c.direction.y),
            at(|c| c.direction.z),
            at(|c| c.time),
            at(|c| c.swept),
            at(|c| c.swept / TAU),
            Cell::from(Some(self.b)),
            Cell::from(self.eps),
            Cell::from(self.r_min),
            at(|c| c.sens),
            at(|c| c.drift_h),
            Cell::from(crossing.and_then(|c| c.drift_l)),
        ];
        let crossing = crossing.map(|&Crossing { position, direction, sens, .. }| SphereCrossing {
            position,
            direction,
            sens,
        });
        Traced { status: self.status, crossing, cells, steps: self.steps }
    }
}

/// Distance from the sphere, relative to its radius, at which a start counts as on it.
const ON_SPHERE: f64 = 4.0 * f64::EPSILON;

/// Follows `ray` until it crosses its sphere outwards. A start on the sphere, to rounding, moving outwards crosses it
/// there.
///
/// # Errors
/// If there is no such ray, or the stepper is the paper's.
pub fn trace(spacetime: &SpacetimeKind, ray: &FreeRay, accuracy: &Accuracy) -> Result<Exit, InputError> {
    answer(spacetime, ray, accuracy)
}

/// Like [`trace`], without derivatives and times.
///
/// # Errors
/// As [`trace`].
pub fn arrive(spacetime: &SpacetimeKind, ray: &FreeRay, accuracy: &Accuracy) -> Result<Arrival, InputError> {
    answer(spacetime, ray, accuracy)
}

/// Answer about a ray: its exit, or only its arrival.
pub(super) trait Answer: Sized {
    /// From an exit in closed form.
    fn known(exit: Exit) -> Self;

    /// Around a centre, with orbits in `R`.
    fn around<M: ConformallyFlat, R: Real>(
        orbit: &Orbit<M>,
        stepper: &impl OrbitStepper,
        tolerance: f64,
    ) -> Self;
}

impl Answer for Exit {
    fn known(exit: Exit) -> Self {
        exit
    }

    fn around<M: ConformallyFlat, R: Real>(
        orbit: &Orbit<M>,
        stepper: &impl OrbitStepper,
        tolerance: f64,
    ) -> Self {
        orbit.exit::<R>(stepper, tolerance)
    }
}

impl Answer for Arrival {
    fn known(exit: Exit) -> Self {
        let crossing = exit.crossing.map(|crossing| (crossing.position, crossing.direction));
        Self { status: exit.status, crossing, steps: exit.steps }
    }

    fn around<M: ConformallyFlat, R: Real>(
        orbit: &Orbit<M>,
        stepper: &impl OrbitStepper,
        tolerance: f64,
    ) -> Self {
        orbit.arrival::<R>(stepper, tolerance).0
    }
}

/// An arrival, and true if the ray passed a throat, as [`Exit::passes`].
impl Answer for (Arrival, bool) {
    fn known(exit: Exit) -> Self {
        (Answer::known(exit), false)
    }

    fn around<M: ConformallyFlat, R: Real>(
        orbit: &Orbit<M>,
        stepper: &impl OrbitStepper,
        tolerance: f64,
    ) -> Self {
        orbit.arrival::<R>(stepper, tolerance)
    }
}

fn answer<A: Answer>(spacetime: &SpacetimeKind, ray: &FreeRay, accuracy: &Accuracy) -> Result<A, InputError> {
    let lengths = Lengths::of(accuracy.precision);
    lengths.check(Input::Columns(&DIRECTION), "the length of the direction", ray.direction.length())?;
    lengths.check(Input::Columns(&SPHERE), "the radius of the sphere", ray.r_out)?;
    let x = ray.start - spacetime.center().unwrap_or_default();
    lengths.check(Input::Columns(&START), "the distance of the start from the centre", x.length())?;
    lengths.check_parameters(spacetime)?;
    spacetime.visit(Asker { x, ray, accuracy, answer: PhantomData })
}

/// Follows a ray from `x`, relative to the centre if there is one.
struct Asker<'a, A> {
    x: DVec3,
    ray: &'a FreeRay,
    accuracy: &'a Accuracy,
    answer: PhantomData<A>,
}

impl<A: Answer> SpacetimeVisitor for Asker<'_, A> {
    type Output = Result<A, InputError>;

    fn flat(self) -> Self::Output {
        Ok(A::known(straight(self.x, self.ray)))
    }

    fn spherical<M: ConformallyFlat>(self, center: DVec3, medium: M) -> Self::Output {
        curved(&medium, self.x, center, self.ray, self.accuracy)
    }

    fn wormhole<M: ConformallyFlat>(self, _: Mouths, _: M) -> Self::Output {
        Err(other_chart("one side's isotropic"))
    }

    fn indexed<F: IndexField>(self, _: &F) -> Self::Output {
        Err(other_chart("isotropic"))
    }

    fn spinning(self, _: Placement, _: KerrNewman) -> Self::Output {
        Err(other_chart("isotropic"))
    }
}

/// Follows a ray around `medium`, from `x` relative to its centre.
pub(super) fn curved<M: ConformallyFlat, A: Answer>(
    medium: &M,
    x: DVec3,
    center: DVec3,
    ray: &FreeRay,
    accuracy: &Accuracy,
) -> Result<A, InputError> {
    let epsilon = match accuracy.precision {
        Precision::F32 => f32::EPSILON.into(),
        Precision::F64 => f64::EPSILON,
    };
    let (rho, horizon) = (x.length(), medium.horizon());
    // As near to the horizon as a few roundings, the index is anything.
    if rho <= horizon * (1.0 + 4.0 * epsilon) {
        return Err(InputError {
            input: Input::Columns(&START),
            cause: format!("the ray starts at the isotropic radius {rho}, but the horizon is at {horizon}"),
            remedy: "start outside the horizon; the isotropic radius is not the areal one".to_owned(),
        });
    }
    let launch = Launch::new(medium, x, ray.direction, epsilon);
    let orbit = Orbit { medium, center, x, ray, launch };
    if let Some(hole) = medium.as_hole() {
        if accuracy.stepper == StepperKind::Quadrature {
            return Ok(A::known(orbit.integrated(&hole)));
        }
        if accuracy.stepper == StepperKind::Series {
            let orbit = Orbit { medium: &ReissnerNordstrom::of(hole), center, x, ray, launch };
            return Ok(with_powers(accuracy.tolerance, Asked { orbit, accuracy, answer: PhantomData }));
        }
    }
    with_stepper(accuracy.stepper, Asked { orbit, accuracy, answer: PhantomData })
        .ok_or_else(|| FORM.refusal(accuracy.stepper))
}

/// Request for the answer about an orbit, for a stepper.
struct Asked<'a, M, A> {
    orbit: Orbit<'a, M>,
    accuracy: &'a Accuracy,
    answer: PhantomData<A>,
}

impl<M: ConformallyFlat, A: Answer> UseStepper for Asked<'_, M, A> {
    type Output = A;

    fn with(self, stepper: impl Stepper + 'static) -> A {
        self.orbit.answer(&stepper, self.accuracy)
    }
}

impl<A: Answer> UsePowers for Asked<'_, ReissnerNordstrom, A> {
    type Output = A;

    fn with<const P: usize>(self) -> A {
        let stepper = ArealSeries::<P>::new(&self.orbit.medium.hole(), self.accuracy.tolerance);
        self.orbit.answer(&stepper, self.accuracy)
    }
}

/// A ray about to be followed.
pub(super) struct Orbit<'a, M> {
    medium: &'a M,
    center: DVec3,
    /// Start, relative to the centre.
    x: DVec3,
    ray: &'a FreeRay,
    launch: Launch,
}

impl<M: ConformallyFlat> Orbit<'_, M> {
    fn answer<A: Answer>(&self, stepper: &impl OrbitStepper, accuracy: &Accuracy) -> A {
        match accuracy.precision {
            Precision::F32 => A::around::<M, f32>(self, stepper, accuracy.tolerance),
            Precision::F64 => A::around::<M, f64>(self, stepper, accuracy.tolerance),
        }
    }

    /// Inverse radius of the sphere.
    fn w_out(&self) -> f64 {
        let on_sphere = (self.launch.w * self.ray.r_out - 1.0).abs() <= ON_SPHERE;
        if on_sphere { self.launch.w } else { 1.0 / self.ray.r_out }
    }

    fn status<R>(&self, end: &OrbitEnd<R>) -> FreeRayEnd {
        match end {
            OrbitEnd::Crosses(..) => FreeRayEnd::Escaped,
            OrbitEnd::Falls => FreeRayEnd::Captured,
            // It is beyond the sphere, but comes back.
            OrbitEnd::Misses if self.launch.fate == Fate::Falls => FreeRayEnd::Captured,
            OrbitEnd::Misses => FreeRayEnd::Missed,
            OrbitEnd::StepLimit => FreeRayEnd::StepLimit,
            OrbitEnd::NonFinite => FreeRayEnd::NonFinite,
        }
    }

    fn arrival<R: Real>(&self, stepper: &impl OrbitStepper, tolerance: f64) -> (Arrival, bool) {
        let Self { medium, launch, .. } = self;
        let start = Phase::new(*medium, R::of(launch.w), R::of(launch.v));
        let control = Control::new(*medium, tolerance, f64::INFINITY);
        let w_out = self.w_out();
        let orbit = (R::of(launch.b), start, launch.fate);
        let journey = follow(*medium, stepper, &control, orbit, w_out, |_| {});
        let crossing = match &journey.end {
            OrbitEnd::Crosses(phase, swept) => {
                let (position, direction) = launch.place(w_out, phase.v.value(), swept.value());
                Some((position + self.center, direction))
            }
            _ => None,
        };
        let status = self.status(&journey.end);
        (Arrival { status, crossing, steps: journey.steps }, journey.passes)
    }

    fn exit<R: Real>(&self, stepper: &impl OrbitStepper, tolerance: f64) -> Exit {
        let Self { medium, launch, .. } = self;
        let dual = |value: f64, slope: f64| Dual { value: R::of(value), slope: R::of(slope) };
        // With the angle α between direction and radius, b = n ρ sin α and v = −n cos α; slopes are d/dα.
        let b = dual(launch.b, -launch.v / launch.w);
        let start = Phase::new(*medium, dual(launch.w, 0.0), dual(launch.v, launch.b * launch.w));
        let w_out = self.w_out();
        let control = Control::new(*medium, tolerance, f64::INFINITY);
        let mut time = 0.0;
        let journey = follow(*medium, stepper, &control, (b, start, launch.fate), w_out, |step| {
            time += elapsed(*medium, stepper, step);
        });
        let crossing = match journey.end {
            OrbitEnd::Crosses(phase, swept) => {
                // From the radius to the direction: the derivative of atan2(b w, −v).
                let (across, outwards) = (b * phase.w, -phase.v);
                let tilt = (outwards.value * across.slope - across.value * outwards.slope)
                    / (across.value.squared() + outwards.value.squared());
                let (v, swept, turn) = (phase.v.value(), swept.value(), swept.slope.value());
                let landing = SphereArrival { v, swept, turn, tilt: tilt.value(), time };
                Some(self.crossing(&landing, w_out))
            }
            _ => None,
        };
        let periastron = journey.periastron.map(|w| w.value());
        let exit = self.ended(self.status(&journey.end), crossing, periastron);
        Exit { passes: journey.passes, steps: journey.steps, ..exit }
    }

    /// The exit by quadrature, around the `hole` that the medium is.
    fn integrated(&self, hole: &StaticHole) -> Exit {
        let Self { medium, launch, .. } = self;
        let w = self.w_out();
        let ArealJourney { passage, periastron } = ArealQuadrature::new(hole).follow(launch, w);
        let crossing = passage.map(|Passage { swept, turn, cosine, time }| {
            let n = medium.index(w);
            // b = n sin η/w at the end, at the angle η from the radius, and b = n sin α/w at the start.
            let tilt = -launch.v * w / (launch.w * n * cosine);
            self.crossing(&SphereArrival { v: -n * cosine, swept, turn, tilt, time }, w)
        });
        let status = match (&crossing, launch.fate) {
            (Some(_), _) => FreeRayEnd::Escaped,
            (None, Fate::Falls) => FreeRayEnd::Captured,
            (None, Fate::Escapes) => FreeRayEnd::Missed,
        };
        self.ended(status, crossing, periastron)
    }

    /// The exit of a ray, without steps, given the inverse radius of its periastron.
    fn ended(&self, status: FreeRayEnd, crossing: Option<Crossing>, periastron: Option<f64>) -> Exit {
        let critical = self.medium.critical_impact_parameter();
        Exit {
            status,
            crossing,
            b: self.launch.b,
            eps: (critical > 0.0).then(|| (self.launch.b - critical) / critical),
            r_min: periastron.map(|w| 1.0 / w),
            passes: false,
            steps: 0,
        }
    }

    fn crossing(&self, landing: &SphereArrival, w: f64) -> Crossing {
        let Self { medium, launch, .. } = self;
        let &SphereArrival { v, swept, turn, tilt, time } = landing;
        let (position, direction) = launch.place(w, v, swept);
        let n2 = |x: DVec3| medium.index_squared(1.0 / x.length());
        let there = n2(position);
        Crossing {
            position: position + self.center,
            direction,
            time,
            swept,
            sens: turn.abs().max((turn + tilt).abs()).max(1.0),
            drift_h: (v * v + (launch.b / position.length()).powi(2)) / there - 1.0,
            drift_l: drift_l(
                n2(self.x).sqrt() * spin(self.x, self.ray.direction),
                there.sqrt() * spin(position, direction),
            ),
        }
    }
}

/// State of a ray where it crosses its sphere, in the plane of its orbit.
struct SphereArrival {
    /// dw/dψ.
    v: f64,
    /// Angle swept, radians.
    swept: f64,
    /// Its derivative by the angle between direction and radius at the start.
    turn: f64,
    /// That of the angle between direction and radius at the end.
    tilt: f64,
    /// Coordinate time, in the unit of length.
    time: f64,
}

/// |x × d|/|d|.
fn spin(x: DVec3, d: DVec3) -> f64 {
    cross_exact::cross(x, d).length() / d.length()
}

/// Relative change of the angular momentum.
fn drift_l(before: f64, after: f64) -> Option<f64> {
    (before > 0.0).then(|| (after - before) / before)
}

/// Follows a ray in flat space from `x`, its sphere about the origin, in closed form.
pub(super) fn straight(x: DVec3, ray: &FreeRay) -> Exit {
    let (rho, r_out) = (x.length(), ray.r_out);
    let direction = ray.direction.normalize();
    let b = spin(x, ray.direction);
    // Way to the point nearest to the centre, backwards, and from there to the sphere.
    let (along, half) = (x.dot(direction), ((r_out - b) * (r_out + b)).max(0.0).sqrt());
    let way = if along > 0.0 { (r_out - rho) * (r_out + rho) / (along + half) } else { half - along };
    let crosses = b <= r_out && way >= -ON_SPHERE * r_out;
    let crossing = crosses.then(|| {
        let way = way.max(0.0);
        let position = x + way * direction;
        Crossing {
            position,
            direction,
            time: way,
            swept: libm::atan2(b * way, rho * rho + way * along),
            sens: (1.0 - along / half).abs().max(1.0),
            drift_h: direction.length_squared() - 1.0,
            drift_l: drift_l(b, spin(position, direction)),
        }
    });
    let status = if crosses { FreeRayEnd::Escaped } else { FreeRayEnd::Missed };
    Exit { status, crossing, b, eps: None, r_min: (along < 0.0).then_some(b), passes: false, steps: 0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    const HOLE: SpacetimeKind = SpacetimeKind::black_hole(DVec3::ZERO, 1.0);
    const ACCURACY: Accuracy =
        Accuracy { stepper: StepperKind::Dop853, tolerance: 1e-11, precision: Precision::F64 };

    fn ray(start: [f64; 3], direction: [f64; 3], r_out: f64) -> FreeRay {
        FreeRay { start: start.into(), direction: direction.into(), r_out }
    }

    fn exit(spacetime: &SpacetimeKind, ray: FreeRay) -> Exit {
        trace(spacetime, &ray, &ACCURACY).unwrap()
    }

    #[test]
    fn the_status_tells_how_a_ray_meets_its_sphere() {
        let cases = [
            // Inside it, outside it, on it.
            ([2.0, 0.0, 0.0], [1.0, 1.0, 0.0], 5.0, FreeRayEnd::Escaped),
            ([9.0, 0.0, 0.0], [1.0, 1.0, 0.0], 5.0, FreeRayEnd::Missed),
            ([3.0, 4.0, 0.0], [1.0, 1.0, 0.0], 5.0, FreeRayEnd::Escaped),
            // Past the hole: through the sphere, and beside it.
            ([9.0, 0.0, 0.0], [-1.0, 0.4, 0.0], 5.0, FreeRayEnd::Escaped),
            ([9.0, 0.0, 0.0], [-1.0, 2.0, 0.0], 5.0, FreeRayEnd::Missed),
            ([9.0, 0.0, 0.0], [-1.0, 0.0, 0.0], 5.0, FreeRayEnd::Captured),
            // Within the photon sphere, turning back: before the sphere, beyond it, from beyond it.
            ([0.5, 0.0, 0.0], [0.5, 1.0, 0.0], 0.9, FreeRayEnd::Captured),
            ([0.5, 0.0, 0.0], [0.5, 1.0, 0.0], 0.501, FreeRayEnd::Escaped),
            ([0.5, 0.0, 0.0], [0.5, 1.0, 0.0], 0.4, FreeRayEnd::Captured),
        ];
        for (start, direction, r_out, status) in cases {
            let found = exit(&HOLE, ray(start, direction, r_out));
            assert_eq!(found.status, status, "{start:?} {direction:?} {r_out}: {found:?}");
            assert_eq!(found.crossing.is_some(), status == FreeRayEnd::Escaped);
            let expected =
                if start[0] == 9.0 && direction[0] < 0.0 && status != FreeRayEnd::Captured { 1 } else { 0 };
            assert_eq!(usize::from(found.r_min.is_some()), expected, "{found:?}");
        }
    }

    #[test]
    fn an_arrival_is_the_end_of_the_exit() {
        for precision in [Precision::F32, Precision::F64] {
            for (start, direction, r_out) in [
                ([2.0, 0.3, 0.0], [1.0, 1.0, 0.2], 5.0),
                ([9.0, 0.0, 0.0], [-1.0, 0.4, 0.0], 50.0),
                ([9.0, 0.0, 0.0], [-1.0, 0.0, 0.0], 5.0),
                ([9.0, 0.0, 0.0], [1.0, 0.0, 0.0], 5.0),
            ] {
                let (ray, accuracy) = (ray(start, direction, r_out), Accuracy { precision, ..ACCURACY });
                for spacetime in [&HOLE, &SpacetimeKind::Flat] {
                    let full = trace(spacetime, &ray, &accuracy).unwrap();
                    assert_eq!(arrive(spacetime, &ray, &accuracy).unwrap(), Arrival::known(full));
                }
            }
        }
    }

    #[test]
    fn a_start_on_the_sphere_moving_outwards_is_the_end() {
        for precision in [Precision::F32, Precision::F64] {
            let start = DVec3::new(0.3, -1.7, 2.2);
            let ray = FreeRay { start, direction: DVec3::new(1.0, -3.0, 0.0), r_out: start.length() };
            let accuracy = Accuracy { precision, ..ACCURACY };
            for spacetime in [&HOLE, &SpacetimeKind::Flat] {
                let end = trace(spacetime, &ray, &accuracy).unwrap().crossing.unwrap();
                assert!(
                    end.position.distance(start) < 1e-6 && end.time < 1e-6 && end.swept < 1e-6,
                    "{end:?}"
                );
                assert!(end.direction.distance(ray.direction.normalize()) < 1e-6, "{end:?}");
            }
        }
    }

    #[test]
    fn a_line_is_the_limit_of_rays_around_a_small_hole() {
        let small = SpacetimeKind::black_hole(DVec3::ZERO, 1e-13);
        let cases = [
            ray([3.0, 1.0, -2.0], [0.1, 2.0, 0.3], 7.0),
            ray([3.0, 1.0, -2.0], [-3.0, 0.5, 0.3], 7.0),
            ray([3.0, 1.0, -12.0], [-0.3, 0.2, 1.3], 7.0),
            ray([3.0, 1.0, -12.0], [3.3, 0.2, 1.3], 7.0),
            ray([3.0, 1.0, -12.0], [-0.3, 0.2, -1.3], 7.0),
        ];
        for ray in cases {
            let (line, orbit) = (exit(&SpacetimeKind::Flat, ray), exit(&small, ray));
            assert_eq!(line.status, orbit.status);
            let close =
                |a: f64, b: f64| assert!((a - b).abs() < 1e-11 * (1.0 + b.abs()), "{line:?} {orbit:?}");
            close(line.b, orbit.b);
            assert_eq!(line.r_min.is_some(), orbit.r_min.is_some());
            close(line.r_min.unwrap_or_default(), orbit.r_min.unwrap_or_default());
            let (Some(a), Some(b)) = (line.crossing, orbit.crossing) else { continue };
            assert!(a.position.distance(b.position) < 1e-11 && a.direction.distance(b.direction) < 1e-11);
            close(a.time, b.time);
            close(a.swept, b.swept);
            close(a.sens, b.sens);
        }
    }

    #[test]
    fn a_hole_elsewhere_moves_the_ray_with_it() {
        let center = DVec3::new(4.0, -8.0, 2.0);
        let ray = ray([3.0, 1.0, -2.0], [-3.0, 2.5, 0.0], 7.0);
        let there = SpacetimeKind::black_hole(center, 1.0);
        let moved = exit(&there, FreeRay { start: ray.start + center, ..ray }).crossing.unwrap();
        let here = exit(&HOLE, ray).crossing.unwrap();
        assert_eq!(moved, Crossing { position: here.position + center, ..here });
    }

    #[test]
    fn sens_is_the_derivative_of_the_end() {
        let ray = ray([6.0, 0.0, 0.0], [-1.0, 0.5, 0.0], 20.0);
        let end = |turn: f64| {
            let direction = DVec3::new(-1.0, 0.5, 0.0).rotate_z(turn);
            exit(&HOLE, FreeRay { direction, ..ray }).crossing.unwrap()
        };
        let (middle, before, after) = (end(0.0), end(-1e-6), end(1e-6));
        let turned = before.position.angle_between(after.position) / 2e-6;
        let bent = before.direction.angle_between(after.direction) / 2e-6;
        assert!((middle.sens / turned.max(bent) - 1.0).abs() < 1e-4, "{} {turned} {bent}", middle.sens);
    }

    #[test]
    fn what_is_no_ray_is_refused() {
        let good = ray([3.0, 1.0, -2.0], [1.0, 0.0, 0.0], 7.0);
        let far = DVec3::splat(1e200);
        let cases = [
            (FreeRay { direction: DVec3::ZERO, ..good }, Input::Columns(&DIRECTION)),
            (FreeRay { direction: DVec3::NAN, ..good }, Input::Columns(&DIRECTION)),
            (FreeRay { direction: far, ..good }, Input::Columns(&DIRECTION)),
            (FreeRay { start: DVec3::ZERO, ..good }, Input::Columns(&START)),
            (FreeRay { start: far, ..good }, Input::Columns(&START)),
            (FreeRay { start: DVec3::X * 0.25, ..good }, Input::Columns(&START)),
            (FreeRay { r_out: 0.0, ..good }, Input::Columns(&SPHERE)),
            (FreeRay { r_out: f64::NAN, ..good }, Input::Columns(&SPHERE)),
        ];
        for (ray, input) in cases {
            assert_eq!(trace(&HOLE, &ray, &ACCURACY).unwrap_err().input, input, "{ray:?}");
        }
        let anti = SpacetimeKind::black_hole(DVec3::ZERO, -1.0);
        assert_eq!(trace(&anti, &good, &ACCURACY).unwrap_err().input, Input::Parameter("rs"));
        let paper = Accuracy { stepper: StepperKind::Rk4Paper, ..ACCURACY };
        assert_eq!(trace(&HOLE, &good, &paper).unwrap_err().input, Input::Stepper);
    }

    #[test]
    fn extreme_rays_end_somewhere_and_in_numbers() {
        for (precision, huge) in [(Precision::F32, 1e15), (Precision::F64, 1e70)] {
            let accuracy = Accuracy { precision, ..ACCURACY };
            for start in [0.250_001, 0.3, 1.0, 1e8, huge] {
                for direction in
                    [[1.0, 0.0, 0.0], [-1.0, 1e-9, 0.0], [0.0, 1.0, 0.0], [-1.0, 1.0 / huge, 0.0]]
                {
                    for r_out in [1.0 / huge, 0.2, 1.0, huge] {
                        let ray = ray([start, 0.0, 0.0], direction, r_out);
                        let end = trace(&HOLE, &ray, &accuracy).unwrap();
                        let finite =
                            end.crossing.is_none_or(|c| c.position.is_finite() && c.time.is_finite());
                        assert!(finite, "{ray:?} {precision:?}: {end:?}");
                    }
                }
            }
        }
    }
}
