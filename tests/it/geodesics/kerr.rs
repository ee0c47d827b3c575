//! Rays of spinning holes against exact tables and exact properties, by the Taylor series and, independently, by the
//! Hamiltonian.

use crate::support::{Random, Row, table};
use glam::DVec3;
use rayon::prelude::*;
use warpfront::geodesic::kerr::{
    Constants, KerrEnd, KerrLaunch, KerrPhoton, MinoState, PhotonEnd, Series, SeriesControl, SeriesStep,
    UnitHole, elapsed, follow, follow_photon,
};
use warpfront::spacetime::{Fate, KerrNewman, Placement, SpacetimeKind};

/// A ray of a table.
struct Case {
    name: String,
    hole: UnitHole,
    photon: KerrPhoton,
    r_out: f64,
    /// Exact state on the way out, and its sensitivity.
    exit: Option<(KerrPhoton, f64)>,
    /// Lz and Q.
    constants: [f64; 2],
}

impl Case {
    fn new(row: &Row, charged: bool) -> Self {
        let hole = UnitHole::new(row.number("a"), if charged { row.number("q") } else { 0.0 });
        let (x, p) = (row.vector(["x0", "y0", "z0"]), row.vector(["px0", "py0", "pz0"]));
        let captured = row.text("status") == "captured";
        let exit = || {
            let (x, p) = (row.vector(["x1", "y1", "z1"]), row.vector(["px1", "py1", "pz1"]));
            (KerrPhoton { x, p, t: row.number("t") }, row.number("sens"))
        };
        Self {
            name: format!("row {} ({}, a = {})", row.text("id"), row.text("kind"), hole.a),
            hole,
            photon: KerrPhoton::new(&hole, x, p).expect("energy 1"),
            r_out: row.number("r_out"),
            exit: (!captured).then(exit),
            constants: [row.number("Lz"), row.number("Q")],
        }
    }

    /// The rows of both tables.
    fn all() -> Vec<Self> {
        let kerr = table("kerr_rays.csv");
        let charged = table("kerr_newman_rays.csv");
        let kerr = kerr.iter().map(|row| Self::new(row, false));
        kerr.chain(charged.iter().map(|row| Self::new(row, true))).collect()
    }
}

/// A way to follow photons to a tolerance: their end, on the spheroid of a radius, and the steps that it took.
type Method = fn(&UnitHole, &KerrPhoton, f64, f64) -> (PhotonEnd, u32);

/// By the series; time, too.
fn by_series(hole: &UnitHole, photon: &KerrPhoton, tolerance: f64, r_out: f64) -> (PhotonEnd, u32) {
    let launch = KerrLaunch::with_momentum(hole, photon.x, photon.p);
    let mut t = 0.0;
    let journey = follow(hole, &launch, tolerance, 1.0 / r_out, |h, at| {
        t += elapsed(hole, &launch.constants, h, at);
    });
    let end = match journey.end {
        KerrEnd::Crosses(state) => {
            PhotonEnd::Crosses(KerrPhoton { t, ..state.photon(hole, &launch.constants) })
        }
        KerrEnd::Falls => PhotonEnd::Falls,
        KerrEnd::Misses => PhotonEnd::Misses,
        KerrEnd::StepLimit => PhotonEnd::StepLimit,
        KerrEnd::NonFinite => PhotonEnd::NonFinite,
    };
    (end, journey.steps)
}

/// By the Hamiltonian, with the fate that the constants of motion decide.
fn by_hamiltonian(hole: &UnitHole, photon: &KerrPhoton, tolerance: f64, r_out: f64) -> (PhotonEnd, u32) {
    let launch = KerrLaunch::with_momentum(hole, photon.x, photon.p);
    let fate = launch.fate();
    let journey = follow_photon(hole, *photon, Some(fate), tolerance, r_out);
    (journey.end, journey.steps)
}

/// By the Hamiltonian, which finds the fate by itself.
fn by_itself(hole: &UnitHole, photon: &KerrPhoton, tolerance: f64, r_out: f64) -> (PhotonEnd, u32) {
    let journey = follow_photon(hole, *photon, None, tolerance, r_out);
    (journey.end, journey.steps)
}

