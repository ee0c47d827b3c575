//! Races: every contender renders every point once to warm up, which is not counted, and there its picture is compared;
//! then once in every round. Ratios are taken within rounds.

use super::contender::Contender;
use super::point::Point;
use crate::film::Image;
use crate::scene::Baked;
use crate::study::compare::Mismatch;
use crate::study::estimate::Estimate;
use crate::study::render::render;
use crate::study::rounds::Study;
use crate::trace::{Counters, Rendered, Run, Stats};

/// All renders of a contender at a point.
#[derive(Clone, Debug)]
pub struct Runs {
    /// Contender that was measured.
    pub contender: Contender,
    /// By round.
    pub rounds: Vec<Stats>,
}

/// All contenders at a point.
#[derive(Clone, Debug)]
pub struct Race {
    /// The point.
    pub point: Point,
    /// In the order of the plan.
    pub runs: Vec<Runs>,
}

/// Contenders at points, all to be raced.
pub struct Bench {
    scenes: Vec<Baked>,
    points: Vec<Point>,
    /// Ratios are those to the first.
    contenders: Vec<Contender>,
    /// The last picture that others must be the same as.
    expected: Option<((Point, Contender), Image)>,
}

impl Bench {
    /// Races of all `contenders` on `scenes` under all `points`.
    pub fn new(scenes: Vec<Baked>, points: Vec<Point>, contenders: Vec<Contender>) -> Self {
        Self { scenes, points, contenders, expected: None }
    }

    fn entry(&self, setting: usize) -> (&Point, Contender) {
        let count = self.contenders.len();
        (&self.points[setting / count], self.contenders[setting % count])
    }

    fn render(&mut self, setting: usize) -> Rendered {
        let count = self.contenders.len();
        let (point, contender) = (&self.points[setting / count], self.contenders[setting % count]);
        let scene = &mut self.scenes[point.scene];
        contender.enter(point, scene);
        let run = Run { threads: point.threads, batch: point.batch, ..Run::default() };
        render(scene, &run, &|_| {})
    }
}

impl Study for Bench {
    type Sample = Stats;
    type Findings = Vec<Race>;
    type Error = Mismatch;

    fn settings(&self) -> usize {
        self.points.len() * self.contenders.len()
    }

    /// Warms up, and refuses contenders whose pictures should be the same and differ in a bit.
    fn prepare(&mut self, setting: usize) -> Result<(), Mismatch> {
        let image = self.render(setting).image;
        let (point, contender) = self.entry(setting);
        if !contender.keeps_the_picture() {
            return Ok(());
        }
        match &self.expected {
            Some(((of, who), picture)) if of.has_picture_of(point) => {
                same_bits((*who, picture), (contender, &image))
            }
            _ => {
                self.expected = Some(((point.clone(), contender), image));
                Ok(())
            }
        }
    }

    fn measure(&mut self, setting: usize) -> Result<Stats, Mismatch> {
        Ok(self.render(setting).stats)
    }

    fn conclude(self, samples: Vec<Vec<Stats>>) -> Vec<Race> {
        let mut samples = samples.into_iter();
        let race = |point: Point| {
            let runs = self.contenders.iter().zip(samples.by_ref());
            Race { point, runs: runs.map(|(&contender, rounds)| Runs { contender, rounds }).collect() }
        };
        self.points.into_iter().map(race).collect()
    }
}

/// Refuses pictures that differ.
fn same_bits((a, first): (Contender, &Image), (b, second): (Contender, &Image)) -> Result<(), Mismatch> {
    for (one, other) in first.channels.iter().zip(&second.channels) {
        let differs = |(x, y): (&f32, &f32)| x.to_bits() != y.to_bits();
        if let Some(pixel) = one.values.iter().zip(&other.values).position(differs) {
            let at = (pixel % first.size.0, pixel / first.size.0);
            let cause = format!(
                "the pictures of {} and {} differ, first in channel {} at pixel {at:?}",
                a.name(),
                b.name(),
                one.name
            );
            return Err(Mismatch { cause, remedy: "this is a bug: please report it with the command" });
        }
    }
    Ok(())
}

impl Race {
    /// CPU time of contender number `slow` over that of number `fast`, from the ratios of all rounds.
    pub fn ratio(&self, slow: usize, fast: usize) -> Option<Estimate> {
        self.ratio_of(slow, fast, |stats| stats.cpu_seconds)
    }

