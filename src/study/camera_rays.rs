//! The trade of speed for accuracy on a scene: errors and costs of ways to follow the rays of its camera.

use std::convert::Infallible;

use glam::{DVec2, DVec3};

use super::errors::{Spread, angle, median};
use super::render::render;
use super::report::Report;
use super::rounds::Study;
use super::table::{TableRow, percent, scientific};
use super::trade_off::{self, TradeOff, over_front};
use super::way::Way;
use crate::geometry::{Geometry, PrimitiveId};
use crate::plot::Figure;
use crate::scene::{Baked, Filter, PixelWidth, Precision, Settings};
use crate::trace::{Ray, RayEnd, Run, Shot, Stats, shoot, transport::Outcome};

/// Errors of the ends of rays, over those that end in the right way; `None` if none do.
#[derive(Clone, Copy, Debug, PartialEq)]
struct CameraRayErrors {
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

/// Cost of rays, by column: CPU time of a camera ray by itself; camera paths traced to their end, on all threads;
/// march steps and BVH queries per ray of these paths.
type Cost = [f64; 4];

/// A setting, measured.
#[derive(Clone, Copy, Debug, PartialEq)]
struct CameraRayMeasurement {
    way: Way,
    errors: CameraRayErrors,
    cost: Cost,
}

/// Tolerance of the reference, radians.
const EXACT: f64 = 1e-12;
/// Arc tolerance of the reference relative to that of the settings under study.
const EXACT_ARC: f64 = 1e-4;
/// Camera rays per pixel whose time is measured.
const CAMERA_SPP: u32 = 8;
/// Size of one diagram, points.
const DIAGRAM: [f64; 2] = [470.0, 420.0];

/// A scene whose camera rays are followed in all settings.
pub struct CameraRays {
    scene: Baked,
    /// The scene's own settings.
    base: Settings,
    settings: Vec<Way>,
    /// Samples per pixel of the path-traced pictures whose speed is measured.
    spp: u32,
    /// Worker threads; 0 means one per core.
    threads: usize,
    exact: ExactEnds,
    /// Of the settings.
    errors: Vec<CameraRayErrors>,
}

impl CameraRays {
    /// A study of `settings` on `scene`, in the size that its settings say, whose path-traced pictures have `spp`
    /// samples per pixel; 0 `threads` means one per core.
    pub fn new(mut scene: Baked, settings: Vec<Way>, spp: u32, threads: usize) -> Self {
        let base = Settings { filter: Filter::Box, ..scene.settings.clone() };
        scene.settings = Settings {
            stepper: Settings::default().stepper,
            tolerance: EXACT,
            precision: Precision::F64,
            arc_tolerance: Some(EXACT_ARC * scene.arc_tolerance()),
            ..base.clone()
        };
        let exact = ExactEnds::of_pixels(&scene);
        Self { scene, base, settings, spp, threads, exact, errors: Vec::new() }
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
        self.errors.push(self.exact.errors(&self.scene));
        Ok(())
    }

    fn measure(&mut self, setting: usize) -> Result<Cost, Infallible> {
        self.scene.settings = self.settings[setting].over(&self.base);
        let camera = self.render(CAMERA_SPP, 1);
        let full = self.render(self.spp, self.base.max_depth);
        let ns_per_ray = 1e9 * camera.cpu_seconds / camera.counters.rays as f64;
        Ok([ns_per_ray, full.paths_per_second, full.steps_per_ray, full.queries_per_ray])
    }

    fn conclude(self, samples: Vec<Vec<Cost>>) -> Report {
        let measured = self.settings.iter().zip(&self.errors).zip(&samples);
        let measurements: Vec<CameraRayMeasurement> = measured
            .map(|((&way, &errors), costs)| {
                let cost = [0, 1, 2, 3].map(|column: usize| median(costs, |cost| cost[column]));
                CameraRayMeasurement { way, errors, cost }
            })
            .collect();
        trade_off::report(&measurements)
    }
}

/// Rays and where they should end.
struct ExactEnds {
    rays: Vec<Ray>,
    ends: Vec<Shot>,
    /// Point that distances are seen from.
    eye: DVec3,
    /// Width of a pixel.
    pixel: PixelWidth,
}

impl ExactEnds {
    /// The rays through the pixel centres of `scene`'s camera, followed as its settings say.
    fn of_pixels(scene: &Baked) -> Self {
        let (width, height) = (scene.settings.width, scene.settings.height);
        let size = DVec2::new(width as f64, height as f64);
        let center = |index: usize| DVec2::new((index % width) as f64 + 0.5, (index / width) as f64 + 0.5);
        let rays: Vec<Ray> = (0..width * height)
            .filter_map(|index| {
                let film = center(index) / size;
                let (position, direction) = scene.camera.ray(film, size.x / size.y, DVec2::splat(0.5))?;
                Some(Ray { position, direction, origin_prim: PrimitiveId::none_on(scene.camera.side) })
            })
            .collect();
        let ends = shoot(scene, &rays);
        Self { rays, ends, eye: scene.camera.position, pixel: scene.pixel() }
    }

