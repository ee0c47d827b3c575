//! Damaged files: none panics, hangs, takes much memory or gives pixels that are not finite.
//!
//! ```sh
//! WARPFRONT_FUZZ_SECONDS=600 cargo test --release --test it damaged_files -- --ignored --nocapture
//! WARPFRONT_FUZZ_SEED=1234 cargo test --release --test it damaged_files -- --ignored --nocapture
//! ```
//!
//! The first tries damaged files for that long (default 60), from number WARPFRONT_FUZZ_FROM on; the second makes one
//! of them again, leaves its files in `target/tmp/fuzz` and tells how it ends. Files are tried in a process of its own,
//! of which a crash or a hang takes nothing but that one file with it.

mod corpus;
mod mutate;

use std::collections::BTreeMap;
use std::io::{BufRead, BufReader, Read};
use std::panic::{self, AssertUnwindSafe};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::Mutex;
use std::sync::atomic::AtomicBool;
use std::sync::mpsc::{Receiver, channel};
use std::time::{Duration, Instant};

use crate::support::dice::Dice;
use crate::support::heap::HEAP;
use corpus::{Corpus, Seed};
use warpfront::asset::{Files, Memory};
use warpfront::film::read_exr_with;
use warpfront::scene::{Baked, LoadOptions, load_with};
use warpfront::study::compare::PicturePair;
use warpfront::trace::{self, Run};

/// Bytes that a damaged file may take, which is told to what reads it, and at which the process ends.
const ALLOWED_MEMORY: u64 = 512 << 20;
const MOST_MEMORY: usize = 1 << 30;
/// Time that a damaged file may take.
const MOST_TIME: Duration = Duration::from_secs(30);

/// How a damaged file is looked at.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Use {
    /// As a picture to compare, and as a sky.
    Picture,
    /// As a scene.
    Scene,
    /// As rays to trace.
    Rays,
    /// As pairs to connect.
    Pairs,
}

/// Files, one of them damaged, and what is done with them.
struct Case {
    what: Use,
    main: String,
    files: Vec<Seed>,
}

impl Case {
    fn new(corpus: &Corpus, seed: u64) -> Self {
        let mut dice = Dice::new(seed);
        let dice = &mut dice;
        let sort = dice.below(100);
        let (what, kind) = match sort {
            0..25 => (Use::Picture, &corpus.exr),
            25..36 => (Use::Picture, &corpus.png),
            36..42 => (Use::Picture, &corpus.jpeg),
            42..48 => (Use::Picture, &corpus.hdr),
            48..58 => (Use::Scene, &corpus.gltf),
            58..68 => (Use::Scene, &corpus.glb),
            68..78 => (Use::Scene, &corpus.obj),
            78..84 => (Use::Scene, &corpus.mtl),
            84..97 => (Use::Scene, &corpus.toml),
            97..99 => (Use::Rays, &corpus.rays),
            _ => (Use::Pairs, &corpus.pairs),
        };
        // Of large files there is less to learn in the same time.
        let mut damaged = dice.pick_weighted(kind, |seed| 1.0 / (seed.bytes.len() as f64 + 2000.0)).clone();
        let others: Vec<&[u8]> = kind.iter().map(|seed| &seed.bytes[..]).collect();
        let other = dice.pick(&others);
        let data = &mut damaged.bytes;
        match sort {
            0..25 => mutate::exr(dice, data, other),
            25..36 => mutate::png(dice, data, other),
            36..42 => mutate::bytes(dice, data, other),
            42..48 if dice.chance(0.5) => mutate::bytes(dice, data, other),
            48..58 if dice.chance(0.1) => {
                let mut buffer = corpus::buffer();
                mutate::bytes(dice, &mut buffer, &[]);
                damaged = Seed { name: "mesh.bin".to_owned(), bytes: buffer };
            }
            48..58 => mutate::json(dice, data, &others),
            58..68 => mutate::glb(dice, data, &[&corpus.gltf[0].bytes]),
            _ => mutate::text(dice, data, &others),
        }
        let main = match damaged.name.as_str() {
            "mesh.bin" => "a.gltf".to_owned(),
            name if name.ends_with(".mtl") => name.replace(".mtl", ".obj"),
            name => name.to_owned(),
        };
        let whole = [&corpus.gltf, &corpus.obj, &corpus.mtl, &corpus.png, &corpus.hdr].into_iter().flatten();
        let beside = whole.filter(|seed| seed.name.starts_with("a.") || seed.name == main);
        let mut files = vec![Seed { name: "mesh.bin".to_owned(), bytes: corpus::buffer() }];
        files.extend(beside.cloned());
        if sort >= 84 {
            files.extend(corpus.glb.iter().chain(&corpus.obj).chain(&corpus.mtl).cloned());
        }
        files.push(damaged);
        Self { what, main, files }
    }

