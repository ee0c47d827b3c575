//! Gain of light sampling: errors of pictures over samples and over time, for ways to look for lights.
//!
//! Errors are those of [`super::compare`], less what the noise of the reference adds to them. Without a bias the mean
//! square error times the time is constant; the gain of a way is how much smaller that product is than without light
//! sampling, which is also the ratio of the mean square errors after equal times.

use super::compare::{Measures, Mismatch, PicturePair};
use super::errors::median;
use super::estimate::{Estimate, geometric_median};
use super::reference::Reference;
use super::render::render;
use super::report::{Report, style_of};
use super::rounds::Study;
use super::table::{Table, TableRow, scientific, with_error};
use crate::film::Image;
use crate::plot::{DataSeries, Diagram, Figure};
use crate::scene::{Baked, LightSampling, flag_name};
use crate::trace::{Progress, Run};

/// Plan of the measurements, and their number.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// Ways to look for lights.
    pub ways: Vec<LightSampling>,
    /// Samples per pixel of the pictures.
    pub spps: Vec<u32>,
    /// Pictures of each kind, with different seeds.
    pub rounds: u32,
    /// Worker threads; 0 means one per core.
    pub threads: usize,
}

/// Size of one diagram, points.
const DIAGRAM: [f64; 2] = [470.0, 420.0];

/// Source of the reference.
pub enum ReferenceSource {
    /// Rendered with light sampling along geodesics, with this many samples per pixel.
    Rendered(u32),
    /// From elsewhere.
    Given(Reference),
}

/// A way and a number of samples, measured.
#[derive(Clone, Copy, Debug, PartialEq)]
struct LightSamplingMeasurement {
    /// The way.
    way: LightSampling,
    /// Samples per pixel.
    spp: u32,
    /// CPU time of a render, seconds; the median.
    seconds: f64,
    /// Mean square error over pixels and `R`, `G`, `B`, radiance²; below 0 where the reference's noise hides it.
    mse: Estimate,
    /// Mean of (a − b)²/(b² + [`super::compare::EPSILON`]).
    relmse: Estimate,
    /// 99.9th percentile of the relative difference of pixels.
    p999: f64,
    /// Mean of the picture over that of the reference; `None` for a black reference.
    mean: Option<Estimate>,
    /// Gain over no light sampling.
    gain: Gain,
}

/// Product of error and time without light sampling, the median over the numbers of samples, over that of something
/// else; `None` where one of them is unknown.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Gain {
    /// In the mean square error.
    absolute: Option<Estimate>,
    /// In the relative one.
    relative: Option<Estimate>,
}

/// A way with all its numbers of samples.
#[derive(Clone, Debug, PartialEq)]
struct Technique {
    /// Light sampling.
    way: LightSampling,
    /// By samples per pixel, as in the plan.
    measurements: Vec<LightSamplingMeasurement>,
    /// The median over `measurements`.
    gain: Gain,
}

/// One picture, measured.
#[derive(Clone, Copy)]
pub struct MeasuredPicture {
    seconds: f64,
    mse: f64,
    relmse: f64,
    p999: f64,
    mean: f64,
}

/// A scene whose pictures are rendered in all ways with all numbers of samples.
pub struct LightStudy<'a> {
    plan: Plan,
    /// Ways side by side, so that they are compared under the same load.
    settings: Vec<(LightSampling, u32)>,
    renders: Renders<'a>,
    reference: Reference,
    /// Of the settings.
    stacks: Vec<Stack>,
}

