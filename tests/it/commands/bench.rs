//! `warpfront bench`: what it prints and writes, and what it refuses.

use std::collections::HashMap;
use std::fs;

use crate::support::Row;
use crate::support::command::{Folder, assert_good, assert_refused, stderr, stdout};
use serde_json::Value;

/// A hole of r_s = 1 between the camera and a wall, and a lamp.
const SCENE: &str = "
[spacetime]
kind = \"schwarzschild\"
schwarzschild_radius = 1
[camera]
position = [0, 0, 12]
look_at = [0, 0, 0]
vertical_fov = 50
[[entity]]
disk = { center = [0, 0, -6], normal = [0, 0, 1], outer = 6 }
[[entity]]
sphere = { center = [2, 4, 0], radius = 0.5 }
emission = 10
";
const SMALL: [&str; 8] = ["--size", "24x16", "--rounds", "2", "--spp", "2", "--threads", "2"];

/// What is swept, the values asked for, those expected, and what shows them in a row.
type Sweep = (&'static str, &'static str, &'static [&'static str], fn(&Row) -> f64);

fn place() -> Folder {
    Folder::with(&[("scene.toml", SCENE)])
}

/// A small race and its rows, its record and what it printed.
fn race(place: &Folder, flags: &[&str]) -> (Vec<Row>, Value, String) {
    let output = place.run(&[&["bench", "scene.toml", "-o", "out"], flags].concat());
    assert_good(&output);
    for file in ["out.csv", "out.json", "out.svg", "out.png"] {
        assert!(stderr(&output).contains(file), "{}", stderr(&output));
    }
    let json = serde_json::from_str(&place.read("out.json")).unwrap();
    (place.rows("out.csv"), json, stdout(&output))
}

#[test]
fn contenders_take_turns_and_both_schedules_do_the_same_work() {
    let place = place();
    let (rows, json, text) =
        race(&place, &[&SMALL[..], &["--baseline", "per-pixel,paper,flat,wavefront"]].concat());
    let found: Vec<(&str, &str)> =
        rows.iter().map(|row| (row.text("contender"), row.text("round"))).collect();
    let names = ["wavefront", "per-pixel", "paper", "flat", "wavefront"];
    assert_eq!(found, names.map(|name| [(name, "1"), (name, "2")]).concat());
    for column in ["paths", "rays", "light_rays", "steps", "queries"] {
        let counts: Vec<f64> = rows[..4].iter().map(|row| row.number(column)).collect();
        assert!(counts[0] > 0.0 && counts.iter().all(|count| *count == counts[0]), "{column}: {counts:?}");
    }
    assert!(rows.iter().all(|row| row.number("paths") == 24.0 * 16.0 * 2.0 && row.number("seconds") > 0.0));
    // The paper's march takes other steps, flat space one query per ray at most.
    assert!(rows[4].number("steps") != rows[0].number("steps"));
    assert!(rows[6].number("queries") <= rows[6].number("rays") + rows[6].number("light_rays"));
    for part in
        ["2 rounds after one render each to warm up", "same, bit for bit", "paper's scheme", "flat space"]
    {
        assert!(text.contains(part), "{text}\nlacks {part}");
    }
    let contenders = json["points"][0]["contenders"].as_array().unwrap();
    assert_eq!(contenders.iter().map(|c| c["name"].as_str().unwrap()).collect::<Vec<_>>(), names);
    for contender in contenders {
        let [median, shortest, longest] =
            [0, 1, 2].map(|index: usize| contender["seconds"][index].as_f64().unwrap());
        assert!(shortest <= median && median <= longest && shortest > 0.0, "{contender}");
        assert_eq!(contender["rounds"].as_array().unwrap().len(), 2);
    }
    let ratio = |index: usize, part: &str| contenders[index]["time_ratio"][part].as_f64();
    assert!(ratio(0, "value").is_none() && ratio(1, "value").unwrap() > 0.0 && ratio(1, "error").is_some());
    assert!(contenders[1]["tracing_ratio"]["value"].as_f64().unwrap() > 0.0);
    assert_eq!(json["points"][0]["schwarzschild_radius"], 1.0);
}