/// Follows all rays of the tables; the largest error over what is allowed.
fn check_tables(name: &str, method: Method, tolerance: f64) {
    let cases = Case::all();
    let ends: Vec<(PhotonEnd, u32)> =
        cases.par_iter().map(|case| method(&case.hole, &case.photon, tolerance, case.r_out)).collect();
    let (mut worst, mut worst_time, mut steps) = (0.0_f64, 0.0_f64, 0);
    let mut wrong = Vec::new();
    for (case, &(end, count)) in cases.iter().zip(&ends) {
        steps += count;
        match (end, case.exit) {
            (PhotonEnd::Crosses(found), Some((exact, sens))) => {
                let off = (found.x.distance(exact.x) / case.r_out).max(found.p.distance(exact.p));
                let share = off / ((tolerance + 1e-15) * sens);
                let late = (found.t - exact.t).abs() / (case.r_out + exact.t);
                worst = worst.max(share);
                worst_time = worst_time.max(late / ((tolerance + 1e-15) * sens));
                if share > 1.0 {
                    wrong.push(format!("{}: {share:.2} of what is allowed, sens {sens:.3e}", case.name));
                }
            }
            (PhotonEnd::Falls, None) => {}
            _ => wrong.push(format!("{}: {end:?}", case.name)),
        }
    }
    let per_ray = f64::from(steps) / cases.len() as f64;
    println!(
        "{name} at {tolerance:e}: worst {worst:.3}, time {worst_time:.3} of what is allowed, {per_ray:.1} steps"
    );
    assert!(wrong.is_empty(), "{name} at {tolerance:e}:\n{}", wrong.join("\n"));
    assert!(worst_time <= 1.0, "{name} at {tolerance:e}: {worst_time}");
}

#[test]
fn every_exact_ray_ends_where_it_should_by_the_series() {
    for tolerance in [1e-3, 1e-5, 1e-8, 1e-10] {
        check_tables("series", by_series, tolerance);
    }
}

#[test]
fn every_exact_ray_ends_where_it_should_by_the_hamiltonian() {
    for tolerance in [1e-3, 1e-5, 1e-8, 1e-10, 1e-12] {
        check_tables("hamiltonian", by_hamiltonian, tolerance);
    }
    check_tables("hamiltonian by itself", by_itself, 1e-12);
}

#[test]
fn constants_of_motion_are_those_of_the_tables() {
    for case in Case::all() {
        let Constants { l, j2, .. } =
            KerrLaunch::with_momentum(&case.hole, case.photon.x, case.photon.p).constants;
        let [exact_l, exact_q] = case.constants;
        let q = j2 - l * l;
        // Of a far start the rounding of its place is a part of what a camera's direction is.
        let moment = case.photon.x.length() * case.photon.p.length();
        let size = 1e-15 * (1.0 + moment) * (1.0 + j2.abs().sqrt());
        let off = (l - exact_l).abs().max((q - exact_q).abs());
        assert!(off < 16.0 * size, "{}: {l} for {exact_l}, {q} for {exact_q}", case.name);
    }
}

/// The ray from `r` at the angle `inclination` to the axis that arrives with Bardeen's impact parameters from there.
fn from_afar(hole: &UnitHole, r: f64, inclination: f64, alpha: f64, beta: f64) -> KerrPhoton {
    let (sin, cos) = inclination.sin_cos();
    let n = DVec3::new(sin, 0.0, cos);
    // N′ is what a photon that falls from there has across the line of sight; β is along −∂_θ.
    let m = DVec3::new(beta * cos, -alpha, -beta * sin);
    let l = -alpha * sin;
    let a2 = hole.a * hole.a;
    let j2 = m.length_squared() - a2 * cos * cos;
    let k = (l - hole.a).powi(2) + j2 - l * l;
    let constants =
        Constants { l, k, j2, k2: j2 - a2, kappa: a2 * (j2 - l * l) + hole.e2 * k, barrier: f64::INFINITY };
    let u = 1.0 / r;
    MinoState { u, v: constants.rate_squared(u).sqrt(), n, m }.photon(hole, &constants)
}

