//! Small numerics that no crate gives.

pub mod bernstein;
pub mod chebyshev;
pub mod columns;
pub mod cross_exact;
pub mod dual;
pub mod fast_log2;
pub mod frame;
pub mod kernel;
pub mod prefetch;
pub mod quadrature;
pub mod real;
pub mod rotation;
pub mod simd;
pub mod sin_cos_turns;
