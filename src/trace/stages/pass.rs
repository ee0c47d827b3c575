//! Passage of rays through surfaces that are not opaque: a ray meets one with the probability of its opacity, and else
//! goes on behind it as if nothing were there.

use super::super::job::Job;
use super::super::path::Path;
use super::super::transport::{Landing, Start};
use super::draw::Draw;
use crate::scene::Baked;
use crate::shade::Material;

/// Most surfaces that the rays of a path look at so; the next is opaque.
const MOST: u32 = 1 << 10;

/// Opacity where a ray lands.
pub fn opacity(scene: &Baked, landing: &Landing) -> f32 {
    let &Landing { primitive, position, .. } = landing;
    let Material { opacity, .. } = &scene.materials[scene.geometry.surface(primitive).material as usize];
    let at = |point| opacity.as_ref().map_or(1.0, |opacity| opacity.at(point, &scene.textures));
    at(scene.geometry.mesh_point(primitive, position).as_ref())
}

/// True if a ray of a path passes through the surface that it lands on.
#[inline(always)]
pub fn passes(job: &Job, path: &mut Path, landing: &Landing) -> bool {
    if !job.has_passages {
        return false;
    }
    // A copy, so that landings stay in registers where nothing is passed through.
    let landing = *landing;
    passes_here(job, path, &landing)
}

#[inline(never)]
fn passes_here(job: &Job, path: &mut Path, landing: &Landing) -> bool {
    let opacity = opacity(job.scene, landing);
    if opacity >= 1.0 || path.looks >= MOST {
        return false;
    }
    path.looks += 1;
    let number = || job.sampler.point::<[f64; 2]>(Draw::Pass.key(path, path.looks))[0];
    opacity <= 0.0 || number() >= f64::from(opacity)
}

/// The ray that goes on behind a surface.
#[inline]
pub fn behind<C>(landing: &Landing, carried: C) -> Start<C> {
    let &Landing { position, direction, primitive: origin_prim, .. } = landing;
    Start { position, direction, origin_prim, carried }
}
