//! The arguments as clap reads them.

use std::path::PathBuf;
use std::time::Duration;

use clap::builder::{OsStringValueParser, TypedValueParser};
use clap::{Args, Parser, Subcommand};

use super::bench_args::BenchArgs;
use super::failure::Failure;
use super::parse;
use super::quality::Quality;
use super::rays_table::Spacetime;
use crate::film::Aov;
use crate::light::Heuristic;
use crate::scene::{Filter, LightSampling, Precision, SamplerKind, Schedule, Settings, StepperKind};
use crate::study::free::Accuracy;
use crate::trace::Run;

/// A path tracer for real scenes in warped spacetime.
#[derive(Debug, Parser)]
#[command(name = "warpfront", version)]
pub(super) struct Cli {
    #[command(subcommand)]
    pub(super) command: Command,
}

/// What to do.
#[derive(Debug, Subcommand)]
pub(super) enum Command {
    /// Render a scene to an OpenEXR file and a PNG preview
    Render(Box<RenderArgs>),
    /// Tell what a scene holds, and which stages a render of it runs and why
    Info(Box<InfoArgs>),
    /// Tell how far a picture is from a reference, and whether noise explains it
    Compare(CompareArgs),
    /// Draw a fan of rays past the hole, in a plane, with what the plane cuts
    Rays(RaysArgs),
    /// Measure errors and speed of steppers and tolerances on a scene
    Study(StudyArgs),
    /// Race the wavefront against other ways to render a scene, and measure how cost grows
    Bench(BenchArgs),
    /// Follow the rays of a CSV file through empty space around a hole
    Trace(TraceArgs),
    /// Find all rays that join pairs of points around a hole
    Connect(ConnectArgs),
}

/// Arguments of `render`.
#[derive(Debug, Args)]
pub(super) struct RenderArgs {
    #[command(flatten)]
    pub(super) scene: SceneArgs,
    #[command(flatten)]
    pub(super) output: OutputArgs,
    #[command(flatten)]
    pub(super) settings: SettingArgs,
    #[command(flatten)]
    pub(super) run: RunArgs,
    /// Exit with 1 if anything was lost: rays, parts of the scene, or samples through an interruption
    #[arg(long)]
    pub(super) strict: bool,
}

/// Arguments of `info`.
#[derive(Debug, Args)]
pub(super) struct InfoArgs {
    #[command(flatten)]
    pub(super) scene: SceneArgs,
    #[command(flatten)]
    pub(super) settings: SettingArgs,
    #[command(flatten)]
    pub(super) share: ShareArgs,
    /// Print JSON
    #[arg(long)]
    pub(super) json: bool,
}

/// Arguments of `compare`.
#[derive(Debug, Args)]
pub(super) struct CompareArgs {
    /// OpenEXR picture
    #[arg(value_name = "A.exr")]
    pub(super) a: PathBuf,
    /// OpenEXR picture of the same size: the reference
    #[arg(value_name = "B.exr")]
    pub(super) b: PathBuf,
    /// OpenEXR file to write: A - B in every channel that both have
    #[arg(short, long, value_name = "DIFF.exr", value_parser = OsStringValueParser::new().try_map(|s| parse::exr(&s)))]
    pub(super) output: Option<PathBuf>,
    /// PNG to write: relative difference of the colours, logarithmic from 0.001 (black) to 1 (pale yellow)
    #[arg(long, value_name = "DIFF.png", value_parser = OsStringValueParser::new().try_map(|s| parse::png(&s)))]
    pub(super) png: Option<PathBuf>,
    /// Print JSON
    #[arg(long)]
    pub(super) json: bool,
    /// Exit with 1 if the RMSE of the colours is above this
    #[arg(long, value_name = "X", value_parser = parse::bound, allow_hyphen_values = true)]
    pub(super) max_rmse: Option<f64>,
    /// Exit with 1 if the relative MSE of the colours is above this
    #[arg(long, value_name = "X", value_parser = parse::bound, allow_hyphen_values = true)]
    pub(super) max_relmse: Option<f64>,
    /// Exit with 1 unless the colours are identical or the same within noise
    #[arg(long)]
    pub(super) strict: bool,
}

