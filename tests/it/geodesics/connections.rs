//! Rays between points, at random: that they are there, that they join the points, and that they agree with each other.

use crate::support::Random;
use crate::support::orbits::start;
use glam::DVec3;
use warpfront::geodesic::{Connection, Control, Dop853, Launch, Lens, Phase, Site, Step, Stepper};
use warpfront::spacetime::{ConformallyFlat, Schwarzschild};

/// Isotropic radius of the horizon of a hole of radius 1.
const HORIZON: f64 = 0.25;
/// Highest winding order that is looked at.
const WINDINGS: u32 = 3;

/// A hole of radius 1 and its lens.
struct World {
    hole: Schwarzschild,
    lens: Lens,
}

impl World {
    fn new(tolerance: f64) -> Self {
        let hole = Schwarzschild::new(1.0);
        Self { hole, lens: Lens::new(&hole, tolerance).unwrap() }
    }

    fn site(&self, x: DVec3) -> Site {
        self.lens.site(&self.hole, x)
    }

    fn connect(&self, x: DVec3, y: DVec3, winding: u32) -> Connection {
        let found = self.lens.connect(&self.site(x), &self.site(y), winding);
        found.unwrap_or_else(|| panic!("no ray of winding {winding} from {x} to {y}"))
    }

    fn index_squared(&self, x: DVec3) -> f64 {
        self.hole.index_squared(1.0 / x.length())
    }
}

/// Two points: any, beside a line through the hole, at one radius, inside the photon sphere, on both sides of it.
fn pair(random: &mut Random, kind: usize) -> (DVec3, DVec3) {
    let sphere = Schwarzschild::new(1.0).photon_sphere();
    let (low, high) = (1.0001 * HORIZON, 1e6);
    let (inside, outside) = ((low, sphere), (sphere, 100.0));
    let mut at = |(low, high): (f64, f64)| random.log_between(low, high);
    let (r, s) = match kind {
        0 | 1 | 5 => (at((low, high)), at((low, high))),
        2 => [at((low, high)); 2].into(),
        3 => (at(inside), at(inside)),
        _ => (at(inside), at(outside)),
    };
    let (u, v) = (random.direction(), random.direction());
    let v = match kind {
        1 => (u + 1e-9 * v).normalize(),
        5 => (1e-9 * v - u).normalize(),
        _ => v,
    };
    if random.between(0.0, 1.0) < 0.5 { (r * u, s * v) } else { (s * v, r * u) }
}
const KINDS: usize = 6;

/// How much closer the points are than the hole: by that much rounding weighs more.
fn closeness(x: DVec3, y: DVec3) -> f64 {
    x.length().max(y.length()) / x.distance(y)
}

/// What an error of an angle is multiplied by in the solid angle.
fn amplification(ray: &Connection) -> f64 {
    ray.swing[0].max(ray.swing[1]).max(1.0) * (1.0 + 1.0 / ray.swept.sin().abs())
}

fn relative(a: f64, b: f64) -> f64 {
    (a - b).abs() / b.abs()
}

/// Where a ray that leaves `x` in a `direction` has swept an angle: by steps.
fn march(hole: &Schwarzschild, x: DVec3, direction: DVec3, swept: f64) -> Option<DVec3> {
    let launch = Launch::new(hole, x, direction, f64::EPSILON);
    let (b, mut phase, _): (f64, Phase<f64>, _) = start(hole, &launch);
    let control = Control::new(hole, 1e-12, f64::INFINITY);
    let mut h = control.first_step(hole, Dop853::ESTIMATE.order, b, &phase);
    let (mut left, mut previous) = (swept, 1.0);
    for _ in 0..2000 {
        let step = Step::new(hole, &Dop853, b, phase, h);
        let verdict = control.judge::<Dop853>(&step, 0.0, previous);
        if !verdict.accepted {
            h = verdict.next_h;
            continue;
        }
        let angle = (b * h).atan();
        if angle >= left {
            let w = Step::new(hole, &Dop853, b, phase, left.tan() / b).end.w;
            return Some(launch.position(w, swept));
        }
        (left, phase) = (left - angle, step.end);
        (h, previous) = (control.within(verdict.next_h, b, &phase), verdict.error);
    }
    None
}

