//! What the integration tests share: reference tables, scenes from text, meshes, random numbers.

pub mod chi_square;
pub mod command;
pub mod dice;
pub mod heap;
pub mod lit;
pub mod orbits;
pub mod quads;

use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

use glam::DVec3;
use rand::rngs::Xoshiro256PlusPlus;
use rand::{RngExt, SeedableRng};
use tempfile::TempDir;
use warpfront::scene::{Baked, StepperKind, flag_name, load};
use warpfront::trace::{self, Rendered, Run};

/// A row of a table.
#[derive(Debug)]
pub struct Row(BTreeMap<String, String>);

impl Row {
    /// The text of a cell.
    pub fn text(&self, column: &str) -> &str {
        self.0.get(column).unwrap_or_else(|| panic!("no column {column}"))
    }

    /// The number in a cell, if it is not empty.
    pub fn maybe(&self, column: &str) -> Option<f64> {
        let text = self.text(column);
        (!text.is_empty()).then(|| text.parse().unwrap_or_else(|_| panic!("{column} = {text}")))
    }

    /// The number in a cell.
    pub fn number(&self, column: &str) -> f64 {
        self.maybe(column).unwrap_or_else(|| panic!("{column} is empty"))
    }

    /// Three numbers.
    pub fn vector(&self, columns: [&str; 3]) -> DVec3 {
        DVec3::from(columns.map(|column| self.number(column)))
    }
}

