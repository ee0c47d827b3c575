//! The trade of speed for accuracy: errors and costs of ways to integrate rays, all measured on one scene.

use std::sync::atomic::AtomicBool;

use glam::{DVec2, DVec3};

use crate::geodesic::Control;
use crate::geometry::{Geometry, PrimitiveId};
use crate::scene::{Baked, Filter, Precision, Schedule, Settings, StepperKind};
use crate::trace::{self, Fate, Ray, Run, Shot, Stats, shoot, transport::Outcome};

/// A way to integrate rays.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Setting {
    /// The stepper.
    pub stepper: StepperKind,
    /// Its tolerance, radians; `None` for a stepper that knows none.
    pub tolerance: Option<f64>,
    /// Numbers that orbits are followed in.
    pub precision: Precision,
    /// The schedule.
    pub schedule: Schedule,
}

/// What is measured, and how often.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// The settings.
    pub settings: Vec<Setting>,
    /// Times that each cost is measured; the median counts.
    pub rounds: u32,
    /// Samples per pixel of the path-traced pictures whose speed is measured.
    pub spp: u32,
    /// Worker threads; 0 means one per core.
    pub threads: usize,
}

/// Size of many errors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spread {
    /// Root of the mean square.
    pub rmse: f64,
    /// Median.
    pub median: f64,
    /// 99th percentile.
    pub p99: f64,
    /// Largest.
    pub max: f64,
}

/// How far rays end from where they should, over those that end in the right way; `None` if none do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Errors {
    /// Rays compared.
    pub rays: usize,
    /// Share of the rays that have another fate or meet another entity than they should.
    pub differ: f64,
    /// Distance between landings, scene units.
    pub position: Option<Spread>,
    /// Angle between directions at landings or at infinity, radians.
    pub direction: Option<Spread>,
    /// Distance between landings, or angle at infinity, in pixels at the straight distance of the landing.
    pub footprint: Option<Spread>,
}

/// What rays cost; medians over the rounds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cost {
    /// Thread time of a camera ray by itself, nanoseconds.
    pub ns_per_ray: f64,
    /// Camera paths traced to their end, per second, on all threads.
    pub paths_per_second: f64,
    /// March steps per ray of these paths.
    pub steps_per_ray: f64,
    /// BVH queries per ray of these paths.
    pub queries_per_ray: f64,
}

/// A setting, measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measurement {
    /// The setting.
    pub setting: Setting,
    /// Its errors.
    pub errors: Errors,
    /// Its cost.
    pub cost: Cost,
}

/// Tolerance of the reference, radians.
const EXACT: f64 = 1e-12;
/// Arc tolerance of the reference relative to that of the settings under study.
const EXACT_ARC: f64 = 1e-4;
/// Camera rays per pixel whose time is measured.
const CAMERA_SPP: u32 = 8;

impl Setting {
    /// All combinations, but only tolerances that a precision has, and for the paper's stepper, which knows neither, one
    /// setting per schedule.
    pub fn grid(
        steppers: &[StepperKind],
        precisions: &[Precision],
        tolerances: &[f64],
        schedules: &[Schedule],
    ) -> Vec<Self> {
        let mut settings = Vec::new();
        for &schedule in schedules {
            for &stepper in steppers {
                if stepper == StepperKind::Rk4Paper {
                    settings.push(Self { stepper, tolerance: None, precision: Precision::F64, schedule });
                    continue;
                }
                for &precision in precisions {
                    let tolerances = tolerances_for(precision, tolerances).map(Some);
                    settings.extend(tolerances.map(|tolerance| Self {
                        stepper,
                        tolerance,
                        precision,
                        schedule,
                    }));
                }
            }
        }
        settings
    }

    /// `base` with this setting in it.
    fn over(&self, base: &Settings) -> Settings {
        let Self { stepper, tolerance, precision, schedule } = *self;
        let tolerance = tolerance.unwrap_or(base.tolerance);
        Settings { stepper, tolerance, precision, schedule, ..base.clone() }
    }
}

