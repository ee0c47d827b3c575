//! Rays through the engine against the exact end states of `schwarzschild_rays.csv`.

use crate::support::{
    Row, camera, hole, material, mesh, orbit_steppers, rectangle, scene, scene_with, sphere, table,
};
use glam::DVec3;
use warpfront::geometry::PrimitiveId;
use warpfront::scene::Baked;
use warpfront::trace::transport::Outcome;
use warpfront::trace::{Ray, Shot, shoot};

/// A row of the table, in numbers.
struct Case {
    name: String,
    r_s: f64,
    start: DVec3,
    direction: DVec3,
    r_out: f64,
    captured: bool,
    /// Exact position and direction on the way out.
    exit: Option<(DVec3, DVec3)>,
    /// |d(final angle)/d(initial angle)|.
    sens: f64,
}

impl Case {
    fn new(row: &Row) -> Self {
        let captured = row.text("status") == "captured";
        let exit = || (row.vector(["x1", "y1", "z1"]), row.vector(["dx1", "dy1", "dz1"]));
        Self {
            name: format!("row {} ({})", row.text("id"), row.text("kind")),
            r_s: row.number("rs"),
            start: row.vector(["x0", "y0", "z0"]),
            direction: row.vector(["dx0", "dy0", "dz0"]).normalize(),
            r_out: row.number("r_out"),
            captured,
            exit: (!captured).then(exit),
            sens: row.maybe("sens").unwrap_or(1.0),
        }
    }

    fn all() -> Vec<Case> {
        table("schwarzschild_rays.csv").iter().map(Case::new).collect()
    }

    /// The size of the hole, or of what replaces it.
    fn unit(&self) -> f64 {
        if self.r_s > 0.0 { self.r_s } else { self.r_out }
    }
}

/// How accurately rays are followed, and from where.
#[derive(Clone, Copy)]
struct Setup<'a> {
    /// Largest error of a step's direction.
    tolerance: f64,
    /// Arc tolerance in units of the hole's size.
    arc: f64,
    /// Place of the hole in units of its size.
    center: DVec3,
    stepper: &'a str,
}

impl Setup<'_> {
    fn center(&self, case: &Case) -> DVec3 {
        self.center * case.unit()
    }

    fn arc_tolerance(&self, case: &Case) -> f64 {
        self.arc * case.unit()
    }

    /// A scene with a hole and one thing around it.
    fn scene(&self, case: &Case, entity: &str, files: &[(&str, &str)]) -> Baked {
        let Setup { tolerance, stepper, .. } = self;
        let render = format!(
            "[render]\nstepper = \"{stepper}\"\ntolerance = {tolerance:?}\narc_tolerance = {:?}\n",
            self.arc_tolerance(case)
        );
        let text = hole(self.center(case), case.r_s) + &render + &material("black", 0.0, 0.0) + entity;
        scene_with(&text, files)
    }

    /// Largest error of the ray, as one of the direction at its start: the tolerance, and rounding.
    fn angle(&self, case: &Case) -> f64 {
        let rounding = 1e-15 * (1.0 + self.center(case).length() / case.start.length().min(case.unit()));
        self.tolerance + rounding
    }

    /// Largest error that the end's direction may have.
    fn end_angle(&self, case: &Case) -> f64 {
        self.angle(case) * case.sens
    }

    /// Largest error of the end's position: the angle's at the distance it is seen from, and the rounding of places.
    fn end_distance(&self, case: &Case) -> f64 {
        self.end_angle(case) * case.r_out + 1e-14 * (case.r_out + self.center(case).length())
    }
}

/// Follows a ray to the sphere of radius `r_out` from inside, going through it on the way in.
fn to_the_sphere(scene: &Baked, case: &Case, center: DVec3) -> Shot {
    let start =
        Ray { position: case.start + center, direction: case.direction, origin_prim: PrimitiveId::NONE };
    let [first] = shoot(scene, &[start])[..] else { panic!("one shot") };
    let starts_outside = case.start.length() > case.r_out;
    match first.end {
        Outcome::Landed(inwards) if starts_outside => {
            let (position, direction) = (inwards.position, inwards.direction);
            shoot(scene, &[Ray { position, direction, origin_prim: inwards.primitive }])[0]
        }
        _ => first,
    }
}

