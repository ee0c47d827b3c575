//! A tile of the picture: sums over samples, in f64 and in sample order.

use std::borrow::Borrow;
use std::ops::Range;

use glam::{DVec3, Vec3};

use super::fate::Fate;
use super::samples::{FirstHit, Samples, Wanted};
use crate::film::{Aov, BEAUTY, Image, Plane};

/// Columns and rows of a tile.
pub const TILE: usize = 32;

/// Sums over the samples of the pixels of a tile.
pub struct Tile {
    /// First column and row.
    pub origin: (usize, usize),
    /// Columns and rows.
    pub size: (usize, usize),
    /// Samples that each pixel holds.
    pub spp: u32,
    beauty: Vec<[f64; 4]>,
    squares: Vec<[f64; 3]>,
    first: Vec<FirstSums>,
    steps: Vec<u64>,
}

/// Sums over the first hits of a pixel.
#[derive(Clone, Copy, Debug, Default)]
struct FirstSums {
    hits: u32,
    depth: f64,
    position: DVec3,
    normal: DVec3,
    albedo: DVec3,
    /// Entity + 1 and fate of the first sample: identities have no mean.
    entity: u32,
    fate: u8,
}

impl Tile {
    /// Bytes for each pixel.
    pub fn pixel_bytes(wanted: Wanted) -> usize {
        let optional = |yes: bool, bytes: usize| if yes { bytes } else { 0 };
        size_of::<[f64; 4]>()
            + optional(wanted.variance, size_of::<[f64; 3]>())
            + optional(wanted.first_hit, size_of::<FirstSums>())
            + optional(wanted.steps, size_of::<u64>())
    }

    /// An empty tile.
    pub fn new(origin: (usize, usize), size: (usize, usize), wanted: Wanted) -> Self {
        let pixels = size.0 * size.1;
        let optional = |yes: bool| if yes { pixels } else { 0 };
        Self {
            origin,
            size,
            spp: 0,
            beauty: vec![[0.0; 4]; pixels],
            squares: vec![[0.0; 3]; optional(wanted.variance)],
            first: vec![FirstSums::default(); optional(wanted.first_hit)],
            steps: vec![0; optional(wanted.steps)],
        }
    }

    /// Adds `count` more samples of every pixel, pixel by pixel.
    pub fn add(&mut self, samples: &Samples, count: u32) {
        let per_pixel = count as usize;
        for pixel in 0..self.beauty.len() {
            self.add_to(pixel, samples, pixel * per_pixel..(pixel + 1) * per_pixel, self.spp == 0);
        }
        self.spp += count;
    }

    /// Puts other samples in the place of all that some pixels hold, pixel by pixel.
    pub fn replace(&mut self, pixels: &[u32], samples: &Samples) {
        let per_pixel = self.spp as usize;
        for (place, &pixel) in pixels.iter().enumerate() {
            let pixel = pixel as usize;
            self.beauty[pixel] = Default::default();
            self.squares.get_mut(pixel).map(std::mem::take);
            self.first.get_mut(pixel).map(std::mem::take);
            self.steps.get_mut(pixel).map(std::mem::take);
            self.add_to(pixel, samples, place * per_pixel..(place + 1) * per_pixel, true);
        }
    }

    /// Adds the samples of some slots to a pixel; `is_new` if it holds none.
    fn add_to(&mut self, pixel: usize, samples: &Samples, slots: Range<usize>, is_new: bool) {
        let start = slots.start;
        for slot in slots {
            let radiance = samples.radiance[slot].as_dvec3();
            let covered = f64::from(u8::from(samples.covered[slot]));
            let values = [radiance.x, radiance.y, radiance.z, covered];
            self.beauty[pixel].iter_mut().zip(values).for_each(|(sum, value)| *sum += value);
            if let Some(squares) = self.squares.get_mut(pixel) {
                squares.iter_mut().zip((radiance * radiance).to_array()).for_each(|(s, v)| *s += v);
            }
            if let Some(first) = self.first.get_mut(pixel) {
                first.add(&samples.first[slot], is_new && slot == start);
            }
            if let Some(steps) = self.steps.get_mut(pixel) {
                *steps += u64::from(samples.steps[slot]);
            }
        }
    }

