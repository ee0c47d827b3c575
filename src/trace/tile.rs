//! A tile of the picture: sums over samples, in f64 and in sample order.

use std::borrow::Borrow;
use std::ops::Range;

use glam::Vec3;

use super::samples::Samples;
use crate::film::{Aov, BEAUTY, Channel, Image, Sums, Wanted};

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
    planes: Vec<Sums>,
}

impl Tile {
    /// Bytes for each pixel.
    pub fn pixel_bytes(wanted: Wanted) -> usize {
        size_of::<[f64; 4]>() + wanted.planes().map(Sums::pixel_bytes).sum::<usize>()
    }

    /// An empty tile.
    pub fn new(origin: (usize, usize), size: (usize, usize), wanted: Wanted) -> Self {
        let pixels = size.0 * size.1;
        let planes = wanted.planes().map(|aov| Sums::new(aov, pixels)).collect();
        Self { origin, size, spp: 0, beauty: vec![[0.0; 4]; pixels], planes }
    }

    /// Adds `count` more samples of every pixel, pixel by pixel.
    pub fn add(&mut self, samples: &Samples, count: u32) {
        let per_pixel = count as usize;
        for pixel in 0..self.beauty.len() {
            self.add_to(pixel, samples, pixel * per_pixel..(pixel + 1) * per_pixel, self.spp as usize);
        }
        self.spp += count;
    }

    /// Puts other samples in the place of all that some pixels hold, pixel by pixel.
    pub fn replace(&mut self, pixels: &[u32], samples: &Samples) {
        let per_pixel = self.spp as usize;
        for (place, &pixel) in pixels.iter().enumerate() {
            let pixel = pixel as usize;
            self.beauty[pixel] = Default::default();
            self.planes.iter_mut().for_each(|plane| plane.clear(pixel));
            self.add_to(pixel, samples, place * per_pixel..(place + 1) * per_pixel, 0);
        }
    }

    /// Adds the samples of some slots to a pixel that holds as many as `before`.
    fn add_to(&mut self, pixel: usize, samples: &Samples, slots: Range<usize>, before: usize) {
        for (slot, held) in slots.zip(before..) {
            let radiance = samples.radiance[slot].as_dvec3();
            let covered = f64::from(u8::from(samples.covered[slot]));
            let values = [radiance.x, radiance.y, radiance.z, covered];
            self.beauty[pixel].iter_mut().zip(values).for_each(|(sum, value)| *sum += value);
            let sample = samples.get(slot);
            self.planes.iter_mut().for_each(|plane| plane.add(pixel, &sample, held));
        }
    }

    /// Means of a pixel's R, G, B, A.
    fn beauty(&self, pixel: usize) -> [f64; 4] {
        self.beauty[pixel].map(|sum| sum / f64::from(self.spp.max(1)))
    }

    /// The values of a pixel's channels for `aov`; none if it is not wanted.
    fn values(&self, aov: Aov, pixel: usize) -> impl Iterator<Item = f32> {
        let plane = self.planes.iter().find(|plane| plane.aov() == aov);
        plane.into_iter().flat_map(move |plane| plane.values(pixel, self.spp.max(1) as usize))
    }

    /// Sum over pixels of the standard error relative to the pixel's brightness, and how many pixels that is.
    pub fn relative_error(&self) -> (f64, usize) {
        let of = |pixel: usize| {
            let error = self.values(Aov::Variance, pixel).sum::<f32>().sqrt();
            let [r, g, b, _] = self.beauty(pixel).map(|mean| mean as f32);
            f64::from(error / (Vec3::new(r, g, b).length() + 1e-3))
        };
        ((0..self.beauty.len()).map(of).sum(), self.beauty.len())
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

/// Puts tiles together: R, G, B, A, then the planes of `aovs` in their order, into `image`. Tiles go as the planes
/// fill.
pub fn assemble<T: Borrow<Tile>>(tiles: impl Iterator<Item = T>, aovs: &[Aov], image: &mut Image) {
    let (width, height) = image.size;
    let names = BEAUTY.iter().chain(aovs.iter().flat_map(|aov| aov.channels()));
    image.channels =
        names.map(|name| Channel { name: name.to_string(), values: vec![0.0; width * height] }).collect();
    for tile in tiles {
        let tile: &Tile = tile.borrow();
        for pixel in 0..tile.size.0 * tile.size.1 {
            let x = tile.origin.0 - image.origin.0 + pixel % tile.size.0;
            let y = tile.origin.1 - image.origin.1 + pixel / tile.size.0;
            let beauty = tile.beauty(pixel).map(|mean| mean as f32);
            let extra = aovs.iter().flat_map(|&aov| tile.values(aov, pixel));
            for (plane, value) in image.channels.iter_mut().zip(beauty.into_iter().chain(extra)) {
                plane.values[y * width + x] = value;
            }
        }
    }
}
