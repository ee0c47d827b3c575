//! Lacquered lobe: a principled one under a coat whose normal is not that of what is beneath, as where a normal map bends
//! one of both. It is a lobe of its own so that others need not know of two normals.
//!
//! Reference: KHR_materials_clearcoat.

use glam::{DVec3, Vec3};

use super::coat::Coat;
use super::local_frame::LocalFrame;
use super::mirror::reflect_above;
use super::model::Bsdf;
use super::principled::Principled;
use super::variation::Variation;
use crate::shade::incidence::{Bounce, Incidence, Response};

/// Principled lobe whose coat has a normal of its own.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lacquered {
    /// The coat and what is beneath.
    pub principled: Principled,
    /// Unit normal of the coat at a hit, in the world; zero where it is that of the surface.
    pub clearcoat_normal: DVec3,
}

/// Least albedo by which what is beneath is chosen: what is black at normal incidence may reflect at others.
const LEAST_BENEATH: f64 = 0.25;

/// The coat and what is beneath for light from one direction.
struct CoatOver {
    frame: LocalFrame,
    /// Direction that light comes from, in the frame of the coat.
    wi: DVec3,
    coat: Coat,
    /// Probability of the coat.
    chance: f64,
    beneath: Principled,
}

impl Bsdf for Lacquered {
    const NAME: &'static str = "lacquered";

    fn sample(&self, incidence: &Incidence, u: [f32; 4]) -> Bounce {
        match CoatOver::new(self, incidence) {
            Some(layers) => layers.sample(incidence, u),
            None => self.principled.sample(incidence, u),
        }
    }

    fn evaluate(&self, incidence: &Incidence, out: DVec3) -> Response {
        match CoatOver::new(self, incidence) {
            Some(layers) => layers.evaluate(incidence, out),
            None => self.principled.evaluate(incidence, out),
        }
    }

    fn varied(self, by: &Variation) -> Self {
        Self { principled: self.principled.varied(by), ..self }
    }

    fn albedo(&self) -> Vec3 {
        self.principled.albedo()
    }

    fn is_specular(&self) -> bool {
        self.principled.is_specular()
    }

    fn gloss(&self) -> f32 {
        self.principled.gloss()
    }

    fn transmits(&self) -> bool {
        self.principled.transmits()
    }

    fn ior(&self) -> Option<f32> {
        self.principled.ior()
    }
}

impl CoatOver {
    /// `None` where there is no coat.
    fn new(lobe: &Lacquered, incidence: &Incidence) -> Option<Self> {
        let Principled { clearcoat, clearcoat_roughness, .. } = lobe.principled;
        let &Incidence { direction, normal, shading_normal, eta } = incidence;
        let has_own = lobe.clearcoat_normal != DVec3::ZERO;
        let of_coat = if has_own { lobe.clearcoat_normal } else { shading_normal };
        let frame = LocalFrame::new(&Incidence::new(direction, normal, of_coat, eta), None);
        let wi = frame.towards(direction);
        let coat = Coat::new(clearcoat, clearcoat_roughness.into(), wi.z)?;
        let beneath = Principled { clearcoat: 0.0, ..lobe.principled };
        let coated = f64::from(coat.reflectance);
        let passes = (1.0 - coated) * f64::from(beneath.albedo().max_element()).max(LEAST_BENEATH);
        Some(Self { frame, wi, coat, chance: coated / (coated + passes), beneath })
    }

    /// Share of light that gets beneath the coat.
    fn passes(&self) -> f32 {
        1.0 - self.coat.reflectance
    }

    fn evaluate(&self, incidence: &Incidence, out: DVec3) -> Response {
        let Response { bsdf, density } = self.beneath.evaluate(incidence, out);
        let coat = self.of_coat(out);
        Response {
            bsdf: self.passes() * bsdf + coat.bsdf,
            density: (1.0 - self.chance) * density + self.chance * coat.density,
        }
    }

    /// Response of the coat. What its normal sends through an opaque surface is reflected by that.
    fn of_coat(&self, out: DVec3) -> Response {
        let towards = |wo: DVec3| self.coat.evaluate(self.wi, wo, (self.wi + wo).normalize());
        let wo = self.frame.local(out);
        let seen = if self.frame.side(out, wo) > 0 { towards(wo) } else { Response::default() };
        let image = if self.beneath.transmits() { None } else { self.frame.image_below(out) };
        match image.filter(|image| image.z > 0.0).map(towards) {
            Some(Response { bsdf, density }) => {
                Response { bsdf: seen.bsdf + bsdf, density: seen.density + density }
            }
            None => seen,
        }
    }

    /// Samples the coat or what is beneath, chosen by the third number.
    fn sample(&self, incidence: &Incidence, [u, v, choice, rest]: [f32; 4]) -> Bounce {
        let chance = self.chance as f32;
        if choice >= chance {
            let choice = ((choice - chance) / (1.0 - chance)).min(1f32.next_down());
            let bounce = self.beneath.sample(incidence, [u, v, choice, rest]);
            if bounce.density == 0.0 {
                return Bounce { weight: self.passes() / (1.0 - chance) * bounce.weight, ..bounce };
            }
            return self.bounce(incidence, bounce.direction, bounce.crosses);
        }
        let Some(ggx) = &self.coat.ggx else {
            let direction = reflect_above(incidence.direction, incidence.normal, self.frame.z);
            let weight = Vec3::splat(self.coat.reflectance / chance);
            return Bounce { direction, weight, density: 0.0, crosses: false };
        };
        let Some(wo) = ggx.sample_reflection(self.wi, u.into(), v.into()) else { return absorbed(incidence) };
        let direction = self.frame.world(wo);
        if !self.beneath.transmits() {
            return self.bounce(incidence, self.frame.image_above(direction), false);
        }
        // What the coat's normal sends through the surface is none of what goes through beneath.
        if self.frame.side(direction, wo) > 0 {
            self.bounce(incidence, direction, false)
        } else {
            absorbed(incidence)
        }
    }

    /// A bounce in a direction that either of both may have chosen.
    fn bounce(&self, incidence: &Incidence, direction: DVec3, crosses: bool) -> Bounce {
        let Response { bsdf, density } = self.evaluate(incidence, direction);
        if density <= 0.0 {
            return absorbed(incidence);
        }
        Bounce { direction, weight: bsdf / density as f32, density, crosses }
    }
}

/// The end of a path.
fn absorbed(incidence: &Incidence) -> Bounce {
    Bounce { direction: incidence.normal, ..Bounce::default() }
}
