//! Rays through wormholes against the exact end states of `ellis_gluing.csv`, `ellis_wormhole_rays.csv` and
//! `dneg_wormhole_rays.csv`, and what their two sides owe each other.

use std::convert::Infallible;
use std::f64::consts::PI;

use crate::support::lit::disk;
use crate::support::{
    Random, Row, camera, far, interstellar, material, scene, sphere, table, vector, wormhole,
};
use glam::{DMat3, DQuat, DVec3};
use warpfront::geometry::PrimitiveId;
use warpfront::light::{Aim, Lensed};
use warpfront::scene::Baked;
use warpfront::spacetime::{ConformallyFlat, Ellis, Interstellar, Mouths, Side};
use warpfront::trace::transport::{Landing, Outcome};
use warpfront::trace::{Ray, shoot};

/// A place and a direction on a side.
#[derive(Clone, Copy, Debug)]
struct State {
    side: Side,
    position: DVec3,
    direction: DVec3,
}

/// A row of a table.
struct Case {
    name: String,
    /// `[spacetime]`, without the far centre.
    spacetime: String,
    /// Isotropic radius of the throat.
    throat: f64,
    /// Length that arcs are held to.
    scale: f64,
    centers: [DVec3; 2],
    start: State,
    end: State,
    r_out: f64,
    sens: f64,
}

/// A state of the chart whose origin is the throat's centre, where the far side is within the throat.
fn from_one_chart(throat: f64, position: DVec3, direction: DVec3) -> State {
    if position.length() >= throat {
        return State { side: Side::Near, position, direction };
    }
    let radial = position.normalize();
    State {
        side: Side::Far,
        position: -(throat * throat) * position / position.length_squared(),
        direction: 2.0 * radial.dot(direction) * radial - direction,
    }
}

impl Case {
    fn gluing(row: &Row) -> Self {
        let side = if row.number("side") > 0.0 { Side::Near } else { Side::Far };
        let position = row.vector(["x0", "y0", "z0"]);
        let direction = row.vector(["dx0", "dy0", "dz0"]).normalize();
        Self {
            name: format!("row {} ({})", row.text("id"), row.text("kind")),
            spacetime: wormhole(row.vector(["cnx", "cny", "cnz"]), row.number("b0"), ""),
            throat: 0.5 * row.number("b0"),
            scale: row.number("b0"),
            centers: [row.vector(["cnx", "cny", "cnz"]), row.vector(["cfx", "cfy", "cfz"])],
            start: State { side: Side::Near, position, direction },
            end: State {
                side,
                position: row.vector(["x1", "y1", "z1"]),
                direction: row.vector(["dx1", "dy1", "dz1"]),
            },
            r_out: row.number("r_out"),
            sens: row.number("sens"),
        }
    }

    fn one_chart(row: &Row) -> Self {
        let (b0, l) = (row.number("b0"), row.number("L"));
        let state = |x, d| from_one_chart(0.5 * b0, row.vector(x), row.vector(d).normalize());
        Self {
            name: format!("row {} ({})", row.text("id"), row.text("kind")),
            spacetime: wormhole(DVec3::ZERO, b0, ""),
            throat: 0.5 * b0,
            scale: b0,
            centers: [DVec3::ZERO; 2],
            start: state(["x0", "y0", "z0"], ["dx0", "dy0", "dz0"]),
            end: state(["x1", "y1", "z1"], ["dx1", "dy1", "dz1"]),
            r_out: 0.5 * (l + (l * l + b0 * b0).sqrt()),
            sens: row.number("sens"),
        }
    }

    fn interstellar(row: &Row) -> Self {
        let lengths = [row.number("rho"), 2.0 * row.number("a"), row.number("W")];
        let hole = Interstellar::new(lengths[0], lengths[1], lengths[2]);
        let throat = hole.throat();
        let state = |l: f64, n, d| {
            let rho = hole.isotropic_radius(l.abs());
            let position = if l < 0.0 { throat * throat / rho } else { rho } * row.vector(n).normalize();
            from_one_chart(throat, position, row.vector(d).normalize())
        };
        Self {
            name: format!("row {} ({})", row.text("id"), row.text("kind")),
            spacetime: interstellar(DVec3::ZERO, lengths, ""),
            throat,
            scale: lengths[0].min(lengths[2]),
            centers: [DVec3::ZERO; 2],
            start: state(row.number("l0"), ["nx0", "ny0", "nz0"], ["dx0", "dy0", "dz0"]),
            end: state(row.number("side") * row.number("L"), ["nx1", "ny1", "nz1"], ["dx1", "dy1", "dz1"]),
            r_out: hole.isotropic_radius(row.number("L")),
            sens: row.number("sens"),
        }
    }

