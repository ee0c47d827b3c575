//! Hits of a round, sorted by where their rays land: on the arc that was searched, or on the ray itself.

use super::land_on_arc::ArcLandings;
use super::land_on_ray::RayLandings;
use crate::geometry::Finds;
use crate::math::columns::Row;

/// Sorts what the lanes found: on the arc lands what need not land `exactly`, and where the arc `is_close` to the ray.
pub fn sort_hits<S: Row>(
    (found, exactly): (&Finds, &[bool]),
    is_close: impl Fn(usize) -> bool,
    on_arcs: &mut ArcLandings,
    on_rays: &mut RayLandings<S>,
) {
    on_rays.hits.clear();
    on_arcs.hits.clear();
    for (lane, found) in found.iter() {
        let stays = !exactly[lane] || is_close(lane);
        let hits = if stays { &mut on_arcs.hits } else { &mut on_rays.hits };
        hits.push((lane, found));
    }
}
