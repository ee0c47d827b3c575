//! Widths of narrow beams along rays that are bent weakly, many side by side.
//!
//! [`Lens::beam_widths`] in straight-line code; where bending is not weak, that is asked.

use glam::DVec3;

use super::connection::{AROUND, RADIAL};
use super::map::{Lens, Site};
use super::track::straight;
use super::weak_rays::WeakRays;
use crate::math::columns::{LANES, Row, columns};
use crate::math::half_turn;
use crate::math::kernel::{Kernel, map};
use crate::math::real::Real;
use crate::math::sin_cos_turns;

columns! {
    /// Directions of a ray at its ends.
    pub struct RayDirections => RayDirectionsBlock {
        /// Unit direction in which it leaves.
        leaving: DVec3,
        /// Unit direction of travel in which it arrives.
        arriving: DVec3,
    }
}

columns! {
    /// Widths of a narrow beam over its angle.
    pub struct BeamWidths => BeamWidthsBlock {
        /// In the plane of its orbit.
        along: f64,
        /// Out of that.
        across: f64,
    }
}

/// Kernel of beams; NaN where they are not bent weakly.
struct WeakBeams<'a>(WeakRays<'a>);

impl Lens {
    /// [`Self::beam_widths`] of many rays, by the places and directions of their ends: calls `each` for every one, in
    /// order.
    pub fn all_beam_widths(
        &self,
        rays: &[(Site, Site, RayDirections)],
        mut each: impl FnMut(usize, Option<[f64; 2]>),
    ) {
        let alone = |(x, y, RayDirections { leaving, arriving }): &(Site, Site, RayDirections)| {
            self.beam_widths(x, *leaving, y, *arriving)
        };
        let Some(bending) = &self.bending else {
            return rays.iter().enumerate().for_each(|(number, ray)| each(number, alone(ray)));
        };
        let kernel = WeakBeams(WeakRays { lens: self, bending });
        let either = |BeamWidths { along, across }: BeamWidths, ray: &(Site, Site, RayDirections)| {
            if along > 0.0 { Some([along, across]) } else { alone(ray) }
        };
        // Pixel by pixel there is but one: the lanes beside it would cost as much.
        if let [ray @ (x, y, directions)] = rays {
            return each(0, either(kernel.run(&(*x, *y), directions), ray));
        }
        for (number, rays) in rays.chunks(LANES).enumerate() {
            let (mut sites, mut ends) =
                (<(Site, Site) as Row>::Block::default(), RayDirectionsBlock::default());
            for (lane, &(x, y, directions)) in rays.iter().enumerate() {
                <(Site, Site)>::set(&mut sites, lane, (x, y));
                RayDirections::set(&mut ends, lane, directions);
            }
            let mut widths = BeamWidthsBlock::default();
            map(&kernel, &[sites], &[ends], std::slice::from_mut(&mut widths));
            for (lane, ray) in rays.iter().enumerate() {
                each(number * LANES + lane, either(BeamWidths::get(&widths, lane), ray));
            }
        }
    }
}

impl Kernel for WeakBeams<'_> {
    type A = (Site, Site);
    type B = RayDirections;
    type Out = BeamWidths;

    #[inline(always)]
    fn run(&self, (x, y): &(Site, Site), &RayDirections { leaving, arriving }: &RayDirections) -> BeamWidths {
        let is_reversed = y.q > x.q;
        let near = if is_reversed { *y } else { *x };
        let far = if is_reversed { *x } else { *y };
        let b = x.radial.cross(leaving).length().at_least(RADIAL) / x.q;
        let outwards = if is_reversed { -arriving.dot(y.radial) } else { leaving.dot(x.radial) };
        let [near_sin, far_sin] = [(b * near.q).at_most(1.0), (b * far.q).at_most(1.0)];
        let [near_cos, far_cos] = [near_sin, far_sin].map(|sin| (1.0 - sin * sin).sqrt());
        let near_cos = if outwards < 0.0 { -near_cos } else { near_cos };
        let gamma = half_turn::angle(near_sin, near_cos) - half_turn::angle(far_sin, far_cos);
        let gamma = gamma.at_least(RADIAL);
        let trial = self.0.at(&near, &far, gamma);
        let line = straight(&near, &far, gamma);
        let (half_sin, half_cos) = sin_cos_turns::small(0.5 * trial.swept.at_most(AROUND));
        let sine =
            if trial.swept < AROUND { 2.0 * half_sin * half_cos } else { x.radial.cross(y.radial).length() };
        let rate = trial.slope * line.distance;
        let is_outside = (x.s > 0.0) & (y.s > 0.0) & (x.depth == y.depth);
        let along = rate / (x.q * y.w);
        BeamWidths {
            along: if is_outside & trial.is_known { along } else { f64::NAN },
            across: sine / (line.b * x.q * y.w),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::offsets_from;
    use super::*;
    use crate::spacetime::Schwarzschild;

    #[test]
    fn beams_side_by_side_are_as_wide_as_each_alone() {
        let hole = Schwarzschild::new(1.0);
        let lens = Lens::new(&hole, 1e-5).expect("a photon sphere");
        let mut offset = offsets_from(hole);
        let mut place = || lens.site(&hole, offset());
        let ray = |i: u32| {
            let (x, y) = (place(), place());
            let ray = lens.connect(&x, &y, u32::from(i.is_multiple_of(8))).expect("a ray");
            (x, y, RayDirections { leaving: ray.direction, arriving: ray.arrival })
        };
        let rays: Vec<_> = (0..20_000).map(ray).collect();
        let (mut worst, mut side_by_side) = (0.0f64, 0);
        lens.all_beam_widths(&rays, |number, found| {
            let (x, y, RayDirections { leaving, arriving }) = &rays[number];
            let (found, alone) = (found.expect("widths"), lens.beam_widths(x, *leaving, y, *arriving));
            let alone = alone.expect("widths");
            side_by_side += usize::from(found != alone);
            for (found, alone) in found.iter().zip(alone) {
                worst = worst.max((found / alone - 1.0).abs());
            }
        });
        // To rounding, which tells them apart.
        assert!(worst < 1e-10 && 20 * side_by_side > rays.len(), "{worst}, {side_by_side}");
    }
}