#[test]
fn stages_handle_every_ray_and_lanes_are_neither_empty_nor_more_than_full() {
    let place = place();
    let (rows, json, text) = race(&place, &SMALL);
    let wavefront = &rows[0];
    for stage in ["advance", "intersect", "settle"] {
        assert_eq!(wavefront.number(&format!("{stage}_items")), wavefront.number("steps"), "{stage}");
    }
    let paths = wavefront.number("generate_items");
    assert_eq!(paths, wavefront.number("film_items"));
    assert!(paths >= wavefront.number("paths"), "edges of lamps have paths of their own");
    // Every ray ends once: at infinity or in the hole, or where it is shaded or brings light.
    let ended = wavefront.number("escape_items") + wavefront.number("scatter_items");
    assert_eq!(ended, wavefront.number("rays") + wavefront.number("light_rays"));
    let occupancy = &json["points"][0]["contenders"][0]["rounds"][0]["stages"]["occupancy"];
    let lanes = |name: &str| occupancy[name].as_u64().unwrap();
    assert!(lanes("rounds") > 0 && lanes("live") >= lanes("rounds"));
    assert!(lanes("live") <= lanes("blocks") && lanes("live") <= lanes("lanes"), "{occupancy}");
    let share = wavefront.number("occupancy");
    assert!(share > 0.0 && share <= 1.0, "{share}");
    let seconds: f64 = ["generate", "advance", "intersect", "settle", "escape", "scatter", "film"]
        .iter()
        .map(|stage| wavefront.number(&format!("{stage}_seconds")))
        .sum();
    let learning = wavefront.number("learning_seconds");
    assert!(learning > 0.0 && seconds > 0.0);
    let whole = wavefront.number("cpu_seconds") - learning;
    assert!(seconds <= whole, "{seconds} of {whole}");
    let per_pixel = &rows[2];
    assert!(
        per_pixel.text("occupancy").is_empty() && per_pixel.text("advance_seconds").is_empty(),
        "{per_pixel:?}"
    );
    for part in [" generate | ", " learn | ", " rest | ", "lanes in use"] {
        assert!(text.contains(part), "{text}\nlacks {part}");
    }
    let svg = place.read("out.svg");
    for part in ["scatter", "per-pixel", "CPU time per camera path (µs)", "round"] {
        assert!(svg.contains(part), "{part} is missing");
    }
    assert!(image::open(place.path("out.png")).unwrap().width() > 800);
}

#[test]
fn a_build_is_compared_with_the_record_of_the_one_before() {
    let place = place();
    race(&place, &SMALL);
    let again = |flags: &[&str]| {
        place.run(&[&["bench", "scene.toml", "--baseline", "flat,previous:out.json"], flags].concat())
    };
    let output = again(&SMALL);
    assert_good(&output);
    let text = stdout(&output);
    for part in ["wavefront: ", "times the CPU time per path of `out.json`", "| ns/ray before"] {
        assert!(text.contains(part), "{text}\nlacks {part}");
    }
    assert_refused(&again(&["--size", "24x16", "--spp", "3"]), &["out.json", "spp 2", "3"]);
    assert_refused(&again(&[&SMALL[..], &["-o", "out"]].concat()), &["out.json"]);
    let refused = |file: &str| {
        place.run(&["bench", "scene.toml", "--baseline", &format!("previous:{file}"), "--size", "24x16"])
    };
    assert_refused(&refused("none.json"), &["none.json"]);
    assert_refused(&refused("scene.toml"), &["scene.toml", "bench -o PREFIX"]);
}

