//! Rays in fields of refraction: several holes against exact rays and against one hole, lenses against their images.

use crate::support::command::{Folder, assert_good};
use crate::support::{Random, Row, data, material, scene, sphere, table, vector};
use glam::DVec3;
use warpfront::geodesic::{
    Dop853, FieldControl, FieldEnd, FieldJourney, FieldRays, Rkn6, Stepper, alone, follow_field,
};
use warpfront::geometry::PrimitiveId;
use warpfront::scene::{Precision, StepperKind};
use warpfront::spacetime::{
    Entry, FieldSurvey, GradedLens, Hole, IndexField, Lenses, SeveralHoles, Sink, Vectors, Viewpoint,
};
use warpfront::study::free::Accuracy;
use warpfront::study::free::isotropic::{FreeRay, trace};
use warpfront::trace::transport::Outcome;
use warpfront::trace::{Ray, shoot};

/// A ray followed to the sphere of this centre and radius.
fn follow(
    field: &impl IndexField,
    stepper: &impl Stepper,
    tolerance: f64,
    (x, d): (DVec3, DVec3),
    sphere: (DVec3, f64),
) -> FieldJourney {
    let control = FieldControl::new(field, 0.0, tolerance, f64::INFINITY);
    let start = FieldRays::new(field, &alone(x), &alone(d));
    follow_field(field, stepper, &control, start, sphere, |_, _, _| {})
}

/// The holes of a row of the table.
fn holes(row: &Row) -> Vec<Hole> {
    let hole = |i: u32| Hole {
        mass: row.number(&format!("m{i}")),
        center: DVec3::from(["hx", "hy", "hz"].map(|name| row.number(&format!("{name}{i}")))),
    };
    (1..=row.number("holes") as u32).map(hole).collect()
}

/// Start and direction of a row, and the sphere on which it ends.
fn given(row: &Row) -> ((DVec3, DVec3), (DVec3, f64)) {
    let [x, d, center] =
        [["x0", "y0", "z0"], ["dx0", "dy0", "dz0"], ["cx", "cy", "cz"]].map(|names| row.vector(names));
    ((x, d), (center, row.number("r_out")))
}

/// How far an end is off, relative to what is allowed.
fn share(row: &Row, tolerance: f64, (position, direction): (DVec3, DVec3)) -> f64 {
    let (x, d) = (row.vector(["x1", "y1", "z1"]), row.vector(["dx1", "dy1", "dz1"]));
    let error = (position.distance(x) / row.number("r_out")).max(direction.distance(d));
    error / ((tolerance + 1e-15) * row.number("sens"))
}

#[test]
fn every_exact_ray_among_several_holes_ends_where_it_should() {
    let rows = table("majumdar_papapetrou_rays.csv");
    assert!(rows.len() > 120);
    fn check(rows: &[Row], name: &str, stepper: impl Stepper) {
        for tolerance in [1e-5, 1e-8, 1e-10] {
            let (mut worst, mut steps) = (0.0f64, 0);
            for row in rows {
                let (ray, sphere) = given(row);
                let journey = follow(&SeveralHoles::new(&holes(row)), &stepper, tolerance, ray, sphere);
                steps += journey.steps;
                let label = format!("row {} at {tolerance:e}: {journey:?}", row.text("id"));
                match (row.text("status"), journey.end) {
                    ("captured", FieldEnd::Falls(hole)) => {
                        assert_eq!(row.number("hole"), (hole + 1) as f64, "{label}");
                    }
                    ("escaped", FieldEnd::Crosses(position, direction)) => {
                        let share = share(row, tolerance, (position, direction));
                        assert!(share < 1.0, "{label}: {share}");
                        worst = worst.max(share);
                    }
                    (status, _) => panic!("{status}: {label}"),
                }
            }
            let mean = f64::from(steps) / rows.len() as f64;
            println!("{name} {tolerance:e}: worst {worst:.3}, {mean:.1} steps");
        }
    }
    check(&rows, "rkn6", Rkn6);
    check(&rows, "dop853", Dop853);
}

