//! Russian roulette and the next bounce.

use glam::{DVec3, Vec3};

use super::super::path::Path;
use super::super::transport::Landing;
use super::super::work::Job;
use crate::geometry::SurfacePoint;
use crate::shade::{self, Incidence};

/// Continues a path from a surface: the unit direction it leaves in, or `None` if it ends here.
///
/// Roulette ends a path with probability 1 − max(throughput) and makes up for it in those that survive: the mean is
/// unchanged.
#[inline]
pub fn scatter(job: &Job, path: &mut Path, landing: &Landing, surface: &SurfacePoint) -> Option<DVec3> {
    if path.depth >= job.settings.max_depth {
        return None;
    }
    let numbers = job.sampler.four(path.pixel, path.sample, path.depth);
    let incidence = Incidence {
        direction: landing.direction,
        normal: surface.normal,
        shading_normal: surface.shading_normal,
        material: surface.surface.material,
        media: path.media,
    };
    let bounce = shade::scatter(&job.scene.materials, &incidence, numbers)?;
    path.throughput *= bounce.weight;
    path.media = bounce.media;
    if path.throughput == Vec3::ZERO {
        return None;
    }
    if path.depth >= job.settings.roulette_depth {
        let survival = path.throughput.max_element().min(1.0);
        if numbers[3] >= survival {
            return None;
        }
        path.throughput /= survival;
    }
    path.depth += 1;
    Some(bounce.direction)
}
