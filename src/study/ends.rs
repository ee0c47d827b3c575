//! The trade of speed for accuracy where nothing is in the way of rays: errors and costs of ways to follow them, against
//! where they end exactly.

use std::hint::black_box;
use std::time::Instant;

use glam::DVec3;
use rayon::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};

use super::free::{self, Accuracy, Arrival, Fault, FreeRay, Status};
use super::sweep::{Spread, angle, in_turn, tolerances_for};
use crate::scene::{Precision, StepperKind};
use crate::spacetime::SpacetimeKind;

/// A ray, and how it ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Case {
    /// What it runs in.
    pub spacetime: SpacetimeKind,
    /// The ray.
    pub ray: FreeRay,
    /// How it ends.
    pub exact: Exact,
}

/// How a ray ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Exact {
    /// How.
    pub status: Status,
    /// Where it crosses its sphere, if it escapes.
    pub crossing: Option<Crossing>,
}

/// Where a ray crosses its sphere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crossing {
    /// Where, in the chart.
    pub position: DVec3,
    /// Unit direction of travel.
    pub direction: DVec3,
    /// Radians there per radian of the starting direction.
    pub sens: f64,
}

/// What is measured, and how often.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// The ways to follow rays.
    pub settings: Vec<Accuracy>,
    /// Times that each cost is measured; the median counts.
    pub rounds: u32,
    /// Worker threads; 0 means one per core.
    pub threads: usize,
}

/// How far rays end from where they should.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Errors {
    /// Rays.
    pub rays: usize,
    /// Those of them that escape and should; the errors are theirs.
    pub compared: usize,
    /// Share of the rays that have another fate than they should.
    pub differ: f64,
    /// Angle between directions, radians.
    pub direction: Option<Spread>,
    /// The same over the ray's sensitivity: radians at its start.
    pub direction_over_sens: Option<Spread>,
    /// Distance between positions over the radius of the sphere.
    pub position: Option<Spread>,
    /// The same over the ray's sensitivity.
    pub position_over_sens: Option<Spread>,
    /// Whether the tolerance is what it says.
    pub honesty: Option<Honesty>,
}

/// Errors of direction or position, the larger, relative to the tolerance times the sensitivity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Honesty {
    /// Share of the rays for which they exceed 1.
    pub above: f64,
    /// The largest.
    pub worst: f64,
}

/// A way to follow rays, measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measurement {
    /// Which one.
    pub setting: Accuracy,
    /// Its errors.
    pub errors: Errors,
    /// Thread time of a ray, nanoseconds; the median over the rounds.
    pub ns_per_ray: f64,
    /// Steps tried per ray.
    pub steps_per_ray: f64,
}

/// A ray that cannot be followed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("ray {index}: {fault}")]
pub struct Refusal {
    /// Which one.
    pub index: usize,
    /// Why not.
    pub fault: Fault,
}

/// How rays are followed whose ends are not known.
const EXACT: Accuracy =
    Accuracy { stepper: StepperKind::Dop853, tolerance: 1e-13, precision: Precision::F64 };
/// Least duration of a measurement, seconds.
const LEAST_SECONDS: f64 = 0.05;
/// Rays that a thread takes at once.
const GRAIN: usize = 64;

impl Exact {
    /// The end of `ray` as the most exact stepper finds it.
    ///
    /// # Errors
    /// As [`free::trace`].
    pub fn followed(spacetime: SpacetimeKind, ray: &FreeRay) -> Result<Self, Fault> {
        let exit = free::trace(spacetime, ray, &EXACT)?;
        let crossing = exit.crossing.map(|crossing| Crossing {
            position: crossing.position,
            direction: crossing.direction,
            sens: crossing.sens,
        });
        Ok(Self { status: exit.status, crossing })
    }
}

/// All combinations, but only tolerances that a precision has; none of the paper's stepper, which knows no orbits.
pub fn grid(steppers: &[StepperKind], precisions: &[Precision], tolerances: &[f64]) -> Vec<Accuracy> {
    let mut settings = Vec::new();
    for &stepper in steppers.iter().filter(|&&stepper| stepper != StepperKind::Rk4Paper) {
        for &precision in precisions {
            let tolerances = tolerances_for(precision, tolerances);
            settings.extend(tolerances.map(|tolerance| Accuracy { stepper, tolerance, precision }));
        }
    }
    settings
}

/// Measures all settings of `plan` on `cases`; `progress` is told how many of how many runs are done.
///
/// # Errors
/// If a ray cannot be followed.
pub fn sweep(
    cases: &[Case],
    plan: &Plan,
    progress: &dyn Fn(usize, usize),
) -> Result<Vec<Measurement>, Refusal> {
    let bench = Bench { cases, pool: ThreadPoolBuilder::new().num_threads(plan.threads).build().ok() };
    let mut measurements = Vec::new();
    for &setting in &plan.settings {
        let arrivals = bench.arrivals(&setting)?;
        let steps: f64 = arrivals.iter().map(|arrival| f64::from(arrival.steps)).sum();
        measurements.push(Measurement {
            setting,
            errors: Errors::of(cases, &arrivals, setting.tolerance),
            ns_per_ray: f64::NAN,
            steps_per_ray: steps / cases.len() as f64,
        });
    }
    let mut repeats = vec![1; plan.settings.len()];
    let times = in_turn(plan.settings.len(), plan.rounds, progress, |index| {
        bench.ns_per_ray(&plan.settings[index], &mut repeats[index])
    });
    for (measurement, times) in measurements.iter_mut().zip(times) {
        measurement.ns_per_ray = Spread::of(times).map_or(f64::NAN, |spread| spread.median);
    }
    Ok(measurements)
}