#[test]
fn sweeps_measure_the_values_asked_for() {
    let place = place();
    let cases: [Sweep; 8] = [
        ("batch", "8,64", &["8", "64"], |row| row.number("batch")),
        ("threads", "1,2", &["1", "2"], |row| row.number("threads")),
        ("pixels", "96,384", &["96", "384"], |row| row.number("width") * row.number("height")),
        ("spp", "2,16,2", &["2", "16"], |row| row.number("spp")),
        ("depth", "1,3", &["1", "3"], |row| row.number("value")),
        ("radius", "0.5,2", &["0.5", "2"], |row| row.number("value")),
        ("tolerance", "1e-2,1e-6", &["0.01", "0.000001"], |row| row.number("value")),
        ("triangles", "100,1000", &["80", "980"], |row| row.number("value")),
    ];
    let small = ["--size", "24x16", "--rounds", "1"];
    let mut costs = HashMap::new();
    for (sweep, values, expected, found) in cases {
        let (rows, json, text) =
            race(&place, &[&small[..], &["--sweep", sweep, "--values", values]].concat());
        let pairs: Vec<(&str, &str)> =
            rows.iter().map(|row| (row.text("value"), row.text("contender"))).collect();
        let both = |value: &&'static str| [(*value, "wavefront"), (*value, "per-pixel")];
        assert_eq!(pairs, expected.iter().flat_map(both).collect::<Vec<_>>(), "{sweep}");
        assert!(
            rows.iter().all(|row| row.text("sweep") == sweep && found(row) == row.number("value")),
            "{rows:?}"
        );
        assert_eq!(json["sweep"], sweep);
        assert_eq!(json["points"].as_array().unwrap().len(), 2);
        // A table with two lines above its rows, one line before it, and one per contender after it.
        assert_eq!(text.lines().count(), 2 + 2 + 4 + 1 + 2, "{text}");
        costs.insert(sweep, [&rows[0], &rows[2]].map(|row| (row.number("rays"), row.number("steps"))));
    }
    let grows = |sweep: &str, part: fn(&(f64, f64)) -> f64| part(&costs[sweep][1]) / part(&costs[sweep][0]);
    assert_eq!((grows("batch", |c| c.0), grows("threads", |c| c.1)), (1.0, 1.0));
    assert!(grows("pixels", |c| c.0) > 2.0 && grows("spp", |c| c.0) > 2.0 && grows("depth", |c| c.0) > 1.2);
    assert!(grows("tolerance", |c| c.1) > 1.2 && grows("radius", |c| c.1) != 1.0);
    let svg = place.read("out.svg");
    for part in ["triangles", "time (s)", "per-pixel", "CPU time per camera path (µs)"] {
        assert!(svg.contains(part), "{part} is missing");
    }
}

#[test]
fn without_a_prefix_and_values_it_prints_only() {
    let place = place();
    let output = place.run(&["bench", "scene.toml", "--size", "8x6", "--rounds", "1", "--sweep", "threads"]);
    assert_good(&output);
    assert!(stdout(&output).contains("| threads |") && stderr(&output).is_empty(), "{}", stderr(&output));
    assert_eq!(fs::read_dir(place.folder()).unwrap().count(), 1);
}

#[test]
fn what_cannot_be_measured_is_refused() {
    let flat = SCENE.replace("schwarzschild_radius = 1", "schwarzschild_radius = 0");
    let place = Folder::with(&[("scene.toml", SCENE), ("flat.toml", &flat)]);
    let cases: &[(&[&str], &[&str])] = &[
        (&["--rounds", "0"], &["--rounds", "from 1"]),
        (&["--size", "0x4"], &["--size"]),
        (&["--batch", "0"], &["--batch"]),
        (&["--baseline", "naive"], &["--baseline", "per-pixel"]),
        (&["--sweep", "seed"], &["--sweep", "triangles"]),
        (&["--values", "1,2"], &["--sweep", "not provided"]),
        (&["--sweep", "spp", "--values", "0"], &["--values", "above 0"]),
        (&["--sweep", "spp", "--values", "1.5"], &["1.5", "whole numbers", "samples per pixel"]),
        (&["--sweep", "threads", "--values", "1e9"], &["1000000000", "from 1 to 1024"]),
        (&["--sweep", "radius", "--values", "1,60"], &["radius of 60", "inside the hole", "smaller"]),
        (&["--sweep", "tolerance", "--values", "1e-7", "--precision", "f32"], &["1e-7", "1.2e-5"]),
        (&["--sweep", "tolerance", "--stepper", "rk4-paper"], &["rk4-paper", "--stepper"]),
        (&["--sweep", "tolerance", "--tolerance", "1e-3"], &["--tolerance", "--values"]),
        (&["--sweep", "depth", "--max-depth", "3"], &["--max-depth", "--sweep depth", "--values"]),
        (&["--sweep", "batch", "--batch", "64"], &["--batch", "--sweep batch"]),
        (&["--set", "camera.zoom=1"], &["zoom"]),
        (&["-o", "missing/out"], &["missing", "does not exist"]),
    ];
    for (flags, said) in cases {
        assert_refused(&place.run(&[&["bench", "scene.toml"], *flags].concat()), said);
    }
    for flags in
        [["--baseline", "paper"], ["--baseline", "flat"], ["--sweep", "radius"], ["--sweep", "tolerance"]]
    {
        assert_refused(
            &place.run(&[&["bench", "flat.toml"], &flags[..]].concat()),
            &["flat", "--black-hole"],
        );
    }
    assert_eq!(fs::read_dir(place.folder()).unwrap().count(), 2);
}