impl<'a> LightStudy<'a> {
    /// A study of `scene`, in the size that its settings say; renders the reference if none is given. `progress` is
    /// told from worker threads how many of how many camera paths are done.
    pub fn new(
        scene: Baked,
        plan: Plan,
        source: ReferenceSource,
        progress: &'a (dyn Fn(Progress) + Sync),
    ) -> Self {
        let settings: Vec<(LightSampling, u32)> =
            plan.spps.iter().flat_map(|&spp| plan.ways.iter().map(move |&way| (way, spp))).collect();
        let pixels = scene.settings.width * scene.settings.height;
        let samples: u64 = settings.iter().map(|&(_, spp)| u64::from(spp)).sum();
        let mut renders = Renders {
            seeds: Seeds { last: scene.settings.seed, taken: None },
            scene,
            threads: plan.threads,
            progress,
            done: 0,
            total: samples.saturating_mul(plan.rounds.into()).saturating_mul(pixels as u64),
        };
        let reference = match source {
            ReferenceSource::Rendered(spp) => renders.reference(spp),
            ReferenceSource::Given(reference) => {
                renders.seeds.taken = seed(&reference.image);
                reference
            }
        };
        let stacks = settings.iter().map(|_| Stack::new(pixels)).collect();
        Self { plan, settings, renders, reference, stacks }
    }

    /// Sums up the pictures of each setting, way by way.
    fn ways(&self, pictures: &[Vec<MeasuredPicture>]) -> Vec<Technique> {
        let Plan { ways, spps, .. } = &self.plan;
        let of_way = |way: usize| (0..spps.len()).map(move |spp| spp * ways.len() + way);
        let costs = |way: usize, error: fn(&MeasuredPicture) -> f64| -> Vec<Vec<f64>> {
            let cost = |picture: &MeasuredPicture| error(picture) * picture.seconds;
            of_way(way).map(|index| pictures[index].iter().map(cost).collect()).collect()
        };
        let errors: [fn(&MeasuredPicture) -> f64; 2] = [|picture| picture.mse, |picture| picture.relmse];
        let off = ways.iter().position(|&way| way == LightSampling::Off);
        let without = errors.map(|error| off.and_then(|off| medians(&costs(off, error))));
        let measured = ways.iter().enumerate().map(|(place, &way)| {
            let [absolute, relative] =
                [0, 1].map(|kind: usize| Gains::of(&costs(place, errors[kind]), without[kind].as_deref()));
            let measurement = |(spp, index): (usize, usize)| LightSamplingMeasurement {
                gain: Gain { absolute: absolute.single[spp], relative: relative.single[spp] },
                mean: self.stacks[index].mean_over(&pictures[index], &self.reference),
                ..LightSamplingMeasurement::of(way, spps[spp], &pictures[index])
            };
            Technique {
                way,
                measurements: of_way(place).enumerate().map(measurement).collect(),
                gain: Gain { absolute: absolute.median, relative: relative.median },
            }
        });
        measured.collect()
    }
}

impl Study for LightStudy<'_> {
    type Sample = MeasuredPicture;
    type Findings = Report;
    type Error = Mismatch;

    fn settings(&self) -> usize {
        self.settings.len()
    }

    fn measure(&mut self, setting: usize) -> Result<MeasuredPicture, Mismatch> {
        let (way, spp) = self.settings[setting];
        let (image, seconds) = self.renders.render(way, spp);
        self.stacks[setting].add(&image);
        MeasuredPicture::of(&image, seconds, &self.reference)
    }

    fn conclude(self, samples: Vec<Vec<MeasuredPicture>>) -> Report {
        let ways = self.ways(&samples);
        Report { text: text(&ways), table: table(&ways), figure: figure(&ways) }
    }
}

/// For every round the median over the numbers of samples, by which `costs` are ordered.
fn medians(costs: &[Vec<f64>]) -> Option<Vec<f64>> {
    let rounds = costs.first()?.len();
    (0..rounds).map(|round| geometric_median(costs.iter().map(|costs| costs[round]).collect())).collect()
}

/// Gains of a way in one kind of error.
struct Gains {
    /// By number of samples.
    single: Vec<Option<Estimate>>,
    median: Option<Estimate>,
}

