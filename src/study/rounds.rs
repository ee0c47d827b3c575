//! Studies: settings that are all measured in turn, round after round, so that a machine that is slow for a while slows
//! all of them.

use crate::trace::Progress;

/// A study: its settings, one measurement of a setting, and the findings from all measurements.
pub trait Study {
    /// One measurement of a setting.
    type Sample;
    /// Findings from all measurements together.
    type Findings;
    /// Error: a setting cannot be measured.
    type Error;

    /// Number of settings.
    fn settings(&self) -> usize;

    /// Runs a setting before the rounds, which warms up and may find what times do not change.
    ///
    /// # Errors
    /// If the setting cannot be measured.
    fn prepare(&mut self, _setting: usize) -> Result<(), Self::Error> {
        Ok(())
    }

    /// Measures a setting once.
    ///
    /// # Errors
    /// If the setting cannot be measured.
    fn measure(&mut self, setting: usize) -> Result<Self::Sample, Self::Error>;

    /// Sums up the samples of each setting by round.
    fn conclude(self, samples: Vec<Vec<Self::Sample>>) -> Self::Findings;
}

/// Measures every setting of `study` in each of `rounds`; `progress` is told how many of how many runs are done.
///
/// # Errors
/// If a setting cannot be measured.
pub fn run<S: Study>(
    mut study: S,
    rounds: u32,
    progress: &dyn Fn(Progress),
) -> Result<S::Findings, S::Error> {
    let settings = study.settings();
    let total = settings * (rounds as usize + 1);
    let tell = |done: usize| progress(Progress { done: done as u64, total: total as u64 });
    for setting in 0..settings {
        tell(setting);
        study.prepare(setting)?;
    }
    let mut samples: Vec<Vec<S::Sample>> = (0..settings).map(|_| Vec::new()).collect();
    for done in settings..total {
        tell(done);
        let setting = done % settings;
        samples[setting].push(study.measure(setting)?);
    }
    tell(total);
    Ok(study.conclude(samples))
}