#[test]
fn fates_are_right_beside_the_edge_of_the_shadow() {
    let rows = table("kerr_critical.csv");
    let wrong: usize = rows
        .par_iter()
        .map(|row| {
            let hole = UnitHole::new(row.number("a"), 0.0);
            let edge = [row.number("alpha"), row.number("beta")];
            let mut wrong = 0;
            for (beside, fate) in [(-1e-9, Fate::Falls), (1e-9, Fate::Escapes)] {
                let [alpha, beta] = edge.map(|b| b * (1.0 + beside));
                let photon = from_afar(&hole, 1e3, row.number("inc_deg").to_radians(), alpha, beta);
                let launch = KerrLaunch::with_momentum(&hole, photon.x, photon.p);
                let found = launch.fate();
                if found != fate {
                    println!("{row:?} {beside}: {found:?}");
                    wrong += 1;
                }
            }
            wrong
        })
        .sum();
    assert_eq!(wrong, 0, "of {}", 2 * rows.len());
}

#[test]
fn the_hamiltonian_finds_the_same_fates_beside_the_edge_of_the_shadow() {
    let rows = table("kerr_critical.csv");
    rows.par_iter().step_by(29).for_each(|row| {
        let hole = UnitHole::new(row.number("a"), 0.0);
        // Beside extremal spins a ray winds about nearly stable orbits for ever.
        if hole.a > 0.9999 {
            return;
        }
        let edge = [row.number("alpha"), row.number("beta")];
        for (beside, falls) in [(-1e-7, true), (1e-7, false)] {
            let [alpha, beta] = edge.map(|b| b * (1.0 + beside));
            let photon = from_afar(&hole, 1e3, row.number("inc_deg").to_radians(), alpha, beta);
            let (end, _) = by_itself(&hole, &photon, 1e-12, 2e3);
            let right = if falls { end == PhotonEnd::Falls } else { matches!(end, PhotonEnd::Crosses(_)) };
            assert!(right, "{row:?} {beside}: {end:?}");
        }
    });
}

#[test]
fn equatorial_rays_turn_at_the_exact_impact_parameters() {
    for (a, prograde, retrograde) in [
        (0.9, 2.844_421_403_476, 6.832_319_230_447),
        (0.998, 2.110_887_794_553, 6.0 * ((0.998_f64).acos() / 3.0).cos() + 0.998),
        (0.9999, 2.024_561_677_005, 6.0 * ((0.9999_f64).acos() / 3.0).cos() + 0.9999),
    ] {
        let hole = UnitHole::new(a, 0.0);
        for (b, alpha) in [(prograde, -1.0), (retrograde, 1.0)] {
            for (beside, fate) in [(-1e-9, Fate::Falls), (1e-9, Fate::Escapes)] {
                let photon =
                    from_afar(&hole, 1e3, 0.5 * std::f64::consts::PI, alpha * b * (1.0 + beside), 0.0);
                let launch = KerrLaunch::with_momentum(&hole, photon.x, photon.p);
                assert_eq!(launch.fate(), fate, "a = {a}, b = {b}, {beside}");
            }
        }
    }
}

/// Rays that start around a hole of any spin: start, momentum of energy 1.
fn random_ray(random: &mut Random, hole: &UnitHole, radii: [f64; 2]) -> KerrPhoton {
    let n = random.direction();
    let x = hole.position(1.0 / random.log_between(radii[0], radii[1]), n);
    loop {
        if let Some(photon) = KerrPhoton::new(hole, x, random.direction()) {
            return photon;
        }
    }
}

/// Spins, of either sign, and charges.
const HOLES: [[f64; 2]; 8] = [
    [0.0, 0.0],
    [0.5, 0.0],
    [-0.9, 0.0],
    [0.998, 0.0],
    [-0.999_999, 0.0],
    [1.0, 0.0],
    [0.6, 0.8],
    [-0.3, 0.5],
];

