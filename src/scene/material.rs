//! `[[material]]` → a material.

use std::ops::RangeInclusive;

use glam::Vec3;
use toml::Spanned;

use super::check;
use super::error::Fault;
use super::file::{EmittingSides, LobeName, MaterialTable, Number, Triple};
use crate::shade::{Dielectric, Diffuse, Lobe, Material, Mirror, Principled, attenuation};

/// Albedo of a diffuse material that does not say.
const DEFAULT_ALBEDO: f32 = 0.8;
/// Index of refraction that is not said.
const DEFAULT_IOR: f64 = 1.5;
/// Roughness that is not said, as in Blender.
const DEFAULT_ROUGHNESS: f32 = 0.5;
/// Indices of refraction of principled materials.
const INDICES: RangeInclusive<f64> = 1.0..=100.0;
/// Thicknesses of films, nanometres.
const THICKNESSES: RangeInclusive<f64> = 0.0..=1e6;
const FRACTIONS: RangeInclusive<f64> = 0.0..=1.0;

/// The material of a table.
pub(super) fn material(table: &MaterialTable) -> Result<Material, Fault> {
    let kind = table.kind.unwrap_or(LobeName::Diffuse);
    if let (Some(ior), LobeName::Diffuse | LobeName::Mirror) = (&table.ior, kind) {
        return Err(Fault::at(
            ior.span(),
            "only a dielectric has an `ior`",
            "remove it, or set `kind = \"dielectric\"`",
        ));
    }
    if kind != LobeName::Principled {
        forbid_layers(table)?;
    }
    let default = match kind {
        LobeName::Diffuse | LobeName::Principled => DEFAULT_ALBEDO,
        LobeName::Mirror | LobeName::Dielectric => 1.0,
    };
    let albedo =
        table.albedo.as_ref().map_or(Ok(Vec3::splat(default)), |rgb| check::reflectance(rgb, "albedo"))?;
    Ok(Material {
        lobe: match kind {
            LobeName::Diffuse => Lobe::Diffuse(Diffuse { albedo }),
            LobeName::Mirror => Lobe::Mirror(Mirror { reflectance: albedo }),
            LobeName::Dielectric => {
                let ior = table.ior.as_ref().map_or(Ok(DEFAULT_IOR), |ior| check::positive(ior, "ior"))?;
                Lobe::Dielectric(Dielectric { ior: ior as f32, tint: albedo })
            }
            LobeName::Principled => Lobe::Principled(principled(table, albedo)?),
        },
        attenuation: inside(table, kind)?,
        emission: table.emission.as_ref().map_or(Ok(Vec3::ZERO), |rgb| check::colour(rgb, "emission"))?,
        emits_both_sides: table.emits != Some(EmittingSides::Front),
        ..Material::default()
    })
}

/// Absorption inside of glass.
fn inside(table: &MaterialTable, kind: LobeName) -> Result<Vec3, Fault> {
    match (&table.attenuation_color, &table.attenuation_distance, kind) {
        (None, None, _) => Ok(Vec3::ZERO),
        (Some(color), distance, LobeName::Dielectric | LobeName::Principled) => {
            let color = check::reflectance(color, "attenuation_color")?;
            let distance = distance
                .as_ref()
                .map_or(Ok(1.0), |distance| check::positive(distance, "attenuation_distance"))?;
            Ok(attenuation(color, distance as f32))
        }
        (Some(color), _, LobeName::Diffuse | LobeName::Mirror) => Err(Fault::at(
            color.span(),
            "light does not go through this material, so it has no `attenuation_color`",
            "remove it, or set `kind = \"dielectric\"`",
        )),
        (None, Some(distance), _) => Err(Fault::at(
            distance.span(),
            "`attenuation_distance` is given without a colour",
            "add `attenuation_color = [r, g, b]`, what is left of white light after this distance",
        )),
    }
}

/// Fails if there are keys of a principled material.
fn forbid_layers(table: &MaterialTable) -> Result<(), Fault> {
    let number = |number: &Option<Number>| number.as_ref().map(Spanned::span);
    let colour = |colour: &Option<Spanned<Triple>>| colour.as_ref().map(Spanned::span);
    let keys = [
        ("metallic", number(&table.metallic)),
        ("roughness", number(&table.roughness)),
        ("specular", number(&table.specular)),
        ("specular_color", colour(&table.specular_color)),
        ("transmission", number(&table.transmission)),
        ("thin", table.thin.as_ref().map(Spanned::span)),
        ("clearcoat", number(&table.clearcoat)),
        ("clearcoat_roughness", number(&table.clearcoat_roughness)),
        ("sheen_color", colour(&table.sheen_color)),
        ("sheen_roughness", number(&table.sheen_roughness)),
        ("iridescence", number(&table.iridescence)),
        ("iridescence_ior", number(&table.iridescence_ior)),
        ("iridescence_thickness", number(&table.iridescence_thickness)),
    ];
    match keys.into_iter().find_map(|(key, span)| Some((key, span?))) {
        None => Ok(()),
        Some((key, span)) => {
            let problem = format!("only a principled material has `{key}`");
            Err(Fault::at(span, problem, "remove it, or set `kind = \"principled\"`"))
        }
    }
}

fn principled(table: &MaterialTable, base: Vec3) -> Result<Principled, Fault> {
    let plain = Principled::PLAIN;
    let within = |value: &Option<Number>, default: f32, range, what| {
        let why = "a principled material has no other";
        value.as_ref().map_or(Ok(default), |value| Ok(check::within(value, range, what, why)? as f32))
    };
    let fraction = |value: &Option<Number>, default: f32, what| within(value, default, FRACTIONS, what);
    let colour = |value: &Option<Spanned<Triple>>, default, what| {
        value.as_ref().map_or(Ok(default), |rgb| check::reflectance(rgb, what))
    };
    Ok(Principled {
        base,
        metallic: fraction(&table.metallic, plain.metallic, "metallic")?,
        roughness: fraction(&table.roughness, DEFAULT_ROUGHNESS, "roughness")?,
        ior: within(&table.ior, plain.ior, INDICES, "ior")?,
        specular: fraction(&table.specular, plain.specular, "specular")?,
        specular_color: colour(&table.specular_color, plain.specular_color, "specular_color")?,
        transmission: fraction(&table.transmission, plain.transmission, "transmission")?,
        is_thin: table.thin.as_ref().is_some_and(|thin| *thin.get_ref()),
        clearcoat: fraction(&table.clearcoat, plain.clearcoat, "clearcoat")?,
        clearcoat_roughness: fraction(&table.clearcoat_roughness, 0.0, "clearcoat_roughness")?,
        sheen_color: colour(&table.sheen_color, plain.sheen_color, "sheen_color")?,
        sheen_roughness: fraction(&table.sheen_roughness, DEFAULT_ROUGHNESS, "sheen_roughness")?,
        iridescence: fraction(&table.iridescence, plain.iridescence, "iridescence")?,
        iridescence_ior: within(&table.iridescence_ior, plain.iridescence_ior, INDICES, "iridescence_ior")?,
        iridescence_thickness: within(
            &table.iridescence_thickness,
            plain.iridescence_thickness,
            THICKNESSES,
            "iridescence_thickness",
        )?,
        ..plain
    })
}
