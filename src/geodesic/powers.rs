//! Length of Taylor series by the tolerance: compiled once for each.

/// Work with series of a number of coefficients.
pub trait UsePowers {
    /// Result.
    type Output;

    /// Does the work with series of `P` coefficients.
    fn with<const P: usize>(self) -> Self::Output;
}

/// Does `work` with the length of series that is fastest for rays of this tolerance, radians. Too long a series is wrong
/// for a loose tolerance: its steps leave the circle of convergence.
pub fn with_powers<W: UsePowers>(tolerance: f64, work: W) -> W::Output {
    if tolerance >= 1e-4 {
        work.with::<8>()
    } else if tolerance >= 3e-6 {
        work.with::<10>()
    } else if tolerance >= 1e-7 {
        work.with::<12>()
    } else {
        work.with::<14>()
    }
}
