//! Curved rays: orbits stepped under error control, searched as arcs.

use glam::DVec3;

use super::columns::{Field, Row, columns};
use super::march::{March, keeps_outside};
use super::transport::{Found, Landing, Outcome, Transport};
use crate::geodesic::{Arc, Control, End, Launch, Phase, PlaneArc, Step};
use crate::geometry::{Geometry, PrimitiveId};
use crate::math::real::Real;
use crate::spacetime::{Chart, ConformallyFlat, Fate};

/// A number that columns can hold.
pub trait Lane: Real + Field<Block: Send> {}
impl<R: Real + Field<Block: Send>> Lane for R {}

/// Rays of a static, spherically symmetric spacetime, followed in numbers of type `R`.
///
/// Orbits are in `R`; places are in f64, and moved by displacements that are good to the rounding of `R` relative to
/// the step: nothing jitters far from the origin.
pub struct Curved<M, R> {
    /// The spacetime.
    pub medium: M,
    /// The method of integration in it.
    pub march: Box<dyn March<R>>,
    /// World position of its centre.
    pub center: DVec3,
    /// Where rays may stop.
    pub chart: Chart,
    /// What steps are held to.
    pub control: Control<R>,
    /// Largest distance between an arc and the curve.
    pub arc_tolerance: f64,
    /// Arcs with a larger sagitta are searched in halves: a thick chord meets too many boxes.
    pub longest_sagitta: f64,
    /// Longer arcs are searched in halves: beside them, the geometry would drown in their rounding.
    pub longest_chord: f64,
    /// World bounds of the geometry; arcs outside are not searched.
    pub bounds: (DVec3, DVec3),
}

columns! {
    /// A curved ray.
    pub struct CurvedFlight<R> => CurvedFlightBlock {
        /// Position, relative to the spacetime's centre.
        position: DVec3,
        /// Unit vector from the centre to the position.
        radial: DVec3,
        /// Unit vector across it in the orbit's plane, in the sense of motion.
        along: DVec3,
        /// Impact parameter.
        b: R,
        /// Inverse radius.
        w: R,
        /// dw/dψ.
        v: R,
        /// ½ dn²/dw.
        pull: R,
        /// Length in ξ to try next.
        h: R,
        /// Relative error of the step before.
        error: R,
        /// How the ray ends if nothing is in its way.
        fate: Fate,
        /// What the position lies on, until the first step is taken.
        leaves: PrimitiveId,
        /// Steps so far, rejected ones included.
        steps: u32,
    }
}

columns! {
    /// One step of a curved ray; places from its start, along the radius there and across it.
    pub struct CurvedMove<R> => CurvedMoveBlock {
        /// Inverse radius at the end.
        w: R,
        /// dw/dψ at the end.
        v: R,
        /// ½ dn²/dw at the end.
        pull: R,
        /// End, outwards.
        end_x: R,
        /// End, across.
        end_y: R,
        /// Middle control point of the arc, outwards.
        middle_x: R,
        /// Middle control point of the arc, across.
        middle_y: R,
        /// Its weight.
        weight: R,
        /// Length in ξ to try next.
        next_h: R,
        /// Relative error.
        error: R,
        /// Whether the step is good enough to be taken.
        accepted: bool,
    }
}

/// Most steps of one ray: two orders of magnitude above what rays with several windings take.
const MAX_STEPS: u32 = 10_000;
/// Most times that an arc is halved because of its sagitta.
const MOST_FOR_SAGITTA: u32 = 8;
/// Most times that an arc is halved because of its length.
const MOST_FOR_LENGTH: u32 = 60;
/// How far outside the geometry a step may end, as a part of the inverse radius that bounds it.
const OUTSIDE: f64 = 0.5;
/// Where a step from far outside ends, as a part of the same: so far out that the pull does not take it in.
const EDGE: f64 = 0.7;

impl<R: Lane> CurvedFlight<R> {
    /// Where the ray is on its orbit.
    #[inline(always)]
    pub fn phase(&self) -> Phase<R> {
        Phase { w: self.w, v: self.v, pull: self.pull }
    }

