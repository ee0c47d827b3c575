//! Aim: rays that join two places, for light sampling.
//!
//! A family of spacetimes brings its own: the data of a place ([`Aim::Place`]) and the rays that join two of them. All
//! of it is deterministic, so that a ray found by BSDF sampling has the density with which it could have been chosen.
//!
//! To add one, implement [`Aim`] in a file beside [`straight`] and [`lensed`], and name it in the transport of its
//! family.

pub mod beams;
pub mod field;
pub mod lensed;
pub mod straight;

use glam::DVec3;

use crate::math::columns::LANES;
use crate::spacetime::{AtInfinity, Side};

/// A ray that joins two places.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Link {
    /// Unit direction at the first.
    pub direction: DVec3,
    /// Unit direction of travel at the second.
    pub arrival: DVec3,
    /// Solid angle at the first over the area at the second, perpendicular to the ray, scene units⁻²; over the solid
    /// angle there if it is at infinity.
    pub geometry_factor: f64,
}

/// Estimate of how a ray arrives; a function of its ends and winding number alone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Approach {
    /// Length of the ray, scene units.
    pub distance: f64,
    /// Unit direction of travel at its end.
    pub direction: DVec3,
    /// True if both are exact; an estimate misses parts of what can be seen.
    pub is_exact: bool,
}

/// Rays of a family of spacetimes between a receiver `x` and a place `y` of light, numbered by how they wind.
pub trait Aim: Send + Sync {
    /// A place in the world or at infinity, with what is computed once for all rays to and from it.
    type Place: Copy;
    /// True if places and rays are found faster side by side, a block of lanes at a time.
    const SIDE_BY_SIDE: bool;

    /// A place in the world of a side.
    fn place(&self, side: Side, x: DVec3) -> Self::Place;

    /// [`Self::place`] of a block.
    #[inline(always)]
    fn places(&self, at: impl Fn(usize) -> (Side, DVec3)) -> [Self::Place; LANES] {
        std::array::from_fn(|lane| {
            let (side, x) = at(lane);
            self.place(side, x)
        })
    }

    /// A place at infinity.
    fn infinity(&self, there: AtInfinity) -> Self::Place;

    /// Count of winding numbers that are sampled: from 0 on.
    fn windings(&self) -> u32;

    /// Weight of a ray that goes around, beside that of the near way.
    fn around(&self, x: &Self::Place, y: &Self::Place) -> f64;

    /// [`Self::around`] of a block.
    fn arounds(&self, x: &[Self::Place; LANES], y: &[Self::Place; LANES]) -> [f64; LANES] {
        std::array::from_fn(|lane| self.around(&x[lane], &y[lane]))
    }

    /// Position of an onlooker to whom all rays are straight; `None` where they are not.
    fn straight_from(&self, _x: &Self::Place) -> Option<DVec3> {
        None
    }

    /// Estimate of the ray with this winding number.
    fn approach(&self, x: &Self::Place, y: &Self::Place, winding: u32) -> Approach;

    /// [`Self::approach`] of the lanes of a block for which there is a winding number.
    #[inline(always)]
    fn approaches(
        &self,
        x: &[Self::Place; LANES],
        y: &[Self::Place; LANES],
        winding: impl Fn(usize) -> Option<u32>,
    ) -> [Option<Approach>; LANES] {
        std::array::from_fn(|lane| Some(self.approach(&x[lane], &y[lane], winding(lane)?)))
    }

    /// The ray with this winding number; `None` if there is none.
    fn link(&self, x: &Self::Place, y: &Self::Place, winding: u32) -> Option<Link>;

    /// [`Self::link`] of the pairs of places with winding numbers that fill a block at most.
    fn links(&self, pairs: &[(Self::Place, Self::Place, u32)]) -> [Option<Link>; LANES] {
        std::array::from_fn(|lane| {
            let (x, y, winding) = pairs.get(lane)?;
            self.link(x, y, *winding)
        })
    }

    /// Winding number and geometry factor of a ray that leaves `x` in `direction` and arrives at `y` travelling along
    /// `arrival`.
    fn classify(
        &self,
        x: &Self::Place,
        direction: DVec3,
        y: &Self::Place,
        arrival: DVec3,
    ) -> Option<(u32, f64)>;

    /// True if a ray that ends at `end`, on the primitive that it was aimed at, on this side, ends where it was aimed at,
    /// `at`, rather than where it meets the same primitive on its way there.
    fn is_reached(&self, side: Side, at: DVec3, end: DVec3) -> bool;

    /// Area in the static frame over area in the chart, at a place.
    fn area_scale(&self, y: &Self::Place) -> f64;
}
