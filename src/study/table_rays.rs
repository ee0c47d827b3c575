//! The trade of speed for accuracy where nothing is in the way of rays: errors and costs of ways to follow them,
//! against where they end exactly.

use std::hint::black_box;

use rayon::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};

use super::errors::{Spread, angle, median};
use super::free::{Accuracy, Arrival, Cells, FreeRayEnd, SphereCrossing, TableForm, Traced};
use super::input_error::InputError;
use super::report::Report;
use super::rounds::Study;
use super::table::{NONE, TableRow, percent, scientific};
use super::trade_off::{self, TradeOff, broad, over_front, through};
use super::way::Way;
use crate::plot::{Diagram, Figure};
use crate::scene::{Precision, StepperKind};
use crate::spacetime::SpacetimeKind;
use crate::trace::cpu_clock;

/// A ray, and how it ends.
#[derive(Clone, Debug, PartialEq)]
pub struct Case {
    /// Spacetime that it runs in.
    pub spacetime: SpacetimeKind,
    /// Cells that describe the ray.
    pub ray: Cells,
    /// Exact end.
    pub exact: Exact,
}

/// Exact end of a ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Exact {
    /// Status at the end.
    pub status: FreeRayEnd,
    /// Crossing of its sphere, if it escapes.
    pub crossing: Option<SphereCrossing>,
}

/// Errors of the ends of rays.
#[derive(Clone, Copy, Debug, PartialEq)]
struct TableRayErrors {
    /// Rays.
    rays: usize,
    /// Those of them that escape and should; the errors are theirs.
    compared: usize,
    /// Share of the rays that have another fate than they should.
    differ: f64,
    /// Angle between directions, radians.
    direction: Option<Spread>,
    /// Angle between directions over the ray's sensitivity: radians at its start.
    direction_over_sens: Option<Spread>,
    /// Distance between positions over the radius of the sphere.
    position: Option<Spread>,
    /// Distance between positions over the radius of the sphere and the ray's sensitivity.
    position_over_sens: Option<Spread>,
    /// Honesty of the tolerance: errors relative to it.
    honesty: Option<Honesty>,
}

/// Errors of direction or position, the larger, relative to the tolerance times the sensitivity.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Honesty {
    /// Share of the rays for which they exceed 1.
    above: f64,
    /// The largest.
    worst: f64,
}

/// A way to follow rays, measured.
#[derive(Clone, Copy, Debug, PartialEq)]
struct TableRayMeasurement {
    setting: Accuracy,
    errors: TableRayErrors,
    /// CPU time of a ray, nanoseconds; the median over the rounds.
    ns_per_ray: f64,
    /// Steps tried per ray.
    steps_per_ray: f64,
}

/// A ray that cannot be followed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("ray {index}: {fault}")]
pub struct TableRayError {
    /// Its number.
    pub index: usize,
    /// Fault of the ray.
    pub fault: InputError,
}

/// Accuracy with which rays are followed whose ends are not known.
const EXACT: Accuracy =
    Accuracy { stepper: StepperKind::Dop853, tolerance: 1e-13, precision: Precision::F64 };
/// Least duration of a measurement, seconds.
const LEAST_SECONDS: f64 = 0.05;
/// Rays that a thread takes at once.
const GRAIN: usize = 64;
/// Size of one diagram, points.
const DIAGRAM: [f64; 2] = [520.0, 460.0];

impl Exact {
    /// The end of `ray` as the most exact stepper finds it.
    ///
    /// # Errors
    /// As [`TableForm::trace`].
    pub fn followed(form: &TableForm, spacetime: &SpacetimeKind, ray: &Cells) -> Result<Self, InputError> {
        let Traced { status, crossing, .. } = (form.trace)(spacetime, ray, &EXACT)?;
        Ok(Self { status, crossing })
    }
}

/// Rays that are followed in all settings.
pub struct TableRays<'a> {
    form: &'static TableForm,
    cases: &'a [Case],
    settings: Vec<Accuracy>,
    /// Without one, rayon's own.
    pool: Option<ThreadPool>,
    /// Of the settings: errors, and steps tried per ray.
    found: Vec<(TableRayErrors, f64)>,
    /// Number of times that all rays are followed in one measurement, by setting.
    repeats: Vec<usize>,
}

