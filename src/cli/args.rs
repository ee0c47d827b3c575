//! The subcommands and their arguments as clap reads them.

use std::path::PathBuf;

use clap::builder::{OsStringValueParser, TypedValueParser};
use clap::{Args, Parser, Subcommand};
use clap_complete::Shell;

use super::bench_args::BenchArgs;
use super::help;
use super::parse;
use super::progress::ProgressArgs;
use super::quality::Quality;
use super::rays_table;
use super::shared_args::{
    AccuracyArgs, ChangeArgs, MemoryArgs, OutputArgs, ReadArgs, RunArgs, SceneArgs, SettingArgs,
};
use crate::math::simd::SimdLevel;
use crate::scene::{LightSampling, Precision, Schedule, Settings, StepperKind};
use crate::spacetime::Entry;
use crate::study::free::Accuracy;

/// A path tracer for real scenes in warped spacetime.
#[derive(Debug, Parser)]
#[command(name = "warpfront", version, after_help = help::ALL)]
pub(super) struct Cli {
    #[command(subcommand)]
    pub(super) command: Command,
    /// Widest vector instructions to use; they change the speed, and no bit of any result
    #[arg(
        long,
        global = true,
        value_enum,
        value_name = "LEVEL",
        default_value = "auto",
        env = "WARPFRONT_SIMD"
    )]
    pub(super) simd: SimdLevel,
}

/// Subcommand.
#[derive(Debug, Subcommand)]
pub(super) enum Command {
    /// Render a scene to an OpenEXR file and a PNG preview
    #[command(after_help = help::RENDER)]
    Render(Box<RenderArgs>),
    /// Tell what a scene holds, and which stages a render of it runs and why
    #[command(after_help = help::INFO)]
    Info(Box<InfoArgs>),
    /// Tell how far a picture is from a reference, and whether noise explains it
    #[command(after_help = help::COMPARE)]
    Compare(CompareArgs),
    /// Draw a fan of rays past the hole, in a plane, with what the plane cuts
    #[command(after_help = help::RAYS)]
    Rays(RaysArgs),
    /// Measure errors and speed of steppers and tolerances on a scene
    #[command(after_help = help::STUDY)]
    Study(StudyArgs),
    /// Race the wavefront against other ways to render a scene, and measure how cost grows
    #[command(after_help = help::BENCH)]
    Bench(BenchArgs),
    /// Follow the rays of a CSV file through empty space around a hole
    #[command(after_help = help::TRACE)]
    Trace(TraceArgs),
    /// Find all rays that join pairs of points around a hole
    #[command(after_help = help::CONNECT)]
    Connect(ConnectArgs),
    /// Print the completions of a shell
    #[command(after_help = help::COMPLETIONS)]
    Completions(CompletionsArgs),
    /// Print a manual page, or write all of them to a folder
    #[command(after_help = help::MAN)]
    Man(ManArgs),
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
    #[command(flatten)]
    pub(super) meter: ProgressArgs,
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
    pub(super) run: RunArgs,
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
    /// OpenEXR file to write: A - B in every channel that both have [default: none]
    #[arg(short, long, value_name = "DIFF.exr", value_parser = OsStringValueParser::new().try_map(|s| parse::exr(&s)))]
    pub(super) output: Option<PathBuf>,
    /// PNG to write: relative difference of the colours, logarithmic from 0.001 (black) to 1 (pale yellow)
    /// [default: none]
    #[arg(long, value_name = "DIFF.png", value_parser = OsStringValueParser::new().try_map(|s| parse::png(&s)))]
    pub(super) png: Option<PathBuf>,
    /// Print JSON
    #[arg(long)]
    pub(super) json: bool,
    /// Exit with 1 if the RMSE of the colours is above this [default: no limit]
    #[arg(long, value_name = "X", value_parser = parse::bound, allow_hyphen_values = true)]
    pub(super) max_rmse: Option<f64>,
    /// Exit with 1 if the relative MSE of the colours is above this [default: no limit]
    #[arg(long, value_name = "X", value_parser = parse::bound, allow_hyphen_values = true)]
    pub(super) max_relmse: Option<f64>,
    /// Exit with 1 unless the colours are identical or the same within noise
    #[arg(long)]
    pub(super) strict: bool,
    #[command(flatten)]
    pub(super) memory: MemoryArgs,
}

