//! How renders end: by limits, signals and kills; what they leave then, and what they say in the meantime.

use std::fs;
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};

use crate::support::command::{Folder, assert_code, assert_good, assert_refused, stderr};
use crate::support::{camera, film, hole, material, scene, sphere};
use glam::DVec3;
use warpfront::film::{Image, read_exr};
use warpfront::trace::Run;

/// A bright lamp, small in the picture, over a grey ball.
fn lamp() -> String {
    camera(DVec3::new(0.0, 1.0, 6.0), DVec3::ZERO, 40.0)
        + &film(40, 30)
        + &material("lamp", 0.0, 50.0)
        + &material("ball", 0.6, 0.0)
        + &sphere(DVec3::new(0.7, 1.3, 0.0), 0.2, "lamp")
        + &sphere(DVec3::ZERO, 1.0, "ball")
}

/// Paths in a closed room of perfect mirrors: none ends before 65535 segments.
fn mirrors() -> String {
    "[render]\nmax_depth = 65535\n[[material]]\nname = \"mirror\"\nkind = \"mirror\"\nalbedo = 1\n".to_owned()
        + &camera(DVec3::new(0.2, 0.1, 0.0), DVec3::X, 60.0)
        + &film(128, 128)
        + &sphere(DVec3::ZERO, 3.0, "mirror")
}

/// Sky at the top and the bottom, and between them a corridor of mirrors in which paths are long.
fn corridor() -> String {
    let disk = |y: f64| {
        let center = crate::support::vector(DVec3::new(0.0, y, -1e6));
        format!(
            "[[entity]]\ndisk = {{ center = {center}, normal = [0, 1, 0], outer = 1e6 }}\nmaterial = \"mirror\"\n"
        )
    };
    "[render]\nmax_depth = 65535\n[environment]\ncolor = 1\n".to_owned()
        + "[[material]]\nname = \"mirror\"\nkind = \"mirror\"\nalbedo = 1\n"
        + "[camera]\nposition = [0, 0, 5.5]\ndirection = [0, 0, -1]\nvertical_fov = 60\n"
        + "[film]\nwidth = 32\nheight = 96\nfilter = \"box\"\n"
        + &disk(-1.0)
        + &disk(1.0)
}

/// A round, glowing room with a mirror and a hole.
fn room_with_a_hole() -> String {
    hole(DVec3::ZERO, 1.0)
        + &camera(DVec3::new(0.0, 0.0, 12.0), DVec3::ZERO, 40.0)
        + &film(64, 48)
        + &material("lamp", 0.5, 1.0)
        + "[[material]]\nname = \"mirror\"\nkind = \"mirror\"\n"
        + &sphere(DVec3::new(3.0, 0.0, 0.0), 1.0, "mirror")
        + &sphere(DVec3::ZERO, 20.0, "lamp")
}

fn folder(text: &str) -> Folder {
    Folder::with(&[("scene.toml", text)])
}

/// Arguments of a render in one thread, without a preview.
fn arguments<'a>(flags: &[&'a str]) -> Vec<&'a str> {
    [&["render", "scene.toml", "-o", "out.exr", "--no-png", "--threads", "1"], flags].concat()
}

fn render(place: &Folder, flags: &[&str]) -> Output {
    place.run(&arguments(flags))
}

/// Samples per pixel that the picture tells.
fn spp(place: &Folder) -> u32 {
    let image = read_exr(&place.path("out.exr")).unwrap();
    let told = image.attributes.iter().find(|(name, _)| name == "spp");
    told.map(|(_, value)| value.parse().unwrap()).unwrap_or_else(|| panic!("no spp"))
}

#[test]
fn a_time_limit_ends_any_number_of_samples() {
    let place = folder(&lamp());
    for samples in ["16777216", "1000000000", "2147483648"] {
        let started = Instant::now();
        assert_good(&render(&place, &["--spp", samples, "--time-limit", "200ms", "--strict"]));
        assert!(started.elapsed() < Duration::from_secs(10), "{:?}", started.elapsed());
        assert!((1..10_000_000).contains(&spp(&place)), "{}", spp(&place));
    }
}

#[test]
fn more_samples_than_there_are_random_numbers_for_are_refused() {
    let place = folder(&lamp());
    for flags in [["--spp", "2147483649"], ["--set", "render.spp=2147483649"], ["--set", "render.spp=1e400"]]
    {
        assert_refused(&render(&place, &flags), &["spp"]);
    }
    assert!(place.files_but("scene.toml").is_empty());
}

