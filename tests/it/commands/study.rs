//! `warpfront study`: the files, the numbers in them, and what is refused.

use std::fs;
use std::path::PathBuf;
use std::process::Output;

use crate::support::command::{Folder, assert_good, assert_refused, stderr, stdout};
use crate::support::{Row, data};

/// A hole of r_s = 1 between the camera and a wall.
const SCENE: &str = "
[spacetime]
kind = \"schwarzschild\"
schwarzschild_radius = 1
[camera]
position = [0, 0, 12]
look_at = [0, 0, 0]
vertical_fov = 50
[environment]
color = [1, 1, 1]
[[entity]]
disk = { center = [0, 0, -6], normal = [0, 0, 1], outer = 6 }
";
const SMALL: [&str; 6] = ["--size", "24x18", "--rounds", "1", "--spp", "1"];

fn folder(scene: &str) -> Folder {
    Folder::with(&[("scene.toml", scene)])
}

fn study(place: &Folder, prefix: &str, flags: &[&str]) -> Output {
    place.run(&[&["study", "scene.toml", "-o", prefix], flags].concat())
}

/// Studies the rays of `text`.
fn study_rays(place: &Folder, text: &str, flags: &[&str]) -> Output {
    fs::write(place.path("rays.csv"), text).unwrap();
    place.run(&[&["study", "--rays", "rays.csv", "-o", "study", "--rounds", "1"], flags].concat())
}

/// The rows of a small study by column, and what was printed.
fn scene_rows(place: &Folder, flags: &[&str]) -> (Vec<Row>, String) {
    written(place, &study(place, "study", &[&SMALL, flags].concat()))
}

/// The rows of a study of the rays of `text` by column, and what was printed.
fn ray_rows(place: &Folder, text: &str, flags: &[&str]) -> (Vec<Row>, String) {
    written(place, &study_rays(place, text, flags))
}

fn written(place: &Folder, output: &Output) -> (Vec<Row>, String) {
    assert_good(output);
    (place.rows("study.csv"), stdout(output))
}

#[test]
fn tighter_tolerances_have_smaller_errors_and_more_steps() {
    let place = folder(SCENE);
    let (rows, table) =
        scene_rows(&place, &["--steppers", "rkn4,rkn6", "--precisions", "f64", "--tolerances", "1e-4,1e-9"]);
    assert_eq!(rows.len(), 4);
    for pair in rows.chunks(2) {
        let [loose, tight] = pair else { panic!() };
        assert_eq!((loose.text("tolerance"), tight.text("stepper")), ("0.0001", loose.text("stepper")));
        for error in ["position_p99", "direction_p99", "footprint_p99", "footprint_median", "position_rmse"] {
            assert!(tight.number(error) < 0.1 * loose.number(error), "{error}: {pair:?}");
        }
        assert!(loose.number("footprint_p99") < 1.0 && tight.number("footprint_p99") < 1e-3);
        assert!(tight.number("steps_per_ray") > loose.number("steps_per_ray"));
        assert!(pair.iter().all(|row| row.number("rays") == 432.0 && row.number("differ") < 0.05));
        assert!(
            pair.iter().all(|row| row.number("ns_per_ray") > 0.0 && row.number("paths_per_second") > 0.0)
        );
    }
    let marked = table.lines().filter(|line| line.contains('*')).count();
    let on_front = rows.iter().filter(|row| row.text("pareto") == "1").count();
    assert!(marked == on_front && on_front > 0 && table.lines().count() == 6, "{table}");
}

#[test]
fn all_steppers_are_studied_and_the_one_without_tolerance_once() {
    let place = folder(SCENE);
    let (rows, table) =
        scene_rows(&place, &["--tolerances", "1e-3,1e-6", "--schedules", "wavefront,per-pixel"]);
    let count = |stepper: &str| rows.iter().filter(|row| row.text("stepper") == stepper).count();
    // One of the tolerances is too fine for f32.
    assert_eq!((count("rkn4"), count("rkn6"), count("rk4-paper")), (6, 6, 2));
    assert!(
        rows.iter()
            .filter(|row| row.text("stepper") == "rk4-paper")
            .all(|row| row.text("tolerance").is_empty())
    );
    assert!(table.contains("rk4-paper") && table.contains("per-pixel"), "{table}");
    let svg = place.read("study.svg");
    for part in [
        "rkn6, wavefront",
        "rkn6 f32, per-pixel",
        "rk4-paper, per-pixel",
        "Pareto front",
        "error (pixels)",
        "camera ray (ns)",
    ] {
        assert!(svg.contains(part), "{part} is missing");
    }
    let image = image::open(place.path("study.png")).unwrap();
    assert!(image.width() > 1000, "{}", image.width());
}

