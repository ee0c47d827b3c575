//! Colour spaces: primaries and white point → the renderer's linear Rec. 709.

use exr::meta::attribute::Chromaticities;
use exr::prelude::Vec2;
use glam::{DMat3, DVec3, Mat3};

/// Those of Rec. 709: the white is D65.
pub const REC709: Chromaticities = Chromaticities {
    red: Vec2(0.64, 0.33),
    green: Vec2(0.3, 0.6),
    blue: Vec2(0.15, 0.06),
    white: Vec2(0.3127, 0.329),
};
/// Chromaticities that differ by less are the same; files write three or four digits.
const SAME: f32 = 1e-3;
/// Factors beyond this come of primaries that lie on a line.
const LARGEST: f64 = 100.0;
/// Bradford's cone responses, by row: X, Y, Z → ρ, γ, β.
const BRADFORD: DMat3 = DMat3::from_cols(
    DVec3::new(0.8951, -0.7502, 0.0389),
    DVec3::new(0.2664, 1.7135, -0.0685),
    DVec3::new(-0.1614, 0.0367, 1.0296),
);

/// Conversion of colours of some primaries to Rec. 709.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ToRec709 {
    /// They are Rec. 709.
    Same,
    /// White to white, after Bradford.
    Matrix(DMat3),
    /// The primaries span no colour space.
    Impossible,
}

impl ToRec709 {
    /// From colours of these chromaticities.
    pub fn of(from: &Chromaticities) -> Self {
        let pairs = [
            (from.red, REC709.red),
            (from.green, REC709.green),
            (from.blue, REC709.blue),
            (from.white, REC709.white),
        ];
        if pairs.iter().all(|(a, b)| (a.0 - b.0).abs() < SAME && (a.1 - b.1).abs() < SAME) {
            return Self::Same;
        }
        let (white, target) = (BRADFORD * white(from), BRADFORD * white(&REC709));
        let adaptation = BRADFORD.inverse() * DMat3::from_diagonal(target / white) * BRADFORD;
        let matrix = to_xyz(&REC709).inverse() * adaptation * to_xyz(from);
        let is_usable = matrix.to_cols_array().iter().all(|factor| factor.abs() < LARGEST);
        if is_usable { Self::Matrix(matrix) } else { Self::Impossible }
    }

    /// The matrix, where there is something to do.
    pub fn matrix(self) -> Option<Mat3> {
        match self {
            Self::Matrix(matrix) => Some(matrix.as_mat3()),
            Self::Same | Self::Impossible => None,
        }
    }
}

/// Luminance of red, green and blue.
pub fn luminance_weights(chromaticities: &Chromaticities) -> DVec3 {
    let weights = to_xyz(chromaticities).row(1);
    let is_usable = weights.is_finite() && weights.y > 0.0;
    if is_usable { weights } else { to_xyz(&REC709).row(1) }
}

/// RGB → XYZ, where RGB = 1 is the white with Y = 1.
fn to_xyz(chromaticities: &Chromaticities) -> DMat3 {
    let Chromaticities { red, green, blue, .. } = *chromaticities;
    let primaries = DMat3::from_cols(xyz(red), xyz(green), xyz(blue));
    primaries * DMat3::from_diagonal(primaries.inverse() * white(chromaticities))
}

/// The white with Y = 1.
fn white(chromaticities: &Chromaticities) -> DVec3 {
    let white = xyz(chromaticities.white);
    white / white.y
}

/// The colour of a chromaticity with X + Y + Z = 1.
fn xyz(Vec2(x, y): Vec2<f32>) -> DVec3 {
    let (x, y) = (f64::from(x), f64::from(y));
    DVec3::new(x, y, 1.0 - x - y)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// AP1 with the white of ACES.
    const ACESCG: Chromaticities = Chromaticities {
        red: Vec2(0.713, 0.293),
        green: Vec2(0.165, 0.83),
        blue: Vec2(0.128, 0.044),
        white: Vec2(0.32168, 0.33767),
    };

    /// Colours that are X, Y and Z themselves.
    const XYZ: Chromaticities = Chromaticities {
        red: Vec2(1.0, 0.0),
        green: Vec2(0.0, 1.0),
        blue: Vec2(0.0, 0.0),
        white: Vec2(1.0 / 3.0, 1.0 / 3.0),
    };

    fn matrix(from: &Chromaticities) -> DMat3 {
        let ToRec709::Matrix(matrix) = ToRec709::of(from) else { panic!("{from:?}") };
        matrix
    }

    #[test]
    fn acescg_becomes_rec_709_as_published() {
        let expected = DMat3::from_cols(
            DVec3::new(1.70505, -0.13026, -0.02400),
            DVec3::new(-0.62179, 1.14080, -0.12897),
            DVec3::new(-0.08326, -0.01055, 1.15297),
        );
        let found = matrix(&ACESCG);
        assert!(found.abs_diff_eq(expected, 1e-4), "{found}");
    }

    #[test]
    fn white_stays_white_and_rec_709_needs_nothing() {
        let equal_energy = Chromaticities { white: Vec2(1.0 / 3.0, 1.0 / 3.0), ..REC709 };
        for space in [ACESCG, equal_energy, XYZ] {
            assert!((matrix(&space) * DVec3::ONE).abs_diff_eq(DVec3::ONE, 1e-6));
        }
        let rounded = Chromaticities { red: Vec2(0.6404, 0.3298), ..REC709 };
        assert_eq!([REC709, rounded].map(|space| ToRec709::of(&space)), [ToRec709::Same; 2]);
        // Y alone is neither red nor blue.
        let green = matrix(&XYZ) * DVec3::Y;
        assert!(green.y > 1.0 && green.x < 0.0 && green.z < 0.0, "{green}");
    }

    #[test]
    fn chromaticities_that_span_no_space_are_none() {
        for broken in [
            Chromaticities { red: REC709.green, ..REC709 },
            Chromaticities { white: Vec2(0.3, 0.0), ..REC709 },
            Chromaticities { blue: Vec2(f32::NAN, 0.1), ..REC709 },
        ] {
            assert_eq!(ToRec709::of(&broken), ToRec709::Impossible, "{broken:?}");
            assert!(luminance_weights(&broken).is_finite());
        }
        assert!((luminance_weights(&REC709) - DVec3::new(0.2126, 0.7152, 0.0722)).length() < 2e-4);
    }
}
