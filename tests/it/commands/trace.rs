//! `warpfront trace` as a user meets it: exact end states at every preset, the files, messages and exit codes.

use std::fs;
use std::process::{Output, Stdio};

use crate::support::command::{Folder, assert_code, assert_refused, stderr};
use crate::support::{Row, data, orbit_steppers, table};

/// Columns of rays around a hole.
const HEADER: &str = "rs,x0,y0,z0,dx0,dy0,dz0,r_out\n";

fn empty() -> Folder {
    Folder::with(&[])
}

/// With the rays of `text` in `rays.csv`.
fn folder(text: &str) -> Folder {
    let place = empty();
    fs::write(place.path("rays.csv"), text).unwrap();
    place
}

/// With the exact table in `rays.csv`.
fn exact_rays() -> Folder {
    folder(&data("schwarzschild_rays.csv"))
}

/// Runs `trace` on `rays.csv` around a hole.
fn trace(place: &Folder, flags: &[&str]) -> Output {
    place.run(&[&["trace", "--spacetime", "schwarzschild", "rays.csv"], flags].concat())
}

/// The rows that `trace` writes.
fn traced(place: &Folder, flags: &[&str]) -> Vec<Row> {
    assert_code(&trace(place, &[&["-o", "out.csv"], flags].concat()), 0);
    place.rows("out.csv")
}

/// Error of the end relative to what is allowed, over all rows, each within `tolerance` times its conditioning; closer
/// to the critical impact parameter than `beside`, relative to it, only the fate counts.
fn worst_end(found: &[Row], tolerance: f64, beside: f64) -> f64 {
    let exact = table("schwarzschild_rays.csv");
    assert_eq!(found.len(), exact.len());
    let mut worst = 0.0_f64;
    for (found, exact) in found.iter().zip(&exact) {
        for column in ["id", "kind", "status"] {
            assert_eq!(found.text(column), exact.text(column), "row {}", exact.text("id"));
        }
        if exact.text("status") == "captured" {
            let empty =
                ["x1", "y1", "z1", "dx1", "dy1", "dz1", "t", "phi", "revs", "r_min", "sens", "drift_h"];
            assert!(empty.iter().all(|column| found.text(column).is_empty()));
            continue;
        }
        if exact.maybe("eps").is_some_and(|eps| eps.abs() < beside) {
            continue;
        }
        let distance = |columns| found.vector(columns).distance(exact.vector(columns));
        let off = distance(["x1", "y1", "z1"]) / exact.number("r_out");
        let turned = distance(["dx1", "dy1", "dz1"]);
        let swept = (found.number("phi") - exact.number("phi")).abs();
        let share = off.max(turned).max(swept) / ((tolerance + 1e-15) * exact.number("sens"));
        worst = worst.max(share);
        assert!(share <= 1.0, "row {}: {share} of what is allowed", exact.text("id"));
        // A radial ray keeps its direction whatever the steps do, and is held to little else.
        assert!(found.number("drift_h").abs() < 1e-3 && found.text("steps").parse::<u32>().is_ok());
    }
    println!("tolerance {tolerance:e}: worst {worst:.3} of what is allowed");
    worst
}

#[test]
fn every_exact_ray_ends_where_it_should_at_every_preset() {
    let place = exact_rays();
    for (quality, tolerance) in [("draft", 1e-3), ("standard", 1e-5), ("reference", 1e-10)] {
        worst_end(&traced(&place, &["--quality", quality]), tolerance, 0.0);
    }
}

