//! Reflection of metals and of opaque dielectrics, mixed.

use glam::{DVec3, Vec3};

use super::ggx::Ggx;
use super::schlick::{GgxAlbedo, Schlick};
use super::thin_film::ThinFilm;
use crate::shade::incidence::Response;

/// Places of both in the mix.
const METAL: usize = 0;
const DIELECTRIC: usize = 1;

/// One of both in the mix.
#[derive(Clone, Copy, Debug)]
pub struct Reflector {
    /// Share in the mix.
    pub share: f32,
    /// Reflectance of its facets.
    pub fresnel: Schlick,
}

/// Reflection for light from one direction; vectors are in a local frame.
#[derive(Clone, Copy, Debug)]
pub struct Specular {
    /// Microfacets; `None`: a mirror.
    pub ggx: Option<Ggx>,
    /// A metal and a dielectric.
    reflectors: [Reflector; 2],
    /// Factors on what they reflect, for light that is scattered more than once.
    compensations: [Vec3; 2],
    film: Option<ThinFilm>,
    /// Directional albedos of both, not weighted by their shares.
    albedos: [Vec3; 2],
}

impl Specular {
    /// Microfacets with these albedos that reflect as a mix of a metal and a dielectric does.
    #[inline(always)]
    pub fn new(
        ggx: Option<Ggx>,
        albedo: &GgxAlbedo,
        mu: f64,
        (reflectors, film): ([Reflector; 2], Option<ThinFilm>),
        is_compensated: bool,
    ) -> Self {
        let compensations = reflectors
            .map(|reflector| if is_compensated { reflector.fresnel.compensation(albedo) } else { Vec3::ONE });
        let single = reflectors.map(|Reflector { fresnel, .. }| {
            let bare = fresnel.albedo(albedo);
            film.map_or(bare, |film| bare.lerp(film.at(mu, fresnel.f0) * albedo.whole as f32, film.factor))
        });
        let albedos = [METAL, DIELECTRIC].map(|index| (compensations[index] * single[index]).min(Vec3::ONE));
        Self { ggx, reflectors, compensations, film, albedos }
    }

    /// Reflected share of light.
    #[inline(always)]
    pub fn albedo(&self) -> Vec3 {
        self.albedos[METAL] * self.reflectors[METAL].share
            + self.albedos[DIELECTRIC] * self.reflectors[DIELECTRIC].share
    }

    /// Albedo of the Lambertian below the dielectric, of one of `base` by itself: no more than gains no light, for light
    /// at the cosine `mu`.
    #[inline(always)]
    pub fn dims(&self, base: Vec3, mu: f64) -> Vec3 {
        let Reflector { share, fresnel } = self.reflectors[DIELECTRIC];
        let passes = if self.film.is_some() { 1.0 } else { fresnel.passes(mu) };
        share * base.min(Vec3::splat((1.0 - self.albedos[DIELECTRIC].max_element()) / passes))
    }

    /// Share of light that passes a facet of the dielectric at a cosine.
    #[inline(always)]
    pub fn transmittance(&self, cos: f64) -> f32 {
        1.0 - self.facet(DIELECTRIC, cos).max_element()
    }

    /// Reflectance at a cosine to the facet.
    #[inline(always)]
    pub fn reflectance(&self, cos: f64) -> Vec3 {
        let of =
            |index: usize| self.reflectors[index].share * self.compensations[index] * self.facet(index, cos);
        of(METAL) + of(DIELECTRIC)
    }

    /// That of facets of one of both.
    #[inline(always)]
    fn facet(&self, index: usize, cos: f64) -> Vec3 {
        let fresnel = self.reflectors[index].fresnel;
        let bare = fresnel.at(cos);
        self.film.map_or(bare, |film| bare.lerp(film.at(cos, fresnel.f0), film.factor))
    }

    /// BRDF × cosine and density, `h` halfway between both directions; none of a mirror.
    #[inline(always)]
    pub fn evaluate(&self, wi: DVec3, wo: DVec3, h: DVec3) -> Response {
        let Some(ggx) = self.ggx else { return Response::default() };
        let [density, whole] = ggx.reflection(wi, wo, h);
        Response { bsdf: self.reflectance(wi.dot(h)) * whole as f32, density }
    }
}
