//! From columns of primitives to hierarchies over them.

use glam::{DAffine3, DVec3};
use rayon::prelude::*;

use super::bvh::{Bvh, EMPTY, LEAF_SIZE};
use super::facets::Facets;
use super::scene::{Item, Placed, SharedMesh, Single};
use super::{Counts, Disk, Geometry, Instance, Line, Mesh, Primitives, Sphere, Surface, Triangle};
use crate::math::columns::Columns;

impl Geometry {
    /// Builds the BVHs, in parallel.
    ///
    /// Inputs are finite and in range: indices, invertible maps, positive radii. Meshes used by no instance are
    /// dropped.
    pub fn build(primitives: Primitives) -> Self {
        let Primitives { mut spheres, mut disks, mut meshes, instances } = primitives;
        let counts = count(&spheres, &disks, &meshes, &instances);
        let origin = choose_origin(&spheres, &disks, &meshes, &instances);
        spheres.iter_mut().for_each(|(sphere, _)| sphere.center -= origin);
        disks.iter_mut().for_each(|(disk, _)| disk.center -= origin);
        let to_local = |instance: &Instance| DAffine3::from_translation(-origin) * instance.to_world;
        let mut uses = vec![0usize; meshes.len()];
        instances.iter().for_each(|(instance, _)| uses[instance.mesh as usize] += 1);

        let shared: Vec<Option<SharedMesh>> = meshes
            .par_iter()
            .zip(&uses)
            .map(|(mesh, &uses)| (uses > 1).then(|| SharedMesh::build(mesh)))
            .collect();
        let mut others: Vec<Item> = (0..spheres.len() as u32).map(Item::Sphere).collect();
        others.extend((0..disks.len() as u32).map(Item::Disk));
        let (mut singles, mut triangles) = (Vec::new(), 0);
        for (index, (instance, _)) in (0..).zip(&instances) {
            let mesh = instance.mesh as usize;
            match (uses[mesh], meshes[mesh].triangles.len() as u32) {
                (1, 0) => {}
                (1, count) => {
                    singles.push(Single { first: triangles, instance: index });
                    triangles += count;
                }
                _ => others.push(Item::Instance(index)),
            }
        }
        let placed: Vec<Placed> =
            instances.iter().map(|(i, surface)| Placed::new(i, &to_local(i), *surface)).collect();

        let mut geometry = Self {
            origin,
            bvh: Bvh::build(0, 0..0, |_| Default::default()),
            others,
            triangles: Columns::default(),
            facets: Facets::default(),
            flat: Vec::new(),
            is_smooth: false,
            singles,
            spheres,
            disks,
            meshes: Vec::new(),
            shared,
            placed,
            counts,
            typical_extent: 0.0,
            near_spheres: Vec::new(),
            far: None,
        };
        let placings: Vec<Placing> = instances
            .iter()
            .map(|(instance, _)| Placing::new(&meshes[instance.mesh as usize], to_local(instance)))
            .collect();
        geometry.build_top(triangles as usize, &placings);
        geometry.near_spheres = geometry.near_spheres();
        meshes.iter_mut().for_each(Mesh::drop_what_shading_does_not_need);
        geometry.meshes = meshes;
        if geometry.is_small::<Line>() {
            let mut flat = vec![None; geometry.bvh.order().len()];
            geometry.members().for_each(|(slot, _)| flat[slot as usize] = geometry.flat_surface(slot));
            geometry.flat = flat;
        }
        geometry.is_smooth = geometry.find_smooth();
        geometry
    }

