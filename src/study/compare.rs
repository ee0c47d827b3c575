//! Difference of a picture A from a reference B.
//!
//! With a and b the values of one pixel in one channel, over the n pairs that are both finite:
//!
//! | measure | formula | unit |
//! |---|---|---|
//! | RMSE | √(Σ(a − b)²/n) | the channel's |
//! | relMSE | Σ((a − b)²/(b² + [`EPSILON`]))/n | none |
//! | difference of means | Σa/Σb − 1 | none |
//! | largest difference | the a − b of largest \|a − b\| | the channel's |
//!
//! A channel is infinite in both pictures where it has no value (depth where nothing is hit), so that equal infinities
//! are equal, as are two NaN; both are left out of the sums.

use std::iter::zip;

use serde::Serialize;

use super::noise::{self, Noise};
use super::window::Window;
use crate::film::{Channel, Image};

/// Keeps the relative square finite where the reference is dark; the square of a radiance of 0.1.
pub const EPSILON: f64 = 0.01;
/// Decades of relative difference that [`PicturePair::false_color`] shows, up to 1.
pub const DECADES: f64 = 3.0;
/// Colour of pixels that cannot be compared; not on the scale.
const NOT_COMPARABLE: [u8; 3] = [0, 255, 0];

/// Error: two pictures, or races, cannot be compared.
#[derive(Debug, thiserror::Error)]
#[error("{cause}")]
pub struct Mismatch {
    /// Problem, in words, with the name of the file.
    pub cause: String,
    /// Remedy.
    pub remedy: &'static str,
}

/// Two pictures of the same pixels, both with colours.
pub struct PicturePair<'a> {
    a: &'a Image,
    b: &'a Image,
    /// `R`, `G`, `B` of A and of B.
    beauty: [Values<'a>; 3],
}

/// A channel of A and of B.
type Values<'a> = (&'a [f32], &'a [f32]);

/// Comparison of two pictures.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Comparison {
    /// Data window: first column and row in the picture, and size in pixels.
    pub window: Window,
    /// `R`, `G`, `B` together.
    pub beauty: ChannelComparison,
    /// Every channel that both have, in A's order.
    pub channels: Vec<ChannelComparison>,
    /// Channels that only A has.
    pub only_a: Vec<String>,
    /// Channels that only B has.
    pub only_b: Vec<String>,
    /// The test for noise, if both pictures have variances.
    pub noise: Option<Noise>,
    /// Verdict on the colours.
    pub verdict: Verdict,
}

/// One channel, or several taken together.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ChannelComparison {
    /// As in the files.
    pub name: String,
    /// Pairs of finite values; all measures are over these.
    pub finite: usize,
    /// Pairs of which one value at least is not finite.
    pub non_finite: usize,
    /// Those of them that are unequal.
    pub non_finite_unequal: usize,
    /// Unequal pairs of either kind.
    pub unequal: usize,
    /// Absent without finite pairs.
    #[serde(flatten)]
    pub measures: Option<Measures>,
}

/// See the formulas of the [module](self).
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Measures {
    /// Root of the mean square of a − b, unit of the channel.
    pub rmse: f64,
    /// Mean of (a − b)²/(b² + [`EPSILON`]).
    pub relmse: f64,
    /// Mean of A, unit of the channel.
    pub mean_a: f64,
    /// Mean of B, unit of the channel.
    pub mean_b: f64,
    /// Mean of A over mean of B, less 1; absent where B's mean is 0.
    pub difference_of_means: Option<f64>,
    /// Largest \|a − b\|, with its sign, unit of the channel.
    pub largest_difference: f64,
    /// Pixel of that: column and row from the top left corner of the whole picture.
    pub largest_at: (usize, usize),
}

/// Verdict on whether two pictures' colours are the same.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// Not one value differs.
    Identical,
    /// They differ by no more than their variances explain.
    WithinNoise,
    /// They differ by more, or by values that are not finite.
    Differ,
    /// They differ, and there are no variances to tell whether by noise.
    Unjudged,
}

