//! The next bounce of a path, and Russian roulette.

use glam::{DVec3, Vec3};

use super::super::job::Job;
use super::super::path::Path;
use super::meet::Meeting;
use crate::shade::{Bounce, Material};

/// Ratio of a path's probability to survive roulette to its throughput: with 1 roulette adds a quarter to the variance of
/// a white room for a tenth fewer rays, with 4 hardly anything for a twentieth.
const SURVIVAL: f32 = 4.0;

/// Continues a path that meets a surface in a unit direction, with four numbers in [0, 1); `None` if it ends here.
#[inline]
pub fn scatter(
    job: &Job,
    path: &mut Path,
    (meeting, material): (&Meeting, &Material),
    direction: DVec3,
    numbers: [f32; 4],
) -> Option<Bounce> {
    let bounce = material.lobe.sample(&meeting.incidence(direction), numbers);
    take(job, path, meeting, &bounce, numbers[3]).then_some(bounce)
}

/// Takes a path through a bounce, with a number in [0, 1); false if it ends here.
///
/// Roulette ends some paths of small throughput and makes up for it in those that survive: the mean is unchanged.
#[inline]
pub fn take(job: &Job, path: &mut Path, meeting: &Meeting, bounce: &Bounce, number: f32) -> bool {
    if path.depth >= job.settings.max_depth {
        return false;
    }
    debug_assert!(bounce.direction.is_normalized() && bounce.density >= 0.0, "{bounce:?}");
    path.throughput *= bounce.weight;
    debug_assert!(path.throughput.is_finite() && path.throughput.min_element() >= 0.0, "{bounce:?}");
    path.media = meeting.media_after(bounce, path.media);
    if path.throughput == Vec3::ZERO {
        return false;
    }
    if path.depth >= job.settings.roulette_depth {
        let survival = (SURVIVAL * path.throughput.max_element()).min(1.0);
        if number >= survival {
            return false;
        }
        path.throughput /= survival;
    }
    path.depth += 1;
    true
}
