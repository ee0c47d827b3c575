//! The density with which light sampling chooses a ray is what it says, asked from either end.

use std::f64::consts::PI;

use crate::support::lit::{TWISTS, room};
use crate::support::{Random, camera, film, material, scene, sphere};
use glam::DVec3;
use warpfront::geometry::PrimitiveId;
use warpfront::light::{
    EmitterHit, Incoming, Lensed, LightRayEnd, LightSampler, Lights, Receiver, StraightAim, Target,
};
use warpfront::scene::Baked;
use warpfront::trace::transport::{Landing, Outcome};
use warpfront::trace::{Ray, shoot};

/// A scene with its lights.
struct Lit {
    scene: Baked,
    lights: Lights,
    sampler: Box<dyn LightSampler>,
    max_winding: u32,
}

impl Lit {
    fn new(mut scene: Baked, max_winding: u32) -> Self {
        // Far below what is asked for.
        scene.settings.tolerance = 1e-9;
        let (sampler, floor): (Box<dyn LightSampler>, f64) = match scene.spacetime.medium() {
            Some((center, metric)) => (Box::new(Lensed::new(metric, center, max_winding).unwrap()), 0.1),
            None => (Box::new(StraightAim), 0.0),
        };
        let Baked { geometry, materials, environment, punctual, .. } = &scene;
        let lights = Lights::new(geometry, (materials, &[]), environment, punctual, floor);
        Self { scene, lights, sampler, max_winding }
    }

    /// Points on surfaces, as paths find them.
    fn receivers(&self, random: &mut Random, count: usize) -> Vec<(Receiver, PrimitiveId)> {
        let (position, _) =
            self.scene.camera.ray(glam::DVec2::splat(0.5), 1.0, glam::DVec2::splat(0.5)).unwrap();
        let mut found = Vec::new();
        let mut from = Ray { position, direction: random.direction(), origin_prim: PrimitiveId::NONE };
        while found.len() < count {
            if let Outcome::Landed(landing) = shoot(&self.scene, &[from])[0].end {
                let normal = self.normal(&landing);
                let normal = normal * -landing.direction.dot(normal).signum();
                let on = landing.primitive;
                let receiver =
                    Receiver { position: landing.position, normal, grazing: 0.0, both_sides: false, on };
                found.push((receiver, landing.primitive));
            }
            from.direction = random.direction();
        }
        found
    }

    fn normal(&self, landing: &Landing) -> DVec3 {
        self.scene.geometry.surface_point(landing.primitive, landing.position).normal
    }

    /// The density of a ray that was followed to its end.
    fn density(&self, receiver: &Receiver, direction: DVec3, landing: &Landing) -> f64 {
        let Landing { primitive, position, direction: arrival, .. } = *landing;
        let hit = EmitterHit { primitive, position, normal: self.normal(landing), arrival };
        self.sampler.surface_density(&self.lights, receiver, direction, &hit)
    }

    /// Where rays from `receiver` end.
    fn follow(
        &self,
        (receiver, origin_prim): &(Receiver, PrimitiveId),
        directions: &[DVec3],
    ) -> Vec<Option<Landing>> {
        let rays: Vec<Ray> = directions
            .iter()
            .map(|&direction| Ray { position: receiver.position, direction, origin_prim: *origin_prim })
            .collect();
        let landing =
            |end: &Outcome<_>| if let Outcome::Landed(landing) = end { Some(*landing) } else { None };
        shoot(&self.scene, &rays).iter().map(|shot| landing(&shot.end)).collect()
    }

    /// Directions of light samples with their targets and densities; `None` for those that find nothing.
    fn samples(&self, receiver: &Receiver, random: &mut Random, count: usize) -> Vec<(DVec3, Target, f64)> {
        let sample = |random: &mut Random| {
            let numbers = [0; 2].map(|_| random.between(0.0, 1.0));
            let sample = self.sampler.sample(&self.lights, receiver, numbers)?;
            let Incoming::Radiance(_, density) = sample.light else { return None };
            Some((sample.direction, sample.target, density))
        };
        (0..count).filter_map(|_| sample(random)).collect()
    }
}

/// Whether a ray ended where it was aimed at.
fn is_met(lit: &Lit, target: Target, landing: &Landing) -> bool {
    // A disk around the hole sees itself edge-on.
    let &Landing { primitive, position, direction, .. } = landing;
    let end = LightRayEnd { primitive, position, direction };
    let is_seen = landing.direction.dot(lit.normal(landing)).abs() > 1e-6;
    is_seen && lit.sampler.reaches(&lit.lights, target, &end)
}

fn ends_agree(rooms: u64, receivers: usize, count: usize, bound: f64) {
    let (mut compared, mut worst, mut wrong) = (0, 0.0f64, Vec::new());
    for number in 0..rooms {
        let twist = TWISTS[number as usize % TWISTS.len()];
        let mut random = Random::new(500 + number);
        let lit = Lit::new(room(&mut random, twist, 1.0), (number / 8 % 4) as u32);
        for from in lit.receivers(&mut random, receivers) {
            let samples = lit.samples(&from.0, &mut random, count);
            let directions: Vec<DVec3> = samples.iter().map(|sample| sample.0).collect();
            for (&(direction, target, density), landing) in samples.iter().zip(lit.follow(&from, &directions))
            {
                let Some(landing) = landing.filter(|landing| is_met(&lit, target, landing)) else { continue };
                let error = (lit.density(&from.0, direction, &landing) / density - 1.0).abs();
                let cos = landing.direction.dot(lit.normal(&landing));
                let bound = bound + 1e-4 / (cos * cos);
                compared += 1;
                if error > bound {
                    wrong.push((number, twist, lit.max_winding, error, cos, density));
                } else if cos.abs() > 0.1 {
                    worst = worst.max(error);
                }
            }
        }
    }
    println!(
        "{compared} densities, worst {worst:.1e}, {} beyond: {:?}",
        wrong.len(),
        &wrong[..wrong.len().min(20)]
    );
    assert!(compared > 1000);
    // Where a ray winds itself around the photon sphere, one crossing of a surface is close to the next.
    assert!(wrong.iter().all(|wrong| wrong.2 > 1) && wrong.len() * 10_000 < compared);
}