    fn all() -> Vec<Self> {
        let gluing = table("ellis_gluing.csv");
        let one_chart = table("ellis_wormhole_rays.csv");
        let three = table("dneg_wormhole_rays.csv");
        let ellis = gluing.iter().map(Self::gluing).chain(one_chart.iter().map(Self::one_chart));
        ellis.chain(three.iter().map(Self::interstellar)).collect()
    }

    fn scene(&self, tolerance: f64, stepper: &str) -> Baked {
        let [near, beyond] = self.centers;
        let text = self.spacetime.clone()
            + &format!("far_center = {}\n", vector(beyond))
            + &format!(
                "[render]\nstepper = \"{stepper}\"\ntolerance = {tolerance:?}\narc_tolerance = {:?}\n",
                1e-3 * self.scale
            )
            + &material("black", 0.0, 0.0)
            + &sphere(near, self.r_out, "black")
            + &far(&sphere(beyond, self.r_out, "black"));
        scene(&text)
    }
}

fn ray(State { side, position, direction }: State) -> Ray {
    Ray { position, direction, origin_prim: PrimitiveId::none_on(side) }
}

fn end(scene: &Baked, ray: Ray) -> Outcome<Infallible> {
    shoot(scene, &[ray])[0].end
}

/// Follows a ray to a sphere from inside, going through it on the way in.
fn to_the_sphere(scene: &Baked, case: &Case) -> Landing {
    let first = end(scene, ray(case.start));
    let center = case.centers[usize::from(case.start.side == Side::Far)];
    let Outcome::Landed(landing) = first else { panic!("{}: {first:?}", case.name) };
    if case.start.position.distance(center) <= case.r_out {
        return landing;
    }
    let Landing { position, direction, primitive: origin_prim, .. } = landing;
    let second = end(scene, Ray { position, direction, origin_prim });
    let Outcome::Landed(landing) = second else { panic!("{}: {second:?}", case.name) };
    landing
}

fn check(tolerance: f64, stepper: &str) {
    let (mut faults, mut worst) = (Vec::new(), 0.0f64);
    let cases = Case::all();
    assert_eq!(cases.len(), 196 + table("dneg_wormhole_rays.csv").len());
    for case in &cases {
        let Case { name, end, sens, r_out, .. } = case;
        let Landing { position, direction, primitive, .. } =
            to_the_sphere(&case.scene(tolerance, stepper), case);
        if primitive.side() != end.side {
            faults.push(format!("{name}: on the {:?} side, not {:?}", primitive.side(), end.side));
            continue;
        }
        let far_away = case.centers.map(DVec3::length).into_iter().fold(0.0, f64::max);
        let rounding = 1e-15 * (1.0 + far_away / case.throat);
        let angle = (tolerance + rounding) * sens;
        let distance = angle * r_out + 1e-14 * (r_out + far_away);
        let off = (position - end.position).reject_from_normalized(end.direction).length();
        let turned = direction.distance(end.direction);
        let share = (off / distance).max(turned / angle);
        worst = worst.max(share);
        if share > 1.0 {
            faults.push(format!("{name}: off by {off:e} of {distance:e}, turned by {turned:e} of {angle:e}"));
        }
    }
    println!("{stepper} at {tolerance:e}: worst {worst:.3} of what is allowed");
    assert!(faults.is_empty(), "{} rows:\n{}", faults.len(), faults.join("\n"));
}

#[test]
fn every_ray_of_the_tables_comes_out_on_its_side_where_it_should() {
    check(1e-5, "rkn6");
    check(1e-8, "rkn6");
    check(1e-8, "dop853");
    check(1e-10, "dop853");
}

