//! The trade of speed for accuracy on a scene: errors and costs of ways to follow the rays of its camera.

use std::convert::Infallible;

use glam::{DVec2, DVec3};

use super::errors::{Spread, angle, median};
use super::grid::grid;
use super::render::render;
use super::report::Report;
use super::rounds::Study;
use super::table::{NONE, Row, percent, scientific};
use super::trade_off::{self, Curve, TradeOff, over_front};
use crate::geometry::{Geometry, PrimitiveId};
use crate::plot::Figure;
use crate::scene::{Baked, Filter, Precision, Schedule, Settings, StepperKind, flag_name};
use crate::trace::{Fate, Ray, Run, Shot, Stats, shoot, transport::Outcome};

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

/// How far rays end from where they should, over those that end in the right way; `None` if none do.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Errors {
    /// Rays compared.
    rays: usize,
    /// Share of the rays that have another fate or meet another entity than they should.
    differ: f64,
    /// Distance between landings, scene units.
    position: Option<Spread>,
    /// Angle between directions at landings or at infinity, radians.
    direction: Option<Spread>,
    /// Distance between landings, or angle at infinity, in pixels at the straight distance of the landing.
    footprint: Option<Spread>,
}

/// What rays cost; medians over the rounds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cost {
    /// Thread time of a camera ray by itself, nanoseconds.
    ns_per_ray: f64,
    /// Camera paths traced to their end, per second, on all threads.
    paths_per_second: f64,
    /// March steps per ray of these paths.
    steps_per_ray: f64,
    /// BVH queries per ray of these paths.
    queries_per_ray: f64,
}

/// A setting, measured.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Measurement {
    setting: Setting,
    errors: Errors,
    cost: Cost,
}

/// Tolerance of the reference, radians.
const EXACT: f64 = 1e-12;
/// Arc tolerance of the reference relative to that of the settings under study.
const EXACT_ARC: f64 = 1e-4;
/// Camera rays per pixel whose time is measured.
const CAMERA_SPP: u32 = 8;
/// Size of one diagram, points.
const CHART: [f64; 2] = [470.0, 420.0];

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
                let ways = grid(&[stepper], precisions, tolerances);
                settings.extend(ways.into_iter().map(|way| Self {
                    stepper,
                    tolerance: Some(way.tolerance),
                    precision: way.precision,
                    schedule,
                }));
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

/// A scene whose camera rays are followed in all settings.
pub struct CameraRays {
    scene: Baked,
    /// The scene's own settings.
    base: Settings,
    settings: Vec<Setting>,
    /// Samples per pixel of the path-traced pictures whose speed is measured.
    spp: u32,
    /// Worker threads; 0 means one per core.
    threads: usize,
    reference: Reference,
    /// Of the settings.
    errors: Vec<Errors>,
}

impl CameraRays {
    /// A study of `settings` on `scene`, in the size that its settings say, whose path-traced pictures have `spp` samples per
    /// pixel; 0 `threads` means one per core.
    pub fn new(mut scene: Baked, settings: Vec<Setting>, spp: u32, threads: usize) -> Self {
        let base = Settings { filter: Filter::Box, ..scene.settings.clone() };
        scene.settings = Settings {
            stepper: Settings::default().stepper,
            tolerance: EXACT,
            precision: Precision::F64,
            arc_tolerance: Some(EXACT_ARC * scene.arc_tolerance()),
            ..base.clone()
        };
        let reference = Reference::of_pixels(&scene);
        Self { scene, base, settings, spp, threads, reference, errors: Vec::new() }
    }

    /// Renders the scene with so many samples per pixel and segments per path.
    fn render(&mut self, spp: u32, max_depth: u32) -> Stats {
        (self.scene.settings.spp, self.scene.settings.max_depth) = (spp, max_depth);
        let run = Run { threads: self.threads, ..Run::default() };
        render(&self.scene, &run, &|_| {}).stats
    }
}

impl Study for CameraRays {
    type Sample = Cost;
    type Findings = Report;
    type Error = Infallible;

    fn settings(&self) -> usize {
        self.settings.len()
    }

    fn prepare(&mut self, setting: usize) -> Result<(), Infallible> {
        self.scene.settings = self.settings[setting].over(&self.base);
        self.errors.push(self.reference.errors(&self.scene));
        Ok(())
    }

    fn measure(&mut self, setting: usize) -> Result<Cost, Infallible> {
        self.scene.settings = self.settings[setting].over(&self.base);
        let camera = self.render(CAMERA_SPP, 1);
        let full = self.render(self.spp, self.base.max_depth);
        Ok(Cost {
            ns_per_ray: 1e9 * camera.seconds * camera.threads as f64 / camera.counters.rays as f64,
            paths_per_second: full.paths_per_second,
            steps_per_ray: full.steps_per_ray,
            queries_per_ray: full.queries_per_ray,
        })
    }

