//! How light finds its way from one place to another: straight, or through a lens.

use glam::DVec3;

use crate::geodesic::{Lens, Site};
use crate::spacetime::ConformallyFlat;

/// A place that light comes from or goes to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// World position; for a place at infinity the unit direction to it.
    pub position: DVec3,
    /// Whether the place is at infinity.
    is_infinite: bool,
    site: Site,
}

/// A ray that joins two places.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Link {
    /// Unit direction at the first.
    pub direction: DVec3,
    /// Unit direction of travel at the second.
    pub arrival: DVec3,
    /// Solid angle at the first over the area at the second, perpendicular to the ray, scene units⁻²; over the solid angle
    /// there if it is at infinity.
    pub spread: f64,
}

/// The rays of a spacetime, as light sampling needs them.
pub trait Sight: Send + Sync {
    /// A place in the world.
    fn place(&self, x: DVec3) -> Place;

    /// The place at infinity in a unit direction.
    fn infinity(&self, direction: DVec3) -> Place;

    /// Winding numbers of the rays that are looked for: those below this.
    fn windings(&self) -> u32;

    /// The probability with which a ray of this winding number is to be chosen; all add up to 1.
    fn odds(&self, x: &Place, y: &Place, winding: u32) -> f64;

    /// The ray from `x` to `y` with this winding number.
    fn link(&self, x: &Place, y: &Place, winding: u32) -> Option<Link>;

    /// Roughly the unit direction in which that ray arrives; the same for the same places.
    fn aim(&self, x: &Place, y: &Place, winding: u32) -> DVec3;

    /// Roughly the length of that ray, scene units; the same for the same places.
    fn distance(&self, x: &Place, y: &Place, winding: u32) -> f64;

    /// Winding number and spread of a ray that leaves `x` in `direction` and arrives at `y` travelling along `arrival`.
    fn ray(&self, x: &Place, direction: DVec3, y: &Place, arrival: DVec3) -> Option<(u32, f64)>;

    /// Whether a ray that ends at `end`, on the primitive that it was aimed at, ends where it was aimed at, `at`, rather
    /// than where it meets the same primitive on its way there.
    fn is_there(&self, at: DVec3, end: DVec3) -> bool;

    /// Area in the static frame over area in the chart, at a place.
    fn area_scale(&self, y: &Place) -> f64;

    /// Whether rays are straight, and [`Self::aim`] exact.
    fn is_straight(&self) -> bool;
}

/// Straight rays.
pub struct Straight;

impl Sight for Straight {
    fn place(&self, x: DVec3) -> Place {
        Place { position: x, is_infinite: false, site: Site::default() }
    }

    fn infinity(&self, direction: DVec3) -> Place {
        Place { position: direction, is_infinite: true, site: Site::default() }
    }

    fn windings(&self) -> u32 {
        1
    }

    fn odds(&self, _: &Place, _: &Place, _: u32) -> f64 {
        1.0
    }

    fn link(&self, x: &Place, y: &Place, _: u32) -> Option<Link> {
        if y.is_infinite {
            return Some(Link { direction: y.position, arrival: y.position, spread: 1.0 });
        }
        let offset = y.position - x.position;
        let distance2 = offset.length_squared();
        let direction = offset.try_normalize()?;
        Some(Link { direction, arrival: direction, spread: 1.0 / distance2 })
    }

    fn aim(&self, x: &Place, y: &Place, _: u32) -> DVec3 {
        if y.is_infinite { y.position } else { (y.position - x.position).normalize_or_zero() }
    }

    fn distance(&self, x: &Place, y: &Place, _: u32) -> f64 {
        x.position.distance(y.position)
    }

    fn ray(&self, x: &Place, _: DVec3, y: &Place, _: DVec3) -> Option<(u32, f64)> {
        let spread = if y.is_infinite { 1.0 } else { 1.0 / x.position.distance_squared(y.position) };
        Some((0, spread))
    }