    /// Writes the files; scenes find assets where those of this repository have them.
    fn write(&self, folder: &Path) {
        for Seed { name, bytes } in &self.files {
            std::fs::write(folder.join("assets").join(name), bytes).unwrap();
        }
    }

    /// What is wrong, if anything is.
    fn attempt(&self, folder: &Path) -> Result<(), String> {
        let path = folder.join("assets").join(&self.main);
        match self.what {
            Use::Scene => read(&path),
            Use::Picture => {
                if let Ok(image) = read_exr_with(&path, &files())
                    && let Ok(pair) = PicturePair::new(("a", &image), ("b", &image))
                {
                    pair.compare();
                }
                let scene = folder.join("assets/sky.toml");
                let text = format!(
                    "environment = {{ image = \"{}\" }}\ncamera = {{ position = [0, 0, 5], look_at = [0, 0, 0], \
                     vertical_fov = 120 }}\n[[entity]]\nsphere = {{ center = [0, 0, 0], radius = 1 }}\n",
                    self.main
                );
                std::fs::write(&scene, text).unwrap();
                read(&scene)
            }
            Use::Rays => command(&path, &["trace", "--spacetime", "schwarzschild"]),
            Use::Pairs => command(&path, &["connect"]),
        }
    }
}

fn files() -> Files {
    Files::within(Memory::at_most(Some(ALLOWED_MEMORY)))
}

/// Loads a scene; renders a few pixels if it is one.
fn read(path: &Path) -> Result<(), String> {
    match load_with(path, &LoadOptions { files: files(), ..LoadOptions::default() }) {
        Ok(scene) => look(scene),
        Err(_) => Ok(()),
    }
}

/// Renders a few pixels.
fn look(mut scene: Baked) -> Result<(), String> {
    let settings = &mut scene.settings;
    (settings.width, settings.height, settings.spp) = (4, 3, 1);
    settings.max_depth = settings.max_depth.min(8);
    if let Some(warning) = scene.warnings.iter().find(|warning| warning.contains(char::is_control)) {
        return Err(format!("a warning is not one printable line: {warning:?}"));
    }
    let rendered =
        trace::render(&scene, &Run { threads: 1, ..Run::default() }, &AtomicBool::new(false), &|_| ());
    for plane in &rendered.image.channels {
        if let Some(value) = plane.values.iter().find(|value| !value.is_finite()) {
            return Err(format!("channel {} holds {value}", plane.name));
        }
    }
    Ok(())
}

/// Runs the command on a table.
fn command(path: &Path, arguments: &[&str]) -> Result<(), String> {
    let mut command = Command::new(env!("CARGO_BIN_EXE_warpfront"));
    let output = command.args(arguments).arg(path).args(["--threads", "1"]).output().unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    let good = matches!(output.status.code(), Some(0 | 2)) && !said.contains("panicked");
    if good { Ok(()) } else { Err(format!("{}: {said}", output.status)) }
}

/// Where the last panic was, and what it said.
static PANIC: Mutex<String> = Mutex::new(String::new());

/// Tries one case; what is wrong, if anything is.
fn attempt(corpus: &Corpus, seed: u64, folder: &Path) -> Result<(), String> {
    std::fs::create_dir_all(folder.join("assets")).unwrap();
    let case = Case::new(corpus, seed);
    case.write(folder);
    panic::catch_unwind(AssertUnwindSafe(|| case.attempt(folder)))
        .unwrap_or_else(|_| Err(PANIC.lock().unwrap().clone()))
        .map_err(|problem| format!("{}: {problem}", case.main))
}

fn remember_panics() {
    panic::set_hook(Box::new(|info| {
        let place = info.location().map(ToString::to_string).unwrap_or_default();
        let said = info.payload().downcast_ref::<String>().cloned();
        let said = said.or_else(|| info.payload().downcast_ref::<&str>().map(|&said| said.to_owned()));
        *PANIC.lock().unwrap() = format!("panic at {place}: {}", said.unwrap_or_default());
    }));
}

