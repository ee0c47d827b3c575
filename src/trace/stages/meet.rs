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
}

/// Looks up the surface that a path in `media` meets where it lands. Glass is met together with all that lies upon it
/// there: what is solid stops light, and further glass is crossed with it.
#[inline(always)]
pub fn meet(scene: &Baked, landing: &Landing, media: Media) -> Meeting {
    let surface = scene.geometry.surface_point(landing.primitive, landing.position);
    meet_surface(scene, landing, media, surface)
}

/// [`meet`], given the surface where the path lands.
#[inline(always)]
pub fn meet_surface(scene: &Baked, landing: &Landing, media: Media, surface: SurfacePoint) -> Meeting {
    let primitive = landing.primitive;
    let surface = at_rest(surface, landing);
    if is_glass(scene, &surface) {
        // Copied and taken apart, so that landings and surfaces stay in registers where there is no glass.
        let (landing, glass) = (*landing, surface);
        let Meeting { primitive, surface, eta, beyond } = meet_upon(scene, &landing, media, glass);
        let SurfacePoint { normal, shading_normal, surface } = surface;
        return Meeting { primitive, surface: SurfacePoint { normal, shading_normal, surface }, eta, beyond };
    }
    Meeting { primitive, surface, eta: 1.0, beyond: media }
}

impl Meeting {
    /// Incidence on it of light that travels in a unit direction.
    #[inline(always)]
    pub fn incidence(&self, direction: DVec3) -> Incidence {
        Incidence::new(direction, self.surface.normal, self.surface.shading_normal, self.eta)
    }

    /// Sine of the angle between both normals.
    #[inline(always)]
    pub fn lean(&self) -> f32 {
        let SurfacePoint { normal, shading_normal, .. } = self.surface;
        if normal == shading_normal { 0.0 } else { normal.cross(shading_normal).length() as f32 }
    }

    /// Material of the surface, as it is all over.
    #[inline(always)]
    pub fn material<'a>(&self, scene: &'a Baked) -> &'a Material {
        &scene.materials[self.surface.surface.material as usize]
    }

    /// Dielectrics around a path in `media` after a bounce.
    #[inline(always)]
    pub fn media_after(&self, bounce: &Bounce, media: Media) -> Media {
        if bounce.crosses { self.beyond } else { media }
    }
}

/// Surface where a path lands, with normals in the frame at rest.
#[inline(always)]
fn at_rest(surface: SurfacePoint, landing: &Landing) -> SurfacePoint {
    let [normal, shading_normal] = landing.stretch.normals([surface.normal, surface.shading_normal]);
    SurfacePoint { normal, shading_normal, ..surface }
}

fn is_glass(scene: &Baked, surface: &SurfacePoint) -> bool {
    scene.materials[surface.surface.material as usize].is_dielectric()
}

/// Meets glass with what lies upon it.
#[inline(never)]
fn meet_upon(scene: &Baked, landing: &Landing, media: Media, glass: SurfacePoint) -> Meeting {
    let &Landing { position, direction, primitive, .. } = landing;
    let face = |surface: &SurfacePoint| (surface.surface.material, direction.dot(surface.normal) < 0.0);
    let others = scene.geometry.upon(primitive, position);
    let surface = |other: PrimitiveId| at_rest(scene.geometry.surface_point(other, position), landing);
    let others = || others.iter().map(|&other| (other, surface(other)));
    if let Some((solid, surface)) = others().find(|(_, other)| !is_glass(scene, other)) {
        return Meeting { primitive: solid, surface, eta: 1.0, beyond: media };
    }
    let faces = std::iter::once(face(&glass)).chain(others().map(|(_, other)| face(&other)));
    let crossing = InterfaceCrossing::of(media, faces);
    let eta = relative_index(&scene.materials, &crossing);
    Meeting { primitive, surface: glass, eta, beyond: crossing.into }
}