#[test]
fn principal_null_rays_fall_straight() {
    for [a, e] in HOLES {
        let hole = UnitHole::new(a, e);
        let mut random = Random::new(1);
        for _ in 0..20 {
            let n = random.direction();
            let r = random.log_between(3.0, 1000.0);
            let launch = KerrLaunch::with_momentum(&hole, hole.position(1.0 / r, n), -n);
            let KerrLaunch { constants, mut state } = launch;
            let control = SeriesControl::new(14, 1e-12);
            let (mut t, mut steps) = (0.0, 0);
            while 1.0 / state.u > 1.0 / (0.9 * hole.horizon) {
                let series = Series::<14>::new(&hole, &constants, &state);
                let h = control.length(&hole, &series);
                // λ to 0.95 of the horizon: on such a ray u grows as λ.
                let h = h.min(0.95 * hole.horizon - state.u).max(1e-9);
                t += elapsed(&hole, &constants, h, &|part| series.at(&hole, part).state);
                state = SeriesStep::new(&hole, &constants, &series, h).end;
                steps += 1;
                assert!(steps < 60, "{a} {r}");
            }
            let off = state.n.distance(n);
            assert!(off < 1e-9, "a = {a}, e = {e}, from {r}: N moved by {off:e}");
            // r = r₀ − τ, t = τ.
            assert!((t - (r - 1.0 / state.u)).abs() < 1e-9 * r, "a = {a}: {t} for {}", r - 1.0 / state.u);
        }
    }
}

#[test]
fn a_hole_that_does_not_spin_is_schwarzschilds_at_the_areal_radius() {
    let areal = |rho: f64| rho * (1.0 + 0.5 / rho).powi(2);
    let mut compared = 0;
    for row in table("schwarzschild_rays.csv") {
        let rs = row.number("rs");
        if rs == 0.0 {
            continue;
        }
        let mass = 0.5 * rs;
        let hole = UnitHole::new(0.0, 0.0);
        let place = |columns| {
            let x = row.vector(columns) / mass;
            areal(x.length()) * x.normalize()
        };
        let x = place(["x0", "y0", "z0"]);
        let launch = KerrLaunch::at_rest(&hole, x, row.vector(["dx0", "dy0", "dz0"]).normalize());
        let r_out = areal(row.number("r_out") / mass);
        let journey = follow(&hole, &launch, 1e-12, 1.0 / r_out, |_, _| {});
        let KerrEnd::Crosses(state) = journey.end else {
            assert!(
                journey.end == KerrEnd::Falls && row.text("status") == "captured",
                "{row:?}: {journey:?}"
            );
            continue;
        };
        let found = state.photon(&hole, &launch.constants);
        let exact = place(["x1", "y1", "z1"]);
        let direction = row.vector(["dx1", "dy1", "dz1"]).normalize();
        let exact_p = KerrLaunch::at_rest(&hole, exact, direction);
        let p = exact_p.state.photon(&hole, &exact_p.constants).p;
        let allowed = 1e-11 * row.number("sens");
        let off = (found.x.distance(exact) / r_out).max(found.p.distance(p) / p.length());
        assert!(off < allowed, "row {}: {off:e}, allowed {allowed:e}", row.text("id"));
        compared += 1;
    }
    assert!(compared > 50);
}

#[test]
fn the_mirror_image_of_a_ray_runs_around_the_mirror_image_of_the_hole() {
    let mirrored = |v: DVec3| DVec3::new(v.x, -v.y, v.z);
    for method in [by_series as Method, by_hamiltonian] {
        for [a, e] in HOLES {
            let (hole, image) = (UnitHole::new(a, e), UnitHole::new(-a, e));
            let mut random = Random::new(2);
            for _ in 0..50 {
                let photon = random_ray(&mut random, &hole, [2.5, 50.0]);
                let (end, steps) = method(&hole, &photon, 1e-6, 60.0);
                let photon = KerrPhoton { x: mirrored(photon.x), p: mirrored(photon.p), t: 0.0 };
                let (other, other_steps) = method(&image, &photon, 1e-6, 60.0);
                match (end, other) {
                    (PhotonEnd::Crosses(one), PhotonEnd::Crosses(two)) => {
                        let off = one.x.distance(mirrored(two.x)) + one.p.distance(mirrored(two.p));
                        assert!(off < 1e-11 && (one.t - two.t).abs() < 1e-11, "a = {a}: {off:e}");
                    }
                    (end, other) => assert_eq!(end, other, "a = {a}"),
                }
                assert_eq!(steps, other_steps);
            }
        }
    }
}