/// `[spacetime]` of holes.
fn several_holes(holes: &[Hole]) -> String {
    let hole = |Hole { center, mass }: &Hole| {
        format!("[[spacetime.hole]]\ncenter = {}\nmass = {mass:?}\n", vector(*center))
    };
    "[spacetime]\nkind = \"several-holes\"\n".to_owned() + &holes.iter().map(hole).collect::<String>()
}

#[test]
fn every_exact_ray_among_several_holes_is_rendered_so() {
    for (tolerance, stepper) in [(1e-5, "rkn6"), (1e-8, "dop853")] {
        for row in table("majumdar_papapetrou_rays.csv") {
            let ((position, direction), (center, r_out)) = given(&row);
            let text = several_holes(&holes(&row))
                + &format!("[render]\nstepper = \"{stepper}\"\ntolerance = {tolerance:?}\n")
                + &format!("arc_tolerance = {:?}\n", 1e-3 * r_out)
                + &material("black", 0.0, 0.0)
                + &sphere(center, r_out, "black");
            let ray = Ray { position, direction: direction.normalize(), origin_prim: PrimitiveId::NONE };
            let shot = shoot(&scene(&text), &[ray])[0];
            let label = format!("row {} at {tolerance:e}: {shot:?}", row.text("id"));
            match shot.end {
                Outcome::Captured => assert_eq!(row.text("status"), "captured", "{label}"),
                // A ray that starts outside lands on the outside first.
                Outcome::Landed(_) if position.distance(center) > r_out => {}
                Outcome::Landed(landing) => {
                    let share = share(&row, tolerance, (landing.position, landing.direction));
                    assert!(share < 1.0, "{label}: {share}");
                }
                _ => panic!("{label}"),
            }
        }
    }
}

#[test]
fn the_table_of_several_holes_is_traced_column_by_column() {
    let folder = Folder::with(&[("rays.csv", &data("majumdar_papapetrou_rays.csv"))]);
    let flags =
        ["trace", "--spacetime", "several-holes", "--quality", "reference", "rays.csv", "-o", "out.csv"];
    assert_good(&folder.run(&flags));
    let (found, exact) = (folder.rows("out.csv"), table("majumdar_papapetrou_rays.csv"));
    assert_eq!(found.len(), exact.len());
    for (found, exact) in found.iter().zip(&exact) {
        let label = format!("row {}", exact.text("id"));
        for column in ["id", "kind", "status", "hole"] {
            assert_eq!(found.text(column), exact.text(column), "{label}");
        }
        if let Some(momentum) = exact.maybe("L_axis") {
            assert!((found.number("L_axis") - momentum).abs() < 1e-12 * (1.0 + momentum.abs()), "{label}");
        }
        if exact.text("status") == "captured" {
            continue;
        }
        let end = (found.vector(["x1", "y1", "z1"]), found.vector(["dx1", "dy1", "dz1"]));
        assert!(share(exact, 1e-10, end) < 1.0, "{label}");
        let (sens, time) = (exact.number("sens"), exact.number("t"));
        assert!((found.number("sens") / sens - 1.0).abs() < 0.02, "{label}: sens {}", found.number("sens"));
        let late = (found.number("t") - time).abs() / time;
        assert!(late < 1e-10 * sens, "{label}: late by {late:e}, sens {sens}");
    }
}

