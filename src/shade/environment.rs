//! Light from infinity.

use glam::{DMat3, DVec3, Vec3};

use super::sun_sky::SunSky;

/// Radiance that arrives from infinity, by direction.
#[derive(Clone, Debug, PartialEq)]
pub enum Environment {
    /// No light.
    Black,
    /// Constant radiance from everywhere.
    Constant(Vec3),
    /// A vertical gradient, from straight down to the horizon to straight up: the sky of a bare file without light.
    Gradient {
        /// Radiance from −Y.
        ground: Vec3,
        /// Radiance from the horizon.
        horizon: Vec3,
        /// Radiance from +Y.
        zenith: Vec3,
    },
    /// A latitude-longitude image.
    Image(LatLong),
    /// A clear sky with the sun, over a plain.
    SunSky(SunSky),
}

/// A latitude-longitude image: row 0 is +Y; the middle column is −Z, u grows towards +X.
#[derive(Clone, Debug, PartialEq)]
pub struct LatLong {
    /// Pixels per row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Linear RGB radiance, row-major.
    pub pixels: Vec<Vec3>,
    /// World direction → image direction.
    pub from_world: DMat3,
}

impl Environment {
    /// Radiance arriving from infinity along `-direction`, i.e. seen when looking along the unit vector `direction`.
    pub fn radiance(&self, direction: DVec3) -> Vec3 {
        match self {
            Environment::Black => Vec3::ZERO,
            Environment::Constant(radiance) => *radiance,
            Environment::Gradient { ground, horizon, zenith } => {
                let height = direction.y as f32;
                let end = if height < 0.0 { *ground } else { *zenith };
                horizon.lerp(end, height.abs().sqrt())
            }
            Environment::Image(image) => image.radiance(direction),
            Environment::SunSky(sky) => sky.radiance(direction),
        }
    }

    /// Memory of its tables, bytes.
    pub fn memory_bytes(&self) -> usize {
        match self {
            Environment::Black | Environment::Constant(_) | Environment::Gradient { .. } => 0,
            Environment::Image(image) => size_of_val(image.pixels.as_slice()),
            Environment::SunSky(sky) => sky.memory_bytes(),
        }
    }

    /// True if the light from infinity depends on its direction.
    pub fn varies(&self) -> bool {
        match self {
            Environment::Black | Environment::Constant(_) => false,
            Environment::Gradient { .. } | Environment::Image(_) => true,
            Environment::SunSky(sky) => !sky.is_black(),
        }
    }

    /// True if no light comes from infinity.
    pub fn is_black(&self) -> bool {
        match self {
            Environment::Black => true,
            Environment::Constant(radiance) => *radiance == Vec3::ZERO,
            Environment::SunSky(sky) => sky.is_black(),
            Environment::Gradient { .. } | Environment::Image(_) => false,
        }
    }
}

impl LatLong {
    /// Bilinear look-up, periodic in longitude and clamped at the poles.
    fn radiance(&self, direction: DVec3) -> Vec3 {
        let d = self.from_world * direction;
        let u = 0.5 + libm::atan2(d.x, -d.z) / std::f64::consts::TAU;
        let v = libm::acos(d.y.clamp(-1.0, 1.0)) / std::f64::consts::PI;
        let x = u * self.width as f64 - 0.5;
        let y = (v * self.height as f64 - 0.5).clamp(0.0, (self.height - 1) as f64);
        let (column, row) = (x.floor(), y.floor());
        let (fx, fy) = ((x - column) as f32, (y - row) as f32);
        let left = (column as i64).rem_euclid(self.width as i64) as usize;
        let right = (left + 1) % self.width;
        let top = row as usize;
        let bottom = (top + 1).min(self.height - 1);
        let at = |x: usize, y: usize| self.pixels[y * self.width + x];
        let upper = at(left, top).lerp(at(right, top), fx);
        let lower = at(left, bottom).lerp(at(right, bottom), fx);
        upper.lerp(lower, fy)
    }
}
