//! Opacity of surfaces, and of their parts.

use super::lookup::Texture;
use super::maps::TextureId;
use crate::geometry::MeshPoint;

/// Component of a texture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TextureChannel {
    /// The first colour, which of grey ones is each.
    Red,
    /// Opacity.
    Alpha,
}

/// Opacity of a surface that is not opaque all over: the probability with which a ray meets it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Opacity {
    /// That of the whole surface.
    pub factor: f32,
    /// Texture that is a factor on it.
    pub map: Option<(TextureId, TextureChannel)>,
    /// True if the opacity of vertex colours is one as well.
    pub by_vertices: bool,
    /// Opacity from which on the surface is opaque, and below which it is not there.
    pub cutoff: Option<f32>,
}

impl Opacity {
    /// False if it is 1 all over.
    pub fn lets_through(&self) -> bool {
        let least = if self.map.is_some() || self.by_vertices { 0.0 } else { self.factor };
        least < self.cutoff.unwrap_or(1.0)
    }

    /// Opacity at a point of a mesh; in the finest mip level, in which a cutoff keeps the area that it leaves.
    pub fn at(&self, point: Option<&MeshPoint>, textures: &[Texture]) -> f32 {
        let Self { factor, map, by_vertices, cutoff } = *self;
        let mut opacity = factor;
        if let Some(point) = point {
            if let Some((TextureId(id), channel)) = map {
                let texel = textures[id as usize].at(point, 0.0);
                opacity *= match channel {
                    TextureChannel::Red => texel.x,
                    TextureChannel::Alpha => texel.w,
                };
            }
            opacity *= if by_vertices { point.color().w } else { 1.0 };
        }
        match cutoff {
            Some(cutoff) => f32::from(u8::from(opacity >= cutoff)),
            None => opacity,
        }
    }
}
