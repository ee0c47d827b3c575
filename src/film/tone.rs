//! From scene radiance to display values: exposure, tone curve, sRGB.

use glam::Vec3;

/// Display value (linear, 0 to 1) up to which nothing is changed; the rest of the range is left to highlights.
const KNEE: f32 = 0.8;
/// Rate at which compressed highlights lose their colour.
const DESATURATION: f32 = 0.15;
/// Radiance beyond which the curve is flat in f32; keeps infinities out of the arithmetic.
const BRIGHTEST: f32 = 1e9;

/// 8-bit sRGB of a linear radiance, `gain` (a factor) applied first; what is not a number or is negative is black.
pub(super) fn to_srgb8(radiance: Vec3, gain: f32) -> [u8; 3] {
    let exposed = (radiance * gain).to_array().map(|c| if c > 0.0 { c.min(BRIGHTEST) } else { 0.0 });
    neutral(Vec3::from(exposed)).to_array().map(|c| (srgb(c) * 255.0).round() as u8)
}

/// The Khronos PBR Neutral tone mapper, less its toe (which takes off the 4 % Fresnel reflection of product shots and
/// would darken a diffuse scene).
///
/// Colours up to [`KNEE`] are shown as they are, so that a white wall stays the white that was asked for; beyond, the
/// brightest channel is compressed along a hyperbola that meets the identity with equal slope, and the colour goes
/// towards white. Source: Khronos ToneMapping repository, `PBR_Neutral`.
fn neutral(color: Vec3) -> Vec3 {
    let peak = color.max_element();
    if peak < KNEE {
        return color;
    }
    let room = 1.0 - KNEE;
    let compressed = 1.0 - room * room / (peak + room - KNEE);
    let whiteness = 1.0 - 1.0 / (DESATURATION * (peak - compressed) + 1.0);
    (color * (compressed / peak)).lerp(Vec3::splat(compressed), whiteness)
}

/// The sRGB transfer function (IEC 61966-2-1).
fn srgb(linear: f32) -> f32 {
    if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * libm::powf(linear, 1.0 / 2.4) - 0.055 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_below_the_knee_are_plain_srgb() {
        assert_eq!(to_srgb8(Vec3::new(0.0, 0.214_041, 0.7), 1.0), [0, 127, 218]);
        assert_eq!(to_srgb8(Vec3::splat(0.107_020_5), 2.0), [127, 127, 127]);
    }

    #[test]
    fn the_curve_is_smooth_at_the_knee_and_never_falls() {
        let at = |v: f32| neutral(Vec3::splat(v)).x;
        let step = 1e-3;
        assert!(((at(KNEE + step) - at(KNEE)) / step - 1.0).abs() < 0.01);
        let values: Vec<f32> = (0..2000).map(|i| at(i as f32 * 0.01)).collect();
        assert!(values.windows(2).all(|pair| pair[0] <= pair[1] && pair[1] <= 1.0));
    }

    #[test]
    fn bright_colours_go_to_white_softly() {
        let [r, g, b] = to_srgb8(Vec3::new(4.0, 0.4, 0.2), 1.0);
        assert!(r > 240 && g < r && b < g);
        assert_eq!(to_srgb8(Vec3::new(1e6, 1e3, 1e3), 1.0), [255, 255, 255]);
    }

    #[test]
    fn values_that_are_no_colours_are_safe() {
        assert_eq!(to_srgb8(Vec3::new(f32::NAN, -1.0, f32::NEG_INFINITY), 1.0), [0, 0, 0]);
        assert_eq!(to_srgb8(Vec3::splat(f32::INFINITY), 1.0), [255, 255, 255]);
        assert_eq!(to_srgb8(Vec3::ZERO, f32::INFINITY), [0, 0, 0]);
    }
}
