//! Clear coat: a layer of varnish of index 1.5, as KHR_materials_clearcoat has it.
//!
//! What it reflects goes by the angle between its normal and the direction that light comes from, and the base beneath
//! gets the rest. So neither gains light, and neither is reciprocal.

use glam::{DVec3, Vec3};

use super::ggx::Ggx;
use super::schlick::Schlick;
use crate::shade::incidence::Response;

/// Reflectance of varnish.
const VARNISH: Schlick = Schlick { f0: Vec3::splat(0.04), f90: 1.0 };

/// Coat for light from one direction; vectors are in a local frame.
#[derive(Clone, Copy, Debug)]
pub struct Coat {
    /// Microfacets; `None`: smooth.
    pub ggx: Option<Ggx>,
    /// Share of light that does not get beneath.
    pub reflectance: f32,
}

impl Coat {
    /// A coat of a roughness, on a share of the surface, for light at a cosine `mu`; `None` if it covers nothing.
    #[inline(always)]
    pub fn new(share: f32, roughness: f64, mu: f64) -> Option<Self> {
        (share > 0.0).then(|| Self {
            ggx: Ggx::isotropic(roughness * roughness),
            reflectance: share * VARNISH.at(mu).x,
        })
    }

    /// BRDF × cosine and density, `h` halfway between both directions; none of a smooth one.
    #[inline(always)]
    pub fn evaluate(&self, wi: DVec3, wo: DVec3, h: DVec3) -> Response {
        let Some(ggx) = self.ggx else { return Response::default() };
        let [density, whole] = ggx.reflection(wi, wo, h);
        Response { bsdf: Vec3::splat(self.reflectance * whole as f32), density }
    }
}
