//! Lookup of a texture by coordinates.
//!
//! Texture coordinates are glTF's: (0, 0) is the upper left corner of the image, (1, 1) the lower right one.

use std::sync::Arc;

use glam::{DVec2, Vec4};

use super::image::MipImage;
use crate::geometry::MeshPoint;
use crate::math::fast_log2::{WIDE_OCTAVE, wide_log2};
use crate::math::floor::floor;

/// Mip levels by which a footprint is looked up in finer texels than those of its area: filters between texels are wider
/// than a texel. From 4 samples of a pixel on, pictures are then nearest to what many would be.
const FINER: f32 = 0.5;

/// Wrapping of a coordinate beyond 0 to 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Wrap {
    /// The image again and again.
    Repeat,
    /// Every other one mirrored.
    Mirror,
    /// The image's edge.
    Clamp,
}

/// Affine map of texture coordinates: columns, then the offset.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UvTransform(pub [DVec2; 3]);

/// An image as a material looks at it.
#[derive(Clone, Debug, PartialEq)]
pub struct Texture {
    /// The image, which textures share.
    pub image: Arc<MipImage>,
    /// Set of the mesh's texture coordinates.
    pub uv_set: usize,
    /// From those to coordinates of the image.
    pub transform: UvTransform,
    /// Wrapping along both.
    pub wrap: [Wrap; 2],
    /// True for the nearest texel, false for bilinear filtering.
    pub is_nearest: bool,
}

impl UvTransform {
    /// Coordinates as they are.
    pub const IDENTITY: Self = Self([DVec2::X, DVec2::Y, DVec2::ZERO]);

    /// Scale, then rotation (radians, counter-clockwise about the upper left corner), then offset: those of
    /// KHR_texture_transform.
    pub fn new(scale: DVec2, rotation: f64, offset: DVec2) -> Self {
        let (sin, cos) = libm::sincos(rotation);
        Self([scale.x * DVec2::new(cos, -sin), scale.y * DVec2::new(sin, cos), offset])
    }

    #[inline]
    fn apply(&self, uv: DVec2) -> DVec2 {
        let Self([u, v, offset]) = *self;
        uv.x * u + uv.y * v + offset
    }
}

impl Texture {
    /// Linear colour and opacity at a point of a mesh, seen in a footprint of a width (scene units): between the two mip
    /// levels whose texels are next to it in width. A mesh without coordinates has the mean all over.
    #[inline]
    pub fn at(&self, point: &MeshPoint, width: f64) -> Vec4 {
        let Some(uv) = point.uv(self.uv_set) else {
            return self.image.texel(self.image.levels() - 1, [0, 0]);
        };
        let level = if width > 0.0 { self.level(width * width * point.uv_density(self.uv_set)) } else { 0.0 };
        self.between(uv, level)
    }

    /// Linear colour and opacity at texture coordinates, between mip levels.
    fn between(&self, uv: DVec2, level: f32) -> Vec4 {
        let uv = self.transform.apply(uv);
        let place = DVec2::new(self.wrap[0].within(uv.x), self.wrap[1].within(uv.y));
        let (fine, share) = (level as usize, level.fract());
        let last = self.image.levels() - 1;
        if fine >= last || share == 0.0 {
            return self.lookup(place, fine.min(last));
        }
        self.lookup(place, fine).lerp(self.lookup(place, fine + 1), share)
    }

    /// Mip level for a footprint, given by its area in texture coordinates, a fraction in general: log₄ of the area in
    /// texels, less [`FINER`].
    fn level(&self, area: f64) -> f32 {
        let Self { image, transform: UvTransform([u, v, _]), .. } = self;
        let [width, height] = image.size(0).map(|size| size as f64);
        let octaves = wide_log2(area * u.perp_dot(*v).abs() * width * height);
        (0.5 * octaves as f32 / WIDE_OCTAVE as f32 - FINER).max(0.0)
    }

    /// Linear colour and opacity at a place of the image, (0, 0) to (1, 1), in a mip level.
    fn lookup(&self, place: DVec2, level: usize) -> Vec4 {
        let size = self.image.size(level);
        let (x, y) = (size[0] as f64 * place.x, size[1] as f64 * place.y);
        if self.is_nearest {
            let nearest = |place: f64, size: usize| (place as usize).min(size - 1);
            return self.image.texel(level, [nearest(x, size[0]), nearest(y, size[1])]);
        }
        let (columns, across) = self.wrap[0].neighbours(x, size[0]);
        let (rows, down) = self.wrap[1].neighbours(y, size[1]);
        let [above, below] =
            self.image.texels(level, columns, rows).map(|[left, right]| left.lerp(right, across));
        above.lerp(below, down)
    }
}

impl Wrap {
    /// The coordinate from 0 to 1 that stands for another; 0 for one that is no number.
    #[inline]
    fn within(self, coordinate: f64) -> f64 {
        if !coordinate.is_finite() {
            return 0.0;
        }
        match self {
            Self::Repeat => coordinate - floor(coordinate),
            Self::Mirror => {
                let of_two = coordinate - 2.0 * floor(0.5 * coordinate);
                if of_two > 1.0 { 2.0 - of_two } else { of_two }
            }
            Self::Clamp => coordinate.clamp(0.0, 1.0),
        }
    }

