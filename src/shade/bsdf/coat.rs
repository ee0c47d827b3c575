//! Clear coat: a layer of varnish of index 1.5, as KHR_materials_clearcoat has it.
//!
//! It reflects by the angle to its facets, and the base beneath gets what is left seen from where light comes from:
//! neither gains nor loses light, and the base is not reciprocal by as much. The extension has both by the angle to
//! the normal.

use glam::{DVec3, Vec3};

use super::ggx::Ggx;
use super::schlick::{GgxAlbedo, Schlick};
use crate::shade::incidence::Response;

/// Reflectance of varnish.
const VARNISH: Schlick = Schlick { f0: Vec3::splat(0.04), f90: 1.0 };

/// Coat for light from one direction; vectors are in a local frame.
#[derive(Clone, Copy, Debug)]
pub struct Coat {
    /// Share of the surface that it covers.
    weight: f32,
    /// Microfacets; `None`: smooth.
    pub ggx: Option<Ggx>,
    /// Reflected share of light.
    pub albedo: f32,
}

impl Coat {
    /// A coat of a roughness for light at a cosine `mu`; `None` if it covers nothing.
    #[inline(always)]
    pub fn new(weight: f32, roughness: f64, mu: f64) -> Option<Self> {
        let ggx = Ggx::isotropic(roughness * roughness);
        (weight > 0.0).then(|| {
            let albedo = VARNISH.albedo(&GgxAlbedo::new(mu, ggx.as_ref()));
            Self { weight, ggx, albedo: weight * albedo.x }
        })
    }

    /// Reflectance at a cosine to the facet.
    #[inline(always)]
    pub fn reflectance(&self, cos: f64) -> Vec3 {
        self.weight * VARNISH.at(cos)
    }

    /// BRDF × cosine and density; none of a smooth one.
    #[inline(always)]
    pub fn evaluate(&self, wi: DVec3, wo: DVec3) -> Response {
        let Some(ggx) = self.ggx else { return Response::default() };
        let (cos, density, whole) = ggx.reflection(wi, wo);
        Response { bsdf: self.reflectance(cos) * whole as f32, density }
    }
}
