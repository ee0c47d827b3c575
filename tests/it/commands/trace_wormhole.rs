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
fn traced(place: &Folder, spacetime: &str, tolerance: &str, stepper: &str) -> Vec<Row> {
    let flags = ["--tolerance", tolerance, "--stepper", stepper, "-o", "out.csv"];
    let command = [&["trace", "--spacetime", spacetime, "rays.csv"], &flags[..]].concat();
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
            let found = traced(&place, "ellis-wormhole", tolerance, stepper);
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
fn the_table_of_interstellars_wormhole_is_followed_to_the_tolerance() {
    let name = "dneg_wormhole_rays.csv";
    let (place, exact) = (folder(&data(name)), table(name));
    for (tolerance, stepper) in
        [("1e-3", "rkn6"), ("1e-5", "rkn6"), ("1e-8", "rkn6"), ("1e-8", "dop853"), ("1e-10", "dop853")]
    {
        let found = traced(&place, "interstellar-wormhole", tolerance, stepper);
        assert_eq!(found.len(), exact.len());
        let (mut worst, allowed) = (0.0f64, tolerance.parse::<f64>().unwrap());
        for (found, exact) in found.iter().zip(&exact) {
            let what = format!("row {} ({}) at {tolerance}", exact.text("id"), exact.text("kind"));
            assert_eq!(found.number("side"), exact.number("side"), "{what}");
            let distance = |columns: [&str; 3]| found.vector(columns).distance(exact.vector(columns));
            let (sens, eps) = (exact.number("sens"), exact.number("eps"));
            let off = distance(["nx1", "ny1", "nz1"]).max(distance(["dx1", "dy1", "dz1"]));
            let share = off / ((allowed + 1e-15) * sens);
            worst = worst.max(share);
            assert!(share <= 1.0, "{what}: off by {off:e}, sens {sens}");
            let time = (found.number("t") / exact.number("t") - 1.0).abs();
            assert!(time <= 2.0 * (allowed + 2e-9) * sens, "{what}: time {time:e}");
            let swept = (found.number("phi") - exact.number("phi")).abs();
            assert!(swept <= 2.0 * (allowed + 1e-15) * sens, "{what}: swept {swept:e}");
            let h = exact.number("h");
            assert!((found.number("h") - h).abs() <= 1e-12 * h.max(1e-3), "{what}");
            assert!((found.number("eps") - eps).abs() < 1e-12, "{what}");
            let is_reflected = !exact.text("l_turn").is_empty();
            assert_eq!(!found.text("l_turn").is_empty(), is_reflected, "{what}");
            if is_reflected {
                let turn = found.number("l_turn") - exact.number("l_turn");
                assert!(
                    turn.abs() < (allowed + 1e-12) * exact.number("l_turn").max(1.0),
                    "{what}: turns {turn:e} off"
                );
            }
        }
        println!("{stepper} at {tolerance}: worst {worst:.3} of what is allowed");
    }
}

#[test]
fn the_starts_and_the_throats_of_tables_are_checked() {
    for (columns, values, what) in [
        ("rho,a,W,l0,nx0,ny0,nz0", "1,1,1,3,0,0,0", "direction from the centre"),
        ("rho,a,W,l0,nx0,ny0,nz0", "1,700,1,3,0,0,1", "throat_length"),
        ("rho,a,W,l0,nx0,ny0,nz0", "1,-1,1,3,0,0,1", "throat length"),
        ("rho,a,W,l0,nx0,ny0,nz0", "1,1,0,3,0,0,1", "lensing_width"),
        ("rho,a,W,x0,y0,z0,l0,nx0,ny0,nz0", "1,1,1,3,0,0,3,0,0,1", "one start"),
    ] {
        let place = folder(&format!("{columns},dx0,dy0,dz0,L\n{values},1,0,0,5\n"));
        let output = place.run(&["trace", "--spacetime", "interstellar-wormhole", "rays.csv"]);
        assert_code(&output, 2);
        let text = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(text.contains(what), "{text}");
    }
}

#[test]
fn a_table_of_ever_new_wormholes_ends_before_it_takes_all_memory() {
    let rows: String =
        (0..1010).map(|i| format!("1,1,{},3,1,0,0,-1,0.1,0,5\n", 0.1 + 1e-3 * f64::from(i))).collect();
    let place = folder(&format!("rho,a,W,l0,nx0,ny0,nz0,dx0,dy0,dz0,L\n{rows}"));
    let output = place.run(&["trace", "--spacetime", "interstellar-wormhole", "rays.csv", "-o", "out.csv"]);
    assert_code(&output, 2);
    // After lines of progress, on a slow machine.
    let text = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(text.contains("lensing_width") && text.contains("1000 in one run"), "{text}");
    assert_eq!(place.files(), ["rays.csv"]);
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
