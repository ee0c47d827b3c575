//! Rounding down.

/// Every number from here on is whole.
const WHOLE: f64 = (1u64 << (f64::MANTISSA_DIGITS - 1)) as f64;

/// The greatest whole number that is not above `x`: [`f64::floor`], which is a call on processors without SSE 4.1.
#[inline(always)]
pub fn floor(x: f64) -> f64 {
    if x.abs() < WHOLE {
        let towards_zero = x as i64 as f64;
        if towards_zero > x { towards_zero - 1.0 } else { towards_zero }
    } else {
        x
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_rounded_down_as_the_standard_library_does() {
        let edges = [
            0.0,
            -0.0,
            0.5,
            1.0,
            1f64.next_down(),
            7.25,
            1e9 + 0.5,
            WHOLE,
            WHOLE - 0.5,
            1e300,
            f64::MIN_POSITIVE,
        ];
        for x in edges.into_iter().flat_map(|x| [x, -x]).chain([f64::INFINITY, f64::NEG_INFINITY]) {
            assert_eq!(floor(x), x.floor(), "{x}");
        }
        assert!(floor(f64::NAN).is_nan());
    }
}
