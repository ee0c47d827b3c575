//! Pictures on surfaces, of which the mean colour counts: walls, floors and lamps then give the right amount of light.

use std::collections::HashMap;
use std::hash::Hash;

use glam::Vec3;

use super::flaw::Flaw;
use super::image::mean_colour;
use super::memory::Memory;

/// Mean colours of pictures, linear RGB; each picture is decoded once.
pub(super) struct MeanColors<K> {
    /// Or what is wrong with the picture.
    known: HashMap<K, Result<Vec3, String>>,
}

impl<K> Default for MeanColors<K> {
    fn default() -> Self {
        Self { known: HashMap::new() }
    }
}

impl<K: Eq + Hash> MeanColors<K> {
    /// The mean colour of a picture, whose file `read` gives, or why there is none.
    pub fn of<B: AsRef<[u8]>>(
        &mut self,
        picture: K,
        memory: &Memory,
        read: impl FnOnce() -> Result<B, Flaw>,
    ) -> Result<Vec3, String> {
        let mean = || mean_colour(read()?.as_ref(), memory);
        self.known.entry(picture).or_insert_with(|| mean().map_err(|flaw| flaw.problem)).clone()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_picture_is_decoded_once_and_counts_as_its_linear_mean() {
        let mut bytes = std::io::Cursor::new(Vec::new());
        let picture = image::RgbImage::from_fn(2, 1, |x, _| image::Rgb([255 * x as u8, 128, 0]));
        picture.write_to(&mut bytes, image::ImageFormat::Png).unwrap();
        let (mut means, memory) = (MeanColors::default(), Memory::default());
        let mean = means.of("a", &memory, || Ok(bytes.get_ref())).unwrap();
        assert!((mean - Vec3::new(0.5, 0.2158605, 0.0)).length() < 1e-6, "{mean}");
        assert_eq!(means.of("a", &memory, || -> Result<Vec<u8>, Flaw> { panic!("read again") }), Ok(mean));
        assert!(means.of("b", &memory, || Ok(b"no picture")).is_err());
    }
}
