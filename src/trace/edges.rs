//! Edges of lamps, as the camera sees them: directly, in mirrors and through glass.
//!
//! Where a pixel sees the edge of a lamp, a camera path brings either all of its light or none: once light on surfaces
//! is sampled well, that is most of what is left of the noise. Probes find such pixels: one before the first sample, more
//! as the samples grow in number. There, what the camera sees of lamps is gathered by [`SPLIT`] short paths for each whole
//! one, which leaves that light out. Which pixels these are depends on the probes alone, so that the picture's expectation
//! is unchanged; and for each sample on its own number alone, so that it does not matter how many are asked for.

use glam::Vec3;

use super::pass_of;
use super::samples::Samples;
use super::work::{Lattice, Share, Work};
use crate::scene::{Baked, MAX_SPP, Settings};

/// Short paths for each whole one: the mean of well-distributed points across an edge errs as their number to the
/// power -3/4, so that these leave an eighth.
const SPLIT: u32 = 16;
/// Probes of a pixel that come early: as many as samples.
const EARLY_PROBES: u32 = 16;
/// Samples of a pixel for each of its later probes, so that their cost is in proportion: an image of a lamp too small for any
/// probe to meet is met by few samples.
const SAMPLES_PER_PROBE: u32 = 4;
/// Number of the first probe: samples that no picture has.
const FIRST_PROBE: u32 = MAX_SPP;
/// Relative difference of what is seen from which on it counts: rounding does not.
const DIFFERENCE: f32 = 1e-3;

/// Pixels of a tile that see edges of lamps.
#[derive(Clone, Debug, Default)]
pub struct Edges {
    /// Their numbers in the tile, row by row.
    pixels: Vec<u32>,
    /// Whether each pixel of the tile is one; empty if none is.
    marks: Vec<bool>,
    /// Probes so far of each pixel.
    probes: u32,
}

impl Edges {
    /// Probes of a pixel that decide how the samples of the pass that starts with this one are taken.
    fn probes_before(sample: u32) -> u32 {
        sample.clamp(1, EARLY_PROBES).max(sample / SAMPLES_PER_PROBE)
    }

    /// Probes of a pixel for a picture of so many samples.
    pub fn probes(spp: u32) -> u32 {
        Self::probes_before(pass_of(spp - 1).start)
    }

    /// Finds more edges in the part of a picture that starts at `origin`, of `size` pixels, before its sample of number
    /// `first_sample` is taken. Gives those of them whose samples so far are worth taking again, with short paths: few samples
    /// without them would make most of the noise of all. `probe` traces; `None`, and nothing changed, if it does.
    pub fn refine(
        &mut self,
        (origin, size): ((usize, usize), (usize, usize)),
        settings: &Settings,
        first_sample: u32,
        probe: impl FnOnce(&Work) -> Option<Samples>,
    ) -> Option<Self> {
        let probes = Self::probes_before(first_sample).saturating_sub(self.probes);
        if probes == 0 {
            return Some(Self::default());
        }
        // Filters reach one pixel far, and so does what a probe says.
        let low = (origin.0.saturating_sub(1), origin.1.saturating_sub(1));
        let high =
            ((origin.0 + size.0 + 1).min(settings.width), (origin.1 + size.1 + 1).min(settings.height));
        let around = (high.0 - low.0, high.1 - low.1);
        let work = Work {
            origin: low,
            size: around,
            lattice: Lattice::ALL,
            first_sample: FIRST_PROBE + self.probes,
            samples: probes,
            share: Share::Lamps,
        };
        let seen: Vec<(Vec3, Vec3)> = probe(&work)?
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
        self.probes += probes;
        let marks: Vec<bool> =
            (0..size.0 * size.1).map(|pixel| self.holds(pixel as u32) || is_edge(pixel)).collect();
        let pixels: Vec<u32> = (0..).zip(&marks).filter(|(_, mark)| **mark).map(|(pixel, _)| pixel).collect();
        let is_early = (1..=EARLY_PROBES).contains(&first_sample);
        let found = pixels.iter().copied().filter(|&pixel| is_early && !self.holds(pixel)).collect();
        self.marks = if pixels.is_empty() { Vec::new() } else { marks };
        self.pixels = pixels;
        Some(Self { pixels: found, ..Self::default() })
    }

    /// Whether a picture of `scene` may have them.
    pub fn are_useful(scene: &Baked) -> bool {
        scene.materials.iter().any(|material| material.emits())
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
        // Past 2^28 samples the same numbers come again, as far as that is from mattering.
        let (first_sample, samples) = (SPLIT.wrapping_mul(first_sample), SPLIT * samples);
        let share = Share::Edges(self);
        (!self.pixels.is_empty()).then_some(Work { origin, size, lattice, first_sample, samples, share })
    }