#[test]
fn a_reversed_ray_returns_to_its_start() {
    // Reversed in time the hole spins the other way and its chart is the other one: r and N are the same in both, but for
    // a turn about the axis that depends on the radius alone. So rays start on the spheroid on which they end.
    for method in [by_series as Method, by_hamiltonian] {
        for [a, e] in HOLES {
            let (hole, reversed) = (UnitHole::new(a, e), UnitHole::new(-a, e));
            let mut random = Random::new(3);
            let mut returned = 0;
            for _ in 0..60 {
                let r = random.log_between(3.0, 100.0);
                let photon = random_ray(&mut random, &hole, [r, r * (1.0 + 1e-9)]);
                let launch = KerrLaunch::with_momentum(&hole, photon.x, photon.p);
                let (start, r) = (launch.state, 1.0 / launch.state.u);
                let inwards = start.v > 0.0 && launch.constants.fate(start.u, start.v) == Fate::Escapes;
                let (PhotonEnd::Crosses(end), _) = method(&hole, &photon, 1e-11, r) else { continue };
                if !inwards {
                    continue;
                }
                let end = KerrLaunch::with_momentum(&hole, end.x, end.p).state;
                let back = MinoState { v: -end.v, m: -end.m, ..end };
                let constants = Constants { l: -launch.constants.l, ..launch.constants };
                let photon = back.photon(&reversed, &constants);
                let (PhotonEnd::Crosses(home), _) = method(&reversed, &photon, 1e-11, r) else {
                    panic!("a = {a}: it does not come back")
                };
                let home = KerrLaunch::with_momentum(&reversed, home.x, home.p).state;
                let off = home.n.distance(start.n) + (home.m + start.m).length() / start.m.length();
                assert!(off < 1e-8, "a = {a}, e = {e}, r = {r}: off by {off:e}");
                returned += 1;
            }
            assert!(returned > 10, "{returned}");
        }
    }
}

#[test]
fn constraints_hold_along_every_ray() {
    for [a, e] in HOLES {
        let hole = UnitHole::new(a, e);
        let mut random = Random::new(4);
        for _ in 0..100 {
            let photon = random_ray(&mut random, &hole, [2.5, 200.0]);
            let launch = KerrLaunch::with_momentum(&hole, photon.x, photon.p);
            let Constants { j2, .. } = launch.constants;
            let check = |state: MinoState| {
                let MinoState { u, v, n, m } = state;
                let rate = launch.constants.rate_squared(u);
                let scale = 1.0 + j2.abs() * u * u;
                assert!((v * v - rate).abs() < 1e-9 * scale, "a = {a}: U − v² = {:e}", rate - v * v);
                assert!((n.length() - 1.0).abs() < 1e-9, "{}", n.length());
                let size = 1.0 + m.length();
                assert!(n.dot(m).abs() < 1e-8 * size, "{}", n.dot(m));
                let excess = m.length_squared() - j2 - a * a * n.z * n.z;
                assert!(excess.abs() < 1e-8 * size * size, "a = {a}: {excess:e}");
            };
            follow(&hole, &launch, 1e-10, 1e-3, |h, at| {
                (0..=4).for_each(|part| check(at(h * f64::from(part) / 4.0)));
            });
        }
    }
}

#[test]
fn momentum_and_velocity_in_the_chart_are_those_of_the_state() {
    for [a, e] in HOLES {
        let hole = UnitHole::new(a, e);
        let mut random = Random::new(5);
        for _ in 0..200 {
            let photon = random_ray(&mut random, &hole, [2.2, 1000.0]);
            let KerrLaunch { constants, state } = KerrLaunch::with_momentum(&hole, photon.x, photon.p);
            // From the state and back.
            let again = state.photon(&hole, &constants);
            let size = photon.p.length();
            assert!(again.x.distance(photon.x) < 1e-14 * photon.x.length());
            assert!(again.p.distance(photon.p) < 1e-12 * size, "a = {a}: {} for {}", again.p, photon.p);
            // Null: g^{μν} p_μ p_ν = −1 + p² − F (1 + N·p)².
            let (r, n) = hole.spheroidal(photon.x);
            let f = hole.potential(r, n.z);
            let w = 1.0 + n.dot(again.p);
            let null = again.p.length_squared() - 1.0 - f * w * w;
            assert!(null.abs() < 1e-12 * size * size, "a = {a}: {null:e}");
            // dX/dτ = p − F w N; the state's is in λ, times u².
            let sigma = r * r + a * a * n.z * n.z;
            let velocity = state.motion(&hole, &constants)[0] * (r * r / sigma);
            let exact = again.p - f * w * n;
            assert!(velocity.distance(exact) < 1e-11 * size, "a = {a}: {velocity} for {exact}");
        }
    }
}

