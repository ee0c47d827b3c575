//! A picture to compare others with, and how much noise it has itself.

use std::iter::zip;

use super::compare::{EPSILON, Mismatch, PicturePair};
use super::noise::CHANNELS;
use crate::film::Image;

/// A picture that is taken for true but for its noise.
pub struct Reference {
    /// The picture.
    pub image: Image,
    /// Its noise; `None` if nothing is known of it.
    pub noise: Option<Variances>,
}

/// Contributions of the noise of a reference to measured errors.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Variances {
    /// To the mean square of differences, unit of radiance².
    pub mse: f64,
    /// To the mean of (a − b)²/(b² + [`EPSILON`]).
    pub relmse: f64,
    /// Variance of the mean of the picture, unit of radiance².
    pub mean: f64,
}

impl Reference {
    /// A picture from elsewhere, which messages call `name`, for pictures of `size` pixels; its noise is that of its
    /// variances, if it has some.
    ///
    /// # Errors
    /// If it has no colours, is not whole, or not of this size.
    pub fn given(image: Image, name: &str, size: (usize, usize)) -> Result<Self, Mismatch> {
        PicturePair::new((name, &image), (name, &image))?;
        if (image.width, image.height) != size {
            let (width, height) = (image.width, image.height);
            let cause = format!(
                "`{name}` is a picture of {width}x{height} pixels, the study one of {}x{}",
                size.0, size.1
            );
            return Err(Mismatch { cause, remedy: "give the reference's size as --size" });
        }
        if image.size != size {
            let cause = format!("`{name}` holds only a part of its picture");
            return Err(Mismatch { cause, remedy: "give a reference that was rendered without --crop" });
        }
        let noise = Variances::of_planes(&image);
        Ok(Self { image, noise })
    }

    /// The mean of two pictures of the same pixels, as many samples each and of different seeds: half their difference
    /// has the variance of their mean.
    pub(super) fn of_halves(mut first: Image, second: &Image) -> Self {
        let half = |values: &[f32], other: &[f32]| -> Vec<f64> {
            zip(values, other).map(|(&a, &b)| 0.5 * (f64::from(a) - f64::from(b))).collect()
        };
        let halves = CHANNELS.map(|(color, _)| {
            let values = |image: &Image| image.channel(color).unwrap_or_default().to_vec();
            half(&values(&first), &values(second))
        });
        for plane in &mut first.channels {
            let other = second.channel(&plane.name).unwrap_or_default();
            plane.values.iter_mut().zip(other).for_each(|(a, &b)| *a = 0.5 * (*a + b));
        }
        let noise = Variances::of(&first, |pixel| {
            // Colours of one sample are not independent: their mean has its own difference.
            let [r, g, b] = [0, 1, 2].map(|color: usize| halves[color].get(pixel).copied().unwrap_or(0.0));
            ([r, g, b].map(|half| half * half), ((r + g + b) / 3.0).powi(2))
        });
        Self { image: first, noise: Some(noise) }
    }
}

impl Variances {
    /// As the variance channels of `image` tell, if it has them.
    fn of_planes(image: &Image) -> Option<Self> {
        let [r, g, b] = CHANNELS.map(|(_, variance)| image.channel(variance));
        let channels = [r?, g?, b?];
        Some(Self::of(image, |pixel| {
            let variances = channels.map(|plane| f64::from(plane[pixel]).max(0.0));
            // As if the colours varied together.
            let mean = variances.iter().map(|variance| variance.sqrt()).sum::<f64>() / 3.0;
            (variances, mean * mean)
        }))
    }

    /// From the variances of every pixel's `R`, `G`, `B` and of the mean of the three.
    fn of(image: &Image, variances: impl Fn(usize) -> ([f64; 3], f64)) -> Self {
        let pixels = image.size.0 * image.size.1;
        let mut sums = Self::default();
        for pixel in 0..pixels {
            let (colors, mean) = variances(pixel);
            if !(colors.iter().all(|variance| variance.is_finite()) && mean.is_finite()) {
                continue;
            }
            sums.mean += mean;
            for ((color, _), variance) in zip(CHANNELS, colors) {
                let value = image.channel(color).map_or(0.0, |plane| f64::from(plane[pixel]));
                sums.mse += variance;
                sums.relmse += variance / (value * value + EPSILON);
            }
        }
        let n = pixels as f64;
        Self { mse: sums.mse / (3.0 * n), relmse: sums.relmse / (3.0 * n), mean: sums.mean / (n * n) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::Channel;

    fn picture(colors: [&[f32]; 3]) -> Image {
        let plane = |((name, _), values): ((&str, &str), &[f32])| Channel {
            name: name.to_owned(),
            values: values.to_vec(),
        };
        let size = (colors[0].len(), 1);
        Image {
            width: size.0,
            height: size.1,
            origin: (0, 0),
            size,
            channels: zip(CHANNELS, colors).map(plane).collect(),
            attributes: Vec::new(),
        }
    }

    #[test]
    fn two_halves_give_their_mean_and_its_variance() {
        let first = picture([&[1.0, 0.0], &[1.0, 0.0], &[1.0, 0.0]]);
        let second = picture([&[3.0, 0.0], &[1.0, 0.0], &[1.0, 0.0]]);
        let reference = Reference::of_halves(first, &second);
        assert_eq!(reference.image.channel("R"), Some(&[2.0, 0.0][..]));
        // One value in six has a variance of 1; the mean of its pixel one of 1/9.
        let expected = Variances { mse: 1.0 / 6.0, relmse: 1.0 / 4.01 / 6.0, mean: 1.0 / 36.0 };
        let noise = reference.noise.unwrap();
        assert!((noise.mse - expected.mse).abs() < 1e-12);
        assert!((noise.relmse - expected.relmse).abs() < 1e-12);
        assert!((noise.mean - expected.mean).abs() < 1e-12);
    }

    #[test]
    fn planes_of_variance_say_what_the_noise_is() {
        let mut image = picture([&[2.0, 0.0], &[1.0, 0.0], &[1.0, 0.0]]);
        let noise = |image: Image| Reference::given(image, "b.exr", (2, 1)).unwrap().noise;
        assert_eq!(noise(image.clone()), None);
        for (_, name) in CHANNELS {
            image.channels.push(Channel { name: name.to_owned(), values: vec![0.25, 0.0] });
        }
        let found = noise(image).unwrap();
        assert!((found.mse - 0.125).abs() < 1e-12 && (found.mean - 0.25 / 4.0).abs() < 1e-12, "{found:?}");
    }

    #[test]
    fn references_of_another_size_and_parts_of_pictures_are_refused() {
        let image = picture([&[2.0, 0.0]; 3]);
        let refused =
            |image: &Image, size| Reference::given(image.clone(), "b.exr", size).err().unwrap().to_string();
        let message = refused(&image, (4, 3));
        assert!(message.contains("2x1") && message.contains("4x3") && message.contains("b.exr"), "{message}");
        let part = Image { width: 4, ..image.clone() };
        assert!(refused(&part, (4, 1)).contains("a part"));
        let gray = Image { channels: image.channels[..1].to_vec(), ..image };
        assert!(refused(&gray, (2, 1)).contains("channel G"));
    }
}