#[test]
fn schedules_have_the_same_errors() {
    let flags = ["--steppers", "rkn6", "--tolerances", "1e-4", "--schedules", "wavefront,per-pixel"];
    let (rows, _) = scene_rows(&folder(SCENE), &flags);
    assert_eq!(rows.len(), 4);
    for precision in ["f64", "f32"] {
        let errors: Vec<&str> = rows
            .iter()
            .filter(|row| row.text("precision") == precision)
            .map(|row| row.text("footprint_rmse"))
            .collect();
        assert!(errors.len() == 2 && errors[0] == errors[1], "{errors:?}");
    }
}

#[test]
fn every_stepper_has_a_curve_per_precision_and_the_papers_one_point() {
    let place = folder(SCENE);
    let steppers = ["--steppers", "rkn6,rk4-paper"];
    let (rows, table) = scene_rows(&place, &[&steppers[..], &["--tolerances", "1e-3,1e-7"]].concat());
    let found: Vec<_> =
        rows.iter().map(|row| ["stepper", "precision", "tolerance"].map(|c| row.text(c))).collect();
    let expected = [
        ["rkn6", "f64", "0.001"],
        ["rkn6", "f64", "0.0000001"],
        ["rkn6", "f32", "0.001"],
        ["rk4-paper", "f64", ""],
    ];
    assert_eq!(found, expected);
    // The precisions differ, but less than the tolerance does.
    let p99 = |row: usize| rows[row].number("direction_p99");
    assert!(
        rows[0].text("direction_p99") != rows[2].text("direction_p99") && p99(1) < 0.1 * p99(2),
        "{rows:?}"
    );
    assert!(p99(2) < 3.0 * p99(0) + 1e-4, "{rows:?}");
    assert!(table.contains("precision") && table.contains("f32"), "{table}");
    let svg = place.read("study.svg");
    assert!(svg.contains(">rkn6<") && svg.contains(">rkn6 f32<") && svg.contains("stroke-dasharray"));
    let (rows, _) = scene_rows(&place, &[&steppers[..], &["--precisions", "f32"]].concat());
    assert_eq!(rows.iter().filter(|row| row.text("precision") == "f32").count(), 3);
}

/// Rays of a table without and with their ends: one around the hole, one straight out, one into it.
const RAYS: &str =
    "rs,x0,y0,z0,dx0,dy0,dz0,r_out\n1,10,3,0,-1,0,0,50\n1,10,0,0,1,0,0,50\n1,10,0,0,-1,0,0,50\n";

fn exact_rays() -> String {
    data("schwarzschild_rays.csv")
}

