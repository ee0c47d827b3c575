//! Pairs of Sobol' points: its first two dimensions, of which every aligned run of 2^k points has one in each rectangle
//! of 2^-i by 2^(i-k), shuffled and scrambled after Owen, so that pairs of any number do not know of each other.
//!
//! References: Burley 2020, "Practical Hash-based Owen Scrambling", JCGT 9(4), whose hashes are `sobol_burley`'s; Kollig
//! and Keller 2002, "Efficient Multidimensional Sampling", for pairs one beside the other.

use sobol_burley::parts::{hash, owen_scramble_rev};

/// The pair `index` of the sequence that `seed` names, for each of some lanes: fractions of 2^32.
#[inline(always)]
pub fn pairs<const N: usize>(index: [u32; N], seed: [u64; N]) -> [[u32; 2]; N] {
    let mut pairs = [[0; 2]; N];
    for lane in 0..N {
        let (low, high) = (seed[lane] as u32, (seed[lane] >> 32) as u32);
        // Reversed: the lowest bit is the first after the point.
        let x = owen_scramble_rev(index[lane].reverse_bits(), low).reverse_bits();
        let y = second_dimension(x);
        pairs[lane] = [(x, hash(low ^ high)), (y, high)]
            .map(|(reversed, scramble)| owen_scramble_rev(reversed, scramble).reverse_bits());
    }
    pairs
}

/// Sobol's second dimension from the first, both reversed: Pascal's triangle modulo 2, of which the entry (r, c) is odd
/// where the bits of r are among those of c, so that each step adds over one bit of c.
#[inline(always)]
fn second_dimension(mut bits: u32) -> u32 {
    bits ^= (bits >> 1) & 0x5555_5555;
    bits ^= (bits >> 2) & 0x3333_3333;
    bits ^= (bits >> 4) & 0x0f0f_0f0f;
    bits ^= (bits >> 8) & 0x00ff_00ff;
    bits ^ (bits >> 16)
}

#[cfg(test)]
mod tests {
    use sobol_burley::parts::sobol_rev;

    use super::*;

    #[test]
    fn the_second_dimension_is_that_of_the_library() {
        for index in 0..1 << 16 {
            assert_eq!(sobol_rev(u32::reverse_bits(index), 0), index);
            assert_eq!(sobol_rev(u32::reverse_bits(index), 1), second_dimension(index));
        }
    }

    #[test]
    fn every_aligned_run_of_a_power_of_two_is_in_every_rectangle_of_its_size_once() {
        for (seed, log, run) in [(3u64, 4, 0), (0x9e37_79b9_7f4a_7c15, 4, 7), (5 << 32, 6, 1), (77, 8, 3)] {
            let count = 1u32 << log;
            let points: Vec<[u32; 2]> = (0..count)
                .map(|i| pairs([run * count + i], [seed.wrapping_mul(0x1234_5679_abcd_ef01)])[0])
                .collect();
            for i in 0..log + 1 {
                let cell = |[x, y]: [u32; 2]| {
                    (u64::from(x) >> (32 - i)) << (log - i) | u64::from(y) >> (32 - (log - i))
                };
                let mut cells: Vec<u64> = points.iter().map(|&point| cell(point)).collect();
                cells.sort_unstable();
                assert!(cells.into_iter().eq(0..u64::from(count)), "{seed} {log} {i}");
            }
        }
    }
}
