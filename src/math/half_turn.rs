//! Angles of up to half a turn.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};

/// Coefficients in t², highest first, of the numerator and the denominator of (atan t / t − 1) / t²: the rational
/// approximation of the Cephes library, good to rounding up to t = 0.66.
const NUMERATOR: [f64; 5] = [
    -8.750_608_600_031_904e-1,
    -1.615_753_718_733_365_2e1,
    -7.500_855_792_314_705e1,
    -1.228_866_684_490_136_1e2,
    -6.485_021_904_942_025e1,
];
const DENOMINATOR: [f64; 6] = [
    1.0,
    2.485_846_490_142_306_2e1,
    1.650_270_098_316_988_6e2,
    4.328_810_604_912_902_7e2,
    4.853_903_996_359_137e2,
    1.945_506_571_482_614e2,
];
/// tan(π/8): from there on the angle is taken from π/4.
const EIGHTH: f64 = 0.414_213_562_373_095_1;

/// Angle between the x axis and the direction (x, y), of which y is not negative, in [0, π]: atan2(y, x) in straight-line
/// code, to the same bits on every machine.
#[inline(always)]
pub fn angle(y: f64, x: f64) -> f64 {
    let size = x.abs();
    let is_steep = y > size;
    let (low, high) = if is_steep { (size, y) } else { (y, size) };
    let is_far = low > EIGHTH * high;
    let t = if is_far { low - high } else { low } / if is_far { low + high } else { high };
    let z = t * t;
    let series = |coefficients: &[f64]| coefficients.iter().fold(0.0, |sum, c| sum * z + c);
    let angle = t + t * (z * series(&NUMERATOR) / series(&DENOMINATOR));
    let angle = if is_far { FRAC_PI_4 + angle } else { angle };
    let angle = if is_steep { FRAC_PI_2 - angle } else { angle };
    if x < 0.0 { PI - angle } else { angle }
}

#[cfg(test)]
mod tests {
    use super::angle;

    #[test]
    fn angles_are_those_of_the_arc_tangent() {
        for i in 0..100_000 {
            let turn = f64::from(i) * 1e-5 * std::f64::consts::PI;
            for size in [1e-100, 1.0, 1e100] {
                let (y, x) = (size * turn.sin(), size * turn.cos());
                let (found, exact) = (angle(y, x), y.atan2(x));
                assert!((found - exact).abs() <= 5e-16 * exact.max(1e-300), "{turn}: {found} {exact}");
            }
        }
        let axes = [(0.0, 1.0, 0.0), (0.0, -1.0, 2.0), (1.0, 0.0, 1.0), (1.0, 1.0, 0.5), (1.0, -1.0, 1.5)];
        for (y, x, quarters) in axes {
            assert_eq!(angle(y, x), quarters * std::f64::consts::FRAC_PI_2);
        }
    }
}
