//! Lookup of the material where a ray lands: textures, vertex colours and normal maps.

use glam::DVec3;

use super::super::transport::Landing;
use super::meet::Meeting;
use crate::geometry::PrimitiveId;
use crate::scene::Baked;
use crate::shade::{Lobe, Material};

/// The material that a ray meets where it lands, if textures vary it, which may also change the shading normal; `None`
/// for that of the scene as it is. What the camera `is_seen` to look at is filtered by the width of its pixels.
#[inline(always)]
pub fn look_up(scene: &Baked, landing: &Landing, is_seen: bool, meeting: &mut Meeting) -> Option<Material> {
    let material = meeting.material(scene);
    if material.maps.is_empty() {
        return None;
    }
    // A copy, and a normal to be put in, so that both stay in registers where there are no textures.
    let (landing, surface_normal) = (*landing, meeting.surface.shading_normal);
    let (varied, normal) = textured(scene, material, (&landing, meeting.primitive, surface_normal), is_seen)?;
    meeting.surface.shading_normal = normal.unwrap_or(surface_normal);
    Some(varied)
}

/// The material at a point of a mesh, and the shading normal if a texture tells; what has no vertices has no textures.
#[inline(never)]
fn textured(
    scene: &Baked,
    material: &Material,
    (landing, primitive, shading_normal): (&Landing, PrimitiveId, DVec3),
    is_seen: bool,
) -> Option<(Material, Option<DVec3>)> {
    let point = scene.geometry.mesh_point(primitive, landing.position)?;
    let width = if is_seen { filter_width(scene, landing) } else { 0.0 };
    let textures = &scene.textures;
    let at_rest = |normal: DVec3| {
        let [_, normal] = landing.stretch.normals([normal; 2]);
        normal
    };
    let mut found = material.at(&point, width, textures);
    if let Lobe::Lacquered(lobe) = &mut found.lobe {
        // Without normals of its own the coat lies flat over bumps of what is beneath.
        let normal = material.clearcoat_normal_at(&point, width, textures);
        lobe.clearcoat_normal = normal.map_or(shading_normal, at_rest);
    }
    Some((found, material.normal_at(&point, width, textures).map(at_rest)))
}

/// Width at which what the camera sees is filtered: of half a pixel's beam, since the samples of a pixel filter as well.
/// It goes by the distance alone: where a lens makes a picture smaller than that, the samples see more of it. 0 on the
/// other side of a wormhole.
fn filter_width(scene: &Baked, landing: &Landing) -> f64 {
    let camera = &scene.camera;
    if landing.primitive.side() != camera.side {
        return 0.0;
    }
    0.5 * scene.pixel().at(landing.position.distance(camera.position))
}
