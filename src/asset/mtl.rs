//! Material libraries of OBJ files, parsed by `tobj` statement by statement as far as each can be read.

use std::collections::{HashMap, HashSet};
use std::fmt::Write;
use std::io::Cursor;
use std::path::{Path, PathBuf};

use glam::{DVec2, Vec3};

use super::files::Files;
use super::flaw::Flaw;
use super::image::Encoding;
use super::notes::Notes;
use super::statements::{Statement, Statements};
use super::textures::TextureTable;
use crate::shade::{
    Dielectric, Diffuse, Lobe, Maps, Material, Mirror, Opacity, Principled, Texture, TextureChannel,
    TextureId, UvTransform, Wrap,
};
use crate::text;

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
/// Largest emission, as in scene files.
const BRIGHTEST: f32 = 1e18;

/// Statements that name pictures, beside those that begin with `map_`.
const PICTURES: [&str; 5] = ["bump", "norm", "disp", "decal", "refl"];

/// The materials of all libraries of a file.
#[derive(Default)]
pub(super) struct Libraries {
    /// The nearest materials that the tracer has.
    pub materials: Vec<Material>,
    /// Features approximated or ignored, one line each.
    pub warnings: Vec<String>,
    /// Index of each material, by its name; the last one of several.
    names: HashMap<String, usize>,
    /// Index of each material, by its name without what may be a comment; the first one of several.
    short_names: HashMap<String, usize>,
    /// Libraries that were read.
    read: HashSet<PathBuf>,
    pictures: TextureTable<PathBuf>,
}

impl Libraries {
    /// Reads the libraries that a `mtllib` statement names; one that cannot be read goes to `notes`.
    pub fn read(&mut self, names: &str, folder: &Path, files: &Files, notes: &mut Notes) {
        if names.is_empty() {
            notes.add("material libraries that cannot be read are left out", "`mtllib` without a name");
        }
        for name in library_names(names, folder) {
            let path = find(folder, name);
            // One file may have many names.
            if !self.read.insert(std::fs::canonicalize(&path).unwrap_or_else(|_| path.clone())) {
                continue;
            }
            if let Err(error) = self.read_file(&path, files) {
                notes.add("material libraries that cannot be read are left out", format!("{name} ({error})"));
            }
        }
    }

    /// Takes the materials, and the textures that their maps number.
    pub fn take(&mut self) -> (Vec<Material>, Vec<Texture>) {
        (std::mem::take(&mut self.materials), std::mem::take(&mut self.pictures).into_textures())
    }

    /// True if a material has textures.
    pub fn has_textures(&self) -> bool {
        self.materials.iter().any(|material| material.textures().next().is_some())
    }

    /// The material of a name.
    pub fn find(&self, name: &str) -> Option<usize> {
        let short = without_comment(name);
        let found = self.names.get(name).or_else(|| self.short_names.get(name));
        found.or_else(|| self.names.get(short)).copied()
    }

    fn read_file(&mut self, path: &Path, files: &Files) -> std::io::Result<()> {
        let bytes = files.read(path)?;
        let mut notes = Notes::default();
        let library = Screened::read(&bytes, &mut notes)?;
        let (parsed, _) =
            tobj::load_mtl_buf(&mut Cursor::new(library.text)).map_err(std::io::Error::other)?;
        let folder = path.parent().unwrap_or(Path::new(""));
        library.unread.iter().for_each(|map| files.mention(&folder.join(MapStatement::of(map).name)));
        for (material, name) in parsed.iter().zip(library.names) {
            let mut converter =
                Converter { name: &name, folder, files, pictures: &mut self.pictures, notes: &mut notes };
            let material = converter.convert(material);
            let index = self.materials.len();
            self.materials.push(material);
            self.short_names.entry(without_comment(&name).to_owned()).or_insert(index);
            if self.names.insert(name.clone(), index).is_some() {
                notes.add("materials that are defined again: the last definition counts", name);
            }
        }
        self.warnings.extend(notes.into_lines(&path.display().to_string()));
        Ok(())
    }
}

