//! Groups of arguments that several subcommands take.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::time::Duration;

use clap::Args;
use clap::builder::{OsStringValueParser, TypedValueParser};

use super::failure::Failure;
use super::parse::{self, Planes};
use super::quality::Quality;
use crate::asset::{Files, Memory};
use crate::light::Heuristic;
use crate::scene::{
    Background, Filter, LightSampling, LoadOptions, Precision, SamplerKind, Schedule, Settings, StepperKind,
    Surroundings,
};
use crate::trace::Run;

/// Scene to load, and changes to it.
#[derive(Debug, Args)]
pub(super) struct SceneArgs {
    /// Scene file: .toml, .gltf, .glb or .obj
    #[arg(value_name = "SCENE")]
    pub(super) path: PathBuf,
    #[command(flatten)]
    pub(super) changes: ChangeArgs,
    #[command(flatten)]
    reads: ReadArgs,
}

impl SceneArgs {
    /// Load options of the scene.
    pub(super) fn options(&self) -> Result<LoadOptions, Failure> {
        Ok(self.changes.options(self.reads.files(&self.path)?))
    }
}

/// Limit on memory.
#[derive(Debug, Default, Args)]
pub(super) struct MemoryArgs {
    /// Most memory to use, such as 8G or 500M; what would not fit is an error [default: what the system leaves]
    #[arg(long, value_name = "SIZE", value_parser = parse::memory, help_heading = "Limits", allow_hyphen_values = true)]
    max_memory: Option<u64>,
}

impl MemoryArgs {
    /// The memory there is.
    pub(super) fn memory(&self) -> Memory {
        Memory::at_most(self.max_memory)
    }
}

/// Limits on reading.
#[derive(Debug, Default, Args)]
pub(super) struct ReadArgs {
    #[command(flatten)]
    memory: MemoryArgs,
    /// Read no file outside the scene's folder, symbolic links included, as for the scenes of strangers
    #[arg(long, help_heading = "Limits")]
    confine: bool,
}

impl ReadArgs {
    /// The memory there is.
    pub(super) fn memory(&self) -> Memory {
        self.memory.memory()
    }

    /// Reader of the files of the scene at a path.
    pub(super) fn files(&self, scene: &Path) -> Result<Files, Failure> {
        let files = Files::within(self.memory.memory());
        if !self.confine {
            return Ok(files);
        }
        let folder = scene.parent().unwrap_or(Path::new(""));
        files.confined_to(folder).map_err(|error| {
            Failure::new(format!("{}: its folder cannot be read: {error}", scene.display()))
                .help("check the path")
        })
    }
}

/// Changes to a scene.
#[derive(Debug, Args)]
pub(super) struct ChangeArgs {
    /// Set a value of the scene file; may be given several times [default: none]
    #[arg(long = "set", value_name = "KEY=VALUE", value_parser = parse::assignment)]
    overrides: Vec<String>,
    /// Put a black hole of Schwarzschild radius RS at X,Y,Z, scene units, which spins about +Y by SPIN = a/M from -1 to 1
    /// [default: the scene's spacetime; SPIN 0]
    #[arg(long, value_name = "X,Y,Z,RS[,SPIN]", value_parser = parse::black_hole, allow_hyphen_values = true)]
    black_hole: Option<[f64; 5]>,
    /// Light from everywhere around: a picture, R,G,B, `sky` or `black` [default: the scene's]
    #[arg(long, value_name = "FILE|R,G,B", value_parser = OsStringValueParser::new().try_map(parse::surroundings))]
    environment: Option<Surroundings>,
    /// Camera of the scene's models to take, by its name [default: the one of the scene file, or the first]
    #[arg(long, value_name = "NAME")]
    camera: Option<String>,
    /// Factor on the lights of glTF files, from candela to W/sr [default: light_scale in the scene file, or 1/683]
    #[arg(long, value_name = "X", value_parser = parse::bound, allow_hyphen_values = true)]
    light_scale: Option<f64>,
    /// Moment of the animations of glTF files, seconds
    #[arg(long, value_name = "SECONDS", default_value_t = 0.0, value_parser = parse::bound, allow_hyphen_values = true)]
    time: f64,
}

impl ChangeArgs {
    /// Load options of the scene, whose files `files` reads.
    pub(super) fn options(&self, files: Files) -> LoadOptions {
        LoadOptions {
            overrides: self.overrides.clone(),
            black_hole: self.black_hole,
            environment: self.environment.clone(),
            camera: self.camera.clone(),
            light_scale: self.light_scale,
            time: self.time,
            size: None,
            files,
        }
    }
}