/// Those of `tolerances` to which rays in numbers of `precision` can be held.
pub(super) fn tolerances_for(precision: Precision, tolerances: &[f64]) -> impl Iterator<Item = f64> {
    let least = match precision {
        Precision::F32 => Control::<f32>::least_tolerance(),
        Precision::F64 => Control::<f64>::least_tolerance(),
    };
    tolerances.iter().copied().filter(move |&tolerance| tolerance >= least)
}

/// Measures all settings of `plan` on `scene`, in the size that its settings say; `progress` is told how many of how
/// many runs are done.
pub fn sweep(mut scene: Baked, plan: &Plan, progress: &dyn Fn(usize, usize)) -> Vec<Measurement> {
    let base = Settings { filter: Filter::Box, ..scene.settings.clone() };
    scene.settings = Settings {
        stepper: Settings::default().stepper,
        tolerance: EXACT,
        precision: Precision::F64,
        arc_tolerance: Some(EXACT_ARC * scene.arc_tolerance()),
        ..base.clone()
    };
    let reference = Reference::of_pixels(&scene);
    let mut errors = Vec::new();
    for setting in &plan.settings {
        scene.settings = setting.over(&base);
        errors.push(reference.errors(&scene));
    }
    let costs = in_turn(plan.settings.len(), plan.rounds, progress, |index| {
        scene.settings = plan.settings[index].over(&base);
        Cost::measure(&mut scene, plan)
    });
    let measured = plan.settings.iter().zip(errors).zip(costs);
    measured
        .map(|((&setting, errors), costs)| Measurement { setting, errors, cost: Cost::median(&costs) })
        .collect()
}

/// What `measure` gives of each of `count` things in each of `rounds`: all in turn, round after round, so that a machine
/// that is slow for a while slows all of them. `progress` is told how many of how many runs are done.
pub(super) fn in_turn<T>(
    count: usize,
    rounds: u32,
    progress: &dyn Fn(usize, usize),
    mut measure: impl FnMut(usize) -> T,
) -> Vec<Vec<T>> {
    let mut measured: Vec<Vec<T>> = (0..count).map(|_| Vec::new()).collect();
    let runs = count * rounds as usize;
    for run in 0..runs {
        progress(run, runs);
        measured[run % count].push(measure(run % count));
    }
    progress(runs, runs);
    measured
}

/// Rays and where they should end.
struct Reference {
    rays: Vec<Ray>,
    ends: Vec<Shot>,
    /// Where distances are seen from.
    eye: DVec3,
    /// Angle of a pixel, radians.
    pixel: f64,
}

impl Reference {
    /// The rays through the pixel centres of `scene`'s camera, followed as its settings say.
    fn of_pixels(scene: &Baked) -> Self {
        let (width, height) = (scene.settings.width, scene.settings.height);
        let size = DVec2::new(width as f64, height as f64);
        let center = |index: usize| DVec2::new((index % width) as f64 + 0.5, (index / width) as f64 + 0.5);
        let rays: Vec<Ray> = (0..width * height)
            .map(|index| {
                let (position, direction) = scene.camera.ray(center(index) / size, size.x / size.y);
                Ray { position, direction, leaves: PrimitiveId::NONE }
            })
            .collect();
        let ends = shoot(scene, &rays);
        Self { rays, ends, eye: scene.camera.position, pixel: 2.0 * scene.camera.tan_half_fov / size.y }
    }

    /// The errors of the rays as `scene`'s settings let them go.
    fn errors(&self, scene: &Baked) -> Errors {
        let (mut position, mut direction, mut footprint) = (Vec::new(), Vec::new(), Vec::new());
        let mut differ = 0;
        for (shot, exact) in shoot(scene, &self.rays).iter().zip(&self.ends) {
            if !alike(&scene.geometry, shot, exact) {
                differ += 1;
                continue;
            }
            match (shot.end, exact.end) {
                (Outcome::Landed(landing), Outcome::Landed(exact)) => {
                    let distance = landing.position.distance(exact.position);
                    position.push(distance);
                    direction.push(angle(landing.direction, exact.direction));
                    footprint.push(distance / (self.pixel * exact.position.distance(self.eye)));
                }
                (Outcome::Escaped(to), Outcome::Escaped(exact)) => {
                    let angle = angle(to, exact);
                    direction.push(angle);
                    footprint.push(angle / self.pixel);
                }
                _ => {}
            }
        }
        Errors {
            rays: self.rays.len(),
            differ: f64::from(differ) / self.rays.len() as f64,
            position: Spread::of(position),
            direction: Spread::of(direction),
            footprint: Spread::of(footprint),
        }
    }
}

