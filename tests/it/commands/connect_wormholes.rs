//! `warpfront connect` through wormholes: the ray of every row of the exact tables joins its ends.

use std::f64::consts::PI;

use crate::support::command::{Folder, assert_code, assert_refused};
use crate::support::{Row, table};
use glam::DVec3;
use warpfront::spacetime::{ConformallyFlat, Interstellar};

/// The rows that `connect` writes of pairs.
fn connected(pairs: &str, spacetime: &str, flags: &[&str]) -> Vec<Row> {
    let place = Folder::with(&[("pairs.csv", pairs)]);
    let command = ["connect", "--spacetime", spacetime, "pairs.csv", "-o", "out.csv"];
    assert_code(&place.run(&[&command[..], flags].concat()), 0);
    place.rows("out.csv")
}

/// Six numbers, as cells.
fn cells(x: DVec3, y: DVec3) -> String {
    [x.x, x.y, x.z, y.x, y.y, y.z].map(|number| format!("{number:?}")).join(",")
}

/// Checks that the exact rays, from each x to its y, are among those found, and returns the largest errors of directions,
/// of angles swept and of relative times, which are below those allowed.
fn check(exact: &[Row], found: &[Row], name: &str, allowed: [f64; 3]) -> [f64; 3] {
    let mut worst = [0.0f64; 3];
    // Winding numbers are up to 8.
    for exact in exact.iter().filter(|row| row.number("phi") < 8.0 * PI) {
        let (id, phi) = (exact.text("id"), exact.number("phi"));
        let rays = found.iter().filter(|row| row.text("pair") == id);
        let off = |row: &&Row| (row.number("Phi") - phi).abs();
        let ray = rays.min_by(|one, other| off(one).total_cmp(&off(other))).unwrap();
        let turned =
            [(["dx0", "dx1", "dx2"], ["dx0", "dy0", "dz0"]), (["dy0", "dy1", "dy2"], ["dx1", "dy1", "dz1"])]
                .map(|(found, exact_columns)| {
                    ray.vector(found).distance(exact.vector(exact_columns).normalize())
                });
        let late = (ray.number("t") / exact.number("t") - 1.0).abs();
        // Ends are given to rounding, which near the critical ray decides how far it winds.
        let swept = off(&ray) / ray.number("swing").max(1.0);
        let errors = [turned[0].max(turned[1]), swept, late];
        let is_good = errors.iter().zip(allowed).all(|(&error, allowed)| error < allowed);
        assert!(is_good, "{name} row {id}: {errors:?} {ray:?}");
        for (worst, error) in worst.iter_mut().zip(errors) {
            *worst = worst.max(error);
        }
    }
    worst
}

#[test]
fn the_rays_of_an_ellis_wormhole_join_their_ends() {
    let exact = table("ellis_wormhole_rays.csv");
    let mut pairs = "pair,b0,x0,x1,x2,y0,y1,y2\n".to_owned();
    for row in &exact {
        let ends = cells(row.vector(["x0", "y0", "z0"]), row.vector(["x1", "y1", "z1"]));
        pairs += &format!("{},{},{ends}\n", row.text("id"), row.text("b0"));
    }
    let found = connected(&pairs, "ellis-wormhole", &["--max-winding", "8"]);
    println!("directions, angles, times: {:?}", check(&exact, &found, "Ellis", [1e-9; 3]));
}

#[test]
fn the_rays_of_interstellars_wormhole_join_their_ends() {
    let exact = table("dneg_wormhole_rays.csv");
    let mut pairs = "pair,rho,a,W,x0,x1,x2,y0,y1,y2\n".to_owned();
    for row in &exact {
        let [rho, a, w] = ["rho", "a", "W"].map(|column| row.number(column));
        let metric = Interstellar::new(rho, 2.0 * a, w);
        let point = |l: f64, n: [&str; 3]| {
            let radius = metric.isotropic_radius(l.abs());
            let radius = if l < 0.0 { metric.throat().powi(2) / radius } else { radius };
            radius * row.vector(n).normalize()
        };
        let x = point(row.number("l0"), ["nx0", "ny0", "nz0"]);
        let y = point(row.number("side") * row.number("L"), ["nx1", "ny1", "nz1"]);
        pairs += &format!("{},{rho:?},{a:?},{w:?},{}\n", row.text("id"), cells(x, y));
    }
    let found = connected(&pairs, "interstellar-wormhole", &["--max-winding", "8"]);
    // Far away its index goes as a logarithm, of which a polynomial holds some digits.
    println!("directions, angles, times: {:?}", check(&exact, &found, "Interstellar", [1e-7, 1e-9, 1e-5]));
}

