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
use super::transport::Transport;

/// Samples per pixel from which on the lights are learned of as well as such a picture is worth.
const LESSONS: [u32; 4] = [1, 4, 16, 32];

/// Lessons of a picture of up to `samples` per pixel, each by the samples per pixel that it is worth: the first is for
/// the first sample.
pub fn lessons(samples: u32) -> impl Iterator<Item = u32> {
    LESSONS.into_iter().filter(move |&lesson| lesson <= samples.max(1))
}

/// Learns `lesson`: which parts of the lamps can be seen, and where their light comes from through mirrors and glass.
/// Nothing of it depends on what was learned before; not worth anything once the job's halt is due.
pub fn learn_lights<T: Transport>(job: &mut Job, transport: &T, lesson: u32) {
    let Some(mut illumination) = job.illumination.take() else { return };
    let pixels = job.settings.width * job.settings.height;
    visible_caps::learn(job, transport, &mut illumination, lesson);
    photons::learn(job, transport, &mut illumination, photons::count(pixels, lesson));
    job.illumination = Some(illumination);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_picture_has_a_first_lesson_and_better_ones_a_few_more() {
        let count = |samples| lessons(samples).collect::<Vec<_>>();
        assert_eq!([count(0), count(1), count(8)], [vec![1], vec![1], vec![1, 4]]);
        assert_eq!(count(64), LESSONS);
    }
}
