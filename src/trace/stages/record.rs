//! Records of the camera ray's end and of its path's march steps, for the planes that were asked for.

use super::super::job::Job;
use super::super::path::Path;
use super::super::ray_end::RayEnd;
use super::super::samples::Samples;
use super::super::transport::{Landing, Transport};
use super::meet::Meeting;
use crate::film::CameraRay;
use crate::geometry::Found;
use crate::scene::Background;
use crate::shade::Material;
use crate::spacetime::Side;

/// Records the surface that a camera ray lands on; later rays are not recorded.
#[inline]
pub fn record_hit(
    path: &Path,
    landing: &Landing,
    meeting: &Meeting,
    material: &Material,
    samples: &mut Samples,
) {
    if path.depth > 1 || !samples.needs().camera_ray {
        return;
    }
    let surface = &meeting.surface;
    let ray = &mut samples.camera_rays[path.slot as usize];
    *ray = CameraRay {
        fate: RayEnd::Hit,
        side: Some(landing.primitive.side()),
        length: ray.length,
        position: landing.position,
        normal: surface.shading_normal,
        albedo: material.albedo(),
        entity: surface.surface.entity,
    };
}

/// Records how a camera ray ended that meets nothing; `side` is where it left to infinity.
#[inline]
pub fn record_end(job: &Job, path: &Path, fate: RayEnd, side: Option<Side>, samples: &mut Samples) {
    if path.depth > 1 {
        return;
    }
    let is_backed =
        |side| job.settings.background == Background::Opaque && !job.scene.environment(side).is_black();
    samples.covered[path.slot as usize] = side.is_none_or(is_backed);
    if samples.needs().camera_ray {
        let ray = &mut samples.camera_rays[path.slot as usize];
        (ray.fate, ray.side) = (fate, side);
    }
}

/// Records a path without a camera ray, beside the picture of a fisheye: as a ray to an infinity where nothing is.
pub fn record_beside(path: &Path, samples: &mut Samples) {
    samples.covered[path.slot as usize] = false;
    if samples.needs().camera_ray {
        samples.camera_rays[path.slot as usize].fate = RayEnd::Escaped;
    }
}

/// Records the way of a camera ray before its first step, computed only if wanted.
#[inline]
pub fn record_entrance(path: &Path, length: impl FnOnce() -> f64, samples: &mut Samples) {
    if samples.needs().length {
        samples.camera_rays[path.slot as usize].length += length();
    }
}

/// Adds a step, of a light ray or not, and for camera rays its length, computed only if wanted.
#[inline]
pub fn record_step(
    path: &Path,
    light_ray_in_flight: bool,
    length: impl FnOnce() -> f64,
    samples: &mut Samples,
) {
    if samples.needs().steps {
        samples.steps[path.slot as usize] += 1;
    }
    if samples.needs().length && path.depth == 1 && !light_ray_in_flight {
        samples.camera_rays[path.slot as usize].length += length();
    }
}

/// Records that a path's move crosses the halo of a lamp, if that is looked for.
#[inline]
pub fn record_halo<T: Transport>(
    job: &Job,
    transport: &T,
    ray: (&T::Flight, &T::Move, Option<Found>),
    path: &Path,
    samples: &mut Samples,
) {
    if let (Some(halos), Some(is_near)) = (&job.halos, samples.near_lamps.get_mut(path.slot as usize)) {
        *is_near |= halos.are_crossed(transport, ray);
    }
}