#[test]
fn every_pixel_gets_its_first_sample_even_where_the_limit_is_over_before() {
    let place = folder(&lamp());
    assert_good(&render(&place, &["--time-limit", "1ms", "--strict"]));
    assert!(spp(&place) >= 1);
}

#[test]
fn a_picture_without_any_sample_replaces_nothing_and_is_no_success() {
    for schedule in ["wavefront", "per-pixel"] {
        let place = folder(&mirrors());
        fs::write(place.path("out.exr"), "yesterday").unwrap();
        let output = render(&place, &["--time-limit", "50ms", "--schedule", schedule]);
        assert_code(&output, 1);
        assert!(stderr(&output).contains("error: the time limit was over before any pixel had a sample"));
        assert_eq!(place.read("out.exr"), "yesterday");
        assert_eq!(place.files_but("scene.toml"), ["out.exr"]);
    }
}

#[test]
fn a_picture_in_which_some_pixels_have_no_sample_is_written_and_is_no_success() {
    let place = folder(&corridor());
    let output = render(&place, &["--time-limit", "50ms"]);
    assert_code(&output, 1);
    let text = stderr(&output);
    assert!(text.contains("warning: the time limit was over: 2048 of 3072 pixels have no sample"), "{text}");
    let image = read_exr(&place.path("out.exr")).unwrap();
    let red = image.channel("R").unwrap();
    assert!(red[..1024].iter().all(|&value| value == 1.0) && red[1024..].iter().all(|&value| value == 0.0));
}

#[test]
fn what_costs_too_much_for_a_sample_ends_in_time_all_the_same() {
    let place = folder(&room_with_a_hole());
    let costly: [&[&str]; 3] = [
        &["--arc-tolerance", "1e-40"],
        &["--arc-tolerance", "1e-40", "--schedule", "per-pixel"],
        &["--tolerance", "1e-300"],
    ];
    for flags in costly {
        let started = Instant::now();
        let output = render(&place, &[flags, &["--time-limit", "50ms"]].concat());
        assert!(started.elapsed() < Duration::from_secs(10), "{flags:?}: {:?}", started.elapsed());
        let is_whole = output.status.code() == Some(0);
        let said = output.status.code() == Some(1) && stderr(&output).contains("sample");
        assert!(is_whole || said, "{flags:?}: {}", stderr(&output));
    }
}

#[test]
fn a_probe_of_rays_that_hardly_end_ends() {
    let mut scene = scene(&room_with_a_hole());
    scene.settings.arc_tolerance = Some(1e-40);
    let started = Instant::now();
    let probe = warpfront::trace::probe(&scene, &Run::default(), Duration::ZERO);
    assert!(started.elapsed() < Duration::from_secs(15), "{:?}", started.elapsed());
    assert!(probe.readings.is_empty());
}

#[test]
fn a_hole_of_the_command_line_is_bounded_as_one_of_a_file() {
    let place = folder(&lamp());
    for hole in ["1e308,1e308,1e308,1", "0,2e18,0,1", "0,0,0,1e19"] {
        assert_refused(&render(&place, &["--black-hole", hole]), &["black hole", "1e18"]);
    }
}

/// The planes of a picture of `lamp` that is to have so many samples and stops at the first look at its noise.
fn stopped(spp: u32, noise: Option<f64>) -> (u32, Image) {
    let mut scene = scene(&lamp());
    scene.settings.spp = spp;
    let rendered = crate::support::render(&scene, &Run { noise, ..Run::default() });
    (rendered.spp, rendered.image)
}

#[test]
fn samples_are_the_same_however_many_are_asked_for() {
    let (_, whole) = stopped(16, None);
    for asked in [64, 256, 1 << 31] {
        let (spp, part) = stopped(asked, Some(1e9));
        assert_eq!(spp, 16);
        assert_eq!(part.channel("R"), whole.channel("R"), "16 of {asked}");
    }
}

/// Starts a command that would take hours, and waits until it has worked for a while.
#[cfg(unix)]
fn started(place: &Folder, flags: &[&str]) -> std::process::Child {
    let mut command = place.command(&arguments(&[&["--spp", "1000000"], flags].concat()));
    let child = command.stderr(Stdio::piped()).spawn().unwrap();
    std::thread::sleep(Duration::from_millis(1500));
    child
}

