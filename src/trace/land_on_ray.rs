//! Landings on the ray itself: from where a move's segment meets a surface to where the ray arrives there.
//!
//! A transport whose segments only come near its rays repeats the step in part, until Newton's method has found the
//! part that ends on the surface.

use glam::DVec3;

use super::transport::{Landing, Transport};
use crate::geometry::{
    Found, Geometry, Line, Need, PrimitiveId, Query, Search, Segment, Skim, SupportingSurface,
};
use crate::math::columns::{Columns, LANES, Row, columns};
use crate::math::kernel::{Kernel, map};

/// A transport that can repeat a step in part, in coordinates of its own.
pub trait Retrace: Transport {
    /// A step, of which parts are wanted.
    type Span: Row;

    /// Step that a ray took, and a point (world) that it leads to.
    fn span(&self, flight: &Self::Flight, step: &Self::Move, point: DVec3) -> Self::Span;

    /// Guess which part of a step leads to `point` (world), in [0, 1].
    fn part_near(&self, flight: &Self::Flight, step: &Self::Move, point: DVec3) -> f64;

    /// Pose after a part of a step.
    fn pose(&self, span: &Self::Span, part: &PartialStep) -> Pose;

    /// Poses after parts of blocks of steps.
    fn pose_all(
        &self,
        spans: &[<Self::Span as Row>::Block],
        parts: &[<PartialStep as Row>::Block],
        poses: &mut [<Pose as Row>::Block],
    );

    /// Pose beside the point of a span, given about what part of the step leads there.
    fn pose_beside(&self, span: &Self::Span, part: &PartialStep) -> Pose {
        self.pose(span, part)
    }

    /// Poses beside the points of blocks of spans, given about what parts of the steps lead there.
    fn pose_beside_all(
        &self,
        spans: &[<Self::Span as Row>::Block],
        parts: &[<PartialStep as Row>::Block],
        poses: &mut [<Pose as Row>::Block],
    ) {
        self.pose_all(spans, parts, poses);
    }

    /// Largest error of a ray's direction, radians.
    fn tolerance(&self) -> f64;

    /// Largest distance between a move's segment and the ray.
    fn segment_tolerance(&self) -> f64;
}

columns! {
    /// The part of a step that leads near a supporting surface.
    pub struct PartialStep => PartialStepBlock {
        /// The part.
        s: f64,
        /// True if it leads so near that no step is needed for the rest.
        is_near: bool,
    }
}

columns! {
    /// A ray after a part of a step.
    pub struct Pose => PoseBlock {
        /// World position.
        position: DVec3,
        /// Unit tangent.
        tangent: DVec3,
        /// Unit vector across it, towards which the ray bends.
        bend: DVec3,
        /// Curvature.
        curvature: f64,
        /// Inverse length over which the spacetime changes: the inverse radius.
        inverse_scale: f64,
        /// Distance over the part of the step.
        speed: f64,
        /// The part.
        s: f64,
    }
}

columns! {
    /// Arrival of a ray at a supporting surface.
    pub struct SurfaceArrival => SurfaceArrivalBlock {
        /// World position.
        position: DVec3,
        /// Unit direction of travel.
        direction: DVec3,
        /// Part of the step.
        s: f64,
    }
}

impl Pose {
    /// Distance along the tangent to the supporting surface.
    #[inline(always)]
    fn ahead(&self, support: &SupportingSurface) -> f64 {
        let (height, normal) = support.height(self.position);
        -height / normal.dot(self.tangent)
    }
}

/// Cosine of the angle between a ray and a surface's normal up to which the segment may cross it the other way.
const GRAZING: f64 = 0.2;
/// Part of a segment over which its direction is told.
const AGO: f64 = 1e-6;
/// Most corrections of a part.
const MOST_CORRECTIONS: u32 = 6;

/// One correction by Newton's method of a part that is not near.
struct Correcting {
    /// Distance, relative to the scale, that a circle bridges as well as is asked for.
    near: f64,
}

impl Correcting {
    fn to(tolerance: f64) -> Self {
        // A circle errs as the distance cubed.
        Self { near: libm::cbrt(0.1 * tolerance) }
    }
}

impl Kernel for Correcting {
    type A = SupportingSurface;
    type B = Pose;
    type Out = PartialStep;

    #[inline(always)]
    fn run(&self, support: &SupportingSurface, pose: &Pose) -> PartialStep {
        let ahead = pose.ahead(support);
        let is_near = (ahead * pose.inverse_scale).abs() < self.near;
        let shift = if is_near { 0.0 } else { ahead / pose.speed };
        PartialStep { s: pose.s + shift, is_near }
    }
}

