//! Rays of a field: their tolerances, where they end, and the arcs that are searched along them.

use super::flight::{FieldFlight, FieldMove};
use super::march::{FieldMarch, Trap, march};
use glam::DVec3;

use crate::geodesic::{Arc, FieldControl};
use crate::scene::Baked;
use crate::spacetime::IndexField;
use crate::trace::arc_sweep::ArcSweep;

/// Rays of a static index of refraction.
pub struct FieldTransport {
    /// The method of integration in the field.
    pub march: Box<dyn FieldMarch>,
    /// True if the directions of escaped rays at infinity matter; else rays are not followed there.
    pub sky: bool,
    /// Step-size control.
    pub control: FieldControl,
    /// Largest error of a ray's direction, radians.
    pub tolerance: f64,
    /// Largest distance between an arc and the curve.
    pub arc_tolerance: f64,
    /// Search along arcs.
    pub sweep: ArcSweep,
}

impl FieldTransport {
    /// Rays of `scene` in `field`; falling ones are followed at least to the distance `core` from each hole, and to the
    /// places of `lights`.
    pub fn new(scene: &Baked, field: &impl IndexField, core: f64, lights: &[DVec3], sky: bool) -> Self {
        let (tolerance, middle) = (scene.settings.tolerance, field.middle());
        let farthest = scene.geometry.radii(middle).map_or(0.0, |(_, farthest)| farthest);
        let arc_tolerance = scene.arc_tolerance_around(middle);
        let control = FieldControl::new(field, farthest, tolerance, arc_tolerance);
        let traps = field.sinks().iter().map(|sink| {
            let nearest = scene.geometry.radii(sink.center).map_or(f64::INFINITY, |(nearest, _)| nearest);
            let lights = lights.iter().map(|light| light.distance(sink.center));
            let nearest = lights.fold(nearest, f64::min);
            let radius = sink.captures.min(nearest.min(core)).max(sink.innermost);
            Trap { center: sink.center, radius2: radius * radius }
        });
        Self {
            march: march(
                field.clone(),
                scene.settings.stepper.around(&scene.spacetime),
                control,
                traps.collect(),
            ),
            sky,
            control,
            tolerance,
            arc_tolerance,
            sweep: ArcSweep::new(scene, arc_tolerance),
        }
    }

    /// The step's arc, in world coordinates.
    #[inline(always)]
    pub fn arc(flight: &FieldFlight, step: &FieldMove) -> Arc {
        let start = flight.position;
        Arc { p0: start, p1: start + step.middle, p2: start + step.chord, w: step.weight }
    }

    /// True if a step can meet anything.
    #[inline(always)]
    pub fn is_searched(&self, flight: &FieldFlight, step: &FieldMove) -> bool {
        let start = (flight.position, flight.momentum);
        step.accepted & !self.control.keeps_outside(start, (step.position, step.momentum))
    }
}
