//! The lens map: rays of light from one point to another, in closed form but for one integral.
//!
//! Let B = n/w be the impact parameter of a ray that grazes the sphere of inverse radius w. In the plane in which a
//! point has the polar radius B instead of ρ, a ray of impact parameter b is at the angle θ, sin θ = b/B, to the
//! radius. That is a straight line; only the angle swept along it is stretched (and coordinate time as its length is):
//!
//! ```text
//! dφ = κ dθ,   dt = κ dl,   κ = −d ln w / d ln B = 1/(1 − w g/n²).
//! ```
//!
//! κ is 1 in flat space and has a pole at the photon sphere, where B is least, at the critical impact parameter b_c.
//! With s² = 1 − b_c/B, s > 0 outside the photon sphere and s < 0 inside, h = κ s is analytic from the horizon or the
//! other side of a throat (s = −1) to infinity (s = 1): one short polynomial holds the whole lens. From
//!
//! ```text
//! dφ = 2 h ds / √((m − 1 + s²)(m + 1 − s²)),   m = b_c/b,
//! ```
//!
//! hyperbolic substitutions take out what is singular near b = b_c, and a Gauss–Legendre rule with a few nodes gives φ
//! and its derivative to any accuracy.
//!
//! A throat that is a cylinder is one point of it: there B is b_c, and a ray sweeps, per unit of the cylinder's length over
//! its radius, 1/√(m² − 1). On its sides h is the same even function, whose singularities may be near s = 0, on the
//! imaginary axis.
//!
//! Two points are joined by one ray in each winding class. Where they lie on the same side of the photon sphere, it is
//! found as a straight line of the plane: γ, the angle that it sweeps there, is the unknown, and φ(γ) grows from 0
//! without bound. Where they lie on both sides, m is. The solid angle at x over the area at y, in the chart, is
//!
//! ```text
//! dΩ/dA = b q_x² w_y² / (|sin φ| R),   q = 1/B,   R = |cos θ_x cos θ_y dφ/db|,
//! ```
//!
//! with R = φ′(γ) D on one side, D = q_x q_y times the length of the straight line; in flat space this is 1/distance².

mod connection;
mod estimates;
mod inwards;
mod map;
mod rules;
mod search;
mod sites;
mod swept;
#[cfg(test)]
mod tests;
mod track;
mod travel_time;
mod weak;
mod weak_beams;
mod weak_rays;

pub use connection::Connection;
pub use inwards::InwardBending;
pub use map::{Lens, Site};
pub use weak::WeakBending;
pub use weak_beams::RayDirections;
pub use weak_rays::LensRay;
