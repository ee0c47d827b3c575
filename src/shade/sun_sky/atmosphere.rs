//! Sunlight that a spherical atmosphere scatters once, as seen from sea level.
//!
//! References: \[N\] Nishita, Sirai, Tadamura, Nakamae 1993, "Display of the Earth Taking into Account Atmospheric
//! Scattering"; \[B\] Bruneton 2017, "A Qualitative and Quantitative Evaluation of 8 Clear Sky Models", for the layer of ozone.

use glam::DVec3;

use super::spectrum::{AEROSOL, SkySpectra, Spectrum, rgb};
use crate::math::quadrature::gauss_legendre;

/// Radii of the Earth and of the top of the atmosphere, metres.
const EARTH: f64 = 6360e3;
const TOP: f64 = 6420e3;
/// Heights in which air and aerosols get thinner by a factor of e, metres.
const AIR_HEIGHT: f64 = 8e3;
const AEROSOL_HEIGHT: f64 = 1.2e3;
/// Height at which ozone is densest, and distance from it at which there is none, metres. \[B\]
const OZONE_HEIGHT: f64 = 25e3;
const OZONE_REACH: f64 = 15e3;
/// Light that aerosols take from a ray over what they scatter. \[N\]
const AEROSOL_EXTINCTION: f64 = 1.11;
/// Nodes along a ray.
const NODES: usize = 32;

/// An atmosphere of air, aerosols and ozone, seen from sea level; +Y is up.
#[derive(Clone, Debug)]
pub struct Atmosphere {
    /// Amounts of air, aerosols and ozone, relative to a clear day's.
    pub amounts: DVec3,
    spectra: SkySpectra,
    /// Places along a ray of length 1, denser near its start, with their weights.
    rule: Vec<(f64, f64)>,
}

/// The start of a ray, and its unit direction.
#[derive(Clone, Copy)]
struct AirRay {
    from: DVec3,
    direction: DVec3,
}

impl Atmosphere {
    pub fn new(amounts: DVec3) -> Self {
        // A fraction s² of the length.
        let clustered = |(x, weight): (f64, f64)| {
            let s = 0.5 + 0.5 * x;
            (s * s, weight * s)
        };
        let rule = gauss_legendre(NODES).into_iter().map(clustered).collect();
        Self { amounts, spectra: SkySpectra::new(), rule }
    }

    /// Colours of what air and aerosols scatter into the view along `direction`, which does not point down, each over its
    /// phase function: air's by [`air_phase`], aerosols' by [`aerosol_phase`]. \[N\] eq. 7
    pub fn scattered(&self, direction: DVec3, sun: DVec3) -> [DVec3; 2] {
        let view = AirRay { from: EARTH * DVec3::Y, direction };
        let length = view.length_to(TOP);
        let first = if sun.y < 0.0 { view.leaves_shadow(sun) } else { 0.0 };
        let [mut air, mut aerosols] = [[0.0; _]; 2];
        // Looking straight away from the sun, it never does.
        let is_lit = first < length;
        if !is_lit {
            return [DVec3::ZERO; 2];
        }
        for &(fraction, weight) in &self.rule {
            let t = first + fraction * (length - first);
            let here = view.at(t);
            let depth = self.depth_along(view, t) + self.depth_to_top(AirRay { from: here, direction: sun });
            let densities = self.amounts * densities(here) * (weight * (length - first));
            let light = self.transmitted(depth);
            for (i, light) in light.into_iter().enumerate() {
                air[i] += light * densities.x * self.spectra.air[i];
                aerosols[i] += light * densities.y * AEROSOL;
            }
        }
        [rgb(&air), rgb(&aerosols)]
    }

    /// Colour of the irradiance of a surface at sea level that faces the sun, in a direction that does not point down.
    pub fn sunlight(&self, sun: DVec3) -> DVec3 {
        rgb(&self.transmitted(self.depth_to_top(AirRay { from: EARTH * DVec3::Y, direction: sun })))
    }

    /// What is left of the sun's light behind optical depths of air, aerosols and ozone, as lengths at full density.
    fn transmitted(&self, depth: DVec3) -> Spectrum {
        let SkySpectra { sun, air, ozone } = &self.spectra;
        let dust = AEROSOL_EXTINCTION * AEROSOL * depth.y;
        std::array::from_fn(|i| sun[i] * libm::exp(-(air[i] * depth.x + dust + ozone[i] * depth.z)))
    }

    /// Lengths at full density from here to the top of the atmosphere, if the Earth is not in the way.
    fn depth_to_top(&self, ray: AirRay) -> DVec3 {
        let down = -ray.from.dot(ray.direction);
        if down <= 0.0 {
            return self.depth_along(ray, ray.length_to(TOP));
        }
        // From its lowest point both ways, so that each part only gets thinner.
        let lowest = AirRay { from: ray.at(down), ..ray };
        let back = AirRay { direction: -ray.direction, ..lowest };
        self.depth_along(back, down) + self.depth_along(lowest, lowest.length_to(TOP))
    }

    fn depth_along(&self, ray: AirRay, length: f64) -> DVec3 {
        let density = |&(fraction, weight): &(f64, f64)| densities(ray.at(fraction * length)) * weight;
        self.amounts * length * self.rule.iter().map(density).sum::<DVec3>()
    }
}

impl AirRay {
    fn at(&self, t: f64) -> DVec3 {
        self.from + t * self.direction
    }

    /// Length to a sphere around the Earth that the start is within.
    fn length_to(&self, radius: f64) -> f64 {
        let b = self.from.dot(self.direction);
        (b * b + radius * radius - self.from.length_squared()).sqrt() - b
    }

    /// Length within the Earth's shadow of a ray that starts there, at sea level: until it leaves the cylinder, or the
    /// Earth's night side.
    fn leaves_shadow(&self, sun: DVec3) -> f64 {
        let (behind, towards) = (self.from.dot(sun), self.direction.dot(sun));
        let a = 1.0 - towards * towards;
        let b = self.from.dot(self.direction) - behind * towards;
        let cylinder = ((b * b + a * behind * behind).sqrt() - b) / a;
        if towards > 0.0 { cylinder.min(-behind / towards) } else { cylinder }
    }
}

/// Densities of air, aerosols and ozone relative to the largest.
fn densities(place: DVec3) -> DVec3 {
    let height = place.length() - EARTH;
    let ozone = (1.0 - (height - OZONE_HEIGHT).abs() / OZONE_REACH).max(0.0);
    DVec3::new(libm::exp(-height / AIR_HEIGHT), libm::exp(-height / AEROSOL_HEIGHT), ozone)
}

/// Phase function of air by the cosine of the angle to the sun. \[N\] eq. 3
pub fn air_phase(cos: f64) -> f64 {
    3.0 / (16.0 * std::f64::consts::PI) * (1.0 + cos * cos)
}

/// Phase function of aerosols (Cornette and Shanks). \[N\] eq. 5
pub fn aerosol_phase(cos: f64) -> f64 {
    const G: f64 = 0.76;
    const SCALE: f64 = 3.0 * (1.0 - G * G) / (8.0 * std::f64::consts::PI * (2.0 + G * G));
    let base = 1.0 + G * G - 2.0 * G * cos;
    SCALE * (1.0 + cos * cos) / (base * base.sqrt())
}