#[cfg(unix)]
fn signal(child: &std::process::Child, name: &str) {
    let id = child.id().to_string();
    assert!(Command::new("kill").args([name, &id]).status().unwrap().success());
}

/// Whether this process, and so what it starts, ignores a signal; false where the system does not tell.
#[cfg(unix)]
fn is_ignored(signal: u32) -> bool {
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    let mask = mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok());
    mask.is_some_and(|mask| mask >> (signal - 1) & 1 == 1)
}

#[cfg(unix)]
#[test]
fn an_interrupted_render_keeps_its_picture_and_ends_by_the_signal() {
    use std::os::unix::process::ExitStatusExt;

    for (name, number) in [("-INT", 2), ("-TERM", 15), ("-HUP", 1)] {
        // Under `nohup`, which tests may run under as well, a lost terminal is no reason to end.
        if name == "-HUP" && is_ignored(1) {
            continue;
        }
        let place = folder(&lamp());
        let child = started(&place, &["--strict"]);
        signal(&child, name);
        let output = child.wait_with_output().unwrap();
        assert_eq!(output.status.signal(), Some(number), "{}", stderr(&output));
        assert!(stderr(&output).contains("of 1000000 samples"), "{}", stderr(&output));
        assert_eq!(place.files_but("scene.toml"), ["out.exr"]);
        assert!(spp(&place) >= 1);
    }
}

#[cfg(unix)]
#[test]
fn an_interruption_before_there_is_a_picture_ends_the_process_at_once_and_keeps_the_old_one() {
    use std::os::unix::process::ExitStatusExt;

    let place = folder(&mirrors());
    fs::write(place.path("out.exr"), "yesterday").unwrap();
    let child = started(&place, &[]);
    signal(&child, "-TERM");
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.signal(), Some(15), "{}", stderr(&output));
    assert_eq!(place.read("out.exr"), "yesterday");
    assert_eq!(place.files_but("scene.toml"), ["out.exr"]);
}

#[cfg(unix)]
#[test]
fn a_killed_render_leaves_nothing() {
    let place = folder(&lamp());
    let mut child = started(&place, &[]);
    child.kill().unwrap();
    child.wait().unwrap();
    assert!(place.files_but("scene.toml").is_empty(), "{:?}", place.files_but("scene.toml"));
}

#[cfg(target_os = "linux")]
#[test]
fn a_render_under_nohup_outlives_its_terminal() {
    let place = folder(&lamp());
    let mut command = Command::new("nohup");
    command.arg(env!("CARGO_BIN_EXE_warpfront")).args(arguments(&["--spp", "1000000"]));
    command.args(["--time-limit", "2500ms"]);
    command.current_dir(place.folder()).stdin(Stdio::null()).stderr(Stdio::piped());
    let child = command.stdout(Stdio::null()).spawn().unwrap();
    std::thread::sleep(Duration::from_millis(1500));
    signal(&child, "-HUP");
    assert_good(&child.wait_with_output().unwrap());
}

#[test]
fn progress_is_told_in_plain_lines_where_there_is_no_terminal() {
    let run = |flags: &[&str]| {
        let place = folder(&lamp());
        let flags = [&["--spp", "1000000", "--time-limit", "4500ms"], flags].concat();
        let child = place.command(&arguments(&flags)).stderr(Stdio::piped()).spawn().unwrap();
        (place, child)
    };
    // Side by side: they take their time.
    let (_told, told) = run(&[]);
    let (_silent, silent) = run(&["--progress", "none"]);
    let lines = |child: std::process::Child| {
        let text = stderr(&child.wait_with_output().unwrap());
        assert!(!text.contains(['\r', '\u{1b}']), "{text:?}");
        text.lines().filter(|line| line.contains("of 1000000 samples per pixel")).count()
    };
    assert_eq!(lines(told), 2);
    assert_eq!(lines(silent), 0);
}

#[test]
fn a_quick_render_tells_no_progress() {
    let output = render(&folder(&lamp()), &["--spp", "1", "--progress", "plain"]);
    assert_good(&output);
    assert_eq!(stderr(&output).lines().count(), 1, "{}", stderr(&output));
}
