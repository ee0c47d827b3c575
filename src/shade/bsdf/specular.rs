//! Reflection of metals and of opaque dielectrics, mixed.

use glam::{DVec3, Vec3};

use super::ggx::Ggx;
use super::schlick::{GgxAlbedo, Schlick};
use super::thin_film::ThinFilm;
use crate::shade::incidence::Response;

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
        let albedos = [0, 1].map(|index| (compensations[index] * single[index]).min(Vec3::ONE));
        Self { ggx, reflectors, compensations, film, albedos }
    }

    /// Reflected share of light.
    #[inline(always)]
    pub fn albedo(&self) -> Vec3 {
        self.albedos[0] * self.reflectors[0].share + self.albedos[1] * self.reflectors[1].share
    }

    /// Share of light that goes on into the dielectric.
    #[inline(always)]
    pub fn passes(&self) -> f32 {
        self.reflectors[1].share * (1.0 - self.albedos[1].max_element())
    }

    /// Reflectance at a cosine to the facet.
    #[inline(always)]
    pub fn reflectance(&self, cos: f64) -> Vec3 {
        let of = |index: usize| {
            let Reflector { share, fresnel } = self.reflectors[index];
            let bare = fresnel.at(cos);
            let coloured = self.film.map_or(bare, |film| bare.lerp(film.at(cos, fresnel.f0), film.factor));
            share * self.compensations[index] * coloured
        };
        of(0) + of(1)
    }

    /// BRDF × cosine and density; none of a mirror.
    #[inline(always)]
    pub fn evaluate(&self, wi: DVec3, wo: DVec3) -> Response {
        let Some(ggx) = self.ggx else { return Response::default() };
        let (cos, density, whole) = ggx.reflection(wi, wo);
        Response { bsdf: self.reflectance(cos) * whole as f32, density }
    }
}
