//! Interface that light goes through: of solid glass, which refracts, or of a thin wall, which blurs.
//!
//! Radiance is not scaled by η², as for smooth glass.
//!
//! Reference: \[W\] Walter, Marschner, Li, Torrance 2007, "Microfacet Models for Refraction through Rough Surfaces".

use glam::{DVec3, Vec3};

use super::dielectric::{fresnel, pass};
use super::ggx::Ggx;
use super::mirror::reflect_above;
use crate::shade::incidence::{Incidence, Response};

/// Differences of the index below which light goes straight on.
const ALIKE: f64 = 1e-4;

/// Interface for light from one direction; vectors are in a local frame.
#[derive(Clone, Copy, Debug)]
pub struct Interface {
    /// Microfacets; `None`: smooth.
    ggx: Option<Ggx>,
    /// True for a wall without thickness.
    is_thin: bool,
    /// Index of refraction beyond, relative to that before.
    eta: f64,
    /// Factor on Fresnel's reflectance.
    reflected: Vec3,
    /// Factor on transmitted light.
    transmitted: Vec3,
}

impl Interface {
    /// Interface with these microfacets, and factors on what it reflects and transmits.
    #[inline(always)]
    pub fn new(ggx: Option<Ggx>, (is_thin, eta): (bool, f64), reflected: Vec3, transmitted: Vec3) -> Self {
        let is_there = is_thin || (eta - 1.0).abs() > ALIKE;
        Self { ggx: ggx.filter(|_| is_there), is_thin, eta, reflected, transmitted }
    }

    /// True if light leaves it in one or two directions.
    #[inline(always)]
    pub fn is_smooth(&self) -> bool {
        self.ggx.is_none()
    }

    /// Sends light on about a normal of a smooth interface, with a number in [0, 1) to choose between both sides: the
    /// direction, and if it crosses the surface.
    #[inline(always)]
    pub fn pass(&self, incidence: &Incidence, normal: DVec3, choice: f64) -> (DVec3, bool) {
        let &Incidence { direction, normal: geometric, .. } = incidence;
        if !self.is_thin {
            // As often as the reflectance that is left of Fresnel's says, which total reflection keeps whole.
            return pass(incidence, choice / f64::from(self.reflected.max_element()));
        }
        if choice < self.reflects(-direction.dot(normal)).0 {
            (reflect_above(direction, geometric, normal), false)
        } else {
            (direction, true)
        }
    }

    /// Factor on light that crosses a smooth interface, or does not.
    #[inline(always)]
    pub fn colour(&self, crosses: bool) -> Vec3 {
        let most = self.reflected.max_element();
        match crosses {
            true => self.transmitted,
            false if most > 0.0 => self.reflected / most,
            false => Vec3::ONE,
        }
    }

    /// Probability and colour of reflection at a cosine to the facet; all of it in total reflection.
    #[inline(always)]
    fn reflects(&self, cos: f64) -> (f64, Vec3) {
        let fresnel = fresnel(self.eta, cos.clamp(0.0, 1.0));
        let chance = if fresnel >= 1.0 { 1.0 } else { fresnel * f64::from(self.reflected.max_element()) };
        (chance, self.colour(false))
    }

    /// BSDF × cosine and density; none of a smooth interface.
    #[inline(always)]
    pub fn evaluate(&self, wi: DVec3, wo: DVec3) -> Response {
        let Some(ggx) = self.ggx else { return Response::default() };
        let is_reflected = wo.z > 0.0;
        // A thin wall transmits the mirror image of what it reflects.
        let image = if self.is_thin && !is_reflected { DVec3 { z: -wo.z, ..wo } } else { wo };
        let bends = !self.is_thin && !is_reflected;
        let across = if bends { -(wi + self.eta * wo) } else { wi + image };
        let h = across.normalize_or(DVec3::Z);
        let h = if h.z < 0.0 { -h } else { h };
        let (cos_i, cos_o) = (wi.dot(h), image.dot(h));
        if cos_i <= 0.0 || (bends && cos_o >= 0.0) {
            return Response::default();
        }
        let jacobian = if bends {
            // [W, eq. 17]
            let sum = cos_i + self.eta * cos_o;
            self.eta * self.eta * -cos_o / (sum * sum)
        } else {
            0.25 / cos_i
        };
        let (chance, colour) = self.reflects(cos_i);
        let (share, colour) = if is_reflected { (chance, colour) } else { (1.0 - chance, self.transmitted) };
        let density = share * ggx.visible(wi, h) * jacobian;
        Response { bsdf: colour * (density * ggx.unshadowed(wi, wo)) as f32, density }
    }

    /// A direction, from two numbers in [0, 1) for a facet and one to choose between both sides; `None` if it is on the
    /// wrong one.
    #[inline(always)]
    pub fn sample(&self, wi: DVec3, [u, v, choice]: [f64; 3]) -> Option<DVec3> {
        let h = self.ggx.map_or(DVec3::Z, |ggx| ggx.sample_visible(wi, u, v));
        let cos = wi.dot(h);
        let image = 2.0 * cos * h - wi;
        if choice < self.reflects(cos).0 {
            return (image.z > 0.0).then_some(image);
        }
        let wo = if self.is_thin {
            DVec3 { z: -image.z, ..image }
        } else {
            let cos_t = (1.0 - (1.0 - cos * cos) / (self.eta * self.eta)).max(0.0).sqrt();
            (cos / self.eta - cos_t) * h - wi / self.eta
        };
        (wo.z < 0.0).then_some(wo)
    }
}
