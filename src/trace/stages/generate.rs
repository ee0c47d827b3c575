//! Camera rays.

use glam::{DVec2, DVec3, Vec3};

use super::super::job::Job;
use super::super::path::Path;
use super::super::work::Work;
use super::draw::Draw;
use crate::scene::Filter;

/// The path `index` of `work`, before its camera ray.
///
/// Paths are numbered sample by sample within each pixel, so that lanes next to each other see much the same scene.
#[inline]
pub fn start(job: &Job, work: &Work, index: u32) -> Path {
    let ((x, y), gathers) = work.path(index);
    Path {
        pixel: (y * job.settings.width + x) as u32,
        sample: work.first_sample + index % work.samples,
        slot: index,
        depth: 1,
        looks: 0,
        throughput: Vec3::ONE,
        gathers,
        radiance: Vec3::ZERO,
        media: job.media,
    }
}

/// World start and unit direction of a path's camera ray, from four numbers in [0, 1): two for the film, two for the
/// lens. `None` beside the picture of a fisheye.
#[inline]
pub fn camera_ray(job: &Job, path: &Path, numbers: [f32; 4]) -> Option<(DVec3, DVec3)> {
    let width = job.settings.width as u32;
    let [u, v, on_lens @ ..] = numbers.map(f64::from);
    let offset = match job.settings.filter {
        Filter::Box => DVec2::new(u, v),
        Filter::Tent => DVec2::new(0.5 + tent(u), 0.5 + tent(v)),
    };
    let size = DVec2::new(job.settings.width as f64, job.settings.height as f64);
    let corner = DVec2::new(f64::from(path.pixel % width), f64::from(path.pixel / width));
    job.scene.camera.ray((corner + offset) / size, size.x / size.y, DVec2::from(on_lens))
}

/// Both, one path at a time.
#[inline]
pub fn generate(job: &Job, work: &Work, index: u32) -> (Path, Option<(DVec3, DVec3)>) {
    let path = start(job, work, index);
    let ray = camera_ray(job, &path, job.sampler.point(Draw::Ray.key(&path, 0)));
    (path, ray)
}

/// A number with the density of a tent on [−1, 1].
fn tent(u: f64) -> f64 {
    if u < 0.5 { (2.0 * u).sqrt() - 1.0 } else { 1.0 - (2.0 - 2.0 * u).sqrt() }
}

#[cfg(test)]
mod tests {
    use super::tent;

    #[test]
    fn the_tent_has_mean_zero_and_variance_one_sixth() {
        const N: usize = 100_000;
        let points = || (0..N).map(|i| tent((i as f64 + 0.5) / N as f64));
        let mean = points().sum::<f64>() / N as f64;
        let variance = points().map(|t| t * t).sum::<f64>() / N as f64;
        assert!(mean.abs() < 1e-9 && (variance - 1.0 / 6.0).abs() < 1e-6, "{mean} {variance}");
    }
}
