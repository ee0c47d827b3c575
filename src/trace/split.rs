//! Short paths to the edges of lamps: what the camera sees of lamps there is gathered by [`SPLIT`] of them for each
//! whole path, which leaves that light out.

use glam::Vec3;

use super::samples::Samples;
use super::work::{Share, Work};
use crate::film::Wanted;

/// Short paths for each whole one: the mean of well-distributed points across an edge errs as their number to the
/// power -3/4, so that these leave an eighth.
const SPLIT: u32 = 16;

/// The samples of `work`, of its short paths too; `None` if `trace` had to give up.
pub fn trace_split(
    work: &Work,
    wanted: Wanted,
    mut trace: impl FnMut(&Work, Wanted) -> Option<Samples>,
) -> Option<Samples> {
    let mut samples = trace(work, wanted)?;
    if let Some(short) = short_paths(work) {
        add(&trace(&short, Wanted::default())?, work, &mut samples);
    }
    Some(samples)
}

/// The short paths that belong to the whole ones of `work`; `None` if there are none.
pub fn short_paths<'a>(work: &Work<'a>) -> Option<Work<'a>> {
    let (Share::Whole(edges) | Share::Beyond(edges)) = work.share else { return None };
    // Past 2^28 samples the same numbers come again, as far as that is from mattering.
    let (first_sample, samples) = (SPLIT.wrapping_mul(work.first_sample), SPLIT * work.samples);
    let share = Share::Edges(edges);
    (!edges.numbers().is_empty()).then_some(Work { first_sample, samples, share, ..*work })
}

/// Adds what the short paths of `work` saw to its whole ones.
fn add(seen: &Samples, work: &Work, whole: &mut Samples) {
    let (Share::Whole(edges) | Share::Beyond(edges)) = work.share else { return };
    let count = work.samples as usize;
    let slots = edges.numbers().iter().enumerate().flat_map(|(place, &pixel)| {
        let place = if matches!(work.share, Share::Beyond(_)) { place } else { pixel as usize };
        (0..count).map(move |sample| place * count + sample)
    });
    for (slot, seen) in slots.zip(seen.radiance.chunks_exact(SPLIT as usize)) {
        whole.radiance[slot] += seen.iter().sum::<Vec3>() / SPLIT as f32;
    }
}
