//! Materials of a library → the nearest ones that the tracer has.

use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use glam::{DVec2, Vec3};

use super::bump;
use super::map_statement::MapStatement;
use super::metallic_roughness;
use super::names::find;
use crate::asset::files::Files;
use crate::asset::flaw::Flaw;
use crate::asset::image::Encoding;
use crate::asset::notes::Notes;
use crate::asset::textures::TextureTable;
use crate::shade::{
    Dielectric, Diffuse, Lobe, Maps, Material, MipImage, Mirror, NormalMap, Opacity, Principled, Texture,
    TextureChannel, TextureId, UvTransform, Wrap,
};

/// Albedo of a material that does not say.
const ALBEDO: f32 = 0.8;
/// Opacity (`d`) below which a material without `illum` is glass.
const GLASS_OPACITY: f32 = 0.5;
/// Index of refraction of glass that does not say.
const GLASS_IOR: f32 = 1.5;
/// Largest index of refraction of principled materials.
const MOST_IOR: f32 = 100.0;
/// Roughness that is not said, as in Blender.
const ROUGHNESS: f32 = 0.5;
/// Statements that make a material principled: roughness, metal, sheen, coat.
const LAYERS: [&str; 4] = ["Pr", "Pm", "Ps", "Pc"];
/// Those that name a picture.
const LAYER_MAPS: [&str; 2] = ["map_Pr", "map_Pm"];
/// Shininess (`Ns`) of what Blender says is smooth.
const SMOOTH: f32 = 1000.0;
/// Factor on the reflectance that the index tells where a picture of Blender's "IOR Level" is white.
const LEVEL: Vec3 = Vec3::splat(2.0);
/// Largest emission, as in scene files.
const BRIGHTEST: f32 = 1e18;

/// Pictures that were made of others, or why they could not be: each once, by the files that they were made of.
pub type MadePictures = HashMap<MadeOf, Result<Arc<MipImage>, String>>;

/// What a picture is made of.
#[derive(PartialEq, Eq, Hash)]
pub enum MadeOf {
    /// Normals of heights, and how these go on beyond their edges.
    Heights(PathBuf, Wrap),
    /// Roughness and metal.
    RoughnessAndMetal([Option<PathBuf>; 2]),
}

/// Turns the materials of one library into the nearest ones that the tracer has.
pub struct Converter<'a> {
    pub name: &'a str,
    pub is_of_blender: bool,
    pub folder: &'a Path,
    pub files: &'a Files,
    pub pictures: &'a mut TextureTable<PathBuf>,
    pub made: &'a mut MadePictures,
    pub notes: &'a mut Notes,
}

