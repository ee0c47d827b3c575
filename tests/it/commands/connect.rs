//! `warpfront connect` as a user meets it: every row of an exact table, the files, messages and exit codes.

use std::process::Output;

use crate::support::command::{Folder, assert_code, assert_refused, stderr};
use crate::support::{Row, data, table};

/// The table of exact connections.
const EXACT: &str = "schwarzschild_connections.csv";
/// Columns of a pair.
const HEADER: &str = "rs,x0,x1,x2,y0,y1,y2\n";
/// Directions at both ends.
const DIRECTIONS: [[&str; 3]; 2] = [["dx0", "dx1", "dx2"], ["dy0", "dy1", "dy2"]];

/// With the pairs of `text` in `pairs.csv`.
fn folder(text: &str) -> Folder {
    Folder::with(&[("pairs.csv", text)])
}

/// With the exact table in `pairs.csv`.
fn exact_pairs() -> Folder {
    folder(&data(EXACT))
}

/// Runs `connect` on `pairs.csv`.
fn connect(place: &Folder, flags: &[&str]) -> Output {
    place.run(&[&["connect", "pairs.csv"], flags].concat())
}

/// The rows that `connect` writes.
fn connected(place: &Folder, flags: &[&str]) -> Vec<Row> {
    assert_code(&connect(place, &[&["-o", "out.csv"], flags].concat()), 0);
    place.rows("out.csv")
}

/// Relative error, or absolute below 1.
fn error(found: &Row, exact: &Row, column: &str) -> f64 {
    (found.number(column) - exact.number(column)).abs() / exact.number(column).abs().max(1.0)
}

#[test]
fn every_exact_connection_is_found_and_no_other() {
    let found = connected(&exact_pairs(), &["--max-winding", "3"]);
    let exact = table(EXACT);
    assert_eq!(found.len(), exact.len());
    let mut worst = [0.0_f64; 7];
    for (found, exact) in found.iter().zip(&exact) {
        let name = format!("pair {}, winding {}", exact.text("pair"), exact.text("winding"));
        for column in ["pair", "kind", "winding", "rs", "x0", "x1", "x2", "y0", "y1", "y2"] {
            assert_eq!(found.text(column), exact.text(column), "{name}");
        }
        let turned = DIRECTIONS.map(|columns| found.vector(columns).distance(exact.vector(columns)));
        let [swept, b, time] = ["Phi", "b", "t"].map(|column| error(found, exact, column));
        let ratio = error(found, exact, "nu_x_over_nu_y");
        let relative =
            |column: &str| (found.number(column) - exact.number(column)).abs() / exact.number(column);
        let spread = relative("G_xy").max(relative("G_yx"));
        // Of a radial ray the table has none.
        let swing = if exact.text("kind") == "radial" { 0.0 } else { relative("swing") };
        let sine = if exact.number("Phi") == 0.0 { 1.0 } else { exact.number("Phi").sin().abs() };
        let allowed = (1e-14 * exact.number("swing") * (1.0 + 1.0 / sine)).max(1e-7);
        assert!(turned.iter().all(|&error| error <= 1e-9), "{name}: turned by {turned:?}");
        assert!(swept.max(b).max(time).max(ratio) <= 1e-9, "{name}: {swept:e} {b:e} {time:e} {ratio:e}");
        assert!(spread.max(swing) <= allowed, "{name}: {spread:e} {swing:e}, allowed {allowed:e}");
        let errors = [turned[0].max(turned[1]), swept, b, time, ratio, spread, spread / allowed];
        for (worst, error) in worst.iter_mut().zip(errors) {
            *worst = worst.max(error);
        }
    }
    let [turned, swept, b, time, ratio, spread, share] = worst;
    println!("direction {turned:.1e}, Phi {swept:.1e}, b {b:.1e}, t {time:.1e}, frequency {ratio:.1e}");
    println!("G {spread:.1e}, at most {share:.3} of what is allowed");
}

#[test]
fn the_table_has_the_columns_of_the_exact_one_below_the_settings() {
    let place = exact_pairs();
    connected(&place, &[]);
    let header = |text: &str| text.lines().find(|line| !line.starts_with('#')).unwrap().to_owned();
    let text = place.read("out.csv");
    assert_eq!(header(&text), header(&place.read("pairs.csv")));
    let comment = text.lines().next().unwrap();
    assert!(
        comment.starts_with("# warpfront ")
            && comment.ends_with(" connect --spacetime schwarzschild --max-winding 1"),
        "{comment}"
    );
    assert!(place.rows("out.csv").iter().all(|row| row.number("winding") <= 1.0));
}

#[test]
fn threads_change_no_byte_and_chunks_no_order() {
    // Three chunks, of pairs that all differ, without labels.
    let mut text = HEADER.to_owned();
    for i in 0..20_000 {
        text += &format!("1,{},0,0,-1,{},0\n", 10.0 + f64::from(i) * 1e-3, 1.0 + f64::from(i) * 1e-4);
    }
    let place = folder(&text);
    let rows = connected(&place, &["--threads", "1"]);
    let one = place.read("out.csv");
    connected(&place, &["--threads", "2"]);
    assert_eq!(one, place.read("out.csv"));
    assert_eq!(rows.len(), 40_000);
    for (i, row) in rows.iter().enumerate() {
        assert_eq!([row.number("pair"), row.number("winding")], [(i / 2 + 1) as f64, (i % 2) as f64]);
    }
}

