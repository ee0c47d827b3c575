//! Parameters that cost grows with, and the points at which it is measured.

use std::num::NonZero;
use std::ops::RangeInclusive;
use std::thread::available_parallelism;

use glam::DVec3;

use super::point::Point;
use super::room::room;
use crate::scene::{Baked, Precision, StepperKind};
use crate::study::way::tolerances_for;

/// Parameter that is varied.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Vary {
    /// Rays in a worker's wavefront.
    Batch,
    /// Worker threads.
    Threads,
    /// Pixels of pictures of the same shape.
    Pixels,
    /// Samples per pixel.
    Spp,
    /// Most ray segments in a path.
    Depth,
    /// Schwarzschild radius, scene units.
    Radius,
    /// Largest error of a ray's direction, radians.
    Tolerance,
    /// Triangles of a room built for this, in place of the scene's geometry.
    Triangles,
}

/// Values that cannot be measured.
#[derive(Debug, thiserror::Error)]
#[error("{cause}")]
pub struct VaryError {
    /// Problem, in words.
    pub cause: String,
    /// Remedy.
    pub remedy: String,
}

fn refuse<T>(cause: impl Into<String>, remedy: impl Into<String>) -> Result<T, VaryError> {
    Err(VaryError { cause: cause.into(), remedy: remedy.into() })
}