    /// Ratio of tracing times: [`Self::ratio`] without the time in which light sampling learns before the first camera
    /// ray, which is not a matter of schedules.
    pub fn tracing_ratio(&self, slow: usize, fast: usize) -> Option<Estimate> {
        self.ratio_of(slow, fast, |stats| stats.cpu_seconds - stats.stages.learning)
    }

    fn ratio_of(&self, slow: usize, fast: usize, time: fn(&Stats) -> f64) -> Option<Estimate> {
        let pairs = self.runs[slow].rounds.iter().zip(&self.runs[fast].rounds);
        let ratios: Vec<f64> = pairs.map(|(slow, fast)| time(slow) / time(fast)).collect();
        Estimate::geometric_mean(&ratios)
    }
}

impl Runs {
    /// The median of `value` over the rounds.
    pub fn median(&self, value: impl Fn(&Stats) -> f64) -> f64 {
        let mut values: Vec<f64> = self.rounds.iter().map(value).collect();
        values.sort_by(f64::total_cmp);
        let middle = |index: usize| values.get(index).copied().unwrap_or(f64::NAN);
        0.5 * (middle(values.len() / 2) + middle(values.len().saturating_sub(1) / 2))
    }

    /// Shortest and longest time of a render, seconds.
    pub fn range(&self, time: fn(&Stats) -> f64) -> [f64; 2] {
        let seconds = || self.rounds.iter().map(time);
        [seconds().fold(f64::INFINITY, f64::min), seconds().fold(0.0, f64::max)]
    }

    /// Counters of the work done, the same in every round.
    pub fn counters(&self) -> Counters {
        self.rounds.first().map_or_else(Counters::default, |stats| stats.counters)
    }

    /// Share of the lanes in use, the same in every round; `None` without a wavefront.
    pub fn occupancy(&self) -> Option<f64> {
        self.rounds.first()?.stages.occupancy.share()
    }

    /// CPU time per camera path, microseconds; the median.
    pub fn us_per_path(&self) -> f64 {
        let paths = self.counters().paths as f64;
        self.median(|stats| 1e6 * stats.cpu_seconds / paths)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::Channel;

    fn all(contender: Contender, seconds: &[f64]) -> Runs {
        let stats = |&cpu_seconds: &f64| Stats { cpu_seconds, threads: 2, ..Stats::default() };
        Runs { contender, rounds: seconds.iter().map(stats).collect() }
    }

    #[test]
    fn ratios_are_taken_within_rounds() {
        let point = Point::flat();
        // The machine was ten times as slow in the second round.
        let runs =
            vec![all(Contender::Wavefront, &[1.0, 10.0, 1.0]), all(Contender::PerPixel, &[1.5, 15.0, 1.5])];
        let race = Race { point, runs };
        let ratio = race.ratio(1, 0).unwrap();
        assert!((ratio.value - 1.5).abs() < 1e-12 && ratio.error.unwrap() < 1e-12);
        assert!((race.ratio(0, 1).unwrap().value * 1.5 - 1.0).abs() < 1e-12);
        assert_eq!(
            (race.runs[1].median(|s| s.cpu_seconds), race.runs[1].range(|s| s.cpu_seconds)),
            (1.5, [1.5, 15.0])
        );
        assert_eq!(all(Contender::Flat, &[3.0, 1.0]).median(|s| s.cpu_seconds), 2.0);
    }

    #[test]
    fn a_picture_that_differs_in_one_bit_is_refused_with_its_place() {
        let picture = |value: f32| Image {
            width: 2,
            height: 2,
            origin: (0, 0),
            size: (2, 2),
            channels: vec![Channel { name: "G".to_owned(), values: vec![0.0, 0.0, 0.0, value] }],
            attributes: Vec::new(),
        };
        let check = |value: f32| {
            same_bits((Contender::Wavefront, &picture(0.0)), (Contender::PerPixel, &picture(value)))
        };
        assert!(check(0.0).is_ok());
        let cause = check(-0.0).unwrap_err().cause;
        assert!(cause.contains("wavefront and per-pixel") && cause.contains("G at pixel (1, 1)"), "{cause}");
    }
}
