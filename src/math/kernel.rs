//! Kernels over columns: plain arithmetic on rows, lane beside lane.

use super::columns::{LANES, PAIRED, Paired, Row};
use super::simd;

/// Function that gives a row from two others, and does nothing else.
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

/// Runs a kernel over blocks as [`map`] does, its result in the place of its first input.
pub fn update<K: Kernel<Out = <K as Kernel>::A>>(
    kernel: &K,
    rows: &mut [<K::A as Row>::Block],
    b: &[<K::B as Row>::Block],
) {
    widest(Update { kernel, rows, b });
}

/// Runs a kernel of numbers of type `R` as [`map`] does: takes two blocks at once if one does not fill the vectors.
pub fn map_full<R, K: Kernel<A: Paired, B: Paired, Out: Paired>>(
    kernel: &K,
    a: &[<K::A as Row>::Block],
    b: &[<K::B as Row>::Block],
    out: &mut [<K::Out as Row>::Block],
) {
    // A constant: pairs are compiled only for the numbers and for the vectors that call for them.
    #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
    if const { LANES * size_of::<R>() < AVX512_BYTES }
        && let pulp::Arch::V4(avx512) = simd::arch()
    {
        let (a, b, (out, last)) = (a.as_chunks(), b.as_chunks(), out.as_chunks_mut());
        avx512.vectorize(MapPairs { kernel, a: a.0, b: b.0, out });
        return map(kernel, a.1, b.1, last);
    }
    map(kernel, a, b, out);
}

/// Bytes in an AVX-512 vector; in all others, a block of the narrowest numbers fills one.
#[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
const AVX512_BYTES: usize = 64;

/// Runs `work` with the widest vectors that the machine has.
///
/// A closure would not do: it cannot be forced inline, and only what is inlined gets the wide instructions.
pub fn widest<W: pulp::NullaryFnOnce>(work: W) -> W::Output {
    simd::arch().dispatch(work)
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

struct Update<'a, K: Kernel> {
    kernel: &'a K,
    rows: &'a mut [<K::A as Row>::Block],
    b: &'a [<K::B as Row>::Block],
}

impl<K: Kernel<Out = <K as Kernel>::A>> pulp::NullaryFnOnce for Update<'_, K> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Update { kernel, rows, b } = self;
        for (block, b) in rows.iter_mut().zip(b) {
            let (a, b) = (*block, *b);
            let mut next = a;
            for lane in 0..LANES {
                K::A::set(&mut next, lane, kernel.run(&K::A::get(&a, lane), &K::B::get(&b, lane)));
            }
            *block = next;
        }
    }
}

struct MapPairs<'a, K: Kernel> {
    kernel: &'a K,
    a: &'a [[<K::A as Row>::Block; 2]],
    b: &'a [[<K::B as Row>::Block; 2]],
    out: &'a mut [[<K::Out as Row>::Block; 2]],
}

impl<K: Kernel<A: Paired, B: Paired, Out: Paired>> pulp::NullaryFnOnce for MapPairs<'_, K> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let MapPairs { kernel, a, b, out } = self;
        for (([a0, a1], [b0, b1]), output) in a.iter().zip(b).zip(out) {
            let (a, b) = (K::A::join([a0, a1]), K::B::join([b0, b1]));
            let mut pair = <K::Out as Paired>::Pair::default();
            for lane in 0..PAIRED {
                let row = kernel.run(&K::A::get_paired(&a, lane), &K::B::get_paired(&b, lane));
                K::Out::set_paired(&mut pair, lane, row);
            }
            *output = K::Out::part(&pair);
        }
    }
}

/// Blocks of nothing, as many as it takes: the second input of kernels that need only one.
pub const NOTHING: &[()] = &[(); usize::MAX];
