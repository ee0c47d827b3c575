//! Render settings: what a scene file may say under `[film]` and `[render]`, and the command line may override.

use serde::{Deserialize, Serialize};

/// Reconstruction filter, sampled (each sample counts for its own pixel only).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum Filter {
    /// Tent of one pixel half-width.
    Tent,
    /// The pixel's own square.
    Box,
}

/// How rays are advanced through curved space.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum StepperKind {
    /// Nyström, order 4, with error control.
    Rkn4,
    /// Nyström, order 5, with error control: fewer steps for the same error.
    Rkn5,
    /// The paper's scheme: RK4 on its equations (7), (8) with the step rule of its Algorithm 2.
    Rk4Paper,
}

/// In which order the kernels run; both give the same bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum Schedule {
    /// Structure-of-arrays batches of paths, one step of all rays at a time.
    Wavefront,
    /// One path after the other.
    PerPixel,
}

/// Source of random numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum SamplerKind {
    /// Owen-scrambled Sobol' points, padded per bounce.
    Sobol,
    /// Independent uniform numbers.
    Independent,
}

/// Everything that decides the picture beside the scene's content.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Settings {
    /// Image width in pixels.
    pub width: usize,
    /// Image height in pixels.
    pub height: usize,
    /// Reconstruction filter.
    pub filter: Filter,
    /// Exposure of the PNG preview, in stops.
    pub exposure: f64,
    /// Samples per pixel.
    pub spp: u32,
    /// Most ray segments in a path, the camera's included.
    pub max_depth: u32,
    /// Russian roulette may end paths after this many segments.
    pub roulette_depth: u32,
    /// Seed of all random numbers.
    pub seed: u64,
    /// Stepper in curved space.
    pub stepper: StepperKind,
    /// Schedule of the kernels.
    pub schedule: Schedule,
    /// Random numbers.
    pub sampler: SamplerKind,
    /// Largest estimated error of a step's direction, radians.
    pub tolerance: f64,
    /// Largest distance between an arc and the true curve, scene units; `None`: from the pixel footprint.
    pub arc_tolerance: Option<f64>,
    /// Factor on the arc tolerance that comes from the pixel footprint; not used if `arc_tolerance` is given.
    pub arc_tolerance_factor: f64,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            width: 640,
            height: 480,
            filter: Filter::Tent,
            exposure: 0.0,
            spp: 64,
            max_depth: 16,
            roulette_depth: 5,
            seed: 0,
            stepper: StepperKind::Rkn5,
            schedule: Schedule::Wavefront,
            sampler: SamplerKind::Sobol,
            tolerance: 1e-5,
            arc_tolerance: None,
            arc_tolerance_factor: 1.0,
        }
    }
}