/// The end of the corrections: what is left is made up for along the circle that the ray is nearest to, then along its
/// tangent.
struct Arriving;

impl Kernel for Arriving {
    type A = SupportingSurface;
    type B = Pose;
    type Out = SurfaceArrival;

    #[inline(always)]
    fn run(&self, support: &SupportingSurface, pose: &Pose) -> SurfaceArrival {
        let (tangent, ahead) = (pose.tangent, pose.ahead(support));
        let turned = (ahead * pose.curvature) * pose.bend;
        let position = pose.position + ahead * (tangent + 0.5 * turned);
        let (height, normal) = support.height(position);
        let direction = tangent + turned;
        let direction = direction / direction.length();
        let position = position - (height / normal.dot(direction)) * direction;
        SurfaceArrival { position, direction, s: pose.s + ahead / pose.speed }
    }
}

/// Landings to be moved onto their rays. Its memory is used again from round to round.
pub struct RayLandings<S: Row> {
    /// Lanes and what they meet.
    pub hits: Vec<(usize, Found)>,
    spans: Columns<S>,
    supports: Columns<SupportingSurface>,
    parts: Columns<PartialStep>,
    poses: Columns<Pose>,
    arrivals: Columns<SurfaceArrival>,
    between: Search<Skim>,
}

impl<S: Row> Default for RayLandings<S> {
    fn default() -> Self {
        Self {
            hits: Vec::new(),
            spans: Columns::default(),
            supports: Columns::default(),
            parts: Columns::default(),
            poses: Columns::default(),
            arrivals: Columns::default(),
            between: Search::default(),
        }
    }
}

/// A step, the supporting surface that it meets, and the part of it where the segment says that is.
#[inline(always)]
fn approach<T: Retrace>(
    transport: &T,
    geometry: &Geometry,
    (flight, step): (&T::Flight, &T::Move),
    found: Found,
) -> (T::Span, SupportingSurface, PartialStep) {
    let s = transport.part_near(flight, step, found.point);
    (
        transport.span(flight, step, found.point),
        geometry.support(found.primitive),
        PartialStep { s, is_near: false },
    )
}

/// Moves a crossing from the segment to the ray, where that stays on the primitive and beside nothing else.
pub fn land_on_ray<T: Retrace>(
    transport: &T,
    geometry: &Geometry,
    ray: (&T::Flight, &T::Move),
    found: Found,
) -> Landing {
    let (span, support, part) = approach(transport, geometry, ray, found);
    let mut pose = transport.pose_beside(&span, &part);
    let correcting = Correcting::to(transport.tolerance());
    for _ in 0..MOST_CORRECTIONS {
        let part = correcting.run(&support, &pose);
        if part.is_near {
            break;
        }
        pose = transport.pose(&span, &part);
    }
    let arrival = Arriving.run(&support, &pose);
    let between = || first_between(geometry, found, &arrival);
    land(transport, geometry, (found, support), &arrival, || (*ray.0, *ray.1), between)
}

/// [`land_on_ray`] for many, lane beside lane; `each` is told where the ray of a lane lands.
pub fn land_all_on_rays<T: Retrace>(
    transport: &T,
    geometry: &Geometry,
    (flights, moves): (&Columns<T::Flight>, &Columns<T::Move>),
    landings: &mut RayLandings<T::Span>,
    mut each: impl FnMut(usize, Landing),
) {
    let RayLandings { hits, spans, supports, parts, poses, arrivals, between } = landings;
    let lanes = hits.len();
    spans.resize(lanes);
    supports.resize(lanes);
    parts.resize(lanes);
    poses.resize(lanes);
    arrivals.resize(lanes);
    for (i, &(lane, found)) in hits.iter().enumerate() {
        let ray = (&flights.get(lane), &moves.get(lane));
        let (span, support, part) = approach(transport, geometry, ray, found);
        spans.set(i, span);
        supports.set(i, support);
        parts.set(i, part);
    }
    transport.pose_beside_all(spans.blocks(lanes), parts.blocks(lanes), poses.blocks_mut(lanes));
    let correcting = Correcting::to(transport.tolerance());
    for block in 0..lanes.div_ceil(LANES) {
        let of = block..block + 1;
        for _ in 0..MOST_CORRECTIONS {
            let (part, pose) =
                (&mut parts.blocks_mut(lanes)[of.clone()], &mut poses.blocks_mut(lanes)[of.clone()]);
            map(&correcting, &supports.blocks(lanes)[of.clone()], pose, part);
            if (LANES * block..lanes.min(LANES * (block + 1))).all(|i| PartialStep::get(&part[0], i).is_near)
            {
                break;
            }
            transport.pose_all(&spans.blocks(lanes)[of.clone()], part, pose);
        }
    }
    map(&Arriving, supports.blocks(lanes), poses.blocks(lanes), arrivals.blocks_mut(lanes));
    between.queries.gather(lanes, |i| {
        let Found { point, primitive } = hits[i].1;
        let segment = Skim(Line { p0: point, p2: arrivals.get(i).position });
        Query { segment, origin_prim: primitive, need: Need::Whole }
    });
    geometry.search_all(between, lanes);
    for (i, &(lane, found)) in hits.iter().enumerate() {
        let arrival = arrivals.get(i);
        let ray = || (flights.get(lane), moves.get(lane));
        let met = || between.found.get(i).map(|found| found.primitive);
        each(lane, land(transport, geometry, (found, supports.get(i)), &arrival, ray, met));
    }
}

