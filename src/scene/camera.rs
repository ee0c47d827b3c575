//! The baked camera.

use glam::{DVec2, DVec3};

use super::projection::{Perspective, Projection};
use crate::spacetime::Side;

/// A camera at rest in the static frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// Position of the pinhole, or of the middle of the lens or the picture plane, world.
    pub position: DVec3,
    /// Unit view direction.
    pub forward: DVec3,
    /// Unit image +x direction.
    pub right: DVec3,
    /// Unit image up direction.
    pub up: DVec3,
    /// Rays of a point of the film.
    pub projection: Projection,
    /// Distance along `forward`, or along each ray if they go all around, at which rays start; up to there they are
    /// straight.
    pub near: f64,
    /// Side of a wormhole that it is on.
    pub side: Side,
}

impl Camera {
    /// A pinhole at `position` that looks along `forward` with `up` upwards in the image; `vertical_fov` in radians.
    ///
    /// It is on the near side. Returns `None` if `forward` is zero, parallel to `up`, or anything is not finite.
    pub fn new(position: DVec3, forward: DVec3, up: DVec3, vertical_fov: f64, near: f64) -> Option<Self> {
        let projection = Projection::Perspective(Perspective::new(vertical_fov)?);
        Self::with(projection, position, forward, up, near)
    }

    /// Like [`Self::new`], with any projection.
    pub fn with(
        projection: Projection,
        position: DVec3,
        forward: DVec3,
        up: DVec3,
        near: f64,
    ) -> Option<Self> {
        let forward = forward.try_normalize()?;
        let right = forward.cross(up).try_normalize()?;
        let finite = position.is_finite() && near.is_finite();
        let up = right.cross(forward);
        (finite && near >= 0.0).then_some(Self {
            position,
            forward,
            right,
            up,
            projection,
            near,
            side: Side::Near,
        })
    }

    /// Start and unit direction of the ray through a point of the film and one of the lens; `None` beside the picture of
    /// a fisheye.
    ///
    /// `film` is (0, 0) at the top left corner of the image, (1, 1) at the bottom right; `aspect` is width over height;
    /// `lens` is in the unit square, its middle that of the lens.
    #[inline]
    pub fn ray(&self, film: DVec2, aspect: f64, lens: DVec2) -> Option<(DVec3, DVec3)> {
        let local = self.projection.ray(film, aspect, lens)?;
        let along = self.in_world(local.along);
        let origin = self.position + self.in_world(local.origin);
        Some((origin + self.near * along, along.normalize()))
    }

    /// Start of the ray that leaves the camera's position in a unit `direction`; `None` if that never gets to the near
    /// plane.
    pub fn start(&self, direction: DVec3) -> Option<DVec3> {
        /// Sine of an angle below which directions count as parallel.
        const PARALLEL: f64 = 1e-6;
        if self.near == 0.0 {
            return Some(self.position);
        }
        let ahead = match self.projection {
            Projection::Perspective(_) | Projection::Orthographic(_) => direction.dot(self.forward),
            Projection::Equirectangular | Projection::Fisheye(_) => 1.0,
        };
        (ahead > PARALLEL).then(|| self.position + self.near / ahead * direction)
    }

    /// Start nearest to `point` of a ray.
    pub(super) fn nearest_start(&self, point: DVec3, aspect: f64) -> DVec3 {
        let local = self.projection.nearest_start(self.local(point), self.near, aspect);
        self.position + self.in_world(local)
    }

    /// True if a ball, as straight rays show it, is in the picture at least in part.
    pub(super) fn sees_ball(&self, center: DVec3, radius: f64, aspect: f64) -> bool {
        self.projection.sees_ball(self.local(center), radius, aspect)
    }

    fn in_world(&self, local: DVec3) -> DVec3 {
        local.z * self.forward + local.x * self.right + local.y * self.up
    }

    fn local(&self, point: DVec3) -> DVec3 {
        let offset = point - self.position;
        DVec3::new(offset.dot(self.right), offset.dot(self.up), offset.dot(self.forward))
    }
}
