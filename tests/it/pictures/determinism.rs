//! A picture depends on nothing but the scene: not on schedule, threads, batches or crop.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};

use crate::support::command::{Folder, assert_good};
use crate::support::{render, scene_file, scene_path};
use clap::ValueEnum;
use warpfront::film::{Aov, Image};
use warpfront::scene::{Precision, SamplerKind, StepperKind, flag_name};
use warpfront::spacetime::SpacetimeKind;
use warpfront::trace::{Run, Session};

const SMALL: [&str; 3] = ["film.width=40", "film.height=34", "render.spp=16"];

fn scenes() -> Vec<PathBuf> {
    let entries = std::fs::read_dir(scene_path("")).expect("scenes");
    let paths = entries.map(|entry| entry.expect("entry").path());
    let mut scenes: Vec<PathBuf> =
        paths.filter(|path| path.extension().is_some_and(|e| e == "toml")).collect();
    scenes.sort();
    assert!(scenes.len() >= 9, "{scenes:?}");
    scenes
}

/// A run with every plane there is.
fn run() -> Run {
    Run { aovs: Aov::ALL.to_vec(), ..Run::default() }
}

fn image(path: &Path, overrides: &[&str], run: &Run) -> Image {
    render(&scene_file(path, &[&SMALL, overrides].concat()), run).image
}

fn assert_same_bits(one: &Image, other: &Image, what: &str) {
    assert_eq!((one.size, one.channels.len()), (other.size, other.channels.len()), "{what}");
    for (a, b) in one.channels.iter().zip(&other.channels) {
        let pairs = || a.values.iter().zip(&b.values);
        let different = pairs().filter(|(x, y)| x.to_bits() != y.to_bits()).count();
        let first = pairs().position(|(x, y)| x.to_bits() != y.to_bits());
        assert_eq!(different, 0, "{what}: plane {} differs, first at {first:?}", a.name);
    }
}

fn assert_schedules_agree(path: &Path, overrides: &[&str]) {
    let with = |schedule| image(path, &[overrides, &[schedule]].concat(), &run());
    let what = format!("{} {overrides:?}", path.display());
    assert_same_bits(&with("render.schedule=wavefront"), &with("render.schedule=per-pixel"), &what);
}

/// Rays land exactly only for planes that tell where.
#[test]
fn surfaces_that_only_emit_look_the_same_whatever_planes_are_asked_for() {
    let path = scene_path("accretion_disk.toml");
    let all = image(&path, &[], &run());
    let colours = |image: &Image| -> Vec<Vec<u32>> {
        let channel = |name| image.channel(name).expect("a colour").iter().map(|value| value.to_bits());
        ["R", "G", "B"].map(|name| channel(name).collect()).into()
    };
    assert!(colours(&all)[0].iter().any(|&bits| f32::from_bits(bits) > 0.5), "the disk is seen");
    for schedule in ["render.schedule=wavefront", "render.schedule=per-pixel"] {
        let alone = image(&path, &[schedule], &Run::default());
        assert!(colours(&alone) == colours(&all), "{schedule}");
    }
}

/// What one plane needs may be recorded for another.
#[test]
fn a_plane_alone_is_the_same_as_beside_all_others() {
    let path = scene_path("cornell_black_hole.toml");
    let all = image(&path, &[], &run());
    for &plane in Aov::ALL {
        let alone = image(&path, &[], &Run { aovs: vec![plane], ..Run::default() });
        for channel in plane.channels() {
            let bits = |image: &Image| -> Vec<u32> {
                image.channel(channel).expect(channel).iter().map(|value| value.to_bits()).collect()
            };
            assert!(bits(&alone) == bits(&all), "{channel}");
        }
    }
}

#[test]
fn both_schedules_give_the_same_bits_in_every_scene() {
    scenes().iter().for_each(|path| assert_schedules_agree(path, &[]));
}

#[test]
fn both_schedules_give_the_same_bits_with_every_stepper_in_either_precision() {
    let path = scene_path("cornell_black_hole.toml");
    for &stepper in StepperKind::value_variants() {
        for &precision in Precision::value_variants() {
            let stepper = format!("render.stepper={}", flag_name(stepper));
            let precision = format!("render.precision={}", flag_name(precision));
            // Single precision does not reach the default tolerance.
            let all = [&stepper, &precision, "film.width=24", "film.height=18", "render.spp=4"];
            assert_schedules_agree(&path, &[&all[..], &["render.tolerance=1e-4"]].concat());
        }
    }
}

#[test]
fn both_schedules_give_the_same_bits_with_every_sampler() {
    for &sampler in SamplerKind::value_variants() {
        let sampler = format!("render.sampler={}", flag_name(sampler));
        assert_schedules_agree(&scene_path("cornell_black_hole.toml"), &[&sampler]);
    }
}

#[test]
fn both_schedules_give_the_same_bits_with_every_way_to_sample_lights() {
    for name in ["cornell_black_hole.toml", "hole_in_glass.toml", "room_black_hole.toml"] {
        for way in [
            "light_sampling=off",
            "light_sampling=straight",
            "max_winding=0",
            "max_winding=3",
            "mis=power",
            "max_depth=2",
        ] {
            assert_schedules_agree(&scene_path(name), &[&format!("render.{way}")]);
        }
    }
}

