//! Images of textures: texels as their file holds them, and mip levels.
//!
//! Texels of 8 bits stay so and are decoded as they are read, before anything is filtered. Deeper ones, and mip levels,
//! are 16 bits of linear light: means of decoded values.

use std::ops::Range;

use glam::Vec4;
use rayon::prelude::*;

/// Levels of an image that is 2^31 texels wide.
const MOST_LEVELS: usize = 32;
/// Texels of an image as its file holds them: red, green, blue, opacity.
#[derive(Clone, Debug, PartialEq)]
pub enum Raster {
    /// 8 bits, of which colours are decoded by a table.
    Encoded(Vec<[u8; 4]>, Box<[f32; 256]>),
    /// 16 bits, linear.
    Linear(Vec<[u16; 4]>),
}

/// An image with its mip levels.
#[derive(Clone, Debug, PartialEq)]
pub struct MipImage {
    /// From the finest to a single texel; at least one.
    levels: Vec<MipLevel>,
}

#[derive(Clone, Debug, PartialEq)]
struct MipLevel {
    width: usize,
    height: usize,
    raster: Raster,
}

impl MipImage {
    /// Most bytes of a texel: its own 8, and a third of as much for the mip levels.
    pub const BYTES_PER_TEXEL: u64 = 11;

    /// An image of `width` × `height` texels, row by row from the top.
    pub fn new(width: usize, height: usize, raster: Raster) -> Self {
        let mut levels = vec![MipLevel { width, height, raster }];
        while let Some(next) = levels.last().filter(|_| levels.len() < MOST_LEVELS).and_then(MipLevel::halved)
        {
            levels.push(next);
        }
        Self { levels }
    }

    /// Number of levels.
    pub fn levels(&self) -> usize {
        self.levels.len()
    }

    /// True if a texel is not opaque.
    pub fn has_alpha(&self) -> bool {
        self.texel(self.levels() - 1, [0, 0]).w < 1.0
    }

    /// Width and height of a level, of which there is one.
    #[inline]
    pub fn size(&self, level: usize) -> [usize; 2] {
        let MipLevel { width, height, .. } = self.levels[level];
        [width, height]
    }

    /// Linear colour and opacity of a texel of a level.
    #[inline]
    pub fn texel(&self, level: usize, [x, y]: [usize; 2]) -> Vec4 {
        self.levels[level].texel(x, y)
    }

    /// Linear colours and opacities where two columns of a level meet two rows: by row, then by column.
    #[inline]
    pub fn texels(&self, level: usize, columns: [usize; 2], rows: [usize; 2]) -> [[Vec4; 2]; 2] {
        let level = &self.levels[level];
        let at = rows.map(|y| columns.map(|x| y * level.width + x));
        match &level.raster {
            Raster::Encoded(texels, table) => at.map(|row| row.map(|at| decoded(texels[at], table))),
            Raster::Linear(texels) => at.map(|row| row.map(|at| linear(texels[at]))),
        }
    }

    /// Heap memory, bytes.
    pub fn memory_bytes(&self) -> usize {
        let bytes = |level: &MipLevel| match &level.raster {
            Raster::Encoded(texels, table) => size_of_val(texels.as_slice()) + size_of_val(table.as_ref()),
            Raster::Linear(texels) => size_of_val(texels.as_slice()),
        };
        self.levels.iter().map(bytes).sum()
    }
}

impl MipLevel {
    #[inline]
    fn texel(&self, x: usize, y: usize) -> Vec4 {
        let at = y * self.width + x;
        match &self.raster {
            Raster::Encoded(texels, table) => decoded(texels[at], table),
            Raster::Linear(texels) => linear(texels[at]),
        }
    }

    /// The next coarser level; `None` after a single texel.
    fn halved(&self) -> Option<Self> {
        if self.width * self.height <= 1 {
            return None;
        }
        let [width, height] = [self.width, self.height].map(|size| (size / 2).max(1));
        let texels = match &self.raster {
            Raster::Encoded(texels, table) => {
                self.means(width, height, |row| texels[row].iter().map(|texel| decoded(*texel, table)))
            }
            Raster::Linear(texels) => {
                self.means(width, height, |row| texels[row].iter().map(|texel| linear(*texel)))
            }
        };
        Some(Self { width, height, raster: Raster::Linear(texels) })
    }