/// Files that are written.
#[derive(Debug, Args)]
#[command(next_help_heading = "Output")]
pub(super) struct OutputArgs {
    /// OpenEXR file to write [default: the scene's name with .exr, in the current folder]
    #[arg(short, long, value_name = "FILE.exr", value_parser = OsStringValueParser::new().try_map(|s| parse::exr(&s)))]
    output: Option<PathBuf>,
    /// PNG preview to write [default: beside the EXR, with the same stem]
    #[arg(long, value_name = "FILE.png", value_parser = OsStringValueParser::new().try_map(|s| parse::png(&s)))]
    pub(super) png: Option<PathBuf>,
    /// Write no PNG preview
    #[arg(long, conflicts_with = "png")]
    pub(super) no_png: bool,
    /// Write settings, counts and times as JSON [default: not written]
    #[arg(long, value_name = "FILE.json", value_parser = OsStringValueParser::new().try_map(|s| parse::json(&s)))]
    pub(super) stats: Option<PathBuf>,
}

impl OutputArgs {
    /// The picture of `scene`.
    pub(super) fn picture(&self, scene: &Path) -> PathBuf {
        self.output.clone().unwrap_or_else(|| {
            let mut name = scene.file_stem().unwrap_or(OsStr::new("picture")).to_owned();
            name.push(".exr");
            name.into()
        })
    }
}

/// Settings that go over those of the scene file.
#[derive(Debug, Default, Args)]
#[command(next_help_heading = "Picture")]
pub(super) struct SettingArgs {
    /// Samples per pixel [default: the scene's, else 64]
    #[arg(long, value_name = "N", value_parser = parse::samples, allow_hyphen_values = true)]
    spp: Option<u32>,
    /// Size of the picture in pixels [default: the scene's, else 640x480]
    #[arg(long, value_name = "WxH", value_parser = parse::size, allow_hyphen_values = true)]
    size: Option<(usize, usize)>,
    #[command(flatten)]
    accuracy: AccuracyArgs,
    /// Order in which the kernels run; the picture is the same [default: the scene's, else wavefront]
    #[arg(long, value_enum, value_name = "NAME")]
    schedule: Option<Schedule>,
    /// Most ray segments in a path, the camera's included [default: the scene's, else 16]
    #[arg(long, value_name = "N", value_parser = parse::segments, allow_hyphen_values = true)]
    max_depth: Option<u32>,
    /// Russian roulette may end paths after this many segments [default: the scene's, else 5]
    #[arg(long, value_name = "N", value_parser = parse::roulette, allow_hyphen_values = true)]
    roulette_depth: Option<u32>,
    /// Seed of all random numbers [default: the scene's, else 0]
    #[arg(long, value_name = "N", value_parser = parse::seed, allow_hyphen_values = true)]
    seed: Option<u64>,
    /// Exposure of the PNG preview in stops [default: the scene's, else 0]
    #[arg(long, value_name = "STOPS", value_parser = parse::exposure, allow_hyphen_values = true)]
    exposure: Option<f64>,
    /// Reconstruction filter [default: the scene's, else tent]
    #[arg(long, value_enum, value_name = "NAME")]
    filter: Option<Filter>,
    /// Light of camera rays that leave to infinity: the environment, or nothing with alpha 0 [default: the scene's,
    /// else opaque]
    #[arg(long, value_enum, value_name = "NAME")]
    background: Option<Background>,
    /// Source of random numbers [default: the scene's, else sobol]
    #[arg(long, value_enum, value_name = "NAME")]
    sampler: Option<SamplerKind>,
    /// Sampling of lights, beside the rays that run into them; `straight` is the paper's way, wrong near a hole
    /// [default: the scene's, else geodesic]
    #[arg(long, value_enum, value_name = "NAME")]
    light_sampling: Option<LightSampling>,
    /// Largest winding number of rays to lights that are looked for [default: the scene's, else 1]
    #[arg(long, value_name = "N", value_parser = parse::winding, allow_hyphen_values = true)]
    max_winding: Option<u32>,
    /// Heuristic that shares light which is found both ways [default: the scene's, else power]
    #[arg(long, value_enum, value_name = "NAME")]
    mis: Option<Heuristic>,
}