    /// A vector in the orbit's plane, from components along the radius and across it.
    #[inline(always)]
    pub(super) fn place(&self, outwards: R, across: R) -> DVec3 {
        outwards.value() * self.radial + across.value() * self.along
    }
}

impl<M: ConformallyFlat, R: Lane> Curved<M, R> {
    /// The part `s` of a step.
    pub(super) fn piece(&self, flight: &CurvedFlight<R>, s: f64) -> Step<R> {
        self.march.step(flight.b, flight.phase(), R::of(s) * flight.h)
    }

    /// The step's arc, in world coordinates.
    #[inline(always)]
    fn arc(&self, flight: &CurvedFlight<R>, step: &CurvedMove<R>) -> Arc {
        let plane = PlaneArc {
            middle: [step.middle_x, step.middle_y],
            end: [step.end_x, step.end_y],
            weight: step.weight,
            error: R::of(0.0),
        };
        plane.placed(flight.position + self.center, flight.radial, flight.along)
    }

    fn may_meet(&self, arc: &Arc) -> bool {
        let (min, max) = self.bounds;
        let (low, high) = (arc.p0.min(arc.p1).min(arc.p2), arc.p0.max(arc.p1).max(arc.p2));
        low.cmple(max).all() && high.cmpge(min).all()
    }

    /// Searches an arc, in halves if it is thick or long beside the geometry.
    fn sweep<F>(&self, arc: &Arc, leaves: PrimitiveId, halvings: u32, search: &mut F) -> Option<Found>
    where
        F: FnMut(&Arc, PrimitiveId) -> Option<Found>,
    {
        if !self.may_meet(arc) {
            return None;
        }
        let thick = halvings < MOST_FOR_SAGITTA && arc.sagitta() > self.longest_sagitta;
        let length2 = arc.p0.distance_squared(arc.p2);
        let long = halvings < MOST_FOR_LENGTH && length2 > self.longest_chord * self.longest_chord;
        if thick || long {
            let (left, right) = arc.halves();
            let first = self.sweep(&left, leaves, halvings + 1, search);
            return first.or_else(|| self.sweep(&right, PrimitiveId::NONE, halvings + 1, search));
        }
        search(arc, leaves)
    }

    /// A length of at most `h` for the next step: far outside the geometry, rays go to its edge in one step, and on
    /// their way out they do not go far beyond.
    #[inline(always)]
    fn within(&self, h: R, b: R, phase: &Phase<R>) -> R {
        let h = self.control.within(h, b, phase);
        let outer = R::of(self.chart.outer);
        let (outside, edge) = (R::of(OUTSIDE), R::of(EDGE) * outer);
        let (w, v) = (phase.w, phase.v);
        if v < R::of(0.0) {
            let end = if w > outer { outside * outer } else { outside * w };
            h.at_most((end - w) / v)
        } else if w < outside * edge {
            h.at_most((edge - w) / v)
        } else {
            h
        }
    }

    /// The direction at infinity of a ray that meets nothing more.
    fn direction_at_infinity(&self, flight: &CurvedFlight<R>, phase: Phase<R>) -> Outcome<CurvedFlight<R>> {
        match self.march.to_infinity(flight.b, phase, flight.fate) {
            End::Crosses(_, swept) => {
                let (sin, cos) = swept.value().sin_cos();
                Outcome::Escaped((cos * flight.radial + sin * flight.along).normalize())
            }
            End::StepLimit => Outcome::StepLimit,
            End::Falls | End::Misses | End::NonFinite => Outcome::NonFinite,
        }
    }
}

impl<M: ConformallyFlat, R: Lane> Transport for Curved<M, R> {
    type Flight = CurvedFlight<R>;
    type Move = CurvedMove<R>;
    type Segment = Arc;

