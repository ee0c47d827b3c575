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
    pub fn sites<M: ConformallyFlat>(
        &self,
        medium: &M,
        places: impl Iterator<Item = DVec3>,
        mut each: impl FnMut(Site),
    ) {
        let mut places = places.peekable();
        while places.peek().is_some() {
            let (mut offsets, mut count) = (<Offset as Row>::Block::default(), 0);
            for x in places.by_ref().take(LANES) {
                Offset::set(&mut offsets, count, Offset { x });
                count += 1;
            }
            let mut sites = <Site as Row>::Block::default();
            map(&Sites { lens: self, medium }, &[offsets], NOTHING, std::slice::from_mut(&mut sites));
            for lane in 0..count {
                let site = Site::get(&sites, lane);
                let is_good = !self.is_in_tube(&site) && !self.is_near_photon_sphere(&site);
                each(if is_good { site } else { self.site(medium, Offset::get(&offsets, lane).x) });
            }
        }
    }
}
