//! The next bounce of a path, and Russian roulette.

use glam::Vec3;

use super::super::job::Job;
use super::super::path::Path;
use crate::shade::{self, Bounce, Incidence};

/// Ratio of a path's probability to survive roulette to its throughput: with 1 roulette adds a quarter to the variance of
/// a white room for a tenth fewer rays, with 4 hardly anything for a twentieth.
const SURVIVAL: f32 = 4.0;

/// Continues a path from a surface, with four numbers in [0, 1); `None` if it ends here.
///
/// Roulette ends some paths of small throughput and makes up for it in those that survive: the mean is unchanged.
#[inline]
pub fn scatter(job: &Job, path: &mut Path, incidence: &Incidence, numbers: [f32; 4]) -> Option<Bounce> {
    if path.depth >= job.settings.max_depth {
        return None;
    }
    let bounce = shade::scatter(&job.scene.materials, incidence, numbers)?;
    debug_assert!(bounce.direction.is_normalized() && bounce.density >= 0.0, "{bounce:?}");
    path.throughput *= bounce.weight;
    debug_assert!(path.throughput.is_finite() && path.throughput.min_element() >= 0.0, "{bounce:?}");
    path.media = bounce.media;
    if path.throughput == Vec3::ZERO {
        return None;
    }
    if path.depth >= job.settings.roulette_depth {
        let survival = (SURVIVAL * path.throughput.max_element()).min(1.0);
        if numbers[3] >= survival {
            return None;
        }
        path.throughput /= survival;
    }
    path.depth += 1;
    Some(bounce)
}
