//! Pictures through wormholes: furnaces, light sampling, both schedules, what a scene may say of its far side.

use crate::support::lit::{Agreement, disk, picture};
use crate::support::{
    Random, camera, closed_box, far, film, interstellar, material, mean_red, mesh, red_range, render,
    scene_file, scene_path, scene_with, sphere, vector, wormhole,
};
use glam::DVec3;
use tempfile::TempDir;
use warpfront::film::Aov;
use warpfront::scene::LightSampling::{Geodesic, Off};
use warpfront::scene::{Baked, load};
use warpfront::trace::Run;

/// The far mouth of the furnaces.
const BEYOND: DVec3 = DVec3::new(5.0, 1.0, -2.0);

/// Throats of the furnaces: Ellis's, and Interstellar's, of a radius, a length and a lensing width.
const THROATS: [Option<[f64; 3]>; 4] =
    [None, Some([0.8, 0.8, 0.5]), Some([0.8, 0.0, 1.5]), Some([0.5, 0.3, 0.03])];

/// A wormhole about the origin of a throat of the furnaces.
fn around_origin(throat: Option<[f64; 3]>, place: &str) -> String {
    match throat {
        None => wormhole(DVec3::ZERO, 1.0, place),
        Some(lengths) => interstellar(DVec3::ZERO, lengths, place),
    }
}

/// Closed rooms of albedo and emission ½ around both mouths, with balls close to them; the camera is on either side.
fn furnace(throat: Option<[f64; 3]>, is_far: bool, settings: &str) -> Baked {
    let place = format!("far_center = {}\nfar_rotate = [10, 200, 30]\n", vector(BEYOND));
    let eye = DVec3::new(1.2, 0.3, -1.7);
    let view =
        camera(if is_far { BEYOND + eye } else { eye }, if is_far { BEYOND } else { DVec3::ZERO }, 100.0);
    let text = around_origin(throat, &place)
        + &if is_far { far(&view) } else { view }
        + &film(16, 16)
        + settings
        + &material("wall", 0.5, 0.5)
        + &mesh("box.obj", DVec3::ZERO, "wall")
        + &far(&mesh("box.obj", BEYOND, "wall"))
        + &sphere(DVec3::new(0.9, 0.0, 0.1), 0.3, "wall")
        + &far(&sphere(BEYOND + DVec3::new(-0.3, 0.9, 0.3), 0.4, "wall"));
    let walls = closed_box(DVec3::new(-2.0, -2.5, -3.0), DVec3::new(2.0, 1.5, 2.5));
    scene_with(&text, &[("box.obj", &walls)])
}

#[test]
fn closed_rooms_around_both_mouths_have_radiance_one_everywhere() {
    let whole = "[render]\nspp = 4\nmax_depth = 400\nroulette_depth = 400\nlight_sampling = \"off\"\n";
    for (throat, is_far) in THROATS.into_iter().flat_map(|throat| [(throat, false), (throat, true)]) {
        let (low, high) = red_range(&render(&furnace(throat, is_far, whole), &Run::default()));
        let what = format!("{throat:?}, far {is_far}: from {low} to {high}");
        assert!((low - 1.0).abs() < 1e-6 && (high - 1.0).abs() < 1e-6, "{what}");
    }
}

#[test]
fn light_sampling_through_the_throat_keeps_the_mean_of_a_furnace() {
    for winding in [0, 1, 3] {
        let settings =
            format!("[render]\nspp = 64\nmax_depth = 400\nroulette_depth = 5\nmax_winding = {winding}\n");
        for (throat, is_far) in THROATS.into_iter().flat_map(|throat| [(throat, false), (throat, true)]) {
            let mean = mean_red(&render(&furnace(throat, is_far, &settings), &Run::default()));
            let what = format!("{throat:?}, winding numbers up to {winding}, far {is_far}: {mean}");
            println!("{what}");
            assert!((mean - 1.0).abs() < 3e-3, "{what}");
        }
    }
}

