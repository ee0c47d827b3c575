//! Straight aim: exact in flat space.

use glam::DVec3;

use super::{Aim, Approach, Link};
use crate::spacetime::{AtInfinity, Side};

/// Straight rays.
pub struct StraightAim;

/// An end of a straight ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StraightPlace {
    /// World position; at infinity the unit direction.
    position: DVec3,
    is_infinite: bool,
    side: Side,
}

impl Aim for StraightAim {
    type Place = StraightPlace;
    const SIDE_BY_SIDE: bool = false;

    fn place(&self, side: Side, x: DVec3) -> StraightPlace {
        StraightPlace { position: x, is_infinite: false, side }
    }

    fn infinity(&self, AtInfinity { side, direction }: AtInfinity) -> StraightPlace {
        StraightPlace { position: direction, is_infinite: true, side }
    }

    fn windings(&self) -> u32 {
        1
    }

    fn around(&self, _: &StraightPlace, _: &StraightPlace) -> f64 {
        0.0
    }

    fn straight_from(&self, x: &StraightPlace) -> Option<DVec3> {
        Some(x.position)
    }

    fn approach(&self, x: &StraightPlace, y: &StraightPlace, _: u32) -> Approach {
        let direction =
            if y.is_infinite { y.position } else { (y.position - x.position).normalize_or_zero() };
        Approach { distance: x.position.distance(y.position), direction, is_exact: true }
    }

    fn link(&self, x: &StraightPlace, y: &StraightPlace, _: u32) -> Option<Link> {
        if x.side != y.side {
            return None;
        }
        if y.is_infinite {
            return Some(Link { direction: y.position, arrival: y.position, geometry_factor: 1.0 });
        }
        let offset = y.position - x.position;
        let distance2 = offset.length_squared();
        let direction = offset.try_normalize()?;
        Some(Link { direction, arrival: direction, geometry_factor: 1.0 / distance2 })
    }

    fn classify(&self, x: &StraightPlace, _: DVec3, y: &StraightPlace, _: DVec3) -> Option<(u32, f64)> {
        let geometry_factor = if y.is_infinite { 1.0 } else { 1.0 / x.position.distance_squared(y.position) };
        Some((0, geometry_factor))
    }

    fn is_reached(&self, _: Side, _: DVec3, _: DVec3) -> bool {
        // What a straight ray meets twice it leaves on the side that is not lit.
        true
    }

    fn area_scale(&self, _: &StraightPlace) -> f64 {
        1.0
    }
}
