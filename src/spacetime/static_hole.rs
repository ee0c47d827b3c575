//! A hole that does not spin.

/// Hole that does not spin, charged or not.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StaticHole {
    /// Mass M.
    pub mass: f64,
    /// Charge Q/M, from −1 to 1.
    pub charge: f64,
}