/// Arguments of `rays`.
#[derive(Debug, Args)]
pub(super) struct RaysArgs {
    #[command(flatten)]
    pub(super) scene: SceneArgs,
    /// Picture, or table of points, to write
    #[arg(short, long, value_name = "FILE.svg|png|csv", value_parser = OsStringValueParser::new().try_map(|s| parse::rays(&s)))]
    pub(super) output: PathBuf,
    /// Number of rays
    #[arg(long, value_name = "N", value_parser = parse::ray_count, default_value = "41", allow_hyphen_values = true)]
    pub(super) count: u32,
    /// Angle from the first ray to the last, degrees [default: the camera's horizontal field of view]
    #[arg(long, value_name = "DEG", value_parser = parse::angle, allow_hyphen_values = true)]
    pub(super) fan: Option<f64>,
    /// Where the rays start; they then fan out towards the hole [default: the camera]
    #[arg(long, value_name = "X,Y,Z", value_parser = parse::triple, allow_hyphen_values = true)]
    pub(super) from: Option<[f64; 3]>,
    /// Direction up from the plane of the rays, as far as the hole in the plane allows [default: the plane holds the
    /// view direction]
    #[arg(long, value_name = "X,Y,Z", value_parser = parse::triple, allow_hyphen_values = true)]
    pub(super) up: Option<[f64; 3]>,
    #[command(flatten)]
    pub(super) accuracy: AccuracyArgs,
}

/// Arguments of `study`.
#[derive(Debug, Args)]
#[command(override_usage = "warpfront study [OPTIONS] -o <PREFIX> <SCENE>\n       \
                            warpfront study [OPTIONS] -o <PREFIX> <SCENE> --light-sampling <LIST>\n       \
                            warpfront study [OPTIONS] -o <PREFIX> --rays <RAYS.csv>")]
pub(super) struct StudyArgs {
    /// Scene file: .toml, .gltf, .glb or .obj
    #[arg(value_name = "SCENE")]
    pub(super) scene: Option<PathBuf>,
    #[command(flatten)]
    pub(super) changes: ChangeArgs,
    /// CSV file with a ray per row, to be followed through empty space, instead of a scene; may have the columns of exact
    /// ends: status,x1,y1,z1,dx1,dy1,dz1,sens
    #[arg(
        long,
        value_name = "RAYS.csv",
        conflicts_with_all = ["scene", "ChangeArgs"]
    )]
    pub(super) rays: Option<PathBuf>,
    /// Spacetime that the rays of --rays are in
    #[arg(long, value_enum, value_name = "NAME", default_value = "schwarzschild", conflicts_with = "scene")]
    pub(super) spacetime: Spacetime,
    /// Writes PREFIX.csv, PREFIX.svg and PREFIX.png
    #[arg(short, long, value_name = "PREFIX", value_parser = OsStringValueParser::new().try_map(|s| parse::prefix(&s)))]
    pub(super) output: PathBuf,
    /// Steppers, separated by commas [default: all; with --rays, all but rk4-paper]
    #[arg(long, value_name = "LIST", value_enum, value_delimiter = ',', conflicts_with = "light_sampling")]
    pub(super) steppers: Vec<StepperKind>,
    /// Numbers that orbits are followed in, separated by commas; f32 only with tolerances from 1.2e-5 up, below which it
    /// does not go
    #[arg(
        long,
        value_name = "LIST",
        value_enum,
        value_delimiter = ',',
        default_value = "f64,f32",
        conflicts_with = "light_sampling"
    )]
    pub(super) precisions: Vec<Precision>,
    /// Tolerances, separated by commas [default: 1e-2 to 1e-8 in decades; with --rays, to 1e-12]
    #[arg(long, value_name = "LIST", value_parser = parse::positive, value_delimiter = ',', allow_hyphen_values = true, conflicts_with = "light_sampling")]
    pub(super) tolerances: Vec<f64>,
    /// Schedules, separated by commas [default: the scene's]
    #[arg(long, value_name = "LIST", value_enum, value_delimiter = ',', conflicts_with_all = ["rays", "light_sampling"])]
    pub(super) schedules: Vec<Schedule>,
    /// Largest distance between an arc and the true curve, scene units [default: from the pixel footprint]
    #[arg(long, value_name = "E", value_parser = parse::positive, allow_hyphen_values = true, conflicts_with_all = ["rays", "light_sampling"])]
    pub(super) arc_tolerance: Option<f64>,
    /// Size of the pictures in pixels
    #[arg(long, value_name = "WxH", value_parser = parse::small_size, default_value = "160x120", allow_hyphen_values = true, conflicts_with = "rays")]
    pub(super) size: (usize, usize),
    /// Samples per pixel where the speed of whole paths is measured
    #[arg(long, value_name = "N", value_parser = parse::count, default_value = "4", allow_hyphen_values = true, conflicts_with_all = ["rays", "light_sampling"])]
    pub(super) spp: u32,
    /// Compares ways to look for lights, separated by commas, instead of steppers
    #[arg(long, value_name = "LIST", value_enum, value_delimiter = ',', conflicts_with = "rays")]
    pub(super) light_sampling: Vec<LightSampling>,
    /// Samples per pixel of the pictures of --light-sampling, separated by commas [default: 1,4,16,64]
    #[arg(
        long,
        value_name = "LIST",
        value_parser = parse::count,
        value_delimiter = ',',
        allow_hyphen_values = true,
        requires = "light_sampling"
    )]
    pub(super) spps: Vec<u32>,
    /// Samples per pixel of the reference of --light-sampling, which is rendered along geodesics [default: 16 times the
    /// largest of --spps]
    #[arg(long, value_name = "N", value_parser = parse::count, allow_hyphen_values = true, requires = "light_sampling")]
    pub(super) reference_spp: Option<u32>,
    /// Picture that is the reference of --light-sampling; its noise is known if it has variances
    #[arg(long, value_name = "FILE.exr", conflicts_with = "reference_spp", requires = "light_sampling")]
    pub(super) reference: Option<PathBuf>,
    /// Times that each setting is measured, all settings in turn; medians of times count
    #[arg(long, value_name = "N", value_parser = parse::count, default_value = "3", allow_hyphen_values = true)]
    pub(super) rounds: u32,
    /// Worker threads; 0 means one per core
    #[arg(long, value_name = "N", value_parser = parse::threads, default_value = "0", allow_hyphen_values = true)]
    pub(super) threads: usize,
}

