//! Curved rays: Nyström steps under error control, searched as arcs.

use glam::DVec3;

use super::columns::columns;
use super::transport::{Found, Landing, Outcome, Transport};
use crate::geodesic::{Arc, Control, Dense, Step, Stepper, Verdict};
use crate::geometry::{Geometry, Line, PrimitiveId};
use crate::spacetime::{Chart, ConformallyFlat, Stop};

/// Rays of a static, spherically symmetric spacetime.
pub struct Curved<M, S> {
    /// The spacetime.
    pub medium: M,
    /// The method of integration.
    pub stepper: S,
    /// World position of its centre.
    pub center: DVec3,
    /// Where rays may stop.
    pub chart: Chart,
    /// What steps are held to.
    pub control: Control,
    /// Arcs with a larger sagitta are searched in halves: a thick chord meets too many boxes.
    pub longest_sagitta: f64,
    /// World bounds of the geometry; arcs outside are not searched.
    pub bounds: (DVec3, DVec3),
}

columns! {
    /// A curved ray; position relative to the spacetime's centre.
    pub struct CurvedFlight => CurvedFlightBlock {
        /// Position.
        position: DVec3,
        /// Momentum, |p| = n.
        momentum: DVec3,
        /// ½∇n² at the position.
        force: DVec3,
        /// Length in σ to try next.
        h: f64,
        /// What the position lies on, until the first step is taken.
        leaves: PrimitiveId,
        /// Steps so far, rejected ones included.
        steps: u32,
    }
}

columns! {
    /// One step of a curved ray.
    pub struct CurvedMove => CurvedMoveBlock {
        /// Position at the end.
        position: DVec3,
        /// Momentum at the end.
        momentum: DVec3,
        /// Force at the end.
        force: DVec3,
        /// Middle control point of the arc.
        middle: DVec3,
        /// Its weight.
        weight: f64,
        /// Length in σ to try next.
        next_h: f64,
        /// Whether the step is good enough to be taken.
        accepted: bool,
    }
}

/// Most steps of one ray: two orders of magnitude above what rays with several windings take.
const MAX_STEPS: u32 = 10_000;
/// Most times that an arc is halved for the search.
const MAX_HALVINGS: u32 = 8;

impl<M: ConformallyFlat, S: Stepper> Curved<M, S> {
    fn step(&self, flight: &CurvedFlight, step: &CurvedMove) -> Step {
        Step {
            start: [flight.position, flight.momentum, flight.force],
            end: [step.position, step.momentum, step.force],
            h: flight.h,
            momentum_error: DVec3::ZERO,
        }
    }

    /// The step's arc, in world coordinates.
    fn arc(&self, flight: &CurvedFlight, step: &CurvedMove) -> Arc {
        Arc {
            p0: flight.position + self.center,
            p1: step.middle + self.center,
            p2: step.position + self.center,
            w: step.weight,
        }
    }

    fn may_meet(&self, arc: &Arc) -> bool {
        let (min, max) = self.bounds;
        let (low, high) = (arc.p0.min(arc.p1).min(arc.p2), arc.p0.max(arc.p1).max(arc.p2));
        low.cmple(max).all() && high.cmpge(min).all()
    }

    /// Moves a crossing from the arc to the dense output, where that stays on the primitive and beside nothing else.
    fn polish(&self, geometry: &Geometry, flight: &CurvedFlight, step: &CurvedMove, found: Found) -> Landing {
        let Found { point, primitive } = found;
        let dense = Dense::new(&self.step(flight, step));
        let start = dense.parameter_beside(point - self.center, step.position - flight.position);
        let at = |s: f64| geometry.carrier(primitive, dense.position(s) + self.center);
        let mut s = start;
        for _ in 0..4 {
            let (height, normal) = at(s);
            let shift = height / normal.dot(dense.velocity(s));
            s -= shift;
            // Quadratic convergence: what is left is the square of this.
            if shift.abs() < 1e-7 {
                break;
            }
        }
        let position = dense.position(s) + self.center;
        let near = (0.0..=1.0).contains(&s) && position.distance(point) <= 8.0 * self.control.arc_tolerance;
        let clear = near
            && geometry.covers(primitive, position)
            && geometry.intersect(&Line { p0: point, p2: position }, primitive).is_none();
        let (position, s) = if clear { (position, s) } else { (point, start) };
        Landing { position, direction: dense.velocity(s).normalize(), primitive }
    }
}

