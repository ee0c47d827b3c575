//! Hits on one lobe: scattered lane beside lane, or one after the other where a lobe chooses among many parts.

use std::marker::PhantomData;

use glam::DVec3;

use super::model::Bsdf;
use crate::math::columns::{Columns, Row, columns, plain_field};
use crate::math::kernel::{Kernel, map, widest};
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

/// Hits on lobes of one kind, scattered lane beside lane.
pub(super) struct HitLanes<L: Bsdf + Row> {
    /// Numbers of the hits.
    numbers: Vec<usize>,
    hits: Columns<(L, Incidence)>,
    queries: Columns<LobeQuery>,
    scattered: Columns<(Bounce, Response)>,
}

impl<L: Bsdf + Row> Default for HitLanes<L> {
    fn default() -> Self {
        let (hits, queries, scattered) = (Columns::default(), Columns::default(), Columns::default());
        Self { numbers: Vec::new(), hits, queries, scattered }
    }
}

impl<L: Bsdf + Row> HitLanes<L> {
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

impl<L: Bsdf + Row> Kernel for Scatter<L> {
    type A = (L, Incidence);
    type B = LobeQuery;
    type Out = (Bounce, Response);

    #[inline(always)]
    fn run(&self, (lobe, incidence): &(L, Incidence), query: &LobeQuery) -> (Bounce, Response) {
        lobe.scatter(incidence, query.u, query.out)
    }
}

/// Hits on lobes of one kind, scattered one after the other.
pub(super) struct HitRows<L> {
    /// Numbers of the hits, with what is hit and four numbers in [0, 1) for a continuation.
    hits: Vec<(usize, L, Incidence, [f32; 4])>,
    scattered: Vec<(Bounce, Response)>,
}

impl<L> Default for HitRows<L> {
    fn default() -> Self {
        Self { hits: Vec::new(), scattered: Vec::new() }
    }
}

impl<L: Bsdf> HitRows<L> {
    /// As [`HitLanes::push`].
    #[inline(always)]
    pub fn push(&mut self, number: usize, lobe: &L, incidence: &Incidence, u: [f32; 4]) {
        self.hits.push((number, *lobe, *incidence, u));
    }

    /// As [`HitLanes::scatter`].
    pub fn scatter(&mut self, out: impl Fn(usize) -> DVec3, each: &mut dyn FnMut(usize, &Bounce, &Response)) {
        let Self { hits, scattered } = self;
        widest(ScatterRows { hits, out, scattered });
        for ((number, ..), (bounce, response)) in hits.drain(..).zip(scattered.drain(..)) {
            each(number, &bounce, &response);
        }
    }
}

/// Scatters hits one after the other.
struct ScatterRows<'a, L, F> {
    hits: &'a [(usize, L, Incidence, [f32; 4])],
    out: F,
    scattered: &'a mut Vec<(Bounce, Response)>,
}

impl<L: Bsdf, F: Fn(usize) -> DVec3> pulp::NullaryFnOnce for ScatterRows<'_, L, F> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Self { hits, out, scattered } = self;
        // A loop, as a closure is not compiled for wide vectors.
        for (number, lobe, incidence, u) in hits {
            scattered.push(lobe.scatter(incidence, *u, out(*number)));
        }
    }
}
