//! Edges of lamps, as the camera sees them: directly, in mirrors and through glass.
//!
//! In a pixel that sees the edge of a lamp, a camera path brings either all of its light or none: once light on
//! surfaces is sampled well, that is most of what is left of the noise. Probes find such pixels: one before the first
//! sample, more as the samples grow in number. There, what the camera sees of lamps is gathered by short paths
//! ([`split`](super::super::split)), several for each whole one, which leaves that light out. Which pixels these are
//! depends on the probes alone, so that the picture's expectation is unchanged; and for each sample on its own number
//! alone, so that it does not matter how many are asked for.
//!
//! Images of small lamps in mirrors, glass and beside holes are too small for so few probes. Where some come near a lamp
//! ([`lamp_halos`](super::super::lamp_halos)), many more follow.

use glam::Vec3;

use super::super::edge_pixels::EdgePixels;
use super::super::passes::pass_of;
use super::super::samples::Samples;
use super::super::work::{Lattice, Share, Work};
use crate::scene::{Baked, MAX_SPP};

/// Probes of a pixel that come early: as many as samples.
const EARLY_PROBES: u32 = 16;
/// Samples of a pixel for each of its later probes, so that their cost is in proportion: an image of a lamp too small
/// for any probe to meet is met by few samples.
const SAMPLES_PER_PROBE: u32 = 4;
/// Number of the first probe: samples that no picture has.
const FIRST_PROBE: u32 = MAX_SPP;
/// Number of the first closer probe.
const FIRST_CLOSER_PROBE: u32 = MAX_SPP + MAX_SPP / 2;
/// Closer probes for each probe of a pixel, of which a few come near a lamp, or more than one in [`FEW`]: as the image of
/// a lamp is about a 64th of that of its halo, they meet it then. Measured.
const CLOSER_PROBES: [u32; 2] = [128, 4];
const FEW: u32 = 4;
/// Relative difference of what is seen from which on it counts: rounding does not.
const DIFFERENCE: f32 = 1e-3;

/// Pixels of a tile that are known to see edges of lamps.
#[derive(Clone, Debug, Default)]
pub struct LampEdges {
    pixels: EdgePixels,
    /// Probes so far of each pixel.
    probes: u32,
    /// Those of them that came near a lamp, of each pixel and those around the tile; empty if none has.
    near_lamps: Vec<u32>,
}

/// Probes of a pixel that decide how its samples from this one on are taken, up to the end of its pass.
fn probes_before(sample: u32) -> u32 {
    let first = pass_of(sample).start;
    first.clamp(1, EARLY_PROBES).max(first / SAMPLES_PER_PROBE)
}

impl LampEdges {
    /// Probes of a pixel for a picture of so many samples.
    pub fn probes(spp: u32) -> u32 {
        probes_before(spp - 1)
    }

    /// Possibility of edges in a picture of `scene`.
    pub fn are_possible(scene: &Baked) -> bool {
        scene.materials.iter().any(|material| material.emits())
    }

    /// The pixels found so far.
    pub fn pixels(&self) -> &EdgePixels {
        &self.pixels
    }

