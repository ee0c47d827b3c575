//! Files of a study that share the beginning of their names.

use std::io::{self, Write};
use std::path::{Path, PathBuf};

use super::failure::Failure;
use crate::film::atomic::Output;
use crate::plot::{Figure, Format};

/// The files that are written.
pub(super) struct Files {
    csv: Output,
    svg: Output,
    png: Output,
}

const EXTENSIONS: [&str; 3] = ["csv", "svg", "png"];

impl Files {
    /// Opens them all, so that one that cannot be written is found before the study.
    pub(super) fn open(prefix: &Path) -> Result<Self, Failure> {
        let open = |extension| Output::create(&with_suffix(prefix, extension)).map_err(Failure::from);
        let [csv, svg, png] = EXTENSIONS.map(open);
        Ok(Self { csv: csv?, svg: svg?, png: png? })
    }

    /// Where they go.
    pub(super) fn paths(&self) -> impl Iterator<Item = &Path> {
        [&self.csv, &self.svg, &self.png].into_iter().map(Output::path)
    }

    /// Writes them all.
    pub(super) fn write(
        self,
        csv: impl FnOnce(&mut dyn Write) -> io::Result<()>,
        figure: &Figure,
    ) -> Result<(), Failure> {
        self.csv.commit(|out| csv(out))?;
        self.svg.commit(|out| figure.write(Format::Svg, out))?;
        self.png.commit(|out| figure.write(Format::Png, out))?;
        Ok(())
    }
}

/// The names of the files.
pub(super) fn names(prefix: &Path) -> String {
    EXTENSIONS.map(|extension| with_suffix(prefix, extension).display().to_string()).join(", ")
}

/// `prefix.extension`, whatever dots the prefix has.
pub(super) fn with_suffix(prefix: &Path, extension: &str) -> PathBuf {
    let mut name = prefix.as_os_str().to_owned();
    name.push(".");
    name.push(extension);
    name.into()
}