/// A wormhole between two empty worlds, rotated.
fn empty(rotation: &str) -> Baked {
    let place = format!("far_center = [4, -1, 2]\n{rotation}");
    let text = wormhole(DVec3::new(1.0, 2.0, 3.0), 1.5, &place)
        + "[environment]\ncolor = 1\n[environment.far]\ncolor = 2\n"
        + "[camera]\nposition = [9, 9, 9]\nlook_at = [0, 0, 0]\nvertical_fov = 40\n"
        + "[render]\nstepper = \"dop853\"\ntolerance = 1e-11\narc_tolerance = 1e-3\n";
    scene(&text)
}

#[test]
fn a_ray_straight_through_keeps_its_direction_but_for_the_rotation_of_the_far_world() {
    let axis = DVec3::new(2.0, -1.0, 0.5).normalize();
    let rotated = "far_rotate = { axis = [2, -1, 0.5], angle = 70 }\n";
    let q = DMat3::from_quat(DQuat::from_axis_angle(axis, 70f64.to_radians()));
    for (place, q) in [("", DMat3::IDENTITY), (rotated, q)] {
        let scene = empty(place);
        let mut random = Random::new(1);
        for _ in 0..50 {
            let direction = random.direction();
            let through = |side, center: DVec3, direction: DVec3| {
                end(&scene, ray(State { side, position: center - 7.0 * direction, direction }))
            };
            let there = through(Side::Near, DVec3::new(1.0, 2.0, 3.0), direction);
            let Outcome::Escaped(there) = there else { panic!("{there:?}") };
            assert!(there.side == Side::Far && there.direction.distance(q * direction) < 1e-9, "{there:?}");
            let back = through(Side::Far, DVec3::new(4.0, -1.0, 2.0), q * direction);
            let Outcome::Escaped(back) = back else { panic!("{back:?}") };
            assert!(back.side == Side::Near && back.direction.distance(direction) < 1e-9, "{back:?}");
        }
    }
}

#[test]
fn the_far_world_is_turned_by_half_a_turn_and_never_mirrored() {
    // Two neighbours of a ray along -z through the middle: one beside it, one above it.
    let half_turn = "far_rotate = { axis = [0, 0, 1], angle = 180 }\n";
    for (place, way) in [("", -1.0), (half_turn, 1.0)] {
        let scene = empty(place);
        let beyond = |offset: DVec3| {
            let position = DVec3::new(1.0, 2.0, 3.0) + 8.0 * DVec3::Z + offset;
            let end = end(&scene, ray(State { side: Side::Near, position, direction: DVec3::NEG_Z }));
            let Outcome::Escaped(there) = end else { panic!("{end:?}") };
            assert_eq!(there.side, Side::Far);
            there.direction
        };
        let (right, up) = (beyond(0.1 * DVec3::X), beyond(0.1 * DVec3::Y));
        assert!(way * right.x > 0.01 && right.y.abs() < 1e-9, "{right:?}");
        assert!(way * up.y > 0.01 && up.x.abs() < 1e-9, "{up:?}");
    }
}

#[test]
fn a_throat_of_next_to_nothing_leaves_flat_space() {
    let small = interstellar(DVec3::ZERO, [1e-9, 1e-9, 1e-10], "");
    for (spacetime, bent) in [(wormhole(DVec3::ZERO, 1e-9, ""), 1e-12), (small, 1e-8)] {
        let text = spacetime
            + "[environment]\ncolor = 1\n[camera]\nposition = [0, 0, 9]\nlook_at = [0, 0, 0]\nvertical_fov = 40\n";
        let scene = scene(&text);
        let mut random = Random::new(2);
        for _ in 0..1000 {
            let (position, direction) = (10.0 * random.in_cube(), random.direction());
            let end = end(&scene, ray(State { side: Side::Near, position, direction }));
            let Outcome::Escaped(there) = end else { panic!("{end:?}") };
            assert!(there.side == Side::Near && there.direction.distance(direction) < bent, "{there:?}");
        }
    }
}

#[test]
fn rays_come_back_to_where_they_started() {
    let place = "far_center = [3, 1, 0]\nfar_rotate = [20, 130, -40]\n";
    for spacetime in [wormhole(DVec3::ZERO, 1.0, place), interstellar(DVec3::ZERO, [0.6, 0.5, 0.3], place)] {
        let text = spacetime
            + "[render]\nstepper = \"dop853\"\ntolerance = 1e-11\narc_tolerance = 1e-3\n"
            + &material("black", 0.0, 0.0)
            + &sphere(DVec3::ZERO, 6.0, "black")
            + &far(&sphere(DVec3::new(3.0, 1.0, 0.0), 5.0, "black"));
        come_back(&scene(&text));
    }
}