    /// Builds the top hierarchy over all members, and puts the triangles in its leaf order. They are placed twice, for
    /// their boxes and in order: to keep them in between would take more memory than anything else.
    fn build_top(&mut self, triangles: usize, placings: &[Placing]) {
        let (others, count) = (self.others.len(), self.others.len() + triangles);
        let instances = self.spheres.len() + self.disks.len()..others;
        let triangle = |number: usize| {
            let Single { first, instance } = self.single(number as u32);
            placings[instance as usize].triangle(number as u32 - first)
        };
        let bounds = |index: usize| match self.others.get(index) {
            Some(&item) => self.item_box(item),
            None => triangle(index - others).bounds(),
        };
        let (typical_extent, bvh) = (self.median_extent(count, bounds), Bvh::build(count, instances, bounds));
        if triangles > 0 {
            self.triangles =
                in_slots(&bvh, |index| index.checked_sub(others).map_or(Triangle::NOWHERE, triangle));
        }
        (self.typical_extent, self.bvh) = (typical_extent, bvh);
        if self.is_small::<Line>() {
            let slots = self.bvh.filled().filter(|&(_, index)| index as usize >= others);
            self.facets = Facets::new(slots.map(|(slot, _)| (slot, self.triangle(slot))));
        }
    }

    fn item_box(&self, item: Item) -> (DVec3, DVec3) {
        match item {
            Item::Sphere(i) => {
                let sphere = &self.spheres[i as usize].0;
                (sphere.center - sphere.radius, sphere.center + sphere.radius)
            }
            Item::Disk(i) => {
                let disk = &self.disks[i as usize].0;
                let half =
                    disk.outer * (DVec3::ONE - disk.normal * disk.normal).max(DVec3::ZERO).map(f64::sqrt);
                (disk.center - half, disk.center + half)
            }
            // Only others are asked for.
            Item::Triangle(_) => Default::default(),
            Item::Instance(i) => {
                let placed = &self.placed[i as usize];
                let bvh = self.shared[placed.mesh as usize].as_ref().and_then(|shared| shared.bvh.bounds());
                let (min, max) = bvh.unwrap_or_default();
                transform_box(&placed.to_object.inverse(), min, max)
            }
        }
    }

    /// Median box diagonal of what a ray can hit, triangles of shared meshes included.
    fn median_extent(&self, count: usize, bounds: impl Fn(usize) -> (DVec3, DVec3)) -> f64 {
        const SAMPLES: usize = 10_000;
        let extent = |index: usize| match self.others.get(index) {
            Some(&Item::Instance(i)) => self.placed_extent(&self.placed[i as usize]),
            _ => {
                let (min, max) = bounds(index);
                min.distance(max)
            }
        };
        let stride = count.div_ceil(SAMPLES).max(1);
        let mut extents: Vec<f64> = (0..count).step_by(stride).map(extent).collect();
        if extents.is_empty() {
            return 0.0;
        }
        let middle = extents.len() / 2;
        *extents.select_nth_unstable_by(middle, f64::total_cmp).1
    }

    /// A triangle from the middle of a placed mesh, for all of them: asked of every instance, so no walk of the mesh.
    fn placed_extent(&self, placed: &Placed) -> f64 {
        let Some(shared) = &self.shared[placed.mesh as usize] else { return 0.0 };
        let leaves = shared.bvh.order().len() / LEAF_SIZE;
        if leaves == 0 {
            return 0.0;
        }
        let (min, max) = shared.triangles.get(leaves / 2 * LEAF_SIZE).bounds();
        min.distance(max) / placed.shrink
    }
}

impl SharedMesh {
    fn build(mesh: &Mesh) -> Self {
        let placing = Placing::new(mesh, DAffine3::IDENTITY);
        let bvh = Bvh::build(mesh.triangles.len(), 0..0, |i| placing.triangle(i as u32).bounds());
        let triangles = in_slots(&bvh, |index| placing.triangle(index as u32));
        Self { bvh, triangles }
    }
}

/// Triangles by leaf slot of a hierarchy.
fn in_slots(bvh: &Bvh, triangle: impl Fn(usize) -> Triangle + Sync) -> Columns<Triangle> {
    let order = bvh.order();
    Columns::fill(order.len() / LEAF_SIZE, |slot| match order[slot] {
        EMPTY => Triangle::NOWHERE,
        index => triangle(index as usize),
    })
}

