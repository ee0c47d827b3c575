//! Projections of cameras: which rays a point of the film stands for.
//!
//! Each works in the camera's own axes, x right, y up and z forward. Its directions are those of the frame at rest where
//! the ray starts, its lengths are measured in the chart.

mod equirectangular;
mod fisheye;
mod local_ray;
mod orthographic;
mod perspective;
mod thin_lens;

use glam::{DVec2, DVec3};

pub use fisheye::Fisheye;
pub use local_ray::{LocalRay, PixelWidth};
pub use orthographic::Orthographic;
pub use perspective::Perspective;
pub use thin_lens::ThinLens;

/// Projection of a camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Projection {
    /// Straight lines stay straight: a pinhole or a thin lens.
    Perspective(Perspective),
    /// Parallel rays.
    Orthographic(Orthographic),
    /// All directions, by longitude and latitude.
    Equirectangular,
    /// A disk in which distance from the middle is angle.
    Fisheye(Fisheye),
}

impl Projection {
    /// The name in scene files.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Perspective(_) => "perspective",
            Self::Orthographic(_) => "orthographic",
            Self::Equirectangular => "equirectangular",
            Self::Fisheye(_) => "fisheye",
        }
    }

    /// The ray through a point of the film and one of the lens; `None` beside the picture.
    ///
    /// `film` is (0, 0) at the top left corner of the picture, (1, 1) at the bottom right; `lens` is in the unit square,
    /// its middle that of the lens; `aspect` is width over height.
    #[inline]
    pub fn ray(&self, film: DVec2, aspect: f64, lens: DVec2) -> Option<LocalRay> {
        match self {
            Self::Perspective(perspective) => Some(perspective.ray(film, aspect, lens)),
            Self::Orthographic(orthographic) => Some(orthographic.ray(film, aspect)),
            Self::Equirectangular => Some(equirectangular::ray(film)),
            Self::Fisheye(fisheye) => fisheye.ray(film, aspect),
        }
    }

    /// Width of a pixel of a picture of so many pixels.
    pub fn pixel(&self, width: usize, height: usize) -> PixelWidth {
        match self {
            Self::Perspective(perspective) => perspective.pixel(height),
            Self::Orthographic(orthographic) => orthographic.pixel(height),
            Self::Equirectangular => equirectangular::pixel(height),
            Self::Fisheye(fisheye) => fisheye.pixel(width, height),
        }
    }

    /// Angle between the rays of neighbouring pixels over that in the middle of the picture, where rays are at an angle of
    /// cosine `cos` to the view direction: what a pinhole sees of a plane across it is as wide everywhere.
    pub fn relative_angle(&self, cos: f64) -> f64 {
        match self {
            Self::Perspective(_) => cos * cos,
            Self::Orthographic(_) | Self::Equirectangular | Self::Fisheye(_) => 1.0,
        }
    }

    /// True if a ball, as straight rays show it, is in the picture at least in part.
    pub fn sees_ball(&self, center: DVec3, radius: f64, aspect: f64) -> bool {
        match self {
            Self::Perspective(perspective) => perspective.sees_ball(center, radius, aspect),
            Self::Orthographic(orthographic) => orthographic.sees_ball(center, radius, aspect),
            Self::Equirectangular => true,
            Self::Fisheye(fisheye) => fisheye.sees_ball(center, radius),
        }
    }

    /// Angle from the left to the right of the picture, radians; `None` if all rays are parallel.
    pub fn horizontal_fov(&self, aspect: f64) -> Option<f64> {
        match self {
            Self::Perspective(perspective) => Some(perspective.horizontal_fov(aspect)),
            Self::Orthographic(_) => None,
            Self::Equirectangular => Some(equirectangular::HORIZONTAL_FOV),
            Self::Fisheye(fisheye) => Some(fisheye.horizontal_fov()),
        }
    }

    /// The start nearest to `point` of a ray that leaves at `near`, which is a plane or, around a camera that looks
    /// everywhere, a sphere.
    pub fn nearest_start(&self, point: DVec3, near: f64, aspect: f64) -> DVec3 {
        match self {
            Self::Perspective(perspective) => perspective.nearest_start(point, near, aspect),
            Self::Orthographic(orthographic) => orthographic.nearest_start(point, near, aspect),
            Self::Equirectangular | Self::Fisheye(_) => near * point.normalize_or(DVec3::Z),
        }
    }

    /// Width over height of the picture if the file does not say; `None` if any will do.
    pub fn own_aspect(&self) -> Option<f64> {
        match self {
            Self::Perspective(_) | Self::Orthographic(_) => None,
            Self::Equirectangular => Some(equirectangular::ASPECT),
            Self::Fisheye(_) => Some(fisheye::ASPECT),
        }
    }
}
