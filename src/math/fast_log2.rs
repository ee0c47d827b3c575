//! Powers to a few per cent, from the bits of floating-point numbers: for what needs no digits.
//!
//! The bits of a positive number are its logarithm, linear between powers of two: logarithms here are fixed-point
//! numbers in units of 1/[`OCTAVE`].

/// From one power of two to the next.
const OCTAVE: i32 = 1 << (f32::MANTISSA_DIGITS - 1);
/// The bits of 1: the bias of the exponent.
const ONE: i32 = (f32::MAX_EXP - 1) * OCTAVE;
/// Half of how far chords of 2^y rise above it, relative to it.
const ABOVE: f32 = 0.03;

/// log₂ x of a positive number, at most 0.09 too small.
#[inline(always)]
pub fn log2(x: f32) -> i32 {
    x.to_bits() as i32 - ONE
}

/// 2^y to 3 %, for |y| < 126.
#[inline(always)]
pub fn exp2(y: i32) -> f32 {
    f32::from_bits((y + ONE) as u32) * (1.0 - ABOVE)
}

/// From one power of two to the next, in logarithms of f64.
pub const WIDE_OCTAVE: i32 = 1 << 20;
/// The upper bits of 1.
const WIDE_ONE: i32 = 1023 * WIDE_OCTAVE;

/// log₂ x of a number of any size, 0 included, at most 0.09 too small, in units of 2⁻²⁰: not those of [`log2`].
#[inline(always)]
pub fn wide_log2(x: f64) -> i32 {
    (x.to_bits() >> 32) as i32 - WIDE_ONE
}

/// 2^y to 3 %, of a logarithm of [`wide_log2`], for |y| < 1022.
#[inline(always)]
pub fn wide_exp2(y: i32) -> f64 {
    f64::from_bits(u64::from((y + WIDE_ONE) as u32) << 32) * (1.0 - f64::from(ABOVE))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_are_as_small_as_promised() {
        for i in -1000..=1000 {
            let y = 0.0123 * i as f32;
            let below = y - log2(y.exp2()) as f32 / OCTAVE as f32;
            assert!((-1e-5..0.09).contains(&below), "log₂ of 2^{y}");
            let power = exp2((y * OCTAVE as f32) as i32);
            assert!((power / y.exp2() - 1.0).abs() < 0.032, "2^{y}");
        }
    }

    #[test]
    fn wide_errors_are_as_small_as_promised() {
        for i in -1000..=1000 {
            let y = 1.017 * f64::from(i);
            let below = y - f64::from(wide_log2(y.exp2())) / f64::from(WIDE_OCTAVE);
            assert!((-1e-5..0.09).contains(&below), "log₂ of 2^{y}");
            let power = wide_exp2((y * f64::from(WIDE_OCTAVE)) as i32);
            assert!((power / y.exp2() - 1.0).abs() < 0.032, "2^{y}");
        }
        assert_eq!(wide_log2(0.0), -WIDE_ONE);
    }
}
