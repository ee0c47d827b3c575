//! Places as a lens sees them, many side by side.

use glam::DVec3;

use super::map::{Lens, Site};
use crate::math::columns::{LANES, Row, columns};
use crate::math::kernel::{Kernel, NOTHING, map};
use crate::spacetime::ConformallyFlat;

columns! {
    /// A place relative to the centre.
    pub struct Offset => OffsetBlock {
        /// From the centre to it.
        x: DVec3,
    }
}

/// Kernel of [`Lens::rough_site`].
struct Sites<'a, M> {
    lens: &'a Lens,
    medium: &'a M,
}

impl<M: ConformallyFlat> Kernel for Sites<'_, M> {
    type A = Offset;
    type B = ();
    type Out = Site;

    #[inline(always)]
    fn run(&self, &Offset { x }: &Offset, (): &()) -> Site {
        self.lens.rough_site(self.medium, x)
    }
}

impl Lens {
    /// [`Self::site`] of many places: calls `each` for every one.
    pub fn sites<M: ConformallyFlat>(&self, medium: &M, places: &[DVec3], mut each: impl FnMut(usize, Site)) {
        for (number, places) in places.chunks(LANES).enumerate() {
            let (mut offsets, mut sites) = (OffsetBlock::default(), <Site as Row>::Block::default());
            for (lane, &x) in places.iter().enumerate() {
                Offset::set(&mut offsets, lane, Offset { x });
            }
            map(&Sites { lens: self, medium }, &[offsets], NOTHING, std::slice::from_mut(&mut sites));
            for (lane, &x) in places.iter().enumerate() {
                let site = Site::get(&sites, lane);
                let is_good = !self.is_in_tube(&site) && !self.is_near_photon_sphere(&site);
                each(number * LANES + lane, if is_good { site } else { self.site(medium, x) });
            }
        }
    }
}
