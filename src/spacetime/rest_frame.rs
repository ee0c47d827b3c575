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
        match self.stretch(position) {
            None => tangent,
            Some((n, s)) => (tangent + (1.0 / s - 1.0) * n.dot(tangent) * n).normalize(),
        }
    }

    /// Unit normals at rest of surfaces that have these normals in the chart, at a world position: normals are covectors.
    #[inline(always)]
    pub fn normals<const COUNT: usize>(&self, position: DVec3, normals: [DVec3; COUNT]) -> [DVec3; COUNT] {
        match self.stretch(position) {
            None => normals,
            Some((n, s)) => normals.map(|normal| (normal - (1.0 - s) * n.dot(normal) * n).normalize()),
        }
    }

    /// The world direction along which space is stretched, and the inverse of by how much; `None` if it is not.
    #[inline(always)]
    fn stretch(&self, position: DVec3) -> Option<(DVec3, f64)> {
        match self {
            Self::Conformal => None,
            Self::Spinning { center, rotation, hole } => {
                let (n, potential) = hole.outgoing(*rotation * (position - *center));
                Some((rotation.transpose() * n, (1.0 - potential).max(0.0).sqrt()))
            }
        }
    }
}
