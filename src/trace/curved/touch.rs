//! Landings where arcs are met that stand for their rays.

use glam::DVec3;

use super::{Curved, CurvedFlight, CurvedMove, Lane};
use crate::geodesic::Arc;
use crate::geometry::Found;
use crate::math::columns::{Columns, columns};
use crate::math::kernel::{Kernel, map};
use crate::spacetime::ConformallyFlat;
use crate::trace::transport::Landing;

columns! {
    /// A point beside an arc.
    pub struct Beside => BesideBlock {
        /// World position.
        point: DVec3,
    }
}

columns! {
    /// The way of an arc.
    pub struct Heading => HeadingBlock {
        /// Unit vector.
        direction: DVec3,
    }
}

/// Which way an arc goes beside a point.
pub struct Touching;

impl Kernel for Touching {
    type A = Arc;
    type B = Beside;
    type Out = Heading;

    #[inline(always)]
    fn run(&self, arc: &Arc, beside: &Beside) -> Heading {
        let velocity = arc.velocity(arc.parameter_beside(beside.point));
        Heading { direction: velocity / velocity.length() }
    }
}

/// Hits to be taken where they are. Its memory is used again from round to round.
#[derive(Default)]
pub struct Touches {
    /// Lanes and what they meet.
    pub hits: Vec<(usize, Found)>,
    arcs: Columns<Arc>,
    points: Columns<Beside>,
    headings: Columns<Heading>,
}

impl<M: ConformallyFlat, R: Lane> Curved<M, R> {
    /// Where a ray lands that stays on its arc.
    pub(super) fn touch(&self, flight: &CurvedFlight<R>, step: &CurvedMove<R>, found: Found) -> Landing {
        let Found { point: position, primitive } = found;
        let Heading { direction } = Touching.run(&self.arc(flight, step), &Beside { point: position });
        Landing { position, direction, primitive }
    }

    /// The same for many, lane beside lane; `each` is told where the ray of a lane lands.
    pub(super) fn touch_all(
        &self,
        flights: &Columns<CurvedFlight<R>>,
        moves: &Columns<CurvedMove<R>>,
        touches: &mut Touches,
        mut each: impl FnMut(usize, Landing),
    ) {
        let Touches { hits, arcs, points, headings } = touches;
        let lanes = hits.len();
        arcs.gather(lanes, |i| self.arc(&flights.get(hits[i].0), &moves.get(hits[i].0)));
        points.gather(lanes, |i| Beside { point: hits[i].1.point });
        headings.resize(lanes);
        map(&Touching, arcs.blocks(lanes), points.blocks(lanes), headings.blocks_mut(lanes));
        for (i, &(lane, Found { point: position, primitive })) in hits.iter().enumerate() {
            each(lane, Landing { position, direction: headings.get(i).direction, primitive });
        }
    }
}
