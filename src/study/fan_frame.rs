//! Frame of a fan's picture: a plane of the world, and the part of it that is shown.

use std::f64::consts::PI;

use glam::{DVec2, DVec3};

use crate::geometry::CrossSection;

/// A plane of the world as a picture shows it.
#[derive(Clone, Copy, Debug)]
pub(super) struct FanPlane {
    pub(super) origin: DVec3,
    pub(super) right: DVec3,
    pub(super) up: DVec3,
}

/// A box in the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct FanBounds {
    pub(super) min: DVec2,
    pub(super) max: DVec2,
}

/// Room around what must be seen, relative to its larger side.
const ROOM: f64 = 0.05;
/// Smaller side of a frame, relative to the larger one, at least.
const SLIMMEST: f64 = 0.45;
/// Corners of the polygon that stands for a circle.
const CORNERS: u32 = 256;

/// The unit vector at an angle from +X, radians.
pub(super) fn unit(angle: f64) -> DVec2 {
    let (sin, cos) = libm::sincos(angle);
    DVec2::new(cos, sin)
}

/// A circle between two angles either side of `middle`, as a polygon.
pub(super) fn circle(center: DVec2, radius: f64, middle: f64, half: f64) -> Vec<[f64; 2]> {
    let angle = |i: u32| middle + half * (2.0 * f64::from(i) / f64::from(CORNERS) - 1.0);
    (0..=CORNERS).map(|i| (center + radius * unit(angle(i))).into()).collect()
}

impl FanPlane {
    /// Coordinates of a point's projection.
    pub(super) fn place(&self, point: DVec3) -> [f64; 2] {
        let from = point - self.origin;
        [from.dot(self.right), from.dot(self.up)]
    }

    /// The part of a cut that the frame may show.
    pub(super) fn outline(&self, cut: &CrossSection, frame: &FanBounds) -> Option<Vec<[f64; 2]>> {
        match *cut {
            CrossSection::Line(ends) => {
                let [a, b] = ends.map(|end| self.place(end));
                let (low, high) = (DVec2::from(a).min(b.into()), DVec2::from(a).max(b.into()));
                let seen = low.cmple(frame.max).all() && high.cmpge(frame.min).all();
                seen.then(|| vec![a, b])
            }
            CrossSection::Circle { center, radius } => {
                // The circle meets the disc around the frame within this angle: walls may be huge spheres.
                let center = DVec2::from(self.place(center));
                let to_frame = 0.5 * (frame.min + frame.max) - center;
                let (distance, reach) = (to_frame.length(), 0.5 * frame.reach());
                let cosine =
                    (distance * distance + radius * radius - reach * reach) / (2.0 * distance * radius);
                let half = if cosine.is_nan() { PI } else { libm::acos(cosine.clamp(-1.0, 1.0)) };
                (half > 0.0).then(|| circle(center, radius, libm::atan2(to_frame.y, to_frame.x), half))
            }
        }
    }
}

impl FanBounds {
    /// Holds nothing.
    pub(super) const NOTHING: Self = Self { min: DVec2::INFINITY, max: DVec2::NEG_INFINITY };

    /// Takes in a disc.
    pub(super) fn hold(&mut self, center: DVec2, radius: f64) {
        self.min = self.min.min(center - radius);
        self.max = self.max.max(center + radius);
    }

    /// Its diagonal.
    pub(super) fn reach(&self) -> f64 {
        self.min.distance(self.max)
    }

    /// Widened to have a margin and not be slim.
    pub(super) fn roomy(self) -> Self {
        let middle = 0.5 * (self.min + self.max);
        let half = 0.5 * (self.max - self.min);
        let longer = half.max_element();
        let half = (half + ROOM * longer).max(DVec2::splat(SLIMMEST * longer));
        Self { min: middle - half, max: middle + half }
    }
}
