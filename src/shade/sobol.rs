//! Owen-scrambled Sobol' points (Burley 2020): `sobol_burley`'s numbers, put together from its parts so that many are
//! made side by side.

use std::sync::LazyLock;

use sobol_burley::parts::{hash, owen_scramble_rev, sobol_rev, u32_to_f32_norm};

/// Points of one sequence, the library's limit.
pub const SEQUENCE: u32 = 1 << 16;
/// Sets of four dimensions of one sequence, the library's limit.
pub const SETS: u32 = 64;

/// Points by four bits of the reversed index at a time: set, which four bits, their value, dimension. A point is the
/// sum without carry of those of its bits.
type Points = [[[[u32; 4]; 16]; 4]; SETS as usize];

static POINTS: LazyLock<Box<Points>> = LazyLock::new(|| {
    let mut points = Box::new([[[[0; 4]; 16]; 4]; SETS as usize]);
    for (set, points) in (0..).zip(points.iter_mut()) {
        for (place, points) in (0..).zip(points) {
            for (bits, point) in (0..).zip(points) {
                for (dimension, coordinate) in (0..).zip(point) {
                    *coordinate = sobol_rev(bits << (16 + 4 * place), 4 * set + dimension);
                }
            }
        }
    }
    points
});

/// All sequences.
#[derive(Clone, Copy)]
pub struct Sobol {
    points: &'static Points,
}

impl Sobol {
    /// The sequences, made once.
    pub fn new() -> Self {
        Self { points: &POINTS }
    }

    /// Numbers that `sobol_burley::sample_4d` gives for each of some lanes: four in [0, 1) of the point `index` below
    /// [`SEQUENCE`], in the dimensions of `set` below [`SETS`], of the sequence scrambled with `seed`.
    #[inline(always)]
    pub fn four<const N: usize>(self, index: [u32; N], set: [u32; N], seed: [u32; N]) -> [[f32; 4]; N] {
        let mut shuffled = [0; N];
        let mut keys = [0; N];
        for lane in 0..N {
            shuffled[lane] = owen_scramble_rev(index[lane].reverse_bits(), hash(seed[lane] ^ 0x79c6_8e4a));
            keys[lane] = seed[lane].wrapping_mul(0x9c8f_2d3b) ^ set[lane];
        }
        let mut sums = [[0; 4]; N];
        for lane in 0..N {
            let points = &self.points[(set[lane] % SETS) as usize];
            let part = |place: usize| points[place][(shuffled[lane] >> (16 + 4 * place)) as usize % 16];
            let (a, b, c, d) = (part(0), part(1), part(2), part(3));
            sums[lane] = std::array::from_fn(|i| a[i] ^ b[i] ^ c[i] ^ d[i]);
        }
        let mut numbers = [[0.0; 4]; N];
        for lane in 0..N {
            for (i, key) in [0x912f_69ba, 0x174f_18ab, 0x691e_72ca, 0xb40c_c1b8].into_iter().enumerate() {
                let scramble = hash(keys[lane] ^ key);
                numbers[lane][i] = u32_to_f32_norm(owen_scramble_rev(sums[lane][i], scramble).reverse_bits());
            }
        }
        numbers
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_numbers_are_those_of_the_library() {
        let sobol = Sobol::new();
        for i in 0..10_000u32 {
            let (index, set, seed) = (i.wrapping_mul(0x9e37_79b9) % SEQUENCE, i % SETS, hash(i));
            let [four] = sobol.four([index], [set], [seed]);
            assert_eq!(four, sobol_burley::sample_4d(index, set, seed));
        }
    }
}