#[test]
fn the_tolerance_holds_on_every_exact_ray() {
    let place = folder(SCENE);
    let flags = ["--steppers", "rkn6,dop853", "--precisions", "f64", "--tolerances", "1e-3,1e-6,1e-9"];
    let (rows, table) = ray_rows(&place, &exact_rays(), &flags);
    assert_eq!(rows.len(), 6);
    for row in &rows {
        assert_eq!((row.number("rays"), row.number("differ")), (200.0, 0.0), "{row:?}");
        assert!(row.number("compared") > 100.0);
        assert_eq!(row.number("above_tolerance"), 0.0, "{row:?}");
        let (worst, tolerance) = (row.number("worst_over_tolerance"), row.number("tolerance"));
        assert!(worst > 0.0 && worst <= 1.0, "{row:?}");
        let largest = ["direction_over_sens_max", "position_over_sens_max"].map(|column| row.number(column));
        let ratio = largest[0].max(largest[1]) / tolerance;
        assert!((ratio - worst).abs() < 1e-9 * worst, "{row:?}");
        for error in ["direction", "direction_over_sens", "position", "position_over_sens"] {
            let [median, p99, max] = ["median", "p99", "max"].map(|v| row.number(&format!("{error}_{v}")));
            assert!(median <= p99 && p99 <= max, "{error}: {row:?}");
        }
        assert!(row.number("direction_max") >= row.number("direction_over_sens_max"));
        assert!(row.number("ns_per_ray") > 0.0 && row.number("steps_per_ray") > 1.0);
    }
    for stepper in rows.chunks(3) {
        assert!(stepper[2].number("steps_per_ray") > stepper[0].number("steps_per_ray"));
        assert!(stepper[2].number("direction_over_sens_p99") < stepper[0].number("direction_over_sens_p99"));
    }
    let marked = table.lines().filter(|line| line.contains('*')).count();
    let on_front = rows.iter().filter(|row| row.text("pareto") == "1").count();
    assert!(marked == on_front && on_front > 0 && table.lines().count() == 8, "{table}");
    let svg = place.read("study.svg");
    for part in ["rkn6", "dop853", "Pareto front", "angle at the end / sens (radians)", "time per ray (ns)"] {
        assert!(svg.contains(part), "{part} is missing");
    }
    assert!(image::open(place.path("study.png")).unwrap().width() > 800);
}

#[test]
fn rays_without_ends_are_compared_with_a_reference() {
    let place = folder(SCENE);
    let (rows, _) = ray_rows(&place, RAYS, &[]);
    let count = |column: &str, value: &str| rows.iter().filter(|row| row.text(column) == value).count();
    // Eleven decades, of which f32 has three, with every stepper but the paper's.
    assert_eq!((rows.len(), count("precision", "f32"), count("stepper", "rk4-paper")), (126, 27, 0));
    for row in &rows {
        assert_eq!((row.number("rays"), row.number("compared"), row.number("differ")), (3.0, 2.0, 0.0));
        assert!(row.number("worst_over_tolerance") < 1.0, "{row:?}");
    }
}

#[test]
fn ends_in_the_table_are_what_rays_are_compared_with() {
    // The ends that `trace` writes, the first one turned a little and the last one said to escape.
    let place = folder(SCENE);
    fs::write(place.path("rays.csv"), RAYS).unwrap();
    let ends = place.run(&["trace", "--spacetime", "schwarzschild", "rays.csv", "--stepper", "dop853"]);
    let flags = ["--steppers", "dop853", "--precisions", "f64", "--tolerances", "1e-10"];
    let ends = String::from_utf8(ends.stdout).unwrap();
    let (rows, _) = ray_rows(&place, &ends, &flags);
    assert!(rows[0].number("direction_max") < 1e-13 && rows[0].number("differ") == 0.0);

    let wrong: Vec<String> = ends.lines().map(|line| line.replace("captured", "missed")).collect();
    let (rows, _) = ray_rows(&place, &(wrong.join("\n") + "\n"), &flags);
    assert!((rows[0].number("differ") - 1.0 / 3.0).abs() < 1e-12);

    let tilted = "rs,x0,y0,z0,dx0,dy0,dz0,r_out,status,x1,y1,z1,dx1,dy1,dz1,sens\n\
                  0,1,0,0,1,0,0,50,escaped,50,0.05,0,1,1e-4,0,2\n";
    let (rows, _) = ray_rows(&place, tilted, &flags);
    let near = |column: &str, expected: f64| {
        let found = rows[0].number(column);
        assert!((found / expected - 1.0).abs() < 1e-6, "{column}: {found}");
    };
    near("direction_max", 1e-4);
    near("direction_over_sens_max", 5e-5);
    near("position_max", 1e-3);
    near("worst_over_tolerance", 5e-4 / 1e-10);
    assert_eq!(rows[0].number("above_tolerance"), 1.0);
}