/// The text of `tests/data/name`.
pub fn data(name: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data").join(name);
    std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// The rows of `tests/data/name`.
pub fn table(name: &str) -> Vec<Row> {
    let text = data(name);
    let mut lines = text.lines().filter(|line| !line.starts_with('#'));
    let names: Vec<&str> = lines.next().expect("column names").split(',').collect();
    let row = |line: &str| {
        let cells: Vec<&str> = line.split(',').collect();
        assert_eq!(cells.len(), names.len(), "{line}");
        Row(names.iter().zip(cells).map(|(name, cell)| (name.to_string(), cell.to_string())).collect())
    };
    lines.map(row).collect()
}

/// The names of all steppers that follow the rays of a hole that does not spin to a tolerance.
pub fn orbit_steppers() -> Vec<String> {
    StepperKind::AROUND_A_HOLE.map(flag_name).to_vec()
}

/// The path of a file in `scenes/`.
pub fn scene_path(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes").join(name)
}

/// A scene from its text.
pub fn scene(text: &str) -> Baked {
    scene_with(text, &[])
}

/// A scene from its text and the files beside it.
pub fn scene_with(text: &str, files: &[(&str, &str)]) -> Baked {
    let folder = TempDir::new().unwrap();
    for (name, content) in files {
        std::fs::write(folder.path().join(name), content).unwrap();
    }
    let path = folder.path().join("scene.toml");
    std::fs::write(&path, text).unwrap();
    load(&path, &[]).unwrap_or_else(|error| panic!("{error}\n{text}"))
}

/// The scene of a file, with overrides.
pub fn scene_file(path: &Path, overrides: &[&str]) -> Baked {
    let overrides: Vec<String> = overrides.iter().map(|text| text.to_string()).collect();
    load(path, &overrides).unwrap_or_else(|error| panic!("{error}"))
}

/// `[spacetime]`.
pub fn hole(center: DVec3, schwarzschild_radius: f64) -> String {
    format!(
        "[spacetime]\nkind = \"schwarzschild\"\ncenter = {}\nschwarzschild_radius = {schwarzschild_radius:?}\n",
        vector(center)
    )
}

/// `[spacetime]` of an Ellis wormhole, with further keys.
pub fn wormhole(center: DVec3, throat_radius: f64, keys: &str) -> String {
    format!(
        "[spacetime]\nkind = \"ellis-wormhole\"\ncenter = {}\nthroat_radius = {throat_radius:?}\n{keys}",
        vector(center)
    )
}

/// `[spacetime]` of Interstellar's wormhole, of a throat radius, a throat length and a lensing width, with further keys.
pub fn interstellar(center: DVec3, [radius, length, width]: [f64; 3], keys: &str) -> String {
    format!(
        "[spacetime]\nkind = \"interstellar-wormhole\"\ncenter = {}\nthroat_radius = {radius:?}\nthroat_length = {length:?}\nlensing_width = {width:?}\n{keys}",
        vector(center)
    )
}

/// `[spacetime]` of every kind in which lights are looked for in another way, with its name: no hole, holes of a
/// Schwarzschild radius, without and with spin, and a wormhole of half that throat radius.
pub fn spacetimes(center: DVec3, size: f64) -> [(&'static str, String); 4] {
    let spinning =
        hole(center, size).replace("schwarzschild\"\n", "kerr\"\n") + "spin = 0.9\naxis = [1, 3, 1]\n";
    [
        ("flat", String::new()),
        ("around a hole", hole(center, size)),
        ("around a spinning hole", spinning),
        ("before a wormhole", wormhole(center, 0.5 * size, "")),
    ]
}

/// The entity or camera of a text, on the far side.
pub fn far(text: &str) -> String {
    text.to_owned() + "side = \"far\"\n"
}

/// `[camera]`; looks from `position` to `target`.
pub fn camera(position: DVec3, target: DVec3, vertical_fov: f64) -> String {
    // Any direction far from parallel to the view will do.
    let up = (target - position).any_orthogonal_vector();
    format!(
        "[camera]\nposition = {}\ndirection = {}\nup = {}\nvertical_fov = {vertical_fov:?}\n",
        vector(position),
        vector(target - position),
        vector(up)
    )
}

/// `[film]`, with the box filter.
pub fn film(width: usize, height: usize) -> String {
    format!("[film]\nwidth = {width}\nheight = {height}\nfilter = \"box\"\n")
}

/// `[[material]]`.
pub fn material(name: &str, albedo: f64, emission: f64) -> String {
    format!("[[material]]\nname = \"{name}\"\nalbedo = {albedo:?}\nemission = {emission:?}\n")
}

/// `[[entity]]` with a sphere.
pub fn sphere(center: DVec3, radius: f64, material: &str) -> String {
    format!(
        "[[entity]]\nsphere = {{ center = {}, radius = {radius:?} }}\nmaterial = \"{material}\"\n",
        vector(center)
    )
}

/// `[[entity]]` with a mesh, moved to `place`.
pub fn mesh(file: &str, place: DVec3, material: &str) -> String {
    format!(
        "[[entity]]\nmesh = \"{file}\"\nmaterial = \"{material}\"\ntransform = {{ translate = {} }}\n",
        vector(place)
    )
}

/// A vector in TOML, to the last bit.
pub fn vector(v: DVec3) -> String {
    format!("[{:?}, {:?}, {:?}]", v.x, v.y, v.z)
}

/// An OBJ file.
pub fn obj(positions: &[DVec3], triangles: &[[usize; 3]]) -> String {
    let mut text = String::new();
    for p in positions {
        let _ = writeln!(text, "v {:?} {:?} {:?}", p.x, p.y, p.z);
    }
    for [a, b, c] in triangles {
        let _ = writeln!(text, "f {} {} {}", a + 1, b + 1, c + 1);
    }
    text
}

/// An OBJ file with the rectangle `center` ± `u` ± `v`, its front towards u × v.
pub fn rectangle(center: DVec3, u: DVec3, v: DVec3) -> String {
    obj(&[center - u - v, center + u - v, center + u + v, center - u + v], &[[0, 1, 2], [0, 2, 3]])
}

/// An OBJ file with a closed box, fronts inwards.
pub fn closed_box(min: DVec3, max: DVec3) -> String {
    let corner = |i: usize| {
        let pick = |bit: usize, low: f64, high: f64| if i >> bit & 1 == 0 { low } else { high };
        DVec3::new(pick(0, min.x, max.x), pick(1, min.y, max.y), pick(2, min.z, max.z))
    };
    let quads = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let triangles: Vec<[usize; 3]> = quads.iter().flat_map(|&[a, b, c, d]| [[a, c, b], [a, d, c]]).collect();
    obj(&(0..8).map(corner).collect::<Vec<_>>(), &triangles)
}

/// Renders with all cores.
pub fn render(scene: &Baked, run: &Run) -> Rendered {
    trace::render(scene, run, &AtomicBool::new(false), &|_| ())
}

/// Mean of the red plane.
pub fn mean_red(rendered: &Rendered) -> f64 {
    let red = rendered.image.channel("R").expect("R");
    red.iter().map(|&value| f64::from(value)).sum::<f64>() / red.len() as f64
}

/// Least and greatest value of the red plane.
pub fn red_range(rendered: &Rendered) -> (f32, f32) {
    let red = rendered.image.channel("R").expect("R");
    red.iter().fold((f32::INFINITY, f32::NEG_INFINITY), |(low, high), &v| (low.min(v), high.max(v)))
}

/// Random numbers that are the same in every run.
pub struct Random(Xoshiro256PlusPlus);

impl Random {
    pub fn new(seed: u64) -> Self {
        Self(Xoshiro256PlusPlus::seed_from_u64(seed))
    }

    /// Uniform in [low, high).
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.0.random::<f64>()
    }

    /// Log-uniform in [low, high).
    pub fn log_between(&mut self, low: f64, high: f64) -> f64 {
        self.between(low.ln(), high.ln()).exp()
    }

    /// Uniform in the cube [−1, 1)³.
    pub fn in_cube(&mut self) -> DVec3 {
        DVec3::from([0; 3].map(|_| self.between(-1.0, 1.0)))
    }

    /// A unit vector, uniform over the sphere.
    pub fn direction(&mut self) -> DVec3 {
        loop {
            let v = self.in_cube();
            if (1e-3..1.0).contains(&v.length_squared()) {
                return v.normalize();
            }
        }
    }
}
