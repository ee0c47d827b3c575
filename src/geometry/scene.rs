//! All primitives of a scene behind one search.
//!
//! Spheres, disks and the triangles of meshes that appear once share the top hierarchy; a mesh that appears more often
//! has a hierarchy of its own, entered through instances. Coordinates are kept relative to an origin near the
//! geometry, so that f32 corners and boxes keep their digits wherever the scene is placed.

use glam::{DAffine3, DMat3, DVec3};
use rayon::prelude::*;

use super::bvh::{Bvh, EMPTY};
use super::distance::Reach;
use super::facets::Facets;
use super::vertex_normals::{Interpolating, SmoothHit, SurfaceNormals};
use super::{Disk, Mesh, Segment, Sphere, Surface, Triangle};
use crate::math::columns::{Columns, columns, plain_field};
use crate::math::kernel::Kernel;
use crate::math::prefetch::prefetch;
use crate::spacetime::Side;

/// Names a primitive and the side that it is on; for triangles of an instance both numbers matter.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct PrimitiveId {
    /// Slot in the top hierarchy of its side, and [`FAR`] on the far side.
    pub(super) item: u32,
    pub(super) triangle: u32,
}

/// Bit of a primitive on the far side of a wormhole.
const FAR: u32 = 1 << 31;

impl PrimitiveId {
    /// No primitive, on the near side.
    pub const NONE: PrimitiveId = PrimitiveId { item: !FAR, triangle: u32::MAX };

    /// No primitive, on a side: the start of a ray in free space.
    pub fn none_on(side: Side) -> Self {
        Self::NONE.on(side)
    }

    /// No primitive, on the side of this one.
    #[inline(always)]
    pub fn none_beside(self) -> Self {
        Self { item: self.item | !FAR, triangle: u32::MAX }
    }

    /// Side that it is on.
    #[inline(always)]
    pub fn side(self) -> Side {
        if self.item & FAR == 0 { Side::Near } else { Side::Far }
    }

    /// The primitive of the same slot on a side.
    #[inline(always)]
    pub(super) fn on(self, side: Side) -> Self {
        let bit = match side {
            Side::Near => 0,
            Side::Far => FAR,
        };
        Self { item: (self.item & !FAR) | bit, triangle: self.triangle }
    }
}

plain_field!(PrimitiveId);

impl Default for PrimitiveId {
    fn default() -> Self {
        Self::NONE
    }
}

/// Hit of a segment on a primitive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Segment parameter.
    pub s: f64,
    /// Primitive that is hit.
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
    /// Surface that a primitive is a part of: a sphere, or a plane, whose radius is 0.
    pub struct SupportingSurface => CarrierBlock {
        /// Centre of the sphere, or a point of the plane.
        anchor: DVec3,
        /// Unit normal of the plane.
        normal: DVec3,
        /// Radius of the sphere.
        radius: f64,
    }
}

impl SupportingSurface {
    fn plane(anchor: DVec3, normal: DVec3) -> Self {
        Self { anchor, normal, radius: 0.0 }
    }

