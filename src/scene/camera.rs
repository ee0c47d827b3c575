//! The baked pinhole camera.

use glam::{DVec2, DVec3};

use crate::spacetime::Side;

/// A pinhole camera at rest in the static frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// Pinhole position, world.
    pub position: DVec3,
    /// Unit view direction.
    pub forward: DVec3,
    /// Unit image +x direction.
    pub right: DVec3,
    /// Unit image up direction.
    pub up: DVec3,
    /// Tangent of half the vertical field of view.
    pub tan_half_fov: f64,
    /// Distance along `forward` at which rays start; up to there they are straight.
    pub near: f64,
    /// Side of a wormhole that it is on.
    pub side: Side,
}

impl Camera {
    /// A camera at `position` that looks along `forward` with `up` upwards in the image; `vertical_fov` in radians.
    ///
    /// It is on the near side. Returns `None` if `forward` is zero, parallel to `up`, or anything is not finite.
    pub fn new(position: DVec3, forward: DVec3, up: DVec3, vertical_fov: f64, near: f64) -> Option<Self> {
        let forward = forward.try_normalize()?;
        let right = forward.cross(up).try_normalize()?;
        let tan_half_fov = libm::tan(0.5 * vertical_fov);
        let finite = position.is_finite() && tan_half_fov.is_finite() && near.is_finite();
        (finite && tan_half_fov > 0.0 && near >= 0.0).then_some(Self {
            position,
            forward,
            right,
            up: right.cross(forward),
            tan_half_fov,
            near,
            side: Side::Near,
        })
    }

    /// Origin (on the near plane) and unit direction of the ray through a film point.
    ///
    /// `film` is in [0, 1]², (0, 0) the top left corner of the image; `aspect` is width over height.
    pub fn ray(&self, film: DVec2, aspect: f64) -> (DVec3, DVec3) {
        let x = (2.0 * film.x - 1.0) * self.tan_half_fov * aspect;
        let y = (1.0 - 2.0 * film.y) * self.tan_half_fov;
        let along = self.forward + x * self.right + y * self.up;
        (self.position + self.near * along, along.normalize())
    }
}