#[test]
fn a_table_of_rays_around_charged_holes_has_the_mass_as_its_unit() {
    let place = folder(&data("reissner_nordstrom_rays.csv"));
    let flags = ["trace", "--spacetime", "reissner-nordstrom", "rays.csv", "-o", "out.csv"];
    assert_code(&place.run(&flags), 0);
    let (found, exact) = (place.rows("out.csv"), table("reissner_nordstrom_rays.csv"));
    assert_eq!(found.len(), exact.len());
    for (found, exact) in found.iter().zip(&exact) {
        assert_eq!(found.text("status"), exact.text("status"), "row {}", exact.text("id"));
        assert_eq!(found.text("Q"), exact.text("Q"));
        let error = |column| match (found.maybe(column), exact.maybe(column)) {
            (Some(found), Some(exact)) => (found / exact - 1.0).abs(),
            _ => 0.0,
        };
        let sens = exact.maybe("sens").unwrap_or(1.0);
        assert!(
            error("t") < 1e-10 + 1e-12 * sens && error("b") < 1e-13 && error("r_min") < 1e-9,
            "{}",
            exact.text("id")
        );
    }
    let more = format!("Q,{}1.5,-20,3,1,1,0,0,30\n", HEADER.replace("rs,", ""));
    fs::write(place.path("rays.csv"), more).unwrap();
    let refused = place.run(&["trace", "--spacetime", "reissner-nordstrom", "rays.csv", "-o", "out.csv"]);
    assert_refused(&refused, &["line 2", "column `Q`", "the charge Q/M is 1.5", "more charge than mass"]);
}

#[test]
fn every_exact_ray_ends_where_it_should_with_every_stepper() {
    let place = exact_rays();
    for stepper in &orbit_steppers() {
        worst_end(&traced(&place, &["--stepper", stepper, "--tolerance", "1e-7"]), 1e-7, 0.0);
    }
}

#[test]
fn rays_around_a_hole_are_known_to_rounding_without_steps_by_default() {
    let found = traced(&exact_rays(), &["--quality", "draft"]);
    worst_end(&found, 1e-13, 0.0);
    assert!(found.iter().all(|row| row.text("steps") == "0"));
    let stepped = traced(&exact_rays(), &["--quality", "draft", "--stepper", "rkn6"]);
    assert!(stepped.iter().any(|row| row.text("steps") != "0"));
}

#[test]
fn single_precision_is_as_good_as_it_says() {
    // 100 roundings are the least tolerance. Beside the critical ray the impact parameter itself is moved, to 64
    // roundings from the critical one, lest rounding change the fate.
    let found = traced(&exact_rays(), &["--precision", "f32", "--stepper", "rkn6"]);
    worst_end(&found, 100.0 * f64::from(f32::EPSILON), 1e-5);
}

#[test]
fn the_other_columns_are_exact_by_default() {
    let found = traced(&exact_rays(), &[]);
    for (found, exact) in found.iter().zip(&table("schwarzschild_rays.csv")) {
        let flat = exact.text("kind") == "flat";
        let sens = exact.maybe("sens").unwrap_or(1.0);
        // In flat space the table has a bound of sens. A radial ray sweeps nothing, which nothing has to keep exact.
        // The radius of closest approach depends on b as the end does; b itself on the rounding of a far start.
        let far = found.vector(["x0", "y0", "z0"]).length();
        let columns = [
            ("t", 1e-10 + 1e-12 * sens),
            ("revs", 1e-10 * sens),
            ("b", 1e-14 * (1.0 + far / exact.number("b").max(1e-300))),
            ("r_min", 1e-12 + 1e-14 * sens.sqrt()),
            ("sens", if flat { f64::INFINITY } else { 1e-5 + 1e-12 * sens }),
        ];
        for (column, allowed) in columns {
            let [found_text, exact_text] = [found, exact].map(|row| row.text(column));
            assert_eq!(found_text.is_empty(), exact_text.is_empty(), "{column} of {}", exact.text("id"));
            let Some(number) = exact.maybe(column) else { continue };
            let error = (found.number(column) - number).abs() / number.abs().max(1e-300);
            let fine = error <= allowed || found.number(column) == number;
            assert!(fine, "{column} of {}: {error:e}, allowed {allowed:e}", exact.text("id"));
        }
        assert!(found.maybe("drift_h").is_none_or(|drift| drift.abs() < 1e-10));
        assert_eq!(found.maybe("eps").is_some(), !flat);
        if let Some(eps) = exact.maybe("eps") {
            assert!((found.number("eps") - eps).abs() < 1e-14 * (1.0 + eps.abs()) * (1.0 + far));
        }
        if let (Some(drift), Some(b)) = (found.maybe("drift_l"), exact.maybe("b")) {
            assert!(drift.abs() * b < 1e-14 * far.max(exact.number("r_out")), "{drift}");
        }
        // What came in comes out, digit for digit.
        for column in ["rs", "x0", "y0", "z0", "dx0", "dy0", "dz0", "r_out"] {
            assert_eq!(found.text(column), exact.text(column));
        }
    }
}

