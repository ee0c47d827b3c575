//! Cost of a render, before it is started.

use std::time::Duration;

use super::units::{decimal, duration, plural};
use crate::scene::{Schedule, flag_name};
use crate::study::estimate::Estimate;
use crate::study::forecast::Forecast;

/// Seconds from which on a part of the time is worth its words.
const SMALLEST: f64 = 0.005;
/// Two standard errors of a value, relative, from which on it is not known.
const UNKNOWN: f64 = 1.0;
/// … and of the ratio of two times up to which they are about the same.
const SAME: f64 = 0.2;

/// Limits that may end a render before all samples are there.
pub(super) struct Limits {
    /// `--time-limit`.
    pub(super) time: Option<Duration>,
    /// `--noise`.
    pub(super) noise: Option<f64>,
}

/// The time of a render in words.
pub(super) fn time(forecast: &Forecast, limits: &Limits) -> String {
    let Forecast { threads, paths, seconds, learning, sampling, edges, .. } = forecast;
    let threads = plural(*threads, "thread", "threads");
    let Some(spread) = spread(*seconds) else {
        let paths = format!("for {} paths on {threads}", decimal(*paths as f64));
        return match seconds.value.is_finite() {
            true => format!(
                "not known, perhaps {} {paths}: the probe was too short to tell",
                duration(seconds.value)
            ),
            false => format!("not known {paths}: nothing could be measured"),
        } + &until(limits, f64::INFINITY);
    };
    let mut parts = vec![format!(
        "{} for {} paths ({} paths/s)",
        duration(sampling.value),
        decimal(*paths as f64),
        decimal(*paths as f64 / sampling.value)
    )];
    if *learning >= SMALLEST {
        parts.insert(0, format!("{} to learn of lights", duration(*learning)));
    }
    if edges.value >= SMALLEST {
        parts.push(format!("{} for edges of lamps", duration(edges.value)));
    }
    let until = until(limits, seconds.value);
    format!(
        "about {} ± {:.0} % on {threads}: {}{until}",
        duration(seconds.value),
        100.0 * spread,
        parts.join(", ")
    )
}

/// Two standard errors, relative; `None` if that is too much to call the value known, or is not known itself.
fn spread(estimate: Estimate) -> Option<f64> {
    let spread = 2.0 * estimate.error? / estimate.value;
    (spread < UNKNOWN).then_some(spread)
}

/// Limits that may end a render of so many seconds early, in words.
fn until(limits: &Limits, seconds: f64) -> String {
    let mut text = String::new();
    if let Some(noise) = limits.noise {
        text += &format!("; --noise {noise} may end it sooner, when is not known");
    }
    if let Some(limit) = limits.time.map(|limit| limit.as_secs_f64()).filter(|&limit| limit < seconds) {
        text += &format!("; --time-limit ends it after {}", duration(limit));
    }
    text
}

/// The faster schedule, in words; `used` is the one that is set.
pub(super) fn schedule(forecast: &Forecast, used: Schedule) -> String {
    let Some((schedule, Estimate { value, error })) = forecast.faster() else {
        return match spread(forecast.per_pixel_over_wavefront) {
            Some(spread) if spread < SAME => "wavefront and per-pixel take about the same time",
            _ => "whether wavefront or per-pixel is faster is not known",
        }
        .to_owned();
    };
    let other = if schedule == Schedule::Wavefront { Schedule::PerPixel } else { Schedule::Wavefront };
    let (name, slower) = (flag_name(schedule), flag_name(other));
    let advice = if schedule == used { String::new() } else { format!(": render with --schedule {name}") };
    format!("{name} is {value:.2} ± {:.2} times as fast as {slower}{advice}", 2.0 * error.unwrap_or(0.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    const NONE: Limits = Limits { time: None, noise: None };

    fn exactly(value: f64) -> Estimate {
        Estimate { value, error: Some(0.05 * value) }
    }

    #[test]
    fn the_words_tell_the_parts_that_there_are() {
        let mut forecast = Forecast {
            threads: 2,
            paths: 2_000_000,
            seconds: exactly(90.0),
            learning: 1.25,
            sampling: exactly(80.0),
            edges: exactly(8.75),
            per_pixel_over_wavefront: exactly(0.5),
        };
        let words = "about 1m 30s ± 10 % on 2 threads: 1.2s to learn of lights, \
                     1m 20s for 2.00 M paths (25.0 k paths/s), 8.8s for edges of lamps";
        assert_eq!(time(&forecast, &NONE), words);
        let advice = "per-pixel is 2.00 ± 0.20 times as fast as wavefront";
        assert_eq!(schedule(&forecast, Schedule::PerPixel), advice);
        let advice = format!("{advice}: render with --schedule per-pixel");
        assert_eq!(schedule(&forecast, Schedule::Wavefront), advice);
        (forecast.learning, forecast.edges, forecast.threads) = (0.0, exactly(0.0), 1);
        let words = "about 1m 30s ± 10 % on 1 thread: 1m 20s for 2.00 M paths (25.0 k paths/s)";
        assert_eq!(time(&forecast, &NONE), words);
        forecast.per_pixel_over_wavefront = exactly(1.02);
        assert!(schedule(&forecast, Schedule::Wavefront).contains("about the same"));
    }

    #[test]
    fn what_is_not_known_is_said_to_be_so() {
        let mut forecast = Forecast {
            threads: 1,
            paths: 2000,
            seconds: Estimate { value: 90.0, error: Some(60.0) },
            learning: 0.0,
            sampling: exactly(90.0),
            edges: exactly(0.0),
            per_pixel_over_wavefront: Estimate { value: 1.5, error: Some(0.5) },
        };
        let words = "not known, perhaps 1m 30s for 2.00 k paths on 1 thread: the probe was too short to tell";
        assert_eq!(time(&forecast, &NONE), words);
        assert!(schedule(&forecast, Schedule::Wavefront).ends_with("is not known"));
        forecast.seconds.error = None;
        assert_eq!(time(&forecast, &NONE), words);
        forecast.seconds.value = f64::NAN;
        assert!(time(&forecast, &NONE).starts_with("not known for 2.00 k paths"));
        forecast.seconds = exactly(90.0);
        let limits = Limits { time: Some(Duration::from_secs(30)), noise: Some(0.01) };
        let words = time(&forecast, &limits);
        assert!(
            words.contains("--noise 0.01 may end it sooner")
                && words.ends_with("--time-limit ends it after 30s")
        );
        let limits = Limits { time: Some(Duration::from_secs(300)), noise: None };
        assert!(!time(&forecast, &limits).contains("limit"));
    }
}
