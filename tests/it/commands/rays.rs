//! `warpfront rays`: the files, the points in them, and what is refused.

use std::collections::BTreeMap;
use std::fs;
use std::process::Output;

use crate::support::command::{Folder, assert_good, assert_refused, stderr};
use glam::DVec3;

/// A hole of r_s = 1 between the camera and a ball.
const SCENE: &str = "
[spacetime]
kind = \"schwarzschild\"
center = [0, 1, 0]
schwarzschild_radius = 1
[camera]
position = [0, 1, 12]
look_at = [0, 1, 0]
vertical_fov = 50
[environment]
color = [1, 1, 1]
[[entity]]
sphere = { center = [3, 1, -4], radius = 1 }
";
const HOLE: DVec3 = DVec3::Y;

fn folder() -> Folder {
    Folder::with(&[("scene.toml", SCENE)])
}

fn draw(place: &Folder, output: &str, flags: &[&str]) -> Output {
    place.run(&[&["rays", "scene.toml", "-o", output], flags].concat())
}

/// Points and fate of each ray.
fn points(place: &Folder, flags: &[&str]) -> BTreeMap<u32, (Vec<DVec3>, String)> {
    let output = draw(place, "rays.csv", flags);
    assert_good(&output);
    let text = place.read("rays.csv");
    let mut lines = text.lines();
    assert_eq!(lines.next(), Some("ray,point,x,y,z,fate"));
    let mut rays: BTreeMap<u32, (Vec<DVec3>, String)> = BTreeMap::new();
    for line in lines {
        let [ray, point, x, y, z, fate] = line.split(',').collect::<Vec<_>>().try_into().unwrap();
        let (points, known) = rays.entry(ray.parse().unwrap()).or_default();
        assert_eq!(point.parse(), Ok(points.len()));
        points.push(DVec3::from([x, y, z].map(|number: &str| number.parse().unwrap())));
        fate.clone_into(known);
    }
    rays
}

#[test]
fn rays_end_where_their_fates_say() {
    let rays = points(&folder(), &["--count", "61"]);
    assert_eq!(rays.len(), 61);
    let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
    for (points, fate) in rays.values() {
        *counts.entry(fate).or_default() += 1;
        assert!(points.iter().all(|point| point.is_finite() && (point.y - 1.0).abs() < 1e-9));
        let last = *points.last().unwrap();
        match fate.as_str() {
            "hit" => assert!((last.distance(DVec3::new(3.0, 1.0, -4.0)) - 1.0).abs() < 1e-6),
            "captured" => assert!((last.distance(HOLE) - 0.25).abs() < 1e-3, "{last}"),
            "escaped" => assert!(last.distance(HOLE) > 10.0),
            other => panic!("{other}"),
        }
    }
    assert!(["hit", "captured", "escaped"].iter().all(|fate| counts.contains_key(fate)), "{counts:?}");
}

#[test]
fn rays_towards_the_shadow_are_captured_and_others_are_not() {
    let place = folder();
    // sin of the shadow's half angle is (3√3/2) r_s / (n ρ), n = (1+u)³/(1−u), u = r_s/4ρ.
    let u: f64 = 0.25 / 12.0;
    let index = (1.0 + u).powi(3) / (1.0 - u);
    let shadow = 2.0 * (1.5 * 3f64.sqrt() / (12.0 * index)).asin().to_degrees();
    for (scale, expected) in [(0.99, "captured"), (1.01, "escaped")] {
        let fan = format!("{}", scale * shadow);
        let rays =
            points(&place, &["--count", "2", "--fan", &fan, "--set", "entity.0.sphere.center=[0,90,0]"]);
        assert!(rays.values().all(|(_, fate)| fate == expected), "{rays:?}");
    }
}

#[test]
fn points_lie_close_enough_to_be_drawn_as_a_curve() {
    let rays = points(&folder(), &["--count", "61"]);
    for (points, fate) in rays.values() {
        let pieces: Vec<DVec3> = points.windows(2).map(|two| two[1] - two[0]).collect();
        // The last piece before a landing may be too short to have a direction.
        for two in pieces.windows(2).filter(|two| two.iter().all(|piece| piece.length() > 1e-3)) {
            let turn = two[0].angle_between(two[1]);
            assert!(turn < 0.2, "a corner of {turn} on a ray that is {fate}");
        }
    }
}

