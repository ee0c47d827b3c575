//! Spectra of the sun and of air, and their colours.
//!
//! References: \[C\] CIE 015:2018, the 1931 standard observer; \[I\] IEC 61966-2-1, linear sRGB; \[P\] Prša et al. 2016,
//! "Nominal Values for Selected Solar and Planetary Quantities", AJ 152, 41; \[N\] Nishita, Sirai, Tadamura, Nakamae 1993,
//! "Display of the Earth Taking into Account Atmospheric Scattering"; \[S\] Serdyuchenko et al. 2014, "High Spectral
//! Resolution Ozone Absorption Cross-Sections", AMT 7, 625.

use std::f64::consts::PI;

use glam::{DMat3, DVec3};

/// Wavelengths of a spectrum.
pub const COUNT: usize = 21;
/// Values at 380, 400, … 780 nm, each for the 20 nm around it.
pub type Spectrum = [f64; COUNT];
const FIRST: f64 = 380.0;
const WIDTH: f64 = 20.0;

/// Scattering coefficient of aerosols at sea level, m⁻¹, alike for all wavelengths; of what they take from a ray, a tenth is
/// absorbed.
pub const AEROSOL: f64 = 2e-5;

/// Colour matching functions x̄, ȳ, z̄. \[C\] table 1.
const OBSERVER: [[f64; 3]; COUNT] = [
    [0.001368, 0.000039, 0.006450],
    [0.014310, 0.000396, 0.067850],
    [0.134380, 0.004000, 0.645600],
    [0.348280, 0.023000, 1.747060],
    [0.290800, 0.060000, 1.669200],
    [0.095640, 0.139020, 0.812950],
    [0.004900, 0.323000, 0.272000],
    [0.063270, 0.710000, 0.078250],
    [0.290400, 0.954000, 0.020300],
    [0.594500, 0.995000, 0.003900],
    [0.916300, 0.870000, 0.001650],
    [1.062200, 0.631000, 0.000800],
    [0.854450, 0.381000, 0.000190],
    [0.447900, 0.175000, 0.000020],
    [0.164900, 0.061000, 0.0],
    [0.046770, 0.017000, 0.0],
    [0.011359, 0.004102, 0.0],
    [0.002899, 0.001047, 0.0],
    [0.000690, 0.000249, 0.0],
    [0.000166, 0.000060, 0.0],
    [0.000042, 0.000015, 0.0],
];

/// Absorption cross-sections of ozone at 233 K, 10⁻²⁷ m². \[S\]
const OZONE: Spectrum = [
    0.25, 1.0953, 4.1415, 12.1355, 29.925, 63.38, 119.08, 187.05, 292.3, 388.3, 453.5, 486.0, 402.25, 293.85,
    204.5, 134.1, 84.39, 58.355, 41.89, 28.44, 26.675,
];
/// Ozone molecules where they are densest, m⁻³, so that a column holds 300 Dobson units: [`super::atmosphere`] spreads them
/// over 15 km.
const DENSEST: f64 = 300.0 * 2.687e20 / 15e3;

/// X, Y, Z → red, green, blue. \[I\]
const TO_RGB: DMat3 = DMat3::from_cols(
    DVec3::new(3.240_454_2, -0.969_266_0, 0.055_643_4),
    DVec3::new(-1.537_138_5, 1.876_010_8, -0.204_025_9),
    DVec3::new(-0.498_531_4, 0.041_556_0, 1.057_225_2),
);

/// Spectra that an atmosphere is made of.
#[derive(Clone, Debug)]
pub struct SkySpectra {
    /// Irradiance of the sun above the atmosphere, W m⁻² nm⁻¹: a black body at 5772 K of 1361 W m⁻² in all. \[P\]
    pub sun: Spectrum,
    /// Scattering coefficient of air at sea level, m⁻¹. \[N\] eq. 2
    pub air: Spectrum,
    /// Absorption coefficient of ozone where it is densest, m⁻¹.
    pub ozone: Spectrum,
}

impl SkySpectra {
    pub fn new() -> Self {
        let (planck, light, boltzmann) = (6.626_070_15e-34, 299_792_458.0, 1.380_649e-23);
        let (temperature, constant) = (5772f64, 1361.0);
        let scale = constant / (5.670_374_419e-8 * temperature.powi(4)) * 1e-9;
        let sun = |wavelength: f64| {
            let exponent = planck * light / (wavelength * boltzmann * temperature);
            scale * 2.0 * PI * planck * light * light / (wavelength.powi(5) * libm::expm1(exponent))
        };
        let (index, molecules) = (1.000_292_6f64, 2.504e25);
        let polarizability = index * index - 1.0;
        let air = |wavelength: f64| {
            8.0 * PI.powi(3) * polarizability.powi(2) / (3.0 * molecules * wavelength.powi(4))
        };
        let at = |f: &dyn Fn(f64) -> f64| std::array::from_fn(|i| f((FIRST + WIDTH * i as f64) * 1e-9));
        Self { sun: at(&sun), air: at(&air), ozone: OZONE.map(|section| DENSEST * section * 1e-27) }
    }
}

/// Colour of a spectrum, whose luminance is ∫ ȳ(λ) L(λ) dλ: lumens over 683. Saturated ones have a negative channel.
pub fn rgb(spectrum: &Spectrum) -> DVec3 {
    let xyz: DVec3 = OBSERVER.iter().zip(spectrum).map(|(xyz, value)| DVec3::from(*xyz) * *value).sum();
    TO_RGB * (WIDTH * xyz)
}
