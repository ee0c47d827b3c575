//! The paper's integrator: classical RK4 on its equations of motion in coordinate time.
//!
//! Reference: \[J\] Jackson, Normann, Hatledal 2025, "The Warped Universe", eqs. (7), (8) and Algorithm 2. The equations
//! hold on null rays with |p| = (1+u)³/(1−u); the paper's renormalisation to |p| = 1 makes them timelike and is left
//! out.

use glam::DVec3;

/// RK4 on \[J\] (7), (8) for a hole of Schwarzschild radius `r_s` at the origin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PaperRk4 {
    /// r_s.
    pub r_s: f64,
}

impl PaperRk4 {
    /// (dx/dt, dp/dt).
    fn rhs(&self, x: DVec3, p: DVec3) -> (DVec3, DVec3) {
        let r = x.length();
        let u = self.r_s / (4.0 * r);
        let (plus, minus) = (1.0 + u, 1.0 - u);
        let velocity = p * (minus * minus / plus.powi(6)); // [J] (7)
        let pull = p.length_squared() * minus * minus / plus.powi(7) + 1.0 / (1.0 - u * u);
        (velocity, x * (-self.r_s / (2.0 * r * r * r) * pull)) // [J] (8)
    }

    /// Position and momentum after coordinate time `dt`.
    pub fn step(&self, x: DVec3, p: DVec3, dt: f64) -> (DVec3, DVec3) {
        let (x1, p1) = self.rhs(x, p);
        let (x2, p2) = self.rhs(x + 0.5 * dt * x1, p + 0.5 * dt * p1);
        let (x3, p3) = self.rhs(x + 0.5 * dt * x2, p + 0.5 * dt * p2);
        let (x4, p4) = self.rhs(x + dt * x3, p + dt * p3);
        (x + dt / 6.0 * (x1 + 2.0 * (x2 + x3) + x4), p + dt / 6.0 * (p1 + 2.0 * (p2 + p3) + p4))
    }
}
