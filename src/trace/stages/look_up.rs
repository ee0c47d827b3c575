//! Lookup of the material where a ray lands: textures, vertex colours and normal maps.

use glam::DVec3;

use super::super::transport::Landing;
use super::meet::Meeting;
use crate::geometry::PrimitiveId;
use crate::scene::Baked;
use crate::shade::Material;

/// The material that a ray meets where it lands, if textures vary it, which may also change the shading normal; `None`
/// for that of the scene as it is. What the camera `is_seen` to look at is filtered by the width of its pixels.
#[inline(always)]
pub fn look_up(scene: &Baked, landing: &Landing, is_seen: bool, meeting: &mut Meeting) -> Option<Material> {
    let material = meeting.material(scene);
    if material.maps.is_empty() {
        return None;
    }
    // A copy, and a normal to be put in, so that both stay in registers where there are no textures.
    let landing = *landing;
    let (varied, normal) = textured(scene, material, (&landing, meeting.primitive), is_seen)?;
    meeting.surface.shading_normal = normal.unwrap_or(meeting.surface.shading_normal);
    Some(varied)
}

/// The material at a point of a mesh, and the shading normal if a texture tells; what has no vertices has no textures.
#[inline(never)]
fn textured(
    scene: &Baked,
    material: &Material,
    (landing, primitive): (&Landing, PrimitiveId),
    is_seen: bool,
) -> Option<(Material, Option<DVec3>)> {
    let point = scene.geometry.mesh_point(primitive, landing.position)?;
    let width = if is_seen { filter_width(scene, landing) } else { 0.0 };
    let normal = material.normal_at(&point, width, &scene.textures);
    let normal = normal.map(|normal| landing.stretch.normals([normal])[0]);
    Some((material.at(&point, width, &scene.textures), normal))
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