impl<'a> PicturePair<'a> {
    /// Pairs `a` with its reference `b`; the strings are what messages call them.
    ///
    /// # Errors
    /// If the pictures or their data windows differ in size or place, or one has no colours or is not whole.
    pub fn new((name_a, a): (&str, &'a Image), (name_b, b): (&str, &'a Image)) -> Result<Self, Mismatch> {
        let mismatch = |cause: String, remedy| Err(Mismatch { cause, remedy });
        for (name, image) in [(name_a, a), (name_b, b)] {
            if !image.is_consistent() {
                let cause = format!("the channels of `{name}` do not fill its data window");
                return mismatch(cause, "give a picture whose channels all have its full resolution");
            }
        }
        if (a.width, a.height) != (b.width, b.height) {
            let (size_a, size_b) = (pixels((a.width, a.height)), pixels((b.width, b.height)));
            let cause = format!("`{name_a}` is a picture of {size_a} pixels, `{name_b}` one of {size_b}");
            return mismatch(cause, "render both with the same --size");
        }
        if (a.origin, a.size) != (b.origin, b.size) {
            let place = |image: &Image| format!("{} pixels at {:?}", pixels(image.size), image.origin);
            let cause = format!("`{name_a}` holds {}, `{name_b}` {}", place(a), place(b));
            return mismatch(cause, "render both with the same --crop");
        }
        let channel = |channel: &str| {
            let of = |name: &str, image: &'a Image| {
                image.channel(channel).ok_or_else(|| Mismatch {
                    cause: format!("`{name}` has no channel {channel}"),
                    remedy: "give pictures with the channels R, G and B",
                })
            };
            Ok((of(name_a, a)?, of(name_b, b)?))
        };
        Ok(Self { a, b, beauty: [channel("R")?, channel("G")?, channel("B")?] })
    }

    /// All numbers.
    pub fn compare(&self) -> Comparison {
        let beauty = self.channel("RGB", &self.beauty);
        let channels = self.shared().map(|(name, values)| self.channel(name, &[values])).collect();
        let noise = noise::test(self.a, self.b);
        let verdict = match &noise {
            _ if beauty.unequal == 0 => Verdict::Identical,
            _ if beauty.non_finite_unequal > 0 => Verdict::Differ,
            Some(noise) if noise.explains() => Verdict::WithinNoise,
            Some(_) => Verdict::Differ,
            None => Verdict::Unjudged,
        };
        Comparison {
            window: Window { origin: self.a.origin, size: self.a.size },
            beauty,
            channels,
            only_a: only(self.a, self.b),
            only_b: only(self.b, self.a),
            noise,
            verdict,
        }
    }

    /// a − b in every channel that both have; 0 for equal infinities.
    pub fn difference(&self) -> Image {
        let subtract = |(&a, &b): (&f32, &f32)| if a == b { 0.0 } else { a - b };
        let plane = |(name, (a, b)): (&str, Values)| Channel {
            name: name.to_owned(),
            values: zip(a, b).map(subtract).collect(),
        };
        Image { channels: self.shared().map(plane).collect(), attributes: Vec::new(), ..*self.a }
    }

    /// Relative difference of a pixel: the root of the mean over `R`, `G`, `B` of (a − b)²/(b² + [`EPSILON`]), so that
    /// relMSE is the mean of its square over the picture.
    pub(super) fn relative(&self, pixel: usize) -> f64 {
        let squares = self.beauty.map(|(a, b)| relative_square(a[pixel], b[pixel]));
        (squares.iter().sum::<f64>() / 3.0).sqrt()
    }

    /// sRGB of every pixel's relative difference, row by row.
    ///
    /// The scale is logarithmic, from black at 10^−[`DECADES`] over red to pale yellow at 1; green marks pixels that
    /// are not finite.
    pub fn false_color(&self) -> Vec<[u8; 3]> {
        let color = |pixel: usize| {
            let relative = self.relative(pixel);
            if !relative.is_finite() {
                return NOT_COMPARABLE;
            }
            let colorous::Color { r, g, b } =
                colorous::INFERNO.eval_continuous((libm::log10(relative) / DECADES + 1.0).clamp(0.0, 1.0));
            [r, g, b]
        };
        (0..self.a.size.0 * self.a.size.1).map(color).collect()
    }

    /// The channels that both have.
    fn shared(&self) -> impl Iterator<Item = (&'a str, Values<'a>)> {
        let values = |plane: &'a Channel| {
            Some((plane.name.as_str(), (plane.values.as_slice(), self.b.channel(&plane.name)?)))
        };
        self.a.channels.iter().filter_map(values)
    }

    fn channel(&self, name: &str, parts: &[Values]) -> ChannelComparison {
        let mut sums = DifferenceSums::default();
        for (a, b) in parts {
            zip(*a, *b).enumerate().for_each(|(pixel, (&a, &b))| sums.add(pixel, a, b));
        }
        let n = sums.finite as f64;
        let place = |pixel: usize| {
            let (x, y) = (pixel % self.a.size.0, pixel / self.a.size.0);
            (self.a.origin.0 + x, self.a.origin.1 + y)
        };
        ChannelComparison {
            name: name.to_owned(),
            finite: sums.finite,
            non_finite: sums.non_finite,
            non_finite_unequal: sums.non_finite_unequal,
            unequal: sums.unequal,
            measures: (sums.finite > 0).then(|| Measures {
                rmse: (sums.squares / n).sqrt(),
                relmse: sums.relative_squares / n,
                mean_a: sums.a / n,
                mean_b: sums.b / n,
                difference_of_means: (sums.b != 0.0).then(|| sums.a / sums.b - 1.0),
                largest_difference: sums.largest.0,
                largest_at: place(sums.largest.1),
            }),
        }
    }
}