#[test]
fn there_is_one_ray_of_every_winding_and_it_is_the_same_both_ways() {
    let world = World::new(1e-15);
    let mut random = Random::new(1);
    let mut worst = [0.0_f64; 4];
    for i in 0..100_000 {
        let (x, y) = pair(&mut random, i % KINDS);
        let (at_x, at_y) = (world.site(x), world.site(y));
        let angle = x.cross(y).length().atan2(x.dot(y));
        for winding in 0..WINDINGS {
            let ray = world.connect(x, y, winding);
            let name = || format!("{x} to {y}, winding {winding}: {ray:?}");
            let turns = std::f64::consts::PI * f64::from(winding + winding % 2);
            let swept = if winding % 2 == 1 { turns - angle } else { turns + angle };
            assert!((ray.swept - swept).abs() < 1e-14 * (1.0 + swept), "{}", name());
            assert!(ray.direction.is_normalized() && ray.arrival.is_normalized(), "{}", name());
            let numbers = [ray.b, ray.geometry_factor, ray.swing[0], ray.swing[1]];
            assert!(numbers.iter().all(|&number| number.is_finite() && number > 0.0), "{}", name());
            // It lies in the plane of the points, and b is that of both directions.
            let spin = [(x, ray.direction), (y, ray.arrival)]
                .map(|(x, d)| x.cross(d).length() * world.index_squared(x).sqrt());
            // Rounding of a direction counts by n ρ.
            let size = [x, y].map(|x| x.length() * world.index_squared(x).sqrt());
            assert!((spin[0] - ray.b).abs() < 1e-14 * (size[0] + ray.b), "{}", name());
            assert!((spin[1] - ray.b).abs() < 1e-14 * (size[1] + ray.b), "{}", name());

            // Of all kinds, but not of all pairs: this takes longer.
            if !(i / KINDS).is_multiple_of(4) {
                continue;
            }
            let back = world.connect(y, x, winding);
            let close = closeness(x, y);
            let turned = ray.direction.distance(-back.arrival).max(ray.arrival.distance(-back.direction));
            let time = world.lens.time(&at_x, &at_y, &ray);
            assert!(time > 0.999 * (x.length() - y.length()).abs(), "{}: {time}", name());
            let late = relative(world.lens.time(&at_y, &at_x, &back), time);
            // Reciprocity: n_x² dΩ_x/dA_y = n_y² dΩ_y/dA_x.
            let [there, again] =
                [ray.geometry_factor * world.index_squared(x), back.geometry_factor * world.index_squared(y)];
            let reciprocity = relative(there, again) / amplification(&ray);
            let (found, spread) = world
                .lens
                .classify(&at_x, ray.direction, &at_y, ray.arrival)
                .unwrap_or_else(|| panic!("{}", name()));
            assert_eq!(found, winding, "{}", name());
            let known = relative(spread, ray.geometry_factor) / amplification(&ray);
            let errors = [turned / close, late / close, reciprocity / close, known / close];
            for (worst, error) in worst.iter_mut().zip(errors) {
                *worst = worst.max(error);
            }
            assert!(errors.iter().all(|&error| error < 1e-9), "{}: {errors:?}", name());
        }
    }
    println!(
        "both ways: direction {:.1e}, time {:.1e}, spread {:.1e}; by itself {:.1e}",
        worst[0], worst[1], worst[2], worst[3]
    );
}

#[test]
fn a_ray_that_is_marched_along_passes_the_other_point() {
    let world = World::new(1e-15);
    let mut random = Random::new(2);
    let (mut worst, mut count) = (0.0_f64, 0);
    for i in 0..2000 {
        let (x, y) = pair(&mut random, i % KINDS);
        for winding in 0..WINDINGS {
            let ray = world.connect(x, y, winding);
            // Angles of radial rays are no measure of length.
            if ray.swept < 1e-3 {
                continue;
            }
            count += 1;
            let end = march(&world.hole, x, ray.direction, ray.swept)
                .unwrap_or_else(|| panic!("{x} to {y}, winding {winding}: no end"));
            // How far it passes by, as seen from the hole: in its plane, and across.
            let cos = ray.arrival.dot(y.normalize()).abs();
            let sin = y.normalize().cross(ray.arrival).length();
            let miss = (end.length() / y.length()).ln().abs() * sin / (ray.swing[0] * cos).max(1.0);
            let aside = end.normalize().distance(y.normalize());
            worst = worst.max(miss).max(aside);
            assert!(miss.max(aside) < 1e-9, "{x} to {y}, winding {winding}: {miss:e} {aside:e}, {ray:?}");
        }
    }
    println!("{count} rays pass by their ends at {worst:.1e} of the sensitivity");
}

#[test]
fn a_coarse_lens_is_as_good_as_it_says() {
    let (fine, coarse) = (World::new(1e-15), World::new(1e-6));
    let mut random = Random::new(3);
    let mut worst = [0.0_f64; 2];
    for i in 0..20_000 {
        let (x, y) = pair(&mut random, i % KINDS);
        for winding in 0..WINDINGS {
            let (exact, found) = (fine.connect(x, y, winding), coarse.connect(x, y, winding));
            let turned = exact.direction.distance(found.direction);
            let spread = relative(found.geometry_factor, exact.geometry_factor) / amplification(&exact);
            assert!(
                turned < 1e-5 && spread < 1e-5,
                "{x} to {y}, winding {winding}: {turned:e} {spread:e}, {exact:?} {found:?}"
            );
            worst = [worst[0].max(turned), worst[1].max(spread)];
        }
    }
    println!("at 1e-6: direction {:.1e}, spread {:.1e} of its amplification", worst[0], worst[1]);
}