    /// The errors of the rays as `scene`'s settings let them go.
    fn errors(&self, scene: &Baked) -> CameraRayErrors {
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
                    footprint.push(distance / self.pixel.at(exact.position.distance(self.eye)));
                }
                (Outcome::Escaped(to), Outcome::Escaped(exact)) => {
                    let angle = angle(to.direction, exact.direction);
                    direction.push(angle);
                    // Parallel rays that leave show the same of infinity in all pixels.
                    if self.pixel.angle > 0.0 {
                        footprint.push(angle / self.pixel.angle);
                    }
                }
                _ => {}
            }
        }
        CameraRayErrors {
            rays: self.rays.len(),
            differ: f64::from(differ) / self.rays.len() as f64,
            position: Spread::of(position),
            direction: Spread::of(direction),
            footprint: Spread::of(footprint),
        }
    }
}

/// True if two rays have the same fate and, if they land, meet the same entity.
fn alike(geometry: &Geometry, a: &Shot, b: &Shot) -> bool {
    let entity = |shot: &Shot| match shot.end {
        Outcome::Landed(landing) => Some(geometry.surface(landing.primitive).entity),
        _ => None,
    };
    RayEnd::of(&a.end) == RayEnd::of(&b.end) && entity(a) == entity(b)
}

impl CameraRayMeasurement {
    /// A value of the error, pixels, and the time per camera ray, nanoseconds.
    fn at(&self, error: fn(&Spread) -> f64) -> [f64; 2] {
        [self.errors.footprint.as_ref().map_or(f64::NAN, error), self.cost[0]]
    }
}

impl TradeOff for CameraRayMeasurement {
    /// 99th percentile of the error, pixels, and time per camera ray, nanoseconds.
    fn place(&self) -> [f64; 2] {
        self.at(|spread| spread.p99)
    }

    fn way(&self) -> Way {
        self.way
    }

    fn printed(&self, row: TableRow) -> TableRow {
        let Self { errors, cost: [ns_per_ray, paths_per_second, steps_per_ray, queries_per_ray], .. } = self;
        row.cell("median (px)", scientific(errors.footprint.map(|spread| spread.median), 1))
            .cell("99 % (px)", scientific(errors.footprint.map(|spread| spread.p99), 1))
            .cell("median", scientific(errors.position.map(|spread| spread.median), 1))
            .cell("99 %", scientific(errors.position.map(|spread| spread.p99), 1))
            .cell("differ", percent(errors.differ))
            .cell("ns/camera ray", format!("{ns_per_ray:.0}"))
            .cell("paths/s", format!("{paths_per_second:.0}"))
            .cell("steps/ray", format!("{steps_per_ray:.2}"))
            .cell("queries/ray", format!("{queries_per_ray:.2}"))
    }

    fn row(&self, row: TableRow) -> TableRow {
        let Self { errors, cost: [ns_per_ray, paths_per_second, steps_per_ray, queries_per_ray], .. } = self;
        let parts = [Spread::RMSE, Spread::MEDIAN, Spread::P99];
        row.cell("rays", errors.rays)
            .cell("differ", errors.differ)
            .spread("position", errors.position, parts)
            .spread("direction", errors.direction, parts)
            .spread("footprint", errors.footprint, parts)
            .cell("ns_per_ray", ns_per_ray)
            .cell("paths_per_second", paths_per_second)
            .cell("steps_per_ray", steps_per_ray)
            .cell("queries_per_ray", queries_per_ray)
    }

    /// Work against precision: time per camera ray over the median error and over its 99th percentile.
    fn figure(all: &[Self]) -> Figure {
        let diagram = |title: &str, error: fn(&Spread) -> f64| {
            let points: Vec<_> = all.iter().map(|m| (m.way, m.at(error))).collect();
            over_front(title, ["error (pixels)", "time per camera ray (ns)"], DIAGRAM, &points)
        };
        let diagrams = vec![
            diagram("Median error", |spread| spread.median),
            diagram("99th percentile of the error", |spread| spread.p99),
        ];
        Figure { diagrams }
    }
}
