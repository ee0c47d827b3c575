//! Sheen of cloth: fibres that stand up, as KHR_materials_sheen has them.
//!
//! The published formulas reflect more than all light at grazing angles where the roughness is below 0.3: there they
//! are dimmed, alike in both directions, so that none is gained.
//!
//! Reference: \[E\] Estevez, Kulla 2017, "Production Friendly Microfacet Sheen BRDF".

use std::f64::consts::{PI, TAU};
use std::sync::LazyLock;

use glam::{DVec3, Vec3};

use super::albedo_table::AlbedoTable;
use crate::math::quadrature::gauss_legendre;
use crate::math::sin_cos_turns;
use crate::shade::incidence::Response;

/// Least roughness: below it, fibres shine at angles of less than a degree only.
const SMOOTHEST: f64 = 0.1;
/// Quadrature nodes by cosine and, for half of a turn, by azimuth.
const POLAR: usize = 32;
const AZIMUTHAL: usize = 16;

/// Sheen above a base, for light from one direction; vectors are in a local frame.
#[derive(Clone, Copy, Debug)]
pub struct Sheen {
    color: Vec3,
    fibres: Fibres,
    roughness: f64,
    /// Directional albedo without colour.
    pub albedo: f64,
}

impl Sheen {
    /// Sheen of a colour and roughness for light at a cosine `mu`; `None` if black.
    #[inline(always)]
    pub fn new(color: Vec3, roughness: f64, mu: f64) -> Option<Self> {
        if color == Vec3::ZERO {
            return None;
        }
        let roughness = roughness.max(SMOOTHEST);
        Some(Self { color, fibres: Fibres::new(roughness), roughness, albedo: albedo(mu, roughness) })
    }

    /// Share of light at a cosine that is left to the base.
    #[inline(always)]
    pub fn leaves(&self, albedo: f64) -> f64 {
        1.0 - f64::from(self.color.max_element()) * albedo.min(1.0)
    }

    /// BRDF × cosine, its density, and the share of light that is left to the base \[E, eqs. 2, 3\].
    #[inline(always)]
    pub fn evaluate(&self, wi: DVec3, wo: DVec3) -> (Response, f64) {
        let most = self.albedo.max(albedo(wo.z, self.roughness));
        let lambdas = [wi.z, wo.z].map(|cos| self.fibres.lambda(cos));
        let brdf = self.fibres.brdf_cos(wi, wo, lambdas) / most.max(1.0);
        (Response { bsdf: self.color * brdf as f32, density: 1.0 / TAU }, self.leaves(most))
    }

    /// An even direction above the surface, from two numbers in [0, 1).
    #[inline(always)]
    pub fn sample(u: f64, v: f64) -> DVec3 {
        let (sin, cos) = sin_cos_turns::sin_cos(u);
        let across = (v * (2.0 - v)).sqrt();
        DVec3::new(across * cos, across * sin, 1.0 - v)
    }
}

/// Directional albedo at a cosine to the normal, as published.
#[inline(always)]
fn albedo(mu: f64, roughness: f64) -> f64 {
    ALBEDO.at(mu, (roughness - SMOOTHEST) / (1.0 - SMOOTHEST))[0]
}

static ALBEDO: LazyLock<AlbedoTable<1>> = LazyLock::new(|| {
    let unit = |(x, weight)| (0.5 + 0.5 * x, 0.5 * weight);
    let [polar, azimuthal] = [POLAR, AZIMUTHAL]
        .map(|count| gauss_legendre(count).into_iter().map(unit).collect::<Vec<(f64, f64)>>());
    let azimuths: Vec<_> =
        azimuthal.into_iter().map(|(azimuth, weight)| (libm::sincos(PI * azimuth), weight)).collect();
    AlbedoTable::new(|mu, above| {
        let (mu, fibres) = (mu.max(1e-4), Fibres::new(SMOOTHEST + above * (1.0 - SMOOTHEST)));
        let wi = DVec3::new((1.0 - mu * mu).sqrt(), 0.0, mu);
        let (masked, mut sum) = (fibres.lambda(mu), 0.0);
        for (z, weight_z) in &polar {
            let (across, shadowed) = ((1.0 - z * z).sqrt(), fibres.lambda(*z));
            for ((sin, cos), weight) in &azimuths {
                let wo = DVec3::new(across * cos, across * sin, *z);
                sum += TAU * weight_z * weight * fibres.brdf_cos(wi, wo, [masked, shadowed]);
            }
        }
        [sum]
    })
});

/// Fibres of a roughness.
#[derive(Clone, Copy, Debug)]
struct Fibres {
    /// 1/α.
    exponent: f64,
    /// Coefficients a to e of the fit of Λ \[E, table 1\].
    fit: [f64; 5],
    /// That at a cosine of one half.
    half: f64,
}

impl Fibres {
    #[inline(always)]
    fn new(roughness: f64) -> Self {
        const SMOOTH: [f64; 5] = [25.3245, 3.32435, 0.16801, -1.27393, -4.85967];
        const ROUGH: [f64; 5] = [21.5473, 3.82987, 0.19823, -1.97760, -4.32054];
        let alpha = roughness * roughness;
        let smooth = (1.0 - alpha) * (1.0 - alpha);
        let fit = std::array::from_fn(|i| ROUGH[i] + smooth * (SMOOTH[i] - ROUGH[i]));
        Self { exponent: 1.0 / alpha, fit, half: curve(&fit, 0.5) }
    }

    /// D V cos of the way out, with Λ of both directions.
    #[inline(always)]
    fn brdf_cos(&self, wi: DVec3, wo: DVec3, [masked, shadowed]: [f64; 2]) -> f64 {
        let h = (wi + wo).normalize();
        let sin = (h.x * h.x + h.y * h.y).sqrt();
        let normals = (2.0 + self.exponent) * libm::pow(sin, self.exponent) / TAU;
        normals / ((1.0 + masked + shadowed) * 4.0 * wi.z)
    }

    #[inline(always)]
    fn lambda(&self, cos: f64) -> f64 {
        let exponent =
            if cos < 0.5 { curve(&self.fit, cos) } else { 2.0 * self.half - curve(&self.fit, 1.0 - cos) };
        libm::exp(exponent)
    }
}

#[inline(always)]
fn curve([a, b, c, d, e]: &[f64; 5], x: f64) -> f64 {
    a / (1.0 + b * libm::pow(x.max(0.0), *c)) + d * x + e
}
