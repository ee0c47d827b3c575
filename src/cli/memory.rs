//! Check that a picture fits in memory, before it is allocated.

use std::num::NonZero;

use super::failure::Failure;
use crate::asset::Memory;
use crate::film::BEAUTY;
use crate::scene::Settings;
use crate::trace::Run;

/// Bytes of a pixel of the preview.
const PREVIEW: usize = 3;
/// Most rays that a worker has in flight, whatever the batch: 16 samples of the pixels of a tile.
const LANES: usize = 1 << 14;
/// Bytes of a ray in flight; 900 were measured near a hole.
const LANE: usize = 1 << 10;
/// Bytes of a ray that is kept, with its end by several steppers.
const KEPT: u64 = 256;
/// Bytes of a thread beside: its stack, and the samples of a tile.
const THREAD: usize = 4 << 20;

/// Bytes that a picture needs at most: first sums over samples, which go as the finished planes come, then the planes
/// in f32 and the preview.
pub(super) fn film_bytes(settings: &Settings, run: &Run) -> u64 {
    let (width, height) = size(settings, run);
    let pixels = (width as u64).saturating_mul(height as u64);
    let channels = BEAUTY.len() + run.aovs.iter().map(|aov| aov.channels().len()).sum::<usize>();
    let finished = channels * size_of::<f32>() + PREVIEW;
    pixels.saturating_mul(run.pixel_bytes().max(finished) as u64)
}

/// Bytes that worker threads need at most.
fn thread_bytes(run: &Run) -> u64 {
    let cores = || std::thread::available_parallelism().map_or(1, NonZero::get);
    let threads = if run.threads == 0 { cores() } else { run.threads };
    (threads * (run.batch.min(LANES) * LANE + THREAD)) as u64
}

/// Columns and rows that are rendered.
fn size(settings: &Settings, run: &Run) -> (usize, usize) {
    run.crop.map_or((settings.width, settings.height), |[x0, y0, x1, y1]| (x1 - x0, y1 - y0))
}

/// Refuses a film or threads that would not fit.
pub(super) fn check(settings: &Settings, run: &Run, memory: &Memory) -> Result<(), Failure> {
    let (width, height) = size(settings, run);
    memory.check("what the threads work on", thread_bytes(run)).map_err(|flaw| {
        Failure::new(flaw.problem).help("give fewer --threads, a smaller --batch, or more with --max-memory")
    })?;
    memory.check(format!("a film of {width}x{height} pixels"), film_bytes(settings, run)).map_err(|flaw| {
        Failure::new(flaw.problem)
            .help("give a smaller --size, a --crop, fewer planes in --aov, or more with --max-memory")
    })
}

/// Refuses pictures all of whose rays are kept, if they would not fit.
pub(super) fn check_kept((width, height): (usize, usize), memory: &Memory) -> Result<(), Failure> {
    let needed = (width as u64).saturating_mul(height as u64).saturating_mul(KEPT);
    memory
        .check(format!("all rays of a picture of {width}x{height} pixels"), needed)
        .map_err(|flaw| Failure::new(flaw.problem).help("give a smaller --size, or more with --max-memory"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::Aov;

    #[test]
    fn planes_that_are_asked_for_count() {
        let settings = Settings { width: 5, height: 2, ..Settings::default() };
        let with = |aovs: &[Aov]| film_bytes(&settings, &Run { aovs: aovs.to_vec(), ..Run::default() });
        assert_eq!(with(&[]), 10 * 4 * 8);
        assert_eq!(with(&[Aov::Variance]), 10 * (4 + 3 * 8) * 8, "of eight runs");
        assert_eq!(film_bytes(&settings, &Run { noise: Some(0.1), ..Run::default() }), 10 * 28 * 8);
        assert_eq!(with(&[Aov::Depth]), 10 * 6 * 8, "its sum, and how many samples hit");
        assert!(with(&[Aov::Depth, Aov::Normal]) > with(&[Aov::Depth]));
        let crop = Run { crop: Some([1, 1, 4, 2]), ..Run::default() };
        assert_eq!(film_bytes(&settings, &crop), 3 * 4 * 8);
        let huge = Settings { width: usize::MAX, height: usize::MAX, ..Settings::default() };
        assert_eq!(film_bytes(&huge, &Run::default()), u64::MAX);
    }

    #[test]
    fn a_film_beyond_all_memory_is_refused_and_its_crop_is_not() {
        let settings = Settings { width: 1 << 31, height: 1 << 31, ..Settings::default() };
        let message = check(&settings, &Run::default(), &Memory::default()).unwrap_err().to_string();
        assert!(message.contains("2147483648x2147483648") && message.contains("--size"), "{message}");
        let crop = Run { crop: Some([5, 5, 10, 10]), ..Run::default() };
        let many = Run { threads: 1 << 20, batch: 1 << 20, ..crop.clone() };
        let message = check(&settings, &many, &Memory::default()).unwrap_err().to_string();
        assert!(message.contains("threads") && message.contains("--batch"), "{message}");
        assert!(check(&settings, &crop, &Memory::default()).is_ok());
    }
}
