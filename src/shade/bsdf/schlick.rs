//! Schlick's Fresnel curve, and what single scattering by GGX microfacets makes of it.

use std::sync::LazyLock;

use glam::{DVec3, Vec3};

use super::albedo_table::AlbedoTable;
use super::ggx::Ggx;
use crate::math::columns::{Columns, columns};
use crate::math::kernel::{Kernel, NOTHING, map};
use crate::math::quadrature::gauss_legendre;

/// F₀ + (F₉₀ − F₀)(1 − cos)⁵.
#[derive(Clone, Copy, Debug)]
pub struct Schlick {
    /// Reflectance at normal incidence.
    pub f0: Vec3,
    /// At grazing incidence.
    pub f90: f32,
}

impl Schlick {
    /// Reflectance at a cosine of incidence.
    #[inline(always)]
    pub fn at(&self, cos: f64) -> Vec3 {
        let grazing = fifth_power(1.0 - cos) as f32;
        self.f0 + (self.f90 - self.f0) * grazing
    }

    /// Share of light at a cosine to the normal that is not reflected on the way to a Lambertian below, by the angle to the
    /// half vector.
    #[inline(always)]
    pub fn passes(&self, mu: f64) -> f32 {
        // The mean of (1 − V·H)⁵ over cosine-weighted directions, to within 2e-5.
        const GRAZING: [f64; 5] = [0.028_166_05, -0.079_872_79, 0.086_525_36, -0.043_756_77, 0.009_021_15];
        let grazing = GRAZING.iter().rev().fold(0.0, |sum, c| sum * mu + c) as f32;
        let f0 = self.f0.max_element();
        1.0 - f0 - (self.f90 - f0) * grazing
    }

    /// Directional albedo of GGX microfacets with this reflectance.
    #[inline(always)]
    pub fn albedo(&self, ggx: &GgxAlbedo) -> Vec3 {
        (ggx.whole - ggx.grazing) as f32 * self.f0 + (ggx.grazing as f32 * self.f90)
    }

    /// Factor that gives back light that is scattered more than once: Σ (Fₐ (1 − E))ᵏ over its orders k, each dimmed
    /// once more by the average reflectance Fₐ \[Turquin 2019, "Practical Multiple Scattering Compensation for
    /// Microfacet Models"; Kulla, Conty 2017\].
    #[inline(always)]
    pub fn compensation(&self, ggx: &GgxAlbedo) -> Vec3 {
        let average = self.f0 + (self.f90 - self.f0) / 21.0;
        (1.0 - average * (1.0 - ggx.whole) as f32).recip()
    }
}

#[inline(always)]
fn fifth_power(x: f64) -> f64 {
    let x = x.clamp(0.0, 1.0);
    let x2 = x * x;
    x2 * x2 * x
}

columns! {
    /// Directional albedo of GGX microfacets, light that is scattered once.
    pub struct GgxAlbedo => GgxAlbedoBlock {
        /// Of such that reflect everything.
        whole: f64,
        /// Of such that reflect (1 − cos)⁵.
        grazing: f64,
    }
}

/// Quadrature nodes by radius and, for half of a turn, by azimuth.
const RADIAL: usize = 96;
const AZIMUTHAL: usize = 14;

static GGX: LazyLock<AlbedoTable<2>> = LazyLock::new(|| {
    let unit = |(x, weight): &(f64, f64)| (0.5 + 0.5 * x, 0.5 * weight);
    let [radial, azimuthal] =
        [RADIAL, AZIMUTHAL].map(|count| gauss_legendre(count).iter().map(unit).collect::<Vec<_>>());
    let nodes: Vec<QuadratureNode> = radial
        .iter()
        .flat_map(|&(v, weight_v)| azimuthal.iter().map(move |&(u, weight_u)| (u, v, weight_u * weight_v)))
        .map(|(u, v, weight)| QuadratureNode { u: 0.5 * u, v, weight })
        .collect();
    let lanes = nodes.len();
    let (mut columns, mut shares) = (Columns::default(), Columns::<GgxAlbedo>::default());
    columns.gather(lanes, |lane| nodes[lane]);
    shares.resize(lanes);
    AlbedoTable::new(|mu, roughness| {
        // At the ends, limits.
        let mu = mu.max(1e-6);
        let wi = DVec3::new((1.0 - mu * mu).sqrt(), 0.0, mu);
        let reflections = Reflections { wi, ggx: Ggx::unbounded((roughness * roughness).max(1e-9)) };
        map(&reflections, columns.blocks(lanes), NOTHING, shares.blocks_mut(lanes));
        (0..lanes)
            .map(|lane| shares.get(lane))
            .fold([0.0; 2], |[whole, grazing], share| [whole + share.whole, grazing + share.grazing])
    })
});

columns! {
    /// Node of a quadrature over the unit square.
    pub struct QuadratureNode => QuadratureNodeBlock {
        /// First coordinate.
        u: f64,
        /// Second coordinate.
        v: f64,
        /// Weight.
        weight: f64,
    }
}