impl Gains {
    /// From the costs of a way by number of samples and round, and those without light sampling by round.
    fn of(costs: &[Vec<f64>], without: Option<&[f64]>) -> Self {
        let over = |costs: &[f64]| {
            let ratios: Vec<f64> = without?.iter().zip(costs).map(|(off, cost)| off / cost).collect();
            Estimate::geometric_mean(&ratios)
        };
        Self {
            single: costs.iter().map(|costs| over(costs)).collect(),
            median: medians(costs).and_then(|medians| over(&medians)),
        }
    }
}

impl LightSamplingMeasurement {
    /// All but the mean and the gain.
    fn of(way: LightSampling, spp: u32, pictures: &[MeasuredPicture]) -> Self {
        let all = |value: fn(&MeasuredPicture) -> f64| pictures.iter().map(value).collect::<Vec<f64>>();
        Self {
            way,
            spp,
            seconds: median(pictures, |picture| picture.seconds),
            mse: Estimate::mean(&all(|picture| picture.mse)),
            relmse: Estimate::mean(&all(|picture| picture.relmse)),
            p999: Estimate::mean(&all(|picture| picture.p999)).value,
            mean: None,
            gain: Gain { absolute: None, relative: None },
        }
    }

    /// 1/(mean square error × time), 1/(radiance² s); `None` where the reference's noise hides the error.
    fn efficiency(&self) -> Option<f64> {
        (self.mse.value > 0.0).then(|| 1.0 / (self.mse.value * self.seconds))
    }

    /// The root of the mean square error, radiance; `None` where the reference's noise hides it.
    fn rmse(&self) -> Option<f64> {
        (self.mse.value > 0.0).then(|| self.mse.value.sqrt())
    }
}

impl MeasuredPicture {
    fn of(image: &Image, seconds: f64, reference: &Reference) -> Result<Self, Mismatch> {
        let pair = PicturePair::new(("the picture", image), ("the reference", &reference.image))?;
        let beauty = pair.compare().beauty.measures;
        let noise = reference.noise.unwrap_or_default();
        let value = |value: fn(&Measures) -> f64| beauty.as_ref().map_or(f64::NAN, value);
        Ok(Self {
            seconds,
            mse: value(|measures| measures.rmse.powi(2)) - noise.mse,
            relmse: value(|measures| measures.relmse) - noise.relmse,
            p999: p999((0..image.size.0 * image.size.1).map(|pixel| pair.relative(pixel)).collect()),
            mean: value(|measures| measures.mean_a),
        })
    }
}

/// 99.9th percentile of those of `values` that are finite.
fn p999(mut values: Vec<f64>) -> f64 {
    values.retain(|value| value.is_finite());
    values.sort_by(f64::total_cmp);
    values.get(values.len() * 999 / 1000).copied().unwrap_or(f64::NAN)
}

/// Sums over pictures of one kind, by pixel, of the mean of its colours and of the square of that.
struct Stack(Vec<[f64; 2]>);

impl Stack {
    fn new(pixels: usize) -> Self {
        Self(vec![[0.0; 2]; pixels])
    }

    fn add(&mut self, image: &Image) {
        let planes = ["R", "G", "B"].map(|name| image.channel(name).unwrap_or_default());
        for (pixel, [sum, squares]) in self.0.iter_mut().enumerate() {
            let colors = planes.map(|plane| plane.get(pixel).map_or(0.0, |&value| f64::from(value)));
            let mean = colors.iter().sum::<f64>() / 3.0;
            if mean.is_finite() {
                (*sum, *squares) = (*sum + mean, *squares + mean * mean);
            }
        }
    }