    /// Finds more edges in the part of a picture that starts at `origin`, of `size` pixels, before its sample of number
    /// `first_sample` is taken. Gives those of them whose samples so far are worth taking again, with short paths: few
    /// samples without them would make most of the noise of all. `probe` traces; `None`, and nothing changed, if it
    /// does.
    pub fn refine(
        &mut self,
        scene: &Baked,
        (origin, size): ((usize, usize), (usize, usize)),
        first_sample: u32,
        probe: impl Fn(&Work) -> Option<Samples>,
    ) -> Option<EdgePixels> {
        let probes = probes_before(first_sample).saturating_sub(self.probes);
        if probes == 0 || !Self::are_possible(scene) {
            return Some(EdgePixels::default());
        }
        // Filters reach one pixel far, and so does what a probe says.
        let (width, height) = (scene.settings.width, scene.settings.height);
        let low = (origin.0.saturating_sub(1), origin.1.saturating_sub(1));
        let high = ((origin.0 + size.0 + 1).min(width), (origin.1 + size.1 + 1).min(height));
        let around = (high.0 - low.0, high.1 - low.1);
        let work = Work {
            origin: low,
            size: around,
            lattice: Lattice::ALL,
            first_sample: FIRST_PROBE + self.probes,
            samples: probes,
            share: Share::Lamps,
        };
        let samples = probe(&work)?;
        let mut seen: Vec<Seen> = seen_by(&samples, probes).collect();
        let near_lamps = self.near_lamps_after(&samples, probes);
        self.look_closer(&work, &near_lamps, &mut seen, &probe)?;
        let is_edge = |pixel: usize| {
            let (x, y) = (origin.0 + pixel % size.0 - low.0, origin.1 + pixel / size.0 - low.1);
            let rows = y.saturating_sub(1)..(y + 2).min(around.1);
            let columns = x.saturating_sub(1)..(x + 2).min(around.0);
            let near = rows.flat_map(|y| seen[y * around.0..][columns.clone()].iter());
            let (least, most) = range(near.flat_map(|&(least, most)| [least, most]));
            (most - least).cmpgt(DIFFERENCE * most).any()
        };
        self.probes += probes;
        self.near_lamps = near_lamps;
        let known = |pixel: usize| self.pixels.holds(pixel as u32);
        let pixels = 0..size.0 * size.1;
        let found: Vec<bool> = pixels.clone().map(|pixel| !known(pixel) && is_edge(pixel)).collect();
        self.pixels = EdgePixels::marked(pixels.map(|pixel| known(pixel) || found[pixel]).collect());
        let is_early = (1..=EARLY_PROBES).contains(&first_sample);
        Some(if is_early { EdgePixels::marked(found) } else { EdgePixels::default() })
    }

    /// Sends closer probes after those of `work`, the ones before included, that came near a lamp, so many of each pixel;
    /// adds what they see. `None` if `probe` gave up.
    fn look_closer(
        &self,
        work: &Work,
        near_lamps: &[u32],
        seen: &mut [Seen],
        probe: &impl Fn(&Work) -> Option<Samples>,
    ) -> Option<()> {
        for (closer, is_for_few) in CLOSER_PROBES.into_iter().zip([true, false]) {
            let are_few = |near: u32| FEW * near < self.probes + work.samples;
            let marks = near_lamps.iter().map(|&near| near > 0 && are_few(near) == is_for_few).collect();
            let pixels = EdgePixels::marked(marks);
            if pixels.numbers().is_empty() {
                continue;
            }
            // Past 2^22 probes the same numbers come again, as far as that is from mattering.
            let first_sample = FIRST_CLOSER_PROBE + closer.wrapping_mul(self.probes) % (MAX_SPP / 4);
            let samples = closer * work.samples;
            let closely = probe(&Work { first_sample, samples, share: Share::Edges(&pixels), ..*work })?;
            for (&pixel, more) in pixels.numbers().iter().zip(seen_by(&closely, samples)) {
                let all = &mut seen[pixel as usize];
                *all = (all.0.min(more.0), all.1.max(more.1));
            }
        }
        Some(())
    }

    /// Probes that came near a lamp, with more of them, so many for each pixel; none if none has.
    fn near_lamps_after(&self, samples: &Samples, count: u32) -> Vec<u32> {
        let found = samples.near_lamps.chunks_exact(count as usize);
        let found = found.map(|probes| probes.iter().filter(|is_near| **is_near).count() as u32);
        let before = self.near_lamps.iter().copied().chain(std::iter::repeat(0));
        found.zip(before).map(|(found, before)| before + found).collect()
    }
}

/// The least and the greatest of each component of what is seen.
type Seen = (Vec3, Vec3);

/// What each pixel's probes saw, so many of each.
fn seen_by(samples: &Samples, count: u32) -> impl Iterator<Item = Seen> {
    samples.radiance.chunks_exact(count as usize).map(|probes| range(probes.iter().copied()))
}

