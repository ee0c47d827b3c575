//! The hole in its place: from the world to units of its mass, with the axis along z, and back.

use glam::{DMat3, DVec3};

use super::hole::UnitHole;
use crate::spacetime::{KerrNewman, Placement};

/// A spinning hole in the world, as rays that are traced into the past meet it.
#[derive(Clone, Copy, Debug)]
pub struct PlacedHole {
    /// The hole, with time reversed.
    pub hole: UnitHole,
    /// World position of its centre.
    pub center: DVec3,
    /// M, scene units.
    pub mass: f64,
    to_hole: DMat3,
    to_world: DMat3,
}

impl PlacedHole {
    /// `hole` in its `placement`.
    pub fn new(placement: Placement, hole: &KerrNewman) -> Self {
        let to_hole = placement.rotation();
        Self {
            hole: UnitHole::reversed(hole),
            center: placement.center,
            mass: hole.mass(),
            to_hole,
            to_world: to_hole.transpose(),
        }
    }

    /// A vector of the world, along the hole's axes.
    #[inline(always)]
    pub fn inwards(&self, vector: DVec3) -> DVec3 {
        self.to_hole * vector
    }

    /// A vector along the hole's axes, in the world.
    #[inline(always)]
    pub fn outwards(&self, vector: DVec3) -> DVec3 {
        self.to_world * vector
    }
}
