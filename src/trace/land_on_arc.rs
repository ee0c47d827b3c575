//! Landings on the arc that was searched, where it is as good as the ray.

use glam::DVec3;

use super::transport::Landing;
use crate::geodesic::Arc;
use crate::geometry::Found;
use crate::math::columns::{Columns, columns};
use crate::math::kernel::{Kernel, map};

columns! {
    /// A point beside an arc.
    pub struct ArcPoint => ArcPointBlock {
        /// World position.
        point: DVec3,
    }
}

columns! {
    /// Direction of an arc.
    pub struct Heading => HeadingBlock {
        /// Unit vector.
        direction: DVec3,
    }
}

/// Direction of an arc beside a point.
pub struct Directing;

impl Kernel for Directing {
    type A = Arc;
    type B = ArcPoint;
    type Out = Heading;

    #[inline(always)]
    fn run(&self, arc: &Arc, beside: &ArcPoint) -> Heading {
        let velocity = arc.velocity(arc.parameter_beside(beside.point));
        Heading { direction: velocity / velocity.length() }
    }
}

/// Hits to be taken where the arcs meet them. Its memory is used again from round to round.
#[derive(Default)]
pub struct ArcLandings {
    /// Lanes and what they meet.
    pub hits: Vec<(usize, Found)>,
    arcs: Columns<Arc>,
    points: Columns<ArcPoint>,
    headings: Columns<Heading>,
}

/// Landing of a ray that stays on its arc.
pub fn land_on_arc(arc: &Arc, found: Found) -> Landing {
    let Found { point: position, primitive } = found;
    let Heading { direction } = Directing.run(arc, &ArcPoint { point: position });
    Landing::conformal(position, direction, primitive)
}

/// [`land_on_arc`] for many, lane beside lane, given the arc of each; `each` is told where the ray of a lane lands.
pub fn land_all_on_arcs(
    landings: &mut ArcLandings,
    arc: impl Fn(usize) -> Arc,
    mut each: impl FnMut(usize, Landing),
) {
    let ArcLandings { hits, arcs, points, headings } = landings;
    let lanes = hits.len();
    arcs.gather(lanes, |i| arc(hits[i].0));
    points.gather(lanes, |i| ArcPoint { point: hits[i].1.point });
    headings.resize(lanes);
    map(&Directing, arcs.blocks(lanes), points.blocks(lanes), headings.blocks_mut(lanes));
    for (i, &(lane, Found { point: position, primitive })) in hits.iter().enumerate() {
        each(lane, Landing::conformal(position, headings.get(i).direction, primitive));
    }
}
