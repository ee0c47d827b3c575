//! Clusters of emitters, exact, while a light tree is built.
//!
//! References: as for the [tree](super).

use glam::DVec3;

use super::cone::Cone;

/// Emitters seen as one.
#[derive(Clone, Copy)]
pub struct Cluster {
    /// World bounds.
    pub min: DVec3,
    /// World bounds.
    pub max: DVec3,
    /// Power relative to the brightest emitter's.
    pub power: f64,
    /// Directions into which it shines.
    pub cone: Cone,
}

impl Cluster {
    /// The cluster of both.
    pub fn union(self, other: Cluster) -> Cluster {
        Cluster {
            min: self.min.min(other.min),
            max: self.max.max(other.max),
            power: self.power + other.power,
            cone: self.cone.union(other.cone),
        }
    }

    /// Surface-area-orientation heuristic of \[C\]: how often the cluster is in doubt, times what is at stake, with the
    /// area of the sphere around the bounds, which is all that the importance knows of them. (A box around emitters in
    /// a row has no area.)
    pub fn cost(&self) -> f64 {
        self.power * self.min.distance_squared(self.max) * self.cone.measure()
    }
}
