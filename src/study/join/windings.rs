//! Rays that wind about one of several holes, looked for leg by leg.
//!
//! From the side of either end the ray that just winds for ever is found by bisection. Both halves, as far as they are
//! needed, are a guess of the ray that winds as often as is asked.

use std::f64::consts::{PI, TAU};
use std::iter;

use glam::DVec3;

use crate::geodesic::{
    FieldConnection, FieldControl, FieldEnd, FieldRays, FieldStop, FieldTarget, JoinLimits, Rkn6, alone,
    follow_field, join_by_way, join_in_field, lane,
};
use crate::light::FieldAim;
use crate::math::frame::tangents;
use crate::spacetime::{IndexField, SeveralHoles, Sink};

/// Least winding number of the rays: others are found from guesses of their directions.
const LEAST_WINDING: u32 = 3;
/// Distance from a hole of the place at which it is looked, in radii of its photon sphere, and by how much rays may miss it.
const BEFORE: f64 = 2.0;
const MISS: f64 = 1e-3;
/// Corrections of a direction in which a hole is seen, at most.
const CORRECTIONS: u32 = 20;
/// Directions past other holes in which a hole is looked for: azimuths, and distances in radii of their shadows.
const AZIMUTHS: u32 = 8;
const PAST: [f64; 3] = [1.2, 2.0, 3.5];
/// Bisections of the angle between a ray that falls in and one that does not, and factor by which that is looked for.
const BISECTIONS: u32 = 34;
const WIDER: f64 = 1.3;
/// Distance from a hole within which a ray winds about it, in radii of its shadow.
const NEAR: f64 = 3.0;
/// Angle between both halves where they end, radians, and cosine of the angle by which a ray turns from stop to stop.
const BETWEEN: f64 = 0.5;
const TURN: f64 = 0.8;
/// Turns of the planes of both halves, radians: where other holes are near, rays in several planes wind alike.
const TILTS: [[f64; 2]; 5] = [[0.0, 0.0], [1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]];
/// Sine of the angle at a hole between both ends, below which any plane holds them.
const ALIGNED: f64 = 1e-3;

/// Directions at `x` of rays to `y` that wind about single holes by winding numbers up to `max_winding`, about.
pub(super) fn winding(
    aim: &FieldAim<SeveralHoles>,
    control: &FieldControl,
    [x, y]: [DVec3; 2],
    max_winding: u32,
) -> Vec<DVec3> {
    let field = aim.field();
    let tilts = &TILTS[..if field.sinks().len() > 1 { TILTS.len() } else { 1 }];
    let mut found = Vec::new();
    if max_winding < LEAST_WINDING {
        return found;
    }
    for sink in field.sinks() {
        let sights = [x, y].map(|from| SeenHole::all(aim, control, from, sink));
        for (near, far) in sights[0].iter().flat_map(|near| sights[1].iter().map(move |far| (near, far))) {
            for (&tilts, sense) in tilts.iter().flat_map(|tilts| [(tilts, 1.0), (tilts, -1.0)]) {
                let plane = WindingPlane::new([near, far], sense);
                let (Some(near), Some(far)) = (
                    near.winding_ray(field, control, plane.side(near, tilts[0])),
                    far.winding_ray(field, control, -plane.side(far, tilts[1])),
                ) else {
                    continue;
                };
                let windings = LEAST_WINDING..=max_winding;
                for winding in windings.filter(|winding| winding.is_multiple_of(2) == (sense > 0.0)) {
                    let half = 0.5 * (plane.sweep(winding) - BETWEEN);
                    let back =
                        far.until(half).rev().map(|stop| FieldStop { direction: -stop.direction, ..stop });
                    found.extend(join_by_way(field, control, near.until(half).chain(back).collect()));
                }
            }
        }
    }
    found
}

/// Plane in which a ray winds about a hole, and the sense in which it does.
struct WindingPlane {
    /// Normal, about which the ray winds the short way from one end to the other.
    normal: DVec3,
    /// The angle of that way, radians.
    angle: f64,
    /// 1 for the short way, −1 for the other.
    sense: f64,
}

impl WindingPlane {
    fn new([near, far]: [&SeenHole; 2], sense: f64) -> Self {
        let across = near.from.cross(far.from);
        let aligned = across.length() < ALIGNED;
        let normal = if aligned { tangents(near.from).0 } else { across.normalize() };
        Self { normal, angle: libm::atan2(across.length(), near.from.dot(far.from)), sense }
    }

    /// Unit vector to the side of a hole on which a ray towards it winds in this sense, turned by a `tilt`.
    fn side(&self, sight: &SeenHole, tilt: f64) -> DVec3 {
        let side = self.sense * self.normal.cross(sight.from);
        let (sin, cos) = libm::sincos(tilt);
        cos * side + sin * sight.from.cross(side)
    }

    /// Angle by which a ray of this winding number goes around.
    fn sweep(&self, winding: u32) -> f64 {
        if winding.is_multiple_of(2) {
            self.angle + PI * f64::from(winding)
        } else {
            TAU - self.angle + PI * f64::from(winding - 1)
        }
    }
}