#[test]
fn far_from_the_hole_rays_are_straight() {
    let world = World::new(1e-15);
    let mut random = Random::new(4);
    for _ in 0..10_000 {
        let size = 1e12 * random.log_between(1.0, 100.0);
        let (x, y) = (size * random.direction(), size * random.direction());
        let distance = x.distance(y);
        // A ray past the hole is bent.
        if x.cross(y).length() < 0.1 * size * distance {
            continue;
        }
        let ray = world.connect(x, y, 0);
        let close = closeness(x, y);
        assert!(ray.direction.distance((y - x) / distance) < 1e-10 * close, "{x} {y} {ray:?}");
        assert!(ray.arrival.distance((y - x) / distance) < 1e-10 * close, "{x} {y} {ray:?}");
        assert!((ray.geometry_factor * distance * distance - 1.0).abs() < 1e-10 * close, "{x} {y} {ray:?}");
        let time = world.lens.time(&world.site(x), &world.site(y), &ray);
        assert!(relative(time, distance) < 1e-9 * close, "{x} {y} {time} {distance}");
    }
}

#[test]
fn points_that_are_close_are_joined_by_short_lines() {
    let world = World::new(1e-15);
    let mut random = Random::new(5);
    for _ in 0..10_000 {
        let (x, apart) = (random.log_between(0.3, 1e6) * random.direction(), random.log_between(1e-9, 1e-5));
        // Beside the photon sphere B hardly tells radii apart.
        if (x.length() - world.hole.photon_sphere()).abs() < 0.1 {
            continue;
        }
        let y = x + apart * x.length() * random.direction();
        let (ray, distance) = (world.connect(x, y, 0), x.distance(y));
        let allowed = 1e-13 / apart + 100.0 * apart;
        assert!(ray.direction.distance((y - x) / distance) < allowed, "{x} {y} {ray:?}");
        assert!((ray.geometry_factor * distance * distance - 1.0).abs() < allowed, "{x} {y} {ray:?}");
        let time = world.lens.time(&world.site(x), &world.site(y), &ray);
        let index = world.index_squared(0.5 * (x + y)).sqrt();
        assert!(relative(time, index * distance) < allowed, "{x} {y} {time}");
    }
}

#[test]
fn beams_are_as_wide_as_neighbouring_rays_are_apart() {
    /// Angle between the rays, radians.
    const APART: f64 = 1e-7;
    let world = World::new(1e-6);
    let x = 10.0 * DVec3::new(0.6, 0.0, 0.8);
    let (radial, across) = (x.normalize(), DVec3::new(-0.8, 0.0, 0.6));
    let out_of_plane = radial.cross(across);
    let critical = world.hole.critical_impact_parameter();
    let index = world.index_squared(x).sqrt();
    let (mut count, mut widest) = (0, 0.0_f64);
    for share in [0.5, 0.9, 0.999, 1.0005, 1.003, 1.02, 1.1, 1.5, 3.0] {
        let sin = share * critical / (x.length() * index);
        let towards = |angle: f64, out: f64| {
            let (sin, cos) = (sin.asin() + angle).sin_cos();
            (out.cos() * (sin * across - cos * radial) + out.sin() * out_of_plane).normalize()
        };
        let direction = towards(0.0, 0.0);
        for swept in [0.3, 1.0, 2.0, 2.8, 3.5, 4.4, 6.0, 7.5] {
            let at = |direction, swept: f64| {
                let end: DVec3 = march(&world.hole, x, direction, swept)?;
                let is_there = end.normalize().dot(x.normalize()) - swept.cos();
                (is_there.abs() < 1e-3 && (0.3..200.0).contains(&end.length())).then_some(end)
            };
            // Not by way of infinity.
            let Some(y) = (1..20).fold(at(direction, swept), |end, part| {
                at(direction, swept * f64::from(part) / 20.0).and(end)
            }) else {
                continue;
            };
            let [before, after] = [-1e-6, 1e-6].map(|angle| at(direction, swept + angle));
            let (Some(before), Some(after)) = (before, after) else { continue };
            let travel = (after - before).normalize();
            let width = |[one, other]: [DVec3; 2]| {
                let offset = at(one, swept)? - at(other, swept)?;
                Some((offset - offset.dot(travel) * travel).length() / APART)
            };
            let half = 0.5 * APART;
            let found = [
                width([towards(half, 0.0), towards(-half, 0.0)]),
                width([towards(0.0, half), towards(0.0, -half)]),
            ];
            let [Some(along), Some(out)] = found else { continue };
            let widths = world.lens.beam_widths(&world.site(x), direction, &world.site(y), travel);
            let [in_plane, beside] = widths.unwrap_or_else(|| panic!("{share} {swept}"));
            let name = format!("b {share}, swept {swept}: {in_plane} for {along}, {beside} for {out}");
            assert!(relative(in_plane, along) < 1e-3 && relative(beside, out) < 1e-3, "{name}");
            (count, widest) = (count + 1, widest.max(in_plane));
        }
    }
    // Also around the hole, where beams get far wider than they would without it.
    assert!(count > 40 && widest > 1e3, "{count} beams, up to {widest}");
}
