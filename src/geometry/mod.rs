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

    /// How many primitives there are.
    pub fn counts(&self) -> Counts {
        Counts::default()
    }

    /// Bytes that primitives and BVH occupy.
    pub fn memory_bytes(&self) -> usize {
        0
    }
}

/// How many primitives there are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Spheres.
    pub spheres: usize,
    /// Flat annuli.
    pub disks: usize,
    /// Triangles of all meshes, each mesh counted once.
    pub triangles: usize,
    /// Triangles of all instances.
    pub instanced_triangles: usize,
    /// Meshes.
    pub meshes: usize,
    /// Placed meshes.
    pub instances: usize,
}
