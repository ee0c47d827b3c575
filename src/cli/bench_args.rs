//! Arguments of `bench`.

use std::path::PathBuf;

use clap::Args;
use clap::builder::{OsStringValueParser, TypedValueParser};

use super::failure::Failure;
use super::parse::{self, Baseline};
use super::progress::ProgressArgs;
use super::shared_args::{AccuracyArgs, SceneArgs, set};
use crate::scene::{LightSampling, Settings, flag_name};
use crate::study::bench::Vary;
use crate::trace::Run;

/// Arguments of `bench`.
#[derive(Debug, Args)]
pub(super) struct BenchArgs {
    #[command(flatten)]
    pub(super) scene: SceneArgs,
    /// Writes PREFIX.csv, PREFIX.json, PREFIX.svg and PREFIX.png [default: no files]
    #[arg(short, long, value_name = "PREFIX", value_parser = OsStringValueParser::new().try_map(|s| parse::prefix(&s)))]
    pub(super) output: Option<PathBuf>,
    /// Contenders of the wavefront, separated by commas: wavefront (against itself: the noise of ratios), per-pixel (the
    /// same kernels, one path after the other), paper (the paper's march, one path after the other), flat (no hole), or
    /// previous:FILE.json (what a build before this one wrote with -o)
    #[arg(
        long,
        value_name = "LIST",
        value_parser = parse::baseline,
        value_delimiter = ',',
        default_value = "per-pixel",
        allow_hyphen_values = true
    )]
    pub(super) baseline: Vec<Baseline>,
    /// Measures how cost grows with this [default: only the race]
    #[arg(long, value_enum, value_name = "WHAT")]
    pub(super) sweep: Option<Vary>,
    /// Values of --sweep, separated by commas [default: some that suit the scene]
    #[arg(
        long,
        value_name = "LIST",
        value_parser = parse::positive,
        value_delimiter = ',',
        allow_hyphen_values = true,
        requires = "sweep"
    )]
    pub(super) values: Vec<f64>,
    /// Times that everything is measured, all in turn, after a render each to warm up
    #[arg(long, value_name = "N", value_parser = parse::count, default_value = "5", allow_hyphen_values = true)]
    pub(super) rounds: u32,
    /// Size of the pictures in pixels
    #[arg(
        long,
        value_name = "WxH",
        value_parser = parse::small_size,
        default_value = "320x240",
        allow_hyphen_values = true
    )]
    pub(super) size: (usize, usize),
    /// Samples per pixel [default: 4]
    #[arg(long, value_name = "N", value_parser = parse::samples, allow_hyphen_values = true)]
    spp: Option<u32>,
    /// Most ray segments in a path, the camera's included [default: the scene's, else 16]
    #[arg(long, value_name = "N", value_parser = parse::segments, allow_hyphen_values = true)]
    max_depth: Option<u32>,
    #[command(flatten)]
    accuracy: AccuracyArgs,
    /// Sampling of lights, beside the rays that run into them [default: the scene's, else geodesic]
    #[arg(long, value_enum, value_name = "NAME")]
    light_sampling: Option<LightSampling>,
    /// Worker threads; 0 means one per core [default: 0]
    #[arg(long, value_name = "N", value_parser = parse::threads, allow_hyphen_values = true)]
    threads: Option<usize>,
    /// Rays in flight per worker [default: 1024]
    #[arg(long, value_name = "N", value_parser = parse::batch, allow_hyphen_values = true)]
    batch: Option<usize>,
    #[command(flatten)]
    pub(super) meter: ProgressArgs,
}

/// Samples per pixel.
const SPP: u32 = 4;

impl BenchArgs {
    /// Puts the flags over what the scene file says.
    pub(super) fn apply(&self, settings: &mut Settings) {
        self.accuracy.apply(settings);
        (settings.width, settings.height) = self.size;
        settings.spp = self.spp.unwrap_or(SPP);
        set(self.max_depth, &mut settings.max_depth);
        set(self.light_sampling, &mut settings.light_sampling);
    }

    /// Run options of the renders.
    pub(super) fn run(&self) -> Run {
        let Run { threads, batch, .. } = Run::default();
        Run { threads: self.threads.unwrap_or(threads), batch: self.batch.unwrap_or(batch), ..Run::default() }
    }

    /// Refuses a flag for what is swept.
    pub(super) fn check(&self) -> Result<(), Failure> {
        let given = match self.sweep {
            Some(Vary::Batch) => self.batch.is_some(),
            Some(Vary::Threads) => self.threads.is_some(),
            Some(Vary::Spp) => self.spp.is_some(),
            Some(Vary::Tolerance) => self.accuracy.has_tolerance(),
            Some(Vary::Depth) => self.max_depth.is_some(),
            Some(Vary::Pixels | Vary::Radius | Vary::Triangles) | None => false,
        };
        match self.sweep.filter(|_| given) {
            Some(sweep) => {
                let name = flag_name(sweep);
                let flag = if sweep == Vary::Depth { "max-depth".to_owned() } else { name.clone() };
                let message = format!("--{flag} cannot be used with --sweep {name}, which sets it");
                Err(Failure::new(message)
                    .help(format!("leave it out; --values says which {name} to measure")))
            }
            None => Ok(()),
        }
    }
}
