//! Numbers in [0, 1) used again after a choice by them.

/// A number in [`below`, `below` + `share`) that made a choice of this share, spread over [0, 1): as even there as it was.
#[inline(always)]
pub fn rescale(u: f64, below: f64, share: f64) -> f64 {
    ((u - below) / share).clamp(0.0, 1f64.next_down())
}
