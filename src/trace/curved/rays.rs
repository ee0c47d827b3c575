//! Curved rays of a spacetime: their tolerances, and the arcs that are searched along them.

use super::departure::WayOut;
use super::entrance::Entrance;
use super::flight::{CurvedFlight, CurvedMove, Lane};
use super::march::{March, keeps_outside};
use super::worlds::Worlds;
use crate::geodesic::{Arc, Control, Phase, PlaneArc};
use crate::spacetime::{Chart, ConformallyFlat};

/// Rays of a static, spherically symmetric spacetime, followed in numbers of type `R`, in one world or in two.
///
/// Orbits are in `R`; places are in f64, and moved by displacements that are good to the rounding of `R` relative to
/// the step: nothing jitters far from the origin.
pub struct Curved<M, R, W> {
    /// The spacetime.
    pub medium: M,
    /// The method of integration in it.
    pub march: Box<dyn March<R>>,
    /// Worlds that they move in.
    pub worlds: W,
    /// Where rays from outside of all geometry start, if it is known how they come there.
    pub entrance: Option<Entrance<R>>,
    /// Way to infinity, if another than the march's is known.
    pub way_out: Option<Box<dyn WayOut<R>>>,
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
}

/// Inverse radius down to which a step may end outside the geometry, as a part of that which bounds it.
const OUTSIDE: f64 = 0.5;
/// Inverse radius below which a ray is so far outside that one step to the geometry would be too long for the rounding
/// of a search, as a part of the same.
const AFAR: f64 = 0.1;
/// Inverse radius at which its next step ends, as a part of the same.
const EDGE: f64 = 0.7;

impl<M: ConformallyFlat, R: Lane, W: Worlds<M>> Curved<M, R, W> {
    /// The step's arc, in world coordinates.
    #[inline(always)]
    pub fn arc(&self, flight: &CurvedFlight<R>, step: &CurvedMove<R>) -> Arc {
        let plane = PlaneArc {
            middle: [step.middle_x, step.middle_y],
            end: [step.end_x, step.end_y],
            weight: step.weight,
            error: R::of(0.0),
        };
        plane.placed(flight.position + self.worlds.of(flight.origin_prim).center, flight.radial, flight.along)
    }

    /// True if a step can meet anything.
    #[inline(always)]
    pub fn is_searched(&self, flight: &CurvedFlight<R>, step: &CurvedMove<R>) -> bool {
        let end = Phase { w: step.w, v: step.v, pull: step.pull };
        step.accepted & !keeps_outside(&self.chart, flight.b, &flight.phase(), &end)
    }

    /// A length of at most `h` for the next step: from afar, rays go to the geometry's edge in one step, and on their way
    /// out they do not go far beyond it.
    #[inline(always)]
    pub fn within(&self, h: R, b: R, phase: &Phase<R>) -> R {
        let h = self.control.within(h, b, phase);
        let outer = R::of(self.chart.outer);
        let (outside, edge) = (R::of(OUTSIDE), R::of(EDGE) * outer);
        let (w, v) = (phase.w, phase.v);
        if v < R::of(0.0) {
            let end = if w > outer { outside * outer } else { outside * w };
            h.at_most((end - w) / v)
        } else if w < R::of(AFAR) * outer {
            h.at_most((edge - w) / v)
        } else {
            h
        }
    }
}
