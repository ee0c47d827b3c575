//! Iridescence: the reflectance of a thin film, as KHR_materials_iridescence has it.
//!
//! Reference: \[B\] Belcour, Barla 2017, "A Practical Extension to Microfacet Theory for the Modeling of Varying
//! Iridescence", ACM TOG 36(4).

use std::f64::consts::{PI, TAU};

use glam::{DVec3, Vec3};

/// Thickness up to which a film fades, nanometres: it is none at 0.
const FADES: f64 = 0.03;

/// Film between air and a base.
#[derive(Clone, Copy, Debug)]
pub struct ThinFilm {
    /// Share of the surface that it covers.
    pub factor: f32,
    /// Index of refraction.
    ior: f64,
    /// Thickness, nanometres.
    thickness: f64,
}

impl ThinFilm {
    /// A film; `None` if it covers nothing.
    #[inline(always)]
    pub fn new(factor: f32, ior: f32, thickness: f32) -> Option<Self> {
        (factor > 0.0).then_some(Self { factor, ior: ior.into(), thickness: thickness.into() })
    }

    /// Reflectance above a base of reflectance `f0` at normal incidence, at a cosine of incidence \[B, eq. 10\].
    pub fn at(&self, cos: f64, f0: Vec3) -> Vec3 {
        let cos = cos.clamp(0.0, 1.0);
        let fade = (self.thickness / FADES).clamp(0.0, 1.0);
        let ior = 1.0 + (self.ior - 1.0) * fade * fade * (3.0 - 2.0 * fade);
        let cos2_inside = 1.0 - (1.0 - cos * cos) / (ior * ior);
        if cos2_inside < 0.0 {
            return Vec3::ONE;
        }
        let cos_inside = cos2_inside.sqrt();
        let upper = schlick(normal_reflectance(ior, 1.0), cos);
        let passes = 1.0 - upper;
        let turned_above = if ior < 1.0 { PI } else { 0.0 };
        let path = 2.0 * ior * self.thickness * cos_inside;

        let mut lower = DVec3::ZERO;
        let mut phase = DVec3::splat(PI - turned_above);
        for channel in 0..3 {
            let root = f64::from(f0[channel]).clamp(0.0, 0.9999).sqrt();
            let base = (1.0 + root) / (1.0 - root);
            lower[channel] = schlick(normal_reflectance(base, ior), cos_inside);
            phase[channel] += if base < ior { PI } else { 0.0 };
        }
        let product = (upper * lower).clamp(DVec3::splat(1e-5), DVec3::splat(0.9999));
        let amplitude = product.map(f64::sqrt);
        let returned = passes * passes * lower / (1.0 - product);
        let mut sum = upper + returned;
        let mut order = returned - passes;
        for m in [1.0, 2.0] {
            order *= amplitude;
            sum += order * 2.0 * sensitivity(m * path, m * phase);
        }
        sum.clamp(DVec3::ZERO, DVec3::ONE).as_vec3()
    }
}

fn normal_reflectance(transmitted: f64, incident: f64) -> f64 {
    let ratio = (transmitted - incident) / (transmitted + incident);
    ratio * ratio
}

fn schlick(f0: f64, cos: f64) -> f64 {
    let x = 1.0 - cos;
    f0 + (1.0 - f0) * x * x * x * x * x
}

/// Response of the eye to light of a path difference, nanometres, and phase shifts: sums of Gaussians, in Rec. 709.
fn sensitivity(path: f64, shift: DVec3) -> DVec3 {
    const VALUE: [f64; 3] = [5.4856e-13, 4.4201e-13, 5.2481e-13];
    const POSITION: [f64; 3] = [1.6810e6, 1.7953e6, 2.2084e6];
    const VARIANCE: [f64; 3] = [4.3278e9, 9.3046e9, 6.6121e9];
    /// Red's second peak.
    const SECOND: [f64; 3] = [9.7470e-14, 2.2399e6, 4.5282e9];
    const WHITE: f64 = 1.0685e-7;
    let phase = TAU * path * 1e-9;
    let peak = |value: f64, position: f64, variance: f64, shift: f64| {
        let gauss = libm::exp(-phase * phase * variance);
        value * (TAU * variance).sqrt() * libm::cos(position * phase + shift) * gauss / WHITE
    };
    let [x, y, z] = [0, 1, 2].map(|i| peak(VALUE[i], POSITION[i], VARIANCE[i], shift[i]));
    let x = x + peak(SECOND[0], SECOND[1], SECOND[2], shift.x);
    DVec3::new(
        3.240_454_2 * x - 1.537_138_5 * y - 0.498_531_4 * z,
        -0.969_266_0 * x + 1.876_010_8 * y + 0.041_556_0 * z,
        0.055_643_4 * x - 0.204_025_9 * y + 1.057_225_2 * z,
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_film_without_thickness_leaves_the_base_as_it_is_at_normal_incidence() {
        let film = ThinFilm::new(1.0, 1.5, 0.0).unwrap();
        for (f0, cos) in [(0.04, 1.0), (0.3, 1.0), (0.9, 1.0)] {
            let with = film.at(cos, Vec3::splat(f0));
            let without = schlick(f0.into(), cos);
            // Amplitudes are bounded from below, which adds 0.6 %.
            assert!((with - without as f32).abs().max_element() < 1e-2, "{f0} {cos}: {with} {without}");
        }
    }

    #[test]
    fn reflectances_of_films_are_bounded_and_coloured() {
        for thickness in [50.0, 150.0, 400.0, 1200.0] {
            for ior in [1.0, 1.3, 1.8, 2.5] {
                let film = ThinFilm::new(1.0, ior, thickness).unwrap();
                for cos in [0.0, 0.01, 0.3, 0.7, 1.0] {
                    let value = film.at(cos, Vec3::new(0.04, 0.5, 1.0));
                    assert!(value.cmpge(Vec3::ZERO).all() && value.cmple(Vec3::ONE).all(), "{value}");
                }
            }
        }
        let film = ThinFilm::new(1.0, 1.3, 400.0).unwrap();
        let value = film.at(0.8, Vec3::splat(0.2));
        assert!(value.max_element() - value.min_element() > 0.05, "{value}");
    }
}
