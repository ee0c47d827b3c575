//! `warpfront trace` around spinning holes: exact end states through the command line, and what is refused.

use std::fs;

use crate::support::command::{Folder, assert_code, assert_refused};
use crate::support::{Row, data, table};

/// Columns of rays around a hole.
const HEADER: &str = "a,x0,y0,z0,px0,py0,pz0,r_out\n";

/// With the rays of `text` in `rays.csv`.
fn folder(text: &str) -> Folder {
    let place = Folder::with(&[]);
    fs::write(place.path("rays.csv"), text).unwrap();
    place
}

/// The rows that `trace` writes of `rays.csv`.
fn traced(place: &Folder, spacetime: &str, flags: &[&str]) -> Vec<Row> {
    let command = ["trace", "--spacetime", spacetime, "rays.csv", "-o", "out.csv"];
    assert_code(&place.run(&[&command[..], flags].concat()), 0);
    place.rows("out.csv")
}

/// The difference of a column from the exact one, 0 if both are empty.
fn error(found: &Row, exact: &Row, column: &str) -> f64 {
    match (found.maybe(column), exact.maybe(column)) {
        (Some(found), Some(exact)) => (found - exact).abs(),
        (None, None) => 0.0,
        both => panic!("{column} of row {}: {both:?}", exact.text("id")),
    }
}

#[test]
fn every_exact_ray_of_a_spinning_hole_ends_where_it_should_at_every_tolerance() {
    for (spacetime, name) in [("kerr", "kerr_rays.csv"), ("kerr-newman", "kerr_newman_rays.csv")] {
        let (place, exact) = (folder(&data(name)), table(name));
        for stepper in ["series", "dop853"] {
            for tolerance in ["1e-3", "1e-5", "1e-8", "1e-10"] {
                let found = traced(&place, spacetime, &["--stepper", stepper, "--tolerance", tolerance]);
                assert_eq!(found.len(), exact.len());
                for (found, exact) in found.iter().zip(&exact) {
                    let row = format!("{name}, row {}, {stepper} {tolerance}", exact.text("id"));
                    assert_eq!(found.text("status"), exact.text("status"), "{row}");
                    let Some(sens) = exact.maybe("sens") else { continue };
                    let distance = |columns| found.vector(columns).distance(exact.vector(columns));
                    let off = distance(["x1", "y1", "z1"]) / exact.number("r_out");
                    let off = off.max(distance(["px1", "py1", "pz1"]));
                    let allowed = (tolerance.parse::<f64>().unwrap() + 1e-15) * sens;
                    assert!(off <= allowed, "{row}: off by {off:e}, allowed {allowed:e}");
                }
            }
        }
    }
}

#[test]
fn the_other_columns_of_a_spinning_hole_are_exact_by_default() {
    for (spacetime, name) in [("kerr", "kerr_rays.csv"), ("kerr-newman", "kerr_newman_rays.csv")] {
        let found = traced(&folder(&data(name)), spacetime, &[]);
        for (found, exact) in found.iter().zip(&table(name)) {
            let row = format!("{name}, row {} ({})", exact.text("id"), exact.text("kind"));
            let sens = exact.maybe("sens").unwrap_or(1.0);
            let start = found.vector(["x0", "y0", "z0"]).length();
            let moment = 1.0 + start * found.vector(["px0", "py0", "pz0"]).length();
            let check = |column: &str, allowed: f64| {
                let off = error(found, exact, column);
                assert!(off <= allowed, "{row}: {column} off by {off:e}, allowed {allowed:e}");
            };
            check("t", 1e-10 * sens * start.max(exact.number("r_out")));
            check("Lz", 1e-14 * moment);
            check("Q", 1e-14 * moment * moment);
            if spacetime == "kerr" {
                check("r_turn", 1e-11 * sens.sqrt() * exact.maybe("r_turn").unwrap_or(1.0));
            } else {
                // The largest of all directions; the other table has that of one.
                check("sens", (1e-5 + 1e-11 * sens) * sens);
            }
        }
    }
}