/// Accuracy of the integration of rays.
#[derive(Debug, Default, Args)]
pub(super) struct AccuracyArgs {
    /// Preset of --stepper, --tolerance and --arc-tolerance, over the scene's values [default: none; `standard` is what
    /// holds if the scene sets none]
    #[arg(long, value_enum, value_name = "PRESET")]
    quality: Option<Quality>,
    /// Stepper that advances rays through curved space [default: the scene's, else rkn6]
    #[arg(long, value_enum, value_name = "NAME")]
    stepper: Option<StepperKind>,
    /// Numbers that orbits are followed in [default: the scene's, else f64]
    #[arg(long, value_enum, value_name = "NAME")]
    precision: Option<Precision>,
    /// Largest error of a ray's direction, radians at its start [default: the scene's, else 1e-5]
    #[arg(long, value_name = "T", value_parser = parse::positive, allow_hyphen_values = true)]
    tolerance: Option<f64>,
    /// Largest distance between an arc and the true curve, scene units [default: the scene's, else from the pixel
    /// footprint]
    #[arg(long, value_name = "E", value_parser = parse::positive, allow_hyphen_values = true)]
    arc_tolerance: Option<f64>,
}

/// Puts a flag, if given, over a setting.
pub(super) fn set<T: Copy>(flag: Option<T>, value: &mut T) {
    *value = flag.unwrap_or(*value);
}

impl AccuracyArgs {
    /// True if the tolerance is given.
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
    /// The size of the picture, if it is given: by it a camera frames the scene.
    pub(super) fn size(&self) -> Option<(usize, usize)> {
        self.size
    }

    /// Puts the flags over what the scene file says.
    pub(super) fn apply(&self, settings: &mut Settings) {
        self.accuracy.apply(settings);
        if let Some((width, height)) = self.size {
            (settings.width, settings.height) = (width, height);
        }
        set(self.spp, &mut settings.spp);
        set(self.schedule, &mut settings.schedule);
        set(self.max_depth, &mut settings.max_depth);
        set(self.roulette_depth, &mut settings.roulette_depth);
        set(self.seed, &mut settings.seed);
        set(self.exposure, &mut settings.exposure);
        set(self.filter, &mut settings.filter);
        set(self.background, &mut settings.background);
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

/// Crop and planes to render, and the workers.
#[derive(Debug, Default, Args)]
#[command(next_help_heading = "Run")]
pub(super) struct ShareArgs {
    /// Worker threads; 0 means one per core
    #[arg(long, value_name = "N", value_parser = parse::threads, default_value = "0", allow_hyphen_values = true)]
    threads: usize,
    /// Rays in flight per worker
    #[arg(
        long,
        value_name = "N",
        value_parser = parse::batch,
        default_value_t = Run::default().batch,
        allow_hyphen_values = true
    )]
    batch: usize,
    /// Planes to write beside the colours, separated by commas, or all [default: none]
    #[arg(long = "aov", value_name = "LIST", value_parser = parse::planes(), value_delimiter = ',')]
    aovs: Vec<Planes>,
    /// Render only the pixels from X0,Y0 up to but without X1,Y1 [default: the whole picture]
    #[arg(long, value_name = "X0,Y0,X1,Y1", value_parser = parse::crop, allow_hyphen_values = true)]
    crop: Option<[usize; 4]>,
}

/// Run options of the render.
#[derive(Debug, Default, Args)]
#[command(next_help_heading = "Run")]
pub(super) struct RunArgs {
    #[command(flatten)]
    share: ShareArgs,
    /// Stop after this time, such as 90s, 5m or 1h30m [default: none]
    #[arg(long, value_name = "TIME", value_parser = parse::duration, allow_hyphen_values = true)]
    time_limit: Option<Duration>,
    /// Stop when the mean relative standard error of the picture falls below this [default: none]
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
            batch: self.batch,
            crop: self.crop,
            aovs: distinct(&self.aovs.iter().flat_map(|planes| planes.0.clone()).collect::<Vec<_>>()),
            ..Run::default()
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::Aov;

    #[test]
    fn a_crop_must_lie_within_the_picture() {
        let args = ShareArgs { crop: Some([0, 0, 17, 12]), ..ShareArgs::default() };
        assert!(args.resolve(17, 12).is_ok());
        let message = args.resolve(16, 12).unwrap_err().to_string();
        assert!(message.contains("--crop 0,0,17,12") && message.contains("16x12"), "{message}");
    }

    #[test]
    fn a_plane_asked_for_twice_is_written_once() {
        let planes = |aovs: &[Aov]| Planes(aovs.to_vec());
        let aovs = vec![planes(&[Aov::Depth, Aov::Normal]), planes(&[Aov::Depth])];
        let args = ShareArgs { aovs, ..ShareArgs::default() };
        assert_eq!(args.resolve(1, 1).unwrap().aovs, [Aov::Depth, Aov::Normal]);
    }
}