#[test]
fn a_pair_on_several_rows_is_one_pair_and_other_columns_do_not_matter() {
    let place = folder(
        "# by hand\r\n note ,y2,y1,y0, x2 ,x1,x0,rs,kind,pair\r\n\"a, b\",0,1,-3e0,0,0,5,1,\"x, y\",first\r\n\
         # between\r\n,0,1,-3,0,0,5.0,1,z,first\r\n,0,1,-3,0,0,5.0,1,z,second\r\n",
    );
    let output = connect(&place, &["--max-winding", "0"]);
    assert_code(&output, 0);
    let text = String::from_utf8_lossy(&output.stdout);
    let lines: Vec<&str> = text.lines().collect();
    assert_eq!(lines.len(), 4, "{text}");
    assert!(lines[2].starts_with("first,\"x, y\",1,5,0,0,-3e0,1,0,0,"), "{text}");
    assert!(lines[3].starts_with("second,z,1,5.0,0,0,-3,1,0,0,"), "{text}");
    assert!(stderr(&output).starts_with("2 pairs: 2 connections; "), "{}", stderr(&output));
}

#[test]
fn points_on_a_line_with_the_hole_are_joined_once() {
    let rows = connected(
        &folder(&format!("{HEADER}1,2,0,0,5,0,0\n1,2,0,0,-5,0,0\n2,0.3,0.6,0.9,0.1e1,2,3\n")),
        &["--max-winding", "3"],
    );
    assert_eq!(rows.len(), 3);
    for row in [&rows[0], &rows[2]] {
        assert_eq!([row.number("winding"), row.number("Phi"), row.number("b")], [0.0; 3]);
        let way = (row.vector(["y0", "y1", "y2"]) - row.vector(["x0", "x1", "x2"])).normalize();
        assert!(DIRECTIONS.iter().all(|&columns| row.vector(columns).distance(way) < 1e-14));
        assert!(row.number("G_xy").is_finite() && row.number("G_yx").is_finite());
    }
    // A ring, for which one ray stands.
    assert_eq!([rows[1].number("winding"), rows[1].number("Phi")], [0.0, std::f64::consts::PI]);
    assert_eq!([rows[1].number("G_xy"), rows[1].number("G_yx")], [f64::INFINITY; 2]);
}

#[test]
fn a_bad_table_is_refused_where_it_is_bad_and_nothing_is_written() {
    let row = "1,10,3,0,-1,5,0\n";
    let labels = format!("pair,{HEADER}");
    let cases: [(String, &[&str]); 12] = [
        (String::new(), &["no column `rs`", "rs,x0,x1,x2,y0,y1,y2"]),
        (HEADER.replace(",y2", ""), &["no column `y2`", "help: name the columns"]),
        (HEADER.replace("rs,", "rs,rs,"), &["two columns `rs`"]),
        (format!("{HEADER}{row}1,10,abc,0,-1,0,0\n"), &["line 3", "column `x1`", "`abc`", "give a finite"]),
        (format!("{HEADER}1,10,nan,0,-1,0,0\n"), &["line 2", "column `x1`", "`nan`"]),
        (format!("# c\n{HEADER}1,10,0,0,-1\n"), &["line 3", "5 cells", "7 columns"]),
        (format!("{HEADER}1,0.1,0.1,0,-1,0,0\n"), &["line 2", "`x0`", "horizon", "areal"]),
        (format!("{HEADER}1,10,0,0,0,0.25,0\n"), &["line 2", "`y0`", "horizon"]),
        (format!("{HEADER}1,10,0,0,0,1e90,0\n"), &["line 2", "`x0` to `y2`", "distance", "to 1e70"]),
        (format!("{HEADER}1,10,3,0,10,3,0\n"), &["line 2", "`x0` to `y2`", "distance", "is 0"]),
        (format!("{HEADER}-1,10,3,0,1,3,0\n"), &["line 2", "`rs`", "0 for flat"]),
        (
            format!("{labels}a,{row}b,{row}a,{}", row.replace("-1", "-2")),
            &["line 4", "column `pair`", "`a`", "line 2", "a label of its own"],
        ),
    ];
    for (text, said) in cases {
        let place = folder(&text);
        let output = connect(&place, &["-o", "out.csv"]);
        assert_refused(&output, &[&["`pairs.csv`", "help: "], said].concat());
        assert_eq!(place.files(), ["pairs.csv"], "{text}");
    }
}

#[test]
fn bad_arguments_are_refused() {
    let place = folder(&format!("{HEADER}1,10,3,0,-1,0,0\n"));
    assert_refused(&connect(&place, &["--max-winding", "-1"]), &["--max-winding", "from 0 to 8"]);
    assert_refused(&connect(&place, &["-o", "pairs.csv"]), &["the table of pairs itself"]);
    assert_refused(&connect(&place, &["-o", "missing/out.csv"]), &["missing", "does not exist"]);
    assert_refused(&place.run(&["connect", "none.csv"]), &["cannot read `none.csv`", "pair of points"]);
    assert_eq!(place.files(), ["pairs.csv"]);
}
