//! Access to the files of a scene: regular files only, and a record of which were read.

use std::collections::BTreeSet;
use std::fs::File;
use std::io::{self, Read};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

/// Reads the files of a scene, and remembers which they were.
#[derive(Debug, Default)]
pub struct Files {
    opened: Mutex<BTreeSet<PathBuf>>,
}

impl Files {
    /// Opens a regular file.
    ///
    /// # Errors
    /// What the operating system says; anything that is not a regular file is refused, since devices and pipes may
    /// never end.
    pub fn open(&self, path: &Path) -> io::Result<File> {
        // Asked before it is opened: opening a pipe waits for somebody who writes to it.
        let metadata = std::fs::metadata(path)?;
        if metadata.is_dir() {
            return Err(io::Error::other("it is a folder"));
        }
        if !metadata.is_file() {
            return Err(io::Error::other("it is not a regular file"));
        }
        let file = File::open(path)?;
        self.opened.lock().unwrap_or_else(PoisonError::into_inner).insert(path.to_owned());
        Ok(file)
    }

    /// Reads a regular file whole.
    ///
    /// # Errors
    /// As [`Self::open`].
    pub fn read(&self, path: &Path) -> io::Result<Vec<u8>> {
        let mut file = self.open(path)?;
        let mut bytes = Vec::new();
        file.read_to_end(&mut bytes)?;
        Ok(bytes)
    }

    /// The files that were opened so far, as they were named.
    pub fn opened(&self) -> Vec<PathBuf> {
        self.opened.lock().unwrap_or_else(PoisonError::into_inner).iter().cloned().collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn folders_and_devices_are_refused_and_files_are_remembered() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a");
        std::fs::write(&path, b"text").unwrap();
        let files = Files::default();
        assert_eq!(files.read(&path).unwrap(), b"text");
        assert!(files.read(folder.path()).unwrap_err().to_string().contains("folder"));
        #[cfg(unix)]
        assert!(files.read(Path::new("/dev/zero")).unwrap_err().to_string().contains("regular"));
        assert!(files.read(&folder.path().join("b")).is_err());
        assert_eq!(files.opened(), [path]);
    }
}
