//! Races of a build before this one, read from the JSON that it wrote.
//!
//! Both builds did not take turns, so that their ratio is that of CPU times on a machine that may have changed: worth
//! less than ratios within a race.

use std::ffi::OsStr;
use std::path::Path;

use serde::Deserialize;
use serde_json::{Map, Value};

use super::point::Point;
use super::race::{Race, Runs};
use crate::study::compare::Mismatch;
use crate::study::estimate::Estimate;
use crate::study::table::{Table, TableRow, with_error};
use crate::trace::StageTimes;

/// Races of a build before.
#[derive(Debug)]
pub struct Previous {
    /// Name of the file.
    name: String,
    record: Record,
}

#[derive(Debug, Deserialize)]
struct Record {
    scene: String,
    points: Vec<RecordedPoint>,
}

#[derive(Debug, Deserialize)]
struct RecordedPoint {
    value: Option<f64>,
    schwarzschild_radius: f64,
    batch: usize,
    settings: Map<String, Value>,
    contenders: Vec<RecordedContender>,
}

#[derive(Debug, Deserialize)]
struct RecordedContender {
    name: String,
    rounds: Vec<Round>,
}

/// What is needed of `Stats`.
#[derive(Debug, Deserialize)]
struct Round {
    cpu_seconds: f64,
    paths: u64,
    stages: StageTimes,
}

impl Previous {
    /// Races in `json`, the contents of a file of this `name`.
    ///
    /// # Errors
    /// If it is not what `bench` writes.
    pub fn read(name: &str, json: &[u8]) -> Result<Self, Mismatch> {
        let record: Record = serde_json::from_slice(json).map_err(|error| Mismatch {
            cause: format!("`{name}` is no record of races: {error}"),
            remedy: "give the PREFIX.json that `bench -o PREFIX` wrote",
        })?;
        Ok(Self { name: name.to_owned(), record })
    }

    /// Refuses a scene file of another name, and points that were not measured, or under other conditions. What only one
    /// of the builds knows may differ.
    ///
    /// # Errors
    /// Names the point, or the condition and both of its values.
    pub fn check(&self, scene: &str, points: &[Point]) -> Result<(), Mismatch> {
        let refuse = |cause: String| {
            Err(Mismatch { cause, remedy: "measure both builds with the same scene and flags" })
        };
        let file = |path: &str| Path::new(path).file_name().map(OsStr::to_os_string);
        if file(scene) != file(&self.record.scene) {
            return refuse(format!("`{}` was measured with scene `{}`", self.name, self.record.scene));
        }
        for point in points {
            let Some(recorded) = self.at(point) else {
                let value =
                    point.value.map_or("a race without a sweep".to_owned(), |value| value.to_string());
                return refuse(format!("`{}` has not measured {value}", self.name));
            };
            let before = recorded.conditions();
            for (name, now) in conditions(point) {
                if let Some(then) = before.get(&name).filter(|then| **then != now) {
                    return refuse(format!("`{}` was measured with {name} {then}, this is {now}", self.name));
                }
            }
        }
        Ok(())
    }

    /// How the CPU time of each contender that is in both compares, with the wavefront's stages.
    pub(super) fn text(&self, races: &[Race]) -> String {
        races.iter().map(|race| self.verdicts(race)).collect()
    }

    fn at(&self, point: &Point) -> Option<&RecordedPoint> {
        self.record.points.iter().find(|recorded| recorded.value == point.value)
    }

    fn verdicts(&self, race: &Race) -> String {
        let Some(recorded) = self.at(&race.point) else { return String::new() };
        let both = race.runs.iter().filter_map(|runs| {
            let name = runs.contender.name();
            let before = recorded.contenders.iter().find(|before| before.name == name)?;
            Some((runs, before))
        });
        let value = race.point.value.map(|value| format!(" at {value}")).unwrap_or_default();
        let text = |(runs, before): (&Runs, &RecordedContender)| {
            let now = Estimate::geometric_mean(&per_path(runs));
            let then = Estimate::geometric_mean(&before.per_path());
            let ratio = now.zip(then).map(|(now, then)| now.over(then));
            let line = format!(
                "{}{value}: {} times the CPU time per path of `{}`, which was measured by itself\n",
                runs.contender.name(),
                with_error(ratio),
                self.name
            );
            if runs.occupancy().is_some() && race.point.value.is_none() {
                format!("{line}\n{}\n", stages(runs, before))
            } else {
                line
            }
        };
        both.map(text).collect()
    }
}