    /// Distance from the supporting surface at `point`, signed, and its gradient.
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

/// Numbers of primitives, meshes and instances.
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

impl Counts {
    fn plus(&self, other: &Self) -> Self {
        Self {
            spheres: self.spheres + other.spheres,
            disks: self.disks + other.disks,
            triangles: self.triangles + other.triangles,
            instanced_triangles: self.instanced_triangles + other.instanced_triangles,
            meshes: self.meshes + other.meshes,
            instances: self.instances + other.instances,
        }
    }
}

impl Hit {
    /// The hit of a side's geometry by itself, on that side.
    #[inline(always)]
    pub(super) fn on(self, side: Side) -> Self {
        Self { primitive: self.primitive.on(side), ..self }
    }
}

/// A member of the top hierarchy.
#[derive(Clone, Copy, Debug)]
pub(super) enum Item {
    Sphere(u32),
    Disk(u32),
    Instance(u32),
    /// The triangle of that number, counted over all meshes that appear once.
    Triangle(u32),
}

/// A mesh whose triangles are in the top hierarchy.
#[derive(Clone, Copy, Debug)]
pub(super) struct Single {
    /// Number of its first triangle.
    pub(super) first: u32,
    pub(super) instance: u32,
}

/// A mesh with its own hierarchy, triangles by leaf slot. Empty if the mesh's triangles are in the top hierarchy.
pub(super) struct SharedMesh {
    pub(super) bvh: Bvh,
    pub(super) triangles: Columns<Triangle>,
}

/// A placed mesh.
#[derive(Debug)]
pub(super) struct Placed {
    pub(super) mesh: u32,
    pub(super) to_object: DAffine3,
    /// Object normal → world normal: inverse transpose.
    pub(super) normal_to_world: DMat3,
    /// Largest stretch of an object-space distance under `to_object`.
    pub(super) shrink: f64,
    /// True if it turns left into right.
    pub(super) is_mirrored: bool,
    pub(super) surface: Surface,
}

impl Placed {
    /// A hit at a point relative to the origin.
    #[inline(always)]
    pub(super) fn smooth_hit(&self, point: DVec3) -> SmoothHit {
        let DMat3 { x_axis: x, y_axis: y, z_axis: z } = self.normal_to_world;
        SmoothHit { point, x, y, z, is_mirrored: self.is_mirrored }
    }
}

/// Primitives with their BVH.
pub struct Geometry {
    pub(super) origin: DVec3,
    pub(super) bvh: Bvh,
    /// All members of the top hierarchy but triangles, which come after them in its order.
    pub(super) others: Vec<Item>,
    /// By leaf slot of the top hierarchy; empty where there is none.
    pub(super) triangles: Columns<Triangle>,
    /// The triangles again, where the scene is small.
    pub(super) facets: Facets,
    /// Surfaces of disks and of triangles without vertex normals, by slot, where the scene is small; `None` of others.
    pub(super) flat: Vec<Option<SurfacePoint>>,
    /// True if triangles have vertex normals, of meshes that appear once where the scene is not small.
    pub(super) is_smooth: bool,
    /// By number of their triangles.
    pub(super) singles: Vec<Single>,
    pub(super) spheres: Vec<(Sphere, Surface)>,
    pub(super) disks: Vec<(Disk, Surface)>,
    pub(super) meshes: Vec<Mesh>,
    pub(super) shared: Vec<Option<SharedMesh>>,
    pub(super) placed: Vec<Placed>,
    pub(super) counts: Counts,
    pub(super) typical_extent: f64,
    /// Primitives near each sphere, which may coincide with it; empty if that is not known.
    pub(super) near_spheres: Vec<Vec<PrimitiveId>>,
    /// Primitives of the far side of a wormhole; to itself, each side is the near one.
    pub(super) far: Option<Box<Geometry>>,
}

impl Geometry {
    /// Adds the geometry of the far side of a wormhole.
    pub fn with_far(self, far: Geometry) -> Self {
        Self { far: Some(Box::new(far)), ..self }
    }

    /// Geometry of a side by itself; `None` if there is none on the far side.
    #[inline(always)]
    pub fn of(&self, side: Side) -> Option<&Self> {
        match side {
            Side::Near => Some(self),
            Side::Far => self.far.as_deref(),
        }
    }

    /// Geometry that a primitive is of, and the primitive's name in that geometry by itself.
    #[inline(always)]
    pub(super) fn owner(&self, primitive: PrimitiveId) -> (&Self, PrimitiveId) {
        (self.of(primitive.side()).unwrap_or(self), primitive.on(Side::Near))
    }

    /// Item in a slot of the top hierarchy.
    #[inline(always)]
    pub(super) fn item(&self, slot: u32) -> Item {
        let index = self.bvh.order()[slot as usize];
        match self.others.get(index as usize) {
            Some(&item) => item,
            None => Item::Triangle(index - self.others.len() as u32),
        }
    }

    /// All members of the top hierarchy, with their slots.
    pub(super) fn members(&self) -> impl Iterator<Item = (u32, Item)> {
        self.bvh.filled().map(|(slot, _)| (slot, self.item(slot)))
    }

    /// Members of the top hierarchy but triangles, with their slots.
    pub(super) fn others(&self) -> impl Iterator<Item = (u32, Item)> {
        let other = |(slot, index): (u32, u32)| self.others.get(index as usize).map(|&item| (slot, item));
        self.bvh.filled().take(if self.others.is_empty() { 0 } else { usize::MAX }).filter_map(other)
    }

    /// The triangle in a slot of the top hierarchy.
    #[inline(always)]
    pub(super) fn triangle(&self, slot: u32) -> Triangle {
        self.triangles.get(slot as usize)
    }

