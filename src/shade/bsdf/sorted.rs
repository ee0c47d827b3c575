//! Hits on one lobe, scattered lane beside lane.

use std::marker::PhantomData;

use glam::DVec3;

use super::model::Bsdf;
use crate::math::columns::{Columns, columns, plain_field};
use crate::math::kernel::{Kernel, map};
use crate::shade::incidence::{Bounce, Incidence, Response};

plain_field!([f32; 4]);

columns! {
    /// Query to a lobe where it is hit.
    pub struct LobeQuery => LobeQueryBlock {
        /// Four numbers in [0, 1) for a continuation.
        u: [f32; 4],
        /// Unit direction to be evaluated; zero if there is none.
        out: DVec3,
    }
}

/// Hits on lobes of one kind.
pub(super) struct HitsOn<L: Bsdf> {
    /// Numbers of the hits.
    numbers: Vec<usize>,
    hits: Columns<(L, Incidence)>,
    queries: Columns<LobeQuery>,
    scattered: Columns<(Bounce, Response)>,
}

impl<L: Bsdf> Default for HitsOn<L> {
    fn default() -> Self {
        let (hits, queries, scattered) = (Columns::default(), Columns::default(), Columns::default());
        Self { numbers: Vec::new(), hits, queries, scattered }
    }
}

impl<L: Bsdf> HitsOn<L> {
    #[inline(always)]
    pub fn push(&mut self, number: usize, lobe: &L, incidence: &Incidence, u: [f32; 4]) {
        let lane = self.numbers.len();
        self.numbers.push(number);
        self.hits.grow(lane + 1);
        self.queries.grow(lane + 1);
        self.hits.set(lane, (*lobe, *incidence));
        self.queries.set(lane, LobeQuery { u, out: DVec3::ZERO });
    }

    /// Scatters the hits, evaluated towards `out` by number, calls `each` with what comes of them, and forgets them.
    pub fn scatter(&mut self, out: impl Fn(usize) -> DVec3, each: &mut dyn FnMut(usize, &Bounce, &Response)) {
        let lanes = self.numbers.len();
        for (lane, &number) in self.numbers.iter().enumerate() {
            self.queries.set(lane, LobeQuery { out: out(number), ..self.queries.get(lane) });
        }
        self.scattered.grow(lanes);
        let (hits, queries) = (self.hits.blocks(lanes), self.queries.blocks(lanes));
        map(&Scatter::<L>(PhantomData), hits, queries, self.scattered.blocks_mut(lanes));
        for (lane, number) in self.numbers.drain(..).enumerate() {
            let (bounce, response) = self.scattered.get(lane);
            each(number, &bounce, &response);
        }
    }
}

/// Kernel of a lobe.
struct Scatter<L>(PhantomData<L>);

impl<L: Bsdf> Kernel for Scatter<L> {
    type A = (L, Incidence);
    type B = LobeQuery;
    type Out = (Bounce, Response);

    #[inline(always)]
    fn run(&self, (lobe, incidence): &(L, Incidence), query: &LobeQuery) -> (Bounce, Response) {
        lobe.scatter(incidence, query.u, query.out)
    }
}