/// What is wrong with an end, if anything; the errors relative to what is allowed go to `worst`.
fn fault(
    case: &Case,
    setup: &Setup,
    end: Outcome<std::convert::Infallible>,
    worst: &mut f64,
) -> Option<String> {
    let Case { name, .. } = case;
    match (end, case.exit) {
        (Outcome::Captured, None) => None,
        (Outcome::Landed(landing), Some((position, direction))) => {
            // Across the ray: along it, what is met decides, and a mesh has the rounding of its file.
            let off =
                (landing.position - setup.center(case) - position).reject_from_normalized(direction).length();
            let turned =
                landing.direction.angle_between(direction).min(landing.direction.distance(direction));
            let share = (off / setup.end_distance(case)).max(turned / setup.end_angle(case));
            *worst = worst.max(share);
            (share > 1.0).then(|| {
                format!(
                    "{name}: off by {off:e} (allowed {:e}), turned by {turned:e} (allowed {:e}), sens {:e}",
                    setup.end_distance(case),
                    setup.end_angle(case),
                    case.sens
                )
            })
        }
        (end, _) => Some(format!("{name}: captured is {}, but {end:?}", case.captured)),
    }
}

/// Checks all rows.
fn check(setup: &Setup, follow: impl Fn(&Case) -> Option<Shot>) {
    let (mut faults, mut worst) = (Vec::new(), 0.0);
    for case in Case::all() {
        let Some(shot) = follow(&case) else { continue };
        faults.extend(fault(&case, setup, shot.end, &mut worst));
    }
    println!("{} at {:e}: worst {worst:.3} of what is allowed", setup.stepper, setup.tolerance);
    assert!(faults.is_empty(), "{} rows:\n{}", faults.len(), faults.join("\n"));
}

fn check_spheres(setup: Setup) {
    check(&setup, |case| {
        let center = setup.center(case);
        let scene = setup.scene(case, &sphere(center, case.r_out, "black"), &[]);
        Some(to_the_sphere(&scene, case, center))
    });
}

fn check_quads(setup: Setup) {
    check(&setup, |case| {
        let (position, direction) = case.exit?;
        let half = 0.05 * case.r_out;
        let u = direction.any_orthonormal_vector();
        let quad = rectangle(DVec3::ZERO, half * u, half * direction.cross(u));
        let place = position + setup.center(case);
        let scene = setup.scene(case, &mesh("quad.obj", place, "black"), &[("quad.obj", &quad)]);
        let start = case.start + setup.center(case);
        Some(
            shoot(
                &scene,
                &[Ray { position: start, direction: case.direction, origin_prim: PrimitiveId::NONE }],
            )[0],
        )
    });
}

const DRAFT: Setup<'static> = Setup { tolerance: 1e-3, arc: 1e-2, center: DVec3::ZERO, stepper: "rkn6" };
const STANDARD: Setup<'static> = Setup { tolerance: 1e-5, arc: 1e-3, ..DRAFT };
const REFERENCE: Setup<'static> =
    Setup { tolerance: 1e-10, arc: 1e-4, center: DVec3::ZERO, stepper: "dop853" };
const ELSEWHERE: DVec3 = DVec3::new(3.0, -2.0, 5.0);

#[test]
fn every_ray_reaches_its_sphere_at_draft_quality() {
    check_spheres(DRAFT);
}

#[test]
fn every_ray_reaches_its_sphere_at_standard_quality() {
    check_spheres(STANDARD);
}

#[test]
fn every_ray_reaches_its_sphere_at_reference_quality() {
    check_spheres(REFERENCE);
}

#[test]
fn every_ray_reaches_its_sphere_with_every_stepper() {
    for stepper in &orbit_steppers() {
        check_spheres(Setup { stepper, tolerance: 1e-6, ..STANDARD });
    }
}

#[test]
fn every_ray_reaches_its_sphere_around_a_hole_elsewhere() {
    check_spheres(Setup { center: ELSEWHERE, ..REFERENCE });
}

