//! Searches along arcs: none where there is no geometry, in pieces where an arc is thick or long.

use glam::DVec3;

use crate::geodesic::Arc;
use crate::geometry::{Found, Geometry, Need, PrimitiveId, Query};
use crate::scene::Baked;

/// Search along arcs among a scene's geometry.
pub struct ArcSweep {
    /// Arcs with a larger sagitta are searched in halves: a thick chord meets too many boxes. Infinite without boxes.
    longest_sagitta: f64,
    /// Longer arcs are searched in halves: beside them, the geometry would drown in their rounding.
    longest_chord: f64,
    /// World bounds of the geometry; arcs outside are not searched.
    bounds: (DVec3, DVec3),
}

/// Most times that an arc is halved because of its sagitta.
const MOST_FOR_SAGITTA: u32 = 8;
/// Most times that an arc is halved because of its length.
const MOST_FOR_LENGTH: u32 = 60;
/// Longest chord of a searched arc, relative to the diagonal of the geometry.
const CHORD: f64 = 8.0;
/// Largest sagitta of a searched arc, relative to the median primitive.
const SAGITTA: f64 = 1.0;

impl ArcSweep {
    /// Search among the geometry of `scene` along arcs that come as near to their rays as `arc_tolerance`.
    pub fn new(scene: &Baked, arc_tolerance: f64) -> Self {
        Self::among(Some(&scene.geometry), arc_tolerance)
    }

    /// Search among a side's geometry, if there is any.
    pub fn among(geometry: Option<&Geometry>, arc_tolerance: f64) -> Self {
        let bounds = geometry.and_then(Geometry::bounds);
        let (low, high) = bounds.unwrap_or((DVec3::INFINITY, DVec3::NEG_INFINITY));
        let boxes = geometry.filter(|geometry| !geometry.is_small::<Arc>());
        Self {
            longest_sagitta: boxes.map_or(f64::INFINITY, |geometry| {
                (4.0 * arc_tolerance).max(SAGITTA * geometry.typical_extent())
            }),
            longest_chord: CHORD * low.distance(high),
            bounds: (low, high),
        }
    }

    /// False for an arc that is outside the bounds of the geometry.
    #[inline(always)]
    fn may_meet(&self, arc: &Arc) -> bool {
        let (min, max) = self.bounds;
        let (low, high) = (arc.p0.min(arc.p1).min(arc.p2), arc.p0.max(arc.p1).max(arc.p2));
        let within = |low: f64, high: f64, min: f64, max: f64| (low <= max) & (high >= min);
        within(low.x, high.x, min.x, max.x)
            & within(low.y, high.y, min.y, max.y)
            & within(low.z, high.z, min.z, max.z)
    }

    /// Query for the arc of a move that starts on `origin_prim`, if the move `is_searched` at all.
    #[inline(always)]
    pub fn query(&self, segment: Arc, origin_prim: PrimitiveId, is_searched: bool) -> Query<Arc> {
        let whole = if self.is_split(&segment, 0) { Need::Pieces } else { Need::Whole };
        let may = is_searched & self.may_meet(&segment);
        Query { segment, origin_prim, need: if may { whole } else { Need::Nothing } }
    }

    /// Searches an arc, in halves if it is thick or long beside the geometry.
    pub fn search<F>(
        &self,
        arc: &Arc,
        origin_prim: PrimitiveId,
        halvings: u32,
        search: &mut F,
    ) -> Option<Found>
    where
        F: FnMut(&Arc, PrimitiveId) -> Option<Found>,
    {
        if !self.may_meet(arc) {
            return None;
        }
        if self.is_split(arc, halvings) {
            let (left, right) = arc.halves();
            let first = self.search(&left, origin_prim, halvings + 1, search);
            return first.or_else(|| self.search(&right, origin_prim.none_beside(), halvings + 1, search));
        }
        search(arc, origin_prim)
    }

    /// True if an arc is to be searched in halves, after it has been halved so often.
    #[inline(always)]
    fn is_split(&self, arc: &Arc, halvings: u32) -> bool {
        let length2 = arc.p0.distance_squared(arc.p2);
        ((halvings < MOST_FOR_SAGITTA) & (arc.sagitta() > self.longest_sagitta))
            | ((halvings < MOST_FOR_LENGTH) & (length2 > self.longest_chord * self.longest_chord))
    }
}