#[test]
fn one_two_and_three_threads_give_the_same_bits() {
    for name in ["cornell_black_hole.toml", "teapot_black_hole.toml", "room_black_hole.toml"] {
        let with = |threads| image(&scene_path(name), &[], &Run { threads, ..run() });
        let one = with(1);
        assert_same_bits(&one, &with(2), name);
        assert_same_bits(&one, &with(3), name);
    }
}

#[test]
fn one_and_two_threads_give_the_same_files() {
    let folder = Folder::with(&[]);
    let scene = scene_path("room_black_hole.toml");
    let flags = ["--size", "40x34", "--spp", "16", "--aov", "depth,normal,entity,variance"];
    for threads in ["1", "2"] {
        let output = format!("{threads}.exr");
        let command = ["render", scene.to_str().unwrap(), "-o", &output, "--threads", threads];
        assert_good(&folder.run(&[&command[..], &flags].concat()));
    }
    let bytes = |name: &str| fs::read(folder.path(name)).unwrap();
    assert!(bytes("1.exr") == bytes("2.exr"), "EXR");
    assert!(bytes("1.png") == bytes("2.png"), "PNG");
}

#[test]
fn small_and_large_batches_give_the_same_bits() {
    for name in ["cornell_black_hole.toml", "cornell_flat.toml", "room_black_hole.toml"] {
        let with = |batch| image(&scene_path(name), &[], &Run { batch, ..run() });
        assert_same_bits(&with(64), &with(65536), name);
        assert_same_bits(&with(1), &with(64), name);
    }
}

#[test]
fn a_crop_holds_the_pixels_of_the_whole_picture() {
    let path = scene_path("cornell_black_hole.toml");
    let [x0, y0, x1, y1] = [5, 1, 38, 30];
    let whole = image(&path, &[], &run());
    let crop = image(&path, &[], &Run { crop: Some([x0, y0, x1, y1]), ..run() });
    assert_eq!((crop.origin, crop.size), ((x0, y0), (x1 - x0, y1 - y0)));
    let mut cut = whole.clone();
    cut.size = crop.size;
    for plane in &mut cut.channels {
        let rows = plane.values.chunks(whole.size.0).skip(y0).take(y1 - y0);
        plane.values = rows.flat_map(|row| row[x0..x1].to_vec()).collect();
    }
    assert_same_bits(&cut, &crop, "crop");
}

#[test]
fn a_hole_of_radius_zero_is_flat_space_to_the_last_bit() {
    let overrides = [&SMALL[..], &["spacetime.schwarzschild_radius=0"]].concat();
    let empty = scene_file(&scene_path("cornell_series.toml"), &overrides);
    assert_eq!(empty.spacetime, SpacetimeKind::Flat);
    let flat = image(&scene_path("cornell_flat.toml"), &[], &run());
    assert_same_bits(&flat, &render(&empty, &run()).image, "r_s = 0");
}

#[test]
fn another_seed_gives_another_picture() {
    let path = scene_path("cornell_flat.toml");
    let with = |seed| image(&path, &[seed], &Run::default()).channel("R").expect("R").to_vec();
    assert_ne!(with("render.seed=1"), with("render.seed=2"));
}

#[test]
fn a_render_put_away_and_extended_twice_gives_the_bits_of_one_that_ran_through() {
    let path = scene_path("cornell_black_hole.toml");
    let scene = scene_file(&path, &SMALL);
    let (run, cancel) = (run(), AtomicBool::new(false));
    let mut session = Session::new(&scene, &run, &cancel);
    // Neither stop is one that passes make by themselves.
    for stop in [3, 11, 16] {
        session = Session::resume(&scene, &run, &cancel, session.into_state()).expect("the same picture");
        while session.pass(stop, |_| ()) {}
        assert_eq!(session.state().spp(), stop);
    }
    let through = image(&path, &[], &run);
    assert_same_bits(&session.image(), &through, "16 samples in three sessions");
    assert_same_bits(&session.into_image(), &through, "16 samples in three sessions, at their end");
}

#[test]
fn a_session_that_is_cancelled_goes_on_from_its_state() {
    let path = scene_path("cornell_black_hole.toml");
    let scene = scene_file(&path, &SMALL);
    let (run, cancel) = (Run { threads: 1, ..run() }, AtomicBool::new(false));
    let mut session = Session::new(&scene, &run, &cancel);
    assert!(session.pass(16, |_| ()));
    // One tile of the second pass is finished, the others are not begun.
    assert!(!session.pass(16, |_| cancel.store(true, Ordering::Relaxed)));
    assert!(!session.pass(16, |_| ()));
    assert_eq!(session.state().spp(), 1);
    let go_on = AtomicBool::new(false);
    let mut session = Session::resume(&scene, &run, &go_on, session.into_state()).expect("the same picture");
    while session.pass(16, |_| ()) {}
    assert_same_bits(&session.into_image(), &image(&path, &[], &run), "cancelled and resumed");
}

#[test]
fn a_session_does_not_resume_another_picture() {
    let scene = scene_file(&scene_path("cornell_black_hole.toml"), &SMALL);
    let cancel = AtomicBool::new(false);
    let (whole, beauty) = (run(), Run::default());
    let crop = Run { crop: Some([0, 0, 8, 8]), ..run() };
    for other in [beauty, crop] {
        let state = Session::new(&scene, &whole, &cancel).into_state();
        assert!(Session::resume(&scene, &other, &cancel, state).is_none());
    }
}
