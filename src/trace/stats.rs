//! What a render did, counted.

use serde::Serialize;

/// Counts and times of one render.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Stats {
    /// Wall time of the render, seconds.
    pub seconds: f64,
}
