//! Estimates of rays between two places, at once: how bright they are, and how they arrive.

use std::f64::consts::PI;

use glam::DVec3;

use super::map::{Lens, Site};
use super::track::{StraightLine, straight};
use super::weak_rays::{Winding, WindingBlock};
use crate::math::columns::{LANES, Row, columns};
use crate::math::kernel::{Kernel, NOTHING, map};
use crate::math::{frame, half_turn};

columns! {
    /// Light that goes around, relative to what comes the near way.
    pub struct MagnificationRatio => MagnificationRatioBlock {
        /// The ratio.
        ratio: f64,
    }
}

columns! {
    /// Estimate of how a ray ends.
    pub struct ArrivalEstimate => ArrivalEstimateBlock {
        /// Unit direction of travel.
        direction: DVec3,
    }
}

/// Kernel of [`Lens::magnification_ratio`].
struct EstimatingRatio<'a>(&'a Lens);

/// Kernel of [`Lens::estimated_arrival`].
struct EstimatingArrival<'a>(&'a Lens);

/// Angle between places, radians, up to which a ray is guessed to be bent weakly.
const WEAK: f64 = 2.8;

impl Lens {
    /// The part of the light from a small source at `y` that goes around the far side, relative to what comes the near
    /// way, for a lens that bends rays by 2c/b: exact far from the centre and close to alignment, an estimate
    /// elsewhere.
    ///
    /// The images of a point mass \[Schneider, Ehlers, Falco 1992, "Gravitational Lenses", 2.3\].
    pub fn magnification_ratio(&self, x: &Site, y: &Site) -> f64 {
        EstimatingRatio(self).run(&(*x, *y), &()).ratio
    }

    /// [`Self::magnification_ratio`] of a block.
    #[inline(always)]
    pub fn magnification_ratios(&self, pair: impl Fn(usize) -> (Site, Site)) -> [f64; LANES] {
        let mut ratios = MagnificationRatioBlock::default();
        map(&EstimatingRatio(self), &[pairs(pair)], NOTHING, std::slice::from_mut(&mut ratios));
        std::array::from_fn(|lane| MagnificationRatio::get(&ratios, lane).ratio)
    }

    /// The part of the light from a small source at `y` beyond a throat that goes around the far side, relative to what
    /// comes the near way: an estimate. m − 1 falls as e^−φ, and with it the solid angle that is left.
    pub fn ratio_beyond_throat(&self, x: &Site, y: &Site) -> f64 {
        let angle = half_turn::angle(x.radial.cross(y.radial).length(), x.radial.dot(y.radial));
        libm::exp(2.0 * (angle - PI))
    }

    /// The unit direction in which the ray that [`Self::connect`] finds arrives at `y`, roughly and at once: to first
    /// order in the bending if the ray does not go around, else as the critical ray.
    pub fn estimated_arrival(&self, x: &Site, y: &Site, winding: u32) -> DVec3 {
        EstimatingArrival(self).run(&(*x, *y), &Winding { number: winding }).direction
    }

    /// [`Self::estimated_arrival`] of a block of pairs of places with winding numbers.
    #[inline(always)]
    pub fn estimated_arrivals(
        &self,
        pair: impl Fn(usize) -> (Site, Site),
        winding: impl Fn(usize) -> u32,
    ) -> [DVec3; LANES] {
        let (mut windings, mut arrivals) = (WindingBlock::default(), ArrivalEstimateBlock::default());
        for lane in 0..LANES {
            Winding::set(&mut windings, lane, Winding { number: winding(lane) });
        }
        map(&EstimatingArrival(self), &[pairs(pair)], &[windings], std::slice::from_mut(&mut arrivals));
        std::array::from_fn(|lane| ArrivalEstimate::get(&arrivals, lane).direction)
    }
}

/// A block of pairs of places.
#[inline(always)]
fn pairs(pair: impl Fn(usize) -> (Site, Site)) -> <(Site, Site) as Row>::Block {
    let mut block = <(Site, Site) as Row>::Block::default();
    for lane in 0..LANES {
        <(Site, Site)>::set(&mut block, lane, pair(lane));
    }
    block
}

impl Kernel for EstimatingRatio<'_> {
    type A = (Site, Site);
    type B = ();
    type Out = MagnificationRatio;

    #[inline(always)]
    fn run(&self, (x, y): &(Site, Site), (): &()) -> MagnificationRatio {
        let (spin, along) = (x.radial.cross(y.radial).length(), x.radial.dot(y.radial));
        let off = half_turn::angle(spin, -along);
        // b²/f − b off − 2c = 0, whose roots are the impact parameters of the two images.
        let root = (off * off + 8.0 * self.0.weak * self.0.critical * (x.w + y.w)).sqrt();
        let ratio = (root - off) / (root + off);
        MagnificationRatio { ratio: ratio * ratio }
    }
}

impl Kernel for EstimatingArrival<'_> {
    type A = (Site, Site);
    type B = Winding;
    type Out = ArrivalEstimate;

    #[inline(always)]
    fn run(&self, (x, y): &(Site, Site), &Winding { number }: &Winding) -> ArrivalEstimate {
        let (spin, cos) = (x.radial.cross(y.radial), x.radial.dot(y.radial));
        let sin = spin.length();
        let angle = half_turn::angle(sin, cos);
        let is_aligned = sin == 0.0;
        let axis = pick(is_aligned, x.radial.cross(frame::tangents(x.radial).0), spin / sin);
        let sense = if number % 2 == 1 { -1.0 } else { 1.0 };
        let along = (sense * axis).cross(y.radial);
        let is_reversed = y.q > x.q;
        let near = if is_reversed { *y } else { *x };
        let far = if is_reversed { *x } else { *y };
        let gamma = self.0.guess(&near, &far, angle, sin / (1.0 + cos));
        let is_weak = (number == 0) & (far.s > 0.0) & (near.s > 0.0) & (gamma > 0.0) & (angle < WEAK);
        let StraightLine { leaving, arriving, .. } = straight(&near, &far, gamma);
        let weak = if is_reversed { [-leaving[0], leaving[1]] } else { arriving };
        let critical_sin = (self.0.critical * y.q).min(1.0);
        let critical_cos = (1.0 - critical_sin * critical_sin).sqrt().copysign(y.s);
        let cos = if is_weak { weak[0] } else { critical_cos };
        let sin = if is_weak { weak[1] } else { critical_sin };
        let towards = cos * y.radial + sin * along;
        let per_length = 1.0 / towards.length();
        let is_direction = (per_length > 0.0) & (per_length < f64::INFINITY);
        ArrivalEstimate { direction: pick(is_direction, towards * per_length, y.radial) }
    }
}

/// One of two vectors, without a branch.
#[inline(always)]
fn pick(is_first: bool, first: DVec3, second: DVec3) -> DVec3 {
    let pick = |first: f64, second: f64| if is_first { first } else { second };
    DVec3::new(pick(first.x, second.x), pick(first.y, second.y), pick(first.z, second.z))
}