#[test]
fn the_columns_are_those_of_the_exact_table_and_more() {
    let place = exact_rays();
    traced(&place, &[]);
    let header = |text: &str| text.lines().find(|line| !line.starts_with('#')).unwrap().to_owned();
    let expected = header(&place.read("rays.csv")) + ",drift_h,drift_l,steps";
    assert_eq!(header(&place.read("out.csv")), expected);
    let comment = place.read("out.csv").lines().next().unwrap().to_owned();
    let settings = "trace --spacetime schwarzschild --stepper quadrature --tolerance 1e-10 --precision f64";
    assert!(comment.starts_with("# warpfront ") && comment.ends_with(settings), "{comment}");
}

#[test]
fn threads_change_no_byte_and_chunks_no_order() {
    // Three chunks, of rays that all differ.
    let mut text = HEADER.to_owned();
    for i in 0..20_000 {
        text += &format!("1,{},0,0,-1,{},0,50\n", 10.0 + f64::from(i) * 1e-3, f64::from(i) * 1e-4);
    }
    let place = folder(&text);
    let quick = ["--quality", "draft"];
    let rows = traced(&place, &[&quick[..], &["--threads", "1"]].concat());
    let one = place.read("out.csv");
    traced(&place, &[&quick[..], &["--threads", "2"]].concat());
    assert_eq!(one, place.read("out.csv"));
    assert_eq!(rows.len(), 20_000);
    assert!(rows.windows(2).all(|pair| pair[0].number("x0") < pair[1].number("x0")));
}

#[test]
fn flat_space_needs_no_radius_and_takes_no_notice_of_one() {
    let place = exact_rays();
    let output = place.run(&["trace", "--spacetime", "flat", "rays.csv", "-o", "out.csv"]);
    assert_code(&output, 0);
    let text = place.read("out.csv");
    assert!(text.contains("\nid,kind,x0,y0,z0,dx0,dy0,dz0,r_out,status,"));
    for row in place.rows("out.csv") {
        if row.text("status") == "escaped" {
            let start = row.vector(["x0", "y0", "z0"]);
            let direction = row.vector(["dx0", "dy0", "dz0"]).normalize();
            let end = start + row.number("t") * direction;
            let size = start.length() + row.number("r_out");
            assert!(end.distance(row.vector(["x1", "y1", "z1"])) < 1e-13 * size);
            assert!((end.length() - row.number("r_out")).abs() < 1e-13 * size);
            assert!((start.angle_between(end) - row.number("phi")).abs() < 1e-7);
        }
        assert!(row.text("eps").is_empty() && row.text("steps") == "0");
    }
}

#[test]
fn spaces_comments_labels_order_and_other_columns_do_not_matter() {
    let place = folder(
        "# made by hand\r\n\r\n# twice\r\nnote, r_out ,kind,dz0,dy0,dx0,z0,y0,x0,rs\r\n\
         \"a, b\", 5e1 ,\"x, y\",0,0,-2,0,3, 10 ,1\r\n# between\r\nagain,50,z,0,0,-1,0,3,10,1\r\n",
    );
    let output = trace(&place, &[]);
    assert_code(&output, 0);
    let text = String::from_utf8_lossy(&output.stdout);
    let lines: Vec<&str> = text.lines().collect();
    assert_eq!(lines.len(), 4, "{text}");
    assert!(lines[1].starts_with("kind,rs,x0,y0,z0,dx0,dy0,dz0,r_out,status,x1,"));
    assert!(lines[2].starts_with("\"x, y\",1,10,3,0,-2,0,0,5e1,escaped,"));
    // The length of the direction does not matter.
    let end = |line: &str| line.split_once(",escaped,").unwrap().1.to_owned();
    assert_eq!(end(lines[2]), end(lines[3]));
    assert!(stderr(&output).starts_with("2 rays: 2 escaped"), "{}", stderr(&output));
}

#[test]
fn a_table_without_rays_gives_one_without_ends() {
    let place = folder(HEADER);
    assert!(traced(&place, &[]).is_empty());
}