impl Converter<'_> {
    /// `illum` 4, 6, 7, 9 (or else a low opacity `d`) is a dielectric. Others with `Pr` or `Pm`, or with a layer, are
    /// principled, as Blender writes them; of the rest, 3 and 5 are a mirror of `Ks` unless it is black, and all else is
    /// diffuse `Kd`. A library of Blender's has principled materials only, and its 6 and 9 mean that `d` is below 1.
    pub fn convert(&mut self, material: &tobj::Material) -> Material {
        let specular = material.specular.map_or(Vec3::ZERO, Vec3::from);
        let is_glass = !self.is_of_blender
            && match material.illumination_model {
                Some(4 | 6 | 7 | 9) => true,
                Some(_) => false,
                None => material.dissolve.is_some_and(|opacity| opacity < GLASS_OPACITY),
            };
        let is_layered = self.is_of_blender
            || LAYERS.iter().any(|key| number(material, key).is_some())
            || LAYER_MAPS.iter().any(|key| material.unknown_param.contains_key(*key));
        let is_mirror =
            matches!(material.illumination_model, Some(3 | 5)) && specular.cmpgt(Vec3::ZERO).any();
        let (emission, emission_map) = self.emission(material);
        let maps = Maps { emission: emission_map, normal: self.normal(material), ..Maps::default() };
        let plain = Material { emission, maps, ..Material::default() };
        if is_glass {
            for keyword in LAYER_MAPS.iter().filter(|key| material.unknown_param.contains_key(**key)) {
                self.notes.add(format!("`{keyword}` of glass is ignored, in material"), self.name);
            }
            return Material { lobe: glass(material), ..plain };
        }
        if is_mirror && !is_layered {
            return Material { lobe: Lobe::Mirror(Mirror { reflectance: self.unit(specular) }), ..plain };
        }
        let (albedo, base_color) = self.base_color(material);
        let maps = Maps { base_color, ..maps };
        let opacity = self.opacity(material);
        if !is_layered {
            return Material { lobe: Lobe::Diffuse(Diffuse { albedo }), maps, opacity, ..plain };
        }
        let mut lobe = layered(material, albedo);
        let specular_color = material.specular_texture.as_deref();
        let specular_color = specular_color.and_then(|map| self.texture("map_Ks", Encoding::Color, map));
        if self.is_of_blender {
            lobe = as_blender_writes(material, lobe);
        }
        if specular_color.is_some() {
            (lobe.specular, lobe.specular_color) = (1.0, LEVEL);
        }
        let (metallic_roughness, [has_roughness, has_metal]) = self.metallic_roughness(material);
        if has_roughness {
            lobe.roughness = 1.0;
        }
        if has_metal {
            lobe.metallic = 1.0;
        }
        let maps = Maps { metallic_roughness, specular_color, ..maps };
        Material { lobe: Lobe::Principled(lobe), maps, opacity, ..plain }.with_coat_apart()
    }

    /// Colour `Kd` and its texture; either may be missing.
    fn base_color(&mut self, material: &tobj::Material) -> (Vec3, Option<TextureId>) {
        let map =
            material.diffuse_texture.as_deref().and_then(|map| self.texture("map_Kd", Encoding::Color, map));
        let usual = if map.is_some() { 1.0 } else { ALBEDO };
        (self.unit(material.diffuse.map_or(Vec3::splat(usual), Vec3::from)), map)
    }

    /// Emission and its texture; either may be missing.
    fn emission(&mut self, material: &tobj::Material) -> (Vec3, Option<TextureId>) {
        let map =
            material.unknown_param.get("map_Ke").and_then(|map| self.texture("map_Ke", Encoding::Color, map));
        let usual = if map.is_some() { Vec3::ONE } else { Vec3::ZERO };
        let emission = self.bounded(material.emissive.map_or(usual, Vec3::from));
        (emission, map.filter(|_| emission != Vec3::ZERO))
    }

    /// Opacity `d` and `map_d`: the picture's own, or else its grey.
    fn opacity(&mut self, material: &tobj::Material) -> Option<Opacity> {
        let map = material.dissolve_texture.as_deref();
        let map = map.and_then(|map| self.texture("map_d", Encoding::Data, map));
        let channel = |map: TextureId| {
            if self.pictures.has_alpha(map) { TextureChannel::Alpha } else { TextureChannel::Red }
        };
        let factor = material.dissolve.map_or(1.0, |d| if d.is_nan() { 1.0 } else { d.clamp(0.0, 1.0) });
        let map = map.map(|map| (map, channel(map)));
        Some(Opacity { factor, map, by_vertices: false, cutoff: None }).filter(Opacity::lets_through)
    }

    /// Normals of `norm`, or else of `map_Bump`: heights, unless it looks like normals.
    fn normal(&mut self, material: &tobj::Material) -> Option<NormalMap> {
        let (norm, bump) = (material.unknown_param.get("norm"), material.normal_texture.as_deref());
        let of_normals = norm.and_then(|map| {
            let statement = MapStatement::of(map);
            Some((self.image("norm", Encoding::Data, &statement)?, statement))
        });
        if of_normals.is_some() && bump.is_some() {
            self.notes.add("`map_Bump` beside `norm` is ignored, in material", self.name);
        }
        let (image, statement) = of_normals.or_else(|| self.bumps(bump?))?;
        Some(NormalMap { texture: self.placed(image, &statement), scale: statement.bumps as f32 })
    }

    /// Normals of a statement of bumps.
    fn bumps<'m>(&mut self, map: &'m str) -> Option<(Arc<MipImage>, MapStatement<'m>)> {
        let statement = MapStatement::of(map);
        let image = self.image("map_Bump", Encoding::Data, &statement)?;
        if bump::is_normal_map(&image) {
            return Some((image, statement));
        }
        let made_of = MadeOf::Heights(find(self.folder, statement.name), statement.wrap);
        let memory = self.files.memory();
        let normals = self.made(made_of, || bump::normals(&image, statement.wrap, &memory));
        Some((self.usable("map_Bump", statement.name, normals)?, statement))
    }

    /// A picture that is made of others.
    fn made(
        &mut self,
        made_of: MadeOf,
        make: impl FnOnce() -> Result<MipImage, Flaw>,
    ) -> Result<Arc<MipImage>, String> {
        let make = || make().map(Arc::new).map_err(|flaw| flaw.problem);
        self.made.entry(made_of).or_insert_with(make).clone()
    }

    /// Roughness and metal of `map_Pr` and `map_Pm` in one texture, and which of them there are: unlike other pictures
    /// these take the places of their numbers, which Blender writes besides.
    fn metallic_roughness(&mut self, material: &tobj::Material) -> (Option<TextureId>, [bool; 2]) {
        let statements = LAYER_MAPS.map(|key| Some(MapStatement::of(material.unknown_param.get(key)?)));
        let mut images = [None, None];
        for ((keyword, statement), image) in LAYER_MAPS.iter().zip(&statements).zip(&mut images) {
            *image = statement.as_ref().and_then(|map| self.image(keyword, Encoding::Data, map));
        }
        let has = images.each_ref().map(Option::is_some);
        let mut placed = statements.iter().zip(has).filter_map(|(map, has)| map.as_ref().filter(|_| has));
        let Some(first) = placed.next() else { return (None, has) };
        if placed.next().is_some_and(|other| !first.is_placed_as(other)) {
            self.notes.add("`map_Pm` is placed as `map_Pr` is, in material", self.name);
        }
        let paths = [0, 1].map(|i| {
            statements[i].as_ref().filter(|_| has[i]).map(|statement| find(self.folder, statement.name))
        });
        let memory = self.files.memory();
        let both = self.made(MadeOf::RoughnessAndMetal(paths), || {
            metallic_roughness::together(images.each_ref().map(Option::as_deref), &memory)
        });
        match self.usable("map_Pr", first.name, both) {
            Some(image) => (Some(self.placed(image, first)), has),
            None => (None, [false; 2]),
        }
    }

    fn texture(&mut self, keyword: &str, encoding: Encoding, map: &str) -> Option<TextureId> {
        let statement = MapStatement::of(map);
        let image = self.image(keyword, encoding, &statement)?;
        Some(self.placed(image, &statement))
    }

    /// The picture of a statement.
    fn image(&mut self, keyword: &str, encoding: Encoding, map: &MapStatement) -> Option<Arc<MipImage>> {
        if let Some(option) = map.ignored {
            self.notes.add(format!("`{option}` of `{keyword}` is ignored, in material"), self.name);
        }
        let path = find(self.folder, map.name);
        let read = || {
            let unread = |error| Flaw::new(format!("cannot be read: {error}"), "");
            self.files.read(&path).map_err(unread)
        };
        let image = self.pictures.image(path.clone(), encoding, &self.files.memory(), read);
        self.usable(keyword, map.name, image)
    }

    /// What there is, or a note why there is nothing.
    fn usable<T>(&mut self, keyword: &str, name: &str, found: Result<T, String>) -> Option<T> {
        let note = |problem: String| {
            let kind = format!("pictures of `{keyword}` that cannot be used are ignored");
            self.notes.add(kind, format!("{name} ({problem})"));
        };
        found.map_err(note).ok()
    }

    /// The texture of a picture, placed as a statement says.
    fn placed(&mut self, image: Arc<MipImage>, map: &MapStatement) -> TextureId {
        // Coordinates of the mesh count from the upper left corner, those of the statement from the lower left one.
        let offset = DVec2::new(map.offset.x, 1.0 - map.scale.y - map.offset.y);
        let transform = UvTransform::new(map.scale, 0.0, offset);
        self.pictures.add(Texture { image, uv_set: 0, transform, wrap: [map.wrap; 2], is_nearest: false })
    }

    /// A colour from 0 to 1.
    fn unit(&mut self, colour: Vec3) -> Vec3 {
        let clamped = Vec3::select(colour.is_nan_mask(), Vec3::ZERO, colour).clamp(Vec3::ZERO, Vec3::ONE);
        if clamped != colour {
            self.notes.add("colours outside 0..1 are clamped", self.name);
        }
        clamped
    }

    /// An emission that can be computed with.
    fn bounded(&mut self, emission: Vec3) -> Vec3 {
        if emission.is_nan() || emission.cmplt(Vec3::ZERO).any() {
            self.notes.add("emission that is negative or not a number is ignored", self.name);
            return Vec3::ZERO;
        }
        if emission.max_element() > BRIGHTEST {
            self.notes.add("emission above 1e18 is clamped", self.name);
        }
        emission.min(Vec3::splat(BRIGHTEST))
    }
}

