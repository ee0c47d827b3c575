//! Directions beside the edges of the shadows of holes: rays that set out there wind.
//!
//! The nearer to the edge, the farther a ray winds: by half a turn more where it is e^π times as near.

use std::f64::consts::{PI, TAU};

use glam::DVec3;

use crate::geodesic::{FieldControl, FieldEnd, FieldRays, Rkn6, alone, follow_field};
use crate::math::frame::tangents;
use crate::spacetime::{IndexField, SeveralHoles};

/// Azimuths about each hole.
const AZIMUTHS: u32 = 24;
/// Bisections of the angle between a ray that falls in and one that does not.
const BISECTIONS: u32 = 26;
/// Directions for each half turn, and largest angle from the edge relative to the shadow's radius.
const PER_HALF_TURN: u32 = 3;
const FARTHEST: f64 = 1.5;

/// Directions at `x` from which rays wind about single holes by winding numbers up to `max_winding`, about.
pub(super) fn beside_shadows<'a>(
    field: &'a SeveralHoles,
    control: &'a FieldControl,
    x: DVec3,
    max_winding: u32,
) -> impl Iterator<Item = DVec3> {
    let azimuths = move |hole: usize| (0..AZIMUTHS).map(move |azimuth| (hole, azimuth));
    let lines = (0..field.sinks().len()).flat_map(azimuths);
    let count = PER_HALF_TURN * (max_winding + 2);
    lines.filter_map(move |(hole, azimuth)| ShadowLine::new(field, control, x, hole, azimuth)).flat_map(
        move |line| {
            (0..count).filter_map(move |place| {
                let part = libm::exp(-PI * f64::from(place) / f64::from(PER_HALF_TURN));
                let angle = line.edge * (1.0 + FARTHEST * part);
                (angle < PI).then(|| line.direction(angle))
            })
        },
    )
}

/// Directions from that to a hole on, to one side.
#[derive(Clone, Copy)]
struct ShadowLine {
    towards: DVec3,
    aside: DVec3,
    /// Angle at which rays no longer fall into the hole.
    edge: f64,
}

impl ShadowLine {
    /// That of an azimuth about a hole; `None` if the ray to it does not fall into it.
    fn new(
        field: &SeveralHoles,
        control: &FieldControl,
        x: DVec3,
        hole: usize,
        azimuth: u32,
    ) -> Option<Self> {
        let towards = (field.sinks()[hole].center - x).try_normalize()?;
        let (a, b) = tangents(towards);
        let (sin, cos) = libm::sincos(TAU * f64::from(azimuth) / f64::from(AZIMUTHS));
        let mut line = Self { towards, aside: cos * a + sin * b, edge: PI };
        let sphere = (control.middle, control.outer + x.distance(control.middle));
        let falls = |direction: DVec3| {
            let start = FieldRays::new(field, &alone(x), &alone(direction));
            follow_field(field, &Rkn6, control, start, sphere, |_, _, _| {}).end == FieldEnd::Falls(hole)
        };
        if !falls(towards) {
            return None;
        }
        let mut within = 0.0;
        for _ in 0..BISECTIONS {
            let middle = 0.5 * (within + line.edge);
            if falls(line.direction(middle)) {
                within = middle;
            } else {
                line.edge = middle;
            }
        }
        Some(line)
    }

    /// Unit direction at an angle from that to the hole.
    fn direction(&self, angle: f64) -> DVec3 {
        let (sin, cos) = libm::sincos(angle);
        cos * self.towards + sin * self.aside
    }
}
