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
    /// [`Self::site`] of a block of places.
    #[inline(always)]
    pub fn sites<M: ConformallyFlat>(
        &self,
        medium: &M,
        place: impl Fn(usize) -> DVec3,
    ) -> <Site as Row>::Block {
        let (mut offsets, mut sites) = (OffsetBlock::default(), <Site as Row>::Block::default());
        for lane in 0..LANES {
            Offset::set(&mut offsets, lane, Offset { x: place(lane) });
        }
        map(&Sites { lens: self, medium }, &[offsets], NOTHING, std::slice::from_mut(&mut sites));
        for lane in 0..LANES {
            let site = Site::get(&sites, lane);
            if self.is_in_tube(&site) || self.is_near_photon_sphere(&site) {
                Site::set(&mut sites, lane, self.site(medium, place(lane)));
            }
        }
        sites
    }
}