/// Principled material of a base colour.
fn layered(material: &tobj::Material, base: Vec3) -> Principled {
    let share = |key| number(material, key).unwrap_or(0.0).clamp(0.0, 1.0);
    Principled {
        base,
        metallic: share("Pm"),
        roughness: number(material, "Pr").map_or(ROUGHNESS, |roughness| roughness.clamp(0.0, 1.0)),
        ior: index(material).min(MOST_IOR),
        sheen_color: Vec3::splat(share("Ps")),
        sheen_roughness: ROUGHNESS,
        clearcoat: share("Pc"),
        clearcoat_roughness: share("Pcr"),
        ..Principled::PLAIN
    }
}

/// The same as Blender encodes it. Where there is no `Pr` or `Pm`, roughness is in `Ns`, and metal in `Ka` if `illum` is 3 or
/// 6. Its "IOR Level" is in `Ks`, of which ½ is the reflectance that the index tells, a quarter of `Pc` is the share that is
/// coated, and `Tf` the share that light goes through.
fn as_blender_writes(material: &tobj::Material, layers: Principled) -> Principled {
    let share = |value: f32| if value.is_nan() { 0.0 } else { value.clamp(0.0, 1.0) };
    let mean = |colour: [f32; 3]| Vec3::from(colour).element_sum() / 3.0;
    let shininess = material.shininess.map_or(0.0, |shininess| share(shininess / SMOOTH));
    let roughness = number(material, "Pr").map_or(1.0 - shininess.sqrt(), |_| layers.roughness);
    let is_metal = matches!(material.illumination_model, Some(3 | 6));
    let metallic = match number(material, "Pm") {
        None if is_metal => material.ambient.map_or(0.0, |ambient| share(mean(ambient))),
        None | Some(_) => layers.metallic,
    };
    let specular = match material.illumination_model {
        Some(1) => 0.0,
        Some(_) | None => material.specular.map_or(1.0, |level| share(2.0 * mean(level))),
    };
    let clearcoat = number(material, "Pc").map_or(0.0, |coat| share(0.25 * coat));
    let transmission = number(material, "Tf").map_or(0.0, share);
    let is_thin = layers.is_thin && transmission == 0.0;
    Principled { roughness, metallic, specular, clearcoat, transmission, is_thin, ..layers }
}

/// Glass, rough if it says `Pr`.
fn glass(material: &tobj::Material) -> Lobe {
    let ior = index(material);
    match number(material, "Pr").map(|roughness| roughness.clamp(0.0, 1.0)) {
        None | Some(0.0) => Lobe::Dielectric(Dielectric { ior, tint: Vec3::ONE }),
        Some(roughness) => {
            let ior = ior.min(MOST_IOR);
            let glass = Principled { roughness, ior, transmission: 1.0, is_thin: false, ..Principled::PLAIN };
            Lobe::Principled(glass)
        }
    }
}

fn index(material: &tobj::Material) -> f32 {
    material.optical_density.filter(|ior| ior.is_finite() && *ior >= 1.0).unwrap_or(GLASS_IOR)
}

/// Number of a statement that `tobj` leaves as text.
fn number(material: &tobj::Material, key: &str) -> Option<f32> {
    material.unknown_param.get(key)?.parse().ok().filter(|number: &f32| !number.is_nan())
}
