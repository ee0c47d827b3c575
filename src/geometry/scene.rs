//! All primitives of a scene behind one search.
//!
//! Spheres, disks and the triangles of meshes that appear once share the top hierarchy; a mesh that appears more often
//! has a hierarchy of its own, entered through instances. Coordinates are kept relative to an origin near the
//! geometry, so that f32 corners and boxes keep their digits wherever the scene is placed.

use glam::{DAffine3, DMat3, DVec3};
use rayon::prelude::*;

use super::bvh::Bvh;
use super::distance::Reach;
use super::{Disk, Mesh, Segment, Sphere, Surface, Triangle};
use crate::math::columns::{columns, plain_field};
use crate::math::kernel::widest;

/// Names a primitive; for triangles of an instance both numbers matter.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct PrimitiveId {
    pub(super) item: u32,
    pub(super) triangle: u32,
}

impl PrimitiveId {
    /// No primitive.
    pub const NONE: PrimitiveId = PrimitiveId { item: u32::MAX, triangle: u32::MAX };
}

plain_field!(PrimitiveId);

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

columns! {
    /// What a primitive is a part of: a sphere, or a plane, whose radius is 0.
    pub struct Carrier => CarrierBlock {
        /// Centre of the sphere, or a point of the plane.
        anchor: DVec3,
        /// Unit normal of the plane.
        normal: DVec3,
        /// Radius of the sphere.
        radius: f64,
    }
}

impl Carrier {
    fn plane(anchor: DVec3, normal: DVec3) -> Self {
        Self { anchor, normal, radius: 0.0 }
    }

    /// Distance from the carrier at `point`, signed, and its gradient.
    #[inline(always)]
    pub fn height(&self, point: DVec3) -> (f64, DVec3) {
        let from = point - self.anchor;
        let distance = from.length();
        let is_sphere = self.radius > 0.0;
        let pick = |sphere: f64, plane: f64| if is_sphere { sphere } else { plane };
        let (round, flat) = (from / distance, self.normal);
        let normal = DVec3::new(pick(round.x, flat.x), pick(round.y, flat.y), pick(round.z, flat.z));
        (pick(distance - self.radius, flat.dot(from)), normal)
    }
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
pub(super) enum Item {
    Sphere(u32),
    Disk(u32),
    /// Index into `triangles` and `sources`.
    Triangle(u32),
    Instance(u32),
}

/// Where a triangle of the top hierarchy comes from.
#[derive(Clone, Copy, Debug)]
pub(super) struct Source {
    pub(super) instance: u32,
    pub(super) triangle: u32,
}

/// A mesh with its own hierarchy, triangles in leaf order. Empty if the mesh's triangles are in the top hierarchy.
pub(super) struct SharedMesh {
    pub(super) bvh: Bvh,
    pub(super) triangles: Vec<Triangle>,
    pub(super) order: Vec<u32>,
}

/// A placed mesh.
pub(super) struct Placed {
    pub(super) mesh: u32,
    pub(super) to_object: DAffine3,
    /// Object normal → world normal: inverse transpose.
    pub(super) normal_to_world: DMat3,
    /// Largest stretch of an object-space distance under `to_object`.
    pub(super) shrink: f64,
    pub(super) surface: Surface,
}

/// Primitives with their BVH.
pub struct Geometry {
    pub(super) origin: DVec3,
    pub(super) bvh: Bvh,
    pub(super) items: Vec<Item>,
    pub(super) spheres: Vec<(Sphere, Surface)>,
    pub(super) disks: Vec<(Disk, Surface)>,
    pub(super) triangles: Vec<Triangle>,
    pub(super) sources: Vec<Source>,
    pub(super) meshes: Vec<Mesh>,
    pub(super) shared: Vec<Option<SharedMesh>>,
    pub(super) placed: Vec<Placed>,
    pub(super) counts: Counts,
    pub(super) typical_extent: f64,
}

impl Geometry {
    /// The first primitive that `segment` meets; `leaves` is the one it starts on.
    ///
    /// Where two primitives are met at the very same parameter the one that was given first wins, whatever the order of
    /// the hierarchy.
    #[inline]
    pub fn intersect<S: Segment>(&self, segment: &S, leaves: PrimitiveId) -> Option<Hit> {
        widest(Search { geometry: self, segment, leaves })
    }

