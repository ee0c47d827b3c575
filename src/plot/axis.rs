//! Axes: from values to places, and where the ticks go.

/// Scale of the values over an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scale {
    /// Evenly.
    Linear,
    /// By their logarithm; values must be above 0.
    Log,
}

/// One axis of a diagram.
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    /// Quantity along it, and its unit.
    pub label: String,
    /// Scale of the values.
    pub scale: Scale,
    /// First and last value.
    pub range: [f64; 2],
}

/// A tick; minor ones have no label.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Tick {
    pub(super) value: f64,
    pub(super) label: Option<String>,
}

/// Least distance of labelled ticks on a linear axis, points.
const APART: f64 = 70.0;
/// Least distance of labelled decades, points.
const DECADES_APART: f64 = 46.0;
/// Length of a decade below which only its ends are labelled, points.
const LONG_DECADE: f64 = 200.0;
/// Room beyond the first and last value of an axis around values, relative to the whole.
const ROOM: f64 = 0.06;

impl Axis {
    /// A linear axis over `range`.
    pub fn linear(label: impl Into<String>, range: [f64; 2]) -> Self {
        Self { label: label.into(), scale: Scale::Linear, range }
    }

    /// A logarithmic axis that holds all finite `values` above 0, with some room.
    pub fn log_around(label: impl Into<String>, values: impl Iterator<Item = f64>) -> Self {
        let usable = values.filter(|value| value.is_finite() && *value > 0.0);
        let (low, high) = usable.fold((f64::INFINITY, 0.0f64), |(low, high), v| (low.min(v), high.max(v)));
        let (low, high) = if low <= high { (libm::log10(low), libm::log10(high)) } else { (0.0, 0.0) };
        // A decade at least, or ticks have nothing to stand on.
        let room = (ROOM * (high - low)).max(0.5 * (1.0 - (high - low)));
        Self {
            label: label.into(),
            scale: Scale::Log,
            range: [low - room, high + room].map(|e| libm::pow(10f64, e)),
        }
    }

    /// Place of `value`, 0 at the first value and 1 at the last.
    pub(super) fn at(&self, value: f64) -> f64 {
        let [first, last] = self.range;
        match self.scale {
            Scale::Linear => (value - first) / (last - first),
            Scale::Log => libm::log(value / first) / libm::log(last / first),
        }
    }

    /// The ticks within the range, drawn `length` points long.
    pub(super) fn ticks(&self, length: f64) -> Vec<Tick> {
        match self.scale {
            Scale::Linear => self.linear_ticks(length),
            Scale::Log => self.log_ticks(length),
        }
    }

    fn linear_ticks(&self, length: f64) -> Vec<Tick> {
        let [first, last] = self.range;
        let fast_log2 = (last - first) * APART / length;
        if !(fast_log2.is_finite() && fast_log2 > 0.0) {
            return Vec::new();
        }
        let decade = libm::pow(10f64, libm::log10(fast_log2).floor());
        let step = [1.0, 2.0, 5.0]
            .map(|m| m * decade)
            .into_iter()
            .find(|&s| s >= fast_log2)
            .unwrap_or(10.0 * decade);
        let decimals = (-libm::log10(step).floor()).clamp(0.0, 12.0) as usize;
        let indices = (first / step).ceil() as i64..=(last / step).floor() as i64;
        indices
            .map(|index| {
                let value = index as f64 * step;
                Tick { value, label: Some(format!("{value:.decimals$}").replace('-', "−")) }
            })
            .collect()
    }

    fn log_ticks(&self, length: f64) -> Vec<Tick> {
        let [first, last] = self.range;
        let decades = libm::log10(last / first);
        let stride = (decades * DECADES_APART / length).ceil().max(1.0) as i32;
        let exponents = libm::log10(first).floor() as i32..=libm::log10(last).floor() as i32;
        let digits = if stride > 1 { 1..2 } else { 1..10 };
        exponents
            .flat_map(|exponent| digits.clone().map(move |digit| (digit, exponent)))
            .map(|(digit, exponent)| {
                let between = length > LONG_DECADE * decades && (digit == 2 || digit == 5);
                let labelled = between || (digit == 1 && exponent % stride == 0);
                let label = labelled.then(|| log_label(digit, exponent));
                Tick { value: f64::from(digit) * 10f64.powi(exponent), label }
            })
            .filter(|tick| (first..=last).contains(&tick.value))
            .collect()
    }
}

/// `10⁻³`, `5·10⁻³`.
fn log_label(digit: i32, exponent: i32) -> String {
    let power: String = exponent
        .to_string()
        .chars()
        .map(|c| {
            if c == '-' {
                '⁻'
            } else {
                ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'][c as usize - '0' as usize]
            }
        })
        .collect();
    if digit == 1 { format!("10{power}") } else { format!("{digit}·10{power}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(axis: &Axis) -> Vec<String> {
        axis.ticks(400.0).into_iter().filter_map(|tick| tick.label).collect()
    }

    #[test]
    fn decades_are_labelled_as_powers_and_lie_evenly() {
        let axis = Axis { label: String::new(), scale: Scale::Log, range: [1e-3, 1e1] };
        assert_eq!(labels(&axis), ["10⁻³", "10⁻²", "10⁻¹", "10⁰", "10¹"]);
        assert!((axis.at(1e-1) - 0.5).abs() < 1e-12);
    }

    #[test]
    fn less_than_two_decades_are_labelled_in_between() {
        let axis = Axis { label: String::new(), scale: Scale::Log, range: [150.0, 900.0] };
        assert_eq!(labels(&axis), ["2·10²", "5·10²"]);
    }

    #[test]
    fn many_decades_are_labelled_with_gaps() {
        let axis = Axis { label: String::new(), scale: Scale::Log, range: [1e-12, 1e1] };
        assert_eq!(labels(&axis), ["10⁻¹²", "10⁻¹⁰", "10⁻⁸", "10⁻⁶", "10⁻⁴", "10⁻²", "10⁰"]);
        assert_eq!(axis.ticks(400.0).len(), 14);
    }

    #[test]
    fn linear_ticks_are_round() {
        assert_eq!(labels(&Axis::linear("", [-1.2, 1.3])), ["−1.0", "−0.5", "0.0", "0.5", "1.0"]);
    }

    #[test]
    fn a_range_around_no_values_or_one_is_a_decade() {
        for values in [vec![], vec![f64::NAN, -1.0, 0.0], vec![3.0], vec![2.0, 2.0]] {
            let [first, last] = Axis::log_around("", values.into_iter()).range;
            assert!((last / first - 10.0).abs() < 1e-9, "{first} {last}");
        }
    }
}
