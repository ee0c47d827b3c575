//! Results of the paths of one tile and pass, in (pixel, sample) order: the only place where finished work waits.
//!
//! Paths end in any order; their results are kept apart until all have ended and are then summed in sample order, so
//! that no schedule, batch size or thread count can change a sum.

use glam::Vec3;

use crate::film::{CameraRay, Needs, Sample, Wanted};

/// Results of the paths of one tile and pass.
pub struct Samples {
    /// Radiance of each path.
    pub radiance: Vec<Vec3>,
    /// True if its camera ray hides what a compositor puts behind the picture.
    pub covered: Vec<bool>,
    /// End of its camera ray; empty unless needed.
    pub camera_rays: Vec<CameraRay>,
    /// Its march steps; empty unless needed.
    pub steps: Vec<u32>,
    /// True if it crossed the halo of a lamp; empty unless that is looked for.
    pub near_lamps: Vec<bool>,
    needs: Needs,
}

impl Samples {
    /// Room for `count` paths.
    pub fn new(wanted: Wanted, count: usize) -> Self {
        let needs = wanted.needs();
        let optional = |yes: bool| if yes { count } else { 0 };
        Self {
            radiance: vec![Vec3::ZERO; count],
            covered: vec![true; count],
            camera_rays: vec![CameraRay::default(); optional(needs.camera_ray)],
            steps: vec![0; optional(needs.steps)],
            near_lamps: Vec::new(),
            needs,
        }
    }

    /// With a look out for halos of lamps.
    pub fn with_halos(self) -> Self {
        Self { near_lamps: vec![false; self.radiance.len()], ..self }
    }

    /// Records that are kept.
    pub fn needs(&self) -> Needs {
        self.needs
    }

    /// The path in a slot, as planes see it.
    pub fn get(&self, slot: usize) -> Sample<'_> {
        Sample {
            radiance: self.radiance[slot],
            camera_ray: self.camera_rays.get(slot),
            steps: self.steps.get(slot).copied().unwrap_or_default(),
        }
    }
}
