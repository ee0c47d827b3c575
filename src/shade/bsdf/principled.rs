//! Principled lobe: the metallic–roughness model of glTF 2.0 with its layers.
//!
//! From the top: clear coat, sheen, and a mix of a metal, of a dielectric over a Lambertian, and of a dielectric that
//! light goes through. Formulas are those of the specification (its appendix B, with height-correlated masking) and of
//! its extensions, but for one thing: none gains light. The Lambertian below a dielectric gets 1 − F(V·H), which together
//! with what the dielectric reflects would be up to 1.7 times the light that comes to a smooth white surface at grazing
//! angles; it is dimmed there. So it is not reciprocal at such angles, nor is what lies below a coat, nor the coat; each
//! other layer by itself is, refraction up to η².
//!
//! One part is chosen by what it scatters, and the density is that of all of them. Parts that are smooth scatter into
//! single directions; the lobe's density is then that of the others.
//!
//! Reference: "glTF 2.0 Specification", appendix B; KHR_materials_clearcoat, …_sheen, …_iridescence, …_specular,
//! …_transmission, …_volume, …_anisotropy, …_ior.

use std::f64::consts::PI;

use glam::{DVec3, Vec3};

use super::coat::Coat;
use super::diffuse::sample_cosine;
use super::ggx::Ggx;
use super::interface::Interface;
use super::local_frame::LocalFrame;
use super::mirror::reflect_above;
use super::model::Bsdf;
use super::schlick::{GgxAlbedo, Schlick};
use super::sheen::Sheen;
use super::specular::{Reflector, Specular};
use super::thin_film::ThinFilm;
use super::variation::Variation;
use crate::shade::incidence::{Bounce, Incidence, Response};

/// Metallic–roughness model with its layers. Fractions are in [0, 1], α is the square of a roughness.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Principled {
    /// Base colour: albedo of a dielectric, reflectance of a metal at normal incidence, tint of light that goes
    /// through.
    pub base: Vec3,
    /// Share of metal.
    pub metallic: f32,
    /// Roughness of the base.
    pub roughness: f32,
    /// Share by which α grows towards 1 along the tangent.
    pub anisotropy: f32,
    /// Direction of the anisotropy, any that is not along the normal: in a material in tangent space, x along the
    /// tangent, at a hit in the world.
    pub tangent: DVec3,
    /// Index of refraction relative to vacuum.
    pub ior: f32,
    /// Factor on the reflectance of a dielectric.
    pub specular: f32,
    /// Colour of the reflectance of a dielectric at normal incidence.
    pub specular_color: Vec3,
    /// Share of a dielectric that light goes through.
    pub transmission: f32,
    /// True if that is a wall without thickness.
    pub is_thin: bool,
    /// Share of the surface that is coated.
    pub clearcoat: f32,
    /// Roughness of the coat.
    pub clearcoat_roughness: f32,
    /// Colour of the sheen.
    pub sheen_color: Vec3,
    /// Roughness of the sheen.
    pub sheen_roughness: f32,
    /// Share of the surface that a thin film covers.
    pub iridescence: f32,
    /// Index of refraction of the film.
    pub iridescence_ior: f32,
    /// Thickness of the film, nanometres.
    pub iridescence_thickness: f32,
    /// True if light is given back that microfacets scatter more than once.
    pub multiscatter: bool,
}

impl Principled {
    /// A white, rough dielectric of index 1.5 without layers.
    pub const PLAIN: Self = Self {
        base: Vec3::ONE,
        metallic: 0.0,
        roughness: 1.0,
        anisotropy: 0.0,
        tangent: DVec3::X,
        ior: 1.5,
        specular: 1.0,
        specular_color: Vec3::ONE,
        transmission: 0.0,
        is_thin: true,
        clearcoat: 0.0,
        clearcoat_roughness: 0.0,
        sheen_color: Vec3::ZERO,
        sheen_roughness: 0.0,
        iridescence: 0.0,
        iridescence_ior: 1.3,
        iridescence_thickness: 400.0,
        multiscatter: true,
    };

    /// Microfacets of the base.
    #[inline(always)]
    fn microfacets(&self) -> Option<Ggx> {
        let [roughness, strength] = [self.roughness, self.anisotropy].map(f64::from);
        let across = roughness * roughness;
        Ggx::new(across + (1.0 - across) * strength * strength, across)
    }

