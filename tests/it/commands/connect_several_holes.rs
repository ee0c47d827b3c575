//! `warpfront connect` among several holes: the rays of the exact table join their ends, and those of one hole are known.

use crate::support::command::{Folder, assert_code, assert_refused};
use crate::support::{Row, table};
use glam::DVec3;

/// The rows that `connect` writes of pairs.
fn connected(pairs: &str, spacetime: &str, flags: &[&str]) -> Vec<Row> {
    let place = Folder::with(&[("pairs.csv", pairs)]);
    let command = ["connect", "--spacetime", spacetime, "pairs.csv", "-o", "out.csv"];
    assert_code(&place.run(&[&command[..], flags].concat()), 0);
    place.rows("out.csv")
}

/// Cells of a vector.
fn cells(x: DVec3) -> String {
    x.to_array().map(|number| format!("{number:?}")).join(",")
}

/// Rows of the exact table whose rays `connect` misses, given a highest winding number; the others are as exact as asked.
fn missed_rows<'a>(exact: &[&'a Row], max_winding: &str) -> Vec<&'a str> {
    let columns = ["m1", "hx1", "hy1", "hz1", "m2", "hx2", "hy2", "hz2", "m3", "hx3", "hy3", "hz3"];
    let mut pairs = format!("pair,{},x0,x1,x2,y0,y1,y2\n", columns.join(","));
    for row in exact {
        let holes = columns.map(|column| row.text(column)).join(",");
        let ends =
            [["x0", "y0", "z0"], ["x1", "y1", "z1"]].map(|columns| cells(row.vector(columns))).join(",");
        pairs += &format!("{},{holes},{ends}\n", row.text("id"));
    }
    let found = connected(&pairs, "several-holes", &["--max-winding", max_winding]);
    let (mut missed, mut worst) = (Vec::new(), [0.0f64; 3]);
    for exact in exact {
        let id = exact.text("id");
        let direction = exact.vector(["dx0", "dy0", "dz0"]).normalize();
        let rays = found.iter().filter(|row| row.text("pair") == id);
        let off = |row: &&Row| row.vector(["dx0", "dx1", "dx2"]).distance(direction);
        let ray = rays.min_by(|one, other| off(one).total_cmp(&off(other)));
        let Some(ray) = ray.filter(|ray| off(ray) < 1e-6) else {
            missed.push(id);
            continue;
        };
        // Where the ends are given to rounding, an arrival is known as well as that lets it be.
        let turned = ray.vector(["dy0", "dy1", "dy2"]).distance(exact.vector(["dx1", "dy1", "dz1"]));
        let late = (ray.number("t") / exact.number("t") - 1.0).abs();
        let errors = [off(&ray), turned / exact.number("sens"), late];
        assert!(errors.iter().all(|&error| error < 1e-9), "row {id}: {errors:?}");
        for (worst, error) in worst.iter_mut().zip(errors) {
            *worst = worst.max(error);
        }
    }
    println!("{} of {} missed: {missed:?}; directions, times: {worst:?}", missed.len(), exact.len());
    missed
}

#[test]
fn the_rays_of_the_exact_table_join_their_ends() {
    let exact: Vec<Row> = table("majumdar_papapetrou_rays.csv");
    let escaped: Vec<&Row> = exact.iter().filter(|row| row.text("status") == "escaped").collect();
    let missed = missed_rows(&escaped, "2");
    // They wind more often.
    assert_eq!(missed, ["119", "125", "134", "135"]);
    let winding: Vec<&Row> = escaped.into_iter().filter(|row| missed.contains(&row.text("id"))).collect();
    // It winds about two holes, one after the other.
    assert_eq!(missed_rows(&winding, "4"), ["125"]);
}

#[test]
fn the_rays_past_one_hole_are_those_of_a_hole_of_extremal_charge() {
    let (center, mass) = (DVec3::new(0.3, -0.2, 1.1), 0.7);
    let points = [(5.0, 3.0), (2.5, 9.0), (20.0, 4.0)]
        .map(|(near, far)| (near * DVec3::new(0.6, 0.0, 0.8), far * DVec3::new(-0.36, 0.48, -0.8)));
    let (mut several, mut one) =
        ("m1,hx1,hy1,hz1,x0,x1,x2,y0,y1,y2\n".to_owned(), "rs,Q,x0,x1,x2,y0,y1,y2\n".to_owned());
    for (x, y) in points {
        several += &format!("{mass},{},{},{}\n", cells(center), cells(center + x), cells(center + y));
        one += &format!("{:?},1,{},{}\n", 2.0 * mass, cells(x), cells(y));
    }
    let several = connected(&several, "several-holes", &["--max-winding", "6"]);
    let one = connected(&one, "reissner-nordstrom", &["--max-winding", "6"]);
    assert_eq!(one.len(), 21);
    for one in one {
        let is_same = |row: &&Row| {
            row.text("pair") == one.text("pair") && (row.number("t") / one.number("t") - 1.0).abs() < 1e-9
        };
        let ray = several.iter().find(is_same).unwrap_or_else(|| panic!("{one:?}"));
        // An error of the start grows on the way to the end.
        let swing = one.number("swing");
        for (columns, allowed) in
            [(["dx0", "dx1", "dx2"], 1e-9), (["dy0", "dy1", "dy2"], 1e-9 + 1e-12 * swing)]
        {
            assert!(ray.vector(columns).distance(one.vector(columns)) < allowed, "{ray:?} {one:?}");
        }
        let spread = 1e-6 + 1e-10 * swing;
        for (column, allowed) in [("nu_x_over_nu_y", 1e-12), ("G_xy", spread), ("G_yx", spread)] {
            let ratio = ray.number(column) / one.number(column);
            assert!((ratio - 1.0).abs() < allowed, "{column}: {ratio} {ray:?} {one:?}");
        }
        assert!(ray.number("sens") >= 1.0);
    }
}

#[test]
fn pairs_without_holes_or_upon_one_are_refused() {
    let place = Folder::with(&[
        ("none.csv", "x0,x1,x2,y0,y1,y2\n3,0,0,0,3,0\n"),
        ("half.csv", "m1,hx1,x0,x1,x2,y0,y1,y2\n1,0,3,0,0,0,3,0\n"),
        ("upon.csv", "m1,hx1,hy1,hz1,x0,x1,x2,y0,y1,y2\n1,0,0,0,3,0,0,0,0,0\n"),
    ]);
    let run = |table: &str| place.run(&["connect", "--spacetime", "several-holes", table, "-o", "out.csv"]);
    assert_refused(&run("none.csv"), &["line 2", "there is no hole", "help: give `m1`"]);
    assert_refused(&run("half.csv"), &["line 2", "not all of its cells", "help: "]);
    assert_refused(&run("upon.csv"), &["line 2", "`y0`", "from a hole", "help: "]);
}