/// Arguments of `trace`.
#[derive(Debug, Args)]
pub(super) struct TraceArgs {
    /// CSV file with a ray per row
    #[arg(value_name = "RAYS.csv")]
    pub(super) rays: PathBuf,
    /// Spacetime that the rays are in
    #[arg(long, value_enum, value_name = "NAME")]
    pub(super) spacetime: Spacetime,
    /// CSV file to write [default: standard output]
    #[arg(short, long, value_name = "OUT.csv")]
    pub(super) output: Option<PathBuf>,
    /// Preset of --stepper and --tolerance
    #[arg(long, value_enum, value_name = "PRESET", default_value = "reference")]
    quality: Quality,
    /// How rays are advanced through curved space
    #[arg(long, value_enum, value_name = "NAME")]
    stepper: Option<StepperKind>,
    /// Numbers that orbits are followed in
    #[arg(long, value_enum, value_name = "NAME", default_value = "f64")]
    precision: Precision,
    /// Largest error of a ray's direction, radians at its start
    #[arg(long, value_name = "T", value_parser = parse::positive, allow_hyphen_values = true)]
    tolerance: Option<f64>,
    /// Worker threads; 0 means one per core
    #[arg(long, value_name = "N", value_parser = parse::threads, default_value = "0", allow_hyphen_values = true)]
    pub(super) threads: usize,
    /// Exit with 1 if a ray was lost: out of steps, or to numbers that are not finite
    #[arg(long)]
    pub(super) strict: bool,
}

impl TraceArgs {
    /// The preset, and the single flags over it.
    pub(super) fn accuracy(&self) -> Accuracy {
        let mut settings = Settings::default();
        self.quality.apply(&mut settings);
        Accuracy {
            stepper: self.stepper.unwrap_or(settings.stepper),
            tolerance: self.tolerance.unwrap_or(settings.tolerance),
            precision: self.precision,
        }
    }
}

/// Arguments of `connect`.
#[derive(Debug, Args)]
pub(super) struct ConnectArgs {
    /// CSV file with a pair of points per row
    #[arg(value_name = "PAIRS.csv")]
    pub(super) pairs: PathBuf,
    /// Highest order: a ray of order 0 takes the short way, of order 1 the other way round, of order 2 the short way once
    /// around the hole, and so on
    #[arg(long, value_name = "N", value_parser = parse::winding, default_value = "1", allow_hyphen_values = true)]
    pub(super) max_winding: u32,
    /// CSV file to write [default: standard output]
    #[arg(short, long, value_name = "OUT.csv")]
    pub(super) output: Option<PathBuf>,
    /// Worker threads; 0 means one per core
    #[arg(long, value_name = "N", value_parser = parse::threads, default_value = "0", allow_hyphen_values = true)]
    pub(super) threads: usize,
    /// Exit with 1 if rounding hides a ray
    #[arg(long)]
    pub(super) strict: bool,
}

