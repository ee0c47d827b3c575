//! Render settings: what a scene file may say under `[film]` and `[render]`, and the command line may override.

use serde::{Deserialize, Serialize};

use crate::light::Heuristic;
use crate::spacetime::SpacetimeKind;

/// Reconstruction filter, sampled (each sample counts for its own pixel only).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
#[serde(rename_all = "kebab-case")]
pub enum Filter {
    /// Tent of one pixel half-width.
    Tent,
    /// The pixel's own square.
    Box,
}

/// Background, seen where a camera ray leaves to infinity without having met a surface, lensed or not.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
#[serde(rename_all = "kebab-case")]
pub enum Background {
    /// The environment, with an alpha of 1; 0 if there is none.
    Opaque,
    /// Nothing, with an alpha of 0; surfaces see and scatter the environment all the same.
    Transparent,
}

/// Stepper that advances rays through curved space.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
#[serde(rename_all = "kebab-case")]
pub enum StepperKind {
    /// Nyström, order 6(4): fewest steps at everyday tolerances.
    Rkn6,
    /// Dormand–Prince 8(5,3), for tight tolerances.
    Dop853,
    /// Dormand–Prince 5(4).
    Dopri5,
    /// Runge–Kutta–Fehlberg 5(4).
    Rkf45,
    /// Nyström, order 4.
    Rkn4,
    /// Classical Runge–Kutta, order 4.
    Rk4,
    /// Suzuki's symplectic composition of leapfrogs, order 4.
    Leapfrog4,
    /// Taylor series, of rays around a single hole: in the inverse areal radius, or in Mino time if it spins. Elsewhere
    /// rkn6 stands for it.
    Series,
    /// Quadrature, good to rounding and without steps, of a table's rays around a hole that does not spin. Elsewhere
    /// series stands for it.
    Quadrature,
    /// The paper's scheme: RK4 on its equations (7), (8) with the step rule of its Algorithm 2.
    Rk4Paper,
}

impl StepperKind {
    /// Stepper that stands for this one in a spacetime: its family may not have all of them.
    pub fn around(self, spacetime: &SpacetimeKind) -> Self {
        match (spacetime, self) {
            (SpacetimeKind::Spinning { .. }, _) => Self::Series,
            (SpacetimeKind::Indexed(_), Self::Dop853) => Self::Dop853,
            (SpacetimeKind::Indexed(_), _) => Self::Rkn6,
            (SpacetimeKind::Wormhole { .. }, Self::Rk4Paper) => Self::Rkn6,
            (SpacetimeKind::Flat | SpacetimeKind::Wormhole { .. }, Self::Series | Self::Quadrature) => {
                Self::Rkn6
            }
            (SpacetimeKind::Wormhole { .. }, stepper) => stepper,
            (SpacetimeKind::Spherical { .. }, Self::Quadrature) => Self::Series,
            (SpacetimeKind::Flat | SpacetimeKind::Spherical { .. }, stepper) => stepper,
        }
    }

    /// Those that follow orbits of static, spherical spacetimes to a tolerance.
    pub const OF_ORBITS: [Self; 7] =
        [Self::Rkn6, Self::Dop853, Self::Dopri5, Self::Rkf45, Self::Rkn4, Self::Rk4, Self::Leapfrog4];

    /// Those that follow the rays of a table around a hole that does not spin to a tolerance.
    pub const AROUND_A_HOLE: [Self; 9] = {
        let [rkn6, dop853, dopri5, rkf45, rkn4, rk4, leapfrog4] = Self::OF_ORBITS;
        [Self::Quadrature, rkn6, Self::Series, dop853, dopri5, rkf45, rkn4, rk4, leapfrog4]
    };
}

/// The numbers that orbits are followed in.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
#[serde(rename_all = "kebab-case")]
pub enum Precision {
    /// Single: good to about 1e-5 radians; eight rays to a vector of 32 bytes.
    F32,
    /// Double.
    F64,
}

