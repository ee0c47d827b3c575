//! Files of a study that share the beginning of their names.

use std::path::{Path, PathBuf};

use super::failure::Failure;
use crate::film::atomic::Output;
use crate::plot::Format;
use crate::study::report::Report;

/// The files that are written.
pub(super) struct StudyFiles {
    csv: Output,
    svg: Output,
    png: Output,
}

impl StudyFiles {
    /// Opens them all, so that one that cannot be written is found before the study.
    pub(super) fn open(prefix: &Path) -> Result<Self, Failure> {
        let open = |extension| Output::create(&with_suffix(prefix, extension)).map_err(Failure::from);
        let [csv, svg, png] = ["csv", "svg", "png"].map(open);
        Ok(Self { csv: csv?, svg: svg?, png: png? })
    }

    /// Paths of the files.
    pub(super) fn paths(&self) -> impl Iterator<Item = &Path> {
        [&self.csv, &self.svg, &self.png].into_iter().map(Output::path)
    }

    /// Their paths, as the user named them.
    pub(super) fn names(&self) -> String {
        let names: Vec<String> = self.paths().map(|path| path.display().to_string()).collect();
        names.join(", ")
    }

    /// Writes them all.
    pub(super) fn write(self, report: &Report) -> Result<(), Failure> {
        self.csv.commit(|out| report.table.write_csv(out))?;
        self.svg.commit(|out| report.figure.write(Format::Svg, out))?;
        self.png.commit(|out| report.figure.write(Format::Png, out))?;
        Ok(())
    }
}

/// `prefix.extension`, whatever dots the prefix has.
pub(super) fn with_suffix(prefix: &Path, extension: &str) -> PathBuf {
    let mut name = prefix.as_os_str().to_owned();
    name.push(".");
    name.push(extension);
    name.into()
}
