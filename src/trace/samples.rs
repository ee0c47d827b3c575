//! What the paths of one tile and pass give, in (pixel, sample) order: the only place where finished work waits.
//!
//! Paths end in any order; their results are kept apart until all have ended and are then summed in sample order, so
//! that no schedule, batch size or thread count can change a sum.

use glam::{DVec3, Vec3};

use super::fate::Fate;
use crate::film::Aov;

/// Which planes beside the beauty are wanted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Wanted {
    /// Anything about the first hit.
    pub first_hit: bool,
    /// Path length to the first hit.
    pub depth: bool,
    /// Sum of squares.
    pub variance: bool,
    /// March steps.
    pub steps: bool,
}

impl Wanted {
    /// What `aovs` need; `noise` says that the variance is needed to decide when to stop.
    pub fn new(aovs: &[Aov], noise: bool) -> Self {
        use Aov::*;
        let any = |list: &[Aov]| aovs.iter().any(|aov| list.contains(aov));
        Self {
            first_hit: any(&[Depth, Normal, Albedo, Position, Entity, Fate]),
            depth: any(&[Depth]),
            variance: noise || any(&[Variance]),
            steps: any(&[Steps]),
        }
    }
}

/// What the camera ray of a path met first.
#[derive(Clone, Copy, Debug, Default)]
pub struct FirstHit {
    /// How the camera ray ended.
    pub fate: Fate,
    /// Coordinate path length to the hit.
    pub depth: f64,
    /// World position.
    pub position: DVec3,
    /// World shading normal.
    pub normal: DVec3,
    /// Material colour.
    pub albedo: Vec3,
    /// Entity index.
    pub entity: u32,
}

/// Results of the paths of one tile and pass.
pub struct Samples {
    /// Radiance of each path.
    pub radiance: Vec<Vec3>,
    /// Whether its camera ray hides what a compositor puts behind the picture.
    pub covered: Vec<bool>,
    /// What its camera ray met; empty unless wanted.
    pub first: Vec<FirstHit>,
    /// Its march steps; empty unless wanted.
    pub steps: Vec<u32>,
    wanted: Wanted,
}

impl Samples {
    /// Room for `count` paths.
    pub fn new(wanted: Wanted, count: usize) -> Self {
        let optional = |yes: bool| if yes { count } else { 0 };
        Self {
            radiance: vec![Vec3::ZERO; count],
            covered: vec![true; count],
            first: vec![FirstHit::default(); optional(wanted.first_hit)],
            steps: vec![0; optional(wanted.steps)],
            wanted,
        }
    }

    /// What is recorded.
    pub fn wanted(&self) -> Wanted {
        self.wanted
    }
}
