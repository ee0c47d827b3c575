//! Passes: the runs of samples that a picture is taken in.

use std::ops::Range;

/// Samples of each pass but the first few.
const PASS: u32 = 16;

/// The samples of the pass that this one belongs to: a picture soon, and Sobol' points in powers of two.
pub fn pass_of(sample: u32) -> Range<u32> {
    match sample {
        0 => 0..1,
        1..4 => 1..4,
        4..8 => 4..8,
        8..PASS => 8..PASS,
        _ => sample / PASS * PASS..(sample / PASS + 1) * PASS,
    }
}
