//! What a render will cost, before it is started.

use std::time::Duration;

use super::units::decimal;
use crate::scene::{Schedule, flag_name};
use crate::study::estimate::Estimate;
use crate::study::forecast::Forecast;

/// Seconds from which on a part of the time is worth its words.
const SMALLEST: f64 = 0.005;

/// The time of a render in words.
pub(super) fn time(forecast: &Forecast) -> String {
    let Forecast { threads, paths, seconds, learning, sampling, edges, .. } = forecast;
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
    let spread = seconds.error.map_or_else(String::new, |error| {
        // Two standard errors.
        format!(" ± {:.0} %", 200.0 * error / seconds.value)
    });
    let threads = if *threads == 1 { "1 thread".to_owned() } else { format!("{threads} threads") };
    format!("about {}{spread} on {threads}: {}", duration(seconds.value), parts.join(", "))
}

/// Which schedule is faster, in words; `used` is the one that is set.
pub(super) fn schedule(forecast: &Forecast, used: Schedule) -> String {
    let Some((schedule, Estimate { value, error })) = forecast.faster() else {
        return "wavefront and per-pixel take about the same time".to_owned();
    };
    let other = if schedule == Schedule::Wavefront { Schedule::PerPixel } else { Schedule::Wavefront };
    let (name, slower) = (flag_name(schedule), flag_name(other));
    let advice = if schedule == used { String::new() } else { format!(": render with --schedule {name}") };
    format!("{name} is {value:.2} ± {:.2} times as fast as {slower}{advice}", 2.0 * error.unwrap_or(0.0))
}

/// Whole seconds, or three digits of less than ten.
fn duration(seconds: f64) -> String {
    if seconds < 9.995 {
        return format!("{seconds:.2}s");
    }
    humantime::format_duration(Duration::from_secs(seconds.round() as u64)).to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

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
        let words = "about 1m 30s ± 10 % on 2 threads: 1.25s to learn of lights, \
                     1m 20s for 2.00 M paths (25.0 k paths/s), 8.75s for edges of lamps";
        assert_eq!(time(&forecast), words);
        let advice = "per-pixel is 2.00 ± 0.20 times as fast as wavefront";
        assert_eq!(schedule(&forecast, Schedule::PerPixel), advice);
        let advice = format!("{advice}: render with --schedule per-pixel");
        assert_eq!(schedule(&forecast, Schedule::Wavefront), advice);
        (forecast.learning, forecast.edges, forecast.threads) = (0.0, exactly(0.0), 1);
        let words = "about 1m 30s ± 10 % on 1 thread: 1m 20s for 2.00 M paths (25.0 k paths/s)";
        assert_eq!(time(&forecast), words);
        forecast.per_pixel_over_wavefront = exactly(1.02);
        assert!(schedule(&forecast, Schedule::Wavefront).contains("about the same"));
    }
}