/// Rays from close to the sphere around the near mouth land where rays back come from.
fn come_back(scene: &Baked) {
    let (mut random, mut passed) = (Random::new(3), 0);
    for _ in 0..2000 {
        let position = 5.9 * random.direction();
        let aim = 1.6 * random.direction() - position;
        let start = State { side: Side::Near, position, direction: aim.normalize() };
        let Outcome::Landed(there) = end(scene, ray(start)) else { panic!("a closed room") };
        passed += u32::from(there.primitive.side() == Side::Far);
        let back =
            Ray { position: there.position, direction: -there.direction, origin_prim: there.primitive };
        let Outcome::Landed(back) = end(scene, back) else { panic!("a closed room") };
        assert_eq!(back.primitive.side(), Side::Near);
        // The way back passes the start and goes on to the sphere around it, 0.1 behind.
        let from_start = back.position - position;
        let beside = from_start.reject_from_normalized(start.direction).length();
        assert!(beside < 1e-3 && from_start.dot(start.direction) < 0.0, "{start:?}: {back:?}");
    }
    assert!((100..1700).contains(&passed), "{passed}");
}

#[test]
fn no_ray_is_lost_and_constants_of_motion_tell_on_which_side_it_ends() {
    let place = "far_center = [1, 1, 1]\n";
    none_is_lost(&wormhole(DVec3::ZERO, 2.0, place), &Ellis::new(2.0));
    let lengths = [1.0, 3.0, 0.3];
    none_is_lost(&interstellar(DVec3::ZERO, lengths, place), &Interstellar::new(1.0, 3.0, 0.3));
}

fn none_is_lost(spacetime: &str, medium: &impl ConformallyFlat) {
    for (tolerance, precision) in [("1e-5", "f64"), ("1e-3", "f64"), ("1e-5", "f32")] {
        let text = spacetime.to_owned()
            + &format!("[render]\ntolerance = {tolerance}\nprecision = \"{precision}\"\n")
            + "[environment]\ncolor = 1\n[camera]\nposition = [0, 0, 9]\nlook_at = [0, 0, 0]\nvertical_fov = 40\n";
        let scene = scene(&text);
        let mut random = Random::new(4);
        let states: Vec<State> = (0..100_000)
            .map(|i| {
                let rho = medium.throat() * (1.0 + random.log_between(1e-6, 1e3));
                let radial = random.direction();
                let side = if i % 2 == 0 { Side::Near } else { Side::Far };
                let center = if side == Side::Near { DVec3::ZERO } else { DVec3::ONE };
                State { side, position: center + rho * radial, direction: random.direction() }
            })
            .collect();
        let rays: Vec<Ray> = states.iter().map(|state| ray(*state)).collect();
        let mut lost = 0;
        for (state, shot) in states.iter().zip(shoot(&scene, &rays)) {
            let x = state.position - if state.side == Side::Near { DVec3::ZERO } else { DVec3::ONE };
            let rho = x.length();
            let (b, critical) = (
                medium.index(1.0 / rho) * x.cross(state.direction).length(),
                medium.critical_impact_parameter(),
            );
            let passes = b < critical && x.dot(state.direction) < 0.0;
            let is_clear = (b - critical).abs() > 1e-4;
            let Outcome::Escaped(there) = shot.end else {
                // A ray nearly across a cylinder winds in it for thousands of radians.
                assert!(medium.mouth() > 0.0 && !is_clear, "{state:?}: {shot:?}");
                lost += 1;
                continue;
            };
            assert!(!is_clear || (there.side != state.side) == passes, "{state:?} with b = {b}: {there:?}");
        }
        assert!(lost < 500, "{lost}");
    }
}