#[test]
fn a_bad_table_is_refused_where_it_is_bad_and_nothing_is_written() {
    let row = "1,10,3,0,-1,0,0,50\n";
    let cases: [(String, &[&str]); 14] = [
        (String::new(), &["no column `rs`", "rs,x0,y0,z0,dx0,dy0,dz0,r_out"]),
        (HEADER.replace(",dz0", ""), &["no column `dz0`", "help: name the columns"]),
        (HEADER.replace("rs,", "rs,rs,"), &["two columns `rs`"]),
        (
            format!("{HEADER}{row}1,10,abc,0,-1,0,0,50\n"),
            &["line 3", "column `y0`", "`abc`", "give a finite"],
        ),
        (format!("{HEADER}{row}1,10,,0,-1,0,0,50\n"), &["line 3", "column `y0`", "no number"]),
        (format!("{HEADER}1,10,nan,0,-1,0,0,50\n"), &["line 2", "column `y0`", "`nan`"]),
        (format!("{HEADER}1,10,0,0,-1,0,0,inf\n"), &["line 2", "column `r_out`", "`inf`"]),
        (format!("# c\n{HEADER}1,10,0,0,-1\n"), &["line 3", "5 cells", "8 columns"]),
        (format!("{HEADER}1,0.1,0.1,0,-1,0,0,50\n"), &["line 2", "`x0`", "horizon", "areal"]),
        (format!("{HEADER}1,0,0,0,-1,0,0,50\n"), &["line 2", "`x0`", "distance", "centre is 0", "above 0"]),
        (format!("{HEADER}1,10,0,0,0,0,0,50\n"), &["line 2", "`dx0`", "length of the direction is 0"]),
        (format!("{HEADER}1,10,0,0,1,0,0,0\n"), &["line 2", "`r_out`", "above 0"]),
        (format!("{HEADER}-1,10,0,0,1,0,0,50\n"), &["line 2", "`rs`", "0 for flat"]),
        (format!("{HEADER}{}1,10,0,0,1,0,0,-1\n", row.repeat(9000)), &["line 9002", "`r_out`"]),
    ];
    for (text, said) in cases {
        let place = folder(&text);
        let output = trace(&place, &["-o", "out.csv", "--quality", "draft"]);
        assert_refused(&output, &[&["`rays.csv`", "help: "], said].concat());
        assert_eq!(place.files(), ["rays.csv"], "{text}");
    }
}

#[test]
fn a_reader_that_has_gone_away_is_no_failure() {
    // Larger than a pipe holds.
    let place = folder(&format!("{HEADER}{}", "1,10,3,0,-1,0,0,50\n".repeat(2000)));
    let mut command = place.command(&["trace", "--spacetime", "schwarzschild", "rays.csv"]);
    let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    drop(child.stdout.take());
    let output = child.wait_with_output().unwrap();
    assert_code(&output, 0);
    assert!(!stderr(&output).contains("error"), "{}", stderr(&output));
}

#[test]
fn bytes_that_are_no_text_are_refused() {
    let place = empty();
    fs::write(place.path("rays.csv"), [HEADER.as_bytes(), b"1,\xff\xfe,0,0,1,0,0,5\n"].concat()).unwrap();
    assert_refused(&trace(&place, &["-o", "out.csv"]), &["line 2", "column `x0`", "is not a number"]);
}

#[test]
fn bad_arguments_are_refused() {
    let place = folder(&format!("{HEADER}1,10,3,0,-1,0,0,50\n"));
    assert_refused(&trace(&place, &["--stepper", "rk4-paper"]), &["rk4-paper", "help: take another stepper"]);
    assert_refused(&trace(&place, &["-o", "rays.csv"]), &["the table of rays itself"]);
    assert_refused(&trace(&place, &["-o", "missing/out.csv"]), &["missing", "does not exist"]);
    assert_refused(&trace(&place, &["--tolerance", "0"]), &["--tolerance", "above 0"]);
    let flat = ["trace", "--spacetime", "flat"];
    assert_refused(&place.run(&[&flat[..], &["none.csv"]].concat()), &["cannot read `none.csv`"]);
    assert_refused(&place.run(&[&flat[..], &["."]].concat()), &["cannot read `.`"]);
    assert_refused(
        &place.run(&["trace", "--spacetime", "goedel", "rays.csv"]),
        &["goedel", "schwarzschild, reissner-nordstrom,"],
    );
    assert_eq!(place.files(), ["rays.csv"]);
}