    /// Adds what the paths of [`Self::work`] saw to the whole ones of `work`.
    pub fn add(&self, seen: &Samples, work: &Work, whole: &mut Samples) {
        let count = work.samples as usize;
        let slots = self.pixels.iter().enumerate().flat_map(|(place, &pixel)| {
            let place = if matches!(work.share, Share::Beyond(_)) { place } else { pixel as usize };
            (0..count).map(move |sample| place * count + sample)
        });
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::{Image, Wanted};
    use crate::scene::load;
    use crate::trace::tile;
    use crate::trace::transport::{Errand, Transport};
    use crate::trace::with_render_transport;
    use crate::trace::work::Job;
    use crate::trace::worker::Workers;

    /// Samples per pixel without short paths to the edges of lamps, and with them.
    const WITHOUT: u32 = 3;
    const WITH: u32 = 16;

    /// A lamp seen past a hole, in a mirror and through a ball of glass, with nothing else to see.
    const LAMPS: &str = r#"
        [spacetime]
        kind = "schwarzschild"
        schwarzschild_radius = 0.4
        [camera]
        position = [0, 0, -12]
        direction = [0, 0, 1]
        vertical_fov = 40
        [film]
        width = 40
        height = 30
        filter = "box"
        [render]
        sampler = "independent"
        max_depth = 8
        [[material]]
        name = "lamp"
        albedo = 0
        emission = 100
        [[material]]
        name = "mirror"
        kind = "mirror"
        [[material]]
        name = "glass"
        kind = "dielectric"
        [[entity]]
        sphere = { center = [0.5, 1, 4], radius = 0.7 }
        material = "lamp"
        [[entity]]
        sphere = { center = [-3, 0, 0], radius = 1.2 }
        material = "mirror"
        [[entity]]
        sphere = { center = [2.7, 0.5, -1], radius = 1.1 }
        material = "glass"
    "#;

    /// The red plane of a picture, with or without short paths.
    struct Picture<'a> {
        scene: &'a Baked,
        splits: bool,
    }

    impl Errand for Picture<'_> {
        type Output = Vec<f64>;

        fn run<T: Transport>(self, transport: &T) -> Vec<f64> {
            let settings = &self.scene.settings;
            let job = Job::new(self.scene, settings);
            let workers = Workers::new(&job, transport, Wanted::default(), 1024);
            let size = (settings.width, settings.height);
            let mut tiles = tile::cover((0, 0), size, Wanted::default());
            for tile in &mut tiles {
                let mut edges = Edges::default();
                while self.splits && tile.spp < settings.spp {
                    let end = pass_of(tile.spp).end.min(settings.spp);
                    workers.own().pass(tile, &mut edges, end).unwrap();
                }
                if !self.splits {
                    let samples = workers.own().samples(tile, Share::Whole(&edges), 0..settings.spp).unwrap();
                    tile.add(&samples, settings.spp);
                }
            }
            let (width, height) = size;
            let (planes, attributes) = (Vec::new(), Vec::new());
            let mut image = Image { width, height, origin: (0, 0), size, planes, attributes };
            tile::assemble(tiles, &[], &mut image);
            image.plane("R").unwrap().iter().map(|&value| f64::from(value)).collect()
        }
    }

    /// Means over pictures with different seeds, and their variances.
    fn statistics(scene: &mut Baked, splits: bool, pictures: u32) -> Vec<(f64, f64)> {
        scene.settings.spp = if splits { WITH } else { WITHOUT };
        let shots: Vec<Vec<f64>> = (0..pictures)
            .map(|seed| {
                scene.settings.seed = u64::from(seed);
                with_render_transport(scene, Picture { scene, splits })
            })
            .collect();
        let count = f64::from(pictures);
        (0..shots[0].len())
            .map(|pixel| {
                let mean = shots.iter().map(|shot| shot[pixel]).sum::<f64>() / count;
                let square = shots.iter().map(|shot| (shot[pixel] - mean).powi(2)).sum::<f64>();
                (mean, square / (count - 1.0) / count)
            })
            .collect()
    }

    #[test]
    fn short_paths_to_the_edges_of_lamps_take_away_most_of_their_noise_and_none_of_their_light() {
        const PICTURES: u32 = 48;
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("lamps.toml");
        std::fs::write(&path, LAMPS).unwrap();
        let mut scene = load(&path, &[]).unwrap();
        // About as many samples of both.
        let (without, with) =
            (statistics(&mut scene, false, 5 * PICTURES), statistics(&mut scene, true, PICTURES));
        let variance = |pixels: &[(f64, f64)]| pixels.iter().map(|(_, variance)| variance).sum::<f64>();
        let ratio = variance(&without) / variance(&with);
        let mean = |pixels: &[(f64, f64)]| pixels.iter().map(|(mean, _)| mean).sum::<f64>();
        let z = (mean(&with) - mean(&without)) / (variance(&without) + variance(&with)).sqrt();
        // Independent samples, 16 for 1: the whole of it, but for images of lamps that no probe met.
        assert!(ratio > 6.0, "{ratio}");
        assert!(z.abs() < 3.5, "{z}");
        // Pixel by pixel, where the noise is known: about one in 370 beyond 3 deviations.
        let deviations: Vec<f64> = without
            .iter()
            .zip(&with)
            .filter(|((mean, variance), (_, other))| *mean > 5.0 && *variance > 0.0 && *other > 0.0)
            .map(|((a, va), (b, vb))| (a - b) / (va + vb).sqrt())
            .collect();
        let count = deviations.len() as f64;
        let square = deviations.iter().map(|z| z * z).sum::<f64>() / count;
        assert!(count > 30.0 && square < 1.0 + 5.0 * (2.0 / count).sqrt(), "{square} of {count}");
    }

    #[test]
    fn probes_grow_with_the_samples_between_passes_only() {
        let before: Vec<u32> = [0, 1, 4, 8, 16, 32, 64, 80].map(Edges::probes_before).into();
        assert_eq!(before, [1, 1, 4, 8, 16, 16, 16, 20]);
        assert_eq!((Edges::probes(1), Edges::probes(16), Edges::probes(64)), (1, 8, 16));
        assert_eq!(Edges::probes(MAX_SPP), (MAX_SPP - 16) / 4);
    }
}