#[test]
fn one_hole_is_a_hole_of_extremal_charge() {
    let (center, mass) = (DVec3::new(0.3, -1.0, 2.0), 0.8);
    let one = SeveralHoles::new(&[Hole { center, mass }]);
    let charged = Entry::named("reissner-nordstrom").unwrap().with(center, &[2.0 * mass, 1.0]);
    let accuracy = Accuracy { stepper: StepperKind::Dop853, tolerance: 1e-11, precision: Precision::F64 };
    let mut random = Random::new(11);
    let (mut escaped, mut captured) = (0, 0);
    for _ in 0..400 {
        let start = center + random.log_between(0.1, 1e5) * mass * random.direction();
        // Half of them towards the hole.
        let aim = center + 12.0 * mass * random.in_cube() - start;
        let direction = if random.between(0.0, 1.0) < 0.5 { random.direction() } else { aim };
        let r_out = 1.5 * start.distance(center).max(10.0 * mass);
        let exit = trace(&charged, &FreeRay { start, direction, r_out }, &accuracy).unwrap();
        let journey = follow(&one, &Dop853, 1e-11, (start, direction), (center, r_out));
        match (exit.crossing, journey.end) {
            (None, FieldEnd::Falls(0)) => captured += 1,
            (Some(exact), FieldEnd::Crosses(position, direction)) if exact.sens < 1e7 => {
                let off =
                    (position.distance(exact.position) / r_out).max(direction.distance(exact.direction));
                assert!(off < 3e-11 * exact.sens, "{start} {direction}: off by {off:e}, sens {}", exact.sens);
                escaped += 1;
            }
            (Some(exact), _) if exact.sens >= 1e7 => {}
            _ => panic!("{start} {direction}: {exit:?} {journey:?}"),
        }
    }
    assert!(escaped > 100 && captured > 50, "{escaped} {captured}");
}

#[test]
fn rays_among_several_holes_run_back_to_where_they_came_from() {
    let mut random = Random::new(3);
    for _ in 0..200 {
        let count = random.between(1.0, 4.99) as u32;
        let hole = |_| Hole { center: 6.0 * random.in_cube(), mass: random.log_between(0.1, 2.0) };
        let holes: Vec<Hole> = (0..count).map(hole).collect();
        let field = SeveralHoles::new(&holes);
        let (x, d) =
            (holes[0].center + random.log_between(0.2, 20.0) * random.direction(), random.direction());
        let sphere = (field.middle(), 100.0);
        let FieldEnd::Crosses(end, heading) = follow(&field, &Dop853, 1e-12, (x, d), sphere).end else {
            continue;
        };
        let radius = 1e-3;
        let back = follow(&field, &Dop853, 1e-12, (end, -heading), (x + radius * d, radius)).end;
        let FieldEnd::Crosses(start, reversed) = back else {
            // The way back misses the small sphere only where the way there is sensitive.
            let beside = (d + 1e-8 * d.any_orthonormal_vector()).normalize();
            let other = follow(&field, &Dop853, 1e-12, (x, beside), sphere).end;
            let FieldEnd::Crosses(other, _) = other else { continue };
            assert!(other.distance(end) > 1e-4, "{x} {d}: {back:?}");
            continue;
        };
        assert!(start.distance(x) < 1e-6 && reversed.distance(-d) < 1e-6, "{x} {d}: {start} {reversed}");
    }
}

/// Distance of two ends, place over `r` or direction; `None` if they are of different kinds.
fn apart(a: FieldEnd, b: FieldEnd, r: f64) -> Option<f64> {
    match (a, b) {
        (FieldEnd::Crosses(x, d), FieldEnd::Crosses(y, e)) => Some((x.distance(y) / r).max(d.distance(e))),
        (FieldEnd::Falls(i), FieldEnd::Falls(j)) => (i == j).then_some(0.0),
        _ => None,
    }
}