#[test]
fn rays_leave_the_picture_without_a_corner_and_along_the_geodesic() {
    // Nothing beyond the photon sphere, so that rays need not be followed from there.
    let place = folder();
    let near = ["--set", "entity.0.sphere.center=[0,1,0]", "--set", "entity.0.sphere.radius=0.3"];
    let rays = points(&place, &[&["--count", "61"][..], &near].concat());
    for (points, _) in rays.values().filter(|(_, fate)| fate == "escaped") {
        let pieces: Vec<DVec3> = points.windows(2).map(|two| two[1] - two[0]).collect();
        let corner = pieces.windows(2).map(|two| two[0].angle_between(two[1])).fold(0.0, f64::max);
        assert!(corner < 0.1, "a corner of {corner}");
        // On the geodesic all the way out: |x × p| is kept, p = n along the ray, here at the middle of each piece.
        let spin = |two: &[DVec3]| {
            let (middle, along) = (0.5 * (two[0] + two[1]) - HOLE, (two[1] - two[0]).normalize());
            let u = 0.25 / middle.length();
            (1.0 + u).powi(3) / (1.0 - u) * middle.cross(along).length()
        };
        let (first, last) = (spin(&points[..2]), spin(&points[points.len() - 2..]));
        assert!((first - last).abs() < 2e-2 * first, "an impact parameter of {first} becomes {last}");
    }
}

#[test]
fn rays_in_the_equator_of_a_spinning_hole_stay_there_and_leave_without_a_corner() {
    let scene = SCENE.replace("\"schwarzschild\"", "\"kerr\"\nspin = 0.9");
    let place = Folder::with(&[("scene.toml", &scene)]);
    // The ball above the equator, near the hole.
    let near = ["--set", "entity.0.sphere.center=[0,2.8,0]", "--set", "entity.0.sphere.radius=0.3"];
    let rays = points(&place, &[&["--count", "61"][..], &near].concat());
    let mut ends = [0, 0];
    for (points, fate) in rays.values() {
        assert!(points.iter().all(|point| (point.y - 1.0).abs() < 1e-6), "{fate}");
        let last = points.last().unwrap().distance(HOLE);
        if fate == "captured" {
            // r₊ = (1 + √(1 − a²))/2, and √(r₊² + (a/2)²) in the chart.
            let r: f64 = 0.5 * (1.0 + (1.0 - 0.81_f64).sqrt());
            assert!((last - r.hypot(0.45)).abs() < 0.1, "{last}");
            ends[0] += 1;
        } else {
            assert!(fate == "escaped" && last > 10.0, "{fate} {last}");
            let pieces: Vec<DVec3> = points.windows(2).map(|two| two[1] - two[0]).collect();
            let corners = pieces.windows(2).filter(|two| two.iter().all(|piece| piece.length() > 1e-3));
            let corner = corners.map(|two| two[0].angle_between(two[1])).fold(0.0, f64::max);
            assert!(corner < 0.2, "a corner of {corner}");
            ends[1] += 1;
        }
    }
    assert!(ends.iter().all(|&count| count > 5), "{ends:?}");
    let inside = draw(&place, "x.svg", &["--from", "0.9,1,0"]);
    assert_refused(&inside, &["starts in the ergosphere", "--from"]);
}

#[test]
fn the_fan_starts_where_it_is_told_and_opens_towards_the_hole_in_the_plane_asked_for() {
    let rays = points(&folder(), &["--from=10,1,0", "--up", "0,0,1", "--count", "5", "--fan", "20"]);
    for (points, _) in rays.values() {
        assert_eq!(points[0], DVec3::new(10.0, 1.0, 0.0));
        assert!(points.iter().all(|point| point.z.abs() < 1e-9));
    }
    let (middle, fate) = &rays[&2];
    assert!(fate == "captured" && middle.iter().all(|point| (point.y - 1.0).abs() < 1e-9));
}