/// Rays, and who follows them.
struct Bench<'a> {
    cases: &'a [Case],
    /// Without one, rayon's own.
    pool: Option<ThreadPool>,
}

impl Bench<'_> {
    fn install<T: Send>(&self, work: impl FnOnce() -> T + Send) -> T {
        match &self.pool {
            Some(pool) => pool.install(work),
            None => work(),
        }
    }

    fn arrivals(&self, accuracy: &Accuracy) -> Result<Vec<Arrival>, Refusal> {
        let arrive = |(index, case): (usize, &Case)| {
            free::arrive(case.spacetime, &case.ray, accuracy).map_err(|fault| Refusal { index, fault })
        };
        self.install(|| self.cases.par_iter().enumerate().map(arrive).collect())
    }

    /// Thread time of a ray, nanoseconds, over as many `repeats` of all rays as it takes, which are kept for next time.
    fn ns_per_ray(&self, accuracy: &Accuracy, repeats: &mut usize) -> f64 {
        let count = self.cases.len();
        loop {
            let rays = count * *repeats;
            let started = Instant::now();
            self.install(|| {
                (0..rays).into_par_iter().with_min_len(GRAIN).for_each(|index| {
                    let case = &self.cases[index % count];
                    let _ = black_box(free::arrive(case.spacetime, &case.ray, accuracy));
                });
            });
            let seconds = started.elapsed().as_secs_f64();
            if seconds >= LEAST_SECONDS {
                let threads = self.install(rayon::current_num_threads);
                return 1e9 * seconds * threads as f64 / rays as f64;
            }
            // A little more than it takes by this measurement, which may be one of a cold start.
            let factor = (1.2 * LEAST_SECONDS / seconds.max(1e-6)).min(100.0);
            *repeats = (*repeats as f64 * factor).ceil() as usize;
        }
    }
}

impl Errors {
    fn of(cases: &[Case], arrivals: &[Arrival], tolerance: f64) -> Self {
        let (mut direction, mut direction_over_sens) = (Vec::new(), Vec::new());
        let (mut position, mut position_over_sens) = (Vec::new(), Vec::new());
        let mut differ = 0;
        let (mut above, mut worst) = (0, 0.0_f64);
        for (Case { ray, exact, .. }, arrival) in cases.iter().zip(arrivals) {
            if arrival.status != exact.status {
                differ += 1;
                continue;
            }
            let (Some((x, d)), Some(exact)) = (arrival.crossing, exact.crossing) else { continue };
            let (turned, off) = (angle(d, exact.direction), x.distance(exact.position) / ray.r_out);
            direction.push(turned);
            direction_over_sens.push(turned / exact.sens);
            position.push(off);
            position_over_sens.push(off / exact.sens);
            let ratio = turned.max(off) / (tolerance * exact.sens);
            above += usize::from(ratio > 1.0);
            worst = worst.max(ratio);
        }
        let (rays, compared) = (cases.len(), direction.len());
        let share = |count: usize, of: usize| count as f64 / of as f64;
        Self {
            rays,
            compared,
            differ: share(differ, rays),
            honesty: (compared > 0).then(|| Honesty { above: share(above, compared), worst }),
            direction: Spread::of(direction),
            direction_over_sens: Spread::of(direction_over_sens),
            position: Spread::of(position),
            position_over_sens: Spread::of(position_over_sens),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn case(sens: f64) -> Case {
        let ray = FreeRay { start: DVec3::X, direction: DVec3::X, r_out: 2.0 };
        let crossing = Crossing { position: 2.0 * DVec3::X, direction: DVec3::X, sens };
        let exact = Exact { status: Status::Escaped, crossing: Some(crossing) };
        Case { spacetime: SpacetimeKind::Flat, ray, exact }
    }

    #[test]
    fn errors_are_those_computed_by_hand() {
        let arrival = |status, off: f64| Arrival {
            status,
            crossing: (status == Status::Escaped).then(|| (DVec3::new(2.0, off, 0.0), DVec3::X)),
            steps: 1,
        };
        let cases = [case(1.0), case(10.0), case(1.0), case(1.0)];
        let arrivals = [
            arrival(Status::Escaped, 0.02),
            arrival(Status::Escaped, 0.02),
            arrival(Status::Captured, 0.0),
            arrival(Status::Escaped, 0.0),
        ];
        let errors = Errors::of(&cases, &arrivals, 5e-3);
        assert_eq!((errors.rays, errors.compared, errors.differ), (4, 3, 0.25));
        assert_eq!(errors.direction.unwrap().max, 0.0);
        assert_eq!(errors.position.unwrap().max, 0.01);
        assert_eq!(errors.position_over_sens.unwrap().median, 0.001);
        assert_eq!(errors.honesty, Some(Honesty { above: 1.0 / 3.0, worst: 2.0 }));
        assert_eq!(Errors::of(&cases[2..3], &arrivals[2..3], 1.0).honesty, None);
    }

    #[test]
    fn single_precision_has_no_fine_tolerances() {
        let grid = grid(
            &[StepperKind::Rkn6, StepperKind::Rk4Paper],
            &[Precision::F64, Precision::F32],
            &[1e-4, 1e-5, 1e-6],
        );
        let tolerances = |precision| {
            let of = grid.iter().filter(|setting| setting.precision == precision);
            of.map(|setting| setting.tolerance).collect::<Vec<_>>()
        };
        assert_eq!(tolerances(Precision::F64), [1e-4, 1e-5, 1e-6]);
        assert_eq!(tolerances(Precision::F32), [1e-4]);
    }
}
