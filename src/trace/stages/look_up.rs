//! Lookup of the material where a ray lands: textures, vertex colours and normal maps.

use glam::DVec3;

use super::super::transport::Landing;
use super::meet::Meeting;
use crate::geometry::PrimitiveId;
use crate::scene::Baked;
use crate::shade::{Footprint, Lobe, Material};

/// Looks up the material that a ray meets where it lands if textures, filtered over a footprint, vary it, which may also
/// change the shading normal; `None` for that of the scene as it is.
#[inline(always)]
pub fn look_up(
    scene: &Baked,
    landing: &Landing,
    footprint: Footprint,
    meeting: &mut Meeting,
    varied: &mut Option<Material>,
) {
    *varied = None;
    let material = meeting.material(scene);
    if material.maps.is_empty() {
        return;
    }
    // A copy, and a normal to be put in, so that both stay in registers where there are no textures.
    let (landing, surface_normal) = (*landing, meeting.surface.shading_normal);
    let at = (&landing, meeting.primitive, surface_normal);
    meeting.surface.shading_normal =
        textured(scene, material, at, footprint, varied).unwrap_or(surface_normal);
}

/// Looks up the material at a point of a mesh: the shading normal if a texture tells. What has no vertices has no textures.
#[inline(never)]
fn textured(
    scene: &Baked,
    material: &Material,
    (landing, primitive, shading_normal): (&Landing, PrimitiveId, DVec3),
    footprint: Footprint,
    varied: &mut Option<Material>,
) -> Option<DVec3> {
    let point = scene.geometry.mesh_point(primitive, landing.position)?;
    let textures = &scene.textures;
    let at_rest = |normal: DVec3| {
        let [_, normal] = landing.stretch.normals([normal; 2]);
        normal
    };
    let found = varied.insert(material.at(&point, footprint, textures));
    if let Lobe::Lacquered(lobe) = &mut found.lobe {
        // Without normals of its own the coat lies flat over bumps of what is beneath.
        let normal = material.clearcoat_normal_at(&point, footprint, textures);
        lobe.clearcoat_normal = normal.map_or(shading_normal, at_rest);
    }
    material.normal_at(&point, footprint, textures).map(at_rest)
}