impl Study for TableRays<'_> {
    type Sample = f64;
    type Findings = Report;
    type Error = TableRayError;

    fn settings(&self) -> usize {
        self.settings.len()
    }

    fn prepare(&mut self, setting: usize) -> Result<(), TableRayError> {
        let accuracy = self.settings[setting];
        let arrivals = self.arrivals(&accuracy)?;
        let steps: f64 = arrivals.iter().map(|arrival| f64::from(arrival.steps)).sum();
        let errors = TableRayErrors::of(self.form, self.cases, &arrivals, accuracy.tolerance);
        self.found.push((errors, steps / self.cases.len() as f64));
        Ok(())
    }

    /// CPU time of a ray, nanoseconds, over as many repeats of all rays as it takes, which are kept for next time.
    fn measure(&mut self, setting: usize) -> Result<f64, TableRayError> {
        let count = self.cases.len();
        loop {
            let rays = count * self.repeats[setting];
            let seconds = self.seconds(&self.settings[setting], rays);
            if seconds >= LEAST_SECONDS {
                return Ok(1e9 * seconds / rays as f64);
            }
            // A little more than it takes by this measurement, which may be one of a cold start.
            let factor = (1.2 * LEAST_SECONDS / seconds.max(1e-6)).min(100.0);
            self.repeats[setting] = (self.repeats[setting] as f64 * factor).ceil() as usize;
        }
    }

    fn conclude(self, samples: Vec<Vec<f64>>) -> Report {
        let measured = self.settings.iter().zip(&self.found).zip(&samples);
        let measurements: Vec<TableRayMeasurement> = measured
            .map(|((&setting, &(errors, steps_per_ray)), times)| TableRayMeasurement {
                setting,
                errors,
                ns_per_ray: median(times, |time| *time),
                steps_per_ray,
            })
            .collect();
        trade_off::report(&measurements)
    }
}

impl<'a> TableRays<'a> {
    /// A study of `settings` on `cases` of a form; 0 `threads` means one per core.
    pub fn new(form: &'static TableForm, cases: &'a [Case], settings: Vec<Accuracy>, threads: usize) -> Self {
        let pool = ThreadPoolBuilder::new().num_threads(threads).build().ok();
        let repeats = vec![1; settings.len()];
        Self { form, cases, settings, pool, found: Vec::new(), repeats }
    }

    fn install<T: Send>(&self, work: impl FnOnce() -> T + Send) -> T {
        match &self.pool {
            Some(pool) => pool.install(work),
            None => work(),
        }
    }

    fn arrivals(&self, accuracy: &Accuracy) -> Result<Vec<Arrival>, TableRayError> {
        let arrive = |(index, case): (usize, &Case)| {
            (self.form.arrive)(&case.spacetime, &case.ray, accuracy)
                .map_err(|fault| TableRayError { index, fault })
        };
        self.install(|| self.cases.par_iter().enumerate().map(arrive).collect())
    }

    /// CPU time in which `rays` rays are followed, round and round through the cases.
    fn seconds(&self, accuracy: &Accuracy, rays: usize) -> f64 {
        let started = cpu_clock::of_process();
        self.install(|| {
            (0..rays).into_par_iter().with_min_len(GRAIN).for_each(|index| {
                let case = &self.cases[index % self.cases.len()];
                let _ = black_box((self.form.arrive)(&case.spacetime, &case.ray, accuracy));
            });
        });
        cpu_clock::of_process().saturating_sub(started).as_secs_f64()
    }
}

