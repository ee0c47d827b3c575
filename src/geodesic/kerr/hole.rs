//! The hole in units of its mass, in the ingoing chart that rays are followed in.

use glam::DVec3;

use crate::spacetime::KerrNewman;

/// Spin and charge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UnitHole {
    /// a/M about z, of either sign.
    pub a: f64,
    /// (Q/M)².
    pub e2: f64,
    /// Inverse radius of the horizon.
    pub horizon: f64,
}

/// ẑ × a vector.
#[inline(always)]
pub(super) fn about_axis(n: DVec3) -> DVec3 {
    DVec3::new(-n.y, n.x, 0.0)
}

/// A vector turned about z by the angle of this sine and cosine.
#[inline(always)]
pub(super) fn turned_by((sin, cos): (f64, f64), n: DVec3) -> DVec3 {
    DVec3::new(cos * n.x - sin * n.y, sin * n.x + cos * n.y, n.z)
}

impl UnitHole {
    /// A hole of spin `a` and charge `e`, both over the mass.
    pub fn new(a: f64, e: f64) -> Self {
        let hole = KerrNewman::new(2.0, a, e);
        Self { a, e2: e * e, horizon: 1.0 / hole.horizon() }
    }

    /// The hole of a scene, whose rays are traced into the past: with time reversed, its outgoing chart is the ingoing
    /// one of a hole that spins the other way.
    pub fn reversed(hole: &KerrNewman) -> Self {
        Self::new(-hole.spin(), hole.charge())
    }

    /// Spheroidal radius r and unit vector N of a position: X = rN + a ẑ×N.
    #[inline(always)]
    pub fn spheroidal(&self, x: DVec3) -> (f64, DVec3) {
        let a = self.a;
        let b = x.length_squared() - a * a;
        let az = 2.0 * a * x.z;
        let root = (b * b + az * az).sqrt();
        // r² = (b + root)/2; inside the ring's sphere b cancels, and the other form is exact.
        let outside = 0.5 * (b + root);
        let inside = 0.5 * az * az / (root - b);
        let r2 = if b >= 0.0 { outside } else { inside };
        let r = r2.sqrt();
        let per = 1.0 / (r2 + a * a);
        (r, DVec3::new((r * x.x + a * x.y) * per, (r * x.y - a * x.x) * per, x.z / r))
    }

    /// Position of the point of inverse radius `u` and unit vector `n`.
    #[inline(always)]
    pub fn position(&self, u: f64, n: DVec3) -> DVec3 {
        n / u + self.a * about_axis(n)
    }

    /// F of the metric η + F l l.
    #[inline(always)]
    pub fn potential(&self, r: f64, mu: f64) -> f64 {
        (2.0 * r - self.e2) / (r * r + self.a * self.a * mu * mu)
    }
}