    /// Shares of the metal, of the dielectric over a Lambertian, and of that which light goes through.
    #[inline(always)]
    fn shares(&self) -> [f32; 3] {
        let dielectric = 1.0 - self.metallic;
        [self.metallic, dielectric * (1.0 - self.transmission), dielectric * self.transmission]
    }

    /// Reflectance of the dielectric.
    #[inline(always)]
    fn dielectric(&self) -> Schlick {
        let root = (self.ior - 1.0) / (self.ior + 1.0);
        let f0 = (root * root * self.specular_color).min(Vec3::ONE) * self.specular;
        Schlick { f0, f90: self.specular }
    }
}

impl Bsdf for Principled {
    const NAME: &'static str = "principled";

    #[inline(always)]
    fn sample(&self, incidence: &Incidence, u: [f32; 4]) -> Bounce {
        Layers::new(self, incidence).sample(incidence, u.map(f64::from))
    }

    #[inline(always)]
    fn evaluate(&self, incidence: &Incidence, out: DVec3) -> Response {
        Layers::new(self, incidence).evaluate(out)
    }

    #[inline(always)]
    fn scatter(&self, incidence: &Incidence, u: [f32; 4], out: DVec3) -> (Bounce, Response) {
        let layers = Layers::new(self, incidence);
        (layers.sample(incidence, u.map(f64::from)), layers.evaluate(out))
    }

    fn albedo(&self) -> Vec3 {
        let Schlick { f0, .. } = self.dielectric();
        let [metal, opaque, clear] = self.shares();
        let base =
            metal * self.base + opaque * (f0 + (1.0 - f0.max_element()) * self.base) + clear * self.base;
        let cloth = self.sheen_color.max_element();
        let beneath = if cloth > 0.0 { base.max(0.1 * self.sheen_color) } else { base };
        let coat = 0.04 * self.clearcoat;
        coat + (1.0 - coat) * beneath
    }

    fn varied(self, by: &Variation) -> Self {
        Self {
            base: self.base * by.color,
            metallic: self.metallic * by.metallic,
            roughness: self.roughness * by.roughness,
            anisotropy: self.anisotropy * by.anisotropy,
            tangent: by.tangent.unwrap_or(self.tangent),
            specular: self.specular * by.specular,
            specular_color: self.specular_color * by.specular_color,
            transmission: self.transmission * by.transmission,
            clearcoat: self.clearcoat * by.clearcoat,
            clearcoat_roughness: self.clearcoat_roughness * by.clearcoat_roughness,
            sheen_color: self.sheen_color * by.sheen_color,
            sheen_roughness: self.sheen_roughness * by.sheen_roughness,
            iridescence: self.iridescence * by.iridescence,
            iridescence_thickness: by.film_thickness.unwrap_or(self.iridescence_thickness),
            ..self
        }
    }

    fn is_specular(&self) -> bool {
        let spreads = self.shares()[1] > 0.0 && self.base != Vec3::ZERO;
        let coat = Coat::new(self.clearcoat, self.clearcoat_roughness.into(), 1.0);
        let is_coat_rough = coat.is_some_and(|coat| coat.ggx.is_some());
        !spreads && !is_coat_rough && self.sheen_color == Vec3::ZERO && self.microfacets().is_none()
    }

    fn gloss(&self) -> f32 {
        self.metallic
    }

    fn transmits(&self) -> bool {
        self.shares()[2] > 0.0
    }

    fn ior(&self) -> Option<f32> {
        (self.transmits() && !self.is_thin).then_some(self.ior)
    }
}

/// Parts that are chosen among.
#[derive(Clone, Copy, Debug, PartialEq)]
enum LobePart {
    Coat,
    Sheen,
    Specular,
    Diffuse,
    Interface,
}

/// The layers for light from one direction.
struct Layers {
    frame: LocalFrame,
    /// Direction that light comes from, in the frame.
    wi: DVec3,
    coat: Option<Coat>,
    sheen: Option<Sheen>,
    specular: Specular,
    /// Reflected fraction of what comes to the Lambertian.
    diffuse: Vec3,
    /// Interface that light goes through, and a factor on what it scatters.
    interface: Option<(f32, Interface)>,
    /// Probabilities of the parts.
    chances: [f64; LobePart::ALL.len()],
}

