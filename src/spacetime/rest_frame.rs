//! Frame at rest: directions and normals as things at rest see them, from those of the chart.
//!
//! In a conformally flat space both agree. Around a spinning hole, the space at rest has the metric δ + F/(1 − F) N N
//! with s² = 1 − F: it is stretched along N by 1/s.

use glam::DVec3;

use super::kerr_newman::KerrNewman;
use super::placement::Placement;

/// Frames of observers and surfaces at rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum RestFrame {
    /// Angles of the chart are true.
    Conformal,
    /// Space around a spinning hole.
    Spinning(Placement, KerrNewman),
}

impl RestFrame {
    /// Unit direction at rest of a tangent of the chart at a world position.
    #[inline(always)]
    pub fn direction(&self, position: DVec3, tangent: DVec3) -> DVec3 {
        match self {
            Self::Conformal => tangent,
            Self::Spinning(placement, hole) => {
                let (n, s) = stretch(placement, hole, position);
                (tangent + (1.0 / s - 1.0) * n.dot(tangent) * n).normalize()
            }
        }
    }

    /// Unit normal at rest of a surface that has this normal in the chart, at a world position: normals are covectors.
    #[inline(always)]
    pub fn normal(&self, position: DVec3, normal: DVec3) -> DVec3 {
        match self {
            Self::Conformal => normal,
            Self::Spinning(placement, hole) => {
                let (n, s) = stretch(placement, hole, position);
                (normal - (1.0 - s) * n.dot(normal) * n).normalize()
            }
        }
    }
}

/// The world direction along which space is stretched, and the inverse of by how much.
#[inline(always)]
fn stretch(placement: &Placement, hole: &KerrNewman, position: DVec3) -> (DVec3, f64) {
    let x = placement.local(position);
    let n = placement.rotation().transpose() * hole.outgoing(x);
    (n, (1.0 - hole.potential(x)).max(0.0).sqrt())
}