    /// The mesh that triangle `number` is a part of.
    pub(super) fn single(&self, number: u32) -> Single {
        self.singles[self.singles.partition_point(|single| single.first <= number) - 1]
    }

    /// Every primitive tested against `segment`, without a BVH: the oracle for [`Self::intersect`].
    pub fn intersect_brute_force<S: Segment>(&self, segment: &S, origin_prim: PrimitiveId) -> Option<Hit> {
        let side = origin_prim.side();
        let hit = self.of(side)?.brute_force(segment, origin_prim.on(Side::Near))?;
        Some(hit.on(side))
    }

    fn brute_force<S: Segment>(&self, segment: &S, origin_prim: PrimitiveId) -> Option<Hit> {
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
        for (slot, item) in self.members() {
            let id = |triangle: u32| PrimitiveId { item: slot, triangle };
            let own = |triangle: u32| origin_prim == id(triangle);
            match item {
                Item::Triangle(_) => consider(segment.cross_triangle(&self.triangle(slot), own(0)), id(0)),
                Item::Sphere(i) => consider(segment.cross_sphere(&self.spheres[i as usize].0, own(0)), id(0)),
                Item::Disk(i) => consider(segment.cross_disk(&self.disks[i as usize].0, own(0)), id(0)),
                Item::Instance(i) => {
                    let placed = &self.placed[i as usize];
                    let Some(shared) = &self.shared[placed.mesh as usize] else { continue };
                    let inner = segment.transformed(&placed.to_object);
                    for (slot, triangle) in shared.triangles() {
                        consider(inner.cross_triangle(&triangle, own(slot)), id(slot));
                    }
                }
            }
        }
        nearest
    }

    pub(super) fn is_before(&self, a: &Hit, b: &Hit) -> bool {
        a.s < b.s || (a.s == b.s && self.given(a.primitive) < self.given(b.primitive))
    }

    /// Sort key of primitives: the order in which they were given.
    #[inline(always)]
    pub(super) fn given(&self, primitive: PrimitiveId) -> (u32, u32) {
        (self.bvh.order()[primitive.item as usize], primitive.triangle)
    }

    /// The supporting surface of a primitive, in the world.
    pub fn support(&self, primitive: PrimitiveId) -> SupportingSurface {
        let (owner, primitive) = self.owner(primitive);
        owner.own_support(primitive)
    }

    fn own_support(&self, primitive: PrimitiveId) -> SupportingSurface {
        match self.item(primitive.item) {
            Item::Sphere(i) => {
                let Sphere { center, radius } = self.spheres[i as usize].0;
                SupportingSurface { anchor: center + self.origin, normal: DVec3::ZERO, radius }
            }
            Item::Disk(i) => {
                let Disk { center, normal, .. } = self.disks[i as usize].0;
                SupportingSurface::plane(center + self.origin, normal)
            }
            Item::Triangle(_) => {
                let triangle = self.triangle(primitive.item);
                let [corner, ..] = triangle.corners();
                SupportingSurface::plane(corner + self.origin, triangle.normal().normalize_or_zero())
            }
            Item::Instance(i) => {
                let placed = &self.placed[i as usize];
                let Some(shared) = &self.shared[placed.mesh as usize] else {
                    return SupportingSurface::default();
                };
                let triangle = shared.triangles.get(primitive.triangle as usize);
                let [corner, ..] = triangle.corners();
                let anchor = placed.to_object.inverse().transform_point3(corner);
                let normal = (placed.normal_to_world * triangle.normal()).normalize_or_zero();
                SupportingSurface::plane(anchor + self.origin, normal)
            }
        }
    }

    /// True if a world point of a primitive's supporting surface lies on the primitive itself.
    pub fn covers(&self, primitive: PrimitiveId, point: DVec3) -> bool {
        let (owner, primitive) = self.owner(primitive);
        owner.own_covers(primitive, point - owner.origin)
    }

    /// [`Self::covers`] for a point relative to the origin.
    fn own_covers(&self, primitive: PrimitiveId, point: DVec3) -> bool {
        match self.item(primitive.item) {
            Item::Sphere(_) => true,
            Item::Disk(i) => self.disks[i as usize].0.holds(point),
            Item::Triangle(_) => self.triangle(primitive.item).holds(point),
            Item::Instance(i) => {
                let placed = &self.placed[i as usize];
                let point = placed.to_object.transform_point3(point);
                let shared = self.shared[placed.mesh as usize].as_ref();
                shared.is_some_and(|shared| shared.triangles.get(primitive.triangle as usize).holds(point))
            }
        }
    }

