//! Light of punctual lights among several holes, through receivers all over the part of a sphere behind the holes: as much as
//! the rays carry that leave the light, followed one by one. Rays close to a caustic, as bright as one likes, are not counted
//! on either side: they would hide in their noise what is missing of the others.

use std::f64::consts::PI;

use glam::{DVec3, Vec3};

use crate::support::Random;
use warpfront::geodesic::{
    FieldControl, FieldEnd, FieldRays, FieldTarget, JoinLimits, Rkn6, alone, follow_field, join_in_field,
};
use warpfront::geometry::{Geometry, PrimitiveId, Primitives};
use warpfront::light::{FieldRegions, Incoming, LightSampler, Lights, Punctual, Receiver};
use warpfront::shade::Environment;
use warpfront::spacetime::{Hole, IndexField, SeveralHoles};

/// Radius of the sphere, scene units.
const RADIUS: f64 = 12.0;
/// Rays that are followed, samples that are taken, and relative standard error of their mean at most.
const RAYS: u32 = 50_000;
const SAMPLES: u32 = 30_000;
const ERROR: f64 = 0.05;
/// Largest ratio of a ray's light to what it would bring in flat space.
const BRIGHTEST: f64 = 4.0;

/// Holes, by their number the room with two holes or random ones, a place for a light, and a direction through them.
fn scene(number: u64) -> (SeveralHoles, DVec3, DVec3) {
    let room = [(DVec3::new(-2.5, 0.5, 1.0), 0.6), (DVec3::new(2.0, -1.0, 0.0), 0.3)];
    let mut random = Random::new(number);
    let mut hole = |_| (3.0 * random.in_cube(), random.log_between(0.1, 0.6));
    let holes: Vec<(DVec3, f64)> =
        if number == 0 { room.to_vec() } else { (0..2 + number % 3).map(&mut hole).collect() };
    let holes: Vec<Hole> = holes.into_iter().map(|(center, mass)| Hole { center, mass }).collect();
    let field = SeveralHoles::new(&holes);
    assert!(field.turning_radius() + field.middle().length() < RADIUS);
    let place = if number == 0 { DVec3::new(5.3, 5.3, 4.0) } else { 8.0 * random.direction() };
    let through = (field.middle() - place).normalize();
    (field, place, through)
}

/// Unit vector with this place among so many that lie evenly over the sphere, on a spiral.
fn evenly(place: u32, count: u32) -> DVec3 {
    let z = 1.0 - (2.0 * f64::from(place) + 1.0) / f64::from(count);
    let (sin, cos) = (PI * (3.0 - 5f64.sqrt()) * f64::from(place)).sin_cos();
    let rho = (1.0 - z * z).sqrt();
    DVec3::new(rho * cos, rho * sin, z)
}

/// True of the part of the sphere that light through the holes reaches.
fn is_behind(place: DVec3, through: DVec3) -> bool {
    place.dot(through) > 0.5 * RADIUS
}

/// Light behind several holes, as rays from it bring it there.
struct Shadow {
    field: SeveralHoles,
    control: FieldControl,
    light: Punctual,
    through: DVec3,
}

impl Shadow {
    fn new(field: SeveralHoles, light: Punctual, through: DVec3) -> Self {
        let control = FieldControl::new(&field, RADIUS, 1e-6, f64::INFINITY);
        Self { field, control, light, through }
    }

    /// True if a ray that leaves the light leaves the sphere where it counts.
    fn counts(&self, x: DVec3, direction: DVec3) -> bool {
        let start = FieldRays::new(&self.field, &alone(x), &alone(direction));
        let sphere = (DVec3::ZERO, RADIUS);
        match follow_field(&self.field, &Rkn6, &self.control, start, sphere, |_, _, _| {}).end {
            FieldEnd::Crosses(place, arrival) => {
                is_behind(place, self.through) && self.is_plain(place, -arrival)
            }
            FieldEnd::Falls(_) | FieldEnd::Misses => false,
            end => panic!("{end:?}"),
        }
    }

    /// True of a ray from `x` to the light that is not too bright.
    fn is_plain(&self, x: DVec3, direction: DVec3) -> bool {
        let towards = || FieldTarget::Infinity(-self.light.direction().unwrap());
        let target = self.light.position().map_or_else(towards, FieldTarget::Place);
        let whole = self.light.position().map_or(1.0, |y| x.distance(y));
        let limits = JoinLimits { enough: 1e-4 * whole, linear: 0.0, corrections: 2 };
        let ray = join_in_field(&self.field, &self.control, (x, direction), target, limits);
        ray.is_some_and(|ray| ray.geometry_factor() * whole * whole < BRIGHTEST)
    }

