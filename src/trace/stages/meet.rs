//! Surface, or glass and all that lies upon it, that a path meets where it lands.

use glam::DVec3;

use super::super::transport::Landing;
use crate::geometry::{PrimitiveId, SurfacePoint};
use crate::scene::Baked;
use crate::shade::{Incidence, InterfaceCrossing, Media};

/// Surface that a path meets where it lands.
pub struct Meeting {
    /// The primitive: of several that lie upon each other a solid one, else the first.
    pub primitive: PrimitiveId,
    /// Its surface.
    pub surface: SurfacePoint,
    /// Through what light goes that is refracted.
    crossing: InterfaceCrossing,
}

/// Looks up the surface that a path in `media` meets where it lands. Glass is met together with all that lies upon it
/// there: what is solid stops light, and further glass is crossed with it.
#[inline(always)]
pub fn meet(scene: &Baked, landing: &Landing, media: Media) -> Meeting {
    let mut meeting = Meeting {
        primitive: landing.primitive,
        surface: surface_at(scene, landing.primitive, landing),
        crossing: InterfaceCrossing::none(media),
    };
    if is_glass(scene, &meeting.surface) {
        meet_upon(scene, landing, media, &mut meeting);
    }
    meeting
}

impl Meeting {
    /// Incidence on it of light in `media` that travels in a unit direction.
    #[inline(always)]
    pub fn incidence(&self, direction: DVec3, media: Media) -> Incidence {
        let SurfacePoint { normal, shading_normal, surface, .. } = self.surface;
        let crossing = self.crossing;
        Incidence { direction, normal, shading_normal, material: surface.material, media, crossing }
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

/// Meets what lies upon glass with it.
#[inline(never)]
fn meet_upon(scene: &Baked, landing: &Landing, media: Media, meeting: &mut Meeting) {
    let &Landing { position, direction, primitive, .. } = landing;
    let face = |surface: &SurfacePoint| (surface.surface.material, direction.dot(surface.normal) < 0.0);
    let others = scene.geometry.upon(primitive, position);
    let others = || others.iter().map(|&other| (other, surface_at(scene, other, landing)));
    if let Some((solid, surface)) = others().find(|(_, other)| !is_glass(scene, other)) {
        (meeting.primitive, meeting.surface) = (solid, surface);
        return;
    }
    let faces = std::iter::once(face(&meeting.surface)).chain(others().map(|(_, other)| face(&other)));
    meeting.crossing = InterfaceCrossing::of(media, faces);
}
