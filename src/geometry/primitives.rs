//! The columns of primitives that a scene bakes to, before the BVH is built.

use glam::DVec3;

use super::mesh::{Instance, Mesh};

/// What a primitive belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Surface {
    /// Index into the baked materials.
    pub material: u32,
    /// Index into the baked entity names.
    pub entity: u32,
}

/// A sphere, world space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sphere {
    /// Centre.
    pub center: DVec3,
    /// Radius, positive.
    pub radius: f64,
}

/// A flat annulus, world space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Disk {
    /// Centre.
    pub center: DVec3,
    /// Unit normal.
    pub normal: DVec3,
    /// Inner radius, ≥ 0.
    pub inner: f64,
    /// Outer radius, > inner.
    pub outer: f64,
}

/// All primitives of a scene; each is paired with its surface.
#[derive(Clone, Debug, Default)]
pub struct Primitives {
    /// Spheres.
    pub spheres: Vec<(Sphere, Surface)>,
    /// Flat annuli.
    pub disks: Vec<(Disk, Surface)>,
    /// Meshes, shared by instances.
    pub meshes: Vec<Mesh>,
    /// Placed meshes.
    pub instances: Vec<(Instance, Surface)>,
}