impl LobePart {
    const ALL: [Self; 5] = [Self::Coat, Self::Sheen, Self::Specular, Self::Diffuse, Self::Interface];
}

impl Layers {
    #[inline(always)]
    fn new(lobe: &Principled, incidence: &Incidence) -> Self {
        let frame = LocalFrame::new(incidence, (lobe.anisotropy > 0.0).then_some(lobe.tangent));
        let wi = frame.towards(incidence.direction);
        let [metal, opaque, clear] = lobe.shares();
        let ggx = lobe.microfacets();
        let albedo = GgxAlbedo::new(wi.z, ggx.as_ref());
        let reflectors = [
            Reflector { share: metal, fresnel: Schlick { f0: lobe.base, f90: 1.0 } },
            Reflector { share: opaque, fresnel: lobe.dielectric() },
        ];
        let film = ThinFilm::new(lobe.iridescence, lobe.iridescence_ior, lobe.iridescence_thickness);
        let specular = Specular::new(ggx, &albedo, wi.z, (reflectors, film), lobe.multiscatter);
        let diffuse = specular.dims(lobe.base, wi.z);
        let interface = (clear > 0.0).then(|| {
            let eta = if lobe.is_thin { lobe.ior.into() } else { incidence.eta };
            let reflected = (lobe.specular * lobe.specular_color).min(Vec3::ONE);
            // A thin wall scatters to either side as a metal does to one, and loses as much.
            let gives_back = lobe.is_thin && lobe.multiscatter;
            let share = if gives_back { clear / albedo.whole as f32 } else { clear };
            (share, Interface::new(ggx, (lobe.is_thin, eta), reflected, lobe.base))
        });
        let coat = Coat::new(lobe.clearcoat, lobe.clearcoat_roughness.into(), wi.z);
        let sheen = Sheen::new(lobe.sheen_color, lobe.sheen_roughness.into(), wi.z);

        let coated = coat.map_or(0.0, |coat| coat.reflectance);
        let cloth =
            sheen.map_or(0.0, |sheen| (sheen.albedo.min(1.0) as f32) * lobe.sheen_color.max_element());
        let beneath = (1.0 - coated) * (1.0 - cloth);
        let estimates = [
            coated,
            (1.0 - coated) * cloth,
            beneath * specular.albedo().max_element(),
            beneath * diffuse.max_element(),
            beneath * clear,
        ];
        let sum: f32 = estimates.iter().sum();
        let chances = estimates.map(|estimate| if sum > 0.0 { f64::from(estimate / sum) } else { 0.0 });
        Self { frame, wi, coat, sheen, specular, diffuse, interface, chances }
    }

    /// Share of light that gets beneath the coat.
    #[inline(always)]
    fn under_coat(&self) -> f32 {
        1.0 - self.coat.map_or(0.0, |coat| coat.reflectance)
    }

    /// Share of light that gets beneath coat and sheen, and leaves at the cosine of where it comes from.
    #[inline(always)]
    fn under_sheen(&self) -> f32 {
        self.under_coat() * self.sheen.map_or(1.0, |sheen| sheen.leaves(sheen.albedo)) as f32
    }

    #[inline(always)]
    fn chance(&self, part: LobePart) -> f64 {
        self.chances[part as usize]
    }

    /// BSDF × cosine of all parts that spread light, and the density with which one of them is sampled. Light that a
    /// shading normal sends through an opaque surface is reflected by that: none is lost.
    #[inline(always)]
    fn evaluate(&self, out: DVec3) -> Response {
        let wo = self.frame.local(out);
        let response = self.towards(wo, self.frame.side(out, wo));
        let image = if self.interface.is_none() { self.frame.image_below(out) } else { None };
        match image {
            Some(image) if image.z > 0.0 => {
                let reflected = self.towards(image, 1);
                Response {
                    bsdf: response.bsdf + reflected.bsdf,
                    density: response.density + reflected.density,
                }
            }
            Some(_) | None => response,
        }
    }