#[test]
fn every_stepper_and_flat_space_draw_rays() {
    let place = folder();
    for flags in [
        &["--stepper", "rkn4"][..],
        &["--stepper", "rkn6", "--tolerance", "1e-9"],
        &["--stepper", "rk4-paper"],
        &["--quality", "draft", "--arc-tolerance", "0.1"],
        &["--set", "spacetime.schwarzschild_radius=0"],
    ] {
        let rays = points(&place, flags);
        assert_eq!(rays.len(), 41, "{flags:?}");
        assert!(rays.values().all(|(points, _)| points.len() >= 2), "{flags:?}");
    }
}

#[test]
fn empty_space_is_drawn_too() {
    let place = folder();
    let empty = SCENE.split("[[entity]]").next().unwrap();
    fs::write(place.path("scene.toml"), empty).unwrap();
    assert!(points(&place, &[]).values().any(|(_, fate)| fate == "captured"));
    let flat = ["--set", "spacetime.schwarzschild_radius=0"];
    assert!(points(&place, &flat).values().all(|(points, fate)| fate == "escaped" && points.len() == 2));
    assert_good(&draw(&place, "flat.svg", &flat));
}

#[test]
fn pictures_show_rays_hole_and_what_the_plane_cuts() {
    let place = folder();
    assert_good(&draw(&place, "rays.svg", &[]));
    let svg = place.read("rays.svg");
    for part in
        ["<svg", "captured (", "hit (", "photon sphere", "horizon", "geometry", "scene units", "</svg>"]
    {
        assert!(svg.contains(part), "{part} is missing");
    }
    let output = draw(&place, "rays.png", &["--count", "3"]);
    assert_good(&output);
    assert!(stderr(&output).contains("3 rays: ") && stderr(&output).contains("wrote rays.png"));
    let image = image::open(place.path("rays.png")).unwrap().to_rgb8();
    let dark = image.pixels().filter(|pixel| pixel.0.iter().all(|&c| c < 64)).count();
    assert!(image.width() > 1000 && image.get_pixel(0, 0).0 == [255; 3], "{:?}", image.dimensions());
    assert!(dark > 5000, "text, frame and horizon are {dark} pixels");
}

#[test]
fn pictures_show_several_holes_and_lenses() {
    let holes = "kind = \"several-holes\"\n[[spacetime.hole]]\ncenter = [-2, 1, 0]\nmass = 0.4\n\
        [[spacetime.hole]]\ncenter = [2, 1, 0]\nmass = 0.3\n";
    let lenses = "kind = \"lenses\"\n\
        [[spacetime.lens]]\nkind = \"luneburg\"\ncenter = [-2, 1, 0]\nradius = 1\n\
        [[spacetime.lens]]\nkind = \"gaussian\"\ncenter = [4, 1, 0]\nwidth = 0.3\namplitude = 0.5\n";
    let (_, rest) = SCENE.split_once("[camera]").unwrap();
    for (spacetime, parts) in [
        (holes, ["photon sphere, about", "hole (not to scale)", "captured ("]),
        (lenses, ["lens", "lens, to its width", "escaped ("]),
    ] {
        let place = Folder::with(&[("scene.toml", &format!("[spacetime]\n{spacetime}[camera]{rest}"))]);
        assert_good(&draw(&place, "rays.svg", &[]));
        let svg = place.read("rays.svg");
        for part in parts {
            assert!(svg.contains(part), "{part} is missing");
        }
    }
}

