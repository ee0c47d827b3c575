//! Smooth dielectric: Fresnel's reflectance and Snell's refraction.
//!
//! Reference: \[P\] Pharr, Jakob, Humphreys, "Physically Based Rendering", 4th ed., 9.3–9.5.

use glam::{DVec3, Vec3};

use super::mirror::reflect_above;
use super::model::Bsdf;
use super::variation::Variation;
use crate::shade::incidence::{Bounce, Incidence};

/// Smooth dielectric with exact unpolarised Fresnel reflectance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dielectric {
    /// Index of refraction relative to vacuum.
    pub ior: f32,
    /// Factor on reflected and transmitted radiance.
    pub tint: Vec3,
}

impl Bsdf for Dielectric {
    const NAME: &'static str = "dielectric";

    #[inline(always)]
    fn sample(&self, incidence: &Incidence, u: [f32; 4]) -> Bounce {
        let (direction, crosses) = pass(incidence, u[2].into());
        Bounce { direction, weight: self.tint, density: 0.0, crosses }
    }

    fn varied(self, &Variation { color, .. }: &Variation) -> Self {
        Self { tint: color * self.tint, ..self }
    }

    fn albedo(&self) -> Vec3 {
        self.tint
    }

    fn is_specular(&self) -> bool {
        true
    }

    fn ior(&self) -> Option<f32> {
        Some(self.ior)
    }
}

/// Reflects with Fresnel's probability (`choice` below it), else refracts, which is told: the weight is 1 either way.
///
/// Radiance is not scaled by η²: the factors of entering and leaving cancel along any path that ends outside, and
/// emitters inside glass are to look as bright as they are set.
pub(super) fn pass(incidence: &Incidence, choice: f64) -> (DVec3, bool) {
    let &Incidence { direction, normal, shading_normal, eta } = incidence;
    for normal_used in [shading_normal, normal] {
        let cos_i = -direction.dot(normal_used);
        if cos_i <= 0.0 {
            continue;
        }
        let refracted = refract_if_chosen(direction, normal_used, eta, choice);
        match refracted {
            Some(out) if out.dot(normal) < 0.0 => return (out, true),
            None => return (reflect_above(direction, normal, normal_used), false),
            Some(_) => {}
        }
    }
    (reflect_above(direction, normal, normal), false)
}

fn refract_if_chosen(direction: DVec3, normal: DVec3, eta: f64, choice: f64) -> Option<DVec3> {
    let reflectance = fresnel(eta, -direction.dot(normal));
    if choice < reflectance { None } else { refract(direction, normal, eta) }
}

/// Unpolarised Fresnel reflectance for relative index `eta` = n_transmitted / n_incident and cosine of incidence in
/// [0, 1]; 1 beyond the critical angle \[P, eq. 9.6\].
pub fn fresnel(eta: f64, cos_i: f64) -> f64 {
    let sin2_t = (1.0 - cos_i * cos_i) / (eta * eta);
    if sin2_t >= 1.0 {
        return 1.0;
    }
    let cos_t = (1.0 - sin2_t).sqrt();
    let s = (cos_i - eta * cos_t) / (cos_i + eta * cos_t);
    let p = (eta * cos_i - cos_t) / (eta * cos_i + cos_t);
    0.5 * (s * s + p * p)
}

/// The refracted direction of `direction` at a surface whose unit normal faces the incident side; `None` on total
/// internal reflection.
fn refract(direction: DVec3, normal: DVec3, eta: f64) -> Option<DVec3> {
    let cos_i = -direction.dot(normal);
    let cos2_t = 1.0 - (1.0 - cos_i * cos_i) / (eta * eta);
    if cos2_t <= 0.0 {
        return None;
    }
    (direction / eta + (cos_i / eta - cos2_t.sqrt()) * normal).try_normalize()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn refraction_obeys_snell_and_is_reversible() {
        let normal = DVec3::Y;
        for (eta, degrees) in [(1.5, 30.0f64), (1.5, 80.0), (1.0 / 1.5, 30.0), (1.0, 45.0)] {
            let angle = degrees.to_radians();
            let incident = DVec3::new(angle.sin(), -angle.cos(), 0.0);
            let out = refract(incident, normal, eta).expect("below the critical angle");
            assert!((out.x * eta - incident.x).abs() < 1e-15);
            let back = refract(-out, -normal, 1.0 / eta).expect("reversible");
            assert!((back + incident).length() < 1e-14);
        }
        let grazing = DVec3::new(0.8, -0.6, 0.0);
        assert_eq!(refract(grazing, normal, 1.0 / 1.5), None);
    }
}
