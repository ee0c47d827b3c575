//! Frame at rest: directions and normals as things at rest see them, from those of the chart.
//!
//! In a conformally flat space both agree. Around a spinning hole, the space at rest has the metric δ + F/(1 − F) N N
//! with s² = 1 − F: it is stretched along N by 1/s.

use glam::{DMat3, DVec3};

use super::kerr_newman::KerrNewman;
use super::placement::Placement;

/// Frames of observers and surfaces at rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum RestFrame {
    /// Angles of the chart are true.
    Conformal,
    /// Space around a spinning hole.
    Spinning {
        /// World position of the centre.
        center: DVec3,
        /// Rotation from the world to coordinates with z along the axis.
        rotation: DMat3,
        /// The hole.
        hole: KerrNewman,
    },
}

impl RestFrame {
    /// Frames around a spinning hole.
    pub(crate) fn spinning(placement: Placement, hole: KerrNewman) -> Self {
        Self::Spinning { center: placement.center, rotation: placement.rotation(), hole }
    }

    /// Unit direction at rest of a tangent of the chart at a world position.
    #[inline(always)]
    pub fn direction(&self, position: DVec3, tangent: DVec3) -> DVec3 {
        self.stretch(position).direction(tangent)
    }

    /// Unit normals at rest of surfaces that have these normals in the chart, at a world position.
    #[inline(always)]
    pub fn normals<const COUNT: usize>(&self, position: DVec3, normals: [DVec3; COUNT]) -> [DVec3; COUNT] {
        self.stretch(position).normals(normals)
    }

    /// Stretch of the space at rest at a world position.
    #[inline(always)]
    pub fn stretch(&self, position: DVec3) -> Stretch {
        match self {
            Self::Conformal => Stretch::NONE,
            Self::Spinning { center, rotation, hole } => {
                let (n, potential) = hole.outgoing(*rotation * (position - *center));
                Stretch::new(rotation.transpose() * n, potential)
            }
        }
    }
}

/// Stretch of the space at rest at a place, against the chart: √(1 − s) N, as a vector of the world.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Stretch(pub(crate) DVec3);

impl Stretch {
    /// None: the angles of the chart are true.
    pub const NONE: Stretch = Stretch(DVec3::ZERO);

    /// Along the unit vector `n`, where the metric is η + `potential` l l; NaN where nothing can be at rest.
    #[inline(always)]
    pub(crate) fn new(n: DVec3, potential: f64) -> Self {
        let size = (1.0 - (1.0 - potential).sqrt()).sqrt();
        Self(if potential < 1.0 { size } else { f64::NAN } * n)
    }

    /// Unit direction at rest of a tangent of the chart.
    #[inline(always)]
    pub fn direction(&self, tangent: DVec3) -> DVec3 {
        if *self == Self::NONE { tangent } else { self.stretched(tangent) }
    }

    /// [`Self::direction`] without a branch, where space is stretched.
    #[inline(always)]
    pub(crate) fn stretched(&self, tangent: DVec3) -> DVec3 {
        // tangent + (1/s − 1) N N·tangent.
        let s = 1.0 - self.0.length_squared();
        let longer = tangent + (self.0.dot(tangent) / s) * self.0;
        longer / longer.length()
    }

    /// Unit normals at rest of surfaces that have these normals in the chart: normals are covectors.
    #[inline(always)]
    pub fn normals<const COUNT: usize>(&self, normals: [DVec3; COUNT]) -> [DVec3; COUNT] {
        if *self == Self::NONE {
            return normals;
        }
        let at_rest = |normal: DVec3| (normal - self.0.dot(normal) * self.0).normalize();
        // Most surfaces are shaded as they are.
        let first = at_rest(normals[0]);
        normals.map(|normal| if normal == normals[0] { first } else { at_rest(normal) })
    }
}