#[test]
fn every_ray_that_comes_out_meets_a_quad_of_triangles_across_its_way() {
    check_quads(STANDARD);
}

#[test]
fn every_ray_that_comes_out_meets_a_quad_around_a_hole_elsewhere() {
    // The quad's own vertices are in 32 bits, which turns rays that end close to the hole.
    check_quads(Setup { center: ELSEWHERE, tolerance: 1e-9, ..REFERENCE });
}

/// Deflection of a ray of impact parameter `b` in units of r_s that comes from `distance`.
fn deflection(b: f64, distance: f64, tolerance: f64) -> f64 {
    // No geometry: nothing but a sky.
    let text = hole(DVec3::ZERO, 1.0)
        + &camera(DVec3::X, DVec3::ZERO, 40.0)
        + "[environment]\ncolor = [1, 1, 1]\n"
        + &format!("[render]\ntolerance = {tolerance:?}\narc_tolerance = 1.0\n");
    let u = 0.25 / distance;
    let index = (1.0 + u).powi(3) / (1.0 - u);
    let position = DVec3::new(-(distance * distance - b * b).sqrt(), b / index, 0.0);
    let [shot] =
        shoot(&scene(&text), &[Ray { position, direction: DVec3::X, origin_prim: PrimitiveId::NONE }])[..]
    else {
        panic!("one shot")
    };
    let Outcome::Escaped(end) = shot.end else { panic!("{shot:?} from {distance:e}") };
    (-end.direction.y).atan2(end.direction.x)
}

#[test]
fn rays_from_any_distance_bend_as_darwin_says() {
    let mut worst = 0.0f64;
    // Impact parameter over M = r_s/2 and deflection.
    for (b, exact) in [(6.0, 1.719388310230), (10.0, 0.590395787606), (20.0, 0.236135995388)] {
        for distance in [1e5, 1e6, 1e7, 1e8] {
            for tolerance in [1e-3, 1e-5, 1e-7] {
                let bent = deflection(0.5 * b, distance, tolerance);
                // |dα/d ln b| is at most b/(b − b_crit), with b_crit = 3√3 M; b is known to 1e-16 distance / b.
                let sensitivity = b / (b - 27.0_f64.sqrt());
                let share = (bent - exact).abs() / (tolerance * sensitivity);
                worst = worst.max(share);
                assert!(share < 1.0, "b = {b} M from {distance:e} at {tolerance:e}: {bent}, exactly {exact}");
            }
        }
    }
    println!("worst {worst:.3} of what is allowed");
}

#[test]
fn rays_from_a_hundred_million_radii_take_as_many_steps_as_rays_from_a_few_hundred() {
    let text = hole(DVec3::ZERO, 1.0)
        + "[environment]\ncolor = [1, 1, 1]\n[render]\narc_tolerance = 1e-2\n"
        + &material("black", 0.0, 0.0)
        + "[[entity]]\ndisk = { center = [0, 0, 0], normal = [0, 1, 0], inner = 3, outer = 15 }\nmaterial = \"black\"\n";
    let scene = scene(&text);
    let steps = |distance: f64| {
        let position = distance * DVec3::new(0.0, 0.6, 0.8);
        let target = |i: i32| DVec3::new(0.3 * f64::from(i % 81 - 40), 0.0, 0.3 * f64::from(i / 81 - 40));
        let ray = |i: i32| {
            let direction = (target(i) - position).normalize();
            Ray { position, direction, origin_prim: PrimitiveId::NONE }
        };
        let shots = shoot(&scene, &(0..81 * 81).map(ray).collect::<Vec<_>>());
        assert!(!shots.iter().any(|shot| matches!(shot.end, Outcome::StepLimit | Outcome::NonFinite)));
        shots.iter().map(|shot| shot.steps as f64).sum::<f64>() / shots.len() as f64
    };
    // From nearer, a step of less leads right into the geometry.
    let near = steps(3e2);
    for distance in [1e4, 1e6, 1e8] {
        let far = steps(distance);
        assert!(far < near + 0.5, "{far} steps a ray from {distance:e}, {near} from 3e2");
    }
}
