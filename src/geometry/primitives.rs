//! The columns of primitives that a scene bakes to, before the BVH is built.

use std::collections::{HashMap, HashSet};
use std::hash::{DefaultHasher, Hash, Hasher};

use glam::DVec3;

use super::mesh::{Instance, Mesh};

/// Material and entity of a primitive.
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

impl Primitives {
    /// Drops what coincides exactly with something of the same kind given before; how many objects that were.
    pub fn drop_doubles(&mut self) -> usize {
        let bits = |v: DVec3| v.to_array().map(f64::to_bits);
        let of_sphere = |sphere: &Sphere| (bits(sphere.center), sphere.radius.to_bits());
        let of_disk =
            |disk: &Disk| (bits(disk.center), bits(disk.normal), disk.inner.to_bits(), disk.outer.to_bits());
        let meshes = first_alike(&self.meshes);
        let of_instance = |instance: &Instance| {
            (meshes[instance.mesh as usize], instance.to_world.to_cols_array().map(f64::to_bits))
        };
        retain_first(&mut self.spheres, of_sphere)
            + retain_first(&mut self.disks, of_disk)
            + retain_first(&mut self.instances, of_instance)
    }
}

/// Keeps the first of all that have the same key; how many it drops.
fn retain_first<T, K: Hash + Eq>(all: &mut Vec<(T, Surface)>, key: impl Fn(&T) -> K) -> usize {
    let (before, mut seen) = (all.len(), HashSet::with_capacity(all.len()));
    all.retain(|(one, _)| seen.insert(key(one)));
    before - all.len()
}

/// Of each mesh, the first that is the same.
fn first_alike(meshes: &[Mesh]) -> Vec<u32> {
    let mut seen: HashMap<u64, Vec<u32>> = HashMap::new();
    let mut first = Vec::with_capacity(meshes.len());
    for (index, mesh) in (0..).zip(meshes) {
        let mut hasher = DefaultHasher::new();
        mesh.triangles.hash(&mut hasher);
        mesh.positions.iter().for_each(|position| position.map(f32::to_bits).hash(&mut hasher));
        let alike = seen.entry(hasher.finish()).or_default();
        let found = alike.iter().copied().find(|&other| meshes[other as usize] == *mesh);
        if found.is_none() {
            alike.push(index);
        }
        first.push(found.unwrap_or(index));
    }
    first
}
