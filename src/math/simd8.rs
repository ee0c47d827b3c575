//! Instructions for eight f32 side by side.
//!
//! Loops over lanes are vectorised by the compiler, which does badly where a comparison becomes bits that are counted: a
//! walk of a hierarchy does little else, and says here which instructions it wants. Products may be fused, so that
//! results differ by their rounding from machine to machine: only what has room for that may use them.

use super::columns::LANES;
use super::simd;

/// Vectors of eight f32. Where one of two numbers is NaN, the less or greater of them is the second.
pub trait Simd8: Copy {
    /// A vector.
    type F: Copy;
    /// Vector of an array.
    fn load(self, lanes: &[f32; LANES]) -> Self::F;
    /// Array of a vector.
    fn store(self, a: Self::F) -> [f32; LANES];
    /// Eight times the same.
    fn splat(self, value: f32) -> Self::F;
    /// a + b.
    fn add(self, a: Self::F, b: Self::F) -> Self::F;
    /// a − b.
    fn sub(self, a: Self::F, b: Self::F) -> Self::F;
    /// a b.
    fn mul(self, a: Self::F, b: Self::F) -> Self::F;
    /// a / b.
    fn div(self, a: Self::F, b: Self::F) -> Self::F;
    /// a b + c, fused or not.
    fn mul_add(self, a: Self::F, b: Self::F, c: Self::F) -> Self::F;
    /// a b − c, fused or not.
    fn mul_sub(self, a: Self::F, b: Self::F, c: Self::F) -> Self::F;
    /// The less of two.
    fn min(self, a: Self::F, b: Self::F) -> Self::F;
    /// The greater of two.
    fn max(self, a: Self::F, b: Self::F) -> Self::F;
    /// Size.
    fn abs(self, a: Self::F) -> Self::F;
    /// a, or −a where b is negative.
    fn flip(self, a: Self::F, b: Self::F) -> Self::F;
    /// Lanes in which a ≤ b, a bit each from the lowest on; not where one of them is NaN.
    fn le(self, a: Self::F, b: Self::F) -> u32;

    /// a × b.
    #[inline(always)]
    fn cross(self, [ax, ay, az]: [Self::F; 3], [bx, by, bz]: [Self::F; 3]) -> [Self::F; 3] {
        [
            self.mul_sub(ay, bz, self.mul(az, by)),
            self.mul_sub(az, bx, self.mul(ax, bz)),
            self.mul_sub(ax, by, self.mul(ay, bx)),
        ]
    }

    /// a · b.
    #[inline(always)]
    fn dot(self, [ax, ay, az]: [Self::F; 3], [bx, by, bz]: [Self::F; 3]) -> Self::F {
        self.mul_add(ax, bx, self.mul_add(ay, by, self.mul(az, bz)))
    }

    /// a − b by component.
    #[inline(always)]
    fn minus(self, [ax, ay, az]: [Self::F; 3], [bx, by, bz]: [Self::F; 3]) -> [Self::F; 3] {
        [self.sub(ax, bx), self.sub(ay, by), self.sub(az, bz)]
    }

    /// Largest component by size.
    #[inline(always)]
    fn largest(self, [x, y, z]: [Self::F; 3]) -> Self::F {
        self.max(self.max(self.abs(x), self.abs(y)), self.abs(z))
    }
}

/// Work for such instructions.
pub trait Simd8Work {
    /// Its result.
    type Output;
    /// Does it.
    fn run<V: Simd8>(self, simd: V) -> Self::Output;
}

/// Does `work` with the widest vectors that the machine has.
pub fn with_simd8<T: Simd8Work>(work: T) -> T::Output {
    match simd::arch() {
        #[cfg(target_arch = "x86_64")]
        pulp::Arch::V4(avx512) => avx512.vectorize(WorkOf(avx512, work)),
        #[cfg(target_arch = "x86_64")]
        pulp::Arch::V3(avx2) => avx2.vectorize(WorkOf(avx2, work)),
        arch => arch.dispatch(WorkOf(LaneByLane, work)),
    }
}

