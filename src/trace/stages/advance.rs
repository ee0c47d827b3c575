//! One move for every ray: pure arithmetic, lane beside lane.

use super::super::columns::{LANES, Row};
use super::super::transport::Transport;

/// A kernel that gives the next move of a ray, from nothing but the ray.
pub trait Advance: Sync {
    /// A ray in flight.
    type Flight: Row;
    /// One move of a ray.
    type Move: Row;

    /// The next move.
    fn advance(&self, flight: &Self::Flight) -> Self::Move;
}

/// A transport as its own kernel.
pub struct Own<'a, T>(pub &'a T);

impl<T: Transport> Advance for Own<'_, T> {
    type Flight = T::Flight;
    type Move = T::Move;

    #[inline(always)]
    fn advance(&self, flight: &T::Flight) -> T::Move {
        self.0.advance(flight)
    }
}

/// Writes the next move of each ray.
///
/// Compiled for the widest vectors that the machine has. No instruction set fuses or reorders operations, so the bits
/// are those of the plain kernel.
pub fn advance_blocks<A: Advance>(
    kernel: &A,
    flights: &[<A::Flight as Row>::Block],
    moves: &mut [<A::Move as Row>::Block],
) {
    pulp::Arch::new().dispatch(Blocks { kernel, flights, moves });
}

/// The loop as a value: closures cannot be forced inline, and only what is inlined gets the wide instructions.
struct Blocks<'a, A: Advance> {
    kernel: &'a A,
    flights: &'a [<A::Flight as Row>::Block],
    moves: &'a mut [<A::Move as Row>::Block],
}

impl<A: Advance> pulp::NullaryFnOnce for Blocks<'_, A> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Blocks { kernel, flights, moves } = self;
        for (output, input) in moves.iter_mut().zip(flights) {
            // Local copies cannot alias, which the vectoriser needs to know.
            let (flights, mut moves) = (*input, <A::Move as Row>::Block::default());
            for lane in 0..LANES {
                A::Move::set(&mut moves, lane, kernel.advance(&A::Flight::get(&flights, lane)));
            }
            *output = moves;
        }
    }
}
