//! Summary of a render.

use super::units::decimal;
use crate::trace::{Fates, Rendered};

/// Size, samples, time and speed, on one line.
pub(super) fn line(rendered: &Rendered, asked_spp: u32) -> String {
    let Rendered { image, spp, stats, .. } = rendered;
    let mut parts = vec![format!("{}x{}", image.size.0, image.size.1)];
    if image.size != (image.width, image.height) {
        parts.push(format!("cropped from {}x{}", image.width, image.height));
    }
    parts.push(if *spp < asked_spp { format!("{spp} of {asked_spp} spp") } else { format!("{spp} spp") });
    parts.push(format!("{:.2} s", stats.seconds));
    if stats.seconds > 0.0 {
        let rates = [
            (stats.counters.paths, "paths/s"),
            (stats.counters.rays, "rays/s"),
            (stats.counters.steps, "steps/s"),
        ];
        let known = rates.iter().filter(|(count, _)| *count > 0);
        parts.extend(known.map(|(count, unit)| format!("{} {unit}", decimal(*count as f64 / stats.seconds))));
    }
    parts.join(", ")
}

/// Losses of the picture against what was asked for, one line each.
pub(super) fn losses(rendered: &Rendered, asked_spp: u32, interrupted: bool) -> Vec<String> {
    let Fates { step_limit, non_finite, .. } = rendered.stats.counters.fates;
    let mut losses = Vec::new();
    if rendered.unsampled > 0 {
        let why = if interrupted { "interrupted" } else { "the time limit was over" };
        let (without, all) = (rendered.unsampled, rendered.pixels());
        losses.push(format!("{why}: {without} of {all} pixels have no sample and are black"));
    } else if interrupted && rendered.spp < asked_spp {
        losses.push(format!("interrupted: every pixel holds {} of {asked_spp} samples", rendered.spp));
    }
    if step_limit > 0 {
        losses.push(format!("{} lost at the step limit", rays(step_limit, rendered.stats.counters.rays)));
    }
    if non_finite > 0 {
        losses.push(format!(
            "{} lost to numbers that are not finite",
            rays(non_finite, rendered.stats.counters.rays)
        ));
    }
    losses
}

fn rays(count: u64, all: u64) -> String {
    let noun = if count == 1 { "ray" } else { "rays" };
    format!("{count} {noun} of {all} ({:.2e} %)", 100.0 * count as f64 / all.max(count) as f64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::Image;
    use crate::trace::{Counters, Stats};

    fn rendered(fates: Fates) -> Rendered {
        let image = Image {
            width: 16,
            height: 12,
            origin: (0, 0),
            size: (4, 4),
            channels: Vec::new(),
            attributes: Vec::new(),
        };
        let counters = Counters { paths: 3_000_000, rays: 8_000_000, fates, ..Counters::default() };
        let stats = Stats { seconds: 2.0, counters, ..Stats::default() };
        Rendered { image, spp: 8, unsampled: 0, stats }
    }

    #[test]
    fn the_line_tells_size_samples_time_and_known_rates() {
        let picture = rendered(Fates::default());
        assert!(line(&picture, 64).contains("8 of 64 spp"));
        let line = line(&picture, 8);
        assert_eq!(line, "4x4, cropped from 16x12, 8 spp, 2.00 s, 1.50 M paths/s, 4.00 M rays/s");
    }

    #[test]
    fn a_complete_picture_has_no_losses() {
        let fates = Fates { hit: 5, escaped: 5, captured: 5, ..Fates::default() };
        assert!(losses(&rendered(fates), 8, false).is_empty());
    }

    #[test]
    fn lost_rays_and_an_interruption_are_named_with_counts() {
        let fates = Fates { step_limit: 1, non_finite: 80, ..Fates::default() };
        let losses = losses(&rendered(fates), 64, true);
        assert_eq!(losses[0], "interrupted: every pixel holds 8 of 64 samples");
        assert_eq!(losses[1], "1 ray of 8000000 (1.25e-5 %) lost at the step limit");
        assert!(losses[2].starts_with("80 rays of 8000000"));
    }

    #[test]
    fn pixels_without_samples_are_counted_whatever_ended_the_render() {
        let picture = Rendered { spp: 0, unsampled: 5, ..rendered(Fates::default()) };
        let of = |interrupted| losses(&picture, 64, interrupted).join("|");
        assert_eq!(of(false), "the time limit was over: 5 of 16 pixels have no sample and are black");
        assert_eq!(of(true), "interrupted: 5 of 16 pixels have no sample and are black");
    }
}
