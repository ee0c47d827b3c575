//! Material libraries of OBJ files.

use std::io::Cursor;
use std::path::Path;

use glam::Vec3;

use super::files::Files;
use super::notes::Notes;
use crate::shade::{Lobe, Material};

/// Opacity (`d`) below which a material without `illum` counts as glass.
const GLASS_OPACITY: f32 = 0.5;
/// Index of refraction of glass that does not say.
const GLASS_IOR: f32 = 1.5;

/// Reads a material library; one that cannot be read is a warning, and its materials become the default.
pub(super) fn load(path: &Path, files: &Files, notes: &mut Notes) -> tobj::MTLLoadResult {
    let name = path.display().to_string();
    let bytes = files.read(path).map_err(|error| {
        notes.add("material library not read, the default material is used", format!("{name} ({error})"));
        tobj::LoadError::OpenFileFailed
    })?;
    let text = screened(&String::from_utf8_lossy(&bytes), notes);
    tobj::load_mtl_buf(&mut Cursor::new(text)).inspect_err(|error| {
        notes.add("material library malformed, the default material is used", format!("{name} ({error})"));
    })
}

/// The text with each colour given by three numbers, which is all that `tobj` reads (it panics on fewer).
///
/// One number means grey; spectral and CIE XYZ colours are ignored.
fn screened(text: &str, notes: &mut Notes) -> String {
    let mut screened = String::with_capacity(text.len());
    for (index, line) in text.lines().enumerate() {
        let mut words = line.split_whitespace();
        let keyword = words.next().unwrap_or_default();
        if ["Ka", "Kd", "Ks", "Ke"].contains(&keyword) {
            let numbers: Vec<&str> = words.take_while(|word| word.parse::<f32>().is_ok()).collect();
            match numbers.as_slice() {
                [grey] => screened.push_str(&format!("{keyword} {grey} {grey} {grey}")),
                [r, g, b, ..] => screened.push_str(&format!("{keyword} {r} {g} {b}")),
                _ => notes.add("colours that are not RGB are ignored; line", (index + 1).to_string()),
            }
        } else {
            screened.push_str(line);
        }
        screened.push('\n');
    }
    screened
}

/// The nearest material that the tracer has.
///
/// `illum` 4, 6, 7, 9 (or a low opacity `d`) is a dielectric; 3 and 5 are a mirror of `Ks`; the rest is diffuse `Kd`.
pub(super) fn convert(material: &tobj::Material, notes: &mut Notes) -> Material {
    note_ignored(material, notes);
    let name = &material.name;
    let mut unit = |colour: Option<[f32; 3]>, default: f32| {
        let colour = colour.map_or(Vec3::splat(default), Vec3::from);
        let clamped = Vec3::select(colour.is_nan_mask(), Vec3::ZERO, colour).clamp(Vec3::ZERO, Vec3::ONE);
        if clamped != colour {
            notes.add("colours outside 0..1 are clamped", name);
        }
        clamped
    };
    let lobe = match material.illumination_model {
        Some(4 | 6 | 7 | 9) => glass(material),
        Some(3 | 5) => Lobe::Mirror { reflectance: unit(material.specular, 1.0) },
        _ if material.dissolve.is_some_and(|opacity| opacity < GLASS_OPACITY) => glass(material),
        _ => Lobe::Diffuse { albedo: unit(material.diffuse, 0.8) },
    };
    let emission = material.emissive.map_or(Vec3::ZERO, Vec3::from);
    let usable = emission.is_finite() && emission.cmpge(Vec3::ZERO).all();
    if !usable {
        notes.add("emission that is negative or not finite is ignored", name);
    }
    Material { lobe, emission: if usable { emission } else { Vec3::ZERO }, ..Material::default() }
}

fn glass(material: &tobj::Material) -> Lobe {
    let ior = material.optical_density.filter(|ior| ior.is_finite() && *ior >= 1.0).unwrap_or(GLASS_IOR);
    Lobe::Dielectric { ior, tint: Vec3::ONE }
}

fn note_ignored(material: &tobj::Material, notes: &mut Notes) {
    let maps = [
        ("map_Ka", &material.ambient_texture),
        ("map_Kd", &material.diffuse_texture),
        ("map_Ks", &material.specular_texture),
        ("map_Bump", &material.normal_texture),
        ("map_Ns", &material.shininess_texture),
        ("map_d", &material.dissolve_texture),
    ];
    let present = maps.iter().filter(|(_, texture)| texture.is_some()).map(|(key, _)| *key);
    let mut unknown: Vec<&str> = material.unknown_param.keys().map(String::as_str).collect();
    unknown.sort_unstable();
    for key in present.chain(unknown) {
        notes.add(format!("`{key}` is ignored, in material"), &material.name);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn convert_text(text: &str) -> (Vec<Material>, Vec<String>) {
        let mut notes = Notes::default();
        let (materials, _) = tobj::load_mtl_buf(&mut Cursor::new(screened(text, &mut notes))).unwrap();
        let converted = materials.iter().map(|material| convert(material, &mut notes)).collect();
        (converted, notes.into_lines("a.mtl"))
    }

    #[test]
    fn illumination_models_choose_the_lobe() {
        let (materials, warnings) = convert_text(
            "newmtl m\nillum 3\nKs .9 .8 .7\nnewmtl g\nillum 7\nNi 1.3\nnewmtl t\nd 0.1\nnewmtl d\nKd .1 .2 .3\nillum 2\n",
        );
        let lobes: Vec<Lobe> = materials.iter().map(|material| material.lobe).collect();
        assert_eq!(
            lobes,
            [
                Lobe::Mirror { reflectance: Vec3::new(0.9, 0.8, 0.7) },
                Lobe::Dielectric { ior: 1.3, tint: Vec3::ONE },
                Lobe::Dielectric { ior: 1.5, tint: Vec3::ONE },
                Lobe::Diffuse { albedo: Vec3::new(0.1, 0.2, 0.3) },
            ]
        );
        assert!(warnings.is_empty(), "{warnings:?}");
    }

    #[test]
    fn ignored_maps_and_odd_colours_are_said_once_each() {
        let (materials, warnings) = convert_text(
            "newmtl a\nmap_Kd a.png\nKd 2 0 0\nKe spectral x.rfl\nPr 0.5\nnewmtl b\nmap_Kd b.png\n",
        );
        assert_eq!(materials[0].lobe, Lobe::Diffuse { albedo: Vec3::X });
        assert_eq!(
            warnings,
            [
                "a.mtl: colours that are not RGB are ignored; line: 4",
                "a.mtl: `map_Kd` is ignored, in material: a, b",
                "a.mtl: `Pr` is ignored, in material: a",
                "a.mtl: colours outside 0..1 are clamped: a",
            ]
        );
    }
}
