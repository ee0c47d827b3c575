//! Pareto fronts: what nothing else beats in everything.

/// Front of `points`: true for those that no other point beats, that is, is at least as small in both values, and
/// smaller in one. Points with a value that is not finite are never on the front.
pub fn front(points: &[[f64; 2]]) -> Vec<bool> {
    let beats = |a: &[f64; 2], b: &[f64; 2]| a[0] <= b[0] && a[1] <= b[1] && a != b;
    let finite = |point: &[f64; 2]| point.iter().all(|value| value.is_finite());
    points.iter().map(|point| finite(point) && !points.iter().any(|other| beats(other, point))).collect()
}

#[cfg(test)]
mod tests {
    use super::front;

    #[test]
    fn only_what_nothing_beats_is_on_the_front() {
        let points = [[1.0, 9.0], [2.0, 5.0], [3.0, 5.0], [2.0, 6.0], [4.0, 4.0], [1.0, 9.0], [5.0, 4.5]];
        assert_eq!(front(&points), [true, true, false, false, true, true, false]);
    }

    #[test]
    fn what_was_not_measured_is_not_on_the_front() {
        assert_eq!(front(&[[f64::NAN, 0.0], [0.0, f64::INFINITY], [1.0, 1.0]]), [false, false, true]);
        assert!(front(&[]).is_empty());
    }
}
