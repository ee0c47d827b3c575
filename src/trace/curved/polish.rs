//! From a crossing of the arc to where the ray itself arrives.

use std::marker::PhantomData;

use glam::DVec3;

use super::{Curved, CurvedFlight, CurvedMove, Lane};
use crate::geodesic::{Phase, Step, Stepper};
use crate::geometry::{Carrier, Found, Geometry, Line, Need, PrimitiveId, Query, Search, Segment};
use crate::math::columns::{Columns, LANES, Row, columns};
use crate::math::kernel::{Kernel, map};
use crate::spacetime::ConformallyFlat;
use crate::trace::transport::Landing;

columns! {
    /// A step, of which parts are wanted.
    pub struct Span<R> => SpanBlock {
        /// Impact parameter.
        b: R,
        /// Inverse radius at the start.
        w: R,
        /// dw/dψ at the start.
        v: R,
        /// ½ dn²/dw at the start.
        pull: R,
        /// Length of the whole step in ξ.
        h: R,
    }
}

columns! {
    /// The part of a step that leads near a carrier.
    pub struct Aim => AimBlock {
        /// The part.
        s: f64,
        /// Whether it leads so near that no step is needed for the rest.
        is_near: bool,
    }
}

columns! {
    /// Where a part of a step leads; places from its start, along the radius there and across it.
    pub struct Pose<R> => PoseBlock {
        /// Outwards.
        x: R,
        /// Across.
        y: R,
        /// Unit tangent, outwards.
        tangent_x: R,
        /// Unit tangent, across.
        tangent_y: R,
        /// Inverse radius.
        w: R,
        /// Distance over the part of the step.
        speed: R,
        /// Curvature, towards the centre.
        curvature: R,
        /// The part.
        s: f64,
    }
}

columns! {
    /// A ray that is followed to a carrier, by Newton's method over the part of its step.
    pub struct Chase => ChaseBlock {
        /// World position of the start.
        position: DVec3,
        /// Unit vector from the centre to the start.
        radial: DVec3,
        /// Unit vector across it in the orbit's plane.
        along: DVec3,
        /// Centre, or a point of the plane.
        anchor: DVec3,
        /// Unit normal of the plane.
        normal: DVec3,
        /// Radius; 0 for a plane.
        radius: f64,
    }
}

columns! {
    /// Where a chase ends.
    pub struct Caught => CaughtBlock {
        /// World position.
        position: DVec3,
        /// Unit direction of travel.
        direction: DVec3,
        /// Part of the step.
        s: f64,
    }
}

impl<R: Lane> Span<R> {
    /// The part of the step that `aim` says.
    #[inline(always)]
    pub fn pose<M: ConformallyFlat>(&self, medium: &M, stepper: &impl Stepper, aim: &Aim) -> Pose<R> {
        let start = Phase { w: self.w, v: self.v, pull: self.pull };
        let step = Step::new(medium, stepper, self.b, start, R::of(aim.s) * self.h);
        let ([x, y], [momentum_x, momentum_y]) = (step.displacement(), step.end_momentum());
        let (w, n) = (step.end.w, step.end.index(self.b));
        let per_n = R::of(1.0) / n;
        let (tangent_x, tangent_y) = (momentum_x * per_n, momentum_y * per_n);
        // |dx/dξ| = n c²/w².
        let speed = self.h * n * step.cos * step.cos / (w * w);
        let w_per_n = w * per_n;
        let curvature = step.end.pull * self.b * (w_per_n * w_per_n * w_per_n);
        Pose { x, y, tangent_x, tangent_y, w, speed, curvature, s: aim.s }
    }
}

impl Chase {
    #[inline(always)]
    fn place<R: Lane>(&self, x: R, y: R) -> DVec3 {
        x.value() * self.radial + y.value() * self.along
    }

    #[inline(always)]
    fn carrier(&self) -> Carrier {
        let Self { anchor, normal, radius, .. } = *self;
        Carrier { anchor, normal, radius }
    }

    /// Position and unit direction of a pose, and how far along the ray the carrier is from there.
    #[inline(always)]
    fn at<R: Lane>(&self, pose: &Pose<R>) -> (DVec3, DVec3, f64) {
        let position = self.position + self.place(pose.x, pose.y);
        let direction = self.place(pose.tangent_x, pose.tangent_y);
        let (height, normal) = self.carrier().height(position);
        (position, direction, -height / normal.dot(direction))
    }
}

/// Most corrections of a chase.
const MOST_CORRECTIONS: u32 = 6;

/// One correction of a chase that is not near.
struct Correcting<R> {
    /// Distance, relative to the radius, that a circle bridges as well as is asked for.
    near: f64,
    number: PhantomData<R>,
}

