//! A step in a field, of which parts are wanted.

use glam::DVec3;

use crate::geodesic::{FieldRays, set_lane};
use crate::math::columns::{LANES, Row, columns};

columns! {
    /// A step, of which parts are wanted.
    pub struct FieldSpan => FieldSpanBlock {
        /// World position of the start.
        position: DVec3,
        /// Momentum there.
        momentum: DVec3,
        /// ½∇n² there.
        force: DVec3,
        /// β there.
        lean: DVec3,
        /// Length over which the index changes there.
        room: f64,
        /// Length of the whole step in τ.
        h: f64,
    }
}

impl FieldSpan {
    /// Starts of a block of steps, and their lengths.
    #[inline(always)]
    pub fn rays(block: &<Self as Row>::Block) -> (FieldRays<LANES>, [f64; LANES]) {
        gather(|l| Self::get(block, l))
    }

    /// The start by itself, and the length.
    #[inline(always)]
    pub fn ray(&self) -> (FieldRays<1>, [f64; 1]) {
        gather(|_| *self)
    }
}

/// Starts of steps, and their lengths.
#[inline(always)]
pub fn gather<const L: usize>(span: impl Fn(usize) -> FieldSpan) -> (FieldRays<L>, [f64; L]) {
    let none = [[0.0; L]; 3];
    // How far the next step may reach has been seen to before.
    let mut rays = FieldRays { x: none, p: none, force: none, lean: none, room: [0.0; L], reach: [0.0; L] };
    let mut lengths = [0.0; L];
    for (l, length) in lengths.iter_mut().enumerate() {
        let FieldSpan { position, momentum, force, lean, room, h } = span(l);
        set_lane(&mut rays.x, l, position);
        set_lane(&mut rays.p, l, momentum);
        set_lane(&mut rays.force, l, force);
        set_lane(&mut rays.lean, l, lean);
        (rays.room[l], *length) = (room, h);
    }
    (rays, lengths)
}
