//! The scene: as authored (an ECS world), and as baked (flat tables).
//!
//! Text → `file` tables → `populate` → `World` of [`components`] → `systems` → `bake` → [`Baked`]. A glTF
//! or OBJ file by itself is a scene file with one entity.
//!
#![doc = include_str!("keys.md")]

mod advice;
mod bake;
mod baked;
mod bare_model;
mod camera;
mod check;
pub mod components;
mod error;
mod file;
mod foreign;
mod hole;
mod light;
mod overrides;
mod populate;
mod settings;
mod squash;
mod systems;
mod text;
mod world;

use std::path::{Path, PathBuf};

use glam::{DVec3, Vec3};

pub use baked::{Baked, FarLights};
pub use camera::Camera;
pub use error::{Place, SceneError};
#[cfg(feature = "cli")]
pub use settings::flag_name;
pub use settings::{
    Background, Filter, LightSampling, MAX_SEGMENTS, MAX_SPP, MAX_WINDING, Precision, SamplerKind, Schedule,
    Settings, StepperKind,
};

use crate::asset::{AssetError, Files, Memory, load_image};
use crate::shade::Environment;
use crate::spacetime::SpacetimeKind;
use bare_model::bare_scene;
use error::{Fault, SourceText};
use populate::Source;
use world::World;

/// Bytes that a triangle takes in the tree, while it is built.
const TRIANGLE_BYTES: u64 = 160;

/// Options for loading a scene, beside its file.
#[derive(Debug, Default)]
pub struct LoadOptions {
    /// Overrides `path.to.key=value`, as after `--set`; array entries go by index or by name.
    pub overrides: Vec<String>,
    /// A black hole instead of the scene's spacetime: X, Y, Z of its center and its Schwarzschild radius, in scene units.
    pub black_hole: Option<[f64; 4]>,
    /// Light from infinity instead of the scene's.
    pub environment: Option<Surroundings>,
    /// Name of the camera, of several.
    pub camera: Option<String>,
    /// Factor on the lights of glTF files, from candela to W/sr and lux to W/m², instead of the scene's.
    pub light_scale: Option<f64>,
    /// Width and height of the picture instead of the scene's, pixels.
    pub size: Option<(usize, usize)>,
    /// Reads the scene's files.
    pub files: Files,
}

/// Remedy for a file that is no scene.
const SCENES: &str = "a scene is a .toml, .gltf, .glb or .obj file";

/// Light from infinity, as an option names it.
#[derive(Clone, Debug, PartialEq)]
pub enum Surroundings {
    /// The built-in sky.
    Sky,
    /// Radiance, the same from everywhere, linear RGB.
    Color(Vec3),
    /// A latitude-longitude picture.
    Image(PathBuf),
}

impl Surroundings {
    fn load(&self, options: &LoadOptions, warnings: &mut Vec<String>) -> Result<Environment, AssetError> {
        Ok(match self {
            Self::Sky => populate::sky(1.0),
            Self::Color(Vec3::ZERO) => Environment::Black,
            Self::Color(colour) => Environment::Constant(*colour),
            Self::Image(path) => populate::panorama(load_image(path, &options.files)?, 1.0, 0.0, warnings),
        })
    }
}

/// Loads a scene as its file has it, but for the overrides; see [`load_with`].
///
/// # Errors
/// As [`load_with`].
pub fn load(path: &Path, overrides: &[String]) -> Result<Baked, SceneError> {
    load_with(path, &LoadOptions { overrides: overrides.to_vec(), ..LoadOptions::default() })
}

