//! The paper's integrator: classical RK4 on equations of motion in coordinate time.
//!
//! Reference: \[J\] Jackson, Normann, Hatledal 2025, "The Warped Universe", eqs. (7), (8) and Algorithm 2.

use glam::DVec3;

use crate::spacetime::ConformallyFlat;

/// Position and momentum after coordinate time `dt` from `x` and `p`, |p| = n.
pub fn rk4_paper(medium: &impl ConformallyFlat, (x, p): (DVec3, DVec3), dt: f64) -> (DVec3, DVec3) {
    let (x1, p1) = medium.motion(x, p);
    let (x2, p2) = medium.motion(x + 0.5 * dt * x1, p + 0.5 * dt * p1);
    let (x3, p3) = medium.motion(x + 0.5 * dt * x2, p + 0.5 * dt * p2);
    let (x4, p4) = medium.motion(x + dt * x3, p + dt * p3);
    (x + dt / 6.0 * (x1 + 2.0 * (x2 + x3) + x4), p + dt / 6.0 * (p1 + 2.0 * (p2 + p3) + p4))
}
