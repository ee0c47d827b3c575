//! All primitives of a scene behind one search.
//!
//! Spheres, disks and the triangles of meshes that appear once share the top hierarchy; a mesh that appears more often
//! has a hierarchy of its own, entered through instances. Coordinates are kept relative to an origin near the
//! geometry, so that f32 corners and boxes keep their digits wherever the scene is placed.

use glam::{DAffine3, DMat3, DVec3};
use rayon::prelude::*;

use super::bvh::Bvh;
use super::distance::Reach;
use super::{Disk, Instance, Mesh, Primitives, Segment, Sphere, Surface, Triangle};

/// Names a primitive; for triangles of an instance both numbers matter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PrimitiveId {
    item: u32,
    triangle: u32,
}

impl PrimitiveId {
    /// No primitive.
    pub const NONE: PrimitiveId = PrimitiveId { item: u32::MAX, triangle: u32::MAX };
}

impl Default for PrimitiveId {
    fn default() -> Self {
        Self::NONE
    }
}

/// Where a segment meets a primitive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Segment parameter.
    pub s: f64,
    /// What is met.
    pub primitive: PrimitiveId,
}

/// The surface at a hit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfacePoint {
    /// Unit geometric normal, towards the front.
    pub normal: DVec3,
    /// Unit shading normal: interpolated where the mesh has vertex normals.
    pub shading_normal: DVec3,
    /// Material and entity.
    pub surface: Surface,
}

/// How much there is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Spheres.
    pub spheres: usize,
    /// Annuli.
    pub disks: usize,
    /// Triangles stored.
    pub triangles: usize,
    /// Triangles seen, instances counted each time.
    pub instanced_triangles: usize,
    /// Meshes.
    pub meshes: usize,
    /// Placed meshes.
    pub instances: usize,
}

/// A member of the top hierarchy.
#[derive(Clone, Copy, Debug)]
enum Item {
    Sphere(u32),
    Disk(u32),
    /// Index into `triangles` and `sources`.
    Triangle(u32),
    Instance(u32),
}

/// Where a triangle of the top hierarchy comes from.
#[derive(Clone, Copy, Debug)]
struct Source {
    instance: u32,
    triangle: u32,
}

/// A mesh with its own hierarchy, triangles in leaf order. Empty if the mesh's triangles are in the top hierarchy.
struct SharedMesh {
    bvh: Bvh,
    triangles: Vec<Triangle>,
    order: Vec<u32>,
}

/// A placed mesh.
struct Placed {
    mesh: u32,
    to_object: DAffine3,
    /// Object normal → world normal: inverse transpose.
    normal_to_world: DMat3,
    /// Largest stretch of an object-space distance under `to_object`.
    shrink: f64,
    surface: Surface,
}

