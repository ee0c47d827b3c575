//! Kernels over columns: plain arithmetic on rows, lane beside lane.

use super::columns::{LANES, Row};

/// What gives a row from two others, and nothing else.
///
/// Lanes run side by side only where it is free of calls, loops and branches: both sides of a choice are computed.
pub trait Kernel: Sync {
    /// First input.
    type A: Row;
    /// Second input.
    type B: Row;
    /// Result.
    type Out: Row;

    /// The result for one lane.
    fn run(&self, a: &Self::A, b: &Self::B) -> Self::Out;
}

/// Runs a kernel over blocks.
///
/// Compiled for the widest vectors that the machine has. No instruction set fuses or reorders operations, so the bits
/// are those of the plain kernel.
pub fn map<K: Kernel>(
    kernel: &K,
    a: &[<K::A as Row>::Block],
    b: &[<K::B as Row>::Block],
    out: &mut [<K::Out as Row>::Block],
) {
    widest(Map { kernel, a, b, out });
}

/// Runs `work` with the widest vectors that the machine has.
///
/// A closure would not do: it cannot be forced inline, and only what is inlined gets the wide instructions.
pub fn widest<W: pulp::NullaryFnOnce>(work: W) -> W::Output {
    pulp::Arch::new().dispatch(work)
}

struct Map<'a, K: Kernel> {
    kernel: &'a K,
    a: &'a [<K::A as Row>::Block],
    b: &'a [<K::B as Row>::Block],
    out: &'a mut [<K::Out as Row>::Block],
}

impl<K: Kernel> pulp::NullaryFnOnce for Map<'_, K> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Map { kernel, a, b, out } = self;
        for ((a, b), output) in a.iter().zip(b).zip(out) {
            // Local copies cannot alias, which the vectoriser needs to know.
            let (a, b, mut block) = (*a, *b, <K::Out as Row>::Block::default());
            for lane in 0..LANES {
                K::Out::set(&mut block, lane, kernel.run(&K::A::get(&a, lane), &K::B::get(&b, lane)));
            }
            *output = block;
        }
    }
}

/// Blocks of nothing, as many as it takes: the second input of kernels that need only one.
pub const NOTHING: &[()] = &[(); usize::MAX];
