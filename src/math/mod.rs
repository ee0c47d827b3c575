//! Small numerics that no crate gives.

pub(crate) mod bernstein;
pub(crate) mod cauchy;
pub(crate) mod chebyshev;
pub mod columns;
pub(crate) mod concentric;
pub mod cross_exact;
pub mod dual;
pub(crate) mod fast_log2;
pub(crate) mod floor;
pub mod frame;
pub(crate) mod half_turn;
pub(crate) mod kernel;
pub(crate) mod prefetch;
pub(crate) mod quadrature;
pub mod real;
pub(crate) mod rescale;
pub(crate) mod rotation;
pub mod simd;
pub(crate) mod simd8;
pub(crate) mod sin_cos_turns;
