//! GGX microfacets, anisotropic, with height-correlated masking and shadowing.
//!
//! Vectors are in a local frame: z along the normal, x and y along the tangents.
//!
//! References: \[H\] Heitz 2014, "Understanding the Masking-Shadowing Function in Microfacet-Based BRDFs", JCGT 3(2);
//! \[D\] Dupuy, Benyoub 2023, "Sampling Visible GGX Normals with Spherical Caps", CGF 42(8).

use std::f64::consts::PI;

use glam::DVec3;

use crate::math::sin_cos_turns;

/// Least α that is told from a perfectly smooth surface.
const SMOOTH: f64 = 1e-4;

/// Distribution of microfacet normals.
#[derive(Clone, Copy, Debug)]
pub struct Ggx {
    /// α along x.
    x: f64,
    /// α along y.
    y: f64,
}

impl Ggx {
    /// Microfacets of these α; `None` if smooth in either direction: a mirror.
    #[inline(always)]
    pub fn new(x: f64, y: f64) -> Option<Self> {
        (x.min(y) >= SMOOTH).then_some(Self { x, y })
    }

    /// Isotropic microfacets of any α > 0, however smooth.
    pub fn unbounded(alpha: f64) -> Self {
        Self { x: alpha, y: alpha }
    }

    /// Isotropic microfacets.
    #[inline(always)]
    pub fn isotropic(alpha: f64) -> Option<Self> {
        Self::new(alpha, alpha)
    }

    /// α along x and y.
    #[inline(always)]
    pub fn alphas(&self) -> [f64; 2] {
        [self.x, self.y]
    }

    /// Smith's Λ of a direction \[H, eq. 72\].
    #[inline(always)]
    pub fn lambda(&self, w: DVec3) -> f64 {
        let (x, y) = (self.x * w.x, self.y * w.y);
        0.5 * ((1.0 + (x * x + y * y) / (w.z * w.z)).sqrt() - 1.0)
    }

    /// G₂/G₁ of light that comes from `wi` and leaves towards `wo`: the share of it that is not shadowed \[H, eq. 99\].
    /// Across the surface as on one side: as all renderers do, PBRT and Cycles among them.
    #[inline(always)]
    pub fn unshadowed(&self, wi: DVec3, wo: DVec3) -> f64 {
        let masked = 1.0 + self.lambda(wi);
        masked / (masked + self.lambda(wo))
    }

    /// Density of the microfacet normal `h` among those seen from `wi`: D(h) G₁(wi) wi·h / wi.z \[H, eq. 16\].
    #[inline(always)]
    pub fn visible(&self, wi: DVec3, h: DVec3) -> f64 {
        let (x, y) = (h.x / self.x, h.y / self.y);
        let stretched = x * x + y * y + h.z * h.z;
        let normals = 1.0 / (PI * self.x * self.y * stretched * stretched);
        normals * wi.dot(h) / ((1.0 + self.lambda(wi)) * wi.z)
    }

    /// A microfacet normal with density [`Self::visible`], from two numbers in [0, 1) \[D, listing 3\].
    #[inline(always)]
    pub fn sample_visible(&self, wi: DVec3, u: f64, v: f64) -> DVec3 {
        let stretched = DVec3::new(self.x * wi.x, self.y * wi.y, wi.z).normalize();
        let (sin, cos) = sin_cos_turns::sin_cos(u);
        let z = (1.0 - v) * (1.0 + stretched.z) - stretched.z;
        let across = (1.0 - z * z).max(0.0).sqrt();
        let cap = DVec3::new(across * cos, across * sin, z) + stretched;
        DVec3::new(self.x * cap.x, self.y * cap.y, cap.z.max(0.0)).normalize()
    }

    /// Reflection from `wi` to `wo`, both above the surface, by facets of normal `h`: the density in solid angle, and
    /// BRDF × cosine if they reflect everything.
    #[inline(always)]
    pub fn reflection(&self, wi: DVec3, wo: DVec3, h: DVec3) -> [f64; 2] {
        let density = self.visible(wi, h) / (4.0 * wi.dot(h));
        [density, density * self.unshadowed(wi, wo)]
    }

    /// A reflected direction with that density, from two numbers in [0, 1); `None` if it is below the surface.
    #[inline(always)]
    pub fn sample_reflection(&self, wi: DVec3, u: f64, v: f64) -> Option<DVec3> {
        let h = self.sample_visible(wi, u, v);
        let wo = 2.0 * wi.dot(h) * h - wi;
        (wo.z > 0.0).then_some(wo)
    }
}