#[test]
fn both_sides_of_a_wormhole_see_the_same_and_areas_are_those_of_each_side() {
    // Points, and their images on the other side: b₀/2 is 1.
    let beyond = |x: DVec3| x / x.length_squared();
    let (x, y) = (DVec3::new(3.0, 1.0, -0.5), DVec3::new(-1.0, 2.0, 0.7));
    let rows = |x: DVec3, y: DVec3| {
        connected(
            &format!("b0,x0,x1,x2,y0,y1,y2\n2,{}\n", cells(x, y)),
            "ellis-wormhole",
            &["--max-winding", "2"],
        )
    };
    let through = |x: DVec3, y: DVec3| [rows(x, y), rows(beyond(x), beyond(y))];
    for [here, there] in [through(x, y), through(x, beyond(y)), through(beyond(x), y)] {
        assert_eq!((here.len(), there.len()), (3, 3));
        for (here, there) in here.iter().zip(&there) {
            for column in ["Phi", "b", "t", "G_xy", "G_yx", "swing"] {
                let (a, b) = (here.number(column), there.number(column));
                assert!((a / b - 1.0).abs() < 1e-11, "{column}: {a} {b}");
            }
            assert_eq!(here.number("nu_x_over_nu_y"), 1.0);
        }
    }
    // A small cone of rays, moved at its end, through the throat.
    let (y, step) = (beyond(y), 1e-5);
    let ray = |y: DVec3| {
        let rows = rows(x, y);
        (rows[0].vector(["dx0", "dx1", "dx2"]), rows[0].vector(["dy0", "dy1", "dy2"]), rows[0].number("G_xy"))
    };
    let (_, arrival, spread) = ray(y);
    let (u, v) = arrival.any_orthonormal_pair();
    let turn = |along: DVec3| (ray(y + step * along).0 - ray(y - step * along).0) / (2.0 * step);
    let area = (1.0 + 1.0 / y.length_squared()).powi(2);
    let cone = turn(u).cross(turn(v)).length() / area;
    assert!((spread / cone - 1.0).abs() < 1e-7, "{spread} {cone}");
}

#[test]
fn radial_rays_pass_a_wormhole_and_rings_are_told() {
    let pairs = "b0,x0,x1,x2,y0,y1,y2\n1,3,0,0,0.01,0,0\n1,3,0,0,-0.01,0,0\n";
    let rows = connected(pairs, "ellis-wormhole", &["--max-winding", "3"]);
    assert_eq!(rows.len(), 2);
    assert_eq!([rows[0].number("Phi"), rows[0].number("b")], [0.0; 2]);
    assert!((rows[0].number("dx0") + 1.0).abs() < 1e-14 && (rows[0].number("dy0") + 1.0).abs() < 1e-14);
    // l = ρ − b₀²/4ρ at both ends.
    let length = (3.0 - 1.0 / 12.0) - (0.01 - 25.0);
    assert!((rows[0].number("t") / length - 1.0).abs() < 1e-12, "{}", rows[0].number("t"));
    assert_eq!(rows[1].number("G_xy"), f64::INFINITY);
    assert!((rows[1].number("Phi") - PI).abs() < 1e-15);
}

#[test]
fn a_wormhole_that_cannot_be_and_points_at_its_centre_are_refused() {
    let place = Folder::with(&[
        ("narrow.csv", "rho,a,W,x0,x1,x2,y0,y1,y2\n1,1,1e-9,3,0,0,0,3,0\n"),
        ("centre.csv", "b0,x0,x1,x2,y0,y1,y2\n1,3,0,0,0,0,0\n"),
    ]);
    let run = |spacetime: &str, table: &str| {
        place.run(&["connect", "--spacetime", spacetime, table, "-o", "out.csv"])
    };
    assert_refused(&run("interstellar-wormhole", "narrow.csv"), &["line 2", "lensing_width", "help: "]);
    assert_refused(&run("ellis-wormhole", "centre.csv"), &["line 2", "`y0`", "distance", "help: "]);
}