    /// Texels before and after a place from 0 to `size`, and the share of the second.
    #[inline]
    fn neighbours(self, place: f64, size: usize) -> ([usize; 2], f32) {
        let from_centres = place - 0.5;
        let before = floor(from_centres);
        let share = (from_centres - before) as f32;
        let last = size - 1;
        let beyond = |inside: usize, opposite: usize| match self {
            Self::Repeat => opposite,
            Self::Mirror | Self::Clamp => inside,
        };
        let first = if before < 0.0 { beyond(0, last) } else { (before as usize).min(last) };
        let second = if before + 1.0 > last as f64 { beyond(last, 0) } else { (before + 1.0) as usize };
        ([first, second], share)
    }
}

#[cfg(test)]
mod tests {
    use super::super::image::Raster;
    use super::*;

    /// Four texels in a row: 0, 0.2, 0.4, 0.6.
    fn row(wrap: Wrap, is_nearest: bool) -> Texture {
        let texels = (0..4).map(|i| [i * 13107; 4]).collect();
        let image = Arc::new(MipImage::new(4, 1, Raster::Linear(texels)));
        Texture { image, uv_set: 0, transform: UvTransform::IDENTITY, wrap: [wrap; 2], is_nearest }
    }

    fn check(texture: &Texture, expected: &[(f64, f64)]) {
        for &(u, value) in expected {
            let found = f64::from(texture.between(DVec2::new(u, 0.5), 0.0).x);
            assert!((found - value).abs() < 1e-6, "{:?} at {u}: {found} for {value}", texture.wrap[0]);
        }
    }

    #[test]
    fn the_nearest_texel_is_that_around_the_place() {
        let inside = [(0.0, 0.0), (0.24, 0.0), (0.26, 0.2), (0.6, 0.4), (0.99, 0.6)];
        for wrap in [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp] {
            check(&row(wrap, true), &inside);
        }
        check(&row(Wrap::Repeat, true), &[(1.0, 0.0), (1.3, 0.2), (-0.1, 0.6), (-7.4, 0.4)]);
        check(
            &row(Wrap::Mirror, true),
            &[(1.0, 0.6), (1.1, 0.6), (1.9, 0.0), (-0.1, 0.0), (-0.9, 0.6), (2.3, 0.2)],
        );
        check(&row(Wrap::Clamp, true), &[(1.0, 0.6), (17.0, 0.6), (-0.3, 0.0)]);
    }

    #[test]
    fn bilinear_filtering_is_exact_at_centres_and_wraps_between_the_edges() {
        for wrap in [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp] {
            check(&row(wrap, false), &[(0.125, 0.0), (0.375, 0.2), (0.25, 0.1), (0.875, 0.6)]);
        }
        check(&row(Wrap::Repeat, false), &[(0.0, 0.3), (1.0, 0.3), (-0.0625, 0.45), (3.0625, 0.15)]);
        check(&row(Wrap::Mirror, false), &[(0.0, 0.0), (1.0, 0.6), (1.25, 0.5), (-0.25, 0.1)]);
        check(&row(Wrap::Clamp, false), &[(0.0, 0.0), (1.0, 0.6), (9.0, 0.6)]);
    }

    #[test]
    fn footprints_are_looked_up_between_the_mip_levels_next_to_them() {
        // 0.1 and 0.5 in the next level, 0.3 in the last.
        let texture = row(Wrap::Clamp, true);
        for (level, value) in [(0.0, 0.0), (0.25, 0.025), (1.0, 0.1), (1.5, 0.2), (2.0, 0.3), (512.0, 0.3)] {
            let found = texture.between(DVec2::new(0.1, 0.5), level).x;
            assert!((found - value).abs() < 2e-5, "{level}: {found}");
        }
        // By the width in texels, whose logarithm is good to a twentieth.
        let transform = UvTransform::new(DVec2::new(2.0, 0.5), 0.3, DVec2::ONE);
        for scaled in [texture.clone(), Texture { transform, ..texture }] {
            for texels in [0.0, 1e-9, 1.0, 1.5, 2.0, 3.7, 8.0, 1e9, f64::INFINITY] {
                let expected = (texels.log2() - 0.5).clamp(0.0, 500.0);
                let level = f64::from(scaled.level(texels * texels / 4.0));
                assert!((level - expected).abs() < 0.05 || level.min(expected) >= 500.0, "{texels}: {level}");
            }
        }
    }

    #[test]
    fn coordinates_that_are_no_numbers_or_huge_find_some_texel() {
        for wrap in [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp] {
            for u in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e300, -1e300, -1e-320] {
                for is_nearest in [false, true] {
                    assert!(row(wrap, is_nearest).between(DVec2::splat(u), 0.0).is_finite());
                }
            }
        }
    }

    #[test]
    fn coordinates_are_scaled_then_rotated_then_moved() {
        let turn = UvTransform::new(DVec2::new(2.0, 3.0), 0.5 * std::f64::consts::PI, DVec2::new(10.0, 20.0));
        let place = turn.apply(DVec2::new(1.0, 1.0));
        assert!((place - DVec2::new(13.0, 18.0)).length() < 1e-12, "{place}");
    }
}