    /// Asks for the memory by which the surface of a primitive is looked up.
    #[inline(always)]
    pub fn prefetch_surface(&self, primitive: PrimitiveId) {
        let (owner, PrimitiveId { item: slot, .. }) = self.owner(primitive);
        if let Some(index) = owner.bvh.order().get(slot as usize) {
            prefetch(index);
        }
    }

    /// The surface of `primitive` at the world point `point`.
    #[inline(always)]
    pub fn surface_point(&self, primitive: PrimitiveId, point: DVec3) -> SurfacePoint {
        let (owner, primitive) = self.owner(primitive);
        owner.own_surface_point(primitive, point - owner.origin)
    }

    /// [`Self::surface_point`] at a point relative to the origin.
    #[inline(always)]
    fn own_surface_point(&self, primitive: PrimitiveId, point: DVec3) -> SurfacePoint {
        match self.flat.get(primitive.item as usize) {
            Some(Some(surface)) => *surface,
            Some(None) | None => {
                // Taken apart, so that what is not looked up stays in registers.
                let SurfacePoint { normal, shading_normal, surface } = self.looked_up(primitive, point);
                SurfacePoint { normal, shading_normal, surface }
            }
        }
    }

    /// Surface that is the same all over the primitive in a slot of the top hierarchy, if it is.
    pub(super) fn flat_surface(&self, slot: u32) -> Option<SurfacePoint> {
        let is_flat = match self.item(slot) {
            Item::Sphere(_) | Item::Instance(_) => false,
            Item::Disk(_) => true,
            Item::Triangle(number) => {
                let placed = &self.placed[self.single(number).instance as usize];
                self.meshes[placed.mesh as usize].normals.is_empty()
            }
        };
        is_flat.then(|| self.looked_up(PrimitiveId { item: slot, triangle: 0 }, DVec3::ZERO))
    }

    #[inline(never)]
    fn looked_up(&self, primitive: PrimitiveId, point: DVec3) -> SurfacePoint {
        match self.item(primitive.item) {
            Item::Sphere(i) => {
                let (sphere, surface) = &self.spheres[i as usize];
                SurfacePoint::flat((point - sphere.center).normalize(), *surface)
            }
            Item::Disk(i) => {
                let (disk, surface) = &self.disks[i as usize];
                SurfacePoint::flat(disk.normal, *surface)
            }
            Item::Triangle(number) => {
                let Single { instance, first } = self.single(number);
                let (triangle, placed) = (self.triangle(primitive.item), &self.placed[instance as usize]);
                match self.meshes[placed.mesh as usize].vertex_normals(number - first) {
                    Some(vertices) => {
                        let hit = placed.smooth_hit(point);
                        let SurfaceNormals { geometric, shading } =
                            Interpolating.run(&(triangle, vertices), &hit);
                        SurfacePoint { normal: geometric, shading_normal: shading, surface: placed.surface }
                    }
                    None => SurfacePoint::flat(triangle.normal().normalize(), placed.surface),
                }
            }
            Item::Instance(i) => {
                let placed = &self.placed[i as usize];
                let Some(shared) = &self.shared[placed.mesh as usize] else {
                    return SurfacePoint::flat(DVec3::Z, placed.surface);
                };
                let corners = shared.triangles.get(primitive.triangle as usize);
                let weights = || {
                    let (u, v) = corners.barycentrics(placed.to_object.transform_point3(point));
                    [1.0 - u - v, u, v]
                };
                let normal = (placed.normal_to_world * corners.normal()).normalize();
                let shading_normal = self.meshes[placed.mesh as usize]
                    .interpolated_normal(shared.bvh.order()[primitive.triangle as usize], weights)
                    .and_then(|n| (placed.normal_to_world * n).try_normalize())
                    .unwrap_or(normal);
                SurfacePoint { normal, shading_normal, surface: placed.surface }
            }
        }
    }

    /// Barycentric coordinates of a point on the triangle in a slot of the top hierarchy, which is of an instance.
    #[inline(always)]
    pub(super) fn single_weights(&self, slot: u32, instance: u32, point: DVec3) -> [f64; 3] {
        let (u, v) = self.triangle(slot).barycentrics(point);
        // Flattened triangles of mirrored placements were rewound, see `Placing`.
        if self.placed[instance as usize].is_mirrored { [1.0 - u - v, v, u] } else { [1.0 - u - v, u, v] }
    }

