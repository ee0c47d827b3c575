//! Dormand and Prince's Nyström pair of order 6(4): five evaluations a step, the sixth is the next step's first.
//!
//! Reference: \[D\] Dormand, Prince 1987, "Runge–Kutta–Nyström triples", Comput. Math. Appl. 13(12), 937.

use super::stepper::{Nystrom, StepErrorModel, Stepper, Trial};
use crate::math::real::Real;

/// Nyström, order 6 with an estimate of order 4.
#[derive(Clone, Copy, Debug, Default)]
pub struct Rkn6;

/// √8581, as which \[D\] gives the coefficients.
const R: f64 = 92.633_687_176_966_03;

const TABLEAU: Nystrom<6> = Nystrom {
    c: [0.0, (209.0 - R) / 900.0, (209.0 - R) / 450.0, (209.0 + R) / 450.0, 0.9, 1.0],
    a: [
        [0.0; 6],
        [(26131.0 - 209.0 * R) / 810_000.0, 0.0, 0.0, 0.0, 0.0, 0.0],
        [(26131.0 - 209.0 * R) / 607_500.0, (26131.0 - 209.0 * R) / 303_750.0, 0.0, 0.0, 0.0, 0.0],
        [
            (980_403_512_254.0 + 7_781_688_431.0 * R) / 11_694_469_921_875.0,
            -(1_262_884_486_208.0 + 15_385_481_287.0 * R) / 11_694_469_921_875.0,
            (7_166_233_891_441.0 + 78_694_563_299.0 * R) / 46_777_879_687_500.0,
            0.0,
            0.0,
            0.0,
        ],
        [
            -9.0 * (329_260.0 + 3181.0 * R) / 27_040_000.0,
            27.0 * (35_129.0 + 3331.0 * R) / 13_520_000.0,
            -27.0 * (554_358_343.0 + 31_040_327.0 * R) / 464_060_480_000.0,
            153.0 * (8_555_257.0 - 67_973.0 * R) / 2_745_920_000.0,
            0.0,
            0.0,
        ],
        [
            329.0 / 4212.0,
            0.0,
            (84_119_543.0 + 366_727.0 * R) / 409_622_616.0,
            (84_119_543.0 - 366_727.0 * R) / 409_622_616.0,
            200.0 / 17901.0,
            0.0,
        ],
    ],
    b: [
        329.0 / 4212.0,
        0.0,
        (389_225_579.0 + 96_856.0 * R) / 1_024_056_540.0,
        (389_225_579.0 - 96_856.0 * R) / 1_024_056_540.0,
        2000.0 / 17901.0,
        1.0 / 20.0,
    ],
    e: [
        329.0 / 4212.0 - (2701.0 + 23.0 * R) / 4563.0,
        (9829.0 + 131.0 * R) / 9126.0,
        (84_119_543.0 + 366_727.0 * R) / 409_622_616.0 - 5.0 * (1798.0 + 17.0 * R) / 9126.0,
        (84_119_543.0 - 366_727.0 * R) / 409_622_616.0,
        200.0 / 17901.0,
        0.0,
    ],
    d: [
        329.0 / 4212.0 - 115.0 / 2106.0,
        0.0,
        (389_225_579.0 + 96_856.0 * R) / 1_024_056_540.0 - (84_119_543.0 + 366_727.0 * R) / 256_014_135.0,
        (389_225_579.0 - 96_856.0 * R) / 1_024_056_540.0 - (84_119_543.0 - 366_727.0 * R) / 256_014_135.0,
        2000.0 / 17901.0 - 6950.0 / 17901.0,
        1.0 / 20.0 + 1.0 / 10.0,
    ],
};

impl Stepper for Rkn6 {
    const ORDER: u32 = 6;
    const ESTIMATE: StepErrorModel = StepErrorModel { order: 6, embedded: 0.008, undone: 0.0 };

    #[inline(always)]
    fn step<R: Real, const N: usize>(
        &self,
        force: impl Fn(R, [R; N]) -> [R; N],
        start: [[R; N]; 3],
        h: R,
    ) -> Trial<R, N> {
        TABLEAU.step(force, start, h)
    }
}

#[cfg(test)]
mod tests {
    use super::super::stepper::tests::check_nystrom;
    use super::*;

    #[test]
    fn the_coefficients_meet_their_conditions() {
        check_nystrom(&TABLEAU, 6, [3, 4]);
    }
}
