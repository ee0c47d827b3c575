//! Worlds of curved rays: one, or the two that a wormhole joins, each with its centre and the bounds of its geometry.

use glam::DVec3;

use crate::geodesic::Arc;
use crate::geometry::{Geometry, PrimitiveId};
use crate::light::Lensed;
use crate::spacetime::{ConformallyFlat, Mouths, Side};

/// A world around the centre of a spacetime.
#[derive(Clone, Copy, Debug)]
pub struct OneWorld {
    /// OneWorld position of the centre.
    pub center: DVec3,
    /// OneWorld bounds of the geometry; arcs outside are not searched.
    bounds: (DVec3, DVec3),
    /// Arcs with a larger sagitta are searched in halves: a thick chord meets too many boxes. Infinite without boxes.
    longest_sagitta: f64,
    /// Longer arcs are searched in halves: beside them, the geometry would drown in their rounding.
    longest_chord: f64,
}

/// Two worlds that a throat joins.
#[derive(Clone, Copy, Debug)]
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

    /// OneWorld of rays that start on a primitive, or in free space on its side.
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

/// Longest chord of a searched arc, relative to the diagonal of the geometry.
const CHORD: f64 = 8.0;
/// Largest sagitta of a searched arc, relative to the median primitive.
const SAGITTA: f64 = 1.0;
/// Most times that an arc is halved because of its sagitta.
const MOST_FOR_SAGITTA: u32 = 8;
/// Most times that an arc is halved because of its length.
const MOST_FOR_LENGTH: u32 = 60;

impl OneWorld {
    /// A world about `center`, with this geometry if any, for arcs within `arc_tolerance` of their rays.
    pub fn new(center: DVec3, geometry: Option<&Geometry>, arc_tolerance: f64) -> Self {
        let bounds = geometry.and_then(Geometry::bounds);
        let (low, high) = bounds.unwrap_or((DVec3::INFINITY, DVec3::NEG_INFINITY));
        let boxes = geometry.filter(|geometry| !geometry.is_small::<Arc>());
        let longest_sagitta = boxes
            .map_or(f64::INFINITY, |geometry| (4.0 * arc_tolerance).max(SAGITTA * geometry.typical_extent()));
        Self { center, bounds: (low, high), longest_sagitta, longest_chord: CHORD * low.distance(high) }
    }

    /// False for an arc that is outside the bounds of the geometry.
    #[inline(always)]
    pub fn may_meet(&self, arc: &Arc) -> bool {
        let (min, max) = self.bounds;
        let (low, high) = (arc.p0.min(arc.p1).min(arc.p2), arc.p0.max(arc.p1).max(arc.p2));
        let within = |low: f64, high: f64, min: f64, max: f64| (low <= max) & (high >= min);
        within(low.x, high.x, min.x, max.x)
            & within(low.y, high.y, min.y, max.y)
            & within(low.z, high.z, min.z, max.z)
    }

    /// True if an arc is to be searched in halves, after it has been halved so often.
    #[inline(always)]
    pub fn is_split(&self, arc: &Arc, halvings: u32) -> bool {
        let length2 = arc.p0.distance_squared(arc.p2);
        ((halvings < MOST_FOR_SAGITTA) & (arc.sagitta() > self.longest_sagitta))
            | ((halvings < MOST_FOR_LENGTH) & (length2 > self.longest_chord * self.longest_chord))
    }
}
