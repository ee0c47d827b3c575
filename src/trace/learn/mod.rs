//! Learning from rays that are no samples: of the lights and of the edges of lamps, before passes.
//!
//! More samples are worth more learning. Of the lights is learned anew, from more rays, before the passes that make a
//! picture a few times as good as it was. How many these are follows from the size of the whole picture and the number
//! of the pass: not from the samples asked for, nor the crop or the time, so that a picture that is extended is the one
//! that was asked for. All of it stops when the job's halt is due.

pub mod lamp_edges;
pub mod photons;
pub mod visible_caps;

use super::job::Job;
use super::passes::pass_of;
use super::transport::Transport;
use crate::scene::MAX_SPP;

/// Rays from which is learned of the lights.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Lesson {
    /// Camera paths that look for the visible parts of lamps.
    pub looks: usize,
    /// Photons.
    pub photons: u32,
}

/// Camera paths for each path that looks around, and for each photon, of the smallest picture that follows: most of it
/// is samples then, too.
const PATHS: [usize; 2] = [56, 7];
/// Most paths that look around, and for how many pixels there is one in any case, of so many paths: a lamp in a small
/// picture should be met a few times.
const MOST_LOOKS: usize = 4096;
const PIXELS: usize = 16;
const LOOKS_IN_ANY_CASE: usize = 256;
/// Most photons for each pixel, in any case in pictures of few pixels, and in all.
const PER_PIXEL: usize = 7;
const IN_ANY_CASE: usize = 1 << 14;
const MOST_PHOTONS: usize = 1 << 19;

impl Lesson {
    /// The lesson that a picture of so many pixels, and samples of each, is worth. More samples are worth another one only
    /// if they are four times as many.
    pub fn of(pixels: usize, samples: u32) -> Self {
        let four_to = |power: u32| 1u32 << (2 * power);
        let first = pass_of(four_to(samples.max(1).ilog2() / 2) - 1).start;
        let paths = pixels.saturating_mul(first as usize + 1);
        let most = pixels.saturating_mul(PER_PIXEL).clamp(IN_ANY_CASE, MOST_PHOTONS);
        let least = (pixels / PIXELS).clamp(1, LOOKS_IN_ANY_CASE);
        Self {
            looks: (paths / PATHS[0]).clamp(least, MOST_LOOKS),
            photons: (paths / PATHS[1]).clamp(1, most) as u32,
        }
    }

    /// All lessons of a picture of so many pixels, and samples of each.
    pub fn all(pixels: usize, samples: u32) -> Vec<Self> {
        let end = pass_of(samples.clamp(1, MAX_SPP) - 1).end;
        let numbers = (0..16).map(|fours| 1 << (2 * fours)).take_while(|&number| number <= end);
        let mut lessons: Vec<Self> = numbers.map(|number| Self::of(pixels, number)).collect();
        lessons.dedup();
        lessons
    }
}

/// Learns a lesson: which parts of the lamps can be seen, and where their light comes from through mirrors and glass.
/// Nothing of it depends on what was learned before; not worth anything once the job's halt is due.
pub fn learn_lights<T: Transport>(job: &mut Job, transport: &T, lesson: Lesson) {
    let Some(mut illumination) = job.illumination.take() else { return };
    visible_caps::learn(job, transport, &mut illumination, lesson.looks);
    photons::learn(job, transport, &mut illumination, lesson.photons);
    job.illumination = Some(illumination);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_picture_has_a_first_lesson_and_better_ones_a_few_more() {
        assert_eq!(Lesson::all(10_000, 0).len(), 1);
        assert_eq!(Lesson::all(10_000, 1), [Lesson { looks: 256, photons: 1428 }]);
        assert_eq!(Lesson::all(10_000, 3)[1], Lesson { looks: 357, photons: 2857 });
        let all = Lesson::all(10_000, u32::MAX);
        assert_eq!(all.len(), 4, "{all:?}");
        assert_eq!(all[3], Lesson { looks: MOST_LOOKS, photons: 70_000 });
        assert_eq!(Lesson::all(100, 1 << 20).last().unwrap().photons, IN_ANY_CASE as u32);
        assert_eq!(Lesson::of(10_000, 17), Lesson::of(10_000, 63));
    }

    #[test]
    fn lessons_take_few_rays_of_a_picture() {
        for pixels in [1usize, 500, 20_000, 4_000_000] {
            for samples in [1u32, 2, 7, 64, 1000] {
                let rays: usize = Lesson::all(pixels, samples)
                    .iter()
                    .map(|lesson| lesson.looks + lesson.photons as usize)
                    .sum();
                let paths = pixels * samples as usize;
                assert!(rays <= paths / 2 + 8, "{rays} rays of {paths} paths");
            }
        }
    }
}