#[test]
fn bad_flags_are_refused_with_a_remedy() {
    let place = folder();
    let cases: &[(&str, &[&str], &[&str])] = &[
        ("rays.pdf", &[], &["--output", "rays.pdf", ".svg or .png or .csv"]),
        ("rays", &[], &["--output", ".svg"]),
        ("rays.csv", &["--count", "0"], &["--count", "from 1"]),
        ("rays.csv", &["--fan", "361"], &["--fan", "up to 360"]),
        ("rays.csv", &["--from", "1,2"], &["--from", "X,Y,Z"]),
        ("rays.csv", &["--up", "a,b,c"], &["--up", "X,Y,Z"]),
        ("rays.csv", &["--up", "0,0,1"], &["along the plane", "help:"]),
        ("rays.csv", &["--up", "0,0,0"], &["along the plane", "help:"]),
        ("rays.csv", &["--from", "0,1.1,0"], &["inside the horizon", "--from"]),
        ("rays.csv", &["--fan", "200", "--set", "camera.near=1"], &["near plane", "--fan"]),
        ("rays.csv", &["--stepper", "euler"], &["--stepper", "rkn4"]),
        ("none/rays.csv", &[], &["`none/rays.csv`", "help:"]),
    ];
    for (output, flags, said) in cases {
        let result = draw(&place, output, flags);
        assert_refused(&result, said);
        assert_eq!(fs::read_dir(place.folder()).unwrap().count(), 1);
    }
    let flags = ["--set", "camera.projection=orthographic", "--set", "camera.height=4"];
    let parallel = draw(&place, "rays.csv", &flags);
    let said = String::from_utf8_lossy(&parallel.stderr);
    assert!(
        parallel.status.code() == Some(2) && said.contains("parallel") && said.contains("--fan"),
        "{said}"
    );
}

#[test]
fn both_sides_of_a_wormhole_are_drawn_and_rays_go_on_beyond_the_throat() {
    let (far_center, throat) = (DVec3::new(50.0, 2.0, 0.0), 0.5);
    let scene = SCENE
        .replace("\"schwarzschild\"", "\"ellis-wormhole\"\nfar_center = [50, 2, 0]\nthroat_radius = 1")
        .replace("schwarzschild_radius = 1\n", "");
    let ball = "[[entity]]\nsphere = { center = [50, 2, -5], radius = 2 }\nside = \"far\"\n";
    let place = Folder::with(&[("scene.toml", &(scene + ball))]);
    assert_good(&draw(&place, "rays.csv", &["--count", "61", "--fan", "12"]));
    let text = place.read("rays.csv");
    assert_eq!(text.lines().next(), Some("ray,point,x,y,z,fate,side"));
    let mut rays: BTreeMap<u32, Vec<(DVec3, bool, String)>> = BTreeMap::new();
    for line in text.lines().skip(1) {
        let [ray, point, x, y, z, fate, side] = line.split(',').collect::<Vec<_>>().try_into().unwrap();
        let points = rays.entry(ray.parse().unwrap()).or_default();
        assert_eq!(point.parse(), Ok(points.len()));
        let at = DVec3::from([x, y, z].map(|number: &str| number.parse().unwrap()));
        points.push((at, side == "far", fate.to_owned()));
    }
    let (mut met, mut passed) = (0, 0);
    for points in rays.values() {
        let Some(first) = points.iter().position(|&(_, is_far, _)| is_far) else { continue };
        assert!(points[first..].iter().all(|&(_, is_far, _)| is_far));
        passed += 1;
        // Upon the throat on both sides, at opposite places.
        let (near, far) = (points[first - 1].0 - HOLE, points[first].0 - far_center);
        assert!((near.length() - throat).abs() < 1e-6 && (near + far).length() < 1e-4, "{near} {far}");
        let (last, _, fate) = points.last().unwrap();
        if fate == "hit" {
            assert!((last.distance(DVec3::new(50.0, 2.0, -5.0)) - 2.0).abs() < 1e-4, "{last}");
            met += 1;
        } else {
            // Out of the picture, along the geodesic.
            assert!(last.distance(far_center) > 5.0, "{fate} {last}");
            let pieces: Vec<DVec3> = points[first..].windows(2).map(|two| two[1].0 - two[0].0).collect();
            let corners = pieces.windows(2).filter(|two| two.iter().all(|piece| piece.length() > 1e-3));
            let corner = corners.map(|two| two[0].angle_between(two[1])).fold(0.0, f64::max);
            assert!(corner < 0.2, "a corner of {corner}");
        }
    }
    assert!(met > 1 && passed > met, "{met} of {passed}");
    assert_good(&draw(&place, "rays.svg", &["--count", "61", "--fan", "12"]));
    let picture = place.read("rays.svg");
    assert!(picture.contains("near side") && picture.contains("far side"), "{picture}");
}