#[test]
fn a_ray_has_the_density_with_which_it_was_chosen() {
    ends_agree(32, 30, 100, 1e-3);
}

/// The mean over all directions of the density is the share of samples that get to where they are aimed at: that checks
/// the geometry factor from which densities come by nothing but counting.
fn densities_integrate(rooms: u64, receivers: usize, count: usize) {
    let (mut squares, mut sum_of_z, mut tests, mut worst) = (0.0, 0.0, 0.0, 0.0f64);
    for number in 0..rooms {
        let twist = TWISTS[number as usize % TWISTS.len()];
        let mut random = Random::new(700 + number);
        let lit = Lit::new(room(&mut random, twist, 1.5), (number / 8 % 3) as u32);
        for from in lit.receivers(&mut random, receivers) {
            let directions: Vec<DVec3> = (0..count).map(|_| random.direction()).collect();
            let ends = lit.follow(&from, &directions);
            let values = directions.iter().zip(&ends).map(|(direction, end)| {
                end.map_or(0.0, |end| 4.0 * PI * lit.density(&from.0, *direction, &end))
            });
            let (sum, square) = values.fold((0.0, 0.0), |(sum, square), v| (sum + v, square + v * v));
            let n = count as f64;
            let (mean, error2) = (sum / n, (square / n - (sum / n).powi(2)) / n);
            let samples = lit.samples(&from.0, &mut random, count / 4);
            let directions: Vec<DVec3> = samples.iter().map(|sample| sample.0).collect();
            let met = samples.iter().zip(lit.follow(&from, &directions));
            let met = met.filter(|(sample, end)| end.is_some_and(|end| is_met(&lit, sample.1, &end))).count();
            let share = 4.0 * met as f64 / n;
            if share < 0.02 || mean * mean < 100.0 * error2 {
                continue;
            }
            let error = (error2 + 4.0 * share * (1.0 - share) / n + 1e-6).sqrt();
            let z = (mean - share) / error;
            squares += z * z;
            sum_of_z += z;
            tests += 1.0;
            if z.abs() > worst.abs() {
                worst = z;
            }
            assert!(mean < 1.0 + 4.0 * error2.sqrt(), "{number} {twist:?}: {mean} ± {}", error2.sqrt());
            assert!(z.abs() < 4.5, "{number} {twist:?}: {mean} ± {} for {share} ± {error}", error2.sqrt());
        }
    }
    let (square, together) = (squares / tests, sum_of_z / f64::sqrt(tests));
    println!("{tests} receivers, worst z {worst:.2}, mean square {square:.2}, all together {together:.2}");
    assert!(together.abs() < 3.0, "{together}");
    assert!(tests > 30.0 && square < 1.0 + 4.0 * (2.0 / tests).sqrt());
}

#[test]
fn densities_integrate_to_the_share_of_samples_that_meet_their_lights() {
    densities_integrate(24, 4, 20_000);
}

/// Inside a sphere that emits every light sample is seen, from every point of it and of what is in it, and whatever a
/// ray meets could have been sampled: rounding does not decide which side of the sphere a point of it is on.
#[test]
fn what_is_seen_inside_a_lamp_can_all_be_sampled() {
    for (number, size) in [1e-3, 0.1, 1.0, 50.0, 1e3, 1e6].into_iter().enumerate() {
        for center in
            [DVec3::ZERO, size * DVec3::new(0.3, -0.7, 0.1), 1e4 * size * DVec3::new(1.0, 0.3, -0.2)]
        {
            let text = camera(center + 0.3 * size * DVec3::X, center, 60.0)
                + &film(1, 1)
                + &material("lamp", 0.5, 1.0)
                + &sphere(center, size, "lamp")
                + &sphere(center - 0.5 * size * DVec3::Z, 0.35 * size, "lamp");
            let lit = Lit::new(scene(&text), 0);
            let mut random = Random::new(900 + number as u64);
            let receivers = lit.receivers(&mut random, 100);
            let on_room = |receiver: &Receiver| receiver.position.distance(center) > 0.9 * size;
            assert!(
                receivers.iter().any(|from| on_room(&from.0))
                    && receivers.iter().any(|from| !on_room(&from.0))
            );
            for from in receivers {
                let samples = lit.samples(&from.0, &mut random, 50);
                let directions: Vec<DVec3> = samples.iter().map(|sample| sample.0).collect();
                let ends = lit.follow(&from, &directions);
                let met = samples.iter().zip(&ends).filter(|(sample, end)| {
                    let landing = end.expect("the room is closed");
                    let density = lit.density(&from.0, sample.0, &landing);
                    let is_same = (density / sample.2 - 1.0).abs() < 1e-4;
                    is_met(&lit, sample.1, &landing) && is_same
                });
                // From the ball's own outer side only the room can be sampled; from the room, the ball hides a part of
                // it.
                assert!(met.count() >= if on_room(&from.0) { 30 } else { 5 }, "{size} at {center}");
                for _ in 0..20 {
                    let direction = (from.0.normal + 0.99 * random.direction()).normalize();
                    let end = lit.follow(&from, &[direction])[0].expect("the room is closed");
                    let density = lit.density(&from.0, direction, &end);
                    assert!(density > 0.0 && density.is_finite(), "{size} at {center}: {density}");
                }
            }
        }
    }
}
