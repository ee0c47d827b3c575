//! Punctual lights (`KHR_lights_punctual`).

use std::f32::consts::FRAC_PI_2;

use glam::{DVec3, Vec3};
use gltf::khr_lights_punctual::{Kind, Light};

use crate::asset::flaw::Flaw;
use crate::asset::notes::Notes;
use crate::light::Punctual;

/// The light in the space of its node, where it shines along −Z; intensities in candela, irradiances in lux.
pub(super) fn convert(light: &Light, notes: &mut Notes) -> Result<Punctual, Flaw> {
    let name = light.name().map_or_else(|| format!("light {}", light.index()), str::to_owned);
    if light.range().is_some() {
        notes.add("range is ignored, light reaches everywhere, of light", &name);
    }
    read(light).map_err(|flaw| flaw.at(format!("light `{name}`")))
}

fn read(light: &Light) -> Result<Punctual, Flaw> {
    let (colour, strength) = (Vec3::from(light.color()), light.intensity());
    if !(colour.is_finite() && colour.cmpge(Vec3::ZERO).all()) {
        return Err(Flaw::new(
            format!("the colour must be finite and not negative, but is {:?}", colour.to_array()),
            "choose another colour and export the file again",
        ));
    }
    if !(strength.is_finite() && strength >= 0.0) {
        return Err(Flaw::new(
            format!("the intensity must be finite and not negative, but is {strength}"),
            "choose another intensity and export the file again",
        ));
    }
    let (position, direction, intensity) = (DVec3::ZERO, DVec3::NEG_Z, colour * strength);
    match light.kind() {
        Kind::Point => Ok(Punctual::Point { position, intensity }),
        Kind::Directional => Ok(Punctual::Distant { direction, irradiance: intensity }),
        Kind::Spot { inner_cone_angle: inner, outer_cone_angle: outer } => {
            // Compared in f32, in which π/2 is a little larger, so that the widest cone that a file can hold passes.
            if !(0.0 <= inner && inner <= outer && outer <= FRAC_PI_2) {
                return Err(Flaw::new(
                    format!("the cone's angles must be 0 ≤ inner ≤ outer ≤ π/2, but are {inner} and {outer}"),
                    "choose other angles and export the file again",
                ));
            }
            let (cos_inner, cos_outer) = (libm::cos(f64::from(inner)), libm::cos(f64::from(outer)));
            Ok(Punctual::Spot { position, direction, intensity, cos_inner, cos_outer })
        }
    }
}
