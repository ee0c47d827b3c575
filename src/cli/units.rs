//! Numbers for people.

/// Three significant digits and a decimal multiple: `1.50 M`.
pub(super) fn decimal(number: f64) -> String {
    let (value, prefix) = [(1e12, " T"), (1e9, " G"), (1e6, " M"), (1e3, " k")]
        .into_iter()
        .find(|(unit, _)| number >= *unit)
        .map_or((number, ""), |(unit, prefix)| (number / unit, prefix));
    let digits = if value >= 100.0 || value == 0.0 {
        0
    } else if value >= 10.0 {
        1
    } else {
        2
    };
    format!("{value:.digits$}{prefix}")
}

/// Four significant digits, with an exponent where the number is very small or large.
pub(super) fn significant(number: f64) -> String {
    let exponent = libm::log10(number.abs()).floor();
    match exponent {
        _ if number == 0.0 => "0".to_owned(),
        -3.0..6.0 => format!("{number:.0$}", (3.0 - exponent).max(0.0) as usize),
        _ => format!("{number:.3e}"),
    }
}

/// As many significant digits as asked for, without zeros at the end, as a person would write the number.
pub(super) fn rounded(number: f64, digits: usize) -> String {
    // Adding zero turns -0 into 0.
    let number = format!("{number:.0$e}", digits - 1).parse().unwrap_or(number) + 0.0;
    match number.abs() {
        0.0 | 1e-4..1e7 => number.to_string(),
        _ => format!("{number:e}"),
    }
}

/// Time in one unit or two, no finer than a person cares.
pub(super) fn duration(seconds: f64) -> String {
    const MINUTE: f64 = 60.0;
    const HOUR: f64 = 60.0 * MINUTE;
    const DAY: f64 = 24.0 * HOUR;
    const YEAR: f64 = 365.25 * DAY;
    // Rounded before it is taken apart: 59.7 seconds of a minute are a minute.
    let two = |unit: f64, name: &str, part: f64, part_name: &str| {
        let parts = (seconds / part).round() * part;
        let whole = (parts / unit).floor();
        match ((parts - whole * unit) / part).round() {
            0.0 => format!("{whole}{name}"),
            rest => format!("{whole}{name} {rest}{part_name}"),
        }
    };
    match seconds {
        ..9.95 => format!("{}s", rounded(seconds, 2)),
        ..59.5 => format!("{seconds:.0}s"),
        ..600.0 => two(MINUTE, "m", 1.0, "s"),
        ..3570.0 => format!("{:.0}m", seconds / MINUTE),
        ..36_000.0 => two(HOUR, "h", MINUTE, "m"),
        ..172_800.0 => format!("{:.0}h", seconds / HOUR),
        ..864_000.0 => two(DAY, " days", HOUR, "h"),
        _ if seconds < 2.0 * YEAR => format!("{:.0} days", seconds / DAY),
        _ if seconds < 1e6 * YEAR => format!("{} years", rounded(seconds / YEAR, 2)),
        _ => "more than a million years".to_owned(),
    }
}

/// `1 sphere`, `2 spheres`.
pub(super) fn plural(count: usize, one: &str, many: &str) -> String {
    format!("{count} {}", if count == 1 { one } else { many })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_keep_three_digits() {
        let cases = [
            (0.0, "0"),
            (0.5, "0.50"),
            (12.34, "12.3"),
            (999.0, "999"),
            (1500.0, "1.50 k"),
            (2.5e7, "25.0 M"),
        ];
        for (number, expected) in cases {
            assert_eq!(decimal(number), expected);
        }
    }

    #[test]
    fn numbers_are_rounded_as_a_person_would() {
        let cases = [
            (0.300_000_000_000_000_04, 4, "0.3"),
            (-0.0, 4, "0"),
            (1.450_000_047_683_715_8, 6, "1.45"),
            (-0.097_166_006_27, 3, "-0.0972"),
            (123_456.7, 3, "123000"),
            (1e-7, 4, "1e-7"),
            (2.5e18, 4, "2.5e18"),
            (f64::INFINITY, 4, "inf"),
        ];
        for (number, digits, expected) in cases {
            assert_eq!(rounded(number, digits), expected);
        }
    }

    #[test]
    fn times_are_told_in_the_units_of_their_size() {
        let cases = [
            (0.012_34, "0.012s"),
            (1.25, "1.2s"),
            (9.96, "10s"),
            (59.4, "59s"),
            (59.7, "1m"),
            (90.0, "1m 30s"),
            (949.0, "16m"),
            (3590.0, "1h"),
            (11_557.0, "3h 13m"),
            (100_000.0, "28h"),
            (300_000.0, "3 days 11h"),
            (1e7, "116 days"),
            (6.8e12, "220000 years"),
            (1e30, "more than a million years"),
        ];
        for (seconds, expected) in cases {
            assert_eq!(duration(seconds), expected);
        }
    }

    #[test]
    fn significant_digits_are_four() {
        let cases = [
            (0.0, "0"),
            (0.001, "0.001000"),
            (-0.123_456, "-0.1235"),
            (12.0, "12.00"),
            (123_456.0, "123456"),
            (9.999e-4, "9.999e-4"),
            (1e7, "1.000e7"),
        ];
        for (number, expected) in cases {
            assert_eq!(significant(number), expected);
        }
    }
}