#[test]
fn random_rays_among_several_holes_keep_their_tolerance() {
    fn check(name: &str, stepper: impl Stepper) {
        for tolerance in [1e-3, 1e-5, 1e-8] {
            let mut random = Random::new(7);
            let (mut shares, mut steps, mut others) = (Vec::new(), 0, 0);
            let count = 1500;
            for i in 0..count {
                let number = random.between(1.0, 4.99) as u32;
                let hole = |_| Hole { center: 8.0 * random.in_cube(), mass: random.log_between(0.1, 2.0) };
                let holes: Vec<Hole> = (0..number).map(hole).collect();
                let field = SeveralHoles::new(&holes);
                // Half of them from near a hole in all directions, half from afar towards all of them.
                let x = if i % 2 == 0 {
                    holes[0].center + random.log_between(0.03, 20.0) * random.direction()
                } else {
                    random.log_between(20.0, 1e6) * random.direction()
                };
                let aim = 15.0 * random.in_cube() - x;
                let d = if i % 2 == 0 { random.direction() } else { aim.normalize() };
                let sphere = (field.middle(), 1.3 * x.distance(field.middle()).max(30.0));
                let exact = |d: DVec3| follow(&field, &Dop853, 1e-13, (x, d), sphere).end;
                let journey = follow(&field, &stepper, tolerance, (x, d), sphere);
                assert!(
                    matches!(journey.end, FieldEnd::Crosses(..) | FieldEnd::Falls(_)),
                    "{x} {d}: {journey:?}"
                );
                steps += journey.steps;
                let (end, angle) = (exact(d), 1e-7);
                let (across, up) = d.any_orthonormal_pair();
                let beside =
                    [across, up].map(|way| apart(end, exact((d + angle * way).normalize()), sphere.1));
                let [Some(first), Some(second)] = beside else { continue };
                let sens = (first.max(second) / angle).max(1.0);
                // Beside the shadow of a hole, the fate is a matter of less than the tolerance.
                let Some(error) = apart(journey.end, end, sphere.1) else {
                    others += 1;
                    continue;
                };
                if sens < 1e5 && matches!(end, FieldEnd::Crosses(..)) {
                    shares.push(error / ((tolerance + 1e-14) * sens));
                }
            }
            shares.sort_by(f64::total_cmp);
            let [median, most, worst] =
                [0.5, 0.99, 1.0].map(|q| shares[(q * (shares.len() - 1) as f64) as usize]);
            let mean = f64::from(steps) / f64::from(count);
            println!(
                "{name} {tolerance:e}: median {median:.3}, 99 % {most:.3}, largest {worst:.3}, {mean:.1} steps"
            );
            assert!(
                most < 1.0 && worst < 10.0 && others <= 5,
                "{name} at {tolerance:e}: {most} {worst} {others}"
            );
        }
    }
    check("rkn6", Rkn6);
    check("dop853", Dop853);
}

#[test]
fn few_steps_take_a_ray_from_afar_past_several_holes() {
    let holes = [
        Hole { center: DVec3::new(2.0, 0.0, 0.0), mass: 1.0 },
        Hole { center: DVec3::new(-3.0, 1.0, 0.0), mass: 0.5 },
    ];
    let field = SeveralHoles::new(&holes);
    for distance in [1e2, 1e4, 1e6, 1e8] {
        let x = distance * DVec3::new(0.6, 0.64, 0.48);
        let aim = DVec3::new(-30.0, 0.0, 20.0) - x;
        let journey = follow(&field, &Rkn6, 1e-5, (x, aim), (field.middle(), 1.5 * distance));
        assert!(
            matches!(journey.end, FieldEnd::Crosses(..)) && journey.steps < 25,
            "{distance:e}: {journey:?}"
        );
    }
}