/// Two rooms that a wormhole joins, with lights on either side or both, and other things at random places.
fn rooms(random: &mut Random, number: u64, is_ellis: bool) -> Baked {
    let b0 = random.between(2.0, 6.0);
    let (near, beyond) = (3.0 * random.in_cube(), 50.0 * random.in_cube());
    let angles = 180.0 * random.in_cube();
    let place = format!("far_center = {}\nfar_rotate = {}\n", vector(beyond), vector(angles));
    let eye = near + (b0 + 3.0) * random.direction();
    let spacetime = if is_ellis {
        wormhole(near, b0, &place)
    } else {
        let radius = 0.5 * b0;
        let lengths = [radius, radius * random.between(0.0, 2.0), radius * random.log_between(0.05, 2.0)];
        interstellar(near, lengths, &place)
    };
    let mut text = spacetime
        + &camera(eye, near, 90.0)
        + &film(32, 32)
        + "[render]\nmax_depth = 5\nroulette_depth = 3\nsampler = \"independent\"\n"
        + &material("wall", 0.7, 0.0)
        + &material("lamp", 0.3, 2.0)
        + "[[material]]\nname = \"glass\"\nkind = \"dielectric\"\n"
        + "[[material]]\nname = \"mirror\"\nkind = \"mirror\"\nalbedo = 0.9\n";
    for (is_far, center) in [(false, near), (true, beyond)] {
        let mut entities = vec![mesh("box.obj", center, "wall")];
        // Outside of the throat's ball, whose radius is b0/2.
        let mut around = |least: f64| (0.5 * b0 + least + random.between(0.1, 5.0)) * random.direction();
        if number % 3 != u64::from(is_far) {
            entities.push(sphere(center + around(2.0), 2.0, "lamp"));
            entities.push(disk(center + around(2.5), DVec3::new(0.6, 0.0, 0.8), 0.5, 2.5, "lamp"));
        }
        let specular = if number.is_multiple_of(2) { "glass" } else { "mirror" };
        entities.push(sphere(center + around(1.2), 1.2, specular));
        entities.push(sphere(center + around(1.5), 1.5, "wall"));
        text.extend(entities.iter().map(|entity| if is_far { far(entity) } else { entity.clone() }));
    }
    let walls = closed_box(DVec3::splat(-13.0), DVec3::splat(12.0));
    scene_with(&text, &[("box.obj", &walls)])
}

#[test]
fn rooms_with_wormholes_look_the_same_with_and_without_light_sampling() {
    for (is_ellis, count, spp) in [(true, 12, 128), (false, 6, 256)] {
        let mut squares = 0.0;
        for number in 0..count {
            let mut scene = rooms(&mut Random::new(700 + number), number, is_ellis);
            let with = picture(&mut scene, Geodesic, spp / 4, 2 * number + 1);
            let without = picture(&mut scene, Off, spp, 2 * number);
            let agreement = Agreement::of(&with, &without);
            agreement.check(&format!("{number}, Ellis {is_ellis}"));
            squares += agreement.z.powi(2);
        }
        let count = count as f64;
        assert!(squares / count < 1.5 + 3.0 * (2.0 / count).sqrt(), "{squares}, Ellis {is_ellis}");
    }
}

/// Overrides that make a wormhole Interstellar's.
const INTERSTELLAR: &str =
    "spacetime.kind=\"interstellar-wormhole\" spacetime.throat_length=0.5 spacetime.lensing_width=0.4";

#[test]
fn wormholes_have_the_same_bits_by_both_schedules() {
    let common = ["film.width=24", "film.height=18", "render.spp=4"];
    for more in
        ["render.stepper=\"rkn6\"", "render.precision=\"f32\"", "spacetime.throat_radius=0.3", INTERSTELLAR]
    {
        let bits = |schedule: &str| -> Vec<u32> {
            let mut overrides = [&common[..], &[schedule]].concat();
            overrides.extend(more.split(' '));
            let scene = scene_file(&scene_path("wormhole_rooms.toml"), &overrides);
            let aovs = vec![Aov::Depth, Aov::Position, Aov::Side, Aov::Steps];
            let image = render(&scene, &Run { aovs, ..Run::default() }).image;
            image.channels.iter().flat_map(|plane| plane.values.iter().map(|value| value.to_bits())).collect()
        };
        assert_eq!(bits("render.schedule=\"wavefront\""), bits("render.schedule=\"per-pixel\""), "{more}");
    }
}

