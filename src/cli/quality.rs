//! `--quality`: how exactly rays follow the true curves.

use clap::ValueEnum;

use crate::scene::{Settings, StepperKind};

/// A preset; it goes over the scene file's values, and single flags go over it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum Quality {
    /// For a first look.
    Draft,
    /// Errors below a pixel.
    Standard,
    /// To compare others against.
    Reference,
}

impl Quality {
    /// Stepper, tolerance, and the factor on the arc tolerance that comes from the pixel footprint: the settings on the
    /// front of `study` nearest to these tolerances.
    fn accuracy(self) -> (StepperKind, f64, f64) {
        match self {
            Quality::Draft => (StepperKind::Rkn6, 1e-3, 4.0),
            Quality::Standard => (StepperKind::Rkn6, 1e-5, 1.0),
            Quality::Reference => (StepperKind::Dop853, 1e-10, 0.1),
        }
    }

    /// Sets what the preset decides.
    pub(super) fn apply(self, settings: &mut Settings) {
        (settings.stepper, settings.tolerance, settings.arc_tolerance_factor) = self.accuracy();
        settings.arc_tolerance = None;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn standard_is_the_default() {
        let mut settings = Settings::default();
        Quality::Standard.apply(&mut settings);
        assert_eq!(settings, Settings::default());
    }
}