/// Primitives with their BVH.
pub struct Geometry {
    origin: DVec3,
    bvh: Bvh,
    items: Vec<Item>,
    spheres: Vec<(Sphere, Surface)>,
    disks: Vec<(Disk, Surface)>,
    triangles: Vec<Triangle>,
    sources: Vec<Source>,
    meshes: Vec<Mesh>,
    shared: Vec<Option<SharedMesh>>,
    placed: Vec<Placed>,
    counts: Counts,
    typical_extent: f64,
}

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
        let mut items: Vec<Item> = (0..spheres.len() as u32).map(Item::Sphere).collect();
        items.extend((0..disks.len() as u32).map(Item::Disk));
        let (mut triangles, mut sources) = (Vec::new(), Vec::new());
        for (index, (instance, _)) in instances.iter().enumerate() {
            let index = index as u32;
            if uses[instance.mesh as usize] > 1 {
                items.push(Item::Instance(index));
                continue;
            }
            let mesh = &meshes[instance.mesh as usize];
            let placed = place_triangles(mesh, &to_local(instance));
            sources.extend((0..placed.len() as u32).map(|triangle| Source { instance: index, triangle }));
            triangles.extend(placed);
        }
        items.extend((0..triangles.len() as u32).map(Item::Triangle));
        meshes.iter_mut().for_each(Mesh::drop_what_shading_does_not_need);
        let placed: Vec<Placed> =
            instances.iter().map(|(i, surface)| Placed::new(i, &to_local(i), *surface)).collect();

        let mut geometry = Self {
            origin,
            bvh: Bvh::build(std::iter::empty()),
            items,
            spheres,
            disks,
            triangles,
            sources,
            meshes,
            shared,
            placed,
            counts,
            typical_extent: 0.0,
        };
        geometry.build_top();
        geometry
    }

    /// Builds the top hierarchy and puts items and triangles in its leaf order.
    fn build_top(&mut self) {
        let boxes: Vec<(DVec3, DVec3)> = self.items.par_iter().map(|&item| self.item_box(item)).collect();
        self.typical_extent = self.median_extent(&boxes);
        self.bvh = Bvh::build(boxes.into_iter());
        let (old_items, old_triangles, old_sources) = (
            std::mem::take(&mut self.items),
            std::mem::take(&mut self.triangles),
            std::mem::take(&mut self.sources),
        );
        self.triangles.reserve_exact(old_triangles.len());
        self.sources.reserve_exact(old_triangles.len());
        self.items = Vec::with_capacity(old_items.len());
        for &index in self.bvh.order() {
            let item = match old_items[index as usize] {
                Item::Triangle(triangle) => {
                    self.triangles.push(old_triangles[triangle as usize]);
                    self.sources.push(old_sources[triangle as usize]);
                    Item::Triangle(self.triangles.len() as u32 - 1)
                }
                other => other,
            };
            self.items.push(item);
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
            Item::Triangle(i) => self.triangles[i as usize].bounds(),
            Item::Instance(i) => {
                let placed = &self.placed[i as usize];
                let bvh = self.shared[placed.mesh as usize].as_ref().and_then(|shared| shared.bvh.bounds());
                let (min, max) = bvh.unwrap_or_default();
                transform_box(&placed.to_object.inverse(), min, max)
            }
        }
    }

    /// Median box diagonal of what a ray can hit, triangles of shared meshes included.
    fn median_extent(&self, boxes: &[(DVec3, DVec3)]) -> f64 {
        const SAMPLES: usize = 10_000;
        let mut extents: Vec<f64> = Vec::new();
        let stride = boxes.len().div_ceil(SAMPLES).max(1);
        for (&item, (min, max)) in self.items.iter().zip(boxes).step_by(stride) {
            extents.push(match item {
                Item::Instance(i) => self.placed_extent(&self.placed[i as usize]),
                _ => min.distance(*max),
            });
        }
        if extents.is_empty() {
            return 0.0;
        }
        let middle = extents.len() / 2;
        *extents.select_nth_unstable_by(middle, f64::total_cmp).1
    }

    /// Median triangle of a placed mesh.
    fn placed_extent(&self, placed: &Placed) -> f64 {
        let Some(shared) = &self.shared[placed.mesh as usize] else { return 0.0 };
        let triangle = &shared.triangles[shared.triangles.len() / 2];
        let (min, max) = triangle.bounds();
        min.distance(max) / placed.shrink
    }

    /// The first primitive that `segment` meets; `leaves` is the one it starts on.
    ///
    /// Where two primitives are met at the very same parameter the one that was given first wins, whatever the order of
    /// the hierarchy.
    #[inline]
    pub fn intersect<S: Segment>(&self, segment: &S, leaves: PrimitiveId) -> Option<Hit> {
        let segment = &segment.transformed(&DAffine3::from_translation(-self.origin));
        let chord = segment.chord();
        let direction = (chord.end - chord.start).normalize_or_zero();
        let mut nearest: Option<Hit> = None;
        self.bvh.walk(&chord, |slot| {
            let item = slot as u32;
            let own = |triangle: u32| leaves == PrimitiveId { item, triangle };
            let found = match self.items[slot] {
                Item::Triangle(i) => {
                    segment.cross_triangle(&self.triangles[i as usize], own(0)).map(|s| (s, 0))
                }
                Item::Sphere(i) => segment.cross_sphere(&self.spheres[i as usize].0, own(0)).map(|s| (s, 0)),
                Item::Disk(i) => segment.cross_disk(&self.disks[i as usize].0, own(0)).map(|s| (s, 0)),
                Item::Instance(i) => {
                    let left = (leaves.item == item).then_some(leaves.triangle);
                    self.intersect_instance(&self.placed[i as usize], segment, left)
                }
            };
            let Some((s, triangle)) = found else { return f64::INFINITY };
            let hit = Hit { s, primitive: PrimitiveId { item, triangle } };
            if nearest.is_none_or(|best| self.is_before(&hit, &best)) {
                nearest = Some(hit);
            }
            (segment.point(s) - chord.start).dot(direction)
        });
        nearest
    }

    /// The first triangle of a placed mesh that `segment` (world, relative to the origin) meets, by parameter and slot.
    fn intersect_instance<S: Segment>(
        &self,
        placed: &Placed,
        segment: &S,
        leaves: Option<u32>,
    ) -> Option<(f64, u32)> {
        let shared = self.shared[placed.mesh as usize].as_ref()?;
        let segment = segment.transformed(&placed.to_object);
        let chord = segment.chord();
        let direction = (chord.end - chord.start).normalize_or_zero();
        let mut nearest: Option<(f64, u32)> = None;
        shared.bvh.walk(&chord, |slot| {
            let own = leaves == Some(slot as u32);
            let Some(s) = segment.cross_triangle(&shared.triangles[slot], own) else { return f64::INFINITY };
            let original = |slot: u32| shared.order[slot as usize];
            let earlier = nearest
                .is_none_or(|(best, at)| s < best || (s == best && original(slot as u32) < original(at)));
            if earlier {
                nearest = Some((s, slot as u32));
            }
            (segment.point(s) - chord.start).dot(direction)
        });
        nearest
    }

    /// Every primitive tested against `segment`, without a BVH: the oracle for [`Self::intersect`].
    pub fn intersect_brute_force<S: Segment>(&self, segment: &S, leaves: PrimitiveId) -> Option<Hit> {
        let segment = &segment.transformed(&DAffine3::from_translation(-self.origin));
        let mut nearest: Option<Hit> = None;
        let mut consider = |s: Option<f64>, primitive: PrimitiveId| {
            let Some(s) = s else { return };
            let hit = Hit { s, primitive };
            if nearest.is_none_or(|best| self.is_before(&hit, &best)) {
                nearest = Some(hit);
            }
        };
        for (slot, item) in self.items.iter().enumerate() {
            let id = |triangle: usize| PrimitiveId { item: slot as u32, triangle: triangle as u32 };
            let own = |triangle: usize| leaves == id(triangle);
            match *item {
                Item::Triangle(i) => {
                    consider(segment.cross_triangle(&self.triangles[i as usize], own(0)), id(0))
                }
                Item::Sphere(i) => consider(segment.cross_sphere(&self.spheres[i as usize].0, own(0)), id(0)),
                Item::Disk(i) => consider(segment.cross_disk(&self.disks[i as usize].0, own(0)), id(0)),
                Item::Instance(i) => {
                    let placed = &self.placed[i as usize];
                    let Some(shared) = &self.shared[placed.mesh as usize] else { continue };
                    let inner = segment.transformed(&placed.to_object);
                    for (slot, triangle) in shared.triangles.iter().enumerate() {
                        consider(inner.cross_triangle(triangle, own(slot)), id(slot));
                    }
                }
            }
        }
        nearest
    }

    fn is_before(&self, a: &Hit, b: &Hit) -> bool {
        let given = |hit: &Hit| (self.bvh.order()[hit.primitive.item as usize], hit.primitive.triangle);
        a.s < b.s || (a.s == b.s && given(a) < given(b))
    }

    /// Signed distance-like function of a primitive's carrier (sphere or plane) at a world point, and its gradient:
    /// what a hit is polished with.
    pub fn carrier(&self, primitive: PrimitiveId, point: DVec3) -> (f64, DVec3) {
        let point = point - self.origin;
        match self.items[primitive.item as usize] {
            Item::Sphere(i) => {
                let from = point - self.spheres[i as usize].0.center;
                let distance = from.length();
                (distance - self.spheres[i as usize].0.radius, from / distance)
            }
            Item::Disk(i) => {
                let disk = &self.disks[i as usize].0;
                (disk.normal.dot(point - disk.center), disk.normal)
            }
            Item::Triangle(i) => {
                let triangle = &self.triangles[i as usize];
                let normal = triangle.normal().normalize_or_zero();
                (normal.dot(point - triangle.corner(0)), normal)
            }
            Item::Instance(i) => {
                let placed = &self.placed[i as usize];
                let Some(shared) = &self.shared[placed.mesh as usize] else { return (0.0, DVec3::ZERO) };
                let triangle = &shared.triangles[primitive.triangle as usize];
                let gradient = placed.normal_to_world * triangle.normal();
                let scale = gradient.length();
                let height =
                    triangle.normal().dot(placed.to_object.transform_point3(point) - triangle.corner(0));
                (height / scale, gradient / scale)
            }
        }
    }

    /// Whether a world point of a primitive's carrier lies on the primitive itself.
    pub fn covers(&self, primitive: PrimitiveId, point: DVec3) -> bool {
        let point = point - self.origin;
        match self.items[primitive.item as usize] {
            Item::Sphere(_) => true,
            Item::Disk(i) => self.disks[i as usize].0.holds(point),
            Item::Triangle(i) => self.triangles[i as usize].holds(point),
            Item::Instance(i) => {
                let placed = &self.placed[i as usize];
                let point = placed.to_object.transform_point3(point);
                let shared = self.shared[placed.mesh as usize].as_ref();
                shared.is_some_and(|shared| shared.triangles[primitive.triangle as usize].holds(point))
            }
        }
    }

    /// The surface of `primitive` at the world point `point`.
    pub fn surface_point(&self, primitive: PrimitiveId, point: DVec3) -> SurfacePoint {
        let point = point - self.origin;
        match self.items[primitive.item as usize] {
            Item::Sphere(i) => {
                let (sphere, surface) = &self.spheres[i as usize];
                SurfacePoint::flat((point - sphere.center).normalize(), *surface)
            }
            Item::Disk(i) => {
                let (disk, surface) = &self.disks[i as usize];
                SurfacePoint::flat(disk.normal, *surface)
            }
            Item::Triangle(i) => {
                let Source { instance, triangle } = self.sources[i as usize];
                let corners = &self.triangles[i as usize];
                let placed = &self.placed[instance as usize];
                // Flattened triangles of mirrored placements were rewound, see `place_triangles`.
                let rewound = placed.to_object.matrix3.determinant() < 0.0;
                let (u, v) = corners.barycentrics(point);
                let weights = if rewound { [1.0 - u - v, v, u] } else { [1.0 - u - v, u, v] };
                self.triangle_point(placed, triangle, weights, corners.normal().normalize())
            }
            Item::Instance(i) => {
                let placed = &self.placed[i as usize];
                let Some(shared) = &self.shared[placed.mesh as usize] else {
                    return SurfacePoint::flat(DVec3::Z, placed.surface);
                };
                let corners = &shared.triangles[primitive.triangle as usize];
                let (u, v) = corners.barycentrics(placed.to_object.transform_point3(point));
                let normal = (placed.normal_to_world * corners.normal()).normalize();
                let triangle = shared.order[primitive.triangle as usize];
                self.triangle_point(placed, triangle, [1.0 - u - v, u, v], normal)
            }
        }
    }

    fn triangle_point(
        &self,
        placed: &Placed,
        triangle: u32,
        weights: [f64; 3],
        normal: DVec3,
    ) -> SurfacePoint {
        let mesh = &self.meshes[placed.mesh as usize];
        let shading_normal = mesh
            .interpolated_normal(triangle, weights)
            .and_then(|n| (placed.normal_to_world * n).try_normalize())
            .unwrap_or(normal);
        SurfacePoint { normal, shading_normal, surface: placed.surface }
    }

    /// What `primitive` belongs to.
    pub fn surface(&self, primitive: PrimitiveId) -> Surface {
        match self.items[primitive.item as usize] {
            Item::Sphere(i) => self.spheres[i as usize].1,
            Item::Disk(i) => self.disks[i as usize].1,
            Item::Triangle(i) => self.placed[self.sources[i as usize].instance as usize].surface,
            Item::Instance(i) => self.placed[i as usize].surface,
        }
    }

    /// Smallest and largest distance of any primitive from the world point `from`; `None` without primitives.
    pub fn radii(&self, from: DVec3) -> Option<(f64, f64)> {
        let from = from - self.origin;
        let reach = self
            .items
            .par_iter()
            .map(|&item| match item {
                Item::Sphere(i) => Reach::sphere(from, &self.spheres[i as usize].0),
                Item::Disk(i) => Reach::disk(from, &self.disks[i as usize].0),
                Item::Triangle(i) => {
                    let triangle = &self.triangles[i as usize];
                    Reach::triangle(from, [0, 1, 2].map(|k| triangle.corner(k)))
                }
                Item::Instance(i) => self.placed_reach(&self.placed[i as usize], from),
            })
            .reduce(|| Reach::NOTHING, Reach::union);
        (!self.items.is_empty()).then_some((reach.nearest, reach.farthest))
    }

    fn placed_reach(&self, placed: &Placed, from: DVec3) -> Reach {
        let Some(shared) = &self.shared[placed.mesh as usize] else { return Reach::NOTHING };
        let to_local = placed.to_object.inverse();
        let corners = |t: &Triangle| [0, 1, 2].map(|k| to_local.transform_point3(t.corner(k)));
        shared.triangles.iter().map(|t| Reach::triangle(from, corners(t))).fold(Reach::NOTHING, Reach::union)
    }

    /// World bounds of everything; `None` without primitives.
    pub fn bounds(&self) -> Option<(DVec3, DVec3)> {
        self.bvh.bounds().map(|(min, max)| (min + self.origin, max + self.origin))
    }

    /// Median size of what a ray can hit, scene units.
    pub fn typical_extent(&self) -> f64 {
        self.typical_extent
    }

    /// How much there is.
    pub fn counts(&self) -> Counts {
        self.counts
    }

    /// Heap memory of primitives and hierarchies, bytes.
    pub fn memory_bytes(&self) -> usize {
        let shared = |s: &SharedMesh| s.bvh.memory_bytes() + s.triangles.len() * (size_of::<Triangle>() + 4);
        self.bvh.memory_bytes()
            + self.items.len() * size_of::<Item>()
            + self.triangles.len() * (size_of::<Triangle>() + size_of::<Source>())
            + self.meshes.iter().map(Mesh::memory_bytes).sum::<usize>()
            + self.shared.iter().flatten().map(shared).sum::<usize>()
    }
}

