//! Surface, or glass and all that lies upon it, that a path meets where it lands.

use glam::DVec3;

use super::super::transport::Landing;
use crate::geometry::{PrimitiveId, SurfacePoint};
use crate::scene::Baked;
use crate::shade::{Bounce, Incidence, InterfaceCrossing, Material, Media, relative_index};

/// Surface that a path meets where it lands.
pub struct Meeting {
    /// The primitive: of several that lie upon each other a solid one, else the first.
    pub primitive: PrimitiveId,
    /// Its surface.
    pub surface: SurfacePoint,
    /// Index of refraction beyond it relative to that before it; 1 where light does not go through.
    eta: f64,
    /// Dielectrics around light that goes through.
    pub beyond: Media,
    /// The material there, if textures vary it.
    textured: Option<Material>,
}

/// Looks up the surface that a path in `media` meets where it lands. Glass is met together with all that lies upon it
/// there: what is solid stops light, and further glass is crossed with it.
#[inline(always)]
pub fn meet(scene: &Baked, landing: &Landing, media: Media) -> Meeting {
    let primitive = landing.primitive;
    let mut surface = surface_at(scene, primitive, landing);
    if is_glass(scene, &surface) {
        return meet_upon(scene, landing, media, surface);
    }
    let textured = textured(scene, primitive, landing, &mut surface);
    Meeting { primitive, surface, eta: 1.0, beyond: media, textured }
}

impl Meeting {
    /// Incidence on it of light that travels in a unit direction.
    #[inline(always)]
    pub fn incidence(&self, direction: DVec3) -> Incidence {
        Incidence::new(direction, self.surface.normal, self.surface.shading_normal, self.eta)
    }

    /// Material of the surface.
    #[inline(always)]
    pub fn material<'a>(&'a self, scene: &'a Baked) -> &'a Material {
        self.textured.as_ref().unwrap_or(&scene.materials[self.surface.surface.material as usize])
    }

    /// Dielectrics around a path in `media` after a bounce.
    #[inline(always)]
    pub fn media_after(&self, bounce: &Bounce, media: Media) -> Media {
        if bounce.crosses { self.beyond } else { media }
    }
}

/// Surface of a primitive where a path lands, with normals in the frame at rest.
#[inline(always)]
fn surface_at(scene: &Baked, primitive: PrimitiveId, landing: &Landing) -> SurfacePoint {
    let surface = scene.geometry.surface_point(primitive, landing.position);
    let [normal, shading_normal] = landing.stretch.normals([surface.normal, surface.shading_normal]);
    SurfacePoint { normal, shading_normal, ..surface }
}

fn is_glass(scene: &Baked, surface: &SurfacePoint) -> bool {
    scene.materials[surface.surface.material as usize].is_dielectric()
}

/// The material where a path lands, if textures vary it; they may change the shading normal.
#[inline(always)]
fn textured(
    scene: &Baked,
    primitive: PrimitiveId,
    landing: &Landing,
    surface: &mut SurfacePoint,
) -> Option<Material> {
    let material = &scene.materials[surface.surface.material as usize];
    if material.maps.is_empty() { None } else { look_up(scene, material, primitive, landing, surface) }
}

/// The material at a point of a mesh, whose shading normal may change; `None` on what has no vertices.
#[inline(never)]
fn look_up(
    scene: &Baked,
    material: &Material,
    primitive: PrimitiveId,
    landing: &Landing,
    surface: &mut SurfacePoint,
) -> Option<Material> {
    let point = scene.geometry.mesh_point(primitive, landing.position)?;
    if let Some(normal) = material.normal_at(&point, 0.0, &scene.textures) {
        [_, surface.shading_normal] = landing.stretch.normals([normal; 2]);
    }
    Some(material.at(&point, 0.0, &scene.textures))
}

/// Meets glass with what lies upon it.
#[inline(never)]
fn meet_upon(scene: &Baked, landing: &Landing, media: Media, mut glass: SurfacePoint) -> Meeting {
    let &Landing { position, direction, primitive, .. } = landing;
    let face = |surface: &SurfacePoint| (surface.surface.material, direction.dot(surface.normal) < 0.0);
    let others = scene.geometry.upon(primitive, position);
    let others = || others.iter().map(|&other| (other, surface_at(scene, other, landing)));
    if let Some((solid, mut surface)) = others().find(|(_, other)| !is_glass(scene, other)) {
        let textured = textured(scene, solid, landing, &mut surface);
        return Meeting { primitive: solid, surface, eta: 1.0, beyond: media, textured };
    }
    let faces = std::iter::once(face(&glass)).chain(others().map(|(_, other)| face(&other)));
    let crossing = InterfaceCrossing::of(media, faces);
    let eta = relative_index(&scene.materials, &crossing);
    let textured = textured(scene, primitive, landing, &mut glass);
    Meeting { primitive, surface: glass, eta, beyond: crossing.into, textured }
}