#[test]
fn bad_tables_of_rays_are_refused_with_a_remedy() {
    let header = "rs,x0,y0,z0,dx0,dy0,dz0,r_out,status,x1,y1,z1,dx1,dy1,dz1,sens\n";
    let ray = "1,10,3,0,-1,0,0,50";
    let cases: [(String, &[&str], &[&str]); 12] = [
        ("rs,x0\n".to_owned(), &[], &["no column `y0`"]),
        (RAYS.lines().next().unwrap().to_owned(), &[], &["`rays.csv` has no rays"]),
        (header.replace(",sens", ""), &[], &["a column `dz1` but no column `sens`", "none of them"]),
        (format!("{header}{ray},gone,1,0,0,1,0,0,1\n"), &[], &["line 2", "`status`", "`gone`", "captured"]),
        (format!("{header}{ray},step-limit,1,0,0,1,0,0,1\n"), &[], &["line 2", "`step-limit`"]),
        (format!("{header}{ray},escaped,1,,0,1,0,0,1\n"), &[], &["line 2", "`y1`", "no number"]),
        (format!("{header}{ray},escaped,1,0,0,1,0,0,0\n"), &[], &["line 2", "`sens`", "above 0"]),
        (format!("{header}{ray},escaped,1,0,0,0,0,0,1\n"), &[], &["line 2", "`dx1`", "no direction"]),
        (RAYS.replace("\n1,10,0,0,1", "\n1,0.1,0,0,1"), &[], &["line 3", "`x0`", "horizon"]),
        (RAYS.replace("\n1,10,0,0,1", "\n1,1e20,0,0,1"), &[], &["line 3", "`x0`", "1e15"]),
        (RAYS.to_owned(), &["--steppers", "rkn6,rk4-paper"], &["rk4-paper", "--steppers"]),
        (
            RAYS.to_owned(),
            &["--precisions", "f32", "--tolerances", "1e-8"],
            &["nothing to measure", "1.2e-5"],
        ),
    ];
    for (text, flags, said) in cases {
        let place = folder(SCENE);
        assert_refused(&study_rays(&place, &text, flags), &[&["help: "], said].concat());
        assert_eq!(fs::read_dir(place.folder()).unwrap().count(), 2, "{text}");
    }
}

#[test]
fn a_scene_or_rays_are_studied_and_not_both() {
    let place = folder(SCENE);
    fs::write(place.path("rays.csv"), RAYS).unwrap();
    let refused = |arguments: &[&str], said: &[&str]| {
        assert_refused(&place.run(&[&["study", "-o", "study"], arguments].concat()), said);
    };
    refused(&[], &["nothing to study", "--rays", "SCENE"]);
    refused(&["scene.toml", "--rays", "rays.csv"], &["--rays", "SCENE", "cannot be used"]);
    refused(&["--rays", "rays.csv", "--set", "camera.near=1"], &["--set", "cannot be used"]);
    refused(&["--rays", "rays.csv", "--size", "8x8"], &["--size", "cannot be used"]);
    refused(&["--rays", "rays.csv", "--schedules", "wavefront"], &["--schedules", "cannot be used"]);
    refused(&["--set", "camera.near=1"], &["nothing to study", "SCENE"]);
    refused(&["scene.toml", "--spacetime", "flat"], &["--spacetime", "cannot be used"]);
    refused(&["--rays", "none.csv"], &["cannot read `none.csv`", "help:"]);
    assert_eq!(fs::read_dir(place.folder()).unwrap().count(), 2);
}

#[test]
fn flat_and_empty_scenes_are_studied_too() {
    let place = folder(SCENE);
    let (rows, _) =
        scene_rows(&place, &["--tolerances", "1e-4", "--set", "spacetime.schwarzschild_radius=0"]);
    assert!(rows.iter().all(|row| row.number("footprint_rmse") == 0.0 && row.number("differ") == 0.0));
    let (rows, _) = scene_rows(&folder(SCENE.split("[[entity]]").next().unwrap()), &["--tolerances", "1e-4"]);
    assert!(
        rows.iter().all(|row| row.text("position_rmse").is_empty() && row.number("direction_rmse") > 0.0)
    );
}

#[test]
fn the_prefix_keeps_its_dots_and_files_are_named() {
    let place = folder(SCENE);
    let flags = [&SMALL[..], &["--steppers", "rkn6", "--precisions", "f64,f64", "--tolerances", "1e-3,1e-3"]]
        .concat();
    let output = study(&place, "v1.2", &flags);
    assert_good(&output);
    assert!(stderr(&output).contains("1 setting; wrote v1.2.csv, v1.2.svg, v1.2.png"), "{}", stderr(&output));
    assert!(["v1.2.csv", "v1.2.svg", "v1.2.png"].iter().all(|name| place.path(name).exists()));
}

