//! Footprint of a ray on a surface, by which textures are filtered.

/// Widths of a footprint, scene units; 0 for a point, which is not filtered.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Footprint {
    /// For textures of what a surface scatters.
    pub scattering: f64,
    /// For textures of what it emits: those are not filtered where light sampling, which looks at points, finds it too.
    pub emission: f64,
}

impl Footprint {
    /// The same for all textures.
    pub fn of_width(width: f64) -> Self {
        Self { scattering: width, emission: width }
    }
}
