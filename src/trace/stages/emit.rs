//! Light from surfaces.

use glam::{DVec3, Vec3};

use super::super::path::Path;
use crate::geometry::SurfacePoint;
use crate::shade::Material;

/// Adds what the surface emits towards a path that arrives in `direction`.
#[inline]
pub fn emit(material: &Material, surface: &SurfacePoint, direction: DVec3, path: &mut Path) {
    let front = direction.dot(surface.normal) < 0.0;
    if material.emission != Vec3::ZERO && (front || material.emits_both_sides) {
        path.radiance += path.throughput * material.emission;
    }
}