/// Both of some values.
fn range(values: impl Iterator<Item = Vec3>) -> Seen {
    values.fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(least, most), value| {
        (least.min(value), most.max(value))
    })
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::AtomicBool;

    use super::*;
    use crate::film::Wanted;
    use crate::scene::load;
    use crate::trace::choice::with_render_transport;
    use crate::trace::halt::Halt;
    use crate::trace::job::Job;
    use crate::trace::render::render;
    use crate::trace::run::Run;
    use crate::trace::transport::{Transport, TransportVisitor};
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

    /// The red plane of a picture, without short paths.
    struct Whole<'a>(&'a Baked);

    impl TransportVisitor for Whole<'_> {
        type Output = Vec<f64>;

        fn run<T: Transport + 'static>(self, transport: T) -> Vec<f64> {
            let settings = &self.0.settings;
            let job = Job::new(self.0, settings, Halt::default());
            let none = EdgePixels::default();
            let work = Work {
                origin: (0, 0),
                size: (settings.width, settings.height),
                lattice: Lattice::ALL,
                first_sample: 0,
                samples: settings.spp,
                share: Share::Whole(&none),
            };
            let workers = Workers::new(settings.schedule, 1024);
            let samples = workers.own().trace(&job, &transport, &work, Wanted::default()).unwrap();
            let pixels = samples.radiance.chunks_exact(settings.spp as usize);
            pixels.map(|pixel| f64::from(pixel.iter().sum::<Vec3>().x / settings.spp as f32)).collect()
        }
    }

    /// The red plane of a picture, with or without short paths.
    fn picture(scene: &Baked, splits: bool) -> Vec<f64> {
        if !splits {
            return with_render_transport(scene, Whole(scene));
        }
        let image = render(scene, &Run::default(), &AtomicBool::new(false), &|_| ()).image;
        image.channel("R").unwrap().iter().map(|&value| f64::from(value)).collect()
    }

    /// Means over pictures with different seeds, and their variances.
    fn statistics(scene: &mut Baked, splits: bool, pictures: u32) -> Vec<(f64, f64)> {
        scene.settings.spp = if splits { WITH } else { WITHOUT };
        let shots: Vec<Vec<f64>> = (0..pictures)
            .map(|seed| {
                scene.settings.seed = u64::from(seed);
                picture(scene, splits)
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

    /// Gain in variance by short paths in a scene, of independent samples, and the means of the pixels and their
    /// variances without them and with them.
    fn gain(text: &str) -> (f64, [Vec<(f64, f64)>; 2]) {
        const PICTURES: u32 = 48;
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("lamps.toml");
        std::fs::write(&path, text).unwrap();
        let mut scene = load(&path, &[]).unwrap();
        // About as many samples of both.
        let (without, with) =
            (statistics(&mut scene, false, 5 * PICTURES), statistics(&mut scene, true, PICTURES));
        let variance = |pixels: &[(f64, f64)]| pixels.iter().map(|(_, variance)| variance).sum::<f64>();
        let mean = |pixels: &[(f64, f64)]| pixels.iter().map(|(mean, _)| mean).sum::<f64>();
        let z = (mean(&with) - mean(&without)) / (variance(&without) + variance(&with)).sqrt();
        assert!(z.abs() < 3.5, "{z}");
        (variance(&without) / variance(&with), [without, with])
    }

    #[test]
    fn short_paths_to_the_edges_of_lamps_take_away_most_of_their_noise_and_none_of_their_light() {
        let (gain, [without, with]) = gain(LAMPS);
        // Independent samples, 16 for 1: the whole of it, but for images of lamps that no probe met.
        assert!(gain > 8.0, "{gain}");
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
    fn images_of_a_small_lamp_far_below_a_pixel_are_found_and_no_bright_dots() {
        // The lamp itself is hidden.
        let hidden = LAMPS.replace("radius = 0.7", "radius = 0.1").replacen(
            "[[entity]]",
            "[[entity]]\nsphere = { center = [0.3, 0.5, -4], radius = 0.4 }\nmaterial = \"wall\"\n[[entity]]",
            1,
        );
        let (gain, _) = gain(&(hidden + "[[material]]\nname = \"wall\"\nalbedo = 0\n"));
        // 3.4 without a closer look.
        assert!(gain > 7.0, "{gain}");
    }

    #[test]
    fn probes_grow_with_the_samples_between_passes_only() {
        let before: Vec<u32> = [0, 1, 4, 8, 16, 32, 64, 80].map(probes_before).into();
        assert_eq!(before, [1, 1, 4, 8, 16, 16, 16, 20]);
        assert_eq!((LampEdges::probes(1), LampEdges::probes(16), LampEdges::probes(64)), (1, 8, 16));
        assert_eq!(LampEdges::probes(MAX_SPP), (MAX_SPP - 16) / 4);
    }
}