/// Which scene, and what is changed in it.
#[derive(Debug, Args)]
pub(super) struct SceneArgs {
    /// Scene file: .toml, .gltf, .glb or .obj
    #[arg(value_name = "SCENE")]
    pub(super) path: PathBuf,
    #[command(flatten)]
    pub(super) changes: ChangeArgs,
}

/// What is changed in a scene.
#[derive(Debug, Args)]
pub(super) struct ChangeArgs {
    /// Set a value of the scene file; may be given several times
    #[arg(long = "set", value_name = "KEY=VALUE", value_parser = parse::assignment)]
    pub(super) overrides: Vec<String>,
    /// Put a black hole of Schwarzschild radius RS at X,Y,Z, scene units
    #[arg(long, value_name = "X,Y,Z,RS", value_parser = parse::black_hole, allow_hyphen_values = true)]
    pub(super) black_hole: Option<[f64; 4]>,
}

/// Which files are written.
#[derive(Debug, Args)]
#[command(next_help_heading = "Output")]
pub(super) struct OutputArgs {
    /// OpenEXR file to write
    #[arg(short, long, value_name = "FILE.exr", value_parser = OsStringValueParser::new().try_map(|s| parse::exr(&s)))]
    pub(super) output: PathBuf,
    /// PNG preview to write [default: beside the EXR, with the same stem]
    #[arg(long, value_name = "FILE.png", value_parser = OsStringValueParser::new().try_map(|s| parse::png(&s)))]
    pub(super) png: Option<PathBuf>,
    /// Write no PNG preview
    #[arg(long, conflicts_with = "png")]
    pub(super) no_png: bool,
    /// Write settings, counts and times as JSON
    #[arg(long, value_name = "FILE.json", value_parser = OsStringValueParser::new().try_map(|s| parse::json(&s)))]
    pub(super) stats: Option<PathBuf>,
}

/// What goes over the settings of the scene file.
#[derive(Debug, Default, Args)]
#[command(next_help_heading = "Picture")]
pub(super) struct SettingArgs {
    /// Samples per pixel
    #[arg(long, value_name = "N", value_parser = parse::count, allow_hyphen_values = true)]
    spp: Option<u32>,
    /// Size of the picture in pixels
    #[arg(long, value_name = "WxH", value_parser = parse::size, allow_hyphen_values = true)]
    size: Option<(usize, usize)>,
    #[command(flatten)]
    accuracy: AccuracyArgs,
    /// Order in which the kernels run; the picture is the same
    #[arg(long, value_enum, value_name = "NAME")]
    schedule: Option<Schedule>,
    /// Most ray segments in a path, the camera's included
    #[arg(long, value_name = "N", value_parser = parse::count, allow_hyphen_values = true)]
    max_depth: Option<u32>,
    /// Seed of all random numbers
    #[arg(long, value_name = "N", value_parser = parse::seed, allow_hyphen_values = true)]
    seed: Option<u64>,
    /// Exposure of the PNG preview in stops
    #[arg(long, value_name = "STOPS", value_parser = parse::exposure, allow_hyphen_values = true)]
    exposure: Option<f64>,
    /// Reconstruction filter
    #[arg(long, value_enum, value_name = "NAME")]
    filter: Option<Filter>,
    /// Source of random numbers
    #[arg(long, value_enum, value_name = "NAME")]
    sampler: Option<SamplerKind>,
    /// How lights are looked for beside the rays that run into them; `straight` is the paper's way, wrong near a hole
    #[arg(long, value_enum, value_name = "NAME")]
    light_sampling: Option<LightSampling>,
    /// Largest winding number of rays to lights that are looked for
    #[arg(long, value_name = "N", value_parser = parse::winding, allow_hyphen_values = true)]
    max_winding: Option<u32>,
    /// How light that is found both ways is shared
    #[arg(long, value_enum, value_name = "NAME")]
    mis: Option<Heuristic>,
}