    fn launch(&self, position: DVec3, direction: DVec3, leaves: PrimitiveId) -> CurvedFlight<R> {
        let position = position - self.center;
        let Launch { radial, along, b, w, v, fate } =
            Launch::new(&self.medium, position, direction, R::EPSILON);
        let (b, phase) = (R::of(b), Phase::new(&self.medium, R::of(w), R::of(v)));
        let h = self.march.first_step(b, &phase);
        CurvedFlight {
            position,
            radial,
            along,
            b,
            w: phase.w,
            v: phase.v,
            pull: phase.pull,
            h: self.within(h, b, &phase),
            error: R::of(1.0),
            fate,
            leaves,
            steps: 0,
        }
    }

    fn advance(&self, flight: &CurvedFlight<R>) -> CurvedMove<R> {
        self.march.advance(flight)
    }

    fn advance_blocks(
        &self,
        flights: &[<Self::Flight as Row>::Block],
        moves: &mut [<Self::Move as Row>::Block],
    ) {
        self.march.advance_blocks(flights, moves);
    }

    #[inline(always)]
    fn search(
        &self,
        flight: &Self::Flight,
        step: &Self::Move,
        mut search: impl FnMut(&Arc, PrimitiveId) -> Option<Found>,
    ) -> Option<Found> {
        let end = Phase { w: step.w, v: step.v, pull: step.pull };
        if !step.accepted || keeps_outside(R::of(self.chart.outer), &flight.phase(), &end) {
            return None;
        }
        self.sweep(&self.arc(flight, step), flight.leaves, 0, &mut search)
    }

    #[inline(always)]
    fn settle(
        &self,
        geometry: Option<&Geometry>,
        flight: &Self::Flight,
        step: &Self::Move,
        found: Option<Found>,
    ) -> Outcome<CurvedFlight<R>> {
        if let Some(found) = found {
            return Outcome::Landed(match geometry {
                Some(geometry) => self.polish(geometry, flight, step, found),
                None => {
                    let Found { point: position, primitive } = found;
                    let arc = self.arc(flight, step);
                    let direction = arc.velocity(arc.parameter_beside(position)).normalize();
                    Landing { position, direction, primitive }
                }
            });
        }
        let steps = flight.steps + 1;
        if steps > MAX_STEPS {
            return Outcome::StepLimit;
        }
        if !step.accepted {
            // The next step must be finite and not vanish; a state lost for good is reported.
            let shorter = CurvedFlight { h: step.next_h, steps, ..*flight };
            let moves = step.next_h.value() > f64::from(f32::MIN_POSITIVE);
            return if moves { Outcome::Flying(shorter) } else { Outcome::NonFinite };
        }
        // In f64, so that the vectors stay orthonormal.
        let tangent = (flight.b * flight.h).value();
        let cos = 1.0 / (1.0 + tangent * tangent).sqrt();
        let sin = tangent * cos;
        let phase = Phase { w: step.w, v: step.v, pull: step.pull };
        let next = CurvedFlight {
            position: flight.position + flight.place(step.end_x, step.end_y),
            radial: cos * flight.radial + sin * flight.along,
            along: cos * flight.along - sin * flight.radial,
            w: phase.w,
            v: phase.v,
            pull: phase.pull,
            h: self.within(step.next_h, flight.b, &phase),
            error: step.error,
            leaves: PrimitiveId::NONE,
            steps,
            ..*flight
        };
        if self.chart.is_left(flight.fate, phase.w.value(), phase.v.value()) {
            return match flight.fate {
                Fate::Escapes => self.direction_at_infinity(&next, phase),
                Fate::Falls => Outcome::Captured,
            };
        }
        Outcome::Flying(next)
    }

    fn course(&self, flight: &Self::Flight, step: &Self::Move) -> Option<Arc> {
        step.accepted.then(|| self.arc(flight, step))
    }

    fn length(&self, flight: &Self::Flight, step: &Self::Move, point: Option<DVec3>) -> f64 {
        if !step.accepted {
            return 0.0;
        }
        let arc = self.arc(flight, step);
        arc.length(point.map_or(1.0, |point| arc.parameter_beside(point)))
    }
}
