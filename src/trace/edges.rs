//! Edges of lamps, as the camera sees them: directly, in mirrors and through glass.
//!
//! Where a pixel sees the edge of a lamp, a camera path brings either all of its light or none: once light on surfaces
//! is sampled well, that is most of what is left of the noise. A few probes find such pixels beforehand. There, what the
//! camera sees of lamps is gathered by [`SPLIT`] short paths for each whole one, which leaves that light out. Which
//! pixels these are depends on the probes alone, so that the picture's expectation is unchanged.

use glam::Vec3;

use super::samples::Samples;
use super::work::{Lattice, Share, Work};
use crate::scene::{Baked, Settings};

/// Short paths for each whole one: the mean of well-distributed points across an edge errs as their number to the
/// power -3/4, so that these leave an eighth.
const SPLIT: u32 = 16;
/// Samples of a pixel for each of its probes, so that their cost is in proportion: an image of a lamp too small for any
/// probe to meet is met by few samples.
const SAMPLES_PER_PROBE: u32 = 4;
/// Number of the first probe: samples that no picture has.
const FIRST_PROBE: u32 = 1 << 31;
/// Relative difference of what is seen from which on it counts: rounding does not.
const DIFFERENCE: f32 = 1e-3;

/// Pixels of a tile that see edges of lamps.
#[derive(Clone, Debug, Default)]
pub struct Edges {
    /// Their numbers in the tile, row by row.
    pixels: Vec<u32>,
    /// Whether each pixel of the tile is one; empty if none is.
    marks: Vec<bool>,
}

impl Edges {
    /// The edges in the part of a picture that starts at `origin`, of `size` pixels. `probe`
    /// traces.
    pub fn find(
        (origin, size): ((usize, usize), (usize, usize)),
        settings: &Settings,
        probe: impl FnOnce(&Work) -> Samples,
    ) -> Self {
        // Filters reach one pixel far, and so does what a probe says.
        let low = (origin.0.saturating_sub(1), origin.1.saturating_sub(1));
        let high =
            ((origin.0 + size.0 + 1).min(settings.width), (origin.1 + size.1 + 1).min(settings.height));
        let around = (high.0 - low.0, high.1 - low.1);
        let probes = settings.spp / SAMPLES_PER_PROBE;
        let work = Work {
            origin: low,
            size: around,
            lattice: Lattice::ALL,
            first_sample: FIRST_PROBE,
            samples: probes,
            share: Share::Lamps,
        };
        let seen: Vec<(Vec3, Vec3)> = probe(&work)
            .radiance
            .chunks_exact(probes as usize)
            .map(|probes| range(probes.iter().copied()))
            .collect();
        let is_edge = |pixel: usize| {
            let (x, y) = (origin.0 + pixel % size.0 - low.0, origin.1 + pixel / size.0 - low.1);
            let rows = y.saturating_sub(1)..(y + 2).min(around.1);
            let columns = x.saturating_sub(1)..(x + 2).min(around.0);
            let near = rows.flat_map(|y| seen[y * around.0..][columns.clone()].iter());
            let (least, most) = range(near.flat_map(|&(least, most)| [least, most]));
            (most - least).cmpgt(DIFFERENCE * most).any()
        };
        let marks: Vec<bool> = (0..size.0 * size.1).map(is_edge).collect();
        let pixels: Vec<u32> = (0..).zip(&marks).filter(|(_, mark)| **mark).map(|(pixel, _)| pixel).collect();
        if pixels.is_empty() { Self::default() } else { Self { pixels, marks } }
    }

    /// Whether a picture of `scene` may have them and enough samples for a probe.
    pub fn are_useful(scene: &Baked) -> bool {
        scene.settings.spp >= SAMPLES_PER_PROBE && scene.materials.iter().any(|material| material.emits())
    }

    /// The pixels' numbers in the tile.
    pub fn pixels(&self) -> &[u32] {
        &self.pixels
    }

    /// Whether the tile's pixel `number` is one of them.
    #[inline]
    pub fn holds(&self, number: u32) -> bool {
        self.marks.get(number as usize).is_some_and(|mark| *mark)
    }

    /// The short paths that belong to the whole ones of `work`; `None` if there are none.
    pub fn work(&self, work: &Work) -> Option<Work<'_>> {
        let Work { origin, size, lattice, first_sample, samples, .. } = *work;
        let (first_sample, samples) = (SPLIT * first_sample, SPLIT * samples);
        let share = Share::Edges(self);
        (!self.pixels.is_empty()).then_some(Work { origin, size, lattice, first_sample, samples, share })
    }

    /// Adds what the paths of [`Self::work`] saw to the whole ones, `count` a pixel.
    pub fn add(&self, seen: &Samples, count: u32, whole: &mut Samples) {
        let count = count as usize;
        let slots = self
            .pixels
            .iter()
            .flat_map(|&pixel| (0..count).map(move |sample| pixel as usize * count + sample));
        for (slot, seen) in slots.zip(seen.radiance.chunks_exact(SPLIT as usize)) {
            whole.radiance[slot] += seen.iter().sum::<Vec3>() / SPLIT as f32;
        }
    }
}

/// The least and the greatest of each component.
fn range(values: impl Iterator<Item = Vec3>) -> (Vec3, Vec3) {
    values.fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(least, most), value| {
        (least.min(value), most.max(value))
    })
}