    /// Compares what samples bring to the sphere with what is there, and gives their ratio and its standard error. The phase
    /// space of rays is kept, n⁴ dA cos θ dΩ: `scale` makes that of the light's end one.
    fn check(&self, what: &str, scale: f64, exact: f64) -> [f64; 2] {
        let nothing = Geometry::build(Primitives::default());
        let lights = Lights::new(&nothing, (&[], &[]), &Environment::Black, &[self.light], 0.1);
        let sampler = FieldRegions::new(self.field.clone(), RADIUS, 1);
        let mut random = Random::new(1);
        let (mut sum, mut squares) = (0.0, 0.0);
        for _ in 0..SAMPLES {
            let position = loop {
                let place = RADIUS * random.direction();
                if is_behind(place, self.through) {
                    break place;
                }
            };
            let receiver = Receiver {
                position,
                normal: -position / RADIUS,
                grazing: 0.0,
                both_sides: false,
                on: PrimitiveId::NONE,
            };
            let numbers = [(); 2].map(|()| random.between(0.0, 1.0));
            let Some(sample) = sampler.sample(&lights, &receiver, numbers) else { continue };
            let Incoming::Irradiance(irradiance) = sample.light else { panic!("{:?}", sample.light) };
            let cos = sample.direction.dot(receiver.normal);
            if cos > 0.0 && self.is_plain(position, sample.direction) {
                let flux = f64::from(irradiance.x) * cos * self.field.potential(position).powi(4) * scale;
                sum += flux;
                squares += flux * flux;
            }
        }
        let count = f64::from(SAMPLES);
        let (mean, zone) = (sum / count, PI * RADIUS * RADIUS);
        let error = ((squares / count - mean * mean) / count).sqrt() * zone / exact;
        let ratio = zone * mean / exact;
        println!("{what}: {ratio:.4} ± {error:.4} of the light");
        assert!(error < ERROR, "{what}: too noisy, {error}");
        assert!((ratio - 1.0).abs() < 4.0 * error, "{what}: {ratio} ± {error}");
        [ratio, error]
    }
}

/// Checks that several ratios are 1 on average, with their standard errors.
fn check_all(found: &[[f64; 2]]) {
    let weight: f64 = found.iter().map(|[_, error]| error.powi(-2)).sum();
    let mean = found.iter().map(|[ratio, error]| ratio * error.powi(-2)).sum::<f64>() / weight;
    let error = weight.powf(-0.5);
    println!("all: {mean:.4} ± {error:.4}");
    assert!(error < 0.02 && (mean - 1.0).abs() < 4.0 * error, "{mean} ± {error}");
}

#[test]
fn nothing_is_missed_of_the_light_of_a_point_behind_several_holes() {
    let found = [0, 1, 2, 3].map(|number| {
        let (field, position, through) = scene(number);
        // Intensities are those of the light's own frame, in which lengths are U times those of the chart.
        let scale = field.potential(position).powi(-2);
        let shadow = Shadow::new(field, Punctual::Point { position, intensity: Vec3::ONE }, through);
        let counts = |place: &u32| shadow.counts(position, evenly(*place, RAYS));
        let exact = 4.0 * PI * (0..RAYS).filter(counts).count() as f64 / f64::from(RAYS);
        shadow.check(&format!("point {number}"), scale, exact)
    });
    check_all(&found);
}

#[test]
fn nothing_is_missed_of_a_distant_light_behind_several_holes() {
    let found = [0, 1, 2, 3].map(|number| {
        let (field, _, through) = scene(number);
        let light = Punctual::Distant { direction: through, irradiance: Vec3::ONE };
        let shadow = Shadow::new(field, light, through);
        // A square of parallel rays from so far that the holes have not bent them yet.
        let (a, b) = through.any_orthonormal_pair();
        let (side, half) = (300, 1.5 * RADIUS);
        let counts = |&(i, j): &(i32, i32)| {
            let along = |i: i32| half * (2.0 * f64::from(i) + 1.0 - f64::from(side)) / f64::from(side);
            shadow.counts(along(i) * a + along(j) * b - 1e6 * through, through)
        };
        let rays = (0..side).flat_map(|i| (0..side).map(move |j| (i, j)));
        let exact = (2.0 * half / f64::from(side)).powi(2) * rays.filter(counts).count() as f64;
        shadow.check(&format!("distant {number}"), 1.0, exact)
    });
    check_all(&found);
}
