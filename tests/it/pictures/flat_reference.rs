//! Flat space against converged pictures of other renderers, by statistics.
//!
//! `tests/data/flat/ref_{a,b,c,p}.exr` hold R, G, B and their standard errors se.R, se.G, se.B, 256 × 192, box filter,
//! 8 segments: a by a double-precision tracer (walls are spheres of radius 1e5), b, c, p by Mitsuba 3.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

use warpfront::film::{Aov, Image, read_exr};
use warpfront::scene::{self, Filter, SamplerKind, Settings};
use warpfront::trace::{self, Run};

const BLOCK: usize = 16;
const SMALLPT: &str = r#"
[camera]
position = [50, 52, 295.6]
look_at = [50, 47.74266344570071, 195.69066567400512]
vertical_fov = 28.799316231093748
near = 140
[[material]]
name = "red"
albedo = [0.75, 0.25, 0.25]
[[material]]
name = "blue"
albedo = [0.25, 0.25, 0.75]
[[material]]
name = "white"
albedo = 0.75
[[material]]
name = "black"
albedo = 0
[[material]]
name = "mirror"
kind = "mirror"
albedo = 0.999
[[material]]
name = "glass"
kind = "dielectric"
albedo = 0.999
ior = 1.5
[[material]]
name = "light"
albedo = 0
emission = 12
[[entity]]
sphere = { center = [27, 16.5, 47], radius = 16.5 }
material = "mirror"
[[entity]]
sphere = { center = [73, 16.5, 78], radius = 16.5 }
material = "glass"
[[entity]]
sphere = { center = [50, 65, 81.6], radius = 8 }
material = "light"
"#;

/// Walls of the smallpt box: material, centre of the giant sphere.
const WALLS: [(&str, [f64; 3]); 6] = [
    ("red", [100001.0, 40.8, 81.6]),
    ("blue", [-99901.0, 40.8, 81.6]),
    ("white", [50.0, 40.8, 100000.0]),
    ("black", [50.0, 40.8, -99830.0]),
    ("white", [50.0, 100000.0, 81.6]),
    ("white", [50.0, -99918.4, 81.6]),
];

fn data(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/flat").join(name)
}

/// Writes a scene file into `folder`.
fn write_scene(folder: &Path, text: &str) -> PathBuf {
    let path = folder.join("scene.toml");
    fs::write(&path, text).expect("the temporary folder is writable");
    path
}

/// Scene a: walls are spheres.
fn sphere_walls(folder: &Path) -> PathBuf {
    let walls = WALLS.map(|(material, center)| {
        format!("[[entity]]\nsphere = {{ center = {center:?}, radius = 1e5 }}\nmaterial = \"{material}\"\n")
    });
    write_scene(folder, &format!("{SMALLPT}{}", walls.concat()))
}

/// Scene p: walls are rectangles of an OBJ each.
fn planar_walls(folder: &Path) -> PathBuf {
    let (low, high) = ([1.0, 0.0, 0.0], [99.0, 81.6, 170.0]);
    let mut text = SMALLPT.to_string();
    for (wall, (material, center)) in WALLS.iter().enumerate() {
        let axis = wall_axis(wall);
        // The wall lies towards the centre of the giant sphere that it replaces, seen from the other side of the room.
        let at = if center[axis] > 0.0 { low[axis] } else { high[axis] };
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        let corner = |cu: f64, cv: f64| {
            let mut p = [at; 3];
            (p[u], p[v]) = (cu, cv);
            format!("v {} {} {}\n", p[0], p[1], p[2])
        };
        let corners = [(low[u], low[v]), (high[u], low[v]), (high[u], high[v]), (low[u], high[v])];
        let vertices: String = corners.into_iter().map(|(cu, cv)| corner(cu, cv)).collect();
        fs::write(folder.join(format!("wall{wall}.obj")), format!("{vertices}f 1 2 3 4\n"))
            .expect("writable");
        text += &format!("[[entity]]\nmesh = \"wall{wall}.obj\"\nmaterial = \"{material}\"\n");
    }
    write_scene(folder, &text)
}

fn wall_axis(wall: usize) -> usize {
    [0, 0, 2, 2, 1, 1][wall]
}

