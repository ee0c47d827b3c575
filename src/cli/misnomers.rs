//! Flags as other programs name them, and what does their job here.

use std::ffi::OsString;

use clap::error::{ContextKind, ContextValue, ErrorKind};
use clap::{Command, Error};

use super::parse;

/// Names that Blender, Cycles, Mitsuba, pbrt and others have for something.
struct Misnomer {
    /// Flags, separated by spaces.
    names: &'static str,
    /// The flag that does it here, if one does.
    flag: Option<&'static str>,
    /// Advice on what to do instead.
    advice: &'static str,
}

const fn does(flag: &'static str, advice: &'static str, names: &'static str) -> Misnomer {
    Misnomer { names, flag: Some(flag), advice }
}

const fn nothing(advice: &'static str, names: &'static str) -> Misnomer {
    Misnomer { names, flag: None, advice }
}

/// The first that fits a subcommand counts.
const MISNOMERS: &[Misnomer] = &[
    does(
        "spp",
        "samples per pixel are set with '--spp N'",
        "-s -n --samples --sample --num-samples --n-samples --sample-count --samplecount --samples-per-pixel \
         --pixel-samples --pixelsamples --max-samples --aa-samples --nspp",
    ),
    does(
        "set",
        "the field of view is a key of the scene file: '--set camera.vertical_fov=50', in degrees",
        "--fov --vertical-fov --vfov --fovy --hfov --horizontal-fov --field-of-view --angle --focal-length --focal \
         --lens --zoom",
    ),
    does(
        "set",
        "the camera is a table of the scene file: '--set camera.position=[0,1,8]', 'camera.look_at=[0,1,0]'",
        "--position --pos --look-at --lookat --target --eye --origin --up --camera-position",
    ),
    does(
        "size",
        "the size of the picture is set with '--size WIDTHxHEIGHT'",
        "-x -y -r --width --height --resolution --res --resolution-x --resolution-y --res-x --res-y --resx --resy \
         --dimensions --image-size --film-size --scale --resolution-percentage",
    ),
    does(
        "output",
        "the picture's file is named with '--output FILE', or '-o FILE'",
        "--out --outfile --out-file --output-file --output-path --output-name --output-image --filename --file-name \
         --render-output --save --write --image --exr",
    ),
    does(
        "aov",
        "there is no denoiser; '--aov albedo,normal,variance' writes what one needs",
        "--denoise --denoiser --denoising --oidn --optix-denoiser --filter-noise",
    ),
    nothing(
        "rays are traced on the CPU's cores only; leave it out ('--threads N' says on how many)",
        "--gpu --gpus --cuda --optix --hip --metal --oneapi --vulkan --device --devices --cycles-device --backend \
         --cpu",
    ),
    does(
        "max-depth",
        "the longest path is set with '--max-depth N', in ray segments: bounces and one more",
        "-b --bounces --bounce --max-bounces --maxbounces --num-bounces --depth --maxdepth --ray-depth --path-depth \
         --max-path-length --path-length --recursion --max-recursion --diffuse-bounces --glossy-bounces \
         --transmission-bounces",
    ),
    does(
        "roulette-depth",
        "Russian roulette starts after '--roulette-depth N' ray segments",
        "--rr --rr-depth --rrdepth --roulette --russian-roulette --russian-roulette-depth --min-depth --min-bounces",
    ),
    does(
        "black-hole",
        "a hole is placed with '--black-hole X,Y,Z,RS', RS its Schwarzschild radius, twice its mass",
        "--hole --blackhole --bh --mass --rs --radius --schwarzschild --schwarzschild-radius --singularity",
    ),
    nothing(
        "holes are Schwarzschild's, without spin and charge",
        "--spin --kerr --charge --spin-parameter --angular-momentum --wormhole",
    ),
    does(
        "threads",
        "the number of threads is set with '--threads N'",
        "-t -j --nthreads --num-threads --n-threads --thread --jobs --cores --workers --cpus --num-workers",
    ),
    does(
        "batch",
        "the number of rays in flight is set with '--batch N'; it changes speed only",
        "--batch-size --batchsize --wavefront-size --tile-size --tilesize --block-size --bucket-size",
    ),
    does(
        "time-limit",
        "a limit of time is set with '--time-limit TIME', such as 90s, 5m or 1h30m",
        "--timeout --timelimit --max-time --render-time --seconds --minutes --duration --limit --budget",
    ),
    does(
        "noise",
        "a limit of noise is set with '--noise X', the mean relative standard error of the pixels",
        "--noise-threshold --noise-limit --adaptive --adaptive-sampling --adaptive-threshold --error --max-error \
         --error-threshold --threshold --convergence",
    ),
    does(
        "stats",
        "progress and a summary are printed anyway; '--stats FILE.json' writes counts and times",
        "-v --verbose --verbosity --debug --log --log-level --statistics --profile --timing",
    ),
    does(
        "progress",
        "'--progress none' leaves the progress out",
        "-q --quiet --silent --no-progress --no-bar",
    ),
    does(
        "aov",
        "planes beside the colours are asked for with '--aov LIST', or '--aov all'",
        "--aovs --pass --passes --layer --layers --planes --plane --channels --buffers --gbuffer --cryptomatte \
         --render-passes --outputs --depth-pass --normals --normal",
    ),
    does(
        "crop",
        "a part of the picture is rendered with '--crop X0,Y0,X1,Y1', in pixels",
        "--cropwindow --crop-window --region --border --render-border --window --viewport --roi --rect --tile \
         --tiles --pixel",
    ),
    does(
        "quality",
        "presets are chosen with '--quality draft|standard|reference'",
        "--preset --quick --draft --fast --final --preview --accuracy",
    ),
    does(
        "exposure",
        "the PNG is made brighter with '--exposure STOPS'; the EXR holds radiance",
        "--ev --stops --gamma --brightness --gain --tonemap --tone-mapping --tonemapping --view-transform --film",
    ),
    does(
        "background",
        "the sky is left out of the picture with '--background transparent'",
        "--transparent --film-transparent --transparent-background --transparency --alpha --rgba --no-sky \
         --no-background --hide-background --hide-environment",
    ),
    does(
        "environment",
        "the surroundings are set with '--environment FILE|COLOR'",
        "--env --envmap --env-map --environment-map --sky --hdri --hdr --ibl --world --background-image --skybox",
    ),
    does(
        "light-sampling",
        "light sampling is chosen with '--light-sampling off|straight|geodesic'",
        "--nee --next-event-estimation --direct --direct-light --light-sampler --lightsampler --integrator",
    ),
    does(
        "max-winding",
        "rays that wind around the hole are looked for up to '--max-winding N'",
        "--winding --windings --orders --order --images --loops",
    ),
    does(
        "set",
        "values of the scene file are set with '--set KEY=VALUE'",
        "-d -p --define --override --param --parameter --option --property",
    ),
    does(
        "stepper",
        "how rays are advanced is chosen with '--stepper NAME', how exactly with '--tolerance T'",
        "--method --solver --ode --rk4 --step --step-size --stepsize --dt --steps --max-steps",
    ),
    does(
        "time",
        "a scene is one picture; the moment of its animations is set with '--time SECONDS'",
        "-f -a -e --frame --frames --frame-start --frame-end --anim --animation --render-frame --render-anim --fps",
    ),
    nothing(
        "the scene is named without a flag: 'warpfront render SCENE'",
        "-i --input --in --scene --scene-file --file --load",
    ),
    nothing("files are replaced without being asked; leave it out", "--overwrite --force --yes --replace"),
    nothing("there is no window; leave it out", "--headless --nogui --no-gui --no-window --batch-mode --gui"),
    does(
        "png",
        "the picture is an OpenEXR file, with a PNG beside it or where '--png FILE.png' says",
        "--format --file-format --render-format --output-format --jpg --jpeg --tiff --hdr-output",
    ),
];

