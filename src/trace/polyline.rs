//! Polylines along single rays.

use std::convert::Infallible;

use glam::DVec3;
use rayon::prelude::*;

use super::choice::with_transport_to;
use super::halt::Halt;
use super::shoot::{Ray, follow};
use super::transport::{Outcome, Transport, TransportVisitor};
use crate::geometry::{Geometry, Segment};
use crate::scene::{Baked, StepperKind};
use crate::spacetime::Side;

/// A ray's path and its end.
#[derive(Clone, Debug, PartialEq)]
pub struct Polyline {
    /// The path from the start to the end, or to where nothing more can be met: a piece on each side of a wormhole that the
    /// ray comes to, one at least.
    pub pieces: Vec<PolylinePiece>,
    /// Unit direction of travel at the last of them.
    pub heading: DVec3,
    /// Outcome of the ray; never flying.
    pub end: Outcome<Infallible>,
}

/// Part of a ray's path on one side of a wormhole.
#[derive(Clone, Debug, PartialEq)]
pub struct PolylinePiece {
    /// Side that it is on.
    pub side: Side,
    /// World points, one at least.
    pub points: Vec<DVec3>,
}

/// Largest distance by which a polyline may cut a corner, relative to the move.
const CUT_CORNER: f64 = 2e-5;
/// Most points along a move.
const MOST_POINTS: f64 = 48.0;

/// Follows `rays` through `scene` as [`shoot`](super::shoot) does, but falling ones down to the horizon, on all
/// threads.
pub fn polylines(scene: &Baked, rays: &[Ray]) -> Vec<Polyline> {
    // Steps of the paper's length jump over the horizon.
    let core = if scene.settings.stepper == StepperKind::Rk4Paper { f64::INFINITY } else { 0.0 };
    with_transport_to(scene, core, true, Trailing { geometry: &scene.geometry, rays })
}

struct Trailing<'a> {
    geometry: &'a Geometry,
    rays: &'a [Ray],
}

impl TransportVisitor for Trailing<'_> {
    type Output = Vec<Polyline>;

    fn run<T: Transport + 'static>(self, transport: T) -> Vec<Polyline> {
        self.rays.par_iter().map(|ray| polyline(&transport, self.geometry, ray)).collect()
    }
}

fn polyline<T: Transport>(transport: &T, geometry: &Geometry, ray: &Ray) -> Polyline {
    let mut piece = PolylinePiece { side: ray.origin_prim.side(), points: vec![ray.position] };
    let (mut pieces, mut heading) = (Vec::new(), ray.direction);
    let (shot, _) =
        follow(transport, geometry, &ray.start(), &Halt::default(), |flight, step, found, landing| {
            // A flight that goes on although something was found came closer to it by a shorter step, to be tried next.
            let taken = landing.is_some() || found.is_none();
            let Some(course) = transport.course(flight, step).filter(|_| taken) else { return };
            let side = transport.side(flight);
            if side != piece.side {
                let next = PolylinePiece { side, points: vec![course.chord().start] };
                pieces.push(std::mem::replace(&mut piece, next));
            }
            extend(&mut piece.points, &course, landing.map(|landing| landing.position));
            heading = landing.map_or(course.heading(), |landing| landing.direction);
        });
    pieces.push(piece);
    Polyline { pieces, heading, end: shot.end }
}

/// Adds the points of `course` after its start, up to `landing` if given; none that is not finite.
fn extend(points: &mut Vec<DVec3>, course: &impl Segment, landing: Option<DVec3>) {
    let chord = course.chord();
    let along = chord.end - chord.start;
    // The sagitta falls with the square of the number of pieces.
    let count = (chord.bow.length() / (CUT_CORNER * along.length())).sqrt().ceil().clamp(1.0, MOST_POINTS);
    let course = (1..=count as u32).map(|i| course.point(f64::from(i) / count));
    // No course turns by more than a right angle: points advance along its chord.
    let before = |point: &DVec3| landing.is_none_or(|landing| (landing - point).dot(along) > 0.0);
    points.extend(course.filter(|point| point.is_finite()).take_while(before));
    points.extend(landing);
}