impl<R: Lane> Kernel for Correcting<R> {
    type A = Chase;
    type B = Pose<R>;
    type Out = Aim;

    #[inline(always)]
    fn run(&self, chase: &Chase, pose: &Pose<R>) -> Aim {
        let (_, _, ahead) = chase.at(pose);
        let is_near = (ahead * pose.w.value()).abs() < self.near;
        let shift = if is_near { 0.0 } else { ahead / pose.speed.value() };
        Aim { s: pose.s + shift, is_near }
    }
}

/// The end of a chase: what is left is made up for along the circle that the ray is nearest to, then along its tangent.
struct Catching<R>(PhantomData<R>);

impl<R: Lane> Kernel for Catching<R> {
    type A = Chase;
    type B = Pose<R>;
    type Out = Caught;

    #[inline(always)]
    fn run(&self, chase: &Chase, pose: &Pose<R>) -> Caught {
        let (position, tangent, ahead) = chase.at(pose);
        let turned = (ahead * pose.curvature.value()) * chase.place(-pose.tangent_y, pose.tangent_x);
        let position = position + ahead * (tangent + 0.5 * turned);
        let (height, normal) = chase.carrier().height(position);
        let direction = tangent + turned;
        let direction = direction / direction.length();
        let position = position - (height / normal.dot(direction)) * direction;
        Caught { position, direction, s: pose.s + ahead / pose.speed.value() }
    }
}

/// Landings to be moved onto their rays. Its memory is used again from round to round.
#[derive(Default)]
pub struct Polishing<R: Lane> {
    /// Lanes and what they meet.
    pub hits: Vec<(usize, Found)>,
    spans: Columns<Span<R>>,
    chases: Columns<Chase>,
    aims: Columns<Aim>,
    poses: Columns<Pose<R>>,
    caught: Columns<Caught>,
    between: Search<Line>,
}

impl<M: ConformallyFlat, R: Lane> Curved<M, R> {
    /// Guesses which part of a step leads to `point`, relative to the centre.
    #[inline(always)]
    fn part(&self, flight: &CurvedFlight<R>, step: &CurvedMove<R>, point: DVec3) -> f64 {
        let tangent = (flight.b * flight.h).value();
        let s = if tangent > 1e-3 {
            point.dot(flight.along) / (point.dot(flight.radial) * tangent)
        } else {
            let (way, whole) = (point - flight.position, flight.place(step.end_x, step.end_y));
            let (x, end_x) = (way.dot(flight.radial), step.end_x.value());
            if end_x.abs() > 0.1 * whole.length() {
                // Nearly along the radius w is linear in ξ.
                x / end_x / ((step.w / flight.w).value() * (1.0 + x * flight.w.value()))
            } else {
                way.dot(whole) / whole.length_squared()
            }
        };
        if s.is_finite() { s.clamp(0.0, 1.0) } else { 1.0 }
    }

    fn correcting(&self) -> Correcting<R> {
        // A circle errs as the distance cubed.
        Correcting { near: libm::cbrt(0.1 * self.tolerance), number: PhantomData }
    }

    /// A chase of the carrier that a flight meets, and where the arc says that is.
    #[inline(always)]
    fn chase(
        &self,
        geometry: &Geometry,
        flight: &CurvedFlight<R>,
        step: &CurvedMove<R>,
        found: Found,
    ) -> (Span<R>, Chase, Aim) {
        let &CurvedFlight { radial, along, b, w, v, pull, h, .. } = flight;
        let Carrier { anchor, normal, radius } = geometry.carrier(found.primitive);
        let position = flight.position + self.center;
        let s = self.part(flight, step, found.point - self.center);
        let chase = Chase { position, radial, along, anchor, normal, radius };
        (Span { b, w, v, pull, h }, chase, Aim { s, is_near: false })
    }

    /// Moves a crossing from the arc to the curve, where that stays on the primitive and beside nothing else.
    pub(super) fn polish(
        &self,
        geometry: &Geometry,
        flight: &CurvedFlight<R>,
        step: &CurvedMove<R>,
        found: Found,
    ) -> Landing {
        let (span, chase, aim) = self.chase(geometry, flight, step, found);
        let mut pose = self.march.pose(&span, &aim);
        for _ in 0..MOST_CORRECTIONS {
            let aim = self.correcting().run(&chase, &pose);
            if aim.is_near {
                break;
            }
            pose = self.march.pose(&span, &aim);
        }
        let caught = Catching(PhantomData).run(&chase, &pose);
        let between = || self.first_between(geometry, found, &caught);
        self.land(geometry, found, &caught, || (*flight, *step), between)
    }

