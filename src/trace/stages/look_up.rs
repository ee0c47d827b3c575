//! Lookup of the material where a ray lands: textures, vertex colours and normal maps.

use super::super::transport::Landing;
use super::meet::Meeting;
use crate::scene::Baked;
use crate::shade::{Footprint, Material};

/// The material that a ray meets where it lands, if textures vary it, which may also change the shading normal; `None`
/// for that of the scene as it is. Textures are filtered over a footprint.
#[inline(always)]
pub fn look_up(
    scene: &Baked,
    landing: &Landing,
    footprint: Footprint,
    meeting: &mut Meeting,
) -> Option<Material> {
    let material = meeting.material(scene);
    if material.maps.is_empty() {
        return None;
    }
    textured(scene, material, landing, footprint, meeting)
}

/// The material at a point of a mesh; what has no vertices has no textures.
#[inline(never)]
fn textured(
    scene: &Baked,
    material: &Material,
    landing: &Landing,
    footprint: Footprint,
    meeting: &mut Meeting,
) -> Option<Material> {
    let point = scene.geometry.mesh_point(meeting.primitive, landing.position)?;
    if let Some(normal) = material.normal_at(&point, footprint, &scene.textures) {
        [_, meeting.surface.shading_normal] = landing.stretch.normals([normal; 2]);
    }
    Some(material.at(&point, footprint, &scene.textures))
}