#[test]
fn bad_flags_are_refused_with_a_remedy() {
    let place = folder(SCENE);
    let cases: &[(&str, &[&str], &[&str])] = &[
        ("study", &["--steppers", "euler"], &["--steppers", "rkn6"]),
        ("study", &["--precisions", "f16"], &["--precisions", "f32"]),
        ("study", &["--steppers", "rkn6", "--tolerances", "1e-30"], &["nothing to measure", "1.2e-5"]),
        ("study", &["--tolerances", "1e-3,0"], &["--tolerances", "above 0"]),
        ("study", &["--schedules", "x"], &["--schedules", "per-pixel"]),
        ("study", &["--rounds", "0"], &["--rounds", "from 1"]),
        ("study", &["--size", "99"], &["--size", "WIDTHxHEIGHT"]),
        ("study", &["--size", "65536x65536"], &["--size", "pixels"]),
        ("study", &["--set", "camera.vertical_fov=500"], &["vertical_fov"]),
        ("", &[], &["--output"]),
        ("folder/", &[], &["--output", "begin with"]),
        ("none/study", &[], &["`none/study.csv`", "help:"]),
    ];
    for (prefix, flags, said) in cases {
        assert_refused(&study(&place, prefix, flags), said);
        assert_eq!(fs::read_dir(place.folder()).unwrap().count(), 1);
    }
}

/// A small lamp over a floor, in flat space and out of the camera's sight.
const LAMP: &str = "
[camera]
position = [0, 2, 8]
look_at = [0, 0, 0]
vertical_fov = 20
[render]
max_depth = 4
[[entity]]
disk = { center = [0, 0, 0], normal = [0, 1, 0], outer = 6 }
[[entity]]
sphere = { center = [-0.5, 0.5, 0], radius = 0.5 }
[[entity]]
sphere = { center = [1, 5, 1], radius = 0.3 }
emission = 30
";
const LIGHTS: [&str; 4] = ["--size", "16x12", "--light-sampling", "off,straight,geodesic"];

/// The rows of a study of light sampling by column, and what was printed.
fn light_rows(place: &Folder, flags: &[&str]) -> (Vec<Row>, String) {
    written(place, &study(place, "study", &[&LIGHTS, flags].concat()))
}

/// A column of a way by numbers of samples.
fn column(rows: &[Row], way: &str, column: &str) -> Vec<f64> {
    rows.iter().filter(|row| row.text("light_sampling") == way).map(|row| row.number(column)).collect()
}

#[test]
fn light_sampling_has_a_row_per_way_and_number_of_samples() {
    let place = folder(LAMP);
    let (rows, table) = light_rows(&place, &["--spps", "4,16,16"]);
    let found: Vec<_> = rows.iter().map(|row| (row.text("light_sampling"), row.text("spp"))).collect();
    let ways = ["off", "straight", "geodesic"];
    assert_eq!(found, ways.map(|way| [(way, "4"), (way, "16")]).concat());
    for row in &rows {
        let mse = row.number("mse");
        assert!((row.number("rmse").powi(2) / mse - 1.0).abs() < 1e-9, "{row:?}");
        assert!((row.number("efficiency") * mse * row.number("seconds") - 1.0).abs() < 1e-9, "{row:?}");
        assert!(row.number("relmse") > 0.0 && row.number("p999") > 0.0 && row.number("gain") > 0.0);
        assert!(row.number("mse_error") > 0.0 && row.number("mean_ratio_error") > 0.0, "{row:?}");
    }
    assert!((rows[0].number("median_gain") - 1.0).abs() < 1e-9, "{:?}", rows[0]);
    // Two tables with two lines above their rows, and a line between them.
    assert_eq!(table.lines().count(), 2 + 6 + 1 + 2 + 3, "{table}");
    let svg = place.read("study.svg");
    for part in [">off<", ">straight<", ">geodesic<", "time (s)", "samples per pixel", "RMSE (radiance)"] {
        assert!(svg.contains(part), "{part} is missing");
    }
    assert!(image::open(place.path("study.png")).unwrap().width() > 800);

    // Errors are the same again, on any number of threads.
    let (again, _) = light_rows(&place, &["--spps", "4,16", "--threads", "1"]);
    for (row, again) in rows.iter().zip(&again) {
        for column in ["mse", "mse_error", "relmse", "p999", "mean_ratio", "mean_ratio_error"] {
            assert_eq!(row.text(column), again.text(column), "{column}");
        }
    }
}

