//! Pictures of bumps: normal maps, or heights that are made into them.
//!
//! One statement of MTL stands for both: programs write `map_Bump` for a normal map, too, as Blender does. Its texels are
//! blue on the average, those of heights are grey.

use glam::{Vec2, Vec3};
use rayon::prelude::*;

use crate::asset::flaw::Flaw;
use crate::asset::memory::Memory;
use crate::shade::{MipImage, Raster, Wrap};

/// Distance of the mean of a normal map from (½, ½, 1): in red and green, and in blue.
const NEAR_FLAT: [f32; 2] = [0.2, 0.35];

/// True if a picture's texels are normals in tangent space.
pub fn is_normal_map(image: &MipImage) -> bool {
    let mean = image.texel(image.levels() - 1, [0, 0]);
    let [across, upwards] = NEAR_FLAT;
    let is_blue = mean.z > mean.x.max(mean.y) + 0.5 * across;
    is_blue && (mean.truncate().truncate() - 0.5).abs().max_element() < across && mean.z > 1.0 - upwards
}

/// The normals of a picture of heights in its red channel: heights that differ by 1 from texel to texel slope by 45°.
///
/// # Errors
/// There is not enough memory.
pub fn normals(heights: &MipImage, wrap: Wrap, memory: &Memory) -> Result<MipImage, Flaw> {
    let [width, height] = heights.size(0);
    let bytes = (width * height) as u64 * MipImage::BYTES_PER_TEXEL;
    memory.check(format!("a normal map of {width} × {height} texels"), bytes)?;
    let neighbour = |at: usize, step: isize, size: usize| {
        let moved = at as isize + step;
        match wrap {
            Wrap::Repeat => moved.rem_euclid(size as isize) as usize,
            Wrap::Mirror | Wrap::Clamp => moved.clamp(0, size as isize - 1) as usize,
        }
    };
    let texel = |index: usize| {
        let (x, y) = (index % width, index / width);
        let at = |x: usize, y: usize| heights.texel(0, [x, y]).x;
        let along = at(neighbour(x, 1, width), y) - at(neighbour(x, -1, width), y);
        // Rows count downwards.
        let up = at(x, neighbour(y, -1, height)) - at(x, neighbour(y, 1, height));
        let normal = (-0.5 * Vec2::new(along, up)).extend(1.0).normalize();
        let [r, g, b] = (0.5 * normal + Vec3::splat(0.5))
            .to_array()
            .map(|component| (component * f32::from(u16::MAX)).round() as u16);
        [r, g, b, u16::MAX]
    };
    let texels = (0..width * height).into_par_iter().map(texel).collect();
    Ok(MipImage::new(width, height, Raster::Linear(texels)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grey(width: usize, height: usize, value: impl Fn(usize, usize) -> f32) -> MipImage {
        let texel = |i: usize| [(value(i % width, i / width) * 65535.0).round() as u16; 4];
        MipImage::new(width, height, Raster::Linear((0..width * height).map(texel).collect()))
    }

    #[test]
    fn slopes_of_heights_are_normals_that_lean_downhill() {
        // Uphill by 0.01 a texel to the right, by 0.02 upwards.
        let heights = grey(8, 8, |x, y| 0.01 * x as f32 + 0.02 * (7 - y) as f32);
        let normals = normals(&heights, Wrap::Clamp, &Memory::default()).unwrap();
        let normal = 2.0 * normals.texel(0, [3, 4]).truncate() - 1.0;
        assert!((normal / normal.z - Vec3::new(-0.01, -0.02, 1.0)).length() < 1e-4, "{normal}");
        // At a repeated edge the picture begins again.
        let normals = super::normals(&heights, Wrap::Repeat, &Memory::default()).unwrap();
        let normal = 2.0 * normals.texel(0, [0, 4]).truncate() - 1.0;
        assert!((normal.x / normal.z - 0.5 * 0.06).abs() < 1e-4, "{normal}");
    }

    #[test]
    fn normal_maps_are_blue_and_heights_are_not() {
        let flat = |texel: [u16; 4]| MipImage::new(2, 2, Raster::Linear(vec![texel; 4]));
        assert!(is_normal_map(&flat([0x8000, 0x8000, 0xffff, 0xffff])));
        assert!(is_normal_map(&flat([0x7000, 0x9000, 0xd000, 0xffff])));
        for texel in [
            [0x8000; 4],
            [0xffff; 4],
            [0, 0, 0, 0xffff],
            [0x8000, 0xffff, 0x8000, 0xffff],
            [0, 0, 0xffff, 0xffff],
        ] {
            assert!(!is_normal_map(&flat(texel)), "{texel:?}");
        }
    }
}
