//! What is met where a path lands, Russian roulette, and the next bounce.

use glam::Vec3;

use super::super::path::Path;
use super::super::transport::Landing;
use super::super::work::Job;
use crate::geometry::{PrimitiveId, SurfacePoint};
use crate::scene::Baked;
use crate::shade::{self, Bounce, Crossing, Incidence, Media};

/// What a path meets where it lands.
pub struct Meeting {
    /// The primitive: of several that lie upon each other a solid one, else the first.
    pub primitive: PrimitiveId,
    /// Its surface.
    pub surface: SurfacePoint,
    /// How light meets it.
    pub incidence: Incidence,
}

/// What a path in `media` meets where it lands. Glass is met together with all that lies upon it there: what is solid stops
/// light, and further glass is gone through with it.
pub fn meet(scene: &Baked, landing: &Landing, media: Media) -> Meeting {
    let &Landing { position, direction, primitive } = landing;
    let surface_at = |primitive| scene.geometry.surface_point(primitive, position);
    let is_glass =
        |surface: &SurfacePoint| scene.materials[surface.surface.material as usize].is_dielectric();
    let face = |surface: &SurfacePoint| (surface.surface.material, direction.dot(surface.normal) < 0.0);
    let surface = surface_at(primitive);
    let alone = |primitive, surface: SurfacePoint, crossing| Meeting {
        primitive,
        surface,
        incidence: Incidence {
            direction,
            normal: surface.normal,
            shading_normal: surface.shading_normal,
            material: surface.surface.material,
            media,
            crossing,
        },
    };
    if !is_glass(&surface) {
        return alone(primitive, surface, Crossing::none(media));
    }
    let others = scene.geometry.upon(primitive, position);
    let others = || others.iter().map(|&other| (other, surface_at(other)));
    if let Some((solid, surface)) = others().find(|(_, other)| !is_glass(other)) {
        return alone(solid, surface, Crossing::none(media));
    }
    let faces = std::iter::once(face(&surface)).chain(others().map(|(_, other)| face(&other)));
    alone(primitive, surface, Crossing::of(media, faces))
}

/// Continues a path from a surface, with four numbers in [0, 1); `None` if it ends here.
///
/// Roulette ends a path with probability 1 − max(throughput) and makes up for it in those that survive: the mean is
/// unchanged.
#[inline]
pub fn scatter(job: &Job, path: &mut Path, incidence: &Incidence, numbers: [f32; 4]) -> Option<Bounce> {
    if path.depth >= job.settings.max_depth {
        return None;
    }
    let bounce = shade::scatter(&job.scene.materials, incidence, numbers)?;
    path.throughput *= bounce.weight;
    path.media = bounce.media;
    if path.throughput == Vec3::ZERO {
        return None;
    }
    if path.depth >= job.settings.roulette_depth {
        let survival = path.throughput.max_element().min(1.0);
        if numbers[3] >= survival {
            return None;
        }
        path.throughput /= survival;
    }
    path.depth += 1;
    Some(bounce)
}
