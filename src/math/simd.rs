//! Vector instructions that kernels are compiled for, chosen once when the program starts.

use std::sync::OnceLock;

/// Widest vector instructions that kernels may use; no choice changes a bit of any result.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
pub enum SimdLevel {
    /// The widest that the machine has
    Auto,
    /// Those that every machine has: SSE2 on x86-64
    Baseline,
    /// AVX2, 32 bytes
    Avx2,
    /// AVX-512, 64 bytes
    Avx512,
}

static CHOSEN: OnceLock<pulp::Arch> = OnceLock::new();

/// Lets kernels use vector instructions up to `level`; to be called before any of them runs.
///
/// # Errors
/// The machine does not have them, or kernels run already with others.
pub fn choose(level: SimdLevel) -> Result<(), String> {
    let arch = match level {
        SimdLevel::Auto => return Ok(()),
        SimdLevel::Baseline => Some(baseline()),
        SimdLevel::Avx2 => avx2(),
        SimdLevel::Avx512 => avx512(),
    };
    let arch = arch.ok_or("this machine does not have these vector instructions")?;
    CHOSEN.set(arch).map_err(|_| "kernels are running already".to_owned())
}

/// The instructions that kernels use.
#[inline(always)]
pub(super) fn arch() -> pulp::Arch {
    *CHOSEN.get_or_init(pulp::Arch::new)
}

#[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
fn baseline() -> pulp::Arch {
    pulp::Arch::Scalar
}

#[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
fn avx2() -> Option<pulp::Arch> {
    pulp::x86::V3::try_new().map(pulp::Arch::V3)
}

#[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
fn avx512() -> Option<pulp::Arch> {
    pulp::x86::V4::try_new().map(pulp::Arch::V4)
}

#[cfg(not(any(target_arch = "x86", target_arch = "x86_64")))]
fn baseline() -> pulp::Arch {
    pulp::Arch::new()
}

#[cfg(not(any(target_arch = "x86", target_arch = "x86_64")))]
fn avx2() -> Option<pulp::Arch> {
    None
}

#[cfg(not(any(target_arch = "x86", target_arch = "x86_64")))]
fn avx512() -> Option<pulp::Arch> {
    None
}
