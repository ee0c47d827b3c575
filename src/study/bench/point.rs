//! Setting of a race, common to all its contenders.

use crate::scene::{Baked, Settings};
use crate::spacetime::SpacetimeKind;
use crate::trace::Run;

/// Setting of a race, common to all its contenders.
#[derive(Clone, Debug, PartialEq)]
pub struct Point {
    /// The value of what is varied, if anything is.
    pub value: Option<f64>,
    /// Index of the scene.
    pub scene: usize,
    /// Its spacetime.
    pub spacetime: SpacetimeKind,
    /// Its settings.
    pub settings: Settings,
    /// Worker threads; 0 means one per core.
    pub threads: usize,
    /// Rays in a worker's wavefront.
    pub batch: usize,
}

#[cfg(test)]
impl Point {
    /// A point of flat space.
    pub(super) fn flat() -> Self {
        let (spacetime, settings) = (SpacetimeKind::Flat, Settings::default());
        Self { value: None, scene: 0, spacetime, settings, threads: 1, batch: 8 }
    }
}

impl Point {
    /// The scene as it is, rendered by `run`.
    pub fn of(scene: &Baked, run: &Run) -> Self {
        Self {
            value: None,
            scene: 0,
            spacetime: scene.spacetime.clone(),
            settings: scene.settings.clone(),
            threads: run.threads,
            batch: run.batch,
        }
    }

    /// True if both points have the same picture, threads and batches left aside.
    pub(super) fn has_picture_of(&self, other: &Self) -> bool {
        (self.scene, &self.spacetime, &self.settings) == (other.scene, &other.spacetime, &other.settings)
    }
}
