//! Forecast of the time of a render, estimated from a short probe of it.

use serde::Serialize;

use super::estimate::Estimate;
use crate::scene::{Schedule, Settings};
use crate::trace::{Probe, Reading};

/// Gain from which on another schedule is worth a word.
const WORTHWHILE: f64 = 1.03;

/// Forecast of a render; times are wall time in seconds.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Forecast {
    /// Worker threads.
    pub threads: usize,
    /// Camera paths.
    pub paths: u64,
    /// All of the time.
    pub seconds: Estimate,
    /// Learning of light sampling.
    pub learning: f64,
    /// Camera paths.
    pub sampling: Estimate,
    /// Edges of lamps.
    pub edges: Estimate,
    /// Time of a path in the per-pixel schedule over that in the wavefront schedule.
    pub per_pixel_over_wavefront: Estimate,
}

impl Forecast {
    /// The forecast of a render with these settings, by what a probe of it tells.
    pub fn new(probe: &Probe, settings: &Settings) -> Self {
        let Probe { threads, learning, pixels, tiles, ref readings, .. } = *probe;
        // Threads that find no tile left wait for the others, after every pass.
        let rounds = tiles.div_ceil(threads);
        let pixels_in_turn = pixels as f64 * rounds as f64 / tiles as f64;
        let all = |time: fn(&Reading) -> f64, times: f64| -> Vec<f64> {
            readings.iter().map(|reading| times * time(reading)).collect()
        };
        let samples = f64::from(settings.spp) * pixels_in_turn;
        let wavefront = Estimate::middle(&all(|reading| reading.wavefront, samples));
        let per_pixel = Estimate::middle(&all(|reading| reading.per_pixel, samples));
        let sampling = match settings.schedule {
            Schedule::Wavefront => wavefront,
            Schedule::PerPixel => per_pixel,
        };
        // Most neighbourhoods have no edges and a few have many: outliers count.
        let edges = Estimate::mean(&all(|reading| reading.edges, pixels_in_turn));
        let error = sampling.error.zip(edges.error).map(|(a, b)| libm::hypot(a, b));
        Self {
            threads,
            paths: pixels as u64 * u64::from(settings.spp),
            seconds: Estimate { value: learning + sampling.value + edges.value, error },
            learning,
            sampling,
            edges,
            per_pixel_over_wavefront: per_pixel.over(wavefront),
        }
    }

    /// The faster schedule and how many times as fast as the other it is; `None` where there is no telling.
    pub fn faster(&self) -> Option<(Schedule, Estimate)> {
        let ratio = self.per_pixel_over_wavefront;
        let (schedule, gain) = if ratio.value >= 1.0 {
            (Schedule::Wavefront, ratio)
        } else {
            let error = ratio.error.map(|error| error / (ratio.value * ratio.value));
            (Schedule::PerPixel, Estimate { value: 1.0 / ratio.value, error })
        };
        let sure = gain.error.is_some_and(|error| gain.value - 1.0 > 2.0 * error);
        (sure && gain.value > WORTHWHILE).then_some((schedule, gain))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn forecast(readings: &[Reading], settings: &Settings) -> Forecast {
        let readings = readings.to_vec();
        let probe = Probe { threads: 2, learning: 0.5, lights: None, pixels: 3000, tiles: 3, readings };
        Forecast::new(&probe, settings)
    }

    #[test]
    fn a_forecast_adds_up_and_counts_tiles_that_leave_threads_idle() {
        let settings = Settings { spp: 10, ..Settings::default() };
        let reading = |wavefront: f64| Reading { wavefront, per_pixel: 2.0 * wavefront, edges: 0.01 };
        let forecast = forecast(&[reading(0.001), reading(0.003)], &settings);
        assert_eq!(forecast.paths, 30_000);
        // Three tiles of 1000 pixels take two threads as long as four.
        assert!((forecast.sampling.value - 2000.0 * 10.0 * 0.002).abs() < 1e-9);
        assert!((forecast.edges.value - 2000.0 * 0.01).abs() < 1e-9);
        let parts = forecast.learning + forecast.sampling.value + forecast.edges.value;
        assert!((forecast.seconds.value - parts).abs() < 1e-9);
        assert_eq!(forecast.seconds.error, forecast.sampling.error);
        let slow = Settings { schedule: Schedule::PerPixel, ..settings };
        let slower = super::tests::forecast(&[reading(0.001), reading(0.003)], &slow);
        assert!((slower.sampling.value - 2.0 * forecast.sampling.value).abs() < 1e-9);
    }

    #[test]
    fn a_schedule_is_called_faster_only_if_it_surely_is() {
        let faster = |ratios: &[f64]| {
            let reading = |&ratio: &f64| Reading { wavefront: 1.0, per_pixel: ratio, edges: 0.0 };
            let readings: Vec<Reading> = ratios.iter().map(reading).collect();
            forecast(&readings, &Settings::default()).faster().map(|(schedule, gain)| (schedule, gain.value))
        };
        assert_eq!(faster(&[2.0, 2.0]), Some((Schedule::Wavefront, 2.0)));
        assert_eq!(faster(&[0.5, 0.5]), Some((Schedule::PerPixel, 2.0)));
        assert_eq!(faster(&[0.5, 0.6, 1.9, 2.5]), None);
        assert_eq!(faster(&[1.01, 1.01]), None);
        assert_eq!(faster(&[2.0]), None);
    }
}
