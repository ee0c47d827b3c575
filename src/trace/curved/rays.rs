//! Curved rays of a spacetime: their tolerances, and the arcs that are searched along them.

use glam::DVec3;

use super::flight::{CurvedFlight, CurvedMove, Lane};
use super::march::{March, keeps_outside};
use crate::geodesic::{Arc, Control, Phase, PlaneArc};
use crate::geometry::{Found, PrimitiveId};
use crate::spacetime::{Chart, ConformallyFlat};

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
    /// True if the directions of escaped rays at infinity matter; else rays are not followed there.
    pub sky: bool,
    /// Radii beyond which rays need not be followed.
    pub chart: Chart,
    /// Step-size control.
    pub control: Control<R>,
    /// Largest error of a ray's direction, radians.
    pub tolerance: f64,
    /// Largest distance between an arc and the curve.
    pub arc_tolerance: f64,
    /// Arcs with a larger sagitta are searched in halves: a thick chord meets too many boxes. Infinite without boxes.
    pub longest_sagitta: f64,
    /// Longer arcs are searched in halves: beside them, the geometry would drown in their rounding.
    pub longest_chord: f64,
    /// World bounds of the geometry; arcs outside are not searched.
    pub bounds: (DVec3, DVec3),
}

/// Most times that an arc is halved because of its sagitta.
const MOST_FOR_SAGITTA: u32 = 8;
/// Most times that an arc is halved because of its length.
const MOST_FOR_LENGTH: u32 = 60;
/// Inverse radius down to which a step may end outside the geometry, as a part of that which bounds it.
const OUTSIDE: f64 = 0.5;
/// Inverse radius at which a step from far outside ends, as a part of the same: so far out that the pull does not take
/// it in.
const EDGE: f64 = 0.7;

impl<M: ConformallyFlat, R: Lane> Curved<M, R> {
    /// The step's arc, in world coordinates.
    #[inline(always)]
    pub fn arc(&self, flight: &CurvedFlight<R>, step: &CurvedMove<R>) -> Arc {
        let plane = PlaneArc {
            middle: [step.middle_x, step.middle_y],
            end: [step.end_x, step.end_y],
            weight: step.weight,
            error: R::of(0.0),
        };
        plane.placed(flight.position + self.center, flight.radial, flight.along)
    }

    /// True if a step can meet anything.
    #[inline(always)]
    pub fn is_searched(&self, flight: &CurvedFlight<R>, step: &CurvedMove<R>) -> bool {
        let end = Phase { w: step.w, v: step.v, pull: step.pull };
        step.accepted & !keeps_outside(R::of(self.chart.outer), &flight.phase(), &end)
    }

    /// False for an arc that is outside the bounds of the geometry.
    #[inline(always)]
    pub fn may_meet(&self, arc: &Arc) -> bool {
        let (min, max) = self.bounds;
        let (low, high) = (arc.p0.min(arc.p1).min(arc.p2), arc.p0.max(arc.p1).max(arc.p2));
        let within = |low: f64, high: f64, min: f64, max: f64| (low <= max) & (high >= min);
        within(low.x, high.x, min.x, max.x)
            & within(low.y, high.y, min.y, max.y)
            & within(low.z, high.z, min.z, max.z)
    }

    /// Searches an arc, in halves if it is thick or long beside the geometry.
    pub fn sweep<F>(
        &self,
        arc: &Arc,
        origin_prim: PrimitiveId,
        halvings: u32,
        search: &mut F,
    ) -> Option<Found>
    where
        F: FnMut(&Arc, PrimitiveId) -> Option<Found>,
    {
        if !self.may_meet(arc) {
            return None;
        }
        if self.is_split(arc, halvings) {
            let (left, right) = arc.halves();
            let first = self.sweep(&left, origin_prim, halvings + 1, search);
            return first.or_else(|| self.sweep(&right, PrimitiveId::NONE, halvings + 1, search));
        }
        search(arc, origin_prim)
    }

    /// A length of at most `h` for the next step: far outside the geometry, rays go to its edge in one step, and on
    /// their way out they do not go far beyond.
    #[inline(always)]
    pub fn within(&self, h: R, b: R, phase: &Phase<R>) -> R {
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

    /// True if an arc is to be searched in halves, after it has been halved so often.
    #[inline(always)]
    pub fn is_split(&self, arc: &Arc, halvings: u32) -> bool {
        let length2 = arc.p0.distance_squared(arc.p2);
        ((halvings < MOST_FOR_SAGITTA) & (arc.sagitta() > self.longest_sagitta))
            | ((halvings < MOST_FOR_LENGTH) & (length2 > self.longest_chord * self.longest_chord))
    }
}
