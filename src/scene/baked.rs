//! The tables that the tracer reads: a scene with every entity dissolved.

use super::{Camera, Settings};
use crate::geometry::Geometry;
use crate::light::Punctual;
use crate::shade::{Environment, Material};
use crate::spacetime::SpacetimeKind;

/// A scene, baked.
pub struct Baked {
    /// Which spacetime the rays cross.
    pub spacetime: SpacetimeKind,
    /// The camera.
    pub camera: Camera,
    /// Primitives and their BVH.
    pub geometry: Geometry,
    /// Materials, indexed by [`crate::geometry::Surface::material`].
    pub materials: Vec<Material>,
    /// Entity names, indexed by [`crate::geometry::Surface::entity`].
    pub entities: Vec<String>,
    /// Lights without extent, in the order of the scene.
    pub punctual: Vec<Punctual>,
    /// Light from infinity.
    pub environment: Environment,
    /// Settings of the scene file, defaults filled in.
    pub settings: Settings,
    /// What was read but not understood, one line each.
    pub warnings: Vec<String>,
    /// What was decided for want of being told, one line each.
    pub notes: Vec<String>,
}

/// Arc tolerance beside the size of a pixel, where none is set.
const PIXEL_FRACTION: f64 = 0.05;

impl Baked {
    /// Largest distance allowed between an arc and the true curve, scene units: as set, or a fraction of a pixel's
    /// footprint at the distance of the hole.
    pub fn arc_tolerance(&self) -> f64 {
        let settings = &self.settings;
        let center = self.spacetime.center().unwrap_or(self.camera.position);
        let pixel = 2.0 * self.camera.tan_half_fov / settings.height as f64;
        let footprint = pixel * self.camera.position.distance(center);
        settings.arc_tolerance.unwrap_or(PIXEL_FRACTION * settings.arc_tolerance_factor * footprint)
    }
}