#[test]
fn directions_at_rest_and_their_rays_are_those_of_the_table() {
    let (mut local, mut arrived) = (0, 0);
    for row in table("kerr_frames.csv") {
        let name = format!("row {} ({})", row.text("id"), row.text("kind"));
        let a = row.number("a");
        let hole = UnitHole::new(a, 0.0);
        // Traced into the past, the hole of a scene spins the other way.
        let scene_hole = KerrNewman::new(2.0, -a, 0.0);
        let placement = Placement { axis: DVec3::new(0.6, 0.0, 0.8), ..Placement::default() };
        let to_world = placement.rotation().transpose();
        let frame = SpacetimeKind::Spinning { placement, hole: scene_hole }.rest_frame();
        let at_rest = |x: DVec3, launch: &KerrLaunch| {
            let [velocity, _] = launch.state.motion(&hole, &launch.constants);
            placement.rotation() * frame.direction(to_world * x, to_world * velocity)
        };
        let (x, energy) = (row.vector(["x0", "y0", "z0"]), -row.number("pt0"));
        let p = row.vector(["px0", "py0", "pz0"]);
        if row.text("frame0") == "static" {
            let d = row.vector(["dx0", "dy0", "dz0"]).normalize();
            let launch = KerrLaunch::at_rest(&hole, x, d);
            let found = launch.state.photon(&hole, &launch.constants);
            assert!((found.p - p / energy).length() < 1e-13 * found.p.length(), "{name}: {}", found.p);
            let seen = at_rest(x, &launch);
            assert!(seen.distance(d) < 1e-13 * found.p.length(), "{name}: {seen} for {d}");
            local += 1;
        }
        if row.text("kind") != "pair" {
            continue;
        }
        let photon = KerrPhoton::new(&hole, x, p).expect("energy 1");
        let (end, _) = by_series(&hole, &photon, 1e-10, row.number("r_out"));
        let PhotonEnd::Crosses(end) = end else {
            assert!(end == PhotonEnd::Falls && row.text("status") == "captured", "{name}: {end:?}");
            continue;
        };
        let allowed = 1.1e-10 * row.number("sens");
        let off = end.x.distance(row.vector(["x1", "y1", "z1"])) / row.number("r_out");
        let off = off.max((end.p - row.vector(["px1", "py1", "pz1"]) / energy).length());
        assert!(off < allowed, "{name}: {off:e}, allowed {allowed:e}");
        if row.text("frame1") == "static" {
            let seen = at_rest(end.x, &KerrLaunch::with_momentum(&hole, end.x, end.p));
            let off = seen.distance(row.vector(["dx1", "dy1", "dz1"]));
            assert!(off < 4.0 * allowed, "{name}: {off:e}, allowed {allowed:e}");
            arrived += 1;
        }
    }
    assert!(local > 20 && arrived > 10, "{local} {arrived}");
}

#[test]
fn a_ray_from_very_far_past_nothing_is_straight() {
    for [a, e] in HOLES {
        let hole = UnitHole::new(a, e);
        let x = DVec3::new(-1e12, 4e11, 3e11);
        let photon = KerrPhoton::new(&hole, x, DVec3::new(0.3, 1.0, -0.2)).unwrap();
        let (end, steps) = by_series(&hole, &photon, 1e-5, 3e12);
        let PhotonEnd::Crosses(end) = end else { panic!("{end:?}") };
        // Bent by no more than 4M/b.
        let turned = end.p.normalize().distance(photon.p.normalize());
        assert!(turned < 1e-11 && steps <= 2, "{turned:e}, {steps} steps");
    }
}