#[test]
fn random_rays_among_several_holes_in_a_closed_sphere_are_never_lost() {
    let mut random = Random::new(8);
    for _ in 0..20 {
        let hole = |_| Hole { center: 5.0 * random.in_cube(), mass: random.log_between(0.05, 2.0) };
        let holes: Vec<Hole> = (0..3).map(hole).collect();
        let text = several_holes(&holes)
            + "[render]\narc_tolerance = 0.01\n"
            + &material("black", 0.0, 0.0)
            + &sphere(DVec3::ZERO, 30.0, "black");
        let ray = |_| {
            let near = holes[random.between(0.0, 3.0) as usize].center;
            let position = near + random.log_between(1e-3, 15.0) * random.direction();
            Ray { position, direction: random.direction(), origin_prim: PrimitiveId::NONE }
        };
        let rays: Vec<Ray> = (0..1000).map(ray).collect();
        for (ray, shot) in rays.iter().zip(shoot(&scene(&text), &rays)) {
            let is_good = matches!(shot.end, Outcome::Captured | Outcome::Landed(_));
            assert!(is_good, "{ray:?}: {shot:?}, {holes:?}");
        }
    }
}

/// n = 2/(1 + x²): all rays from x meet again at −x/x².
#[derive(Clone, PartialEq)]
struct FishEye;

impl FishEye {
    /// n² and 2/(1 + x²)² · −4/(1 + x²), the factor of x in ½∇n².
    fn terms(x: [f64; 3]) -> (f64, f64) {
        let n = 2.0 / (1.0 + x[0] * x[0] + x[1] * x[1] + x[2] * x[2]);
        (n * n, -n * n * n)
    }
}

impl IndexField for FishEye {
    fn survey<const L: usize>(&self, x: &Vectors<L>, _: &Vectors<L>) -> FieldSurvey<L> {
        let (mut index_squared, mut force, mut room) = ([0.0; L], [[0.0; L]; 3], [1.0; L]);
        for l in 0..L {
            let place = [x[0][l], x[1][l], x[2][l]];
            let (n2, pull) = Self::terms(place);
            (index_squared[l], room[l]) = (n2, (2.0 / n2.sqrt()).sqrt());
            for k in 0..3 {
                force[k][l] = pull * place[k];
            }
        }
        FieldSurvey { index_squared, force, lean: [[0.0; L]; 3], room, reach: room }
    }

    fn acceleration<const L: usize>(&self, from: &Viewpoint<L>, y: &Vectors<L>) -> Vectors<L> {
        let mut force = [[0.0; L]; 3];
        for l in 0..L {
            let place = [0, 1, 2].map(|k| from.x[k][l] + y[k][l]);
            let (_, pull) = Self::terms(place);
            for k in 0..3 {
                force[k][l] = pull * place[k];
            }
        }
        force
    }

    fn area_scale(&self, _: DVec3) -> f64 {
        1.0
    }

    fn middle(&self) -> DVec3 {
        DVec3::ZERO
    }

    fn turning_radius(&self) -> f64 {
        1e9
    }

    fn sinks(&self) -> &[Sink] {
        &[]
    }
}

#[test]
fn all_rays_from_a_point_of_the_fish_eye_in_space_meet_at_its_image() {
    fn check(name: &str, stepper: impl Stepper) {
        for tolerance in [1e-5, 1e-8, 1e-10] {
            let mut random = Random::new(5);
            let (mut worst, mut steps) = (0.0f64, 0);
            for _ in 0..200 {
                let x = random.log_between(0.3, 3.0) * random.direction();
                // Not along the radius: that way leads through infinity.
                let across = random.direction().cross(x).normalize();
                let d = (across + random.between(-1.0, 1.0) * x / x.length()).normalize();
                let image = -x / x.length_squared();
                // The ray is a circle, at the same angle to the radius here and there. It leaves a small sphere there.
                let tangent = 2.0 * d.dot(x) * x / x.length_squared() - d;
                let radius = 0.05 * image.length();
                let sphere = (image - radius * tangent, radius);
                let journey = follow(&FishEye, &stepper, tolerance, (x, d), sphere);
                steps += journey.steps;
                let FieldEnd::Crosses(place, direction) = journey.end else { panic!("{x} {d}: {journey:?}") };
                let off = place.distance(image) / image.length().max(1.0).max(x.length());
                let share = off.max(direction.distance(tangent)) / (tolerance + 1e-14);
                worst = worst.max(share);
            }
            println!("{name} {tolerance:e}: worst {worst:.3}, {:.1} steps", f64::from(steps) / 200.0);
            assert!(worst < 5.0, "{name} at {tolerance:e}: {worst}");
        }
    }
    check("rkn6", Rkn6);
    check("dop853", Dop853);
}

