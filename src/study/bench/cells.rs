//! Cells that tables of races have in common.

use super::race::Runs;
use crate::study::estimate::Estimate;
use crate::study::table::with_error;
use crate::trace::Stats;

/// `0.512 (0.509–0.530)`: the median time and its range, seconds.
pub(super) fn seconds(runs: &Runs, time: fn(&Stats) -> f64) -> String {
    let [shortest, longest] = runs.range(time);
    format!("{:.3} ({shortest:.3}–{longest:.3})", runs.median(time))
}

/// A ratio to the first contender, as contender number `index` has it.
pub(super) fn over_first(index: usize, ratio: Option<Estimate>) -> String {
    if index == 0 { "1".to_owned() } else { with_error(ratio) }
}
