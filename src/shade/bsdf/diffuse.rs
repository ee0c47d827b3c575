//! Lambertian reflection.

use glam::{DVec3, Vec3};

use super::model::Bsdf;
use super::variation::Variation;
use crate::math::columns::columns;
use crate::math::concentric::concentric;
use crate::math::frame::tangents;
use crate::math::sin_cos_turns;
use crate::shade::incidence::{Bounce, Incidence, Response};

columns! {
    /// Lambertian reflection, both sides.
    #[derive(PartialEq)]
    pub struct Diffuse => DiffuseBlock {
        /// Reflected fraction of the irradiance, in [0, 1] per channel.
        albedo: Vec3,
    }
}

impl Bsdf for Diffuse {
    const NAME: &'static str = "diffuse";

    #[inline(always)]
    fn sample(&self, incidence: &Incidence, u: [f32; 4]) -> Bounce {
        let direction = sample_cosine(incidence.shading_normal, u[0].into(), u[1].into());
        // A shading normal can send light through the surface, which reflects it: no light is lost.
        let height = direction.dot(incidence.normal);
        let direction = direction - 2.0 * height.min(0.0) * incidence.normal;
        let passed = if height != 0.0 { 1.0 } else { 0.0 };
        let density = reflected_density(incidence, direction, height.abs());
        Bounce { direction, weight: passed * self.albedo, density, crosses: false }
    }

    #[inline(always)]
    fn evaluate(&self, incidence: &Incidence, out: DVec3) -> Response {
        let height = out.dot(incidence.normal);
        let density = if height > 0.0 { reflected_density(incidence, out, height) } else { 0.0 };
        Response { bsdf: self.albedo * density as f32, density }
    }

    fn varied(self, &Variation { color, .. }: &Variation) -> Self {
        Self { albedo: color * self.albedo }
    }

    fn albedo(&self) -> Vec3 {
        self.albedo
    }

    fn is_specular(&self) -> bool {
        false
    }
}

/// A direction around the unit vector `normal` with density cos θ/π, from two numbers in [0, 1).
///
/// The throughput of a cosine-sampled Lambertian bounce is the albedo alone.
#[inline(always)]
pub fn sample_cosine(normal: DVec3, u: f64, v: f64) -> DVec3 {
    let (tangent, bitangent) = tangents(normal);
    let [square, turns] = concentric(u, v);
    let (sin, cos) = sin_cos_turns::sin_cos(turns);
    square.sqrt() * (cos * tangent + sin * bitangent) + (1.0 - square).sqrt() * normal
}

/// Density of a direction at a height above the surface, in solid angle: its own and that of its mirror image below.
#[inline(always)]
fn reflected_density(incidence: &Incidence, direction: DVec3, height: f64) -> f64 {
    let Incidence { normal, shading_normal, .. } = incidence;
    let cos = shading_normal.dot(direction);
    let below = cos - 2.0 * height * shading_normal.dot(*normal);
    (cos.max(0.0) + below.max(0.0)) / std::f64::consts::PI
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_mean_cosine_of_cosine_sampled_directions_is_two_thirds() {
        let normal = DVec3::new(0.48, -0.6, 0.64);
        let n = 200;
        let mut mean = 0.0;
        for i in 0..n * n {
            let (u, v) = ((i / n) as f64 + 0.5, (i % n) as f64 + 0.5);
            let direction = sample_cosine(normal, u / n as f64, v / n as f64);
            assert!((direction.length() - 1.0).abs() < 1e-14);
            mean += direction.dot(normal);
        }
        // The midpoint rule converges as slowly as the cosine falls at the edge of the disk.
        assert!((mean / (n * n) as f64 - 2.0 / 3.0).abs() < 5e-4);
    }

    #[test]
    fn a_shading_normal_reflects_what_it_would_send_through_the_surface() {
        let white = Diffuse { albedo: Vec3::ONE };
        let incidence = Incidence::new(DVec3::NEG_Z, DVec3::Z, DVec3::new(0.8, 0.0, 0.6), 1.0);
        let n = 200;
        let mut whole = 0.0;
        for i in 0..n * n {
            let [u, v] = [i / n, i % n].map(|index| (f64::from(index) + 0.5) / f64::from(n));
            // Evenly over the hemisphere.
            let (sin, cos) = sin_cos_turns::sin_cos(v);
            let radius = (1.0 - u * u).sqrt();
            let Response { bsdf, density } =
                white.evaluate(&incidence, DVec3::new(radius * cos, radius * sin, u));
            assert_eq!(bsdf.x, density as f32);
            whole += density * std::f64::consts::TAU / f64::from(n * n);
            let bounce = white.sample(&incidence, [u as f32, v as f32, 0.0, 0.0]);
            assert!(bounce.direction.z > 0.0 && bounce.weight == Vec3::ONE);
            let again = white.evaluate(&incidence, bounce.direction).density;
            assert!((bounce.density - again).abs() < 1e-12, "{} {again}", bounce.density);
        }
        assert!((whole - 1.0).abs() < 1e-3, "{whole}");
    }
}
