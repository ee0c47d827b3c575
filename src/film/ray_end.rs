//! Ends of rays, as the `fate` plane numbers them.

/// End of a ray; the numbers are those of the `fate` plane.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(u8)]
pub enum RayEnd {
    /// Met a surface.
    Hit = 1,
    /// Left to infinity.
    Escaped = 2,
    /// Fell through the horizon.
    Captured = 3,
    /// Ran out of steps.
    StepLimit = 4,
    /// Lost its state.
    #[default]
    NonFinite = 5,
}
