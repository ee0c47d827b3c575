//! Lookup of a material where a ray lands: textures, vertex colours and normal maps.

use super::super::transport::Landing;
use crate::geometry::{PrimitiveId, SurfacePoint};
use crate::scene::Baked;
use crate::shade::Material;

/// The material where a ray lands, if textures vary it; they may change the shading normal. What the camera `is_seen` to
/// look at is filtered by the width of its pixels.
#[inline(always)]
pub fn look_up(
    scene: &Baked,
    primitive: PrimitiveId,
    landing: &Landing,
    is_seen: bool,
    surface: &mut SurfacePoint,
) -> Option<Material> {
    let material = &scene.materials[surface.surface.material as usize];
    if material.maps.is_empty() {
        return None;
    }
    textured(scene, material, primitive, landing, is_seen, surface)
}

/// The material at a point of a mesh, whose shading normal may change; `None` on what has no vertices.
#[inline(never)]
fn textured(
    scene: &Baked,
    material: &Material,
    primitive: PrimitiveId,
    landing: &Landing,
    is_seen: bool,
    surface: &mut SurfacePoint,
) -> Option<Material> {
    let point = scene.geometry.mesh_point(primitive, landing.position)?;
    let width = if is_seen { pixel_width(scene, landing) } else { 0.0 };
    if let Some(normal) = material.normal_at(&point, width, &scene.textures) {
        [_, surface.shading_normal] = landing.stretch.normals([normal; 2]);
    }
    Some(material.at(&point, width, &scene.textures))
}

/// Width of a pixel's beam where a ray of the camera lands, by the distance alone: where a lens makes a picture smaller
/// than that, the samples of the pixel see more of it. 0 on the other side of a wormhole.
fn pixel_width(scene: &Baked, landing: &Landing) -> f64 {
    let camera = &scene.camera;
    if landing.primitive.side() != camera.side {
        return 0.0;
    }
    let pixel = 2.0 * camera.tan_half_fov / scene.settings.height as f64;
    pixel * landing.position.distance(camera.position)
}
