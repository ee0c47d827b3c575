//! The files of one render, opened before it and written after it.

use std::fs;
use std::io::Write;
use std::path::Path;

use serde::Serialize;

use super::failure::Failure;
use super::shared_args::OutputArgs;
use crate::film::atomic::Output;
use crate::film::{write_exr, write_png};
use crate::scene::{Background, Settings};
use crate::trace::{Rendered, Stats};

/// The files to be written.
pub(super) struct Outputs {
    exr: Output,
    png: Option<Output>,
    stats: Option<Output>,
}

/// True if both paths lead to the same file, which exists.
pub(super) fn same_file(a: &Path, b: &Path) -> bool {
    let there = |path| fs::canonicalize(path).ok();
    there(a).is_some_and(|a| Some(a) == there(b))
}

/// Record that `--stats` writes.
#[derive(Serialize)]
struct StatsRecord<'a> {
    version: &'static str,
    scene: String,
    spp: u32,
    settings: &'a Settings,
    stats: &'a Stats,
}

impl Outputs {
    /// Opens them all, so that one that cannot be written is found before the render and not after.
    pub(super) fn open(args: &OutputArgs, scene: &Path) -> Result<Self, Failure> {
        let picture = args.picture(scene);
        let beside = (!args.no_png).then(|| picture.with_extension("png"));
        let png = args.png.clone().or(beside);
        let open = |path: &Path| Output::create(path).map_err(Failure::from);
        Ok(Self {
            exr: open(&picture)?,
            png: png.as_deref().map(open).transpose()?,
            stats: args.stats.as_deref().map(open).transpose()?,
        })
    }

    /// Paths of the files.
    pub(super) fn paths(&self) -> impl Iterator<Item = &Path> {
        [Some(&self.exr), self.png.as_ref(), self.stats.as_ref()].into_iter().flatten().map(Output::path)
    }

    /// Their paths, as the user named them.
    pub(super) fn names(&self) -> String {
        let names: Vec<String> = self.paths().map(|path| path.display().to_string()).collect();
        names.join(", ")
    }

    /// Writes them all, the picture first.
    pub(super) fn write(self, rendered: &Rendered, settings: &Settings, scene: &Path) -> Result<(), Failure> {
        self.exr.commit(|out| write_exr(&rendered.image, out))?;
        if let Some(png) = self.png {
            let transparent = settings.background == Background::Transparent;
            png.commit(|out| write_png(&rendered.image, settings.exposure, transparent, out))?;
        }
        if let Some(stats) = self.stats {
            let record = StatsRecord {
                version: env!("CARGO_PKG_VERSION"),
                scene: scene.display().to_string(),
                spp: rendered.spp,
                settings,
                stats: &rendered.stats,
            };
            stats.commit(|out| {
                serde_json::to_writer_pretty(&mut *out, &record)?;
                out.write_all(b"\n")
            })?;
        }
        Ok(())
    }
}
