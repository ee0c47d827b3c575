//! Landings as things at rest around a spinning hole see them.

use glam::DVec3;

use super::flight::SpinningFlight;
use crate::geodesic::kerr::PlacedHole;
use crate::math::columns::{Columns, columns};
use crate::math::kernel::{Kernel, NOTHING, map};
use crate::spacetime::Stretch;
use crate::trace::transport::{Landing, Outcome};

columns! {
    /// Arrival of a ray in the chart.
    pub struct ChartArrival => ChartArrivalBlock {
        /// World position.
        position: DVec3,
        /// Tangent, along the world's axes.
        tangent: DVec3,
    }
}

columns! {
    /// Arrival of a ray in the frame at rest.
    pub struct ArrivalAtRest => ArrivalAtRestBlock {
        /// Unit direction; not finite where nothing can be at rest.
        direction: DVec3,
        /// [`Stretch`] there.
        stretch: DVec3,
    }
}

/// Arrivals, from the chart to the frame at rest.
pub struct ToRest<'a>(pub &'a PlacedHole);

impl Kernel for ToRest<'_> {
    type A = ChartArrival;
    type B = ();
    type Out = ArrivalAtRest;

    #[inline(always)]
    fn run(&self, &ChartArrival { position, tangent }: &ChartArrival, (): &()) -> ArrivalAtRest {
        let PlacedHole { hole, center, mass, .. } = self.0;
        // N of the outgoing chart is that of the ingoing one with the spin reversed, which rays are followed in.
        let (r, n) = hole.spheroidal(self.0.inwards(position - *center) * (1.0 / mass));
        let stretch = Stretch::new(self.0.outwards(n), hole.potential(r, n.z));
        ArrivalAtRest { direction: stretch.stretched(tangent), stretch: stretch.0 }
    }
}

/// Landings on their way to the frame at rest. Its memory is used again from round to round.
#[derive(Default)]
pub struct LandingsAtRest {
    /// Lanes and their landings in the chart.
    pub landings: Vec<(usize, Landing)>,
    arrivals: Columns<ChartArrival>,
    at_rest: Columns<ArrivalAtRest>,
}

fn in_chart(landing: &Landing) -> ChartArrival {
    ChartArrival { position: landing.position, tangent: landing.direction }
}

/// What reaches into the ergosphere in spite of the scene's checks takes the ray with it.
fn landed(landing: &Landing, at_rest: ArrivalAtRest) -> Outcome<SpinningFlight> {
    let ArrivalAtRest { direction, stretch } = at_rest;
    if !direction.is_finite() {
        return Outcome::Captured;
    }
    Outcome::Landed(Landing { direction, stretch: Stretch(stretch), ..*landing })
}

/// Landing in the frame at rest, from one in the chart.
pub fn land_at_rest(place: &PlacedHole, landing: &Landing) -> Outcome<SpinningFlight> {
    landed(landing, ToRest(place).run(&in_chart(landing), &()))
}

/// [`land_at_rest`] for many, lane beside lane; `each` is told what becomes of a lane's ray.
pub fn land_all_at_rest(
    place: &PlacedHole,
    landings: &mut LandingsAtRest,
    mut each: impl FnMut(usize, Outcome<SpinningFlight>),
) {
    let LandingsAtRest { landings, arrivals, at_rest } = landings;
    let lanes = landings.len();
    arrivals.gather(lanes, |i| in_chart(&landings[i].1));
    at_rest.resize(lanes);
    map(&ToRest(place), arrivals.blocks(lanes), NOTHING, at_rest.blocks_mut(lanes));
    for (i, (lane, landing)) in landings.drain(..).enumerate() {
        each(lane, landed(&landing, at_rest.get(i)));
    }
}