/// How rays are integrated.
#[derive(Debug, Default, Args)]
pub(super) struct AccuracyArgs {
    /// Preset of --stepper, --tolerance and --arc-tolerance
    #[arg(long, value_enum, value_name = "PRESET")]
    quality: Option<Quality>,
    /// How rays are advanced through curved space
    #[arg(long, value_enum, value_name = "NAME")]
    stepper: Option<StepperKind>,
    /// Numbers that orbits are followed in
    #[arg(long, value_enum, value_name = "NAME")]
    precision: Option<Precision>,
    /// Largest error of a ray's direction, radians at its start
    #[arg(long, value_name = "T", value_parser = parse::positive, allow_hyphen_values = true)]
    tolerance: Option<f64>,
    /// Largest distance between an arc and the true curve, scene units [default: from the pixel footprint]
    #[arg(long, value_name = "E", value_parser = parse::positive, allow_hyphen_values = true)]
    arc_tolerance: Option<f64>,
}

/// Puts a flag, if given, over a setting.
pub(super) fn set<T: Copy>(flag: Option<T>, value: &mut T) {
    *value = flag.unwrap_or(*value);
}

impl AccuracyArgs {
    /// Whether the tolerance is given.
    pub(super) fn has_tolerance(&self) -> bool {
        self.tolerance.is_some()
    }

    /// Puts the preset, then the single flags, over what the scene file says.
    pub(super) fn apply(&self, settings: &mut Settings) {
        if let Some(quality) = self.quality {
            quality.apply(settings);
        }
        settings.arc_tolerance = self.arc_tolerance.or(settings.arc_tolerance);
        set(self.stepper, &mut settings.stepper);
        set(self.precision, &mut settings.precision);
        set(self.tolerance, &mut settings.tolerance);
    }
}

impl SettingArgs {
    /// Puts the flags over what the scene file says.
    pub(super) fn apply(&self, settings: &mut Settings) {
        self.accuracy.apply(settings);
        if let Some((width, height)) = self.size {
            (settings.width, settings.height) = (width, height);
        }
        set(self.spp, &mut settings.spp);
        set(self.schedule, &mut settings.schedule);
        set(self.max_depth, &mut settings.max_depth);
        set(self.seed, &mut settings.seed);
        set(self.exposure, &mut settings.exposure);
        set(self.filter, &mut settings.filter);
        set(self.sampler, &mut settings.sampler);
        set(self.light_sampling, &mut settings.light_sampling);
        set(self.max_winding, &mut settings.max_winding);
        set(self.mis, &mut settings.heuristic);
    }
}

/// A list without repetitions, in order.
pub(super) fn distinct<T: Copy + PartialEq>(values: &[T]) -> Vec<T> {
    let mut distinct = Vec::new();
    for &value in values {
        if !distinct.contains(&value) {
            distinct.push(value);
        }
    }
    distinct
}

/// What is rendered, and by whom.
#[derive(Debug, Default, Args)]
#[command(next_help_heading = "Run")]
pub(super) struct ShareArgs {
    /// Worker threads; 0 means one per core
    #[arg(long, value_name = "N", value_parser = parse::threads, default_value = "0", allow_hyphen_values = true)]
    threads: usize,
    /// Rays in flight per worker
    #[arg(long, value_name = "N", value_parser = parse::batch, allow_hyphen_values = true)]
    batch: Option<usize>,
    /// Planes to write beside the colours, separated by commas
    #[arg(long = "aov", value_name = "LIST", value_enum, value_delimiter = ',')]
    aovs: Vec<Aov>,
    /// Render only the pixels from X0,Y0 up to but without X1,Y1
    #[arg(long, value_name = "X0,Y0,X1,Y1", value_parser = parse::crop, allow_hyphen_values = true)]
    crop: Option<[usize; 4]>,
}

/// How the render runs.
#[derive(Debug, Default, Args)]
#[command(next_help_heading = "Run")]
pub(super) struct RunArgs {
    #[command(flatten)]
    share: ShareArgs,
    /// Stop after this time, such as 90s, 5m or 1h30m
    #[arg(long, value_name = "TIME", value_parser = parse::duration, allow_hyphen_values = true)]
    time_limit: Option<Duration>,
    /// Stop when the mean relative standard error of the picture falls below this
    #[arg(long, value_name = "X", value_parser = parse::positive, allow_hyphen_values = true)]
    noise: Option<f64>,
}

