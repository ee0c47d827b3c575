//! Random numbers for what happens to a path.

use super::super::job::Job;
use super::super::path::Path;
use crate::shade::{Key, SamplePoint};

/// Consumer of random numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Draw {
    /// The camera ray, or the next ray from a vertex.
    Ray,
    /// A light ray from a vertex.
    Light,
    /// A light ray at a mirror or glass.
    Bend,
    /// A ray at a surface that is not opaque.
    Pass,
}

impl Draw {
    /// Key of its numbers, at a depth (of passages: a count) of at most [`MAX_SEGMENTS`](crate::scene::MAX_SEGMENTS): 0
    /// for the camera.
    #[inline]
    pub fn key(self, path: &Path, depth: u32) -> Key {
        Key { pixel: path.pixel, sample: path.sample, set: ((self as u32) << 16) + depth }
    }
}

/// Random numbers for a vertex, each in [0, 1).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Numbers {
    /// For the next ray.
    pub ray: [f32; 4],
    /// For a light ray, where lights are sampled.
    pub light: [f64; 2],
}

impl Numbers {
    /// Those for where `path` has landed.
    pub fn draw(job: &Job, path: &Path) -> Self {
        let key = |draw: Draw| draw.key(path, path.depth);
        let light = if job.illumination.is_some() { job.sampler.point(key(Draw::Light)) } else { [0.0; 2] };
        Self { ray: job.sampler.point(key(Draw::Ray)), light }
    }
}

/// Random numbers for many paths, drawn side by side.
#[derive(Default)]
pub struct Draws {
    keys: Vec<Key>,
    ray: Vec<[f32; 4]>,
    light: Vec<[f64; 2]>,
}

impl Draws {
    /// Draws for the camera rays of `paths`.
    pub fn cameras<'a>(&mut self, job: &Job, paths: impl Iterator<Item = &'a Path>) {
        let keys = paths.map(|path| Draw::Ray.key(path, 0));
        draw(job, keys, &mut self.keys, &mut self.ray);
    }

    /// Draws for where `paths` have landed.
    pub fn vertices<'a>(&mut self, job: &Job, paths: impl Iterator<Item = &'a Path> + Clone) {
        let keys = |draw: Draw| paths.clone().map(move |path| draw.key(path, path.depth));
        draw(job, keys(Draw::Ray), &mut self.keys, &mut self.ray);
        if job.illumination.is_some() {
            draw(job, keys(Draw::Light), &mut self.keys, &mut self.light);
        }
    }

    /// The numbers for the camera ray with this place among them.
    #[inline]
    pub fn camera(&self, place: usize) -> [f32; 4] {
        self.ray[place]
    }

    /// The numbers for the path with this place among those that landed.
    #[inline]
    pub fn vertex(&self, place: usize) -> Numbers {
        let light = if self.light.is_empty() { [0.0; 2] } else { self.light[place] };
        Numbers { ray: self.ray[place], light }
    }
}

fn draw<P: SamplePoint>(
    job: &Job,
    from: impl Iterator<Item = Key>,
    keys: &mut Vec<Key>,
    numbers: &mut Vec<P>,
) {
    keys.clear();
    keys.extend(from);
    job.sampler.points(keys, numbers);
}
