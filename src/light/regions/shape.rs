//! Regions of directions: where a light may be seen.

use std::f64::consts::{PI, SQRT_2, TAU};

use glam::{DVec2, DVec3};

use crate::math::concentric::concentric;
use crate::math::frame::tangents;
use crate::math::sin_cos_turns;

/// A region of unit directions, from which one is drawn evenly.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Region {
    /// An ellipse in Lambert's equal-area map.
    Ellipse(Ellipse),
    /// A sector between two circles about a pole.
    Sector(Sector),
}

/// An ellipse about the middle of the map.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ellipse {
    middle: DVec3,
    /// Unit vectors along the axes.
    axes: [DVec3; 2],
    /// Half of their lengths in the map, of which the whole sphere is the disk of radius 2.
    reach: DVec2,
}

/// Directions at these angles to the pole and about it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sector {
    pole: DVec3,
    /// Unit vectors across the pole: in the middle of the sector, and a right angle further.
    axes: [DVec3; 2],
    /// Cosines of the angles to the pole, the smaller one first.
    cos: [f64; 2],
    /// Half of the azimuths' range, radians.
    half: f64,
}

/// Size of regions relative to what the points about a light span: where light may come around the hole, and elsewhere.
const ARC_WIDER: f64 = 1.3;
const WIDER: f64 = 1.1;
/// Major half-axis of an ellipse beyond which a sector is tried.
const LARGE: f64 = 0.15;
/// Smallest angle between a sector and its pole, radians.
const NEAR_POLE: f64 = 0.03;
/// Largest area of a region, steradian: other ways find larger lamps as well.
const LARGEST: f64 = 2.0;

impl Region {
    /// The region about the direction of a light's `middle` and of `points` around it, and `margin` radians wider: a
    /// sector about `pole`, if one is given, where an ellipse is too large. `None` if it is so large that it is not worth
    /// while.
    pub fn about(middle: DVec3, points: &[DVec3], pole: Option<DVec3>, margin: f64) -> Option<Self> {
        let wider = if pole.is_some() { ARC_WIDER } else { WIDER };
        let ellipse = Ellipse::about(middle, points, wider, margin);
        let pole = pole.filter(|_| ellipse.as_ref().is_none_or(|ellipse| ellipse.reach.x > LARGE));
        let area = ellipse.as_ref().map_or(f64::INFINITY, Ellipse::area);
        let sector = pole.and_then(|pole| Sector::about(middle, points, pole, margin));
        let region = match sector.filter(|sector| sector.area() < area) {
            Some(sector) => Self::Sector(sector),
            None => Self::Ellipse(ellipse?),
        };
        (region.area() < LARGEST).then_some(region)
    }

    /// Density of a direction that is drawn from it.
    pub fn density(&self, direction: DVec3) -> f64 {
        if self.holds(direction) { 1.0 / self.area() } else { 0.0 }
    }

    /// Solid angle.
    pub fn area(&self) -> f64 {
        match self {
            Self::Ellipse(ellipse) => ellipse.area(),
            Self::Sector(sector) => sector.area(),
        }
    }

    /// True if it holds a unit direction.
    pub fn holds(&self, direction: DVec3) -> bool {
        match self {
            Self::Ellipse(ellipse) => ellipse.holds(direction),
            Self::Sector(sector) => sector.holds(direction),
        }
    }

    /// The direction in its middle.
    pub fn middle(&self) -> DVec3 {
        match self {
            Self::Ellipse(ellipse) => ellipse.middle,
            Self::Sector(sector) => sector.at(0.5, 0.5),
        }
    }

    /// A direction, from two numbers in [0, 1).
    pub fn sample(&self, u: f64, v: f64) -> DVec3 {
        match self {
            Self::Ellipse(ellipse) => {
                let [square, turns] = concentric(u, v);
                ellipse.at(square.sqrt(), turns)
            }
            Self::Sector(sector) => sector.at(u, v),
        }
    }
}

/// Place of a direction in Lambert's map about `middle`, as a vector across it.
fn lambert(middle: DVec3, direction: DVec3) -> DVec3 {
    let cos = middle.dot(direction);
    (direction - cos * middle) * (2.0 / (1.0 + cos)).sqrt()
}