struct WorkOf<V, T>(V, T);

impl<V: Simd8, T: Simd8Work> pulp::NullaryFnOnce for WorkOf<V, T> {
    type Output = T::Output;

    #[inline(always)]
    fn call(self) -> T::Output {
        self.1.run(self.0)
    }
}

/// Plain arithmetic, for the compiler to vectorise.
#[derive(Clone, Copy)]
pub struct LaneByLane;

#[inline(always)]
fn each(lane: impl Fn(usize) -> f32) -> [f32; LANES] {
    let mut all = [0.0; LANES];
    for (i, one) in all.iter_mut().enumerate() {
        *one = lane(i);
    }
    all
}

impl Simd8 for LaneByLane {
    type F = [f32; LANES];

    #[inline(always)]
    fn load(self, lanes: &[f32; LANES]) -> Self::F {
        *lanes
    }

    #[inline(always)]
    fn store(self, a: Self::F) -> [f32; LANES] {
        a
    }

    #[inline(always)]
    fn splat(self, value: f32) -> Self::F {
        [value; LANES]
    }

    #[inline(always)]
    fn add(self, a: Self::F, b: Self::F) -> Self::F {
        each(|i| a[i] + b[i])
    }

    #[inline(always)]
    fn sub(self, a: Self::F, b: Self::F) -> Self::F {
        each(|i| a[i] - b[i])
    }

    #[inline(always)]
    fn mul(self, a: Self::F, b: Self::F) -> Self::F {
        each(|i| a[i] * b[i])
    }

    #[inline(always)]
    fn div(self, a: Self::F, b: Self::F) -> Self::F {
        each(|i| a[i] / b[i])
    }

    #[inline(always)]
    fn mul_add(self, a: Self::F, b: Self::F, c: Self::F) -> Self::F {
        each(|i| a[i] * b[i] + c[i])
    }

    #[inline(always)]
    fn mul_sub(self, a: Self::F, b: Self::F, c: Self::F) -> Self::F {
        each(|i| a[i] * b[i] - c[i])
    }

    #[inline(always)]
    fn min(self, a: Self::F, b: Self::F) -> Self::F {
        each(|i| if a[i] < b[i] { a[i] } else { b[i] })
    }

    #[inline(always)]
    fn max(self, a: Self::F, b: Self::F) -> Self::F {
        each(|i| if a[i] > b[i] { a[i] } else { b[i] })
    }

    #[inline(always)]
    fn abs(self, a: Self::F) -> Self::F {
        each(|i| a[i].abs())
    }

    #[inline(always)]
    fn flip(self, a: Self::F, b: Self::F) -> Self::F {
        each(|i| if b[i].is_sign_negative() { -a[i] } else { a[i] })
    }

    #[inline(always)]
    fn le(self, a: Self::F, b: Self::F) -> u32 {
        (0..LANES).fold(0, |bits, i| bits | u32::from(a[i] <= b[i]) << i)
    }
}

#[cfg(target_arch = "x86_64")]
mod x86 {
    use std::arch::x86_64::{__m256, _CMP_LE_OQ};

    use pulp::bytemuck::cast;
    use pulp::x86::{V3, V4};

    use super::{LANES, Simd8};

