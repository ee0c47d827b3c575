//! Rays that join two places by way of others: multiple shooting.
//!
//! A ray that winds is so sensitive to its start that Newton's method finds it from beside it only. Cut into legs that are
//! little sensitive each, it is found from afar: all stops are corrected together, until every leg ends as the next one
//! starts. The corrections obey a linear recurrence, whose growing solutions are kept apart by an orthonormal basis at
//! every stop.
//!
//! References: multiple shooting: Stoer, Bulirsch 2002, "Introduction to Numerical Analysis", § 7.3.5; the march from
//! basis to basis: Conte 1966, SIAM Review 8, 309.

use glam::{DMat2, DMat4, DVec2, DVec3, DVec4};

use super::connect::{beside, mean};
use super::control::{FieldControl, FieldVerdict};
use super::step::{FieldRays, FieldStep, lane, set_lane};
use crate::geodesic::{Rkn6, Stepper};
use crate::math::frame::tangents;
use crate::math::kernel::widest;
use crate::spacetime::{IndexField, Vectors};

/// A place that a ray goes through, about.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FieldStop {
    /// World position.
    pub x: DVec3,
    /// Unit direction of travel.
    pub direction: DVec3,
    /// Length over which the field changes.
    pub scale: f64,
}

/// A leg between two stops. What is across the direction of a stop is two offsets, in units of its scale, and two turns,
/// radians.
struct Leg {
    /// Where the leg ends, across the next stop.
    off: DVec4,
    /// How that changes with the start of the leg.
    slopes: DMat4,
}

/// Offsets and turns of the rays beside a leg.
const BESIDE: f64 = 1e-6;
/// Rays that stand for a leg and its derivatives.
const RAYS: usize = 8;
/// Steps of a leg at most.
const MOST_STEPS: u32 = 1000;
/// How near a leg ends to the plane through the next stop, relative to their distance.
const NEAREST: f64 = 1e-7;
/// Sum of squares by which ends miss the next starts that is enough, root.
const ENOUGH: f64 = 1e-7;
/// Corrections of all stops at most, halvings of one that makes it worse, and the largest change by one.
const CORRECTIONS: u32 = 20;
const MOST_HALVINGS: u32 = 4;
const LARGEST: f64 = 0.5;

/// Unit direction at the first stop of a ray from there to the place of the last, by way of the others or of places near
/// them; `None` if there is none, or none is found.
pub fn join_by_way(
    field: &impl IndexField,
    control: &FieldControl,
    mut stops: Vec<FieldStop>,
) -> Option<DVec3> {
    let mut legs = legs_between(field, control, &stops)?;
    for _ in 0..CORRECTIONS {
        let missed = miss(&legs);
        if missed <= ENOUGH {
            return stops.first().map(|stop| stop.direction);
        }
        let changes = changes(&legs);
        let largest = changes.iter().fold(0.0f64, |largest, by| largest.max(by.abs().max_element()));
        let mut part = (LARGEST / largest).min(1.0);
        (stops, legs) = (0..=MOST_HALVINGS).find_map(|_| {
            let moved: Vec<FieldStop> =
                stops.iter().zip(&changes).map(|(stop, &by)| stop.moved(part * by)).collect();
            part *= 0.5;
            let legs = legs_between(field, control, &moved)?;
            (miss(&legs) < missed).then_some((moved, legs))
        })?;
    }
    None
}

impl FieldStop {
    /// The stop, moved and turned.
    fn moved(&self, by: DVec4) -> Self {
        let (a, b) = tangents(self.direction);
        Self {
            x: self.x + self.scale * (by.x * a + by.y * b),
            direction: (self.direction + by.z * a + by.w * b).normalize(),
            ..*self
        }
    }
}

fn legs_between(field: &impl IndexField, control: &FieldControl, stops: &[FieldStop]) -> Option<Vec<Leg>> {
    stops.windows(2).map(|ends| leg(field, control, &ends[0], &ends[1])).collect()
}

/// By how much legs miss the stops: the direction at the last one is free.
fn miss(legs: &[Leg]) -> f64 {
    let Some((last, others)) = legs.split_last() else { return 0.0 };
    let on_the_way: f64 = others.iter().map(|leg| leg.off.length_squared()).sum();
    (on_the_way + last.off.truncate().truncate().length_squared()).sqrt()
}