impl Placed {
    fn new(instance: &Instance, to_local: &DAffine3, surface: Surface) -> Self {
        let to_object = to_local.inverse();
        let columns = to_object.matrix3.to_cols_array_2d().map(|c| DVec3::from(c).length_squared());
        Self {
            mesh: instance.mesh,
            to_object,
            normal_to_world: to_object.matrix3.transpose(),
            // Frobenius norm: an upper bound of the stretch.
            shrink: columns.iter().sum::<f64>().sqrt(),
            is_mirrored: to_object.matrix3.determinant() < 0.0,
            surface,
        }
    }
}

/// A mesh under a map.
struct Placing<'a> {
    mesh: &'a Mesh,
    map: DAffine3,
    /// Triangles are rewound if the map mirrors, so that their fronts stay in front.
    mirrored: bool,
}

impl<'a> Placing<'a> {
    fn new(mesh: &'a Mesh, map: DAffine3) -> Self {
        Self { mesh, map, mirrored: map.matrix3.determinant() < 0.0 }
    }

    fn triangle(&self, index: u32) -> Triangle {
        let [a, b, c] = self.mesh.triangles[index as usize];
        let corners = if self.mirrored { [a, c, b] } else { [a, b, c] };
        let [a, b, c] = corners.map(|index| {
            let [x, y, z] = self.mesh.positions[index as usize].map(f64::from);
            self.map.transform_point3(DVec3::new(x, y, z)).as_vec3()
        });
        Triangle { a, b, c }
    }
}

fn transform_box(map: &DAffine3, min: DVec3, max: DVec3) -> (DVec3, DVec3) {
    let corner = |i: usize| {
        let pick = |bit: usize, low: f64, high: f64| if i >> bit & 1 == 0 { low } else { high };
        map.transform_point3(DVec3::new(pick(0, min.x, max.x), pick(1, min.y, max.y), pick(2, min.z, max.z)))
    };
    (0..8).map(corner).fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(lo, hi), p| (lo.min(p), hi.max(p)))
}

fn count(
    spheres: &[(Sphere, Surface)],
    disks: &[(Disk, Surface)],
    meshes: &[Mesh],
    instances: &[(Instance, Surface)],
) -> Counts {
    Counts {
        spheres: spheres.len(),
        disks: disks.len(),
        triangles: meshes.iter().map(|m| m.triangles.len()).sum(),
        instanced_triangles: instances.iter().map(|(i, _)| meshes[i.mesh as usize].triangles.len()).sum(),
        meshes: meshes.len(),
        instances: instances.len(),
    }
}

/// Zero, unless the geometry lies far from it compared with its size; then its median place.
fn choose_origin(
    spheres: &[(Sphere, Surface)],
    disks: &[(Disk, Surface)],
    meshes: &[Mesh],
    instances: &[(Instance, Surface)],
) -> DVec3 {
    let mut places: Vec<DVec3> = spheres.iter().map(|(s, _)| s.center).collect();
    places.extend(disks.iter().map(|(d, _)| d.center));
    for (instance, _) in instances {
        let positions = &meshes[instance.mesh as usize].positions;
        for position in positions.iter().step_by(positions.len().div_ceil(64).max(1)) {
            places.push(instance.to_world.transform_point3(DVec3::from(position.map(f64::from))));
        }
    }
    if places.is_empty() {
        return DVec3::ZERO;
    }
    let mut quantile = |axis: usize, q: f64| {
        let index = (q * (places.len() - 1) as f64) as usize;
        places.select_nth_unstable_by(index, |a, b| a[axis].total_cmp(&b[axis])).1[axis]
    };
    let middle = DVec3::from([0, 1, 2].map(|axis| quantile(axis, 0.5)));
    let spread = DVec3::from([0, 1, 2].map(|axis| quantile(axis, 0.9) - quantile(axis, 0.1)));
    if middle.length() > 16.0 * spread.max_element() && places.len() > 1 {
        middle.round()
    } else {
        DVec3::ZERO
    }
}