/// Arguments of `rays`.
#[derive(Debug, Args)]
pub(super) struct RaysArgs {
    #[command(flatten)]
    pub(super) scene: SceneArgs,
    /// Picture, or table of points, to write
    #[arg(
        short,
        long,
        value_name = "FILE.svg|png|csv",
        value_parser = OsStringValueParser::new().try_map(|s| parse::rays(&s))
    )]
    pub(super) output: PathBuf,
    /// Number of rays
    #[arg(long, value_name = "N", value_parser = parse::ray_count, default_value = "41", allow_hyphen_values = true)]
    pub(super) count: u32,
    /// Angle from the first ray to the last, degrees [default: the camera's horizontal field of view]
    #[arg(long, value_name = "DEG", value_parser = parse::angle, allow_hyphen_values = true)]
    pub(super) fan: Option<f64>,
    /// Start of the rays; they then fan out towards the hole [default: the camera]
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
    #[command(flatten)]
    pub(super) reads: ReadArgs,
    /// CSV file with a ray per row, to be followed through empty space, instead of a scene; may have the columns of
    /// exact ends: status,x1,y1,z1,dx1,dy1,dz1,sens [default: none]
    #[arg(
        long,
        value_name = "RAYS.csv",
        conflicts_with_all = ["scene", "ChangeArgs"]
    )]
    pub(super) rays: Option<PathBuf>,
    /// Spacetime that the rays of --rays are in
    #[arg(
        long,
        value_parser = rays_table::spacetime(),
        value_name = "NAME",
        default_value = "schwarzschild",
        conflicts_with = "scene"
    )]
    pub(super) spacetime: &'static Entry,
    /// Writes PREFIX.csv, PREFIX.svg and PREFIX.png
    #[arg(short, long, value_name = "PREFIX", value_parser = OsStringValueParser::new().try_map(|s| parse::prefix(&s)))]
    pub(super) output: PathBuf,
    /// Steppers, separated by commas [default: all; with --rays, all but rk4-paper]
    #[arg(long, value_name = "LIST", value_enum, value_delimiter = ',', conflicts_with = "light_sampling")]
    pub(super) steppers: Vec<StepperKind>,
    /// Numbers that orbits are followed in, separated by commas; f32 only with tolerances from 1.2e-5 up, below which
    /// it does not go
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
    #[arg(
        long,
        value_name = "LIST",
        value_parser = parse::positive,
        value_delimiter = ',',
        allow_hyphen_values = true,
        conflicts_with = "light_sampling"
    )]
    pub(super) tolerances: Vec<f64>,
    /// Schedules, separated by commas [default: the scene's]
    #[arg(
        long,
        value_name = "LIST",
        value_enum,
        value_delimiter = ',',
        conflicts_with_all = ["rays", "light_sampling"]
    )]
    pub(super) schedules: Vec<Schedule>,
    /// Largest distance between an arc and the true curve, scene units [default: from the pixel footprint]
    #[arg(
        long,
        value_name = "E",
        value_parser = parse::positive,
        allow_hyphen_values = true,
        conflicts_with_all = ["rays", "light_sampling"]
    )]
    pub(super) arc_tolerance: Option<f64>,
    /// Size of the pictures in pixels
    #[arg(
        long,
        value_name = "WxH",
        value_parser = parse::small_size,
        default_value = "160x120",
        allow_hyphen_values = true,
        conflicts_with = "rays"
    )]
    pub(super) size: (usize, usize),
    /// Samples per pixel where the speed of whole paths is measured
    #[arg(
        long,
        value_name = "N",
        value_parser = parse::samples,
        default_value = "4",
        allow_hyphen_values = true,
        conflicts_with_all = ["rays", "light_sampling"]
    )]
    pub(super) spp: u32,
    /// Compares ways to look for lights, separated by commas, instead of steppers [default: none]
    #[arg(long, value_name = "LIST", value_enum, value_delimiter = ',', conflicts_with = "rays")]
    pub(super) light_sampling: Vec<LightSampling>,
    /// Samples per pixel of the pictures of --light-sampling, separated by commas [default: 1,4,16,64]
    #[arg(
        long,
        value_name = "LIST",
        value_parser = parse::samples,
        value_delimiter = ',',
        allow_hyphen_values = true,
        requires = "light_sampling"
    )]
    pub(super) spps: Vec<u32>,
    /// Samples per pixel of the reference of --light-sampling, which is rendered along geodesics [default: 16 times the
    /// largest of --spps]
    #[arg(
        long,
        value_name = "N",
        value_parser = parse::samples,
        allow_hyphen_values = true,
        requires = "light_sampling"
    )]
    pub(super) reference_spp: Option<u32>,
    /// Picture that is the reference of --light-sampling; its noise is known if it has variances
    /// [default: one is rendered]
    #[arg(long, value_name = "FILE.exr", conflicts_with = "reference_spp", requires = "light_sampling")]
    pub(super) reference: Option<PathBuf>,
    /// Times that each setting is measured, all settings in turn; medians of times count
    #[arg(long, value_name = "N", value_parser = parse::count, default_value = "3", allow_hyphen_values = true)]
    pub(super) rounds: u32,
    /// Worker threads; 0 means one per core
    #[arg(long, value_name = "N", value_parser = parse::threads, default_value = "0", allow_hyphen_values = true)]
    pub(super) threads: usize,
    #[command(flatten)]
    pub(super) meter: ProgressArgs,
}