#[test]
fn one_way_in_one_round_has_neither_gains_nor_errors() {
    let place = folder(LAMP);
    let flags = ["--size", "16x12", "--light-sampling", "geodesic", "--spps", "2", "--rounds", "1"];
    let (rows, table) = written(&place, &study(&place, "study", &flags));
    assert!(rows.len() == 1 && rows[0].number("mse") > 0.0, "{table}");
    for column in ["mse_error", "relmse_error", "mean_ratio_error", "gain", "relative_gain", "median_gain"] {
        assert!(rows[0].text(column).is_empty(), "{column}: {:?}", rows[0]);
    }
}

#[test]
fn in_flat_space_all_ways_have_the_same_mean_and_light_sampling_less_noise() {
    let (rows, table) = light_rows(&folder(LAMP), &["--spps", "16", "--reference-spp", "1024"]);
    let [off, straight, geodesic] = ["off", "straight", "geodesic"].map(|way| {
        let [mean, error] = ["mean_ratio", "mean_ratio_error"].map(|name| column(&rows, way, name)[0]);
        assert!((mean - 1.0).abs() < 4.0 * error, "{way}\n{table}");
        (mean, error)
    });
    assert!((geodesic.0 - off.0).abs() < 4.0 * geodesic.1.hypot(off.1), "{table}");
    assert!(geodesic.1 < 0.05 && straight.1 < 0.05, "{table}");
    let mse = |way| column(&rows, way, "mse")[0];
    assert!(mse("geodesic") < 0.1 * mse("off") && mse("straight") < 0.1 * mse("off"), "{table}");
}

/// The paper's box with a small lamp, without caustics, looked into where the camera does not see the lamp.
const SMALL_LAMP: [&str; 7] = [
    "entity.light.sphere.center=[0,20,56.6]",
    "entity.light.sphere.radius=1.5",
    "entity.light.emission=400",
    "entity.glass ball.material=\"white\"",
    "entity.mirror ball.material=\"white\"",
    "camera.direction=[0.12,-0.1,-1]",
    "camera.vertical_fov=8",
];

#[test]
fn near_a_hole_straight_light_is_too_dark_and_light_along_geodesics_is_not() {
    let scene = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("scenes/cornell_black_hole.toml");
    let place = folder(&fs::read_to_string(scene).unwrap());
    let changes = SMALL_LAMP.map(|change| ["--set", change]).concat();
    let (rows, table) = light_rows(&place, &[&changes[..], &["--spps", "4,16"]].concat());
    let of = |way, name| column(&rows, way, name);
    for spp in 0..2 {
        let mean = |way| (of(way, "mean_ratio")[spp], of(way, "mean_ratio_error")[spp]);
        let (straight, error) = mean("straight");
        // It has fireflies, and then large errors.
        assert!(straight < 0.9 && straight + 3.0 * error < 1.0, "{table}");
        let (geodesic, error) = mean("geodesic");
        assert!((geodesic - 1.0).abs() < 4.0 * error && error < 0.1, "{table}");
        // At equal samples: times would depend on what else the machine does.
        for error in ["mse", "relmse"] {
            assert!(of("off", error)[spp] > 20.0 * of("geodesic", error)[spp], "{error}\n{table}");
        }
    }
    // A bias stays, noise does not.
    let falls = |way| of(way, "mse")[0] / of(way, "mse")[1];
    assert!(falls("geodesic") > 2.5 && falls("straight") < 2.5, "{table}");
}

