//! Learning from rays that are no samples: of the lights before the first sample, of the edges of lamps before each
//! pass. All of it stops when the job's halt is due, and depends on the scene and its seed alone.

pub mod lamp_edges;
pub mod photons;
pub mod visible_caps;

use super::illumination::Illumination;
use super::job::Job;
use super::transport::Transport;

/// Sets up the light sampling of `job`: learns what of the lamps can be seen, and where their light comes from through
/// mirrors and glass. Not worth anything once the job's halt is due.
pub fn learn_lights<T: Transport>(job: &mut Job, transport: &T) {
    let Some(mut illumination) = Illumination::of(job.scene, transport) else { return };
    visible_caps::learn(job, transport, &mut illumination);
    photons::learn(job, transport, &mut illumination, photons::count(job.settings));
    job.illumination = Some(illumination);
}
