//! `light = { ... }` of an entity → a punctual light.

use std::ops::Range;

use toml::Spanned;

use super::check;
use super::error::Fault;
use super::file::{LightName, LightTable, Number};
use crate::light::Punctual;

/// Half-angle of a spot's cone that does not say, degrees; glTF's default.
const DEFAULT_OUTER: f64 = 45.0;

/// Checks a light and reads it, in entity space.
pub(super) fn light(table: &Spanned<LightTable>) -> Result<Punctual, Fault> {
    let (span, table) = (table.span(), table.get_ref());
    check_keys(table)?;
    let position =
        || check::finite_vector(needed(&table.position, "position", table.kind, &span)?, "position");
    let direction =
        || check::direction(needed(&table.direction, "direction", table.kind, &span)?, "direction");
    let intensity = || check::colour(needed(&table.intensity, "intensity", table.kind, &span)?, "intensity");
    let irradiance =
        || check::colour(needed(&table.irradiance, "irradiance", table.kind, &span)?, "irradiance");
    match table.kind {
        LightName::Point => Ok(Punctual::Point { position: position()?, intensity: intensity()? }),
        LightName::Distant => Ok(Punctual::Distant { direction: direction()?, irradiance: irradiance()? }),
        LightName::Spot => {
            let (inner, outer) = cone(table.inner_angle.as_ref(), table.outer_angle.as_ref())?;
            Ok(Punctual::Spot {
                position: position()?,
                direction: direction()?,
                intensity: intensity()?,
                cos_inner: libm::cos(inner),
                cos_outer: libm::cos(outer),
            })
        }
    }
}

/// The value of a key without which a light of this kind is not known.
fn needed<'a, T>(
    given: &'a Option<T>,
    key: &str,
    kind: LightName,
    span: &Range<usize>,
) -> Result<&'a T, Fault> {
    given.as_ref().ok_or_else(|| {
        let problem = format!("a {} light needs `{key}`", kind.name());
        Fault::at(span.clone(), problem, format!("add `{key} = ...`"))
    })
}

/// Fails if a key is given that lights of this kind do not have.
fn check_keys(table: &LightTable) -> Result<(), Fault> {
    let (spot, distant) = (table.kind == LightName::Spot, table.kind == LightName::Distant);
    let keys = [
        ("position", table.position.as_ref().map(Spanned::span), !distant),
        ("direction", table.direction.as_ref().map(Spanned::span), spot || distant),
        ("intensity", table.intensity.as_ref().map(Spanned::span), !distant),
        ("irradiance", table.irradiance.as_ref().map(Spanned::span), distant),
        ("inner_angle", table.inner_angle.as_ref().map(Spanned::span), spot),
        ("outer_angle", table.outer_angle.as_ref().map(Spanned::span), spot),
    ];
    let known: Vec<String> =
        keys.iter().filter(|(.., has)| *has).map(|(key, ..)| format!("`{key}`")).collect();
    for (key, given, has) in keys {
        if let (Some(span), false) = (given, has) {
            return Err(Fault::at(
                span,
                format!("a {} light has no `{key}`", table.kind.name()),
                format!("remove it; beside `kind` there are {}", known.join(", ")),
            ));
        }
    }
    Ok(())
}

/// Half-angles of the cones of full and of some light, radians.
fn cone(inner: Option<&Number>, outer: Option<&Number>) -> Result<(f64, f64), Fault> {
    let outer_degrees = outer.map_or(Ok(DEFAULT_OUTER), |angle| check::non_negative(angle, "outer_angle"))?;
    if let (Some(outer), true) = (outer, outer_degrees > 90.0) {
        return Err(Fault::at(
            outer.span(),
            format!("outer_angle must be at most 90, not {outer_degrees}"),
            "write the angle between the axis and the edge of the cone, in degrees",
        ));
    }
    let inner_degrees = inner.map_or(Ok(0.0), |angle| check::non_negative(angle, "inner_angle"))?;
    if let (Some(inner), true) = (inner, inner_degrees > outer_degrees) {
        return Err(Fault::at(
            inner.span(),
            format!("the inner angle {inner_degrees} is greater than the outer one, {outer_degrees}"),
            "make `inner_angle` at most `outer_angle`",
        ));
    }
    Ok((inner_degrees.to_radians(), outer_degrees.to_radians()))
}
