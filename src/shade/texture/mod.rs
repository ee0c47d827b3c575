//! Pictures on surfaces.

mod footprint;
mod image;
mod lookup;
mod maps;
mod opacity;

pub use footprint::Footprint;
pub use image::{MipImage, Raster};
pub use lookup::{Texture, UvTransform, Wrap};
pub use maps::{AnisotropyMap, FilmMap, Maps, NormalMap, TextureId, VertexColors};
pub use opacity::{Opacity, TextureChannel};