/// Over pairs of values.
#[derive(Default)]
struct DifferenceSums {
    finite: usize,
    non_finite: usize,
    non_finite_unequal: usize,
    unequal: usize,
    a: f64,
    b: f64,
    squares: f64,
    relative_squares: f64,
    /// Difference and pixel.
    largest: (f64, usize),
}

impl DifferenceSums {
    fn add(&mut self, pixel: usize, a: f32, b: f32) {
        let unequal = usize::from(a != b && !(a.is_nan() && b.is_nan()));
        self.unequal += unequal;
        if !(a.is_finite() && b.is_finite()) {
            self.non_finite += 1;
            self.non_finite_unequal += unequal;
            return;
        }
        let difference = f64::from(a) - f64::from(b);
        if self.finite == 0 || difference.abs() > self.largest.0.abs() {
            self.largest = (difference, pixel);
        }
        self.finite += 1;
        self.a += f64::from(a);
        self.b += f64::from(b);
        self.squares += difference * difference;
        self.relative_squares += relative_square(a, b);
    }
}

/// (a − b)²/(b² + [`EPSILON`]); 0 for equal infinities, not finite for others.
fn relative_square(a: f32, b: f32) -> f64 {
    if a == b {
        return 0.0;
    }
    let (a, b) = (f64::from(a), f64::from(b));
    (a - b).powi(2) / (b * b + EPSILON)
}

/// Names of the channels of `image` that `other` lacks.
fn only(image: &Image, other: &Image) -> Vec<String> {
    let names = image.channels.iter().map(|plane| &plane.name);
    names.filter(|name| other.channel(name).is_none()).cloned().collect()
}

