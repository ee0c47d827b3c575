//! The scene: as authored (an ECS world), and as baked (flat tables).
//!
//! Text → `file` tables → `populate` → `World` of [`components`] → `systems` → `bake` → [`Baked`]. A glTF
//! or OBJ file by itself is a scene file with one entity.

mod bake;
mod baked;
mod camera;
mod check;
pub mod components;
mod error;
mod file;
mod foreign;
mod light;
mod overrides;
mod populate;
mod settings;
mod squash;
mod systems;
mod text;
mod world;

use std::path::Path;

use glam::DVec3;

pub use baked::{Baked, SpacetimeKind};
pub use camera::Camera;
pub use error::{Place, SceneError};
pub use settings::{
    Background, Filter, LightSampling, MAX_SEGMENTS, MAX_WINDING, Precision, SamplerKind, Schedule, Settings,
    StepperKind, flag_name,
};

use crate::asset::{Files, Memory};
use error::{Fault, SourceText};
use populate::Source;
use world::World;

/// Bytes that a triangle takes in the tree, while it is built.
const TRIANGLE_BYTES: u64 = 160;

/// What is asked of a scene beside its file.
#[derive(Debug, Default)]
pub struct LoadOptions {
    /// Overrides `path.to.key=value`, as after `--set`; array entries go by index or by name.
    pub overrides: Vec<String>,
    /// A black hole instead of the scene's spacetime: X, Y, Z of its center and its Schwarzschild radius, in scene units.
    pub black_hole: Option<[f64; 4]>,
    /// Reads the scene's files.
    pub files: Files,
}

/// What to do about a file that is none.
const SCENES: &str = "a scene is a .toml, .gltf, .glb or .obj file";

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
    build(&source, options).map_err(|fault| source.locate(fault))
}

/// The scene file that a model by itself stands for.
fn bare_scene(path: &Path, component: &str) -> String {
    format!("[[entity]]\n{component} = {}\n", toml_edit::Value::from(bare_name(path)))
}

/// What that file calls the model; not always the name itself, which may not be text.
fn bare_name(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
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

fn build(source: &SourceText, options: &LoadOptions) -> Result<Baked, Fault> {
    let file = file::parse(source.text)?;
    let sky_if_dark = source.on_disk.is_none() && file.environment.is_none();
    let folder = source.path.parent().unwrap_or(Path::new(""));
    let bare = source.on_disk.is_none().then_some(source.path);
    let mut world = populate::populate(file, &Source { folder, bare, files: &options.files })?;
    check_memory(&world, &options.files.memory())?;
    if let Some(hole) = options.black_hole {
        replace_spacetime(&mut world, hole)?;
    }
    if sky_if_dark && !world.emits() {
        world.environment = populate::sky(1.0);
    }
    bake::bake(world)
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
    let center = DVec3::new(x, y, z);
    if !(center.is_finite() && radius.is_finite() && radius >= 0.0) {
        return Err(Fault::whole(
            format!("the black hole {x},{y},{z},{radius} is not usable"),
            "give finite numbers X,Y,Z,RS with RS at least 0",
        ));
    }
    world.spacetime = populate::black_hole(center, radius);
    Ok(())
}

#[cfg(test)]
mod tests;
