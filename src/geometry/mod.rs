//! Primitives, their intersection with lines and arcs, and the BVH over them.

mod mesh;
mod primitives;

pub use mesh::{Instance, Mesh};
pub use primitives::{Disk, Primitives, Sphere, Surface};

/// Primitives with their BVH.
pub struct Geometry {}

impl Geometry {
    /// Builds the BVH, in parallel.
    pub fn build(_primitives: Primitives) -> Self {
        Self {}
    }
}
