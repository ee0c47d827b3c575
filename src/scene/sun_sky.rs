//! Keys of `[environment] kind = "sun-sky"` → a clear sky.

use glam::{DVec3, Vec3};
use toml::Spanned;

use super::check;
use super::error::Fault;
use super::file::{EnvironmentTable, Number, SkyName};
use crate::shade::{ClearSky, SunSky};

/// Height of the sun where none is given, degrees.
const ELEVATION: f64 = 15.0;
/// Angular diameter of the sun, degrees.
const SUN_SIZE: f64 = 0.545;
/// Reflectance of the ground.
const GROUND: f32 = 0.3;
/// Largest factor on the sun: its radiance can be computed with even if it is small.
const BRIGHTEST: f64 = 1e8;
/// Largest amount of air, dust or ozone.
const MOST: f64 = 10.0;

/// The sky of a table that asks for one.
pub(super) fn sun_sky(table: &EnvironmentTable, strength: f32) -> Result<SunSky, Fault> {
    let amount = |value: &Option<Number>, key: &str| {
        let checked = |value| check::within(value, 0.0..=MOST, key, "1 is a clear day");
        value.as_ref().map_or(Ok(1.0), checked)
    };
    let elevation = table.sun_elevation.as_ref().map_or(Ok(ELEVATION), |angle| {
        check::within(angle, -90.0..=90.0, "sun_elevation", "it is the angle above the horizon in degrees")
    })?;
    let azimuth = table.sun_azimuth.as_ref().map_or(Ok(0.0), |angle| check::finite(angle, "sun_azimuth"))?;
    let size = table.sun_size.as_ref().map_or(Ok(SUN_SIZE), |angle| {
        check::within(angle, 0.01..=20.0, "sun_size", "it is the angle across the sun in degrees")
    })?;
    let disk_strength =
        table.sun_strength.as_ref().map_or(Ok(1.0), |factor| check::non_negative(factor, "sun_strength"))?;
    if f64::from(strength) * disk_strength > BRIGHTEST
        && let Some(factor) = table.sun_strength.as_ref().or(table.strength.as_ref())
    {
        let problem = format!("`strength` times `sun_strength` is more than {BRIGHTEST:e}");
        return Err(Fault::at(factor.span(), problem, "write smaller ones: 1 is the sun as it is"));
    }
    let ground = table
        .ground_albedo
        .as_ref()
        .map_or(Ok(Vec3::splat(GROUND)), |albedo| check::reflectance(albedo, "ground_albedo"))?;
    let has_disk = table.sun_disk.as_ref().is_none_or(|disk| *disk.get_ref()) && disk_strength > 0.0;
    Ok(SunSky::new(ClearSky {
        elevation: elevation.to_radians(),
        azimuth: azimuth.to_radians(),
        amounts: DVec3::new(
            amount(&table.air, "air")?,
            amount(&table.dust, "dust")?,
            amount(&table.ozone, "ozone")?,
        ),
        ground,
        disk: has_disk.then_some(size.to_radians()),
        disk_strength: disk_strength as f32,
        strength,
    }))
}

/// Fails if a key is given that only this kind of environment has.
pub(super) fn check_absent(table: &EnvironmentTable) -> Result<(), Fault> {
    if table.kind == Some(SkyName::SunSky) {
        return Ok(());
    }
    let number = |value: &Option<Number>| value.as_ref().map(Spanned::span);
    let keys = [
        ("sun_elevation", number(&table.sun_elevation)),
        ("sun_azimuth", number(&table.sun_azimuth)),
        ("sun_size", number(&table.sun_size)),
        ("sun_strength", number(&table.sun_strength)),
        ("sun_disk", table.sun_disk.as_ref().map(Spanned::span)),
        ("air", number(&table.air)),
        ("dust", number(&table.dust)),
        ("ozone", number(&table.ozone)),
        ("ground_albedo", table.ground_albedo.as_ref().map(Spanned::span)),
    ];
    match keys.into_iter().find_map(|(key, span)| Some((key, span?))) {
        Some((key, span)) => {
            let problem = format!("`{key}` is for `kind = \"sun-sky\"`");
            Err(Fault::at(span, problem, "remove it, or write this kind"))
        }
        None => Ok(()),
    }
}
