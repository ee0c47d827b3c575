//! Checks of single values, with the place of whatever fails.

use std::ops::{Range, RangeInclusive};

use glam::{DVec3, Vec3};

use super::error::Fault;
use super::file::{Number, Triple, Vector};
use toml::Spanned;

/// Fails unless `good`; `value` is shown.
fn require(
    good: bool,
    span: Range<usize>,
    problem: impl FnOnce() -> String,
    help: &str,
) -> Result<(), Fault> {
    if good { Ok(()) } else { Err(Fault::at(span, problem(), help)) }
}

/// Largest number that makes sense anywhere: squares and products with it stay finite in 32 bits.
pub const LARGEST: f64 = 1e18;

/// A number from −1e18 to 1e18.
pub fn finite(value: &Number, what: &str) -> Result<f64, Fault> {
    let number = *value.get_ref();
    let problem = || format!("{what} must be finite and at most {LARGEST:e}, not {number}");
    require(number.abs() <= LARGEST, value.span(), problem, "write a smaller number")?;
    Ok(number)
}

/// A number > 0.
pub fn positive(value: &Number, what: &str) -> Result<f64, Fault> {
    let number = finite(value, what)?;
    let problem = || format!("{what} must be positive, not {number}");
    require(number > 0.0, value.span(), problem, "write a number greater than 0")?;
    Ok(number)
}

/// A number ≥ 0.
pub fn non_negative(value: &Number, what: &str) -> Result<f64, Fault> {
    let number = finite(value, what)?;
    let problem = || format!("{what} must not be negative, but is {number}");
    require(number >= 0.0, value.span(), problem, "write 0 or a positive number")?;
    Ok(number)
}

/// A number strictly between two bounds.
pub fn between(value: &Number, low: f64, high: f64, what: &str) -> Result<f64, Fault> {
    let number = finite(value, what)?;
    let problem = || format!("{what} must be between {low} and {high}, not {number}");
    let help = format!("write a number greater than {low} and less than {high}");
    require(number > low && number < high, value.span(), problem, &help)?;
    Ok(number)
}

/// A number from one bound to another, both allowed; `why` is the reason for them.
pub fn within(value: &Number, bounds: RangeInclusive<f64>, what: &str, why: &str) -> Result<f64, Fault> {
    let number = finite(value, what)?;
    let (low, high) = (bounds.start(), bounds.end());
    let problem = || format!("{what} must be from {low} to {high}, not {number}: {why}");
    require(
        bounds.contains(&number),
        value.span(),
        problem,
        &format!("write a number from {low} to {high}"),
    )?;
    Ok(number)
}

/// A vector whose coordinates are from −1e18 to 1e18.
pub fn finite_vector(value: &Vector, what: &str) -> Result<DVec3, Fault> {
    let vector = DVec3::from(*value.get_ref());
    let problem = || format!("{what} must be finite and at most {LARGEST:e}, not {:?}", vector.to_array());
    let good = vector.abs().cmple(DVec3::splat(LARGEST)).all();
    require(good, value.span(), problem, "write three smaller numbers")?;
    Ok(vector)
}

/// A direction, made a unit vector.
pub fn direction(value: &Vector, what: &str) -> Result<DVec3, Fault> {
    let vector = finite_vector(value, what)?;
    vector.try_normalize().ok_or_else(|| {
        Fault::at(value.span(), format!("{what} has no direction: its length is 0"), "write a nonzero vector")
    })
}

/// A colour, each channel from 0 to 1e18.
pub fn colour(value: &Spanned<Triple>, what: &str) -> Result<Vec3, Fault> {
    let [r, g, b] = value.get_ref().0;
    let rgb = Vec3::new(r as f32, g as f32, b as f32);
    let problem = || format!("{what} must be between 0 and {LARGEST:e}, but is [{r}, {g}, {b}]");
    let good = rgb.cmpge(Vec3::ZERO).all() && rgb.cmple(Vec3::splat(LARGEST as f32)).all();
    require(good, value.span(), problem, "write finite numbers of at least 0")?;
    Ok(rgb)
}

/// A reflectance, each channel in [0, 1].
pub fn reflectance(value: &Spanned<Triple>, what: &str) -> Result<Vec3, Fault> {
    let rgb = colour(value, what)?;
    let problem = || format!("{what} must be at most 1, but is {:?}", rgb.to_array());
    let help = "a surface that reflects more than it receives creates light; write numbers from 0 to 1";
    require(rgb.cmple(Vec3::ONE).all(), value.span(), problem, help)?;
    Ok(rgb)
}