impl RunArgs {
    /// The run for a picture of `width` × `height` pixels.
    pub(super) fn resolve(&self, width: usize, height: usize) -> Result<Run, Failure> {
        let run = self.share.resolve(width, height)?;
        Ok(Run { time_limit: self.time_limit, noise: self.noise, ..run })
    }
}

impl ShareArgs {
    /// The run for a picture of `width` × `height` pixels.
    pub(super) fn resolve(&self, width: usize, height: usize) -> Result<Run, Failure> {
        if let Some([x0, y0, x1, y1]) = self.crop.filter(|[_, _, x1, y1]| *x1 > width || *y1 > height) {
            let message =
                format!("--crop {x0},{y0},{x1},{y1} reaches outside the picture of {width}x{height} pixels");
            return Err(
                Failure::new(message).help(format!("stay within 0,0,{width},{height}, or change --size"))
            );
        }
        Ok(Run {
            threads: self.threads,
            batch: self.batch.unwrap_or(Run::default().batch),
            crop: self.crop,
            aovs: distinct(&self.aovs),
            ..Run::default()
        })
    }
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory;

    use super::*;

    fn resolved(flags: &[&str], settings: Settings) -> Settings {
        let arguments = ["warpfront", "render", "scene.toml", "-o", "out.exr"].iter().chain(flags);
        let Command::Render(args) = Cli::try_parse_from(arguments).unwrap().command else { panic!() };
        let mut settings = settings;
        args.settings.apply(&mut settings);
        settings
    }

    #[test]
    fn the_argument_definitions_are_consistent() {
        Cli::command().debug_assert();
    }

    #[test]
    fn without_flags_the_scene_file_decides() {
        let scene = Settings { spp: 7, tolerance: 0.5, arc_tolerance: Some(2.0), ..Settings::default() };
        assert_eq!(resolved(&[], scene.clone()), scene);
    }

    #[test]
    fn the_preset_goes_over_the_scene_file_and_flags_over_the_preset() {
        let scene = Settings { tolerance: 0.5, arc_tolerance: Some(2.0), ..Settings::default() };
        let preset = resolved(&["--quality", "draft"], scene.clone());
        assert_eq!((preset.tolerance, preset.arc_tolerance, preset.arc_tolerance_factor), (1e-3, None, 4.0));
        let flags = resolved(&["--quality", "draft", "--tolerance", "1e-4", "--arc-tolerance", "0.1"], scene);
        assert_eq!((flags.tolerance, flags.arc_tolerance), (1e-4, Some(0.1)));
    }

    #[test]
    fn every_setting_has_its_flag() {
        let flags = [
            "--spp=3",
            "--size=5x6",
            "--stepper=rk4-paper",
            "--precision=f32",
            "--schedule=per-pixel",
            "--max-depth=9",
            "--seed=11",
            "--exposure=-1.5",
            "--filter=box",
            "--sampler=independent",
            "--light-sampling=straight",
            "--max-winding=3",
            "--mis=power",
        ];
        let expected = Settings {
            width: 5,
            height: 6,
            filter: Filter::Box,
            exposure: -1.5,
            spp: 3,
            max_depth: 9,
            seed: 11,
            stepper: StepperKind::Rk4Paper,
            precision: Precision::F32,
            schedule: Schedule::PerPixel,
            sampler: SamplerKind::Independent,
            light_sampling: LightSampling::Straight,
            max_winding: 3,
            heuristic: Heuristic::Power,
            ..Settings::default()
        };
        assert_eq!(resolved(&flags, Settings::default()), expected);
    }

    #[test]
    fn a_crop_must_lie_within_the_picture() {
        let args = ShareArgs { crop: Some([0, 0, 17, 12]), ..ShareArgs::default() };
        assert!(args.resolve(17, 12).is_ok());
        let message = args.resolve(16, 12).unwrap_err().to_string();
        assert!(message.contains("--crop 0,0,17,12") && message.contains("16x12"), "{message}");
    }

    #[test]
    fn a_plane_asked_for_twice_is_written_once() {
        let args = ShareArgs { aovs: vec![Aov::Depth, Aov::Normal, Aov::Depth], ..ShareArgs::default() };
        assert_eq!(args.resolve(1, 1).unwrap().aovs, [Aov::Depth, Aov::Normal]);
    }
}
