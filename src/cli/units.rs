//! Numbers for people.

/// Binary multiples of a byte.
pub(super) fn bytes(count: u64) -> String {
    indicatif::BinaryBytes(count).to_string()
}

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
