//! `warpfront trace` through wormholes: the exact tables, in both charts and in one.

use std::fs;

use crate::support::command::{Folder, assert_code};
use crate::support::{Row, data, table};

/// With the rays of `text` in `rays.csv`.
fn folder(text: &str) -> Folder {
    let place = Folder::with(&[]);
    fs::write(place.path("rays.csv"), text).unwrap();
    place
}

/// The rows that `trace` writes for a table at a tolerance.
fn traced(place: &Folder, tolerance: &str, stepper: &str) -> Vec<Row> {
    let flags = ["--tolerance", tolerance, "--stepper", stepper, "-o", "out.csv"];
    let command = [&["trace", "--spacetime", "ellis-wormhole", "rays.csv"], &flags[..]].concat();
    assert_code(&place.run(&command), 0);
    place.rows("out.csv")
}

/// Radius of a row's sphere in the chart of its end.
fn radius(row: &Row, name: &str) -> f64 {
    if name == "ellis_gluing.csv" {
        return row.number("r_out");
    }
    let (l, b0) = (row.number("L"), row.number("b0"));
    let rho = 0.5 * (l + (l * l + b0 * b0).sqrt());
    if row.number("side") > 0.0 { rho } else { 0.25 * b0 * b0 / rho }
}

#[test]
fn tables_of_wormholes_are_followed_to_the_tolerance_in_both_conventions() {
    for name in ["ellis_gluing.csv", "ellis_wormhole_rays.csv"] {
        let (place, exact) = (folder(&data(name)), table(name));
        for (tolerance, stepper) in
            [("1e-3", "rkn6"), ("1e-5", "rkn6"), ("1e-8", "rkn6"), ("1e-10", "dop853")]
        {
            let found = traced(&place, tolerance, stepper);
            assert_eq!(found.len(), exact.len());
            let (mut worst, allowed) = (0.0f64, tolerance.parse::<f64>().unwrap());
            for (found, exact) in found.iter().zip(&exact) {
                let what = format!("{name} row {} at {tolerance}", exact.text("id"));
                assert_eq!(found.number("side"), exact.number("side"), "{what}");
                let distance = |columns| found.vector(columns).distance(exact.vector(columns));
                let far_away = if name == "ellis_gluing.csv" {
                    exact.vector(["cfx", "cfy", "cfz"]).length()
                        + exact.vector(["cnx", "cny", "cnz"]).length()
                } else {
                    0.0
                };
                let (r, sens) = (radius(exact, name), exact.number("sens"));
                let rounding = 1e-15 * (1.0 + far_away / (0.5 * exact.number("b0")));
                let off = (distance(["x1", "y1", "z1"]) - 1e-14 * far_away).max(0.0) / r;
                let turned = distance(["dx1", "dy1", "dz1"]);
                let share = off.max(turned) / ((allowed + rounding) * sens);
                worst = worst.max(share);
                assert!(share <= 1.0, "{what}: off by {off:e}, turned by {turned:e}, sens {sens}");
                let time = (found.number("t") / exact.number("t") - 1.0).abs();
                assert!(time <= 2.0 * (allowed + 1e-13) * sens, "{what}: time {time:e}");
                let same = |column: &str, slack: f64| {
                    let (found, exact) = (found.number(column), exact.number(column));
                    assert!(
                        (found - exact).abs() <= slack * exact.abs().max(1.0),
                        "{what}: {column} {found}"
                    );
                };
                same("phi", (allowed + rounding) * sens);
                same("h", 1e-12);
                same("sens", 0.3 * sens);
            }
            println!("{name} at {tolerance}: worst {worst:.3} of what is allowed");
        }
    }
}

#[test]
fn a_table_needs_one_radius_and_all_centres_or_none() {
    let head = "b0,x0,y0,z0,dx0,dy0,dz0";
    for (columns, values, what) in [
        ("", "", "needs one radius"),
        (",r_out,L", ",5,5", "needs one radius"),
        (",r_out,cnx", ",5,0", "some of the centres are missing"),
        (",r_out,cnx,cny,cnz,cfx,cfy,cfz", ",5,0,0,2.9,0,0,0", "within the throat"),
    ] {
        let place = folder(&format!("{head}{columns}\n1,0,0,3,1,0,0{values}\n"));
        let output = place.run(&["trace", "--spacetime", "ellis-wormhole", "rays.csv"]);
        assert_code(&output, 2);
        let text = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(text.contains(what), "{text}");
    }
}
