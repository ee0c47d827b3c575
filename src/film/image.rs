//! A finished picture: named f32 planes, ready to be written.

/// What can be asked for beside the beauty; a plane nobody asked for is never computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, clap::ValueEnum)]
pub enum Aov {
    /// Coordinate path length from the camera to the first hit, scene units; infinite where nothing is hit.
    Depth,
    /// World shading normal at the first hit, mean over all samples (zero where nothing is hit), not renormalised.
    Normal,
    /// Colour of the material at the first hit, mean over all samples.
    Albedo,
    /// World position of the first hit, mean over the samples that hit.
    Position,
    /// Entity index + 1 of the first hit of the first sample, 0 where nothing is hit.
    Entity,
    /// Variance of the pixel's mean, per colour channel.
    Variance,
    /// Mean number of march steps per path, all its rays together.
    Steps,
    /// Fate of the camera ray of the first sample: 1 hit, 2 escaped, 3 captured, 4 step limit, 5 non-finite.
    Fate,
}

impl Aov {
    /// Names of the channels that hold this plane in an EXR, in the order in which the image keeps them.
    ///
    /// All are 32-bit floats; indices (`ID`) and counts (`N`) too, since an f32 holds integers below 2²⁴ exactly.
    pub fn channels(self) -> &'static [&'static str] {
        match self {
            Aov::Depth => &["depth.Z"],
            Aov::Normal => &["normal.X", "normal.Y", "normal.Z"],
            Aov::Albedo => &["albedo.R", "albedo.G", "albedo.B"],
            Aov::Position => &["position.X", "position.Y", "position.Z"],
            Aov::Entity => &["entity.ID"],
            Aov::Variance => &["variance.R", "variance.G", "variance.B"],
            Aov::Steps => &["steps.N"],
            Aov::Fate => &["fate.ID"],
        }
    }
}

/// Names of the channels that every image has.
pub const BEAUTY: [&str; 4] = ["R", "G", "B", "A"];

/// One named channel of an image.
#[derive(Clone, Debug, PartialEq)]
pub struct Plane {
    /// Channel name as it appears in the EXR, e.g. `R`, `normal.X`.
    pub name: String,
    /// Row-major values, row 0 at the top.
    pub values: Vec<f32>,
}

/// A finished picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Image {
    /// Width of the whole picture, pixels.
    pub width: usize,
    /// Height of the whole picture, pixels.
    pub height: usize,
    /// First column and row of the data window; planes hold only the data window.
    pub origin: (usize, usize),
    /// Size of the data window.
    pub size: (usize, usize),
    /// `R`, `G`, `B`, `A`, then what was asked for.
    pub planes: Vec<Plane>,
    /// Header attributes as name and text: samples per pixel, seed, entity names (`entity.N`, N as in the entity plane).
    pub attributes: Vec<(String, String)>,
}

impl Image {
    /// The values of the plane called `name`, row-major over the data window.
    pub fn plane(&self, name: &str) -> Option<&[f32]> {
        self.planes.iter().find(|plane| plane.name == name).map(|plane| plane.values.as_slice())
    }

    /// Whether the data window is a part of the picture and every plane fills it.
    pub fn is_consistent(&self) -> bool {
        let fits = |start: usize, size: usize, whole: usize| size > 0 && start + size <= whole;
        fits(self.origin.0, self.size.0, self.width)
            && fits(self.origin.1, self.size.1, self.height)
            && self.planes.iter().all(|plane| plane.values.len() == self.size.0 * self.size.1)
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use clap::ValueEnum;

    use super::*;

    #[test]
    fn no_two_planes_share_a_channel_name() {
        let aovs = Aov::value_variants().iter().flat_map(|aov| aov.channels());
        let names: Vec<&str> = BEAUTY.iter().chain(aovs).copied().collect();
        assert_eq!(names.len(), names.iter().collect::<BTreeSet<_>>().len());
    }
}