/// Arguments of `trace`.
#[derive(Debug, Args)]
pub(super) struct TraceArgs {
    /// CSV file with a ray per row
    #[arg(value_name = "RAYS.csv")]
    pub(super) rays: PathBuf,
    /// Spacetime that the rays are in
    #[arg(long, value_parser = rays_table::spacetime(), value_name = "NAME")]
    pub(super) spacetime: &'static Entry,
    /// CSV file to write [default: standard output]
    #[arg(short, long, value_name = "OUT.csv")]
    pub(super) output: Option<PathBuf>,
    /// Preset of --stepper and --tolerance
    #[arg(long, value_enum, value_name = "PRESET", default_value = "reference")]
    quality: Quality,
    /// Stepper that advances rays through curved space [default: quadrature around a hole that does not spin, series
    /// around one that does, else the preset's]
    #[arg(long, value_enum, value_name = "NAME")]
    stepper: Option<StepperKind>,
    /// Numbers that orbits are followed in
    #[arg(long, value_enum, value_name = "NAME", default_value = "f64")]
    precision: Precision,
    /// Largest error of a ray's direction, radians at its start [default: the preset's]
    #[arg(long, value_name = "T", value_parser = parse::positive, allow_hyphen_values = true)]
    tolerance: Option<f64>,
    /// Worker threads; 0 means one per core
    #[arg(long, value_name = "N", value_parser = parse::threads, default_value = "0", allow_hyphen_values = true)]
    pub(super) threads: usize,
    #[command(flatten)]
    pub(super) meter: ProgressArgs,
    /// Exit with 1 if a ray was lost: out of steps, or to numbers that are not finite
    #[arg(long)]
    pub(super) strict: bool,
}