/// Whether two rays have the same fate and, if they land, meet the same entity.
fn alike(geometry: &Geometry, a: &Shot, b: &Shot) -> bool {
    let entity = |shot: &Shot| match shot.end {
        Outcome::Landed(landing) => Some(geometry.surface(landing.primitive).entity),
        _ => None,
    };
    Fate::of(&a.end) == Fate::of(&b.end) && entity(a) == entity(b)
}

/// Angle between unit vectors, also where it is too small for its cosine.
pub(super) fn angle(a: DVec3, b: DVec3) -> f64 {
    2.0 * libm::asin((0.5 * a.distance(b)).min(1.0))
}

impl Spread {
    /// The spread of `values`; `None` if there are none.
    pub(super) fn of(mut values: Vec<f64>) -> Option<Self> {
        values.sort_by(f64::total_cmp);
        let count = values.len();
        let rmse = (values.iter().map(|value| value * value).sum::<f64>() / count as f64).sqrt();
        let at = |index: usize| values.get(index).copied();
        Some(Self { rmse, median: at(count / 2)?, p99: at(count * 99 / 100)?, max: *values.last()? })
    }
}

impl Cost {
    /// The cost under the settings of `scene`, measured once.
    fn measure(scene: &mut Baked, plan: &Plan) -> Self {
        let max_depth = scene.settings.max_depth;
        (scene.settings.max_depth, scene.settings.spp) = (1, CAMERA_SPP);
        let camera = stats(scene, plan.threads);
        (scene.settings.max_depth, scene.settings.spp) = (max_depth, plan.spp);
        let full = stats(scene, plan.threads);
        Self {
            ns_per_ray: 1e9 * camera.seconds * camera.threads as f64 / camera.counters.rays as f64,
            paths_per_second: full.paths_per_second,
            steps_per_ray: full.steps_per_ray,
            queries_per_ray: full.queries_per_ray,
        }
    }

    fn median(costs: &[Self]) -> Self {
        let median = |value: fn(&Self) -> f64| {
            Spread::of(costs.iter().map(value).collect()).map_or(f64::NAN, |spread| spread.median)
        };
        Self {
            ns_per_ray: median(|cost| cost.ns_per_ray),
            paths_per_second: median(|cost| cost.paths_per_second),
            steps_per_ray: median(|cost| cost.steps_per_ray),
            queries_per_ray: median(|cost| cost.queries_per_ray),
        }
    }
}

fn stats(scene: &Baked, threads: usize) -> Stats {
    let run = Run { threads, ..Run::default() };
    trace::render(scene, &run, &AtomicBool::new(false), &|_| {}).stats
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stepper_without_tolerance_is_measured_once_per_schedule() {
        let grid = Setting::grid(
            &[StepperKind::Rkn6, StepperKind::Rk4Paper],
            &[Precision::F64, Precision::F32],
            &[1e-2, 1e-6],
            &[Schedule::Wavefront, Schedule::PerPixel],
        );
        assert_eq!(grid.len(), 8);
        assert_eq!(grid.iter().filter(|setting| setting.tolerance.is_none()).count(), 2);
        assert_eq!(grid.iter().filter(|setting| setting.precision == Precision::F32).count(), 2);
    }

    #[test]
    fn spreads_are_those_of_textbooks() {
        let spread = Spread::of((0..=200).rev().map(f64::from).collect()).unwrap();
        assert_eq!((spread.median, spread.p99, spread.max), (100.0, 198.0, 200.0));
        assert_eq!(Spread::of(vec![3.0, 4.0]).unwrap().rmse, 12.5f64.sqrt());
        assert_eq!(Spread::of(Vec::new()), None);
    }

    #[test]
    fn small_angles_keep_their_digits() {
        let tilted = DVec3::new(1e-10, 0.0, 1.0).normalize();
        assert!((angle(DVec3::Z, tilted) - 1e-10).abs() < 1e-20);
    }
}
