//! Small numerics that no crate gives.

pub mod bernstein;
pub mod chebyshev;
pub mod columns;
pub mod dual;
pub mod exact;
pub mod frame;
pub mod kernel;
pub mod prefetch;
pub mod quadrature;
pub mod real;
pub mod rotation;
pub mod rough;
pub mod simd;
pub mod turn;