impl TraceArgs {
    /// The preset, a stepper that goes over it, and the single flags over both.
    pub(super) fn accuracy(&self, stepper: Option<StepperKind>) -> Accuracy {
        let mut settings = Settings::default();
        self.quality.apply(&mut settings);
        Accuracy {
            stepper: self.stepper.or(stepper).unwrap_or(settings.stepper),
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
    /// Spacetime that the points are in
    #[arg(long, value_parser = rays_table::spacetime(), value_name = "NAME", default_value = "schwarzschild")]
    pub(super) spacetime: &'static Entry,
    /// Highest order: a ray of order 0 takes the short way, of order 1 the other way round, of order 2 the short way
    /// once around the hole, and so on
    #[arg(long, value_name = "N", value_parser = parse::winding, default_value = "1", allow_hyphen_values = true)]
    pub(super) max_winding: u32,
    /// CSV file to write [default: standard output]
    #[arg(short, long, value_name = "OUT.csv")]
    pub(super) output: Option<PathBuf>,
    /// Worker threads; 0 means one per core
    #[arg(long, value_name = "N", value_parser = parse::threads, default_value = "0", allow_hyphen_values = true)]
    pub(super) threads: usize,
    #[command(flatten)]
    pub(super) meter: ProgressArgs,
    /// Exit with 1 if rounding hides a ray
    #[arg(long)]
    pub(super) strict: bool,
}

/// Arguments of `completions`.
#[derive(Debug, Args)]
pub(super) struct CompletionsArgs {
    /// Shell to complete commands in
    #[arg(value_enum, value_name = "SHELL")]
    pub(super) shell: Shell,
}

/// Arguments of `man`.
#[derive(Debug, Args)]
pub(super) struct ManArgs {
    /// Subcommand whose page is printed [default: the program's own page]
    #[arg(value_name = "COMMAND", conflicts_with = "output")]
    pub(super) command: Option<String>,
    /// Folder to write all pages to [default: one is printed]
    #[arg(short, long, value_name = "FOLDER")]
    pub(super) output: Option<PathBuf>,
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use clap::CommandFactory;
    use serde_json::{Value, json};

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

    /// Default of each flag that takes a value: the text behind `[default: ` in its help.
    fn defaults(command: &clap::Command) -> BTreeMap<String, Option<String>> {
        let flags = command.get_arguments().filter(|flag| {
            !flag.is_positional() && !flag.is_required_set() && flag.get_action().takes_values()
        });
        let default = |flag: &clap::Arg| {
            let set: Vec<String> =
                flag.get_default_values().iter().map(|value| value.to_string_lossy().into_owned()).collect();
            let help = flag.get_help().map(ToString::to_string).unwrap_or_default();
            let told = help.split_once("[default: ").map(|(_, told)| told.trim_end_matches(']').to_owned());
            told.or((!set.is_empty()).then(|| set.join(",")))
        };
        flags.map(|flag| (flag.get_id().to_string(), default(flag))).collect()
    }

    #[test]
    fn help_tells_the_default_of_every_flag_that_takes_a_value() {
        for command in Cli::command().get_subcommands() {
            for (flag, default) in defaults(command) {
                assert!(default.is_some(), "{} --{flag} does not tell", command.get_name());
            }
            assert!(command.get_after_help().is_some(), "{} has no examples", command.get_name());
        }
    }

    #[test]
    fn defaults_in_the_help_are_those_that_hold() {
        let settings = serde_json::to_value(Settings::default()).unwrap();
        let told = defaults(Cli::command().find_subcommand("render").unwrap());
        let mut checked = 0;
        for (flag, told) in told {
            let Some((_, told)) =
                told.unwrap().split_once(", else ").map(|(a, b)| (a.to_owned(), b.to_owned()))
            else {
                continue;
            };
            let key = if flag == "mis" { "heuristic" } else { &flag };
            let holds = match &settings[key] {
                serde_json::Value::String(name) => name.clone(),
                serde_json::Value::Number(number) => {
                    assert_eq!(told.parse::<f64>().ok(), number.as_f64(), "--{flag}");
                    told.clone()
                }
                _ if flag == "size" => format!("{}x{}", settings["width"], settings["height"]),
                _ => "from the pixel footprint".to_owned(),
            };
            assert_eq!(told, holds, "--{flag}");
            checked += 1;
        }
        assert!(checked >= 16, "{checked}");
    }

    #[test]
    fn examples_in_the_help_can_be_parsed() {
        let command = Cli::command();
        let texts = command.get_subcommands().chain([&command]).filter_map(|c| c.get_after_help());
        let text: String = texts.map(|text| format!("{text}\n")).collect();
        let examples: Vec<&str> = text.lines().filter(|line| line.starts_with("  warpfront ")).collect();
        assert!(examples.len() > 15);
        for example in examples {
            let arguments = example.split(['|', '>']).next().unwrap_or_default().split_whitespace();
            if let Err(error) = Cli::try_parse_from(arguments) {
                assert!(!error.use_stderr(), "{example}: {error}");
            }
        }
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

    /// Every flag of a setting, with another value than the default, and all settings under these flags.
    fn every_flag() -> (Vec<&'static str>, Value) {
        let flags = [
            "--size=5x6",
            "--filter=box",
            "--background=transparent",
            "--exposure=-1.5",
            "--spp=3",
            "--max-depth=9",
            "--roulette-depth=7",
            "--seed=11",
            "--stepper=rk4-paper",
            "--precision=f32",
            "--schedule=per-pixel",
            "--sampler=independent",
            "--light-sampling=straight",
            "--max-winding=3",
            "--mis=balance",
            "--quality=draft",
            "--tolerance=0.25",
            "--arc-tolerance=0.5",
        ];
        let settings = json!({
            "width": 5,
            "height": 6,
            "filter": "box",
            "background": "transparent",
            "exposure": -1.5,
            "spp": 3,
            "max_depth": 9,
            "roulette_depth": 7,
            "seed": 11,
            "stepper": "rk4-paper",
            "precision": "f32",
            "schedule": "per-pixel",
            "sampler": "independent",
            "light_sampling": "straight",
            "max_winding": 3,
            "heuristic": "balance",
            // Materials are baked with it: `--set render.multiscatter=false`.
            "multiscatter": true,
            "tolerance": 0.25,
            "arc_tolerance": 0.5,
            "arc_tolerance_factor": 4.0,
        });
        (flags.to_vec(), settings)
    }

    #[test]
    fn every_setting_has_its_flag() {
        let (flags, expected) = every_flag();
        let default = Settings::default();
        let given = serde_json::to_value(resolved(&flags, default.clone())).unwrap();
        assert_eq!(given, expected);
        let default = serde_json::to_value(default).unwrap();
        for (key, value) in default.as_object().unwrap().iter().filter(|(key, _)| *key != "multiscatter") {
            assert_ne!(&given[key], value, "no flag changes `{key}`");
        }
    }

    #[test]
    fn every_flag_of_a_setting_is_tested() {
        let (flags, _) = every_flag();
        let command = SettingArgs::augment_args(clap::Command::new("flags"));
        for name in command.get_arguments().filter_map(|argument| argument.get_long()) {
            let start = format!("--{name}=");
            assert!(flags.iter().any(|flag| flag.starts_with(&start)), "{start} is not among {flags:?}");
        }
    }
}