/// Loads a scene: a `.toml` file, or a `.gltf`, `.glb` or `.obj` file by itself.
///
/// A bare model gets the camera of the file, or one that frames it, and a sky if nothing in it emits light.
///
/// # Errors
/// Anything that is wrong with the file, with what it names, or with an option; see [`SceneError`].
pub fn load_with(path: &Path, options: &LoadOptions) -> Result<Baked, SceneError> {
    let extension = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
    let (on_disk, text) = match extension.as_str() {
        "toml" => {
            let read = options.files.read(path);
            let bytes = read.map_err(|source| SceneError::Read { path: path.to_owned(), source })?;
            let text = text::decode(path, bytes)?;
            (Some(text.clone()), text)
        }
        "gltf" | "glb" => (None, bare_scene(path, "gltf")),
        "obj" => (None, bare_scene(path, "mesh")),
        _ => {
            let (problem, help) = match foreign::known(path) {
                Some((what, remedy)) => (format!("{what}, not a scene file"), remedy),
                None if path.is_dir() => ("a folder, not a scene file".to_owned(), SCENES),
                None => ("not a scene file".to_owned(), SCENES),
            };
            return Err(SceneError::UnknownType { path: path.to_owned(), problem, help });
        }
    };
    let text = edited(path, text, &options.overrides)?;
    let source = SourceText { path, text: &text, on_disk: on_disk.as_deref() };
    let mut warnings = Vec::new();
    let environment =
        options.environment.as_ref().map(|given| given.load(options, &mut warnings)).transpose()?;
    let mut baked = build(&source, environment, options).map_err(|fault| source.locate(fault))?;
    baked.warnings.append(&mut warnings);
    Ok(baked)
}

/// The scene's text with the overrides applied; the rest keeps its lines.
fn edited(path: &Path, text: String, overrides: &[String]) -> Result<String, SceneError> {
    if overrides.is_empty() {
        return Ok(text);
    }
    let source = SourceText { path, text: &text, on_disk: Some(&text) };
    let mut document = overrides::document(&text).map_err(|fault| source.locate(fault))?;
    for text in overrides {
        overrides::apply(&mut document, text)?;
    }
    Ok(document.to_string())
}

fn build(
    source: &SourceText,
    environment: Option<Environment>,
    options: &LoadOptions,
) -> Result<Baked, Fault> {
    let file = file::parse(source.text)?;
    let has_environment = environment.is_some() || file.environment.is_some();
    let folder = source.path.parent().unwrap_or(Path::new(""));
    let bare = source.on_disk.is_none().then_some(source.path);
    let mut world = populate::populate(
        file,
        &Source { folder, bare, files: &options.files, light_scale: options.light_scale },
    )?;
    check_memory(&world, &options.files.memory())?;
    if let Some(hole) = options.black_hole {
        replace_spacetime(&mut world, hole)?;
    }
    if let Some((width, height)) = options.size {
        (world.settings.width, world.settings.height) = (width, height);
        world.has_own_size = true;
    }
    if let Some(environment) = environment {
        world.environment = environment;
    }
    if bare.is_some() && !has_environment {
        surround_model(&mut world);
    }
    bake::bake(world, options.camera.as_deref())
}

/// Puts a sky around a model in which nothing emits light, and says what is around it.
fn surround_model(world: &mut World) {
    let what = if world.emits() {
        "a model carries no world: the background is black"
    } else {
        world.environment = populate::sky(1.0);
        "nothing in the model emits light, so the built-in sky lights it"
    };
    world.notes.push(format!("{what}; --environment takes a picture, R,G,B, sky or black"));
}

/// Refuses meshes whose search tree would not fit.
fn check_memory(world: &World, memory: &Memory) -> Result<(), Fault> {
    let triangles: usize = world.meshes.iter().map(|mesh| mesh.triangles.len()).sum();
    let needed = (triangles as u64).saturating_mul(TRIANGLE_BYTES);
    memory
        .check(format!("the search tree of {triangles} triangles"), needed)
        .map_err(|flaw| Fault::whole(flaw.problem, flaw.help))
}

fn replace_spacetime(world: &mut World, [x, y, z, radius]: [f64; 4]) -> Result<(), Fault> {
    if ![x, y, z, radius].iter().all(|number| number.abs() <= check::LARGEST) || radius < 0.0 {
        return Err(Fault::whole(
            format!("the black hole {x},{y},{z},{radius} is not usable"),
            format!("give numbers X,Y,Z,RS of at most {:e}, and RS at least 0", check::LARGEST),
        ));
    }
    world.spacetime = SpacetimeKind::black_hole(DVec3::new(x, y, z), radius);
    world.has_own_spacetime = true;
    Ok(())
}

#[cfg(test)]
mod tests;
