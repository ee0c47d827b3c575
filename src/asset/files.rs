//! Access to the files of a scene: regular files only, within bounds, and a record of which were read.

use std::collections::BTreeSet;
use std::fs::{self, File};
use std::io::{self, Read};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use super::memory::Memory;

/// Reads the files of a scene, and remembers which they were.
#[derive(Debug, Default)]
pub struct Files {
    inputs: Mutex<BTreeSet<PathBuf>>,
    memory: Memory,
    /// Without symbolic links.
    folder: Option<PathBuf>,
}

impl Files {
    /// A reader whose contents are to fit in `memory`.
    pub fn within(memory: Memory) -> Self {
        Self { memory, ..Self::default() }
    }

    /// Confines the reader: nothing outside `folder` is opened.
    ///
    /// # Errors
    /// There is no such folder.
    pub fn confined_to(self, folder: &Path) -> io::Result<Self> {
        let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
        Ok(Self { folder: Some(fs::canonicalize(folder)?), ..self })
    }

    /// Memory that may be used.
    pub fn memory(&self) -> Memory {
        self.memory
    }

    /// Opens a regular file.
    ///
    /// # Errors
    /// Errors of the operating system; a file outside the folder is refused, and anything that is not a regular file,
    /// since devices and pipes may never end.
    pub fn open(&self, path: &Path) -> io::Result<File> {
        self.open_sized(path).map(|(file, _)| file)
    }

    /// Reads a regular file whole.
    ///
    /// # Errors
    /// As [`Self::open`]; the file is larger than the memory that is left.
    pub fn read(&self, path: &Path) -> io::Result<Vec<u8>> {
        let (file, size) = self.open_sized(path)?;
        self.memory.check("it", size).map_err(|flaw| io::Error::other(flaw.problem))?;
        let mut bytes = Vec::with_capacity(size as usize);
        // No more than was checked, even if it grows.
        file.take(size).read_to_end(&mut bytes)?;
        Ok(bytes)
    }

    /// Remembers a file that the scene names, even if nothing in it is needed.
    pub fn mention(&self, path: &Path) {
        self.inputs.lock().unwrap_or_else(PoisonError::into_inner).insert(path.to_owned());
    }

    /// The files that were opened or mentioned so far, as they were named.
    pub fn inputs(&self) -> Vec<PathBuf> {
        self.inputs.lock().unwrap_or_else(PoisonError::into_inner).iter().cloned().collect()
    }

    fn open_sized(&self, path: &Path) -> io::Result<(File, u64)> {
        let found = match &self.folder {
            Some(folder) => within(path, folder)?,
            None => path.to_owned(),
        };
        // Asked before it is opened: opening a pipe waits for somebody who writes to it.
        let metadata = fs::metadata(&found)?;
        if metadata.is_dir() {
            return Err(io::Error::other("it is a folder"));
        }
        if !metadata.is_file() {
            return Err(io::Error::other("it is not a regular file"));
        }
        let file = File::open(&found)?;
        self.mention(path);
        Ok((file, metadata.len()))
    }
}

/// The file behind all links, if it lies in `folder`.
fn within(path: &Path, folder: &Path) -> io::Result<PathBuf> {
    let found = fs::canonicalize(path)?;
    if found.starts_with(folder) {
        return Ok(found);
    }
    Err(io::Error::other(format!(
        "it lies outside the folder `{}`, to which --confine keeps all reads",
        folder.display()
    )))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn folders_and_devices_are_refused_and_files_are_remembered() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a");
        fs::write(&path, b"text").unwrap();
        let files = Files::default();
        assert_eq!(files.read(&path).unwrap(), b"text");
        assert!(files.read(folder.path()).unwrap_err().to_string().contains("folder"));
        #[cfg(unix)]
        assert!(files.read(Path::new("/dev/zero")).unwrap_err().to_string().contains("regular"));
        assert!(files.read(&folder.path().join("b")).is_err());
        assert_eq!(files.inputs(), std::slice::from_ref(&path));
        files.mention(Path::new("texture.png"));
        assert_eq!(files.inputs().len(), 2);
    }

    #[test]
    fn a_file_that_does_not_fit_in_memory_is_not_read() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a");
        File::create(&path).unwrap().set_len(1 << 40).unwrap();
        let message = Files::default().read(&path).unwrap_err().to_string();
        assert!(message.contains("1.00 TiB"), "{message}");
    }

    #[cfg(unix)]
    #[test]
    fn confined_files_lie_within_the_folder_behind_all_links() {
        let root = tempfile::tempdir().unwrap();
        let (inside, outside) = (root.path().join("scene/a"), root.path().join("secret"));
        fs::create_dir(root.path().join("scene")).unwrap();
        fs::write(&inside, b"a").unwrap();
        fs::write(&outside, b"b").unwrap();
        std::os::unix::fs::symlink(&outside, root.path().join("scene/link")).unwrap();
        std::os::unix::fs::symlink("a", root.path().join("scene/near")).unwrap();
        let files = Files::default().confined_to(&root.path().join("scene")).unwrap();
        assert_eq!(files.read(&inside).unwrap(), b"a");
        assert_eq!(files.read(&root.path().join("scene/near")).unwrap(), b"a");
        for name in ["scene/link", "scene/../secret", "secret"] {
            let message = files.read(&root.path().join(name)).unwrap_err().to_string();
            assert!(message.contains("outside") && message.contains("scene`"), "{name}: {message}");
        }
    }
}