/// A hole as it is seen from a place.
struct SeenHole<'a> {
    hole: &'a Sink,
    /// The place.
    x: DVec3,
    /// A ray from there that falls into it.
    ray: FieldConnection,
    /// Unit direction from the hole to where that comes from.
    from: DVec3,
}

impl<'a> SeenHole<'a> {
    /// All ways in which a hole is seen.
    fn all(aim: &FieldAim<SeveralHoles>, control: &FieldControl, x: DVec3, hole: &'a Sink) -> Vec<Self> {
        let field = aim.field();
        let Some(to) = (hole.center - x).try_normalize() else { return Vec::new() };
        let before = |from: DVec3| FieldTarget::Place(hole.center + BEFORE * hole.photon_sphere * from);
        let limits = JoinLimits { enough: MISS * hole.photon_sphere, linear: 0.0, corrections: CORRECTIONS };
        let guesses = aim.guesses(x, before(-to)).chain(iter::once(to)).chain(past_others(field, x, hole));
        let images = aim.images(control, (x, before(-to)), guesses, limits);
        let seen = |image: &FieldConnection| {
            let ray = join_in_field(field, control, (x, image.direction), before(-image.arrival), limits)?;
            let sight = Self { hole, x, ray, from: -ray.arrival };
            sight.falls(field, control, ray.direction).then_some(sight)
        };
        images.iter().filter_map(seen).collect()
    }

    /// True if the ray in a unit direction falls into the hole.
    fn falls(&self, field: &SeveralHoles, control: &FieldControl, direction: DVec3) -> bool {
        let start = FieldRays::new(field, &alone(self.x), &alone(direction));
        let sphere = (control.middle, control.outer + self.x.distance(control.middle));
        let end = follow_field(field, &Rkn6, control, start, sphere, |_, _, _| {}).end;
        matches!(end, FieldEnd::Falls(sink) if field.sinks()[sink].center == self.hole.center)
    }

    /// The ray that winds for ever, to a `side` of the hole; `None` if none is found.
    fn winding_ray(&self, field: &SeveralHoles, control: &FieldControl, side: DVec3) -> Option<WindingRay> {
        let towards = self.ray.direction;
        let turned = self.ray.turned(side);
        let aside = (turned - turned.dot(towards) * towards).try_normalize()?;
        let direction = |angle: f64| {
            let (sin, cos) = libm::sincos(angle);
            cos * towards + sin * aside
        };
        let (mut within, mut edge) = (0.0, (self.hole.shadow * turned.length()).min(1.0));
        while self.falls(field, control, direction(edge)) {
            (within, edge) = (edge, WIDER * edge);
            if edge > PI {
                return None;
            }
        }
        for _ in 0..BISECTIONS {
            let middle = 0.5 * (within + edge);
            if self.falls(field, control, direction(middle)) {
                within = middle;
            } else {
                edge = middle;
            }
        }
        Some(WindingRay::new(field, control, self, direction(edge)))
    }
}

/// Directions at `x` past the holes other than `hole`.
fn past_others(field: &SeveralHoles, x: DVec3, hole: &Sink) -> impl Iterator<Item = DVec3> {
    let others = field.sinks().iter().filter(move |other| other.center != hole.center);
    others.flat_map(move |other| {
        let to = other.center - x;
        let (a, b) = tangents(to.normalize_or(DVec3::Z));
        let places = (0..AZIMUTHS).flat_map(|azimuth| PAST.map(|past| (azimuth, past)));
        places.map(move |(azimuth, past)| {
            let (sin, cos) = libm::sincos(TAU * f64::from(azimuth) / f64::from(AZIMUTHS));
            (to + past * other.shadow * (cos * a + sin * b)).normalize()
        })
    })
}

/// Stops along a ray that winds about a hole, from its start on.
struct WindingRay {
    /// Stops, and the angle by which the ray has gone around the hole before.
    stops: Vec<(FieldStop, f64)>,
}

impl WindingRay {
    fn new(field: &SeveralHoles, control: &FieldControl, sight: &SeenHole, direction: DVec3) -> Self {
        let SeenHole { hole, x, from, .. } = *sight;
        let reach = NEAR * hole.shadow;
        let mut stops = vec![(FieldStop { x, direction, scale: x.distance(hole.center) }, 0.0)];
        let (mut swept, mut last) = (0.0, from);
        let start = FieldRays::new(field, &alone(x), &alone(direction));
        let sphere = (control.middle, control.outer + x.distance(control.middle));
        follow_field(field, &Rkn6, control, start, sphere, |start, _, _| {
            let (x, direction) = (lane(&start.x, 0), lane(&start.p, 0).normalize());
            let away = x - hole.center;
            let scale = away.length();
            if scale < reach {
                swept += libm::atan2(last.cross(away).length(), last.dot(away));
                last = away;
            }
            if direction.dot(stops[stops.len() - 1].0.direction) < TURN {
                stops.push((FieldStop { x, direction, scale }, swept));
            }
        });
        Self { stops }
    }

    /// The stops until the ray has gone around by an angle.
    fn until(&self, swept: f64) -> impl DoubleEndedIterator<Item = FieldStop> {
        let count = self.stops.iter().take_while(|stop| stop.1 <= swept).count();
        self.stops[..count].iter().map(|stop| stop.0)
    }
}