#[test]
fn a_half_turn_of_the_far_world_about_the_line_of_sight_shows_it_upright() {
    // Places seen from the near side, at the same angle above the axis on both sides of the throat.
    let text = wormhole(DVec3::ZERO, 1.0, "far_rotate = { axis = [0, 0, 1], angle = 180 }\n")
        + &material("black", 0.0, 0.0)
        + &far(&sphere(DVec3::ZERO, 4.0, "black"));
    let scene = scene(&text);
    for angle in [0.02, 0.05, 0.08] {
        let direction = DVec3::new(0.0, f64::sin(angle), -f64::cos(angle));
        let start = State { side: Side::Near, position: DVec3::new(0.0, 0.0, 5.0), direction };
        let Outcome::Landed(there) = end(&scene, ray(start)) else { panic!("the sphere beyond") };
        assert!(there.position.y > 0.0 && there.position.x.abs() < 1e-9, "{there:?}");
        assert!(there.position.y.atan2(-there.position.z) < PI, "{there:?}");
    }
}

#[test]
fn the_aim_joins_places_on_either_side_by_rays_that_arrive() {
    check_aim(Ellis::new(1.3), |near, place| wormhole(near, 1.3, place));
    for [radius, length, width] in [[0.8, 0.9, 0.3], [0.8, 0.0, 2.0]] {
        let medium = Interstellar::new(radius, length, width);
        check_aim(medium, |near, place| interstellar(near, [radius, length, width], place));
    }
}

fn check_aim(medium: impl ConformallyFlat, spacetime: impl Fn(DVec3, &str) -> String) {
    let mut random = Random::new(5);
    let (near, beyond) = (DVec3::new(0.5, -1.0, 2.0), DVec3::new(9.0, 3.0, -4.0));
    let rotation = DMat3::from_quat(DQuat::from_axis_angle(DVec3::new(0.6, 0.0, 0.8), 2.1));
    let mouths = Mouths { near, far: beyond, rotation };
    let aim = Lensed::through(medium, mouths, 2).unwrap();
    let place = format!(
        "far_center = {}\nfar_rotate = {{ axis = [0.6, 0, 0.8], angle = {:?} }}\n",
        vector(beyond),
        2.1f64.to_degrees()
    );
    let mut count = 0;
    for number in 0..60 {
        let [from, to] = [number % 2, number / 2 % 2].map(|i| if i == 0 { Side::Near } else { Side::Far });
        let mut somewhere =
            |side| mouths.center(side) + random.log_between(1.2 * medium.throat(), 12.0) * random.direction();
        let (x, y) = (somewhere(from), somewhere(to));
        let (at_x, at_y) = (aim.place(from, x), aim.place(to, y));
        for winding in 0..3 {
            let Some(link) = aim.link(&at_x, &at_y, winding) else { continue };
            let size = 1e-2 * y.distance(mouths.center(to));
            let target = disk(y, link.arrival, 0.0, size, "black");
            let text = spacetime(near, &place)
                + "[render]\nstepper = \"dop853\"\ntolerance = 1e-11\narc_tolerance = 1e-4\n"
                + &camera(near + 20.0 * DVec3::Z, near, 40.0)
                + &material("black", 0.0, 0.0)
                + &if to == Side::Far { far(&target) } else { target };
            let scene = scene(&text);
            let arrival = |direction: DVec3| {
                let start = State { side: from, position: x, direction: direction.normalize() };
                let Outcome::Landed(landing) = end(&scene, ray(start)) else {
                    panic!("{number}, winding number {winding}: {link:?} from {x} to {y}")
                };
                landing
            };
            let what = format!("{number}, winding number {winding}");
            let middle = arrival(link.direction);
            assert!(middle.position.distance(y) < 0.5 * size, "{what}: {middle:?} is not {y}");
            assert!(middle.direction.distance(link.arrival) < 1e-3, "{what}: {middle:?}, {link:?}");
            let (u, v) = link.direction.any_orthonormal_pair();
            let step = 1e-4 * link.geometry_factor.sqrt() * size;
            let across = |w: DVec3| {
                arrival(link.direction + step * w).position - arrival(link.direction - step * w).position
            };
            let area = across(u).cross(across(v)).length();
            let ratio = link.geometry_factor * area / (4.0 * step * step);
            assert!((ratio - 1.0).abs() < 5e-3, "{what}: geometry factor off by {ratio}");
            let (found, factor) = aim.classify(&at_x, link.direction, &at_y, link.arrival).unwrap();
            assert!(
                found == winding && (factor / link.geometry_factor - 1.0).abs() < 1e-2,
                "{what}: {factor}"
            );
            count += 1;
        }
    }
    assert!(count > 150, "{count}");
}