fn pixels((width, height): (usize, usize)) -> String {
    format!("{width}x{height}")
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A picture of one row, whose R, G, B are `values`.
    fn row(values: &[f32]) -> Image {
        let plane = |name: &str| Channel { name: name.to_owned(), values: values.to_vec() };
        Image {
            width: 10,
            height: 10,
            origin: (3, 2),
            size: (values.len(), 1),
            channels: ["R", "G", "B"].map(plane).to_vec(),
            attributes: Vec::new(),
        }
    }

    fn pair<'a>(a: &'a Image, b: &'a Image) -> PicturePair<'a> {
        PicturePair::new(("a.exr", a), ("b.exr", b)).unwrap()
    }

    fn refused(a: &Image, b: &Image) -> String {
        PicturePair::new(("a.exr", a), ("b.exr", b)).err().unwrap().to_string()
    }

    #[test]
    fn the_measures_are_those_computed_by_hand() {
        // Differences 1, -2, 0, 0; over b² + 0.01: 1/1.01, 4/9.01.
        let (a, b) = (row(&[2.0, 1.0, 0.0, 1.0]), row(&[1.0, 3.0, 0.0, 1.0]));
        let found = pair(&a, &b).compare();
        let expected = Measures {
            rmse: 1.25f64.sqrt(),
            relmse: (1.0 / 1.01 + 4.0 / 9.01) / 4.0,
            mean_a: 1.0,
            mean_b: 1.25,
            difference_of_means: Some(-0.2),
            largest_difference: -2.0,
            largest_at: (4, 2),
        };
        let red = &found.channels[0];
        assert_eq!((red.name.as_str(), red.finite, red.unequal), ("R", 4, 2));
        let red = red.measures.clone().unwrap();
        assert!((red.relmse - expected.relmse).abs() < 1e-15);
        assert!((red.difference_of_means.unwrap() + 0.2).abs() < 1e-15);
        let exact = |m: &Measures| (m.rmse, m.mean_a, m.mean_b, m.largest_difference, m.largest_at);
        assert_eq!(exact(&red), exact(&expected));
        assert_eq!((found.beauty.finite, found.beauty.unequal), (12, 6));
        assert_eq!(found.verdict, Verdict::Unjudged);
    }

    #[test]
    fn the_largest_difference_may_be_in_the_first_pixel_and_zero() {
        let image = row(&[0.5, 0.5]);
        let found = pair(&image, &image).compare();
        let measures = found.beauty.measures.unwrap();
        assert_eq!((measures.largest_difference, measures.largest_at), (0.0, (3, 2)));
        assert_eq!(found.verdict, Verdict::Identical);
    }

    #[test]
    fn values_that_are_not_finite_are_counted_and_left_out() {
        const INF: f32 = f32::INFINITY;
        let (a, b) = (row(&[INF, f32::NAN, INF, 1.0, f32::NAN]), row(&[INF, f32::NAN, 1.0, INF, 1.0]));
        let found = pair(&a, &b).compare();
        let red = &found.channels[0];
        assert_eq!((red.finite, red.non_finite, red.non_finite_unequal, red.unequal), (0, 5, 3, 3));
        assert!(red.measures.is_none());
        assert_eq!(found.verdict, Verdict::Differ);
        assert_eq!(pair(&a, &a).compare().verdict, Verdict::Identical);
    }

    #[test]
    fn channels_that_only_one_has_are_named() {
        let (a, mut b) = (row(&[1.0]), row(&[1.0]));
        b.channels.push(Channel { name: "depth.Z".to_owned(), values: vec![2.0] });
        let found = pair(&a, &b).compare();
        assert!(found.only_a.is_empty() && found.channels.len() == 3);
        assert_eq!(found.only_b, ["depth.Z"]);
        assert_eq!(pair(&b, &a).compare().only_a, ["depth.Z"]);
    }

    #[test]
    fn pictures_that_do_not_fit_are_refused_by_name() {
        let image = row(&[1.0, 2.0]);
        let wider = Image { width: 11, ..image.clone() };
        assert!(refused(&image, &wider).contains("`b.exr` one of 11x10"));
        let moved = Image { origin: (4, 2), ..image.clone() };
        assert!(refused(&image, &moved).contains("`b.exr` 2x1 pixels at (4, 2)"));
        let mut grey = image.clone();
        grey.channels.remove(1);
        assert_eq!(refused(&grey, &image), "`a.exr` has no channel G");
        let mut ragged = image.clone();
        ragged.channels[2].values.pop();
        assert!(refused(&image, &ragged).contains("`b.exr`"));
    }

    #[test]
    fn the_difference_has_the_sign_of_a_less_b_and_the_place_of_both() {
        let (a, b) = (row(&[3.0, f32::INFINITY, 1.0]), row(&[1.0, f32::INFINITY, 2.0]));
        let difference = pair(&a, &b).difference();
        assert_eq!(difference.channels, row(&[2.0, 0.0, -1.0]).channels);
        assert_eq!((difference.origin, difference.width), (a.origin, a.width));
    }

    #[test]
    fn false_colours_go_from_black_to_yellow_and_mark_what_is_not_finite() {
        // Relative differences 0, just above 1, and not known.
        let (a, b) = (row(&[1.0, 3.0, f32::NAN]), row(&[1.0, 1.0, 1.0]));
        let inferno = |at| colorous::INFERNO.eval_continuous(at).as_array();
        assert_eq!(pair(&a, &b).false_color(), [inferno(0.0), inferno(1.0), NOT_COMPARABLE]);
    }
}