impl SurfacePoint {
    fn flat(normal: DVec3, surface: Surface) -> Self {
        Self { normal, shading_normal: normal, surface }
    }
}

impl SharedMesh {
    fn build(mesh: &Mesh) -> Self {
        let triangles = place_triangles(mesh, &DAffine3::IDENTITY);
        let bvh = Bvh::build(triangles.iter().map(Triangle::bounds));
        let order = bvh.order().to_vec();
        let triangles = order.iter().map(|&i| triangles[i as usize]).collect();
        Self { bvh, triangles, order }
    }
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
            surface,
        }
    }
}

/// The triangles of a mesh under `map`, rewound if the map mirrors, so that their fronts stay in front.
fn place_triangles(mesh: &Mesh, map: &DAffine3) -> Vec<Triangle> {
    let place = |index: u32| {
        let [x, y, z] = mesh.positions[index as usize].map(f64::from);
        map.transform_point3(DVec3::new(x, y, z)).as_vec3().to_array()
    };
    let mirrored = map.matrix3.determinant() < 0.0;
    let wind = |[a, b, c]: [u32; 3]| if mirrored { [a, c, b] } else { [a, b, c] };
    mesh.triangles.par_iter().map(|&t| Triangle { corners: wind(t).map(place) }).collect()
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
