//! Lookup of the material where a ray lands: textures, vertex colours and normal maps.

use std::borrow::Cow;

use super::super::transport::Landing;
use super::meet::Meeting;
use crate::scene::Baked;
use crate::shade::Material;

/// The material that a ray meets where it lands: the scene's, or as textures vary it, which may also change the shading
/// normal. What the camera `is_seen` to look at is filtered as its pixels are wide.
#[inline(always)]
pub fn look_up<'a>(
    scene: &'a Baked,
    landing: &Landing,
    is_seen: bool,
    meeting: &mut Meeting,
) -> Cow<'a, Material> {
    let material = &scene.materials[meeting.surface.surface.material as usize];
    if material.maps.is_empty() {
        return Cow::Borrowed(material);
    }
    textured(scene, material, landing, is_seen, meeting)
}

/// The material at a point of a mesh; what has no vertices has no textures.
#[inline(never)]
fn textured<'a>(
    scene: &Baked,
    material: &'a Material,
    landing: &Landing,
    is_seen: bool,
    meeting: &mut Meeting,
) -> Cow<'a, Material> {
    let Some(point) = scene.geometry.mesh_point(meeting.primitive, landing.position) else {
        return Cow::Borrowed(material);
    };
    let width = if is_seen { filter_width(scene, landing) } else { 0.0 };
    if let Some(normal) = material.normal_at(&point, width, &scene.textures) {
        [_, meeting.surface.shading_normal] = landing.stretch.normals([normal; 2]);
    }
    Cow::Owned(material.at(&point, width, &scene.textures))
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