    /// Mean of the pictures over that of the reference; its error is that of pixels which are independent.
    fn mean_over(&self, pictures: &[MeasuredPicture], reference: &Reference) -> Option<Estimate> {
        let colors = ["R", "G", "B"].map(|name| reference.image.channel(name).unwrap_or_default());
        let finite = colors.iter().flat_map(|plane| plane.iter()).filter(|value| value.is_finite());
        let (sum, count) = finite.fold((0.0, 0), |(sum, count), &v| (sum + f64::from(v), count + 1));
        let expected = sum / f64::from(count);
        let mean = Estimate::mean(&pictures.iter().map(|picture| picture.mean).collect::<Vec<f64>>()).value;
        let ratio = mean / expected;
        let noise = reference.noise.unwrap_or_default();
        let error = self
            .variance_of_mean(pictures.len() as f64)
            .map(|variance| (variance + ratio * ratio * noise.mean).sqrt() / expected.abs());
        ratio.is_finite().then_some(Estimate { value: ratio, error })
    }

    /// Of the mean over all `n` pictures and their pixels.
    fn variance_of_mean(&self, n: f64) -> Option<f64> {
        let of_pixel = |[sum, squares]: &[f64; 2]| (squares - sum * sum / n).max(0.0) / (n - 1.0) / n;
        let pixels = self.0.len() as f64;
        (n > 1.0).then(|| self.0.iter().map(of_pixel).sum::<f64>() / (pixels * pixels))
    }
}

/// Renderer of the pictures, each with a seed of its own.
struct Renders<'a> {
    scene: Baked,
    threads: usize,
    seeds: Seeds,
    progress: &'a (dyn Fn(Progress) + Sync),
    /// Camera paths.
    done: u64,
    total: u64,
}

impl Renders<'_> {
    /// A picture with a seed of its own, and the CPU time that it took, seconds.
    fn render(&mut self, way: LightSampling, spp: u32) -> (Image, f64) {
        let settings = &mut self.scene.settings;
        (settings.light_sampling, settings.spp, settings.seed) = (way, spp, self.seeds.next());
        let (done, total) = (self.done, self.total);
        let progress = |now: Progress| (self.progress)(Progress { done: done + now.done, total });
        let run = Run { threads: self.threads, ..Run::default() };
        let rendered = render(&self.scene, &run, &progress);
        self.done += (self.scene.settings.width * self.scene.settings.height) as u64 * u64::from(spp);
        (rendered.image, rendered.stats.cpu_seconds)
    }

    /// The reference, of `spp` samples in all.
    fn reference(&mut self, spp: u32) -> Reference {
        let half = spp.div_ceil(2);
        let pixels = (self.scene.settings.width * self.scene.settings.height) as u64;
        self.total = self.total.saturating_add(2 * u64::from(half) * pixels);
        let [(first, _), (second, _)] = [(); 2].map(|()| self.render(LightSampling::Geodesic, half));
        Reference::of_halves(first, &second)
    }
}

/// Seeds that no two pictures share.
struct Seeds {
    last: u64,
    /// The seed of a reference from elsewhere.
    taken: Option<u64>,
}

impl Seeds {
    fn next(&mut self) -> u64 {
        self.last = self.last.wrapping_add(1);
        if self.taken == Some(self.last) {
            self.last = self.last.wrapping_add(1);
        }
        self.last
    }
}

/// The seed that `image` was rendered with, if it says so.
fn seed(image: &Image) -> Option<u64> {
    image.attributes.iter().find(|(name, _)| name == "seed")?.1.parse().ok()
}