    /// Material and entity of `primitive`.
    pub fn surface(&self, primitive: PrimitiveId) -> Surface {
        let (owner, primitive) = self.owner(primitive);
        match owner.item(primitive.item) {
            Item::Sphere(i) => owner.spheres[i as usize].1,
            Item::Disk(i) => owner.disks[i as usize].1,
            Item::Triangle(number) => owner.placed[owner.single(number).instance as usize].surface,
            Item::Instance(i) => owner.placed[i as usize].surface,
        }
    }

    /// Smallest and largest distance of any primitive of the near side from the world point `from`; `None` without
    /// primitives.
    pub fn radii(&self, from: DVec3) -> Option<(f64, f64)> {
        let from = from - self.origin;
        let order = self.bvh.order();
        let reach = (0..order.len() as u32)
            .into_par_iter()
            .filter(|&slot| order[slot as usize] != EMPTY)
            .map(|slot| self.reach(slot, from))
            .reduce(|| Reach::NOTHING, Reach::union);
        (!order.is_empty()).then_some((reach.nearest, reach.farthest))
    }

    /// Entity of a primitive that comes nearer than `radius` to the world point `from`, on the near side.
    pub fn entity_within(&self, from: DVec3, radius: f64) -> Option<u32> {
        let from = from - self.origin;
        let is_within = |slot: &u32| self.reach(*slot, from).nearest < radius;
        let slot = self.members().map(|(slot, _)| slot).find(is_within)?;
        Some(self.surface(PrimitiveId { item: slot, triangle: 0 }).entity)
    }

    /// Smallest and largest distance of a member of the top hierarchy from a point relative to the origin.
    pub(super) fn reach(&self, slot: u32, from: DVec3) -> Reach {
        match self.item(slot) {
            Item::Sphere(i) => Reach::sphere(from, &self.spheres[i as usize].0),
            Item::Disk(i) => Reach::disk(from, &self.disks[i as usize].0),
            Item::Triangle(_) => Reach::triangle(from, self.triangle(slot).corners()),
            Item::Instance(i) => self.placed_reach(&self.placed[i as usize], from),
        }
    }

    fn placed_reach(&self, placed: &Placed, from: DVec3) -> Reach {
        let Some(shared) = &self.shared[placed.mesh as usize] else { return Reach::NOTHING };
        let to_local = placed.to_object.inverse();
        let placed = |triangle: Triangle| triangle.corners().map(|corner| to_local.transform_point3(corner));
        let reaches = shared.triangles().map(|(_, triangle)| Reach::triangle(from, placed(triangle)));
        reaches.fold(Reach::NOTHING, Reach::union)
    }

    /// World bounds of everything on the near side; `None` without primitives.
    pub fn bounds(&self) -> Option<(DVec3, DVec3)> {
        self.bvh.bounds().map(|(min, max)| (min + self.origin, max + self.origin))
    }

    /// Median size of what a ray can hit on the near side, scene units.
    pub fn typical_extent(&self) -> f64 {
        self.typical_extent
    }

    /// Numbers of primitives, meshes and instances on both sides.
    pub fn counts(&self) -> Counts {
        self.far.as_ref().map_or(self.counts, |far| self.counts.plus(&far.counts))
    }

    /// Heap memory of primitives and hierarchies, bytes.
    pub fn memory_bytes(&self) -> usize {
        let shared = |s: &SharedMesh| s.bvh.memory_bytes() + s.triangles.memory_bytes();
        self.bvh.memory_bytes()
            + self.others.len() * size_of::<Item>()
            + self.triangles.memory_bytes()
            + self.meshes.iter().map(Mesh::memory_bytes).sum::<usize>()
            + self.shared.iter().flatten().map(shared).sum::<usize>()
            + self.far.as_ref().map_or(0, |far| far.memory_bytes())
    }
}

impl SharedMesh {
    /// Triangles with their slots.
    pub(super) fn triangles(&self) -> impl Iterator<Item = (u32, Triangle)> {
        self.bvh.filled().map(|(slot, _)| (slot, self.triangles.get(slot as usize)))
    }
}

impl SurfacePoint {
    fn flat(normal: DVec3, surface: Surface) -> Self {
        Self { normal, shading_normal: normal, surface }
    }
}