impl Vary {
    /// Label of the axis of a diagram.
    pub fn label(self) -> &'static str {
        match self {
            Self::Batch => "rays in flight per worker",
            Self::Threads => "threads",
            Self::Pixels => "pixels",
            Self::Spp => "samples per pixel",
            Self::Depth => "most segments of a path",
            Self::Radius => "Schwarzschild radius (scene units)",
            Self::Tolerance => "tolerance (radians)",
            Self::Triangles => "triangles",
        }
    }

    /// The scenes that it takes to measure `values`, or else values that suit `scene`, and the points, which but for
    /// the value are like `base`.
    ///
    /// # Errors
    /// If there is nothing to vary in the scene, or a value is not one that it can have.
    pub fn points(
        self,
        values: &[f64],
        base: &Point,
        scene: Baked,
    ) -> Result<(Vec<Baked>, Vec<Point>), VaryError> {
        self.check_scene(&scene)?;
        let usual = self.usual(base, &scene);
        let values = if values.is_empty() { &usual } else { values };
        let mut points: Vec<Point> = Vec::new();
        let mut rooms = Vec::new();
        for &value in values {
            self.check(value, base, &scene)?;
            let mut point = self.at(value, base);
            if self == Self::Triangles {
                let (room, triangles) = room(&scene, value as usize);
                point.value = Some(triangles as f64);
                point.scene = rooms.len();
                rooms.push(room);
            }
            if points.iter().all(|other| other.value != point.value) {
                points.push(point);
            }
        }
        Ok((if self == Self::Triangles { rooms } else { vec![scene] }, points))
    }

    /// Refuses a scene in which there is nothing to vary.
    fn check_scene(self, scene: &Baked) -> Result<(), VaryError> {
        if !matches!(self, Self::Radius | Self::Tolerance) {
            return Ok(());
        }
        if scene.spacetime.is_flat() {
            return refuse(
                "the scene is flat: its rays are straight and have neither radius nor tolerance",
                "give a scene with a hole, or --black-hole",
            );
        }
        if self == Self::Tolerance && scene.settings.stepper == StepperKind::Rk4Paper {
            return refuse("rk4-paper knows no tolerance", "give another --stepper");
        }
        Ok(())
    }

    /// Values that show how cost grows.
    fn usual(self, base: &Point, scene: &Baked) -> Vec<f64> {
        let powers = |exponents: RangeInclusive<i32>, of: f64| exponents.map(|e| of.powi(e)).collect();
        match self {
            Self::Batch => powers(3..=8, 4.0),
            Self::Threads => {
                let cores = available_parallelism().map_or(1, NonZero::get);
                let doubled = std::iter::successors(Some(1), |n| Some(2 * n)).take_while(|&n| n < cores);
                doubled.chain([cores]).map(|n| n as f64).collect()
            }
            Self::Pixels => {
                let pixels = (base.settings.width * base.settings.height) as f64;
                [1.0 / 16.0, 0.25, 1.0, 4.0].map(|factor| factor * pixels).to_vec()
            }
            Self::Spp => powers(0..=4, 2.0),
            Self::Depth => powers(0..=5, 2.0),
            Self::Radius => {
                let radii =
                    [0.125, 0.25, 0.5, 1.0, 2.0].map(|factor| factor * base.spacetime.schwarzschild_radius());
                radii.into_iter().filter(|&radius| is_outside(scene, radius)).collect()
            }
            Self::Tolerance => {
                let tolerances = [1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8];
                tolerances_for(base.settings.precision, &tolerances).collect()
            }
            Self::Triangles => powers(3..=6, 10.0),
        }
    }

    /// Refuses values that this cannot have.
    fn check(self, value: f64, base: &Point, scene: &Baked) -> Result<(), VaryError> {
        let whole = match self {
            Self::Batch => 1..=1 << 20,
            Self::Threads => 1..=1024,
            Self::Pixels => 1..=1 << 24,
            Self::Spp | Self::Depth => 1..=u32::MAX,
            Self::Triangles => 1..=1 << 26,
            Self::Radius if !is_outside(scene, value) => {
                return refuse(
                    format!(
                        "with a radius of {value} the camera is inside the hole, whose horizon is at {}",
                        scene.spacetime.with_schwarzschild_radius(value).horizon()
                    ),
                    "give smaller --values",
                );
            }
            Self::Tolerance if tolerances_for(base.settings.precision, &[value]).next().is_none() => {
                let precision = base.settings.precision;
                let least = if precision == Precision::F32 { "1.2e-5" } else { "2.3e-14" };
                return refuse(
                    format!("a tolerance of {value:e} is finer than the numbers"),
                    format!("give --values from {least} up, or another --precision"),
                );
            }
            Self::Radius | Self::Tolerance => return Ok(()),
        };
        let (least, most) = (*whole.start(), *whole.end());
        if value.fract() == 0.0 && value >= f64::from(least) && value <= f64::from(most) {
            return Ok(());
        }
        let remedy = format!("give whole numbers from {least} to {most}");
        refuse(format!("{value} is no number of {}", self.label()), remedy)
    }

    /// `base` with a value that it can have.
    fn at(self, value: f64, base: &Point) -> Point {
        let mut point = Point { value: Some(value), ..base.clone() };
        match self {
            Self::Batch => point.batch = value as usize,
            Self::Threads => point.threads = value as usize,
            Self::Pixels => {
                let (width, height) = (base.settings.width as f64, base.settings.height as f64);
                let scale = (value / (width * height)).sqrt();
                let size = [width, height].map(|side| (scale * side).round().max(1.0) as usize);
                [point.settings.width, point.settings.height] = size;
                point.value = Some((size[0] * size[1]) as f64);
            }
            Self::Spp => point.settings.spp = value as u32,
            Self::Depth => point.settings.max_depth = value as u32,
            Self::Radius => {
                point.spacetime = point.spacetime.with_schwarzschild_radius(value);
            }
            Self::Tolerance => point.settings.tolerance = value,
            Self::Triangles => {}
        }
        point
    }
}

/// Test for rays that start outside of a hole of this radius in the place of the scene's.
fn is_outside(scene: &Baked, radius: f64) -> bool {
    let camera = &scene.camera;
    let start: DVec3 = camera.position + camera.near * camera.forward;
    let spacetime = scene.spacetime.with_schwarzschild_radius(radius);
    !spacetime.drags(camera.position) && !spacetime.drags(start)
}