    #[inline(always)]
    fn search<S: Segment>(&self, segment: &S, leaves: PrimitiveId) -> Option<Hit> {
        let segment = &segment.shifted(-self.origin);
        let chord = segment.chord();
        let direction = (chord.end - chord.start).normalize_or_zero();
        let mut nearest: Option<Hit> = None;
        let only_triangles = self.triangles.len() == self.items.len();
        self.bvh.walk(&chord, |slot| {
            let item = slot as u32;
            let own = |triangle: u32| leaves == PrimitiveId { item, triangle };
            let kind = if only_triangles { Item::Triangle(item) } else { self.items[slot] };
            let found = match kind {
                Item::Triangle(i) => (segment.cross_triangle(&self.triangles[i as usize], own(0)), 0),
                Item::Sphere(i) => (segment.cross_sphere(&self.spheres[i as usize].0, own(0)), 0),
                Item::Disk(i) => (segment.cross_disk(&self.disks[i as usize].0, own(0)), 0),
                Item::Instance(i) => {
                    let left = (leaves.item == item).then_some(leaves.triangle);
                    self.intersect_instance(&self.placed[i as usize], segment, left)
                }
            };
            let (s, triangle) = found;
            if s == f64::INFINITY {
                return s;
            }
            let hit = Hit { s, primitive: PrimitiveId { item, triangle } };
            if nearest.is_none_or(|best| self.is_before(&hit, &best)) {
                nearest = Some(hit);
            }
            (segment.point(s) - chord.start).dot(direction)
        });
        nearest
    }

    /// The first triangle of a placed mesh that `segment` (world, relative to the origin) meets, by parameter (infinite if
    /// there is none) and slot.
    fn intersect_instance<S: Segment>(
        &self,
        placed: &Placed,
        segment: &S,
        leaves: Option<u32>,
    ) -> (f64, u32) {
        let Some(shared) = &self.shared[placed.mesh as usize] else { return (f64::INFINITY, 0) };
        let segment = segment.transformed(&placed.to_object);
        let chord = segment.chord();
        let direction = (chord.end - chord.start).normalize_or_zero();
        let mut nearest = (f64::INFINITY, 0);
        shared.bvh.walk(&chord, |slot| {
            let own = leaves == Some(slot as u32);
            let s = segment.cross_triangle(&shared.triangles[slot], own);
            if s == f64::INFINITY {
                return s;
            }
            let original = |slot: u32| shared.order[slot as usize];
            let (best, at) = nearest;
            if s < best || (s == best && original(slot as u32) < original(at)) {
                nearest = (s, slot as u32);
            }
            (segment.point(s) - chord.start).dot(direction)
        });
        nearest
    }

    /// Every primitive tested against `segment`, without a BVH: the oracle for [`Self::intersect`].
    pub fn intersect_brute_force<S: Segment>(&self, segment: &S, leaves: PrimitiveId) -> Option<Hit> {
        let segment = &segment.shifted(-self.origin);
        let mut nearest: Option<Hit> = None;
        let mut consider = |s: f64, primitive: PrimitiveId| {
            if s == f64::INFINITY {
                return;
            }
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

    /// The carrier of a primitive, in the world.
    pub fn carrier(&self, primitive: PrimitiveId) -> Carrier {
        match self.items[primitive.item as usize] {
            Item::Sphere(i) => {
                let Sphere { center, radius } = self.spheres[i as usize].0;
                Carrier { anchor: center + self.origin, normal: DVec3::ZERO, radius }
            }
            Item::Disk(i) => {
                let Disk { center, normal, .. } = self.disks[i as usize].0;
                Carrier::plane(center + self.origin, normal)
            }
            Item::Triangle(i) => {
                let triangle = &self.triangles[i as usize];
                Carrier::plane(triangle.corner(0) + self.origin, triangle.normal().normalize_or_zero())
            }
            Item::Instance(i) => {
                let placed = &self.placed[i as usize];
                let Some(shared) = &self.shared[placed.mesh as usize] else { return Carrier::default() };
                let triangle = &shared.triangles[primitive.triangle as usize];
                let anchor = placed.to_object.inverse().transform_point3(triangle.corner(0));
                let normal = (placed.normal_to_world * triangle.normal()).normalize_or_zero();
                Carrier::plane(anchor + self.origin, normal)
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
                // Flattened triangles of mirrored placements were rewound, see `Placing`.
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

/// A search, for the widest vectors that the machine has.
struct Search<'a, S> {
    geometry: &'a Geometry,
    segment: &'a S,
    leaves: PrimitiveId,
}

impl<S: Segment> pulp::NullaryFnOnce for Search<'_, S> {
    type Output = Option<Hit>;

    #[inline(always)]
    fn call(self) -> Option<Hit> {
        self.geometry.search(self.segment, self.leaves)
    }
}

impl SurfacePoint {
    fn flat(normal: DVec3, surface: Surface) -> Self {
        Self { normal, shading_normal: normal, surface }
    }
}
