//! What a render did, counted.

use serde::Serialize;

/// Counts and times of one render.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Stats {
    /// Wall time of the render, seconds.
    pub seconds: f64,
    /// Camera paths traced.
    pub paths: u64,
    /// Rays traced, the camera's included.
    pub rays: u64,
    /// Integration steps.
    pub steps: u64,
    /// BVH queries.
    pub queries: u64,
    /// How the rays ended.
    pub fates: Fates,
}

/// How many rays ended in which way.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub struct Fates {
    /// Met a surface.
    pub hit: u64,
    /// Left the scene for infinity.
    pub escaped: u64,
    /// Fell through a horizon.
    pub captured: u64,
    /// Were given up after the most steps allowed; their light is lost.
    pub step_limit: u64,
    /// Left the range of numbers; their light is lost.
    pub non_finite: u64,
}