    macro_rules! avx {
        ($set:ty, $le:expr) => {
            impl Simd8 for $set {
                type F = __m256;

                #[inline(always)]
                fn load(self, lanes: &[f32; LANES]) -> __m256 {
                    cast(*lanes)
                }

                #[inline(always)]
                fn store(self, a: __m256) -> [f32; LANES] {
                    cast(a)
                }

                #[inline(always)]
                fn splat(self, value: f32) -> __m256 {
                    self.avx._mm256_set1_ps(value)
                }

                #[inline(always)]
                fn add(self, a: __m256, b: __m256) -> __m256 {
                    self.avx._mm256_add_ps(a, b)
                }

                #[inline(always)]
                fn sub(self, a: __m256, b: __m256) -> __m256 {
                    self.avx._mm256_sub_ps(a, b)
                }

                #[inline(always)]
                fn mul(self, a: __m256, b: __m256) -> __m256 {
                    self.avx._mm256_mul_ps(a, b)
                }

                #[inline(always)]
                fn div(self, a: __m256, b: __m256) -> __m256 {
                    self.avx._mm256_div_ps(a, b)
                }

                #[inline(always)]
                fn mul_add(self, a: __m256, b: __m256, c: __m256) -> __m256 {
                    self.fma._mm256_fmadd_ps(a, b, c)
                }

                #[inline(always)]
                fn mul_sub(self, a: __m256, b: __m256, c: __m256) -> __m256 {
                    self.fma._mm256_fmsub_ps(a, b, c)
                }

                #[inline(always)]
                fn min(self, a: __m256, b: __m256) -> __m256 {
                    self.avx._mm256_min_ps(a, b)
                }

                #[inline(always)]
                fn max(self, a: __m256, b: __m256) -> __m256 {
                    self.avx._mm256_max_ps(a, b)
                }

                #[inline(always)]
                fn abs(self, a: __m256) -> __m256 {
                    self.avx._mm256_andnot_ps(self.splat(-0.0), a)
                }

                #[inline(always)]
                fn flip(self, a: __m256, b: __m256) -> __m256 {
                    self.avx._mm256_xor_ps(a, self.avx._mm256_and_ps(self.splat(-0.0), b))
                }

                #[inline(always)]
                fn le(self, a: __m256, b: __m256) -> u32 {
                    $le(self, a, b)
                }
            }
        };
    }
    avx!(V3, |avx2: V3, a, b| {
        avx2.avx._mm256_movemask_ps(avx2.avx._mm256_cmp_ps::<_CMP_LE_OQ>(a, b)).cast_unsigned()
    });
    avx!(V4, |avx512: V4, a, b| u32::from(avx512.avx512f._mm256_cmp_ps_mask::<_CMP_LE_OQ>(a, b)));
}

#[cfg(test)]
mod tests {
    use super::*;

    /// All operations on some numbers, one after the other.
    struct AllOperations([[f32; LANES]; 3]);

    impl Simd8Work for AllOperations {
        type Output = (Vec<[f32; LANES]>, u32);

        fn run<V: Simd8>(self, simd: V) -> Self::Output {
            let [a, b, c] = [simd.load(&self.0[0]), simd.load(&self.0[1]), simd.load(&self.0[2])];
            let results = vec![
                simd.store(simd.add(a, b)),
                simd.store(simd.sub(a, b)),
                simd.store(simd.mul(a, b)),
                simd.store(simd.div(a, b)),
                simd.store(simd.mul_add(a, b, c)),
                simd.store(simd.mul_sub(a, b, c)),
                simd.store(simd.min(a, b)),
                simd.store(simd.max(a, b)),
                simd.store(simd.abs(a)),
                simd.store(simd.flip(a, b)),
                simd.store(simd.splat(self.0[0][0])),
            ];
            (results, simd.le(a, b))
        }
    }

    #[test]
    fn the_widest_vectors_calculate_as_plain_lanes_do() {
        // Products are exact: fused or not, sums are the same.
        let a = [1.0, -2.5, 0.0, -0.0, 8.0, f32::INFINITY, f32::NAN, 3.0];
        let b = [2.0, -2.5, -0.0, 1.0, -0.5, 1.0, 2.0, f32::NAN];
        let c = [0.5, 1.0, -4.0, 0.25, 3.0, -1.0, 1.0, 2.0];
        let bits = |(results, bits): (Vec<[f32; LANES]>, u32)| {
            let canonical = |value: f32| if value.is_nan() { f32::NAN.to_bits() } else { value.to_bits() };
            (results.iter().map(|lanes| lanes.map(canonical)).collect::<Vec<_>>(), bits)
        };
        assert_eq!(
            bits(with_simd8(AllOperations([a, b, c]))),
            bits(AllOperations([a, b, c]).run(LaneByLane))
        );
    }
}