    /// Response towards a direction in the frame, on this side of the surface.
    #[inline(always)]
    fn towards(&self, wo: DVec3, side: i8) -> Response {
        let wi = self.wi;
        let mut sum = Response::default();
        let mut add = |part: LobePart, factor: f32, Response { bsdf, density }: Response| {
            sum.bsdf += factor * bsdf;
            sum.density += self.chance(part) * density;
        };
        if side == 0 {
            return sum;
        }
        let mut beneath = self.under_coat();
        if side < 0 {
            beneath = self.under_sheen();
        } else {
            let h = (wi + wo).normalize();
            if let Some(coat) = &self.coat {
                add(LobePart::Coat, 1.0, coat.evaluate(wi, wo, h));
            }
            if let Some(sheen) = &self.sheen {
                let (response, leaves) = sheen.evaluate(wi, wo);
                add(LobePart::Sheen, beneath, response);
                beneath *= leaves as f32;
            }
            add(LobePart::Specular, beneath, self.specular.evaluate(wi, wo, h));
            let density = wo.z / PI;
            let passes = self.specular.transmittance(wi.dot(h));
            let bsdf = self.diffuse * (passes * density as f32);
            add(LobePart::Diffuse, beneath, Response { bsdf, density });
        }
        if let Some((share, interface)) = &self.interface {
            add(LobePart::Interface, beneath * share, interface.evaluate(wi, wo));
        }
        sum
    }

    /// Samples a part, chosen by the third number.
    #[inline(always)]
    fn sample(&self, incidence: &Incidence, [u, v, choice, _]: [f64; 4]) -> Bounce {
        let Some((part, choice)) = self.choose(choice) else { return absorbed(incidence) };
        let (wi, under_sheen) = (self.wi, self.under_sheen());
        let chance = self.chance(part) as f32;
        let mirrored = |weight: Vec3| {
            let direction = reflect_above(incidence.direction, incidence.normal, self.frame.z);
            Bounce { direction, weight: weight / chance, density: 0.0, crosses: false }
        };
        let wo = match part {
            LobePart::Coat => match &self.coat {
                Some(Coat { ggx: Some(ggx), .. }) => ggx.sample_reflection(wi, u, v),
                Some(coat) => return mirrored(Vec3::splat(coat.reflectance)),
                None => None,
            },
            LobePart::Sheen => Some(Sheen::sample(u, v)),
            LobePart::Specular => match &self.specular {
                Specular { ggx: Some(ggx), .. } => ggx.sample_reflection(wi, u, v),
                specular => return mirrored(under_sheen * specular.reflectance(wi.z)),
            },
            LobePart::Diffuse => Some(sample_cosine(DVec3::Z, u, v)),
            LobePart::Interface => match &self.interface {
                Some((share, interface)) if interface.is_smooth() => {
                    let (direction, crosses) = interface.pass(incidence, self.frame.z, choice);
                    let weight = (under_sheen * share / chance) * interface.colour(crosses);
                    return Bounce { direction, weight, density: 0.0, crosses };
                }
                Some((_, interface)) => interface.sample(wi, [u, v, choice]),
                None => None,
            },
        };
        let Some(wo) = wo else { return absorbed(incidence) };
        let direction = self.frame.world(wo);
        let direction = if self.interface.is_none() { self.frame.image_above(direction) } else { direction };
        let Response { bsdf, density } = self.evaluate(direction);
        if density <= 0.0 {
            return absorbed(incidence);
        }
        Bounce { direction, weight: bsdf / density as f32, density, crosses: wo.z < 0.0 }
    }

    /// A part, and what is left of the number in [0, 1) that chose it; `None` if nothing scatters.
    #[inline(always)]
    fn choose(&self, number: f64) -> Option<(LobePart, f64)> {
        let (mut rest, mut chosen) = (number, None);
        for part in LobePart::ALL {
            let chance = self.chance(part);
            if chance > 0.0 {
                chosen = Some((part, (rest / chance).min(1f64.next_down())));
                if rest < chance {
                    break;
                }
            }
            rest -= chance;
        }
        chosen
    }
}

/// The end of a path.
#[inline(always)]
fn absorbed(incidence: &Incidence) -> Bounce {
    Bounce { direction: incidence.normal, ..Bounce::default() }
}