#[test]
fn the_plane_of_the_side_tells_the_throat_from_what_is_around_it() {
    let text = wormhole(DVec3::ZERO, 1.0, "")
        + &camera(DVec3::new(0.0, 0.0, 5.0), DVec3::ZERO, 60.0)
        + &film(31, 31)
        + "[environment]\ncolor = 1\n[environment.far]\ncolor = 3\n";
    let run = Run { aovs: vec![Aov::Side], ..Run::default() };
    let rendered = render(&scene_with(&text, &[]), &run);
    let at = |name: &str, pixel: usize| rendered.image.channel(name).unwrap()[pixel];
    let (middle, corner) = (15 * 31 + 15, 0);
    assert_eq!((at("side.ID", middle), at("R", middle)), (2.0, 3.0));
    assert_eq!((at("side.ID", corner), at("R", corner)), (1.0, 1.0));
}

#[test]
fn depth_is_the_way_to_the_throat_and_from_there_on() {
    let text = wormhole(DVec3::ZERO, 1.0, "far_center = [30, 0, 0]\n")
        + &camera(DVec3::new(0.0, 0.0, 5.0), DVec3::ZERO, 1.0)
        + &film(9, 9)
        + &material("white", 0.8, 1.0)
        + &far(&sphere(DVec3::new(30.0, 0.0, 0.0), 3.0, "white"));
    let run = Run { aovs: vec![Aov::Depth, Aov::Position], ..Run::default() };
    let rendered = render(&scene_with(&text, &[]), &run);
    let at = |name: &str| rendered.image.channel(name).unwrap()[4 * 9 + 4];
    // Straight through: the throat is at half the throat radius on either side.
    assert!((at("depth.Z") - 7.0).abs() < 1e-2, "{}", at("depth.Z"));
    assert!((at("position.Z") + 3.0).abs() < 1e-2, "{}", at("position.Z"));
}

#[test]
fn a_point_light_beyond_the_throat_lights_as_a_small_lamp_of_its_intensity_does() {
    let (b0, place, radius) = (2.0f64, DVec3::new(1.0, 2.0, 6.0), 0.1);
    let common = wormhole(DVec3::ZERO, b0, "far_center = [20, 0, 0]\nfar_rotate = [0, 130, 0]\n")
        + &camera(DVec3::new(0.0, 1.0, 9.0), DVec3::new(0.0, -3.0, 0.0), 60.0)
        + &film(16, 16)
        + "[render]\nspp = 256\nmax_winding = 3\nsampler = \"independent\"\n"
        + &material("white", 0.8, 0.0)
        + &material("lamp", 0.0, 1000.0)
        + &disk(DVec3::new(0.0, -3.0, 0.0), DVec3::Y, 0.0, 9.0, "white");
    let position = DVec3::new(20.0, 0.0, 0.0) + place;
    // Of the lamp's own frame, whose lengths are n times those of the chart.
    let index = 1.0 + 0.25 * b0 * b0 / place.length_squared();
    let intensity = 1000.0 * std::f64::consts::PI * (index * radius).powi(2);
    let point = format!(
        "[[entity]]\nlight = {{ kind = \"point\", position = {}, intensity = {intensity:?} }}\n",
        vector(position)
    );
    let mean = |light: &str, max_depth: u32| {
        let common = common.replace("[render]", &format!("[render]\nmax_depth = {max_depth}"));
        mean_red(&render(&scene_with(&(common + &far(light)), &[]), &Run::default()))
    };
    // What the camera sees of the lamp itself, a thousandth of a pixel of it through the throat, is in both.
    let on_disk = |light: &str| mean(light, 2) - mean(light, 1);
    let (by_point, by_lamp) = (on_disk(&point), on_disk(&sphere(position, radius, "lamp")));
    println!("{by_point} by a point, {by_lamp} by a lamp");
    assert!(by_lamp > 0.0 && (by_point / by_lamp - 1.0).abs() < 0.03, "{by_point} and {by_lamp}");
}