/// Conditions of a point by name.
fn conditions(point: &Point) -> Map<String, Value> {
    let settings = match serde_json::to_value(&point.settings) {
        Ok(Value::Object(settings)) => settings,
        Ok(_) | Err(_) => Map::new(),
    };
    let (radius, batch) = (point.spacetime.schwarzschild_radius(), point.batch);
    RecordedPoint { value: None, schwarzschild_radius: radius, batch, settings, contenders: Vec::new() }
        .conditions()
}

impl RecordedPoint {
    fn conditions(&self) -> Map<String, Value> {
        let mut conditions = self.settings.clone();
        conditions.insert("batch".to_owned(), self.batch.into());
        conditions.insert("schwarzschild_radius".to_owned(), self.schwarzschild_radius.into());
        conditions
    }
}

impl RecordedContender {
    /// CPU time of a camera path by round, seconds.
    fn per_path(&self) -> Vec<f64> {
        self.rounds.iter().map(|round| round.cpu_seconds / round.paths as f64).collect()
    }

    /// CPU time of a ray in stage number `index` by round, nanoseconds.
    fn per_ray(&self, index: usize) -> Vec<f64> {
        self.rounds.iter().map(|round| per_ray(&round.stages, index)).collect()
    }
}

fn per_path(runs: &Runs) -> Vec<f64> {
    runs.rounds.iter().map(|stats| stats.cpu_seconds / stats.counters.paths as f64).collect()
}

fn per_ray(stages: &StageTimes, index: usize) -> f64 {
    let (_, stage) = stages.named()[index];
    1e9 * stage.seconds / stage.items as f64
}

/// Stages before and now, those that handled rays in both.
fn stages(runs: &Runs, before: &RecordedContender) -> String {
    let row = |(index, (name, _)): (usize, (&'static str, _))| {
        let times: Vec<f64> = runs.rounds.iter().map(|stats| per_ray(&stats.stages, index)).collect();
        let now = Estimate::geometric_mean(&times)?;
        let then = Estimate::geometric_mean(&before.per_ray(index))?;
        Some(
            TableRow::default()
                .cell("stage", name)
                .cell("ns/ray before", format!("{:.1}", then.value))
                .cell("ns/ray", format!("{:.1}", now.value))
                .cell("ratio", with_error(Some(now.over(then)))),
        )
    };
    let names = StageTimes::default().named();
    Table::of(names.into_iter().enumerate().filter_map(row)).markdown()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::bench::{BenchRecord, Contender};
    use crate::trace::Stats;

    fn race(cpu_seconds: f64) -> Race {
        let point = Point::flat();
        let mut stats = Stats { cpu_seconds, ..Stats::default() };
        stats.counters.paths = 100;
        stats.stages.occupancy.count(1, 8, 8);
        (stats.stages.advance.seconds, stats.stages.advance.items) = (0.5 * cpu_seconds, 100);
        let runs = vec![Runs { contender: Contender::Wavefront, rounds: vec![stats; 2] }];
        Race { point, runs }
    }

    fn recorded(race: Race) -> Previous {
        let record = serde_json::to_string(&BenchRecord::new("scene.toml", None, &[race])).unwrap();
        Previous::read("old.json", record.as_bytes()).unwrap()
    }

    #[test]
    fn a_build_that_takes_half_the_time_of_the_one_before_is_said_to() {
        let text = recorded(race(2.0)).text(&[race(1.0)]);
        assert!(text.contains("0.5") && text.contains("old.json"), "{text}");
        assert!(text.contains("advance") && text.contains("10000000.0"), "{text}");
    }

    #[test]
    fn other_settings_are_refused_by_name() {
        let previous = recorded(race(2.0));
        let mut point = race(1.0).point;
        previous.check("old/scene.toml", std::slice::from_ref(&point)).unwrap();
        assert!(previous.check("other.toml", &[]).unwrap_err().cause.contains("scene.toml"));
        point.settings.spp += 1;
        let cause = previous.check("scene.toml", &[point.clone()]).unwrap_err().cause;
        assert!(cause.contains("spp"), "{cause}");
        (point.settings.spp, point.batch) = (point.settings.spp - 1, 16);
        assert!(previous.check("scene.toml", &[point.clone()]).unwrap_err().cause.contains("batch"));
        (point.batch, point.value) = (8, Some(3.0));
        assert!(previous.check("scene.toml", &[point]).unwrap_err().cause.contains("has not measured 3"));
    }
}
