//! Whether a picture fits in memory, asked before it is allocated.

use sysinfo::{MemoryRefreshKind, RefreshKind, System};

use super::failure::Failure;
use super::units::bytes;
use crate::film::{Aov, BEAUTY};
use crate::scene::Settings;
use crate::trace::Run;

/// Bytes of a pixel's sums: four channels, and what is known of first hits, in f64.
const SUMS: (usize, usize) = (4 * size_of::<f64>(), 16 * size_of::<f64>());
/// Bytes of a pixel of the preview.
const PREVIEW: usize = 3;

/// Bytes that a picture of this many pixels needs: sums over samples, finished planes in f32, and the preview.
pub(super) fn film_bytes(pixels: u64, aovs: &[Aov]) -> u64 {
    let channels = BEAUTY.len() + aovs.iter().map(|aov| aov.channels().len()).sum::<usize>();
    let sums = if aovs.is_empty() { SUMS.0 } else { SUMS.0 + SUMS.1 };
    pixels.saturating_mul((sums + channels * size_of::<f32>() + PREVIEW) as u64)
}

/// Bytes that are free, the limits of a container included; `None` where the system does not tell.
fn available() -> Option<u64> {
    let memory = RefreshKind::nothing().with_memory(MemoryRefreshKind::nothing().with_ram());
    let system = System::new_with_specifics(memory);
    let free = system.available_memory();
    let allowed = system.cgroup_limits().map_or(free, |limits| limits.free_memory);
    (free > 0).then_some(free.min(allowed))
}

/// Refuses a film that would not fit.
pub(super) fn check(settings: &Settings, run: &Run) -> Result<(), Failure> {
    let (width, height) =
        run.crop.map_or((settings.width, settings.height), |[x0, y0, x1, y1]| (x1 - x0, y1 - y0));
    let needed = film_bytes((width as u64).saturating_mul(height as u64), &run.aovs);
    match available() {
        Some(free) if needed > free => Err(Failure::new(format!(
            "a film of {width}x{height} pixels needs {} of memory, and {} are free",
            bytes(needed),
            bytes(free)
        ))
        .help("give a smaller --size, a --crop, or fewer planes in --aov")),
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn planes_that_are_asked_for_count() {
        assert_eq!(film_bytes(10, &[]), 10 * (4 * 8 + 4 * 4 + 3));
        assert_eq!(film_bytes(10, &[Aov::Depth, Aov::Normal]), 10 * (20 * 8 + 8 * 4 + 3));
        assert_eq!(film_bytes(u64::MAX, &[]), u64::MAX);
    }

    #[test]
    fn a_film_beyond_all_memory_is_refused_and_its_crop_is_not() {
        let settings = Settings { width: 1 << 31, height: 1 << 31, ..Settings::default() };
        let message = check(&settings, &Run::default()).unwrap_err().to_string();
        assert!(message.contains("2147483648x2147483648") && message.contains("--size"), "{message}");
        let crop = Run { crop: Some([5, 5, 10, 10]), ..Run::default() };
        assert!(check(&settings, &crop).is_ok());
    }
}
