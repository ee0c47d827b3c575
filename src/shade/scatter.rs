//! A bounce: one sampled direction of a material's lobe.

use glam::{DVec3, Vec3};

use super::incidence::{Bounce, Incidence};
use super::material::Material;

/// Samples the lobe of `materials[incidence.material]` with four numbers in [0, 1); `None` if the path is absorbed.
pub fn scatter(materials: &[Material], incidence: &Incidence, u: [f32; 4]) -> Option<Bounce> {
    let eta = || {
        let crossing = incidence.crossing;
        index(materials, crossing.into.current()) / index(materials, crossing.from)
    };
    materials[incidence.material as usize].lobe.sample(incidence, eta, u)
}

/// BSDF × cosine towards the unit direction `out`, and the density with which [`scatter`] chooses it; `None` where no
/// light goes, as everywhere but in a single direction of a mirror.
pub fn evaluate(materials: &[Material], incidence: &Incidence, out: DVec3) -> Option<(Vec3, f64)> {
    materials[incidence.material as usize].lobe.evaluate(incidence, out)
}

/// Index of refraction of a medium, 1 of none.
fn index(materials: &[Material], medium: Option<u32>) -> f64 {
    medium.and_then(|medium| materials[medium as usize].lobe.ior()).map_or(1.0, f64::from)
}