#[test]
fn the_columns_of_a_spinning_hole_are_those_of_the_exact_table_and_the_steps() {
    let place = folder(&data("kerr_newman_rays.csv"));
    traced(&place, "kerr-newman", &[]);
    let text = place.read("out.csv");
    let expected =
        "\nid,kind,a,q,x0,y0,z0,px0,py0,pz0,r_out,status,x1,y1,z1,px1,py1,pz1,t,Lz,Q,r_turn,sens,steps\n";
    assert!(text.contains(expected), "{text}");
    let settings = "trace --spacetime kerr-newman --stepper series --tolerance 1e-10 --precision f64\n";
    assert!(text.lines().next().unwrap().ends_with(settings.trim()), "{text}");
}

#[test]
fn the_schwarzschild_radius_of_a_spinning_hole_is_its_scale() {
    let place = folder(&format!("rs,{HEADER}2,0.9,10,3,1,-1,0.2,0.1,20\n14,0.9,70,21,7,-1,0.2,0.1,140\n"));
    let rows = traced(&place, "kerr", &[]);
    let close = |column: &str, scale: f64| {
        let [one, other] = [0, 1].map(|row: usize| rows[row].number(column));
        assert!((other - scale * one).abs() < 1e-12 * other.abs(), "{column}: {one}, {other}");
    };
    for column in ["x1", "y1", "z1", "t", "Lz", "r_turn"] {
        close(column, 7.0);
    }
    for column in ["px1", "py1", "pz1", "sens"] {
        close(column, 1.0);
    }
    close("Q", 49.0);
}

#[test]
fn a_ray_whose_energy_is_not_positive_is_captured() {
    // In the ergosphere, with a momentum along N.
    let place = folder(&format!("{HEADER}0.998,1.6,0,0,0.8,-0.6,0,20\n0.998,1.6,0,0,0,1,0,20\n"));
    let rows = traced(&place, "kerr", &[]);
    assert_eq!(rows[0].text("status"), "captured");
    assert!(rows[0].text("Lz").is_empty() && rows[0].text("steps") == "0");
    assert!(!rows[1].text("Lz").is_empty());
}

#[test]
fn what_is_no_ray_around_a_spinning_hole_is_refused() {
    let row = "10,3,1,-1,0.2,0.1,20\n";
    let cases: [(String, &str, &[&str], &[&str]); 9] = [
        (format!("{HEADER}0.5,{row}"), "kerr", &["--stepper", "rkn6"], &["rkn6", "series, dop853"]),
        (format!("{HEADER}0.5,{row}"), "kerr", &["--precision", "f32"], &["--precision", "f64"]),
        (format!("{HEADER}1.5,{row}"), "kerr", &[], &["line 2", "column `a`", "a/M is 1.5", "no horizon"]),
        (format!("rs,{HEADER}0,0.5,{row}"), "kerr", &[], &["line 2", "column `rs`", "--spacetime flat"]),
        (
            format!("{HEADER}0.5,1.5,0,0,-1,0.2,0.1,20\n"),
            "kerr",
            &[],
            &["line 2", "`x0`", "the horizon is at"],
        ),
        (format!("{HEADER}0.5,10,3,1,0,0,0,20\n"), "kerr", &[], &["line 2", "columns `px0`, `py0`, `pz0`"]),
        (format!("{HEADER}0.5,10,3,1,1,0,0,0\n"), "kerr", &[], &["line 2", "column `r_out`", "above 0"]),
        (format!("q,{HEADER}0.8,0.8,{row}"), "kerr-newman", &[], &["line 2", "columns `a`, `q`", "horizon"]),
        (format!("{HEADER}0.8,{row}"), "kerr-newman", &[], &["no column `q`"]),
    ];
    for (text, spacetime, flags, said) in cases {
        let place = folder(&text);
        let command = ["trace", "--spacetime", spacetime, "rays.csv", "-o", "out.csv"];
        assert_refused(&place.run(&[&command[..], flags].concat()), said);
        assert_eq!(place.files(), ["rays.csv"], "{text}");
    }
}

#[test]
fn a_study_of_rays_around_a_spinning_hole_compares_with_the_exact_table() {
    let place = folder(&data("kerr_rays.csv"));
    let study = ["study", "--rays", "rays.csv", "--spacetime", "kerr", "-o", "study", "--rounds", "1"];
    assert_code(&place.run(&[&study[..], &["--tolerances", "1e-5,1e-9"]].concat()), 0);
    let rows = place.rows("study.csv");
    assert_eq!(rows.len(), 4);
    for row in &rows {
        assert_eq!(row.number("differ"), 0.0, "{row:?}");
        assert!(row.number("worst_over_tolerance") <= 1.0, "{row:?}");
    }
}