#[test]
fn luneburgs_lens_in_space_gathers_parallel_rays_in_a_point_of_its_rim() {
    let (center, radius) = (DVec3::new(3.0, -2.0, 1.0), 1.5);
    // With another one far aside, which nothing comes near.
    let aside = GradedLens::Gaussian { center: DVec3::new(0.0, 300.0, 0.0), width: 2.0, amplitude: 0.3 };
    let field = Lenses::new(&[GradedLens::Luneburg { center, radius }, aside]);
    let d = DVec3::new(0.48, 0.6, 0.64);
    let across = d.any_orthonormal_vector();
    fn check(name: &str, stepper: impl Stepper, [d, across]: [DVec3; 2], field: &Lenses, radius: f64) {
        let center = field.lenses()[0].center();
        for tolerance in [1e-3, 1e-5, 1e-8, 1e-11] {
            let (mut worst, mut steps) = (0.0f64, 0);
            for i in 0..100 {
                let b = 0.0098 * f64::from(i) + 0.001;
                let x = center + radius * (b * across - (2.0 + 30.0 * f64::from(i % 3)) * d);
                let journey = follow(field, &stepper, tolerance, (x, d), (center, 3.0 * radius));
                steps += journey.steps;
                let FieldEnd::Crosses(place, heading) = journey.end else { panic!("{b}: {journey:?}") };
                // At the focus a ray has turned by asin b.
                let exact = ((1.0 - b) * (1.0 + b)).sqrt() * d - b * across;
                let past = (center + radius * d - place).cross(heading).length() / radius;
                // Near the rim, rays are that much closer to each other in angle than in place.
                let sens = 1.0 / ((1.0 - b) * (1.0 + b)).sqrt();
                worst = worst.max(past.max(heading.distance(exact)) / (sens * tolerance + 1e-14));
            }
            println!("{name} {tolerance:e}: worst {worst:.3}, {:.1} steps", f64::from(steps) / 100.0);
            assert!(worst < 1.0, "{name} at {tolerance:e}: {worst}");
        }
    }
    check("rkn6", Rkn6, [d, across], &field, radius);
    check("dop853", Dop853, [d, across], &field, radius);
}

#[test]
fn a_ray_through_gaussian_lenses_keeps_its_angular_momentum_about_their_axis() {
    let axis = DVec3::new(0.0, 0.6, 0.8);
    let lens = |along: f64, width, amplitude| GradedLens::Gaussian { center: along * axis, width, amplitude };
    let field = Lenses::new(&[lens(0.0, 1.0, 0.5), lens(2.5, 0.6, -0.4), lens(-20.0, 0.2, 0.8)]);
    let mut random = Random::new(2);
    for _ in 0..300 {
        let x = 50.0 * random.direction();
        let d = (2.0 * random.in_cube() - x).normalize();
        let FieldEnd::Crosses(end, heading) = follow(&field, &Rkn6, 1e-9, (x, d), (DVec3::ZERO, 60.0)).end
        else {
            panic!("{x} {d}")
        };
        let change = axis.dot(x.cross(d)) - axis.dot(end.cross(heading));
        assert!(change.abs() < 1e-7, "{x} {d}: {change:e}");
        let fine = follow(&field, &Dop853, 1e-12, (x, d), (DVec3::ZERO, 60.0)).end;
        let FieldEnd::Crosses(exact, _) = fine else { panic!("{x} {d}") };
        assert!(exact.distance(end) < 1e-5, "{x} {d}: {exact} {end}");
    }
}
