//! Lensed aim: exact in static, spherical spacetimes, with all windings around the centre.

use glam::DVec3;

use super::{Aim, Approach, Link};
use crate::geodesic::{Lens, Site};
use crate::spacetime::ConformallyFlat;

/// Rays around the centre of a spacetime.
pub struct Lensed<M> {
    medium: M,
    center: DVec3,
    lens: Lens,
    windings: u32,
}

/// An end of a ray around a centre.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LensedPlace {
    /// World position; at infinity the unit direction.
    position: DVec3,
    is_infinite: bool,
    site: Site,
}

/// Relative error of connections: far below what their rays are traced with.
const TOLERANCE: f64 = 1e-5;
/// Largest distance of a ray's end from its target, relative to the distance from the centre: far more than its error
/// and far less than there is between two crossings of a surface.
const NEAR: f64 = 0.01;
/// Least weight, beside that of the near way, of a ray that goes around: it is weak but easily missed otherwise.
const LEAST_AROUND: f64 = 0.02;
/// Weight of rays that go around more than once.
const REMOTE: f64 = 0.01;

impl<M: ConformallyFlat> Lensed<M> {
    /// Rays around `center` with winding numbers up to `max_winding`; `None` if `medium` has no photon sphere.
    pub fn new(medium: M, center: DVec3, max_winding: u32) -> Option<Self> {
        let lens = Lens::new(&medium, TOLERANCE)?;
        Some(Self { medium, center, lens, windings: max_winding + 1 })
    }

    /// True of a place within the horizon, where no ray ends, or upon it.
    fn is_hidden(&self, place: &LensedPlace) -> bool {
        !place.is_infinite && place.position.distance(self.center) <= self.medium.horizon()
    }
}

impl<M: ConformallyFlat> Aim for Lensed<M> {
    type Place = LensedPlace;

    fn place(&self, x: DVec3) -> LensedPlace {
        let site = self.lens.site(&self.medium, x - self.center);
        LensedPlace { position: x, is_infinite: false, site }
    }

    fn infinity(&self, direction: DVec3) -> LensedPlace {
        LensedPlace { position: direction, is_infinite: true, site: Site::infinity(direction) }
    }

    fn windings(&self) -> u32 {
        self.windings
    }

    fn pmf(&self, x: &LensedPlace, y: &LensedPlace, winding: u32) -> f64 {
        let around = self.lens.magnification_ratio(&x.site, &y.site).max(LEAST_AROUND);
        let weight = |winding: u32| match winding {
            0 => 1.0,
            1 => around,
            _ => REMOTE,
        };
        weight(winding) / (0..self.windings).map(weight).sum::<f64>()
    }

    fn approach(&self, x: &LensedPlace, y: &LensedPlace, winding: u32) -> Approach {
        let is_hidden = self.is_hidden(y);
        let distance = if winding == 0 || is_hidden {
            x.position.distance(y.position)
        } else {
            x.position.distance(self.center) + y.position.distance(self.center)
        };
        let direction = if is_hidden {
            (y.position - x.position).normalize_or_zero()
        } else {
            self.lens.estimated_arrival(&x.site, &y.site, winding)
        };
        Approach { distance, direction, is_exact: false }
    }

    fn link(&self, x: &LensedPlace, y: &LensedPlace, winding: u32) -> Option<Link> {
        if self.is_hidden(y) {
            return None;
        }
        let found = self.lens.connect(&x.site, &y.site, winding)?;
        let geometry_factor = found.geometry_factor;
        Some(Link { direction: found.direction, arrival: found.arrival, geometry_factor })
    }

    fn classify(
        &self,
        x: &LensedPlace,
        direction: DVec3,
        y: &LensedPlace,
        arrival: DVec3,
    ) -> Option<(u32, f64)> {
        self.lens.classify(&x.site, direction, &y.site, arrival)
    }

    fn is_reached(&self, at: DVec3, end: DVec3) -> bool {
        at.distance_squared(end) <= NEAR * NEAR * end.distance_squared(self.center)
    }

    fn area_scale(&self, y: &LensedPlace) -> f64 {
        if y.is_infinite {
            return 1.0;
        }
        let w = 1.0 / y.position.distance(self.center);
        self.medium.index_squared(w) * self.medium.lapse(w).powi(2)
    }
}
