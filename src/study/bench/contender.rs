//! Contenders of a race.

use super::point::Point;
use crate::scene::{Baked, Schedule, Settings, StepperKind, flag_name};
use crate::spacetime::SpacetimeKind;

/// A way to render a scene, all else being equal.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Contender {
    /// The wavefront; against itself it shows what a ratio is worth.
    Wavefront,
    /// Kernels of the wavefront, one path after the other.
    PerPixel,
    /// The paper's march, one path after the other.
    Paper,
    /// The wavefront without the hole.
    Flat,
}

impl Contender {
    /// Its name on the command line.
    pub fn name(self) -> String {
        flag_name(self)
    }

    /// True if it must render the same picture as the wavefront.
    pub fn keeps_the_picture(self) -> bool {
        matches!(self, Self::Wavefront | Self::PerPixel)
    }

    /// True if in flat space it is the same as another contender.
    pub fn needs_a_hole(self) -> bool {
        matches!(self, Self::Paper | Self::Flat)
    }

    /// Makes `scene` what it renders at `point`.
    pub(super) fn enter(self, point: &Point, scene: &mut Baked) {
        let schedule = match self {
            Self::Wavefront | Self::Flat => Schedule::Wavefront,
            Self::PerPixel | Self::Paper => Schedule::PerPixel,
        };
        let stepper = if self == Self::Paper { StepperKind::Rk4Paper } else { point.settings.stepper };
        scene.settings = Settings { schedule, stepper, ..point.settings.clone() };
        scene.spacetime = if self == Self::Flat { SpacetimeKind::Flat } else { point.spacetime.clone() };
    }
}