/// The names on a `mtllib` line: all of it if there is such a file, else files with blanks in their names that end with
/// `.mtl`, else words.
fn library_names<'a>(line: &'a str, folder: &Path) -> Vec<&'a str> {
    let is_file = |name: &str| is_file(&find(folder, name));
    if is_file(line) {
        return vec![line];
    }
    let line = without_comment(line);
    let (mut names, mut start) = (Vec::new(), 0);
    let is_suffix = |end: usize| {
        let suffix = end.checked_sub(4).and_then(|at| line.get(at..end));
        suffix.is_some_and(|suffix| suffix.eq_ignore_ascii_case(".mtl"))
    };
    let ends = line.match_indices(char::is_whitespace).map(|(at, _)| at).chain([line.len()]);
    for end in ends.filter(|end| is_suffix(*end) || *end == line.len()) {
        let name = line.get(start..end).unwrap_or_default().trim_start();
        if is_file(name) {
            names.push(name);
        } else {
            names.extend(name.split_whitespace());
        }
        start = end;
    }
    names
}

/// Path of a file of this name: in the folder, by a path of Windows, or by its name alone; the first if nowhere.
fn find(folder: &Path, name: &str) -> PathBuf {
    let name = name.trim_matches('"');
    let slashes = name.replace('\\', "/");
    let alone = slashes.rsplit('/').next().unwrap_or_default();
    let places = [name, &slashes, alone].map(|name| folder.join(name));
    let found = places.iter().find(|path| is_file(path));
    found.or(places.first()).cloned().unwrap_or_default()
}

/// True if there is something by this name that is no folder.
fn is_file(path: &Path) -> bool {
    std::fs::metadata(path).is_ok_and(|file| !file.is_dir())
}

/// A name up to a blank and a `#`.
fn without_comment(name: &str) -> &str {
    let mut before = name.match_indices('#').map(|(at, _)| name.get(..at).unwrap_or_default());
    before.find(|before| before.ends_with(char::is_whitespace)).map_or(name, str::trim_end)
}

/// The statements of a library that `tobj` can read (it refuses the whole library, or panics, at others), each
/// material named by its number.
#[derive(Default)]
struct Screened {
    text: String,
    /// The materials' own names.
    names: Vec<String>,
    /// Values of statements of pictures that are not read.
    unread: HashSet<String>,
}

impl Screened {
    fn read(bytes: &[u8], notes: &mut Notes) -> std::io::Result<Self> {
        let mut screened = Self::default();
        let mut statements = Statements::new(bytes);
        while let Some(statement) = statements.next()? {
            screened.add(&statement, notes);
        }
        Ok(screened)
    }

    fn add(&mut self, statement: &Statement, notes: &mut Notes) {
        let Statement { line, keyword, name } = *statement;
        if keyword == "newmtl" {
            if name.is_empty() {
                notes.add("materials without a name cannot be used, in line", line.to_string());
            }
            let _ = writeln!(self.text, "newmtl {}", self.names.len());
            self.names.push(name.to_owned());
            return;
        }
        let Some(material) = self.names.last() else {
            notes.add("statements before the first `newmtl` are left out, in line", line.to_string());
            return;
        };
        let values = match keyword {
            "Ka" | "Kd" | "Ks" | "Ke" => colour(statement.values()),
            "Ns" | "Ni" | "d" | "Pr" | "Pm" | "Ps" | "Pc" | "Pcr" => first::<f32>(statement.values()),
            "illum" => first::<u8>(statement.values()),
            "map_Kd" | "map_Ke" | "map_d" => Some(name.to_owned()).filter(|name| !name.is_empty()),
            _ => {
                if keyword.starts_with("map_") || PICTURES.contains(&keyword) {
                    self.unread.insert(name.to_owned());
                }
                notes.add(format!("`{}` is ignored, in material", text::quoted(keyword)), material);
                return;
            }
        };
        match values {
            Some(values) => {
                // Writing to a string cannot fail.
                let _ = writeln!(self.text, "{keyword} {values}");
            }
            None => {
                let kind = "statements that cannot be read are left out, in line";
                notes.add(kind, format!("{line}: `{}`", format!("{keyword} {name}").trim_end()));
            }
        }
    }
}