/// What is wrong with a scene.
fn error(text: &str) -> String {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("scene.toml");
    std::fs::write(&path, text).unwrap();
    match load(&path, &[]) {
        Ok(_) => panic!("no error"),
        Err(error) => error.to_string(),
    }
}

#[test]
fn a_throat_that_numbers_cannot_tell_is_an_error_that_names_its_key() {
    let ball = material("white", 0.5, 1.0) + &sphere(DVec3::new(3.0, 0.0, 0.0), 0.4, "white");
    let rest = camera(DVec3::new(0.0, 0.0, 5.0), DVec3::ZERO, 60.0) + &ball;
    for (lengths, key) in [
        ([1.0, -1.0, 0.5], "throat_length"),
        ([1.0, f64::INFINITY, 0.5], "throat_length"),
        ([1.0, f64::NAN, 0.5], "throat_length"),
        ([1.0, 1400.0, 0.5], "throat_length"),
        ([1.0, 1.0, 0.0], "lensing_width"),
        ([1.0, 1.0, -0.5], "lensing_width"),
        ([1.0, 1.0, f64::NAN], "lensing_width"),
        ([1.0, 1.0, 1e9], "lensing_width"),
        ([-1.0, 1.0, 0.5], "throat_radius"),
    ] {
        let told = error(&(interstellar(DVec3::ZERO, lengths, "") + &rest));
        assert!(told.contains(key), "{lengths:?}: {told}");
    }
    let short =
        "[spacetime]\nkind = \"interstellar-wormhole\"\nthroat_radius = 1\nlensing_width = 1\n".to_owned();
    assert!(error(&(short + &rest)).contains("throat_length"));
    // No throat is no wormhole.
    scene_with(&(interstellar(DVec3::ZERO, [0.0, 1.0, 0.5], "") + &rest), &[]);
}

#[test]
fn what_reaches_into_the_throat_is_an_error_that_names_it() {
    let common = wormhole(DVec3::ZERO, 1.0, "far_center = [9, 0, 0]\n") + &material("white", 0.5, 1.0);
    let eye = camera(DVec3::new(0.0, 0.0, 5.0), DVec3::ZERO, 60.0);
    let ball = sphere(DVec3::new(0.8, 0.0, 0.0), 0.4, "white");
    let text = common.clone() + &eye + &ball;
    assert!(error(&text).contains("`sphere 0`: it reaches into the throat"), "{}", error(&text));
    // There is nothing on the other side, whose throat is elsewhere.
    scene_with(&(common.clone() + &eye + &far(&ball)), &[]);
    let text = common.clone() + &eye + &far(&sphere(DVec3::new(9.8, 0.0, 0.0), 0.4, "white"));
    assert!(error(&text).contains("reaches into the throat"), "{}", error(&text));
    let inside = camera(DVec3::new(0.0, 0.0, 0.3), DVec3::X, 60.0);
    let text = common + &inside + &sphere(DVec3::new(3.0, 0.0, 0.0), 0.4, "white");
    assert!(error(&text).contains("within the throat"), "{}", error(&text));
}

#[test]
fn a_far_side_that_does_not_exist_is_told() {
    let eye = camera(DVec3::new(0.0, 0.0, 5.0), DVec3::ZERO, 60.0);
    let ball = sphere(DVec3::ZERO, 0.4, "white");
    let white = material("white", 0.5, 1.0);
    let scene = scene_with(&(eye.clone() + &white + &ball + &far(&ball)), &[]);
    let told = scene.warnings.iter().any(|warning| warning.contains("no far side"));
    assert!(told && scene.geometry.counts().spheres == 1, "{:?}", scene.warnings);
    let text = far(&eye) + &white + &ball;
    assert!(error(&text).contains("on the far side"), "{}", error(&text));
}