/// The number in an environment variable.
fn variable(name: &str) -> Option<u64> {
    std::env::var(name).ok().map(|text| text.parse().unwrap_or_else(|_| panic!("{name}={text}")))
}

/// Under this variable the test is a worker that tries one file after the other from there on.
const WORKER: &str = "WARPFRONT_FUZZ_WORKER";

/// Tries files without end, and says which, and what is wrong.
fn work(from: u64) {
    let folder = tempfile::tempdir().unwrap();
    let corpus = Corpus::new();
    remember_panics();
    HEAP.set_limit(MOST_MEMORY).unwrap();
    for seed in from.. {
        println!("\nbegin {seed}");
        if let Err(problem) = attempt(&corpus, seed, folder.path()) {
            println!("\nfault {}", problem.replace('\n', " "));
        }
    }
}

/// A worker, and what it says.
struct Worker {
    child: Child,
    lines: Receiver<String>,
}

impl Worker {
    fn start(from: u64) -> Self {
        let mut command = Command::new(std::env::current_exe().unwrap());
        command.args(["--ignored", "--nocapture", "--exact", TEST]).env(WORKER, from.to_string());
        let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        let (sender, lines) = channel();
        let out = BufReader::new(child.stdout.take().unwrap());
        std::thread::spawn(move || {
            out.lines().map_while(Result::ok).try_for_each(|line| sender.send(line)).ok();
        });
        Self { child, lines }
    }

    /// Ends the process; what it said last, if it ended by itself.
    fn end(mut self) -> String {
        let _ = self.child.kill();
        let mut said = String::new();
        let _ = self.child.stderr.take().unwrap().read_to_string(&mut said);
        let status = self.child.wait().unwrap();
        format!("{status}: {}", said.lines().next().unwrap_or_default())
    }
}

const TEST: &str = "files::fuzz::damaged_files_neither_panic_nor_hang_nor_take_much_memory";

#[test]
#[ignore = "tries damaged files for a minute, or for WARPFRONT_FUZZ_SECONDS"]
fn damaged_files_neither_panic_nor_hang_nor_take_much_memory() {
    if let Some(from) = variable(WORKER) {
        return work(from);
    }
    if let Some(seed) = variable("WARPFRONT_FUZZ_SEED") {
        let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("fuzz");
        println!("the files are in {}", folder.display());
        HEAP.set_limit(MOST_MEMORY).unwrap();
        return attempt(&Corpus::new(), seed, &folder).unwrap_or_else(|problem| panic!("{problem}"));
    }
    let end = Instant::now() + Duration::from_secs(variable("WARPFRONT_FUZZ_SECONDS").unwrap_or(60));
    let from = variable("WARPFRONT_FUZZ_FROM").unwrap_or(0);
    let mut seed = from;
    // By what is wrong, without the numbers in it: how often, the first file, and all that was said of it.
    let mut faults: BTreeMap<String, (usize, u64, String)> = BTreeMap::new();
    let mut found = |seed: u64, problem: String| {
        let kind = problem.split(": ").skip(1).collect::<String>().replace(|c: char| c.is_ascii_digit(), "");
        let fault = faults.entry(kind).or_insert((0, seed, problem));
        if fault.0 == 0 {
            println!("WARPFRONT_FUZZ_SEED={seed}: {}", fault.2);
        }
        fault.0 += 1;
    };
    while Instant::now() < end {
        let worker = Worker::start(seed);
        let problem = loop {
            match worker.lines.recv_timeout(MOST_TIME) {
                Ok(line) => match line.split_once(' ') {
                    Some(("begin", number)) => seed = number.parse().unwrap(),
                    Some(("fault", problem)) => found(seed, problem.to_owned()),
                    _ => {}
                },
                Err(error) => break Some(error),
            }
            if Instant::now() >= end {
                break None;
            }
        };
        let last = worker.end();
        if let Some(why) = problem {
            found(seed, format!("process: {why}, {last}"));
        }
        seed += 1;
    }
    println!("{} files, {} kinds of faults", seed - from, faults.len());
    assert!(seed > from, "nothing was tried");
    assert!(faults.is_empty(), "{faults:#?}");
}
