//! Loading of a scene: its file, the options given beside it, and what they make of each other.

use std::path::Path;

use glam::DVec3;

use super::baked::Baked;
use super::bare_model::bare_scene;
use super::components::MeshShape;
use super::error::{Fault, SceneError, SourceText};
use super::populate::AssetSource;
use super::surroundings::{self, Surroundings};
use super::world::World;
use super::{bake, check, file, foreign, overrides, populate, text};
use crate::asset::{Files, Memory};
use crate::shade::Environment;
use crate::spacetime::SpacetimeKind;

/// Bytes that a triangle takes in the tree, while it is built.
const TRIANGLE_BYTES: u64 = 160;
/// Bytes that a triangle takes as a lamp, once for each of its mesh's instances.
const LAMP_BYTES: u64 = 512;

/// Options for loading a scene, beside its file.
#[derive(Debug, Default)]
pub struct LoadOptions {
    /// Overrides `path.to.key=value`, as after `--set`; array entries go by index or by name.
    pub overrides: Vec<String>,
    /// A black hole instead of the scene's spacetime: X, Y, Z of its center and its Schwarzschild radius, in scene
    /// units, and its spin a/M about +Y.
    pub black_hole: Option<[f64; 5]>,
    /// Light from infinity instead of the scene's.
    pub environment: Option<Surroundings>,
    /// Name of the camera, of several.
    pub camera: Option<String>,
    /// Factor on the lights of glTF files, from candela to W/sr and lux to W/m², instead of the scene's.
    pub light_scale: Option<f64>,
    /// Moment of the animations of glTF files, seconds.
    pub time: f64,
    /// Width and height of the picture instead of the scene's, pixels.
    pub size: Option<(usize, usize)>,
    /// Reads the scene's files.
    pub files: Files,
}

/// Remedy for a file that is no scene.
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
    let text = overrides::edited(path, text, &options.overrides)?;
    let source = SourceText { path, text: &text, on_disk: on_disk.as_deref() };
    let mut warnings = Vec::new();
    let environment =
        options.environment.as_ref().map(|given| given.load(&options.files, &mut warnings)).transpose()?;
    let mut baked = build(&source, environment, options).map_err(|fault| source.locate(fault))?;
    baked.warnings.append(&mut warnings);
    Ok(baked)
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
        &AssetSource {
            folder,
            bare,
            files: &options.files,
            light_scale: options.light_scale,
            time: options.time,
        },
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
        surroundings::surround(&mut world);
    }
    bake::bake(world, options.camera.as_deref())
}

/// Refuses meshes whose search tree, and instances whose lamps would not fit.
fn check_memory(world: &World, memory: &Memory) -> Result<(), Fault> {
    let check = |what: String, count: u64, bytes: u64| {
        let checked = memory.check(what, count.saturating_mul(bytes));
        checked.map_err(|flaw| Fault::whole(flaw.problem, flaw.help))
    };
    let triangles: u64 = world.meshes.iter().map(|mesh| mesh.triangles.len() as u64).sum();
    check(format!("the search tree of {triangles} triangles"), triangles, TRIANGLE_BYTES)?;
    let mut shapes = world.entities.query::<&MeshShape>();
    let parts = shapes.iter().flat_map(|shape| &shape.0);
    let lamps: u64 = parts
        .filter(|(_, material)| world.material(*material).emits())
        .filter_map(|(mesh, _)| Some(world.meshes.get(mesh.0 as usize)?.triangles.len() as u64))
        .sum();
    check(format!("the light of {lamps} triangles that emit"), lamps, LAMP_BYTES)
}

fn replace_spacetime(world: &mut World, [x, y, z, radius, spin]: [f64; 5]) -> Result<(), Fault> {
    let within = [x, y, z, radius].iter().all(|number| number.abs() <= check::LARGEST);
    if !within || radius < 0.0 || spin.abs() > 1.0 || spin.is_nan() {
        return Err(Fault::whole(
            format!("the black hole {x},{y},{z},{radius},{spin} is not usable"),
            format!(
                "give numbers X,Y,Z,RS of at most {:e}, RS at least 0, and a spin from -1 to 1",
                check::LARGEST
            ),
        ));
    }
    world.spacetime = SpacetimeKind::spinning(DVec3::new(x, y, z).into(), radius, spin);
    world.has_own_spacetime = true;
    Ok(())
}
