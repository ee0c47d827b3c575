//! Punctual lights around a spinning hole: a true connection per receiver and light.
//!
//! Of the rays that go the near way and of those that go around once, one is chosen by a guess of their brightness; behind
//! the hole, where there may be four, all of them are found, and one is chosen by its brightness. A ray that is not found
//! brings nothing: windings beyond that, and a few per cent of those that go around.

use glam::DVec3;

use crate::geodesic::kerr::{KerrConnection, KerrConnector, KerrPlace, PlacedHole};
use crate::light::aim::Link;

/// Largest error of a connection's direction, radians: below that of the march.
const TOLERANCE: f64 = 1e-6;
/// Azimuths around the hole from which rays to what is behind it are looked for.
const AZIMUTHS: u32 = 16;
/// Least probability of a ray that goes around.
const LEAST_AROUND: f64 = 0.02;

/// Place of a light around the hole: world position; `None` where nothing is at rest.
pub fn light_place(place: &PlacedHole, position: DVec3) -> Option<KerrPlace> {
    let light = KerrPlace::new(&place.hole, place.inwards((position - place.center) / place.mass));
    let is_outside = light.r * place.hole.horizon > 1.0 && place.hole.potential(light.r, light.n.z) < 1.0;
    is_outside.then_some(light)
}

/// Place of a light at infinity, in a unit direction of the world.
pub fn light_at_infinity(place: &PlacedHole, direction: DVec3) -> KerrPlace {
    KerrPlace { r: f64::INFINITY, n: place.inwards(direction) }
}

/// A ray from a world position to a light, in the world, and its probability, from a number in [0, 1).
pub fn link(
    place: &PlacedHole,
    position: DVec3,
    to: &KerrPlace,
    goes_around: bool,
    u: f64,
) -> Option<(Link, f64)> {
    let hole = &place.hole;
    let from = &KerrPlace::new(hole, place.inwards((position - place.center) / place.mass));
    let connector = KerrConnector { hole, from, to, tolerance: TOLERANCE };
    let near = from.aim(hole, to, 0)?;
    let (ray, pmf) = if goes_around && KerrConnector::has_more(&near) {
        brightest(&connector.all(AZIMUTHS), u)?
    } else {
        let around = if goes_around { from.ratio_around(to).max(LEAST_AROUND) } else { 0.0 };
        let pmf = around / (1.0 + around);
        if u < pmf {
            (connector.by_aim(&from.aim(hole, to, 1)?)?, pmf)
        } else {
            (connector.by_aim(&near)?, 1.0 - pmf)
        }
    };
    let per_area = if to.r == f64::INFINITY { 1.0 } else { place.mass * place.mass };
    let link = Link {
        direction: place.outwards(ray.direction),
        arrival: place.outwards(ray.arrival),
        geometry_factor: ray.geometry_factor / per_area,
    };
    link.geometry_factor.is_finite().then_some((link, pmf))
}

/// One of several rays in proportion to its brightness, and the probability of that.
fn brightest(rays: &[KerrConnection], u: f64) -> Option<(KerrConnection, f64)> {
    let sum: f64 = rays.iter().map(|ray| ray.geometry_factor).sum();
    let mut left = u * sum;
    let chosen = rays.iter().find(|ray| {
        left -= ray.geometry_factor;
        left < 0.0
    })?;
    Some((*chosen, chosen.geometry_factor / sum))
}