fn render(path: &Path, spp: u32) -> Image {
    render_with(path, (256, 192), spp, |_| {})
}

fn render_with(path: &Path, size: (usize, usize), spp: u32, set: impl Fn(&mut Settings)) -> Image {
    let mut scene = scene::load(path, &[]).unwrap_or_else(|error| panic!("{error}"));
    let settings = &mut scene.settings;
    (settings.width, settings.height, settings.filter) = (size.0, size.1, Filter::Box);
    (settings.spp, settings.max_depth, settings.roulette_depth) = (spp, 8, 5);
    set(settings);
    let run = Run { aovs: vec![Aov::Variance], ..Run::default() };
    trace::render(&scene, &run, &AtomicBool::new(false), &|_| {}).image
}

/// Mean and variance of the mean over a block of pixels.
#[derive(Clone, Copy)]
struct Estimate {
    mean: f64,
    variance: f64,
}

fn plane<'a>(image: &'a Image, name: &str) -> &'a [f32] {
    &image
        .channels
        .iter()
        .find(|plane| plane.name == name)
        .unwrap_or_else(|| panic!("no channel {name}"))
        .values
}

/// Estimates over blocks of `size` pixels, from means and variances of single pixels.
fn blocks(means: &[f32], variances: &[f64], width: usize, size: (usize, usize)) -> Vec<Estimate> {
    let height = means.len() / width;
    let mut estimates = Vec::new();
    for y0 in (0..height).step_by(size.1) {
        for x0 in (0..width).step_by(size.0) {
            let mut sum = Estimate { mean: 0.0, variance: 0.0 };
            for y in y0..y0 + size.1 {
                for x in x0..x0 + size.0 {
                    sum.mean += f64::from(means[y * width + x]);
                    sum.variance += variances[y * width + x];
                }
            }
            let count = (size.0 * size.1) as f64;
            estimates.push(Estimate { mean: sum.mean / count, variance: sum.variance / (count * count) });
        }
    }
    estimates
}

/// P(|z| > x) of a normal variable.
fn two_sided_tail(x: f64) -> f64 {
    libm::erfc(x / std::f64::consts::SQRT_2)
}

/// Compares a render with its reference: relative difference of the means below `bound`, and no block's z-score beyond
/// what 1 % of right renders show (Šidák over all blocks and channels).
fn compare(name: &str, image: &Image, bound: f64) {
    let reference = read_exr(&data(&format!("ref_{name}.exr"))).unwrap_or_else(|error| panic!("{error}"));
    let mut worst: f64 = 0.0;
    let mut tests = 0;
    for channel in ["R", "G", "B"] {
        let ours: Vec<f64> = plane(image, &format!("variance.{channel}")).iter().map(|&v| v.into()).collect();
        let theirs: Vec<f64> =
            plane(&reference, &format!("se.{channel}")).iter().map(|&se| f64::from(se).powi(2)).collect();
        let whole = |means: &[f32], variances: &[f64]| blocks(means, variances, 256, (256, 192))[0];
        let (a, b) = (whole(plane(image, channel), &ours), whole(plane(&reference, channel), &theirs));
        let (difference, error) = (a.mean / b.mean - 1.0, (a.variance + b.variance).sqrt() / b.mean);
        println!(
            "{name} {channel}: mean {:.5} against {:.5}, {:+.3} % ± {:.3} %",
            a.mean,
            b.mean,
            100.0 * difference,
            100.0 * error
        );
        assert!(
            difference.abs() < bound,
            "{name} {channel}: means differ by {difference:.5}, more than {bound}"
        );
        let ours = blocks(plane(image, channel), &ours, 256, (BLOCK, BLOCK));
        let theirs = blocks(plane(&reference, channel), &theirs, 256, (BLOCK, BLOCK));
        for (a, b) in ours.iter().zip(&theirs) {
            let deviation = (a.variance + b.variance).sqrt();
            tests += 1;
            if deviation > 0.0 {
                worst = worst.max((a.mean - b.mean).abs() / deviation);
            } else {
                assert_eq!(a.mean, b.mean, "{name} {channel}: blocks without noise differ");
            }
        }
    }
    let probability = 1.0 - (1.0 - two_sided_tail(worst)).powi(tests);
    println!("{name}: largest z {worst:.2} of {tests}, probability {probability:.3}");
    assert!(
        probability > 0.01,
        "{name}: a block differs by {worst:.2} standard errors, probability {probability:.2e}"
    );
}

