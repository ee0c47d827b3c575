//! Mouths of a wormhole: the centres of its throat in both worlds, and how these are glued together.
//!
//! Both are glued antipodally. A place at the distance ρ from the near centre c, in the unit direction e, is the place at
//! the distance r²/ρ from the far centre c′ in the direction −Q e, r the radius of the throat and Q a rotation:
//!
//! ```text
//! x′ − c′ = −r² Q (x − c)/ρ².
//! ```
//!
//! What goes straight through the middle keeps its direction but for Q, and nothing is mirrored. A direction d becomes
//! Q (2 (e·d) e − d).

use glam::{DMat3, DVec3};

use super::side::Side;

/// Centres of a wormhole in both worlds, and the rotation between them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mouths {
    /// Centre in the near world.
    pub near: DVec3,
    /// Centre in the far world.
    pub far: DVec3,
    /// Q.
    pub rotation: DMat3,
}

impl Mouths {
    /// The centre in the world of a side.
    pub fn center(&self, side: Side) -> DVec3 {
        match side {
            Side::Near => self.near,
            Side::Far => self.far,
        }
    }

    /// A vector of the world of `side`, turned into the other world by Q or back.
    pub fn turned(&self, side: Side, vector: DVec3) -> DVec3 {
        match side {
            Side::Near => self.rotation * vector,
            Side::Far => self.rotation.transpose() * vector,
        }
    }

    /// A direction in the chart of `side`, at a place in the unit direction `radial` from the centre, as one in the chart
    /// of the other side.
    pub fn across(&self, side: Side, radial: DVec3, direction: DVec3) -> DVec3 {
        self.turned(side, 2.0 * radial.dot(direction) * radial - direction)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::rotation;

    #[test]
    fn there_and_back_is_nothing_and_handedness_is_kept() {
        let rotation = DMat3::from_quat(rotation::about(DVec3::new(0.6, 0.0, 0.8), 2.0));
        let mouths = Mouths { near: DVec3::ZERO, far: DVec3::X, rotation };
        let radial = DVec3::new(2.0, -1.0, 0.5).normalize();
        let across = |direction| mouths.across(Side::Near, radial, direction);
        let [x, y, z] = [DVec3::X, DVec3::Y, DVec3::Z].map(across);
        assert!(x.cross(y).distance(z) < 1e-15);
        let beyond = -mouths.turned(Side::Near, radial);
        assert!(mouths.across(Side::Far, beyond, y).distance(DVec3::Y) < 1e-15);
        assert!(across(radial).distance(rotation * radial) < 1e-15);
    }
}