impl<M: ConformallyFlat, S: Stepper> Transport for Curved<M, S> {
    type Flight = CurvedFlight;
    type Move = CurvedMove;
    type Segment = Arc;

    fn launch(&self, position: DVec3, direction: DVec3, leaves: PrimitiveId) -> CurvedFlight {
        let x = position - self.center;
        let momentum = self.medium.momentum(x, direction);
        CurvedFlight {
            position: x,
            momentum,
            force: self.medium.force(x),
            h: self.control.first_step(&self.stepper, &self.medium, x, momentum),
            leaves,
            steps: 0,
        }
    }

    #[inline(always)]
    fn advance(&self, flight: &CurvedFlight) -> CurvedMove {
        let step =
            self.stepper.step(&self.medium, [flight.position, flight.momentum, flight.force], flight.h);
        let Verdict { arc, accepted, next_h } = self.control.judge(&step);
        let [position, momentum, force] = step.end;
        CurvedMove { position, momentum, force, middle: arc.p1, weight: arc.w, next_h, accepted }
    }

    #[inline(always)]
    fn search(
        &self,
        flight: &Self::Flight,
        step: &Self::Move,
        mut search: impl FnMut(&Arc, PrimitiveId) -> Option<Found>,
    ) -> Option<Found> {
        if !step.accepted {
            return None;
        }
        let mut pending = [(self.arc(flight, step), 0); MAX_HALVINGS as usize + 1];
        let mut count = 1;
        let mut leaves = flight.leaves;
        while count > 0 {
            count -= 1;
            let (arc, halvings) = pending[count];
            if !self.may_meet(&arc) {
                leaves = PrimitiveId::NONE;
                continue;
            }
            if halvings < MAX_HALVINGS && arc.sagitta() > self.longest_sagitta {
                let (left, right) = arc.halves();
                pending[count] = (right, halvings + 1);
                pending[count + 1] = (left, halvings + 1);
                count += 2;
                continue;
            }
            if let found @ Some(_) = search(&arc, leaves) {
                return found;
            }
            leaves = PrimitiveId::NONE;
        }
        None
    }

    #[inline(always)]
    fn settle(
        &self,
        geometry: &Geometry,
        flight: &Self::Flight,
        step: &Self::Move,
        found: Option<Found>,
    ) -> Outcome<CurvedFlight> {
        if let Some(found) = found {
            return Outcome::Landed(self.polish(geometry, flight, step, found));
        }
        let steps = flight.steps + 1;
        if steps > MAX_STEPS {
            return Outcome::StepLimit;
        }
        if !step.accepted {
            // The next step must be finite and not vanish beside the position; a state lost for good is reported.
            let moves = step.next_h * flight.momentum.length() > f64::EPSILON * flight.position.length();
            let shorter = CurvedFlight { h: step.next_h, steps, ..*flight };
            return if moves { Outcome::Flying(shorter) } else { Outcome::NonFinite };
        }
        match self.chart.stop(step.position, step.momentum) {
            Some(Stop::Escaped) => {
                Outcome::Escaped(self.medium.escape_direction(step.position, step.momentum))
            }
            Some(Stop::Captured) => Outcome::Captured,
            None => Outcome::Flying(CurvedFlight {
                position: step.position,
                momentum: step.momentum,
                force: step.force,
                h: self.control.within_stride(step.next_h, step.position, step.momentum),
                leaves: PrimitiveId::NONE,
                steps,
            }),
        }
    }

    fn course(&self, flight: &Self::Flight, step: &Self::Move) -> Option<Arc> {
        step.accepted.then(|| self.arc(flight, step))
    }

    fn length(&self, flight: &Self::Flight, step: &Self::Move, point: Option<DVec3>) -> f64 {
        if !step.accepted {
            return 0.0;
        }
        let dense = Dense::new(&self.step(flight, step));
        let end = match point {
            Some(point) => dense.parameter_beside(point - self.center, step.position - flight.position),
            None => 1.0,
        };
        dense.length(end)
    }
}
