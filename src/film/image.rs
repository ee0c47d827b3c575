//! A finished picture: named f32 planes, ready to be written.

/// What can be asked for beside the beauty; a plane nobody asked for is never computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, clap::ValueEnum)]
pub enum Aov {
    /// Coordinate path length from the camera to the first hit, scene units; infinite where nothing is hit.
    Depth,
    /// World shading normal at the first hit.
    Normal,
    /// Colour of the material at the first hit.
    Albedo,
    /// World position of the first hit.
    Position,
    /// Entity index + 1 of the first hit, 0 where nothing is hit.
    Entity,
    /// Variance of the pixel's mean, per colour channel.
    Variance,
    /// Mean number of march steps per path.
    Steps,
    /// Fate of the camera ray.
    Fate,
}

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
    /// Header attributes as name and text: samples per pixel, seed, scene, version, entity names.
    pub attributes: Vec<(String, String)>,
}
