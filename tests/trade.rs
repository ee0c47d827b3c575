//! The trade of speed for accuracy on the paper's Cornell box: the README's table.
//!
//! `cargo test --release --test trade -- --ignored --nocapture`

use std::path::Path;
use std::sync::atomic::AtomicBool;

use warpfront::film::{Aov, Image};
use warpfront::scene::{self, Baked, Filter, Schedule, Settings, StepperKind};
use warpfront::trace::{self, Rendered, Run};

fn cornell(change: impl Fn(&mut Settings)) -> Baked {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/cornell_black_hole.toml");
    let mut scene = scene::load(&path, &[]).unwrap_or_else(|error| panic!("{error}"));
    (scene.settings.width, scene.settings.height, scene.settings.filter) = (320, 240, Filter::Box);
    change(&mut scene.settings);
    scene
}

fn render(scene: &Baked, aovs: Vec<Aov>) -> Rendered {
    trace::render(scene, &Run { aovs, ..Run::default() }, &AtomicBool::new(false), &|_| {})
}

/// First hits of one sample per pixel.
fn hits(change: impl Fn(&mut Settings)) -> Image {
    let scene = cornell(|settings| {
        change(settings);
        settings.spp = 1;
    });
    render(&scene, vec![Aov::Position, Aov::Entity]).image
}

/// Median and 99th percentile of the distance between first hits, where both images meet the same entity.
fn errors(image: &Image, exact: &Image) -> (f64, f64) {
    let plane = |image: &Image, name: &str| image.plane(name).expect("asked for").to_vec();
    let [x, y, z] = ["position.X", "position.Y", "position.Z"].map(|n| (plane(image, n), plane(exact, n)));
    let (entity, expected) = (plane(image, "entity.ID"), plane(exact, "entity.ID"));
    let square = |axis: &(Vec<f32>, Vec<f32>), i: usize| f64::from(axis.0[i] - axis.1[i]).powi(2);
    let mut distances: Vec<f64> = (0..entity.len())
        .filter(|&i| entity[i] == expected[i] && entity[i] != 0.0)
        .map(|i| (square(&x, i) + square(&y, i) + square(&z, i)).sqrt())
        .collect();
    distances.sort_by(f64::total_cmp);
    (distances[distances.len() / 2], distances[distances.len() * 99 / 100])
}

#[test]
#[ignore = "prints the README's table of speed against accuracy; a measurement, not a check"]
fn speed_against_accuracy() {
    let exact = hits(|settings| (settings.tolerance, settings.arc_tolerance) = (1e-11, Some(1e-6)));
    let row = |name: &str, change: &dyn Fn(&mut Settings)| {
        let (median, most) = errors(&hits(change), &exact);
        let scene = cornell(|settings| {
            change(settings);
            settings.spp = 4;
        });
        let stats = render(&scene, Vec::new()).stats;
        println!(
            "| {name} | {:.2} | {:.2} | {:.0} 000 | {median:.0e} | {most:.0e} |",
            stats.steps_per_ray,
            stats.queries_per_ray,
            stats.paths_per_second / 1000.0
        );
    };
    println!("| setting | steps/ray | queries/ray | paths/s | median error | 99 % below |");
    row("`--quality draft`", &|s| (s.tolerance, s.arc_tolerance_factor) = (1e-3, 4.0));
    row("`--quality standard`", &|_| {});
    row("`--quality reference`", &|s| (s.tolerance, s.arc_tolerance_factor) = (1e-8, 0.1));
    row("`--stepper rkn4`", &|s| s.stepper = StepperKind::Rkn4);
    row("`--tolerance 1e-4`", &|s| s.tolerance = 1e-4);
    row("`--tolerance 1e-6`", &|s| s.tolerance = 1e-6);
    row("`--arc-tolerance 0.1`", &|s| s.arc_tolerance = Some(0.1));
    row("`--arc-tolerance 0.001`", &|s| s.arc_tolerance = Some(0.001));
    row("`--schedule per-pixel`", &|s| s.schedule = Schedule::PerPixel);
    row("`--stepper rk4-paper --schedule per-pixel`", &|s| {
        (s.stepper, s.schedule) = (StepperKind::Rk4Paper, Schedule::PerPixel);
    });
}
