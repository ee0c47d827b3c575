//! Worlds of curved rays: one, or the two that a wormhole joins, each with its centre and its geometry.

use glam::DVec3;

use crate::geometry::PrimitiveId;
use crate::light::Lensed;
use crate::spacetime::{ConformallyFlat, Mouths, Side};
use crate::trace::arc_sweep::ArcSweep;

/// A world around the centre of a spacetime.
pub struct OneWorld {
    /// World position of the centre.
    pub center: DVec3,
    /// Search along arcs in it.
    pub sweep: ArcSweep,
}

/// Two worlds that a throat joins.
pub struct TwoWorlds {
    /// The world of `center`.
    pub near: OneWorld,
    /// The world of `far_center`.
    pub far: OneWorld,
    /// Way from one to the other.
    pub mouths: Mouths,
    /// Isotropic radius of the throat.
    pub throat: f64,
}

/// Throat to another world.
#[derive(Clone, Copy, Debug)]
pub struct Throat<'a> {
    /// Way to the other world.
    pub mouths: &'a Mouths,
    /// Isotropic radius.
    pub radius: f64,
}

/// The worlds that rays move in around `M`.
pub trait Worlds<M>: Send + Sync {
    /// Aim of light samples in them, with winding numbers up to `max_winding`; `None` if it finds no rays around `medium`.
    fn aim(&self, medium: M, max_winding: u32) -> Option<Lensed<M>>;

    /// World of rays that start on a primitive, or in free space on its side.
    fn of(&self, origin_prim: PrimitiveId) -> &OneWorld;

    /// Throat that joins them; `None` if there is but one.
    fn throat(&self) -> Option<Throat<'_>>;
}

impl<M: ConformallyFlat> Worlds<M> for OneWorld {
    fn aim(&self, medium: M, max_winding: u32) -> Option<Lensed<M>> {
        Lensed::new(medium, self.center, max_winding)
    }

    #[inline(always)]
    fn of(&self, _: PrimitiveId) -> &OneWorld {
        self
    }

    #[inline(always)]
    fn throat(&self) -> Option<Throat<'_>> {
        None
    }
}

impl<M: ConformallyFlat> Worlds<M> for TwoWorlds {
    fn aim(&self, medium: M, max_winding: u32) -> Option<Lensed<M>> {
        Lensed::through(medium, self.mouths, max_winding)
    }

    #[inline(always)]
    fn of(&self, origin_prim: PrimitiveId) -> &OneWorld {
        match origin_prim.side() {
            Side::Near => &self.near,
            Side::Far => &self.far,
        }
    }

    #[inline(always)]
    fn throat(&self) -> Option<Throat<'_>> {
        Some(Throat { mouths: &self.mouths, radius: self.throat })
    }
}