/// All measurements, and what each way gains, as two tables.
fn text(ways: &[Technique]) -> String {
    let gains = |row: TableRow, prefix: &str, gain: &Gain| {
        row.cell(format!("{prefix}gain"), with_error(gain.absolute))
            .cell(format!("{prefix}relative gain"), with_error(gain.relative))
    };
    let row = |m: &LightSamplingMeasurement| {
        let row = TableRow::default()
            .cell("light sampling", flag_name(m.way))
            .cell("spp", m.spp)
            .cell("CPU seconds", format!("{:.3}", m.seconds))
            .cell("RMSE", scientific(m.rmse(), 2))
            .cell("relMSE", scientific(Some(m.relmse.value).filter(|relmse| *relmse > 0.0), 2))
            .cell("99.9 %", scientific(Some(m.p999), 2))
            .cell("mean/reference", with_error(m.mean))
            .cell("1/(MSE s)", scientific(m.efficiency(), 2));
        gains(row, "", &m.gain)
    };
    let of_way = |way: &Technique| {
        gains(TableRow::default().cell("light sampling", flag_name(way.way)), "median ", &way.gain)
    };
    let all = Table::of(ways.iter().flat_map(|way| &way.measurements).map(row));
    format!("{}\n{}", all.markdown(), Table::of(ways.iter().map(of_way)).markdown())
}

/// All measurements, for programs.
fn table(ways: &[Technique]) -> Table {
    let row = |way: &Technique, m: &LightSamplingMeasurement| {
        TableRow::default()
            .cell("light_sampling", flag_name(m.way))
            .cell("spp", m.spp)
            .cell("seconds", m.seconds)
            .estimate("mse", Some(m.mse))
            .maybe("rmse", m.rmse())
            .estimate("relmse", Some(m.relmse))
            .cell("p999", m.p999)
            .estimate("mean_ratio", m.mean)
            .maybe("efficiency", m.efficiency())
            .estimate("gain", m.gain.absolute)
            .estimate("relative_gain", m.gain.relative)
            .estimate("median_gain", way.gain.absolute)
            .estimate("median_relative_gain", way.gain.relative)
    };
    Table::of(ways.iter().flat_map(|way| way.measurements.iter().map(|m| row(way, m))))
}

/// Error over time and over samples, a curve for each way.
fn figure(ways: &[Technique]) -> Figure {
    let diagram = |title: &str, label: &str, x: fn(&LightSamplingMeasurement) -> f64| {
        let point = |m: &LightSamplingMeasurement| m.rmse().map(|rmse| [x(m), rmse]);
        let series = |way: &Technique| DataSeries {
            name: flag_name(way.way),
            style: style_of(&way.way),
            curves: vec![way.measurements.iter().filter_map(point).collect()],
        };
        Diagram::log_log(title, [label, "RMSE (radiance)"], DIAGRAM, ways.iter().map(series).collect())
    };
    let diagrams = vec![
        diagram("Error over time", "CPU time (s)", |m| m.seconds),
        diagram("Error over samples", "samples per pixel", |m| f64::from(m.spp)),
    ];
    Figure { diagrams }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_picture_has_the_seed_of_the_reference_or_of_another() {
        let mut seeds = Seeds { last: u64::MAX - 1, taken: Some(1) };
        assert_eq!([(); 4].map(|()| seeds.next()), [u64::MAX, 0, 2, 3]);
    }

    #[test]
    fn the_gain_of_a_way_over_itself_is_one() {
        let costs = vec![vec![1.0, 2.0], vec![4.0, 2.0], vec![2.0, 3.0], vec![3.0, 8.0]];
        let gains = Gains::of(&costs, medians(&costs).as_deref());
        assert!((gains.median.unwrap().value - 1.0).abs() < 1e-12);
        assert!((gains.median.unwrap().error.unwrap()).abs() < 1e-12);
        let tenth: Vec<Vec<f64>> = costs.iter().map(|c| c.iter().map(|c| 0.1 * c).collect()).collect();
        let gains = Gains::of(&tenth, medians(&costs).as_deref());
        assert!((gains.median.unwrap().value - 10.0).abs() < 1e-12);
        assert!(Gains::of(&costs, None).median.is_none());
    }

    #[test]
    fn the_quantile_leaves_one_in_a_thousand_above() {
        let mut values: Vec<f64> = (0..2000).rev().map(f64::from).collect();
        values.push(f64::NAN);
        assert_eq!(p999(values), 1998.0);
        assert!(p999(Vec::new()).is_nan());
    }
}
