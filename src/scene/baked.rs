//! The tables that the tracer reads: a scene with every entity dissolved.

use std::sync::Arc;

use glam::DVec3;

use super::projection::{Perspective, PixelWidth, Projection};
use super::{Camera, Settings};
use crate::geometry::{Geometry, Primitives};
use crate::light::Punctual;
use crate::shade::{Environment, Material, Texture};
use crate::spacetime::{Side, SpacetimeKind};

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
    /// Textures, indexed by [`crate::shade::TextureId`].
    pub textures: Vec<Texture>,
    /// Entity names, indexed by [`crate::geometry::Surface::entity`].
    pub entities: Vec<String>,
    /// Punctual lights, in the order of the scene.
    pub punctual: Vec<Punctual>,
    /// Light from infinity.
    pub environment: Environment,
    /// Lights of the far side of a wormhole.
    pub far: FarLights,
    /// Settings of the scene file, defaults filled in.
    pub settings: Settings,
    /// Content that was read but not understood, one line each.
    pub warnings: Vec<String>,
    /// Choices made for want of being told, one line each.
    pub notes: Vec<String>,
}

/// Lights of the far side of a wormhole that are no surfaces.
#[derive(Clone, Debug)]
pub struct FarLights {
    /// Punctual lights, in the order of the scene.
    pub punctual: Vec<Punctual>,
    /// Light from infinity.
    pub environment: Environment,
}

impl Default for FarLights {
    fn default() -> Self {
        Self { punctual: Vec::new(), environment: Environment::Black }
    }
}

/// Arc tolerance beside the size of a pixel, where none is set.
const PIXEL_FRACTION: f64 = 0.05;

impl Baked {
    /// Light from infinity on a side.
    pub fn environment(&self, side: Side) -> &Environment {
        match side {
            Side::Near => &self.environment,
            Side::Far => &self.far.environment,
        }
    }

    /// Memory of the images of textures, bytes.
    pub fn texture_bytes(&self) -> usize {
        let mut images: Vec<_> = self.textures.iter().map(|texture| &texture.image).collect();
        images.sort_by_key(|image| Arc::as_ptr(image));
        images.dedup_by(|one, other| Arc::ptr_eq(one, other));
        images.iter().map(|image| image.memory_bytes()).sum()
    }

    /// Punctual lights of both sides, with their sides.
    pub fn punctual(&self) -> impl Iterator<Item = (Side, &Punctual)> {
        let near = self.punctual.iter().map(|light| (Side::Near, light));
        near.chain(self.far.punctual.iter().map(|light| (Side::Far, light)))
    }

    /// Largest distance allowed between an arc and the true curve, scene units: as set, or a fraction of a pixel's
    /// footprint at the distance of the hole.
    pub fn arc_tolerance(&self) -> f64 {
        let mouth = self.spacetime.wormhole().map(|(mouths, _)| mouths.center(self.camera.side));
        self.arc_tolerance_around(mouth.or(self.spacetime.center()).unwrap_or(self.camera.position))
    }

    /// Width of a pixel.
    pub fn pixel(&self) -> PixelWidth {
        self.camera.projection.pixel(self.settings.width, self.settings.height)
    }

    /// Like [`Self::arc_tolerance`], with the hole at `center`.
    pub fn arc_tolerance_around(&self, center: DVec3) -> f64 {
        let settings = &self.settings;
        let footprint = self.pixel().at(self.camera.position.distance(center));
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
            projection: Projection::Perspective(Perspective { tan_half_fov: 0.5, lens: None }),
            near: 0.0,
            side: Side::Near,
        };
        Self {
            spacetime: SpacetimeKind::Flat,
            camera,
            geometry: Geometry::build(Primitives::default()),
            materials: Vec::new(),
            textures: Vec::new(),
            entities: Vec::new(),
            punctual: Vec::new(),
            environment: Environment::Black,
            far: FarLights::default(),
            settings: Settings::default(),
            warnings: Vec::new(),
            notes: Vec::new(),
        }
    }
}
