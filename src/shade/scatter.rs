//! A bounce: one sampled direction of a material's lobe.

use glam::{DVec3, Vec3};

use super::{Crossing, Lobe, Material, Media, dielectric, diffuse, mirror};

/// Incidence of light on a surface.
#[derive(Clone, Copy, Debug)]
pub struct Incidence {
    /// Unit direction of travel.
    pub direction: DVec3,
    /// Unit geometric normal, towards the front.
    pub normal: DVec3,
    /// Unit shading normal.
    pub shading_normal: DVec3,
    /// Index of the material met.
    pub material: u32,
    /// Dielectrics around the path.
    pub media: Media,
    /// Through what light goes that is refracted.
    pub crossing: Crossing,
}

/// A sampled continuation of a path.
#[derive(Clone, Copy, Debug)]
pub struct Bounce {
    /// Unit direction of travel.
    pub direction: DVec3,
    /// BSDF × cosine / density.
    pub weight: Vec3,
    /// Density of the direction in solid angle; 0 for a lobe of a single direction.
    pub density: f64,
    /// Dielectrics around the path from here on.
    pub media: Media,
}

/// Samples the lobe of `materials[incidence.material]` with four numbers in [0, 1); `None` if the path is absorbed.
pub fn scatter(materials: &[Material], incidence: &Incidence, u: [f32; 4]) -> Option<Bounce> {
    let &Incidence { direction, media, .. } = incidence;
    let (normal, shading) = incidence.facing();
    match materials[incidence.material as usize].lobe {
        Lobe::Diffuse { albedo } => {
            let out = diffuse::sample(shading, u[0].into(), u[1].into());
            // A shading normal can send light through the surface; such paths carry nothing.
            let absorbed = albedo == Vec3::ZERO || out.dot(normal) <= 0.0;
            let density = diffuse::density(shading, out);
            (!absorbed).then_some(Bounce { direction: out, weight: albedo, density, media })
        }
        Lobe::Mirror { reflectance } => {
            let out = reflect_above(direction, normal, shading);
            Some(Bounce { direction: out, weight: reflectance, density: 0.0, media })
        }
        Lobe::Dielectric { tint, .. } => {
            let (out, media) = through_dielectric(materials, incidence, f64::from(u[2]));
            Some(Bounce { direction: out, weight: tint, density: 0.0, media })
        }
    }
}

/// BSDF × cosine towards the unit direction `out`, and the density with which [`scatter`] chooses it; `None` where no
/// light goes, as everywhere but in a single direction of a mirror.
pub fn evaluate(materials: &[Material], incidence: &Incidence, out: DVec3) -> Option<(Vec3, f64)> {
    let (normal, shading) = incidence.facing();
    match materials[incidence.material as usize].lobe {
        Lobe::Diffuse { albedo } => {
            let density = diffuse::density(shading, out);
            (density > 0.0 && out.dot(normal) > 0.0).then(|| (albedo * density as f32, density))
        }
        Lobe::Mirror { .. } | Lobe::Dielectric { .. } => None,
    }
}

impl Incidence {
    /// Geometric and shading normal on the side that the light comes from.
    pub fn facing(&self) -> (DVec3, DVec3) {
        let flip = |n: DVec3, against: DVec3| if n.dot(against) > 0.0 { -n } else { n };
        let normal = flip(self.normal, self.direction);
        (normal, flip(self.shading_normal, -normal))
    }
}

/// Reflection about the shading normal, or about the geometric one where that would go through the surface.
fn reflect_above(direction: DVec3, normal: DVec3, shading: DVec3) -> DVec3 {
    let out = mirror::reflect(direction, shading);
    if out.dot(normal) > 0.0 { out } else { mirror::reflect(direction, normal) }
}

/// Reflects with Fresnel's probability (`choice` below it), else refracts: the weight is 1 either way.
///
/// Radiance is not scaled by η²: the factors of entering and leaving cancel along any path that ends outside, and
/// emitters inside glass are to look as bright as they are set.
fn through_dielectric(materials: &[Material], incidence: &Incidence, choice: f64) -> (DVec3, Media) {
    let &Incidence { direction, media, crossing: Crossing { from, into }, .. } = incidence;
    let (normal, shading) = incidence.facing();
    let eta = index(materials, into.current()) / index(materials, from);
    for normal_used in [shading, normal] {
        let cos_i = -direction.dot(normal_used);
        if cos_i <= 0.0 {
            continue;
        }
        let refracted = refract_if_chosen(direction, normal_used, eta, choice);
        match refracted {
            Some(out) if out.dot(normal) < 0.0 => return (out, into),
            None => return (reflect_above(direction, normal, normal_used), media),
            Some(_) => {}
        }
    }
    (reflect_above(direction, normal, normal), media)
}

fn refract_if_chosen(direction: DVec3, normal: DVec3, eta: f64, choice: f64) -> Option<DVec3> {
    let reflectance = dielectric::fresnel(eta, -direction.dot(normal));
    if choice < reflectance { None } else { dielectric::refract(direction, normal, eta) }
}

fn index(materials: &[Material], medium: Option<u32>) -> f64 {
    match medium.map(|m| materials[m as usize].lobe) {
        Some(Lobe::Dielectric { ior, .. }) => f64::from(ior),
        _ => 1.0,
    }
}