/// In which order the kernels run; both give the same bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
#[serde(rename_all = "kebab-case")]
pub enum Schedule {
    /// Structure-of-arrays batches of paths, one step of all rays at a time.
    Wavefront,
    /// One path after the other.
    PerPixel,
}

/// Source of random numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
#[serde(rename_all = "kebab-case")]
pub enum SamplerKind {
    /// Owen-scrambled Sobol' points, padded per bounce.
    Sobol,
    /// Independent uniform numbers.
    Independent,
}

/// Sampling of lights, beside the rays that surfaces send out.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
#[serde(rename_all = "kebab-case")]
pub enum LightSampling {
    /// Not at all: only what rays run into counts.
    Off,
    /// Along straight lines, as the paper does, and instead of what rays run into: wrong where space is curved.
    Straight,
    /// Along geodesics, sharing with what rays run into.
    Geodesic,
}

/// Largest image side, pixels.
pub(super) const MAX_SIDE: usize = 1 << 16;

/// Most pixels in an image.
pub(super) const MAX_PIXELS: usize = 1 << 28;

/// Largest winding number of rays to lights: those that go around more often cannot be told from the critical ray.
pub const MAX_WINDING: u32 = 8;

/// Most samples of a pixel that can be asked for: the numbers of others are left to probes.
pub const MAX_SPP: u32 = 1 << 31;

/// Most ray segments of a path that can be asked for: there are random numbers for as many.
pub const MAX_SEGMENTS: u32 = u16::MAX as u32;

/// Everything that decides the picture beside the scene's content.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Settings {
    /// Image width in pixels.
    pub width: usize,
    /// Image height in pixels.
    pub height: usize,
    /// Reconstruction filter.
    pub filter: Filter,
    /// Background, behind everything.
    pub background: Background,
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
    /// Numbers that orbits are followed in.
    pub precision: Precision,
    /// Schedule of the kernels.
    pub schedule: Schedule,
    /// Random numbers.
    pub sampler: SamplerKind,
    /// Sampling of lights.
    pub light_sampling: LightSampling,
    /// Largest winding number of rays to lights that are looked for: 0 the near way, 1 around the far side as well, and
    /// so on.
    pub max_winding: u32,
    /// Heuristic that shares light found both ways.
    pub heuristic: Heuristic,
    /// True if light is given back that microfacets of principled materials scatter more than once.
    pub multiscatter: bool,
    /// Largest error of a ray's direction, all its steps together, radians at its start.
    pub tolerance: f64,
    /// Largest distance between an arc and the true curve, scene units; `None`: from the pixel footprint.
    pub arc_tolerance: Option<f64>,
    /// Factor on the arc tolerance that comes from the pixel footprint; not used if `arc_tolerance` is given.
    pub arc_tolerance_factor: f64,
}

impl Settings {
    /// Width over height.
    pub fn aspect(&self) -> f64 {
        self.width as f64 / self.height as f64
    }
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            width: 640,
            height: 480,
            filter: Filter::Tent,
            background: Background::Opaque,
            exposure: 0.0,
            spp: 64,
            max_depth: 16,
            roulette_depth: 5,
            seed: 0,
            stepper: StepperKind::Rkn6,
            precision: Precision::F64,
            schedule: Schedule::Wavefront,
            sampler: SamplerKind::Sobol,
            light_sampling: LightSampling::Geodesic,
            max_winding: 1,
            heuristic: Heuristic::Power,
            multiscatter: true,
            tolerance: 1e-5,
            arc_tolerance: None,
            arc_tolerance_factor: 1.0,
        }
    }
}

/// The name under which a setting is given on the command line.
#[cfg(feature = "cli")]
pub fn flag_name(value: impl clap::ValueEnum) -> String {
    value.to_possible_value().map_or_else(String::new, |value| value.get_name().to_owned())
}
