//! Materials, their lobes, light from infinity, and the random numbers that choose among them.

mod bsdf;
mod environment;
mod incidence;
mod material;
mod media;
mod sampler;
mod sobol;
mod sun_sky;
mod texture;

pub(crate) use bsdf::sample_cosine;
pub use bsdf::{
    Bsdf, Dielectric, Diffuse, Lacquered, Lobe, Mirror, Principled, SortedHits, Variation, fresnel,
};
pub use environment::{Environment, LatLong};
pub use incidence::{Bounce, Incidence, Response};
pub use material::{Material, attenuation, relative_index};
pub use media::{InterfaceCrossing, Media};
pub use sampler::{Key, SamplePoint, Sampler};
pub use sun_sky::{ClearSky, SunDisk, SunSky};
pub use texture::{
    AnisotropyMap, FilmMap, Footprint, Maps, MipImage, NormalMap, Opacity, Raster, Texture, TextureChannel,
    TextureId, UvTransform, VertexColors, Wrap,
};
