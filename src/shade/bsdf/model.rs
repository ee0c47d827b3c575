//! A lobe's part of a BSDF: what each of them implements.

use glam::{DVec3, Vec3};

use crate::shade::incidence::{Bounce, Incidence};

/// A scattering lobe.
pub trait Bsdf {
    /// Name in scene files and reports.
    const NAME: &'static str;
    /// True if light from one direction leaves in one or two: next-event estimation cannot choose them.
    const IS_SPECULAR: bool;

    /// Samples a continuation with four numbers in [0, 1); `None` if the path is absorbed. `eta` is the relative index
    /// of refraction across the surface.
    fn sample(&self, incidence: &Incidence, eta: impl FnOnce() -> f64, u: [f32; 4]) -> Option<Bounce>;

    /// BSDF × cosine towards the unit direction `out`, and the density with which [`Self::sample`] chooses it; `None`
    /// where no light goes.
    fn evaluate(&self, _incidence: &Incidence, _out: DVec3) -> Option<(Vec3, f64)> {
        None
    }

    /// Colour in the albedo plane: scattered fraction of the light.
    fn albedo(&self) -> Vec3;

    /// Index of refraction relative to vacuum, if light goes through.
    fn ior(&self) -> Option<f32> {
        None
    }
}
