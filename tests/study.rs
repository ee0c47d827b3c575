//! `warpfront study`: the files, the numbers in them, and what is refused.

use std::collections::HashMap;
use std::fs;
use std::path::PathBuf;
use std::process::{Command, Output, Stdio};

use tempfile::TempDir;

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

struct Place(TempDir);

impl Place {
    fn new(scene: &str) -> Self {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("scene.toml"), scene).unwrap();
        Self(folder)
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn study(&self, prefix: &str, flags: &[&str]) -> Output {
        let mut command = Command::new(env!("CARGO_BIN_EXE_warpfront"));
        command.current_dir(self.0.path()).args(["study", "scene.toml", "-o", prefix]).args(flags);
        command.stdin(Stdio::null()).output().unwrap()
    }

    /// The rows of a small study by column, and what was printed.
    fn rows(&self, flags: &[&str]) -> (Vec<HashMap<String, String>>, String) {
        let output = self.study("study", &[&SMALL, flags].concat());
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        let text = fs::read_to_string(self.path("study.csv")).unwrap();
        let mut lines = text.lines().map(|line| line.split(',').map(str::to_owned).collect::<Vec<_>>());
        let header = lines.next().unwrap();
        let row = |cells: Vec<String>| {
            assert_eq!(cells.len(), header.len());
            header.iter().cloned().zip(cells).collect()
        };
        (lines.map(row).collect(), String::from_utf8(output.stdout).unwrap())
    }
}

fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

fn number(row: &HashMap<String, String>, column: &str) -> f64 {
    row[column].parse().unwrap_or_else(|error| panic!("{column} {:?}: {error}", row[column]))
}

#[test]
fn tighter_tolerances_have_smaller_errors_and_more_steps() {
    let place = Place::new(SCENE);
    let (rows, table) = place.rows(&["--steppers", "rkn4,rkn6", "--tolerances", "1e-4,1e-9"]);
    assert_eq!(rows.len(), 4);
    for pair in rows.chunks(2) {
        let [loose, tight] = pair else { panic!() };
        assert_eq!(
            (loose["tolerance"].as_str(), tight["stepper"].as_str()),
            ("0.0001", loose["stepper"].as_str())
        );
        for error in ["position_p99", "direction_p99", "footprint_p99", "footprint_median", "position_rmse"] {
            assert!(number(tight, error) < 0.1 * number(loose, error), "{error}: {pair:?}");
        }
        assert!(number(loose, "footprint_p99") < 1.0 && number(tight, "footprint_p99") < 1e-3);
        assert!(number(tight, "steps_per_ray") > number(loose, "steps_per_ray"));
        assert!(pair.iter().all(|row| number(row, "rays") == 432.0 && number(row, "differ") < 0.05));
        assert!(
            pair.iter().all(|row| number(row, "ns_per_ray") > 0.0 && number(row, "paths_per_second") > 0.0)
        );
    }
    let marked = table.lines().filter(|line| line.contains('*')).count();
    let on_front = rows.iter().filter(|row| row["pareto"] == "1").count();
    assert!(marked == on_front && on_front > 0 && table.lines().count() == 6, "{table}");
}

#[test]
fn all_steppers_are_studied_and_the_one_without_tolerance_once() {
    let place = Place::new(SCENE);
    let (rows, table) = place.rows(&["--tolerances", "1e-3,1e-4", "--schedules", "wavefront,per-pixel"]);
    let count = |stepper: &str| rows.iter().filter(|row| row["stepper"] == stepper).count();
    assert_eq!((count("rkn4"), count("rkn6"), count("rk4-paper")), (4, 4, 2));
    assert!(rows.iter().filter(|row| row["stepper"] == "rk4-paper").all(|row| row["tolerance"].is_empty()));
    assert!(table.contains("rk4-paper") && table.contains("per-pixel"), "{table}");
    let svg = fs::read_to_string(place.path("study.svg")).unwrap();
    for part in
        ["rkn6, wavefront", "rk4-paper, per-pixel", "Pareto front", "error (pixels)", "camera ray (ns)"]
    {
        assert!(svg.contains(part), "{part} is missing");
    }
    let image = image::open(place.path("study.png")).unwrap();
    assert!(image.width() > 1000, "{}", image.width());
}

#[test]
fn schedules_have_the_same_errors() {
    let flags = ["--steppers", "rkn6", "--tolerances", "1e-4", "--schedules", "wavefront,per-pixel"];
    let (rows, _) = Place::new(SCENE).rows(&flags);
    assert_eq!(rows.len(), 2);
    assert_eq!(rows[0]["footprint_rmse"], rows[1]["footprint_rmse"]);
}

#[test]
fn flat_and_empty_scenes_are_studied_too() {
    let place = Place::new(SCENE);
    let (rows, _) = place.rows(&["--tolerances", "1e-4", "--set", "spacetime.schwarzschild_radius=0"]);
    assert!(rows.iter().all(|row| number(row, "footprint_rmse") == 0.0 && number(row, "differ") == 0.0));
    let (rows, _) = Place::new(SCENE.split("[[entity]]").next().unwrap()).rows(&["--tolerances", "1e-4"]);
    assert!(rows.iter().all(|row| row["position_rmse"].is_empty() && number(row, "direction_rmse") > 0.0));
}

#[test]
fn the_prefix_keeps_its_dots_and_files_are_named() {
    let place = Place::new(SCENE);
    let flags = [&SMALL[..], &["--steppers", "rkn6", "--tolerances", "1e-3,1e-3"]].concat();
    let output = place.study("v1.2", &flags);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert!(stderr(&output).contains("1 setting; wrote v1.2.csv, v1.2.svg, v1.2.png"), "{}", stderr(&output));
    assert!(["v1.2.csv", "v1.2.svg", "v1.2.png"].iter().all(|name| place.path(name).exists()));
}

#[test]
fn bad_flags_are_refused_with_a_remedy() {
    let place = Place::new(SCENE);
    let cases: &[(&str, &[&str], &[&str])] = &[
        ("study", &["--steppers", "euler"], &["--steppers", "rkn6"]),
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
        let result = place.study(prefix, flags);
        let text = stderr(&result);
        assert_eq!(result.status.code(), Some(2), "{text}");
        assert!(text.starts_with("error: ") && !text.contains("panicked"), "{text}");
        said.iter().for_each(|part| assert!(text.contains(part), "{text}\nlacks {part:?}"));
        assert_eq!(fs::read_dir(place.0.path()).unwrap().count(), 1);
    }
}