#[test]
fn a_picture_can_be_the_reference_and_its_variances_are_subtracted() {
    let place = folder(LAMP);
    // Of the same noise as the pictures: half of the measured squares are its own.
    let render = ["render", "scene.toml", "--size", "32x24", "--spp", "64", "--sampler", "independent"];
    let flags = ["--size", "32x24", "--spps", "64", "--set", "render.sampler=\"independent\"", "--reference"];
    let with = |file: &str, more: &[&str]| {
        let output = place.run(&[&render[..], &["-o", file], more].concat());
        assert_good(&output);
        let output = study(&place, "study", &[&LIGHTS[2..], &flags[..], &[file]].concat());
        (stderr(&output), written(&place, &output).0)
    };
    let (said, rows) = with("known.exr", &["--aov", "variance"]);
    assert!(!said.contains("warning"), "{said}");
    let (said, unknown) = with("unknown.exr", &[]);
    assert!(said.contains("`unknown.exr` has no variances") && said.contains("--aov variance"), "{said}");
    let ratio = column(&unknown, "geodesic", "mse")[0] / column(&rows, "geodesic", "mse")[0];
    assert!((1.5..2.7).contains(&ratio), "{ratio}");
}

#[test]
fn what_does_not_belong_to_a_study_of_light_sampling_is_refused() {
    let place = folder(LAMP);
    let render = |size: &str, file: &str, more: &[&str]| {
        let output = place.run(
            &[&["render", "scene.toml", "--spp", "1", "--no-png", "--size", size, "-o", file], more].concat(),
        );
        assert_good(&output);
    };
    render("8x6", "small.exr", &[]);
    render("16x12", "part.exr", &["--crop", "0,0,8,12"]);
    fs::write(place.path("rays.csv"), RAYS).unwrap();
    let cases: &[(&[&str], &[&str])] = &[
        (&["--steppers", "rkn6"], &["--steppers", "--light-sampling", "cannot be used"]),
        (&["--precisions", "f64"], &["--precisions", "cannot be used"]),
        (&["--tolerances", "1e-3"], &["--tolerances", "cannot be used"]),
        (&["--schedules", "wavefront"], &["--schedules", "cannot be used"]),
        (&["--arc-tolerance", "1"], &["--arc-tolerance", "cannot be used"]),
        (&["--spp", "4"], &["--spp", "cannot be used"]),
        (&["--spps", "0"], &["--spps", "from 1"]),
        (&["--reference-spp", "0"], &["--reference-spp", "from 1"]),
        (&["--reference-spp", "4", "--reference", "small.exr"], &["--reference", "cannot be used"]),
        (&["--reference", "none.exr"], &["cannot read `none.exr`", "help:"]),
        (&["--reference", "small.exr"], &["`small.exr`", "8x6", "16x12", "--size"]),
        (&["--reference", "part.exr"], &["`part.exr`", "part", "--crop"]),
        (&["--set", "render.max_depth=1"], &["no surface", "max_depth"]),
    ];
    let files = fs::read_dir(place.folder()).unwrap().count();
    for (flags, said) in cases {
        assert_refused(&study(&place, "study", &[&LIGHTS, *flags].concat()), said);
        assert_eq!(fs::read_dir(place.folder()).unwrap().count(), files, "{flags:?}");
    }
    let dark = study(&place, "study", &[&LIGHTS, &["--set", "entity.2.emission=0"][..]].concat());
    let said = stderr(&dark);
    assert!(dark.status.code() == Some(2) && said.contains("`scene.toml` has no lights"), "{said}");
    assert!(said.contains("help: give a scene with an emission") && dark.stdout.is_empty(), "{said}");
    let refused = |flags: &[&str], said: &[&str]| assert_refused(&study(&place, "study", flags), said);
    refused(&["--light-sampling", "curved"], &["--light-sampling", "geodesic"]);
    refused(&["--light-sampling"], &["--light-sampling", "value is required"]);
    refused(&["--spps", "4"], &["--light-sampling", "not provided"]);
    refused(&["--reference-spp", "4"], &["--light-sampling", "not provided"]);
    let rays = ["study", "--rays", "rays.csv", "-o", "study", "--light-sampling", "off"];
    assert_refused(&place.run(&rays), &["--light-sampling", "cannot be used"]);
}