    /// The same for many, lane beside lane; `each` is told where the ray of a lane lands.
    pub(super) fn polish_all(
        &self,
        geometry: &Geometry,
        flights: &Columns<CurvedFlight<R>>,
        moves: &Columns<CurvedMove<R>>,
        polishing: &mut Polishing<R>,
        mut each: impl FnMut(usize, Landing),
    ) {
        let Polishing { hits, spans, chases, aims, poses, caught, between } = polishing;
        let lanes = hits.len();
        spans.resize(lanes);
        chases.resize(lanes);
        aims.resize(lanes);
        poses.resize(lanes);
        caught.resize(lanes);
        for (i, &(lane, found)) in hits.iter().enumerate() {
            let (span, chase, aim) = self.chase(geometry, &flights.get(lane), &moves.get(lane), found);
            spans.set(i, span);
            chases.set(i, chase);
            aims.set(i, aim);
        }
        self.march.pose_all(spans.blocks(lanes), aims.blocks(lanes), poses.blocks_mut(lanes));
        for block in 0..lanes.div_ceil(LANES) {
            let of = block..block + 1;
            for _ in 0..MOST_CORRECTIONS {
                let (aim, pose) =
                    (&mut aims.blocks_mut(lanes)[of.clone()], &mut poses.blocks_mut(lanes)[of.clone()]);
                map(&self.correcting(), &chases.blocks(lanes)[of.clone()], pose, aim);
                if (LANES * block..lanes.min(LANES * (block + 1))).all(|i| Aim::get(&aim[0], i).is_near) {
                    break;
                }
                self.march.pose_all(&spans.blocks(lanes)[of.clone()], aim, pose);
            }
        }
        map(&Catching(PhantomData), chases.blocks(lanes), poses.blocks(lanes), caught.blocks_mut(lanes));
        between.queries.gather(lanes, |i| {
            let Found { point, primitive } = hits[i].1;
            let segment = Line { p0: point, p2: caught.get(i).position };
            Query { segment, leaves: primitive, need: Need::Whole }
        });
        geometry.search_all(between, lanes);
        for (i, &(lane, found)) in hits.iter().enumerate() {
            let caught = caught.get(i);
            let ray = || (flights.get(lane), moves.get(lane));
            let met = || between.found[i].map(|found| found.primitive);
            each(lane, self.land(geometry, found, &caught, ray, met));
        }
    }

    /// What stands between where the arc meets a primitive and where the ray does.
    fn first_between(&self, geometry: &Geometry, found: Found, caught: &Caught) -> Option<PrimitiveId> {
        let way = Line { p0: found.point, p2: caught.position };
        geometry.intersect(&way, found.primitive).map(|hit| hit.primitive)
    }

    /// Where a ray lands: where it was caught, if that is on the primitive and nothing is in `between`. Seldom asks for the
    /// `ray` itself.
    fn land(
        &self,
        geometry: &Geometry,
        found: Found,
        caught: &Caught,
        ray: impl Fn() -> (CurvedFlight<R>, CurvedMove<R>),
        between: impl FnOnce() -> Option<PrimitiveId>,
    ) -> Landing {
        let Found { point, primitive } = found;
        let Caught { position, direction, s } = *caught;
        let moved = position.distance(point);
        if (0.0..=1.0).contains(&s) && moved <= 8.0 * self.arc_tolerance {
            // Both ends lie on the primitive's carrier: what shares that cannot stand between them.
            let shares_carrier = |other: PrimitiveId| {
                let normal = |primitive| geometry.carrier(primitive).height(point).1;
                normal(primitive).cross(normal(other)).length_squared() < 1e-18
            };
            if geometry.covers(primitive, position) && between().is_none_or(shares_carrier) {
                return Landing { position, direction, primitive };
            }
            // The curve passes beside the primitive, across an edge that it shares: its tangent tells what it meets.
            let reach = 2.0 * moved * direction;
            if moved < 0.1 * position.distance(ray().0.position + self.center) {
                let tangent = Line { p0: position - reach, p2: position + reach };
                if let Some(hit) = geometry.intersect(&tangent, PrimitiveId::NONE) {
                    return Landing { position: tangent.point(hit.s), direction, primitive: hit.primitive };
                }
            }
        }
        let (flight, step) = ray();
        let (span, chase, aim) = self.chase(geometry, &flight, &step, found);
        let (_, direction, _) = chase.at(&self.march.pose(&span, &aim));
        Landing { position: point, direction: direction.normalize(), primitive }
    }
}