    /// Mean colour of a pixel.
    fn mean(&self, pixel: usize) -> Vec3 {
        let [r, g, b, _] = self.beauty[pixel].map(|sum| (sum / self.count()) as f32);
        Vec3::new(r, g, b)
    }

    /// Variance of the mean of a pixel's channels: sample variance over the number of samples.
    fn variance(&self, pixel: usize) -> [f32; 3] {
        let n = self.count();
        std::array::from_fn(|channel| {
            let mean = self.beauty[pixel][channel] / n;
            let spread = (self.squares[pixel][channel] / n - mean * mean).max(0.0);
            (spread / (n - 1.0).max(1.0)) as f32
        })
    }

    fn count(&self) -> f64 {
        f64::from(self.spp.max(1))
    }

    /// Sum over pixels of the standard error relative to the pixel's brightness, and how many pixels that is.
    pub fn relative_error(&self) -> (f64, usize) {
        let of = |pixel: usize| {
            let error = self.variance(pixel).iter().sum::<f32>().sqrt();
            f64::from(error / (self.mean(pixel).length() + 1e-3))
        };
        ((0..self.beauty.len()).map(of).sum(), self.beauty.len())
    }

    /// The values of a pixel's channels for `aov`.
    fn values(&self, aov: Aov, pixel: usize) -> Vec<f32> {
        let first = || self.first[pixel];
        let vector = |v: DVec3| v.as_vec3().to_array().to_vec();
        match aov {
            Aov::Depth => {
                let first = first();
                vec![if first.hits == 0 {
                    f32::INFINITY
                } else {
                    (first.depth / f64::from(first.hits)) as f32
                }]
            }
            Aov::Position => vector(first().position / f64::from(first().hits.max(1))),
            Aov::Normal => vector(first().normal / self.count()),
            Aov::Albedo => vector(first().albedo / self.count()),
            Aov::Entity => vec![first().entity as f32],
            Aov::Fate => vec![f32::from(first().fate)],
            Aov::Variance => self.variance(pixel).to_vec(),
            Aov::Steps => vec![(self.steps[pixel] as f64 / self.count()) as f32],
        }
    }
}

impl FirstSums {
    fn add(&mut self, hit: &FirstHit, is_first_sample: bool) {
        let on_surface = hit.fate == Fate::Hit;
        if is_first_sample {
            self.entity = if on_surface { hit.entity + 1 } else { 0 };
            self.fate = hit.fate as u8;
        }
        if on_surface {
            self.hits += 1;
            self.depth += hit.depth;
            self.position += hit.position;
            self.normal += hit.normal;
            self.albedo += hit.albedo.as_dvec3();
        }
    }
}

/// Tiles that cover the window `origin`, `size`, row by row.
pub fn cover(origin: (usize, usize), size: (usize, usize), wanted: Wanted) -> Vec<Tile> {
    let mut tiles = Vec::new();
    for y in (0..size.1).step_by(TILE) {
        for x in (0..size.0).step_by(TILE) {
            let extent = (TILE.min(size.0 - x), TILE.min(size.1 - y));
            tiles.push(Tile::new((origin.0 + x, origin.1 + y), extent, wanted));
        }
    }
    tiles
}

/// Puts tiles together: R, G, B, A, then the planes of `aovs` in their order, into `image`. Tiles go as the planes fill.
pub fn assemble<T: Borrow<Tile>>(tiles: impl Iterator<Item = T>, aovs: &[Aov], image: &mut Image) {
    let (width, height) = image.size;
    let names = BEAUTY.iter().chain(aovs.iter().flat_map(|aov| aov.channels()));
    image.planes =
        names.map(|name| Plane { name: name.to_string(), values: vec![0.0; width * height] }).collect();
    for tile in tiles {
        let tile: &Tile = tile.borrow();
        for pixel in 0..tile.size.0 * tile.size.1 {
            let x = tile.origin.0 - image.origin.0 + pixel % tile.size.0;
            let y = tile.origin.1 - image.origin.1 + pixel / tile.size.0;
            let beauty = tile.beauty[pixel].map(|sum| (sum / tile.count()) as f32);
            let extra = aovs.iter().flat_map(|&aov| tile.values(aov, pixel));
            for (plane, value) in image.planes.iter_mut().zip(beauty.into_iter().chain(extra)) {
                plane.values[y * width + x] = value;
            }
        }
    }
}