    fn conclude(self, samples: Vec<Vec<Cost>>) -> Report {
        let measured = self.settings.iter().zip(&self.errors).zip(&samples);
        let measurements: Vec<Measurement> = measured
            .map(|((&setting, &errors), costs)| Measurement { setting, errors, cost: Cost::median(costs) })
            .collect();
        trade_off::report(&measurements)
    }
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

impl Cost {
    fn median(costs: &[Self]) -> Self {
        Self {
            ns_per_ray: median(costs, |cost| cost.ns_per_ray),
            paths_per_second: median(costs, |cost| cost.paths_per_second),
            steps_per_ray: median(costs, |cost| cost.steps_per_ray),
            queries_per_ray: median(costs, |cost| cost.queries_per_ray),
        }
    }
}

impl Measurement {
    /// A value of the error, pixels, and the time per camera ray, nanoseconds.
    fn at(&self, error: fn(&Spread) -> f64) -> [f64; 2] {
        [self.errors.footprint.as_ref().map_or(f64::NAN, error), self.cost.ns_per_ray]
    }
}

impl TradeOff for Measurement {
    /// 99th percentile of the error, pixels, and time per camera ray, nanoseconds.
    fn place(&self) -> [f64; 2] {
        self.at(|spread| spread.p99)
    }

    fn printed(&self, row: Row) -> Row {
        let Self { setting, errors, cost } = self;
        row.cell("stepper", flag_name(setting.stepper))
            .cell("precision", flag_name(setting.precision))
            .cell(
                "tolerance",
                setting.tolerance.map_or(NONE.to_owned(), |tolerance| format!("{tolerance:e}")),
            )
            .cell("schedule", flag_name(setting.schedule))
            .cell("median (px)", scientific(errors.footprint.map(|spread| spread.median), 1))
            .cell("99 % (px)", scientific(errors.footprint.map(|spread| spread.p99), 1))
            .cell("median", scientific(errors.position.map(|spread| spread.median), 1))
            .cell("99 %", scientific(errors.position.map(|spread| spread.p99), 1))
            .cell("differ", percent(errors.differ))
            .cell("ns/camera ray", format!("{:.0}", cost.ns_per_ray))
            .cell("paths/s", format!("{:.0}", cost.paths_per_second))
            .cell("steps/ray", format!("{:.2}", cost.steps_per_ray))
            .cell("queries/ray", format!("{:.2}", cost.queries_per_ray))
    }

    fn row(&self) -> Row {
        let Self { setting, errors, cost } = self;
        let mut row = Row::default()
            .cell("stepper", flag_name(setting.stepper))
            .cell("precision", flag_name(setting.precision))
            .maybe("tolerance", setting.tolerance)
            .cell("schedule", flag_name(setting.schedule))
            .cell("rays", errors.rays)
            .cell("differ", errors.differ);
        let spreads =
            [("position", errors.position), ("direction", errors.direction), ("footprint", errors.footprint)];
        for (name, spread) in spreads {
            row = row
                .maybe(format!("{name}_rmse"), spread.map(|spread| spread.rmse))
                .maybe(format!("{name}_median"), spread.map(|spread| spread.median))
                .maybe(format!("{name}_p99"), spread.map(|spread| spread.p99));
        }
        row.cell("ns_per_ray", cost.ns_per_ray)
            .cell("paths_per_second", cost.paths_per_second)
            .cell("steps_per_ray", cost.steps_per_ray)
            .cell("queries_per_ray", cost.queries_per_ray)
    }

    /// Work against precision: time per camera ray over the median error and over its 99th percentile.
    fn figure(all: &[Self]) -> Figure {
        let schedules = all.iter().any(|m| m.setting.schedule != all[0].setting.schedule);
        let curve = |m: &Measurement| Curve {
            stepper: m.setting.stepper,
            precision: m.setting.precision,
            schedule: schedules.then_some(m.setting.schedule),
        };
        let chart = |title: &str, error: fn(&Spread) -> f64| {
            let points: Vec<_> = all.iter().map(|m| (curve(m), m.at(error))).collect();
            over_front(title, ["error (pixels)", "time per camera ray (ns)"], CHART, &points)
        };
        let charts = vec![
            chart("Median error", |spread| spread.median),
            chart("99th percentile of the error", |spread| spread.p99),
        ];
        Figure { charts }
    }
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
}
