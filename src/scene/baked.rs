//! The tables that the tracer reads: a scene with every entity dissolved.

use glam::DVec3;

use super::{Camera, Settings};
use crate::geometry::{Geometry, Primitives};
use crate::light::Punctual;
use crate::shade::{Environment, Material};
use crate::spacetime::SpacetimeKind;

/// A scene, baked.
pub struct Baked {
    /// Spacetime that the rays cross.
    pub spacetime: SpacetimeKind,
    /// The camera.
    pub camera: Camera,
    /// Primitives and their BVH.
    pub geometry: Geometry,
    /// Materials, indexed by [`crate::geometry::Surface::material`].
    pub materials: Vec<Material>,
    /// Entity names, indexed by [`crate::geometry::Surface::entity`].
    pub entities: Vec<String>,
    /// Punctual lights, in the order of the scene.
    pub punctual: Vec<Punctual>,
    /// Light from infinity.
    pub environment: Environment,
    /// Settings of the scene file, defaults filled in.
    pub settings: Settings,
    /// Content that was read but not understood, one line each.
    pub warnings: Vec<String>,
    /// Choices made for want of being told, one line each.
    pub notes: Vec<String>,
}

/// Arc tolerance beside the size of a pixel, where none is set.
const PIXEL_FRACTION: f64 = 0.05;

impl Baked {
    /// Largest distance allowed between an arc and the true curve, scene units: as set, or a fraction of a pixel's
    /// footprint at the distance of the hole.
    pub fn arc_tolerance(&self) -> f64 {
        self.arc_tolerance_around(self.spacetime.center().unwrap_or(self.camera.position))
    }

    /// Like [`Self::arc_tolerance`], with the hole at `center`.
    pub fn arc_tolerance_around(&self, center: DVec3) -> f64 {
        let settings = &self.settings;
        let pixel = 2.0 * self.camera.tan_half_fov / settings.height as f64;
        let footprint = pixel * self.camera.position.distance(center);
        settings.arc_tolerance.unwrap_or(PIXEL_FRACTION * settings.arc_tolerance_factor * footprint)
    }
}

/// Empty flat space, seen along −Z from the origin: for scenes that are built in code.
impl Default for Baked {
    fn default() -> Self {
        let camera = Camera {
            position: DVec3::ZERO,
            forward: DVec3::NEG_Z,
            right: DVec3::X,
            up: DVec3::Y,
            tan_half_fov: 0.5,
            near: 0.0,
        };
        Self {
            spacetime: SpacetimeKind::Flat,
            camera,
            geometry: Geometry::build(Primitives::default()),
            materials: Vec::new(),
            entities: Vec::new(),
            punctual: Vec::new(),
            environment: Environment::Black,
            settings: Settings::default(),
            warnings: Vec::new(),
            notes: Vec::new(),
        }
    }
}