    fn is_there(&self, _: DVec3, _: DVec3) -> bool {
        // What a straight ray meets twice it leaves on the side that is not lit.
        true
    }

    fn area_scale(&self, _: &Place) -> f64 {
        1.0
    }

    fn is_straight(&self) -> bool {
        true
    }
}

/// Rays around the centre of a spacetime.
pub struct Lensed<M> {
    medium: M,
    center: DVec3,
    lens: Lens,
    windings: u32,
}

/// Relative error of connections: far below what their rays are traced with.
const TOLERANCE: f64 = 1e-5;
/// How far from where it was aimed at a ray may end, relative to the distance from the centre: far more than its error
/// and far less than there is between two crossings of a surface.
const NEAR: f64 = 0.01;
/// Weight, beside that of the near way, of a ray that goes around, at least; it is weak but easily missed otherwise.
const LEAST_ODDS: f64 = 0.02;
/// The same of rays that go around more than once.
const REMOTE_ODDS: f64 = 0.01;

impl<M: ConformallyFlat> Lensed<M> {
    /// Rays around `center` with winding numbers up to `max_winding`; `None` if `medium` has no photon sphere.
    pub fn new(medium: M, center: DVec3, max_winding: u32) -> Option<Self> {
        let lens = Lens::new(&medium, TOLERANCE)?;
        Some(Self { medium, center, lens, windings: max_winding + 1 })
    }

    /// Whether a place lies within the horizon, where no ray ends, or upon it.
    fn is_hidden(&self, place: &Place) -> bool {
        !place.is_infinite && place.position.distance(self.center) <= self.medium.horizon()
    }
}

impl<M: ConformallyFlat> Sight for Lensed<M> {
    fn place(&self, x: DVec3) -> Place {
        let site = self.lens.site(&self.medium, x - self.center);
        Place { position: x, is_infinite: false, site }
    }

    fn infinity(&self, direction: DVec3) -> Place {
        Place { position: direction, is_infinite: true, site: Site::infinity(direction) }
    }

    fn windings(&self) -> u32 {
        self.windings
    }

    fn odds(&self, x: &Place, y: &Place, winding: u32) -> f64 {
        let around = self.lens.odds(&x.site, &y.site).max(LEAST_ODDS);
        let weight = |winding: u32| match winding {
            0 => 1.0,
            1 => around,
            _ => REMOTE_ODDS,
        };
        weight(winding) / (0..self.windings).map(weight).sum::<f64>()
    }

    fn link(&self, x: &Place, y: &Place, winding: u32) -> Option<Link> {
        if self.is_hidden(y) {
            return None;
        }
        let found = self.lens.connect(&x.site, &y.site, winding)?;
        Some(Link { direction: found.direction, arrival: found.arrival, spread: found.spread })
    }

    fn aim(&self, x: &Place, y: &Place, winding: u32) -> DVec3 {
        if self.is_hidden(y) {
            return (y.position - x.position).normalize_or_zero();
        }
        self.lens.aim(&x.site, &y.site, winding)
    }

    fn distance(&self, x: &Place, y: &Place, winding: u32) -> f64 {
        if winding == 0 || self.is_hidden(y) {
            return x.position.distance(y.position);
        }
        x.position.distance(self.center) + y.position.distance(self.center)
    }

    fn ray(&self, x: &Place, direction: DVec3, y: &Place, arrival: DVec3) -> Option<(u32, f64)> {
        self.lens.ray(&x.site, direction, &y.site, arrival)
    }

    fn is_there(&self, at: DVec3, end: DVec3) -> bool {
        at.distance_squared(end) <= NEAR * NEAR * end.distance_squared(self.center)
    }

    fn area_scale(&self, y: &Place) -> f64 {
        if y.is_infinite {
            return 1.0;
        }
        let w = 1.0 / y.position.distance(self.center);
        self.medium.index_squared(w) * self.medium.lapse(w).powi(2)
    }

    fn is_straight(&self) -> bool {
        false
    }
}