impl TableRayErrors {
    fn of(form: &TableForm, cases: &[Case], arrivals: &[Arrival], tolerance: f64) -> Self {
        let (mut direction, mut direction_over_sens) = (Vec::new(), Vec::new());
        let (mut position, mut position_over_sens) = (Vec::new(), Vec::new());
        let mut differ = 0;
        let (mut above, mut worst) = (0, 0.0_f64);
        for (Case { spacetime, ray, exact }, arrival) in cases.iter().zip(arrivals) {
            if arrival.status != exact.status {
                differ += 1;
                continue;
            }
            let (Some((x, d)), Some(exact)) = (arrival.crossing, exact.crossing) else { continue };
            let (turned, off) =
                (angle(d, exact.direction), x.distance(exact.position) / (form.radius)(spacetime, ray));
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

impl TradeOff for TableRayMeasurement {
    /// 99th percentile of the error of direction at the start, radians, and time per ray, nanoseconds.
    fn place(&self) -> [f64; 2] {
        [self.errors.direction_over_sens.map_or(f64::NAN, |spread| spread.p99), self.ns_per_ray]
    }

    fn way(&self) -> Way {
        self.setting.into()
    }

    fn printed(&self, row: TableRow) -> TableRow {
        let errors = &self.errors;
        let honest = |text: fn(Honesty) -> String| errors.honesty.map_or(NONE.to_owned(), text);
        row.cell("median/sens", scientific(errors.direction_over_sens.map(|spread| spread.median), 1))
            .cell("99 %/sens", scientific(errors.direction_over_sens.map(|spread| spread.p99), 1))
            .cell("max/sens", scientific(errors.direction_over_sens.map(|spread| spread.max), 1))
            .cell("above tolerance", honest(|honesty| percent(honesty.above)))
            .cell("worst", honest(|honesty| format!("{:.2}", honesty.worst)))
            .cell("wrong fate", percent(errors.differ))
            .cell("ns/ray", format!("{:.0}", self.ns_per_ray))
            .cell("steps/ray", format!("{:.2}", self.steps_per_ray))
    }

    fn row(&self, row: TableRow) -> TableRow {
        let errors = &self.errors;
        let parts = [Spread::MEDIAN, Spread::P99, Spread::MAX];
        row.cell("rays", errors.rays)
            .cell("compared", errors.compared)
            .cell("differ", errors.differ)
            .spread("direction", errors.direction, parts)
            .spread("direction_over_sens", errors.direction_over_sens, parts)
            .spread("position", errors.position, parts)
            .spread("position_over_sens", errors.position_over_sens, parts)
            .maybe("above_tolerance", errors.honesty.map(|honesty| honesty.above))
            .maybe("worst_over_tolerance", errors.honesty.map(|honesty| honesty.worst))
            .cell("ns_per_ray", self.ns_per_ray)
            .cell("steps_per_ray", self.steps_per_ray)
    }

    /// Work against precision, time per ray over the 99th percentile of the error; and the largest error over the
    /// tolerance.
    fn figure(all: &[Self]) -> Figure {
        let at = |place: &dyn Fn(&Self) -> [f64; 2]| -> Vec<(Way, [f64; 2])> {
            all.iter().map(|m| (m.way(), place(m))).collect()
        };
        let error = "angle at the end / sens (radians)";
        let largest =
            |m: &TableRayMeasurement| m.errors.direction_over_sens.map_or(f64::NAN, |spread| spread.max);
        let kept = at(&|m| [m.setting.tolerance, largest(m)]);
        let allowed = all.iter().map(|m| [m.setting.tolerance; 2]).collect();
        let diagrams = vec![
            over_front(
                "Work and precision, 99 % of the rays",
                [error, "time per ray (ns)"],
                DIAGRAM,
                &at(&TableRayMeasurement::place),
            ),
            Diagram::log_log(
                "Largest error (grey: the tolerance)",
                ["tolerance (radians)", error],
                DIAGRAM,
                through(&kept),
            )
            .over(broad("error = tolerance", allowed)),
        ];
        Figure { diagrams }
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;

    fn case(sens: f64) -> Case {
        let ray = Cells { needed: vec![1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 2.0], optional: Vec::new() };
        let crossing = SphereCrossing { position: 2.0 * DVec3::X, direction: DVec3::X, sens };
        let exact = Exact { status: FreeRayEnd::Escaped, crossing: Some(crossing) };
        Case { spacetime: SpacetimeKind::Flat, ray, exact }
    }

    #[test]
    fn errors_are_those_computed_by_hand() {
        let arrival = |status, off: f64| Arrival {
            status,
            crossing: (status == FreeRayEnd::Escaped).then(|| (DVec3::new(2.0, off, 0.0), DVec3::X)),
            steps: 1,
        };
        let cases = [case(1.0), case(10.0), case(1.0), case(1.0)];
        let arrivals = [
            arrival(FreeRayEnd::Escaped, 0.02),
            arrival(FreeRayEnd::Escaped, 0.02),
            arrival(FreeRayEnd::Captured, 0.0),
            arrival(FreeRayEnd::Escaped, 0.0),
        ];
        let form = TableForm::of(SpacetimeKind::Flat.entry());
        let errors = TableRayErrors::of(form, &cases, &arrivals, 5e-3);
        assert_eq!((errors.rays, errors.compared, errors.differ), (4, 3, 0.25));
        assert_eq!(errors.direction.unwrap().max, 0.0);
        assert_eq!(errors.position.unwrap().max, 0.01);
        assert_eq!(errors.position_over_sens.unwrap().median, 0.001);
        assert_eq!(errors.honesty, Some(Honesty { above: 1.0 / 3.0, worst: 2.0 }));
        assert_eq!(TableRayErrors::of(form, &cases[2..3], &arrivals[2..3], 1.0).honesty, None);
    }
}