/// Three numbers; one means grey, spectral and CIE XYZ colours are none.
fn colour(values: &str) -> Option<String> {
    let numbers: Vec<&str> =
        values.split_whitespace().take_while(|word| word.parse::<f32>().is_ok()).take(3).collect();
    match numbers.as_slice() {
        [grey] if values.split_whitespace().nth(1).is_none() => Some(format!("{grey} {grey} {grey}")),
        [_, _, _] => Some(numbers.join(" ")),
        _ => None,
    }
}

/// The first word, if it is a number of this type.
fn first<T: std::str::FromStr>(values: &str) -> Option<String> {
    let word = values.split_whitespace().next()?;
    word.parse::<T>().is_ok().then(|| word.to_owned())
}

/// Turns the materials of one library into the nearest ones that the tracer has.
struct Converter<'a> {
    name: &'a str,
    folder: &'a Path,
    files: &'a Files,
    pictures: &'a mut TextureTable<PathBuf>,
    notes: &'a mut Notes,
}

impl Converter<'_> {
    /// `illum` 4, 6, 7, 9 (or else a low opacity `d`) is a dielectric. Others with `Pr` or `Pm`, or with a layer, are
    /// principled, as Blender writes them; of the rest, 3 and 5 are a mirror of `Ks` unless it is black, and all else is
    /// diffuse `Kd`.
    fn convert(&mut self, material: &tobj::Material) -> Material {
        let specular = material.specular.map_or(Vec3::ZERO, Vec3::from);
        let is_glass = match material.illumination_model {
            Some(4 | 6 | 7 | 9) => true,
            Some(_) => false,
            None => material.dissolve.is_some_and(|opacity| opacity < GLASS_OPACITY),
        };
        let is_layered = LAYERS.iter().any(|key| number(material, key).is_some());
        let is_mirror =
            matches!(material.illumination_model, Some(3 | 5)) && specular.cmpgt(Vec3::ZERO).any();
        let (lobe, base_color, opacity) = if is_glass {
            (glass(material), None, None)
        } else if is_mirror && !is_layered {
            (Lobe::Mirror(Mirror { reflectance: self.unit(specular) }), None, None)
        } else {
            let (albedo, map) = self.base_color(material);
            let diffuse = Lobe::Diffuse(Diffuse { albedo });
            let lobe = if is_layered { layered(material, albedo) } else { diffuse };
            (lobe, map, self.opacity(material))
        };
        let (emission, emission_map) = self.emission(material);
        let maps = Maps { base_color, emission: emission_map, ..Maps::default() };
        Material { lobe, emission, maps, opacity, ..Material::default() }
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

    fn texture(&mut self, keyword: &str, encoding: Encoding, map: &str) -> Option<TextureId> {
        let MapStatement { name, scale, offset, wrap, has_gain } = MapStatement::of(map);
        if has_gain {
            self.notes.add(format!("`-mm` of `{keyword}` is ignored, in material"), self.name);
        }
        let path = find(self.folder, name);
        let read = || {
            let unread = |error| Flaw::new(format!("cannot be read: {error}"), "");
            self.files.read(&path).map_err(unread)
        };
        match self.pictures.image(path.clone(), encoding, &self.files.memory(), read) {
            Ok(image) => {
                // Those of the mesh count from the upper left corner, those of the statement from the lower left one.
                let offset = DVec2::new(offset.x, 1.0 - scale.y - offset.y);
                let transform = UvTransform::new(scale, 0.0, offset);
                let texture = Texture { image, uv_set: 0, transform, wrap: [wrap; 2], is_nearest: false };
                Some(self.pictures.add(texture))
            }
            Err(problem) => {
                let kind = format!("pictures of `{keyword}` that cannot be used are ignored");
                self.notes.add(kind, format!("{name} ({problem})"));
                None
            }
        }
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

/// Principled material of a base colour, as Blender writes it.
fn layered(material: &tobj::Material, base: Vec3) -> Lobe {
    let share = |key| number(material, key).unwrap_or(0.0).clamp(0.0, 1.0);
    Lobe::Principled(Principled {
        base,
        metallic: share("Pm"),
        roughness: number(material, "Pr").map_or(ROUGHNESS, |roughness| roughness.clamp(0.0, 1.0)),
        ior: index(material).min(MOST_IOR),
        sheen_color: Vec3::splat(share("Ps")),
        sheen_roughness: ROUGHNESS,
        clearcoat: share("Pc"),
        clearcoat_roughness: share("Pcr"),
        ..Principled::PLAIN
    })
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

/// A statement that names a picture.
struct MapStatement<'a> {
    /// Name of the file.
    name: &'a str,
    /// Factors on texture coordinates (`-s`), and what is added to them (`-o`).
    scale: DVec2,
    offset: DVec2,
    /// Wrapping (`-clamp`).
    wrap: Wrap,
    /// True if `-mm` changes the picture's values.
    has_gain: bool,
}

impl<'a> MapStatement<'a> {
    fn of(map: &'a str) -> Self {
        let (scale, offset, wrap) = (DVec2::ONE, DVec2::ZERO, Wrap::Repeat);
        let mut statement = Self { name: map.trim(), scale, offset, wrap, has_gain: false };
        while let Some((option, after)) = statement.name.split_once(char::is_whitespace) {
            let most = match option {
                "-o" | "-s" | "-t" => 3,
                "-mm" => 2,
                "-blendu" | "-blendv" | "-cc" | "-clamp" | "-imfchan" | "-texres" | "-bm" | "-boost"
                | "-type" => 1,
                _ => break,
            };
            statement.name = after.trim_start();
            for taken in 0..most {
                let Some((value, after)) = statement.name.split_once(char::is_whitespace) else { break };
                let number = value.parse::<f64>().ok();
                if taken > 0 && number.is_none() {
                    break;
                }
                statement.name = after.trim_start();
                statement.take(option, taken, value, number);
            }
        }
        statement
    }

    /// Takes a value of an option.
    fn take(&mut self, option: &str, place: usize, value: &str, number: Option<f64>) {
        match (option, number.filter(|_| place < 2)) {
            ("-s", Some(number)) => self.scale[place] = number,
            ("-o", Some(number)) => self.offset[place] = number,
            ("-clamp", _) if value == "on" => self.wrap = Wrap::Clamp,
            ("-mm", _) => self.has_gain = true,
            _ => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The materials and warnings of a library beside a picture `e.png`, of which one of 64 pixels is white.
    fn convert_bytes(bytes: &[u8]) -> (Vec<Material>, Vec<String>) {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("a.mtl"), bytes).unwrap();
        std::fs::create_dir(folder.path().join("tex")).unwrap();
        let picture = image::RgbImage::from_fn(8, 8, |x, y| image::Rgb([255 * u8::from(x + y == 0); 3]));
        picture.save(folder.path().join("tex/e 1.png")).unwrap();
        let mut libraries = Libraries::default();
        let mut notes = Notes::default();
        libraries.read("a.mtl", folder.path(), &Files::default(), &mut notes);
        assert_eq!(notes.into_lines("a.obj"), Vec::<String>::new());
        let prefix = format!("{}/", folder.path().display());
        let warnings = libraries.warnings.iter().map(|line| line.replace(&prefix, "")).collect();
        (libraries.materials, warnings)
    }

    fn convert_text(text: &str) -> (Vec<Material>, Vec<String>) {
        convert_bytes(text.as_bytes())
    }

    fn lobes(text: &str) -> Vec<Lobe> {
        let (materials, warnings) = convert_text(text);
        assert!(warnings.is_empty(), "{warnings:?}");
        materials.iter().map(|material| material.lobe).collect()
    }

    #[test]
    fn illumination_models_choose_the_lobe() {
        let text = "newmtl m\nillum 3\nKs .9 .8 .7\nnewmtl g\nillum 7\nNi 1.3\nnewmtl t\nd 0.1\nnewmtl d\nKd .1 .2 .3\nillum 2\n";
        let expected = [
            Lobe::Mirror(Mirror { reflectance: Vec3::new(0.9, 0.8, 0.7) }),
            Lobe::Dielectric(Dielectric { ior: 1.3, tint: Vec3::ONE }),
            Lobe::Dielectric(Dielectric { ior: 1.5, tint: Vec3::ONE }),
            Lobe::Diffuse(Diffuse { albedo: Vec3::new(0.1, 0.2, 0.3) }),
        ];
        assert_eq!(lobes(text), expected);
        assert_eq!(lobes(&text.replace('\n', "\r")), expected);
        assert_eq!(lobes(&format!("\u{feff}{}", text.replace('\n', "\r\n"))), expected);
    }

    #[test]
    fn roughness_metal_coat_and_sheen_make_a_principled_material() {
        let base = Vec3::new(0.1, 0.2, 0.3);
        let plain = Principled { base, roughness: 0.5, sheen_roughness: 0.5, ..Principled::PLAIN };
        let coated = Principled { clearcoat: 1.0, clearcoat_roughness: 0.03, ..plain };
        let cloth = Principled { sheen_color: Vec3::splat(0.4), sheen_roughness: 0.5, ..plain };
        let frosted =
            Principled { roughness: 0.3, ior: 1.4, transmission: 1.0, is_thin: false, ..Principled::PLAIN };
        let text = "newmtl a\nKd .1 .2 .3\nPr 0.25\nPm 2\nnewmtl b\nKd .1 .2 .3\nPc 1\nPcr 0.03\n\
                    newmtl c\nKd .1 .2 .3\nPs 0.4\nillum 3\nKs 1 1 1\nnewmtl d\nillum 7\nPr 0.3\nNi 1.4\n";
        let metal = Principled { metallic: 1.0, roughness: 0.25, ..plain };
        assert_eq!(lobes(text), [metal, coated, cloth, frosted].map(Lobe::Principled));
    }

    #[test]
    fn a_mirror_that_reflects_nothing_is_diffuse() {
        let red = Lobe::Diffuse(Diffuse { albedo: Vec3::X });
        assert_eq!(lobes("newmtl a\nillum 3\nKd 1 0 0\nnewmtl b\nKd 1 0 0\nKs 0 0 0\nillum 5"), [red, red]);
    }

    #[test]
    fn ignored_maps_and_odd_colours_are_said_once_each() {
        let (materials, warnings) = convert_text(
            "newmtl a\nmap_Ks a.png\nKd 2 0 0\nKe spectral x.rfl\naniso 0.5\nnewmtl b\nmap_Ks b.png\n",
        );
        assert_eq!(materials[0].lobe, Lobe::Diffuse(Diffuse { albedo: Vec3::X }));
        assert_eq!(
            warnings,
            [
                "a.mtl: `map_Ks` is ignored, in material: a, b",
                "a.mtl: statements that cannot be read are left out, in line: 4: `Ke spectral x.rfl`",
                "a.mtl: `aniso` is ignored, in material: a",
                "a.mtl: colours outside 0..1 are clamped: a",
            ]
        );
    }

    #[test]
    fn one_odd_statement_costs_itself_and_not_the_library() {
        for odd in [
            "illum",
            "illum 2.0",
            "illum -1",
            "illum 999",
            "Ni 1,45",
            "Ni",
            "Ns none",
            "d -halo 0.5",
            "map_Kd",
            "Kd 1 1",
            "Kd 0,5 0,5 0,5",
            "Kd 1 1 x",
            "Kd",
            "Ks xyz 1 1 1",
            "Ke -1.#IND 0 0",
            "map_Ke ",
        ] {
            let (materials, warnings) =
                convert_text(&format!("newmtl wall\nKd 1 1 1\n{odd}\nnewmtl lamp\nKd 0 0 0\nKe 1 1 1\n"));
            let shown = odd.trim_end();
            let said = format!("a.mtl: statements that cannot be read are left out, in line: 3: `{shown}`");
            assert_eq!(warnings, [said], "{odd}");
            assert_eq!(materials[0].lobe, Lobe::Diffuse(Diffuse { albedo: Vec3::ONE }), "{odd}");
            assert_eq!(materials[1].emission, Vec3::ONE, "{odd}");
        }
    }

    #[test]
    fn statements_without_a_material_and_materials_without_a_name_are_said() {
        let (materials, warnings) = convert_text("Kd 1 0 0\nnewmtl\nKd 0 1 0\nnewmtl a\nKd 0 0 1\n");
        assert_eq!(materials[1].lobe, Lobe::Diffuse(Diffuse { albedo: Vec3::Z }));
        assert_eq!(
            warnings,
            [
                "a.mtl: statements before the first `newmtl` are left out, in line: 1",
                "a.mtl: materials without a name cannot be used, in line: 2",
            ]
        );
    }

    #[test]
    fn a_picture_is_a_factor_on_kd_or_ke_moved_as_its_options_say() {
        let (materials, warnings) = convert_text(
            "newmtl a\nKd 1 1 .5\nmap_Kd -s 2 3 1 -o 0.5 0.25 -clamp on tex\\e 1.png\n\
             newmtl b\nKd 0 0 0\nKe 64 64 64\nmap_Ke tex/e 1.png\nmap_Kd C:\\gone\\x.png\nnewmtl c\nmap_Kd tex/e 1.png\n\
             newmtl d\nmap_Ke tex/e 1.png\nmap_Kd -mm 0 2 tex/e 1.png\n",
        );
        let map =
            |index: usize| (materials[index].lobe.albedo(), materials[index].emission, materials[index].maps);
        let maps = |base_color: Option<u32>, emission: Option<u32>| Maps {
            base_color: base_color.map(TextureId),
            emission: emission.map(TextureId),
            ..Maps::default()
        };
        assert_eq!(map(0), (Vec3::new(1.0, 1.0, 0.5), Vec3::ZERO, maps(Some(0), None)));
        assert_eq!(map(1), (Vec3::ZERO, Vec3::splat(64.0), maps(None, Some(1))));
        assert_eq!(map(2), (Vec3::ONE, Vec3::ZERO, maps(Some(2), None)));
        assert_eq!(map(3), (Vec3::ONE, Vec3::ONE, maps(Some(3), Some(4))));
        assert!(warnings[0].starts_with(
            "a.mtl: pictures of `map_Kd` that cannot be used are ignored: C:\\gone\\x.png (cannot be read"
        ));
        assert_eq!(warnings[1..], ["a.mtl: `-mm` of `map_Kd` is ignored, in material: d"]);
        let MapStatement { name, scale, offset, wrap, has_gain } =
            MapStatement::of(" -s 2 3 1 -o 0.5 0.25 -clamp on tex/e 1.png");
        assert_eq!((name, scale, offset), ("tex/e 1.png", DVec2::new(2.0, 3.0), DVec2::new(0.5, 0.25)));
        assert_eq!((wrap, has_gain), (Wrap::Clamp, false));
    }

    #[test]
    fn emission_is_bounded() {
        let (materials, warnings) = convert_text(
            "newmtl a\nKe 1e39 1 0\nnewmtl b\nKe -1 0 0\nnewmtl c\nKe nan 0 0\nnewmtl d\nKe 1e18 0 0",
        );
        let emission: Vec<Vec3> = materials.iter().map(|material| material.emission).collect();
        assert_eq!(emission, [Vec3::new(1e18, 1.0, 0.0), Vec3::ZERO, Vec3::ZERO, Vec3::X * 1e18]);
        assert_eq!(
            warnings,
            [
                "a.mtl: emission above 1e18 is clamped: a",
                "a.mtl: emission that is negative or not a number is ignored: b, c",
            ]
        );
    }

    #[test]
    fn very_many_unknown_statements_are_a_few_lines() {
        let keys: String = (0..100_000).map(|i| format!("k{i} 1\n")).collect();
        let (_, warnings) = convert_text(&format!("newmtl a\n{keys}"));
        assert!(warnings.len() < 30, "{}", warnings.len());
    }
}