/// Puts advice into an error about a flag or a subcommand that there is not; `arguments` are all that were given, the
/// program's name first.
pub(super) fn advise(error: &mut Error, mut program: Command, arguments: &[OsString]) {
    program.build();
    let chosen = arguments.iter().skip(1).find_map(|name| program.find_subcommand(name));
    let mut command = chosen.unwrap_or(&program).clone();
    let advice = match error.kind() {
        ErrorKind::UnknownArgument => unknown(error, ContextKind::InvalidArg)
            .and_then(|flag| advice(&flag, &command))
            .map(str::to_owned),
        ErrorKind::InvalidSubcommand => unknown(error, ContextKind::InvalidSubcommand)
            .filter(|word| parse::names_a_scene(word))
            .map(|scene| format!("a scene is rendered with 'warpfront render {scene}'")),
        _ => None,
    };
    if let Some(advice) = advice {
        // Clap suggests flags that are spelled alike.
        error.remove(ContextKind::SuggestedArg);
        error.remove(ContextKind::SuggestedSubcommand);
        error.insert(ContextKind::Suggested, ContextValue::StyledStrs(vec![advice.into()]));
        error.insert(ContextKind::Usage, ContextValue::StyledStr(command.render_usage()));
    }
}

/// Unknown name that an error reports.
fn unknown(error: &Error, kind: ContextKind) -> Option<String> {
    match error.get(kind) {
        Some(ContextValue::String(name)) => Some(name.clone()),
        _ => None,
    }
}

/// Advice on what does the job of `flag` in `command`.
fn advice(flag: &str, command: &Command) -> Option<&'static str> {
    let flag = flag.to_lowercase().replace('_', "-");
    let has = |name: &str| command.get_arguments().any(|known| known.get_long() == Some(name));
    MISNOMERS
        .iter()
        .filter(|misnomer| misnomer.flag.is_none_or(has))
        .find(|misnomer| misnomer.names.split(' ').any(|name| name == flag))
        .map(|misnomer| misnomer.advice)
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use clap::CommandFactory;

    use super::super::args::Cli;
    use super::*;

    #[test]
    fn no_misnomer_is_a_flag_of_render_and_none_stands_twice() {
        let command = Cli::command();
        let render = command.find_subcommand("render").unwrap();
        let mut seen = BTreeSet::new();
        for name in MISNOMERS.iter().flat_map(|misnomer| misnomer.names.split(' ')) {
            assert!(name.starts_with('-') && seen.insert(name), "{name} stands twice");
            let is_flag = render.get_arguments().any(|flag| {
                let long = flag.get_long().map(|long| format!("--{long}"));
                let short = flag.get_short().map(|short| format!("-{short}"));
                [long, short].iter().flatten().any(|known| known == name)
            });
            assert!(!is_flag, "{name} is a flag");
        }
    }

    #[test]
    fn advice_names_only_flags_that_the_subcommand_has() {
        let command = Cli::command();
        let of = |name: &str, flag: &str| advice(flag, command.find_subcommand(name).unwrap());
        assert!(of("render", "--samples").unwrap().contains("--spp"));
        assert!(of("render", "--Num_Samples").unwrap().contains("--spp"));
        assert!(of("compare", "--samples").is_none());
        assert!(of("render", "--fov").unwrap().contains("camera.vertical_fov"));
    }
}