#[test]
fn walls_that_are_spheres_of_radius_1e5_match_a_double_precision_tracer() {
    let folder = tempfile::tempdir().expect("temporary folder");
    compare("a", &render(&sphere_walls(folder.path()), 128), 0.003);
}

#[test]
fn planar_walls_with_mirror_and_glass_match_mitsuba() {
    let folder = tempfile::tempdir().expect("temporary folder");
    compare("p", &render(&planar_walls(folder.path()), 128), 0.003);
}

#[test]
fn the_cornell_box_of_rectangles_matches_mitsuba() {
    compare("b", &render(&data("cornell_b.glb"), 128), 0.003);
}

#[test]
fn a_box_with_327_680_triangles_matches_mitsuba() {
    compare("c", &render(&data("cornell_bumpy_c.glb"), 64), 0.005);
}

/// Mean of (a − b)²/(b² + 0.01) against a reference, whose pixels are taken together.
fn relative_mse(name: &str, image: &Image) -> f64 {
    let reference = read_exr(&data(&format!("ref_{name}.exr"))).unwrap_or_else(|error| panic!("{error}"));
    let (width, by) = (image.size.0, reference.size.0 / image.size.0);
    let count = 3 * width * image.size.1;
    let errors = ["R", "G", "B"].into_iter().flat_map(|channel| {
        let [mean, deviation] =
            [channel, format!("se.{channel}").as_str()].map(|name| plane(&reference, name));
        let variances: Vec<f64> = deviation.iter().map(|&se| f64::from(se).powi(2)).collect();
        let truth = blocks(mean, &variances, reference.size.0, (by, by));
        let error = |(&a, b): (&f32, Estimate)| {
            ((f64::from(a) - b.mean).powi(2) - b.variance) / (b.mean * b.mean + 0.01)
        };
        plane(image, channel).iter().zip(truth).map(error).collect::<Vec<_>>()
    });
    errors.sum::<f64>() / count as f64
}

#[test]
fn few_samples_of_the_cornell_box_leave_less_error_than_those_of_mitsuba() {
    for (spp, bound) in [(16, 0.0075), (64, 0.0015)] {
        let seeds = 0..2;
        let error = |seed| {
            let image = render_with(&data("cornell_b.glb"), (128, 96), spp, |settings| settings.seed = seed);
            relative_mse("b", &image)
        };
        let mean = seeds.clone().map(error).sum::<f64>() / f64::from(seeds.end as u32);
        println!("{spp} samples: {mean:.5}");
        assert!(mean < bound, "{spp} samples: {mean}, not {bound}");
    }
}

#[test]
fn variances_are_those_between_pictures_for_independent_samples_and_little_above_for_sobol() {
    for (sampler, bounds) in [(SamplerKind::Independent, 0.9..1.1), (SamplerKind::Sobol, 1.0..1.6)] {
        const SEEDS: u64 = 16;
        let picture = |seed| {
            render_with(&data("cornell_b.glb"), (32, 24), 64, |settings| {
                (settings.sampler, settings.seed) = (sampler, seed);
            })
        };
        let pictures: Vec<Image> = (0..SEEDS).map(picture).collect();
        let (mut said, mut found) = (0.0, 0.0);
        for pixel in 0..32 * 24 {
            let of =
                |name: &'static str| pictures.iter().map(move |image| f64::from(plane(image, name)[pixel]));
            let mean = of("R").sum::<f64>() / SEEDS as f64;
            // Dark pixels count as much as bright ones.
            let weight = 1.0 / (mean * mean + 0.01);
            found += weight * of("R").map(|value| (value - mean).powi(2)).sum::<f64>() / (SEEDS - 1) as f64;
            said += weight * of("variance.R").sum::<f64>() / SEEDS as f64;
        }
        println!("{sampler:?}: {:.3}", said / found);
        assert!(bounds.contains(&(said / found)), "{sampler:?}: {said} for {found}");
    }
}
