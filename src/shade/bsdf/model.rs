//! A lobe's part of a BSDF: what each of them implements.

use glam::{DVec3, Vec3};

use super::variation::Variation;
use crate::shade::incidence::{Bounce, Incidence, Response};

/// A scattering lobe: a row of parameters and two kernels, which run on one hit or on many side by side.
pub trait Bsdf: Copy + Send + Sync {
    /// Name in scene files and reports.
    const NAME: &'static str;

    /// Samples a continuation with four numbers in [0, 1).
    fn sample(&self, incidence: &Incidence, u: [f32; 4]) -> Bounce;

    /// BSDF × cosine towards the unit direction `out`, and the density with which [`Self::sample`] chooses it; zero
    /// where no light goes, as everywhere but in a single direction of a mirror, and without those parts of a lobe.
    fn evaluate(&self, _incidence: &Incidence, _out: DVec3) -> Response {
        Response::default()
    }

    /// Samples with the numbers `u` and evaluates towards `out`.
    #[inline(always)]
    fn scatter(&self, incidence: &Incidence, u: [f32; 4], out: DVec3) -> (Bounce, Response) {
        (self.sample(incidence, u), self.evaluate(incidence, out))
    }

    /// The lobe as it is at a point of a surface.
    fn varied(self, by: &Variation) -> Self;

    /// Colour in the albedo plane: scattered fraction of the light.
    fn albedo(&self) -> Vec3;

    /// True if light from one direction leaves in one or two and no others: next-event estimation cannot choose them.
    fn is_specular(&self) -> bool;

    /// How little light that it scatters goes by the cosine at which it came: 0 as of a Lambertian, 1 as of a metal, whose
    /// highlights are as bright at any angle.
    fn gloss(&self) -> f32 {
        0.0
    }

    /// True if light leaves on the other side as well.
    fn transmits(&self) -> bool {
        self.ior().is_some()
    }

    /// Index of refraction relative to vacuum, if light enters what is beyond.
    fn ior(&self) -> Option<f32> {
        None
    }
}
