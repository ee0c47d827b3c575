//! The one way by which light enters a path.

use glam::Vec3;

use super::super::path::{Gathers, Path};
use super::super::vertex::Vertex;
use crate::geometry::PrimitiveId;
use crate::light::Target;

/// Origin of light that reaches the camera along a path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightSource {
    /// The light's emitter.
    pub emitter: EmitterId,
    /// Ray segments between it and the camera: 1 where it is seen, 2 for direct light, more for indirect.
    pub segments: u32,
}

/// Emitter of deposited light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum EmitterId {
    /// A surface: its primitive, by which the geometry knows its entity and material.
    Surface(PrimitiveId),
    /// A point light, by its number among the scene's.
    Point(u32),
    /// The environment or a distant light.
    Infinity,
}

impl LightSource {
    /// The emitter that a light ray reaches; `None` for one that was not aimed at any.
    #[inline(always)]
    pub fn reached(vertex: &Vertex) -> Option<Self> {
        let emitter = match vertex.target {
            Target::Surface(primitive, _) => EmitterId::Surface(primitive),
            Target::Point(index) => EmitterId::Point(index),
            Target::Infinity(_) | Target::SkyTile(..) => EmitterId::Infinity,
            Target::Nothing | Target::ThroughSpecular => return None,
        };
        Some(Self { emitter, segments: vertex.depth })
    }

    /// True if it is for `gathers` to add: the camera's view of lamps is left to other paths in some pixels.
    #[inline(always)]
    fn is_for(self, gathers: Gathers) -> bool {
        match gathers {
            Gathers::All => true,
            Gathers::Lamps => matches!(self.emitter, EmitterId::Surface(_)),
            Gathers::Beyond => !matches!(self.emitter, EmitterId::Surface(_)),
        }
    }
}

/// Adds light from `source` to `path`: `radiance`, as it arrives at the camera, is computed only if this path gathers
/// it.
#[inline(always)]
pub fn deposit(path: &mut Path, source: LightSource, radiance: impl FnOnce() -> Vec3) {
    if source.is_for(path.gathers) {
        let radiance = radiance();
        debug_assert!(radiance.is_finite() && radiance.min_element() >= 0.0, "{source:?}: {radiance}");
        path.radiance += radiance;
    }
}