    /// Means over the texels under those of `width` × `height`, of which `row` gives those of a range.
    fn means<T: Iterator<Item = Vec4>>(
        &self,
        width: usize,
        height: usize,
        row: impl Fn(Range<usize>) -> T + Sync,
    ) -> Vec<[u16; 4]> {
        let columns: Vec<_> = (0..width).map(|x| covered(x, self.width, width)).collect();
        let mut means = vec![[0; 4]; width * height];
        means.par_chunks_mut(width).enumerate().for_each_init(
            || vec![Vec4::ZERO; self.width],
            |sums, (y, means)| {
                sums.fill(Vec4::ZERO);
                for (y, share) in
                    covered(y, self.height, height).into_iter().filter(|(_, share)| *share > 0.0)
                {
                    let texels = row(y * self.width..(y + 1) * self.width);
                    sums.iter_mut().zip(texels).for_each(|(sum, texel)| *sum += share * texel);
                }
                for (mean, columns) in means.iter_mut().zip(&columns) {
                    let sum: Vec4 = columns.iter().map(|(x, share)| *share * sums[*x]).sum();
                    // Rounded to the nearest.
                    *mean = (sum * f32::from(u16::MAX) + 0.5).to_array().map(|value| value as u16);
                }
            },
        );
        means
    }
}

#[inline(always)]
fn decoded([r, g, b, a]: [u8; 4], table: &[f32; 256]) -> Vec4 {
    let decode = |value: u8| table[usize::from(value)];
    Vec4::new(decode(r), decode(g), decode(b), f32::from(a) / f32::from(u8::MAX))
}

#[inline(always)]
fn linear(texel: [u16; 4]) -> Vec4 {
    Vec4::from(texel.map(f32::from)) / f32::from(u16::MAX)
}

/// Texels under the texel `at` of a row of `coarse`, among those of a row of `fine`, with their shares: at most three,
/// where an odd number is halved.
fn covered(at: usize, fine: usize, coarse: usize) -> [(usize, f32); 3] {
    let scale = fine as f64 / coarse as f64;
    let (start, end) = (at as f64 * scale, (at + 1) as f64 * scale);
    let first = start.floor() as usize;
    [0, 1, 2].map(|offset| {
        let texel = first + offset;
        let overlap = end.min((texel + 1) as f64) - start.max(texel as f64);
        (texel.min(fine - 1), (overlap.max(0.0) / scale) as f32)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grey(width: usize, height: usize, value: impl Fn(usize) -> u16) -> MipImage {
        MipImage::new(width, height, Raster::Linear((0..width * height).map(|i| [value(i); 4]).collect()))
    }

    #[test]
    fn every_level_has_the_mean_of_the_first() {
        for (width, height) in [(8, 8), (7, 3), (1, 5), (13, 1), (33, 21)] {
            let image = grey(width, height, |i| (i * 7919 % 50_000) as u16);
            let mean = |level: usize| {
                let [width, height] = image.size(level);
                let texels =
                    (0..width * height).map(|i| f64::from(image.texel(level, [i % width, i / width]).x));
                texels.sum::<f64>() / (width * height) as f64
            };
            assert_eq!(image.size(image.levels() - 1), [1, 1]);
            for level in 0..image.levels() {
                assert!((mean(level) - mean(0)).abs() < 1e-5, "{width} × {height}, {level}");
            }
        }
    }

    #[test]
    fn means_are_of_decoded_values() {
        let mut table = Box::new([0.0; 256]);
        (table[10], table[200]) = (0.25, 0.75);
        let texels = vec![[10, 200, 10, 255], [200, 200, 10, 0]];
        let image = MipImage::new(2, 1, Raster::Encoded(texels, table));
        assert_eq!(image.texel(0, [1, 0]), Vec4::new(0.75, 0.75, 0.25, 0.0));
        assert!((image.texel(1, [0, 0]) - Vec4::new(0.5, 0.75, 0.25, 0.5)).length() < 2e-5);
        assert_eq!(image.memory_bytes(), 8 + 1024 + 8);
    }
}