/// First primitive between where the segment meets a primitive and where the ray does.
fn first_between(geometry: &Geometry, found: Found, arrival: &SurfaceArrival) -> Option<PrimitiveId> {
    let way = Skim(Line { p0: found.point, p2: arrival.position });
    geometry.intersect(&way, found.primitive).map(|hit| hit.primitive)
}

/// Landing of a ray: at its arrival, if that is on the primitive and nothing is in `between`. Seldom asks for the `ray`
/// itself.
fn land<T: Retrace>(
    transport: &T,
    geometry: &Geometry,
    (found, support): (Found, SupportingSurface),
    arrival: &SurfaceArrival,
    ray: impl Fn() -> (T::Flight, T::Move),
    between: impl FnOnce() -> Option<PrimitiveId>,
) -> Landing {
    let Found { point, primitive } = found;
    let SurfaceArrival { position, direction, s } = *arrival;
    let moved = position.distance(point);
    if (0.0..=1.0).contains(&s) && moved <= 8.0 * transport.segment_tolerance() {
        // Both ends lie on the primitive's supporting surface: what shares that cannot stand between them.
        let shares_support = |other: PrimitiveId| {
            let (_, normal) = geometry.support(other).height(point);
            support.height(point).1.cross(normal).length_squared() < 1e-18
        };
        if geometry.covers(primitive, position) && between().is_none_or(shares_support) {
            let (_, normal) = support.height(position);
            let is_steep = normal.dot(direction).abs() > GRAZING;
            if is_steep || against(transport, &ray(), (point, normal), direction).is_none() {
                return Landing::conformal(position, direction, primitive);
            }
            return stay(transport, geometry, &ray(), found);
        }
        // The curve passes beside the primitive, across an edge that it shares: its tangent tells what it meets.
        let reach = 2.0 * moved * direction;
        let (flight, step) = ray();
        let course = transport.course(&flight, &step);
        if course.is_some_and(|course| moved < 0.1 * position.distance(course.chord().start)) {
            let tangent = Line { p0: position - reach, p2: position + reach };
            if let Some(hit) = geometry.intersect(&tangent, primitive.none_beside()) {
                return Landing::conformal(tangent.point(hit.s), direction, hit.primitive);
            }
        }
    }
    stay(transport, geometry, &ray(), found)
}

/// Landing of a ray where its segment meets the primitive.
fn stay<T: Retrace>(transport: &T, geometry: &Geometry, ray: &(T::Flight, T::Move), found: Found) -> Landing {
    let Found { point, primitive } = found;
    let (span, support, part) = approach(transport, geometry, (&ray.0, &ray.1), found);
    let direction = transport.pose_beside(&span, &part).tangent.normalize();
    let (_, normal) = support.height(point);
    let direction = against(transport, ray, (point, normal), direction).unwrap_or(direction);
    Landing::conformal(point, direction, primitive)
}

/// Direction of a ray's segment where it meets a surface, given a point there and the normal, if it crosses that to the
/// other side than the ray's `direction`: a ray that grazes a surface may go away from it where its segment arrives, and
/// would come from behind.
fn against<T: Retrace>(
    transport: &T,
    (flight, step): &(T::Flight, T::Move),
    (point, normal): (DVec3, DVec3),
    direction: DVec3,
) -> Option<DVec3> {
    let course = transport.course(flight, step)?;
    let before = (course.parameter_beside(point) - AGO).max(0.0);
    let way = course.point(before + AGO) - course.point(before);
    if way.dot(normal) * direction.dot(normal) < 0.0 { way.try_normalize() } else { None }
}