impl Ellipse {
    fn about(middle: DVec3, points: &[DVec3], wider: f64, margin: f64) -> Option<Self> {
        let (x, y) = tangents(middle);
        // Half of the sum of squares of pairs of opposite points is that of the semi-axes.
        let (mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0);
        for &point in points {
            let place = lambert(middle, point);
            let (px, py) = (place.dot(x), place.dot(y));
            (xx, xy, yy) = (xx + 0.5 * px * px, xy + 0.5 * px * py, yy + 0.5 * py * py);
        }
        let (mean, half) = (0.5 * (xx + yy), 0.5 * (xx - yy));
        let root = (half * half + xy * xy).sqrt();
        let major = DVec2::new(root + half, xy).try_normalize();
        // Where the points lie along y, the other column of the matrix is the exact one.
        let major = if half < 0.0 { DVec2::new(xy, root - half).try_normalize() } else { major };
        let major = major.unwrap_or(DVec2::X);
        let axes = [major.x * x + major.y * y, major.x * y - major.y * x];
        let reach = DVec2::new(mean + root, (mean - root).max(0.0));
        let reach = wider * DVec2::new(reach.x.sqrt(), reach.y.sqrt()) + margin;
        // Within the hemisphere about the middle: further out the map is much distorted.
        (reach.x < SQRT_2).then_some(Self { middle, axes, reach })
    }

    fn area(&self) -> f64 {
        PI * self.reach.x * self.reach.y
    }

    fn holds(&self, direction: DVec3) -> bool {
        let place = lambert(self.middle, direction);
        let unit = DVec2::from(self.axes.map(|axis| axis.dot(place))) / self.reach;
        unit.length_squared() <= 1.0
    }

    /// The direction at a distance, relative to the edge's, and an azimuth in turns.
    fn at(&self, distance: f64, turns: f64) -> DVec3 {
        let (sin, cos) = sin_cos_turns::sin_cos(turns);
        let place = distance * self.reach * DVec2::new(cos, sin);
        let [x, y] = self.axes;
        let square = 0.25 * place.length_squared();
        (1.0 - 2.0 * square) * self.middle + (1.0 - square).max(0.0).sqrt() * (place.x * x + place.y * y)
    }
}

impl Sector {
    fn about(middle: DVec3, points: &[DVec3], pole: DVec3, margin: f64) -> Option<Self> {
        let across = middle - middle.dot(pole) * pole;
        let x = across.try_normalize()?;
        let y = pole.cross(x);
        let to_pole = |direction: DVec3| libm::acos(direction.dot(pole).clamp(-1.0, 1.0));
        let start = to_pole(middle);
        let ((mut nearest, mut farthest), (mut least, mut most)) = ((start, start), (0.0f64, 0.0f64));
        for &point in points {
            let angle = to_pole(point);
            (nearest, farthest) = (nearest.min(angle), farthest.max(angle));
            let azimuth = libm::atan2(point.dot(y), point.dot(x));
            (least, most) = (least.min(azimuth), most.max(azimuth));
        }
        let wide = 0.5 * ARC_WIDER * (farthest - nearest) + margin;
        let angle = 0.5 * (farthest + nearest);
        let (nearest, farthest) = (angle - wide, angle + wide);
        if !(nearest > NEAR_POLE && farthest < PI - NEAR_POLE) {
            return None;
        }
        let half = (0.5 * ARC_WIDER * (most - least) + margin / libm::sin(angle)).min(PI);
        let (sin, cos) = libm::sincos(0.5 * (least + most));
        let axes = [cos * x + sin * y, cos * y - sin * x];
        Some(Self { pole, axes, cos: [libm::cos(farthest), libm::cos(nearest)], half })
    }

    fn area(&self) -> f64 {
        2.0 * self.half * (self.cos[1] - self.cos[0])
    }

    fn holds(&self, direction: DVec3) -> bool {
        let [x, y] = self.axes.map(|axis| axis.dot(direction));
        let cos = self.pole.dot(direction);
        cos >= self.cos[0] && cos <= self.cos[1] && libm::atan2(y, x).abs() <= self.half
    }

    /// The direction at parts of the ranges, each from 0 to 1.
    fn at(&self, height: f64, along: f64) -> DVec3 {
        let cos = self.cos[0] + height * (self.cos[1] - self.cos[0]);
        let turns = (2.0 * along - 1.0) * self.half / TAU;
        let (s, c) = sin_cos_turns::sin_cos(turns.rem_euclid(1.0));
        let [x, y] = self.axes;
        cos * self.pole + (1.0 - cos * cos).max(0.0).sqrt() * (c * x + s * y)
    }
}
