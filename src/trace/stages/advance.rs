//! One move for every ray: pure arithmetic, lane beside lane.

use super::super::columns::{Columns, LANES, Row};
use super::super::transport::Transport;

/// Writes the next move of each of the first `lanes` rays (and of what else is in their blocks).
///
/// Compiled for the widest vectors that the machine has. No instruction set fuses or reorders operations, so the bits
/// are those of the plain kernel.
pub fn advance<T: Transport>(
    transport: &T,
    flights: &Columns<T::Flight>,
    moves: &mut Columns<T::Move>,
    lanes: usize,
) {
    pulp::Arch::new().dispatch(Advance { transport, flights, moves, lanes });
}

/// The loop as a value: closures cannot be forced inline, and only what is inlined gets the wide instructions.
struct Advance<'a, T: Transport> {
    transport: &'a T,
    flights: &'a Columns<T::Flight>,
    moves: &'a mut Columns<T::Move>,
    lanes: usize,
}

impl<T: Transport> pulp::NullaryFnOnce for Advance<'_, T> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Advance { transport, flights, moves, lanes } = self;
        for (output, input) in moves.blocks_mut(lanes).iter_mut().zip(flights.blocks(lanes)) {
            // Local copies cannot alias, which the vectoriser needs to know.
            let (flights, mut moves) = (*input, <T::Move as Row>::Block::default());
            for lane in 0..LANES {
                T::Move::set(&mut moves, lane, transport.advance(&T::Flight::get(&flights, lane)));
            }
            *output = moves;
        }
    }
}
