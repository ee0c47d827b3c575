//! The numbers that rays are followed in: f32, f64, and either with a derivative.

use std::fmt::Debug;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// Number that the march works in.
///
/// Comparisons are those of the value: a derivative never decides anything.
pub trait Real:
    Copy
    + Debug
    + Default
    + PartialOrd
    + Send
    + Sync
    + 'static
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// Distance from 1 to the next larger number.
    const EPSILON: f64;

    /// The nearest number to `x`.
    fn of(x: f64) -> Self;

    /// The value in f64.
    fn value(self) -> f64;

    /// √self.
    fn sqrt(self) -> Self;

    /// |self|.
    fn abs(self) -> Self;

    /// The smaller of two; `other` if `self` is NaN.
    #[inline(always)]
    fn at_most(self, other: Self) -> Self {
        if self < other { self } else { other }
    }

    /// The larger of two; `other` if `self` is NaN.
    #[inline(always)]
    fn at_least(self, other: Self) -> Self {
        if self > other { self } else { other }
    }

    /// self².
    #[inline(always)]
    fn squared(self) -> Self {
        self * self
    }
}

macro_rules! real {
    ($float:ident) => {
        impl Real for $float {
            const EPSILON: f64 = $float::EPSILON as f64;

            #[inline(always)]
            fn of(x: f64) -> Self {
                x as $float
            }

            #[inline(always)]
            fn value(self) -> f64 {
                f64::from(self)
            }

            #[inline(always)]
            fn sqrt(self) -> Self {
                $float::sqrt(self)
            }

            #[inline(always)]
            fn abs(self) -> Self {
                $float::abs(self)
            }
        }
    };
}
real!(f32);
real!(f64);