/// Kernel that reflects light from `wi` at the facet of a node: the node's shares of the albedos.
struct Reflections {
    wi: DVec3,
    ggx: Ggx,
}

impl Kernel for Reflections {
    type A = QuadratureNode;
    type B = ();
    type Out = GgxAlbedo;

    #[inline(always)]
    fn run(&self, &QuadratureNode { u, v, weight }: &QuadratureNode, (): &()) -> GgxAlbedo {
        let Self { wi, ggx } = *self;
        let h = ggx.sample_visible(wi, u, v);
        let cos = wi.dot(h);
        let wo = 2.0 * cos * h - wi;
        let share = weight * ggx.unshadowed(wi, wo);
        let whole = if wo.z > 0.0 { share } else { 0.0 };
        GgxAlbedo { whole, grazing: whole * fifth_power(1.0 - cos) }
    }
}

impl GgxAlbedo {
    /// Albedo for light at a cosine to the normal, to within 1.2e-3, and 1e-3 above μ = 0.01. Of anisotropic microfacets it is an upper bound, the
    /// largest one of isotropic ones of either α and of their mean: so nothing gains light.
    #[inline(always)]
    pub fn new(mu: f64, ggx: Option<&Ggx>) -> Self {
        let Some(ggx) = ggx else { return Self { whole: 1.0, grazing: fifth_power(1.0 - mu) } };
        let [x, y] = ggx.alphas();
        let of = |alpha: f64| {
            let [whole, grazing] = GGX.at(mu, alpha.sqrt());
            Self { whole, grazing }
        };
        let most = |a: Self, b: Self| Self { whole: a.whole.max(b.whole), grazing: a.grazing.max(b.grazing) };
        if x == y { of(x) } else { most(of((x * y).sqrt()), most(of(x), of(y))) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_passes_on_the_way_to_a_lambertian_is_the_mean_over_half_vectors() {
        let (fresnel, nodes) = (Schlick { f0: Vec3::splat(0.04), f90: 1.0 }, gauss_legendre(200));
        for mu in [0.0, 0.1, 0.3, 0.5, 0.8, 1.0f64] {
            let wi = DVec3::new((1.0 - mu * mu).sqrt(), 0.0, mu);
            let mut sum = 0.0;
            for (x, weight) in &nodes {
                for (y, weight_y) in &nodes {
                    let (square, (sin, cos)) = (0.5 + 0.5 * x, libm::sincos(std::f64::consts::PI * y));
                    let across = square.sqrt();
                    let wo = DVec3::new(across * cos, across * sin, (1.0 - square).sqrt());
                    let passes = 1.0 - fresnel.at(wi.dot((wi + wo).normalize())).x;
                    sum += 0.25 * weight * weight_y * f64::from(passes);
                }
            }
            let passes = f64::from(fresnel.passes(mu));
            assert!((passes - sum).abs() < 1e-4, "{mu}: {passes} {sum}");
        }
    }

    #[test]
    fn the_albedo_of_microfacets_is_that_of_fine_quadrature_at_every_angle_and_roughness() {
        const FINE: usize = 2000;
        let mut worst = [0.0f64; 2];
        for roughness in [0.012, 0.02, 0.06, 0.1, 0.15, 0.22, 0.3, 0.41, 0.5, 0.63, 0.77, 0.9, 1.0] {
            let ggx = Ggx::isotropic(roughness * roughness).unwrap();
            for mu in [1e-3, 0.01, 0.02, 0.05, 0.11, 0.2, 0.34, 0.5, 0.71, 0.93, 1.0f64] {
                let wi = DVec3::new((1.0 - mu * mu).sqrt(), 0.0, mu);
                let mut sum = [0.0; 2];
                for i in 0..FINE {
                    for j in 0..FINE / 20 {
                        let [v, u] = [(i as f64 + 0.5) / FINE as f64, (j as f64 + 0.5) / (FINE / 10) as f64];
                        let h = ggx.sample_visible(wi, u, v);
                        let cos = wi.dot(h);
                        let wo = 2.0 * cos * h - wi;
                        let share = if wo.z > 0.0 { ggx.unshadowed(wi, wo) } else { 0.0 };
                        sum = [sum[0] + share, sum[1] + share * fifth_power(1.0 - cos)];
                    }
                }
                let exact = sum.map(|sum| sum / (FINE * FINE / 20) as f64);
                let GgxAlbedo { whole, grazing } = GgxAlbedo::new(mu, Some(&ggx));
                worst[0] = worst[0].max((whole - exact[0]).abs());
                worst[1] = worst[1].max((grazing - exact[1]).abs());
            }
        }
        println!("{worst:?}");
        assert!(worst[0] < 1.2e-3 && worst[1] < 1.2e-3, "{worst:?}");
    }
}