/// Changes of all stops that would let every leg end as the next one starts, to first order. Neither the place of the first
/// stop changes nor that of the last.
fn changes(legs: &[Leg]) -> Vec<DVec4> {
    // A change is basis · share + rest.
    let (mut basis, mut rest) = ([DVec4::Z, DVec4::W], DVec4::ZERO);
    let mut march = Vec::with_capacity(legs.len());
    for leg in legs {
        let [first, second] = basis.map(|axis| leg.slopes * axis);
        let end = leg.slopes * rest + leg.off;
        let along = first.normalize();
        let shear = along.dot(second);
        let across = (second - shear * along).normalize();
        let growth = DMat2::from_cols(DVec2::new(first.length(), 0.0), DVec2::new(shear, across.dot(second)));
        let shift = DVec2::new(along.dot(end), across.dot(end));
        march.push((basis, rest, growth, shift));
        (basis, rest) = ([along, across], end - shift.x * along - shift.y * across);
    }
    let place = |change: DVec4| DVec2::new(change.x, change.y);
    let mut share = DMat2::from_cols(place(basis[0]), place(basis[1])).inverse() * -place(rest);
    let mut changes = vec![DVec4::ZERO];
    for (basis, rest, growth, shift) in march.into_iter().rev() {
        share = growth.inverse() * (share - shift);
        changes.push(share.x * basis[0] + share.y * basis[1] + rest);
    }
    changes.reverse();
    changes
}

/// The leg from a stop to the plane through the next, across the direction there; `None` if it does not get there.
fn leg(field: &impl IndexField, control: &FieldControl, from: &FieldStop, to: &FieldStop) -> Option<Leg> {
    let (mut starts, mut directions) = ([[0.0; RAYS]; 3], [[0.0; RAYS]; 3]);
    let axes = [DVec4::X, DVec4::Y, DVec4::Z, DVec4::W];
    for l in 0..RAYS {
        let sign = if l % 2 == 0 { BESIDE } else { -BESIDE };
        let start = from.moved(sign * axes[l / 2]);
        set_lane(&mut starts, l, start.x);
        set_lane(&mut directions, l, start.direction);
    }
    let end = widest(LegRays { field, control, starts: &starts, directions: &directions, to })?;
    let (a, b) = tangents(to.direction);
    let across = |l: usize| {
        // Each ray reaches the plane at a time of its own.
        let (x, p) = (lane(&end.x, l), lane(&end.p, l));
        let more = (to.x - x).dot(to.direction) / p.dot(to.direction);
        let (offset, p) = (x + more * p - to.x, p + more * lane(&end.force, l));
        let per_ahead = 1.0 / p.dot(to.direction);
        let place = DVec2::new(a.dot(offset), b.dot(offset)) / to.scale;
        DVec4::new(place.x, place.y, a.dot(p) * per_ahead, b.dot(p) * per_ahead)
    };
    let slope = |axis: usize| (across(2 * axis) - across(2 * axis + 1)) / (2.0 * BESIDE);
    Some(Leg {
        off: (0..RAYS).map(across).sum::<DVec4>() / RAYS as f64,
        slopes: DMat4::from_cols(slope(0), slope(1), slope(2), slope(3)),
    })
}

/// Rays beside each other, to be followed until their middle goes through the plane of a stop.
struct LegRays<'a, F> {
    field: &'a F,
    control: &'a FieldControl,
    starts: &'a Vectors<RAYS>,
    directions: &'a Vectors<RAYS>,
    to: &'a FieldStop,
}

impl<F: IndexField> pulp::NullaryFnOnce for LegRays<'_, F> {
    type Output = Option<FieldRays<RAYS>>;

    #[inline(always)]
    fn call(self) -> Self::Output {
        let Self { field, control, starts, directions, to } = self;
        let step =
            |rays: &FieldRays<RAYS>, h: f64| FieldStep::new::<{ 3 * RAYS }>(field, &Rkn6, rays, &[h; RAYS]);
        let middle = |rays: &FieldRays<RAYS>| mean::<RAYS>(|l| lane(&rays.x, l));
        let momentum = |rays: &FieldRays<RAYS>| mean::<RAYS>(|l| lane(&rays.p, l));
        // How far the middle ray has to go, times n.
        let left = |rays: &FieldRays<RAYS>| (to.x - middle(rays)).dot(to.direction) * momentum(rays).length();
        let mut rays = FieldRays::new(field, starts, directions);
        let whole = to.x.distance(middle(&rays));
        let (mut h, mut previous) = (control.first_step(Rkn6::ESTIMATE.order, &rays, 0), 1.0);
        if left(&rays) <= 0.0 {
            return None;
        }
        for _ in 0..MOST_STEPS {
            let moved = step(&rays, h);
            let FieldVerdict { accepted, next_h, error } =
                control.judge::<RAYS, Rkn6>((&moved, h), 0.0, previous, 0);
            if !accepted {
                let moves = next_h > f64::from(f32::MIN_POSITIVE);
                if !moves {
                    return None;
                }
                h = next_h;
                continue;
            }
            if left(&moved.end) <= 0.0 {
                return Some(beside(&rays, (&moved, h), step, left, NEAREST * whole));
            }
            let x = middle(&moved.end);
            let is_gone = control.leaves(x, momentum(&moved.end)) && left(&moved.end) > left(&rays);
            if is_gone || field.sinks().iter().any(|sink| x.distance(sink.center) < sink.captures) {
                return None;
            }
            (rays, previous) = (moved.end, error);
            h = control.within(next_h, &rays, 0);
        }
        None
    }
}
