//! Output files that appear whole or not at all.
//!
//! An [`Output`] is asked for before the work starts, so that a folder that cannot be written to is found at once, and
//! committed after it. Only then are there bytes, in a temporary file beside the target, which goes away with the
//! process if that calls [`abandon`] before it ends. What a process leaves that is killed while it writes, the next
//! removes: a temporary file is locked as long as its process lives.

use std::collections::BTreeSet;
use std::fs::{self, File, TryLockError};
use std::io::{self, BufWriter, ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

use tempfile::{Builder, NamedTempFile};

/// Name of a temporary file, around what makes it unique.
const NAME: (&str, &str) = (".warpfront-", ".tmp");
/// Temporary files made at most until one is not taken for a stale one.
const ATTEMPTS: u32 = 100;

/// Temporary files that now exist.
static UNFINISHED: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());

fn unfinished() -> MutexGuard<'static, BTreeSet<PathBuf>> {
    UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Removes unfinished output files, before the process ends; while what it gives is held, no thread begins or finishes
/// one.
pub fn abandon() -> impl Sized {
    let unfinished = unfinished();
    for path in unfinished.iter() {
        // Nothing can be done about a file that cannot be removed, and nobody is left to tell.
        let _ = fs::remove_file(path);
    }
    unfinished
}

/// Failure to write a file.
#[derive(Debug, thiserror::Error)]
#[error("cannot write `{}`: {cause}", path.display())]
pub struct OutputError {
    /// The file that was to be written, as the caller named it.
    pub path: PathBuf,
    /// Cause of the failure, in words.
    pub cause: String,
    /// Remedy for it.
    pub remedy: String,
}

/// A file about to be written.
pub struct Output {
    path: PathBuf,
    target: PathBuf,
}

impl Output {
    /// An output at `path`, where a file may be written; nothing that is there already is changed.
    ///
    /// A symbolic link is followed: the file that it points to is the one that will be replaced.
    ///
    /// # Errors
    /// If `path` is a folder, a device or write-protected, or its folder is missing, full or may not be written to.
    pub fn create(path: &Path) -> Result<Self, OutputError> {
        let refused = |cause: &str, remedy: &str| OutputError {
            path: path.to_owned(),
            cause: cause.to_owned(),
            remedy: remedy.to_owned(),
        };
        match fs::metadata(path) {
            Ok(there) if there.is_dir() => {
                return Err(refused("it is a folder", "name a file, for instance one inside that folder"));
            }
            Ok(there) if !there.is_file() => {
                return Err(refused("it is not an ordinary file", "name an ordinary file"));
            }
            Ok(there) if there.permissions().readonly() => {
                return Err(refused("it is write-protected", "make it writable or name another file"));
            }
            Err(error) if error.kind() != ErrorKind::NotFound => return Err(explain(path, &error)),
            _ => {}
        }
        let target = fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
        // Has no name, or not for long: a process that is killed leaves nothing.
        tempfile::tempfile_in(folder_of(&target)).map_err(|error| explain(path, &error))?;
        Ok(Self { path: path.to_owned(), target })
    }

    /// The file, as the caller named it.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Lets `write` fill the file and puts it in place.
    ///
    /// # Errors
    /// Error of `write`, or of the file system; the target is then as it was before.
    pub fn commit(
        self,
        write: impl FnOnce(&mut BufWriter<&File>) -> io::Result<()>,
    ) -> Result<(), OutputError> {
        replace(&self.target, write).map_err(|error| explain(&self.path, &error))
    }
}

/// Puts a file that `write` fills in the place of `target`, safely on its disk: else the machine may go down with
/// neither the new file nor the old one there.
fn replace(target: &Path, write: impl FnOnce(&mut BufWriter<&File>) -> io::Result<()>) -> io::Result<()> {
    let folder = folder_of(target);
    remove_stale(folder);
    let temporary = temporary_beside(target)?;
    let written = fill(temporary.as_file(), write);
    let mut unfinished = unfinished();
    unfinished.remove(temporary.path());
    match written {
        Ok(()) => temporary.persist(target).map_err(|error| error.error)?,
        Err(error) => {
            // While the list is locked, as everywhere else.
            drop(temporary);
            return Err(error);
        }
    };
    // Not every file system can, and the file is in place.
    #[cfg(unix)]
    let _ = File::open(folder).and_then(|folder| folder.sync_all());
    Ok(())
}

fn fill(file: &File, write: impl FnOnce(&mut BufWriter<&File>) -> io::Result<()>) -> io::Result<()> {
    let mut buffer = BufWriter::with_capacity(1 << 18, file);
    let written = write(&mut buffer).and_then(|()| buffer.flush());
    // Bytes that could not be flushed are lost anyway; dropping the buffer would try again.
    let _ = buffer.into_parts();
    written?;
    file.sync_all()
}

/// A locked file that is known to be unfinished.
fn temporary_beside(target: &Path) -> io::Result<NamedTempFile> {
    let mut builder = Builder::new();
    builder.prefix(NAME.0).suffix(NAME.1);
    #[cfg(unix)]
    builder.permissions(permissions(target));
    let mut unfinished = unfinished();
    for _ in 0..ATTEMPTS {
        let temporary = builder.tempfile_in(folder_of(target))?;
        // Before it was locked, another process may have taken it for a stale one. Where files cannot be locked, none
        // are.
        let is_taken = matches!(temporary.as_file().try_lock(), Err(TryLockError::WouldBlock));
        if !is_taken && temporary.path().exists() {
            unfinished.insert(temporary.path().to_owned());
            return Ok(temporary);
        }
    }
    Err(io::Error::other("temporary files do not last"))
}

/// Removes what killed processes left in `folder`: temporary files that nobody has locked.
fn remove_stale(folder: &Path) {
    let remove = |path: &Path| {
        let file = File::options().write(true).open(path)?;
        file.try_lock()?;
        fs::remove_file(path)
    };
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let name = entry.file_name();
        let name = name.to_string_lossy();
        let is_ours = name.starts_with(NAME.0) && name.ends_with(NAME.1);
        if is_ours && entry.file_type().is_ok_and(|kind| kind.is_file()) {
            // Whoever owns it may still write it, or may not want it removed.
            let _ = remove(&entry.path());
        }
    }
}

/// Those of the file to be replaced; for a new one those of any new file, not the private ones of a temporary file.
#[cfg(unix)]
fn permissions(target: &Path) -> fs::Permissions {
    use std::os::unix::fs::PermissionsExt;

    fs::metadata(target).map_or_else(|_| fs::Permissions::from_mode(0o666), |there| there.permissions())
}

fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    }
}

fn explain(path: &Path, error: &io::Error) -> OutputError {
    let folder = folder_of(path).display();
    let (cause, remedy) = match error.kind() {
        ErrorKind::NotFound => {
            (format!("the folder `{folder}` does not exist"), "create the folder or name another".to_owned())
        }
        ErrorKind::NotADirectory => {
            (format!("`{folder}` is not a folder"), "name a file in an existing folder".to_owned())
        }
        ErrorKind::PermissionDenied => (
            format!("no permission to create files in `{folder}`"),
            "change the folder's permissions or name another folder".to_owned(),
        ),
        ErrorKind::ReadOnlyFilesystem => {
            (format!("`{folder}` is on a read-only file system"), "name another folder".to_owned())
        }
        ErrorKind::StorageFull | ErrorKind::QuotaExceeded => (
            format!("the disk that holds `{folder}` is full"),
            "free some space or name another folder".to_owned(),
        ),
        ErrorKind::InvalidFilename => ("the name is too long".to_owned(), "give a shorter name".to_owned()),
        _ => (error.to_string(), "name another file or folder".to_owned()),
    };
    OutputError { path: path.to_owned(), cause, remedy }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        let mut names: Vec<String> = fs::read_dir(folder)
            .unwrap()
            .map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned())
            .collect();
        names.sort();
        names
    }

    #[test]
    fn a_committed_file_replaces_the_old_one_and_nothing_else_is_left() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("out.txt");
        fs::write(&path, "old").unwrap();
        let output = Output::create(&path).unwrap();
        assert_eq!(fs::read_to_string(&path).unwrap(), "old");
        output.commit(|out| out.write_all(b"new")).unwrap();
        assert_eq!(fs::read_to_string(&path).unwrap(), "new");
        assert_eq!(names(folder.path()), ["out.txt"]);
    }

    #[test]
    fn a_failed_write_leaves_the_old_file_alone() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("out.txt");
        fs::write(&path, "old").unwrap();
        let failed = Output::create(&path).unwrap().commit(|out| {
            out.write_all(b"half")?;
            Err(ErrorKind::StorageFull.into())
        });
        let message = failed.unwrap_err().to_string();
        assert!(message.contains("out.txt") && message.contains("full"), "{message}");
        assert_eq!(fs::read_to_string(&path).unwrap(), "old");
        assert_eq!(names(folder.path()), ["out.txt"]);
    }

    #[test]
    fn an_output_that_is_not_written_yet_leaves_nothing() {
        let folder = tempfile::tempdir().unwrap();
        let _output = Output::create(&folder.path().join("out.txt")).unwrap();
        assert!(names(folder.path()).is_empty());
    }

    #[test]
    fn what_a_killed_process_left_is_removed_and_what_another_writes_is_not() {
        let folder = tempfile::tempdir().unwrap();
        let there = [".warpfront-stale.tmp", ".warpfront-busy.tmp", "warpfront.tmp"];
        there.iter().for_each(|name| fs::write(folder.path().join(name), "part").unwrap());
        let busy = File::options().write(true).open(folder.path().join(there[1])).unwrap();
        busy.lock().unwrap();
        Output::create(&folder.path().join("out")).unwrap().commit(|_| Ok(())).unwrap();
        assert_eq!(names(folder.path()), [there[1], "out", there[2]]);
    }

    #[test]
    fn outputs_that_are_written_at_once_do_not_disturb_each_other() {
        let folder = tempfile::tempdir().unwrap();
        std::thread::scope(|scope| {
            for thread in 0..4 {
                let path = folder.path().join(format!("{thread}.txt"));
                scope.spawn(move || {
                    for _ in 0..20 {
                        Output::create(&path).unwrap().commit(|out| out.write_all(b"whole")).unwrap();
                    }
                });
            }
        });
        assert_eq!(names(folder.path()), ["0.txt", "1.txt", "2.txt", "3.txt"]);
    }

    #[test]
    fn what_is_wrong_with_the_path_is_said() {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("file"), "").unwrap();
        let cases = [
            (folder.path().to_owned(), "it is a folder"),
            (folder.path().join("missing/out.exr"), "missing` does not exist"),
            (folder.path().join("file/out.exr"), "file` is not a folder"),
            (folder.path().join("x".repeat(300)), "too long"),
        ];
        for (path, expected) in cases {
            let error = Output::create(&path).err().unwrap();
            assert!(error.to_string().contains(expected), "{error} lacks {expected:?}");
            assert!(error.to_string().contains(&path.display().to_string()));
            assert!(!error.remedy.is_empty());
        }
        assert_eq!(names(folder.path()), ["file"]);
    }

    #[cfg(unix)]
    #[test]
    fn a_new_file_has_ordinary_permissions_and_an_old_one_keeps_its_own() {
        use std::os::unix::fs::PermissionsExt;

        let folder = tempfile::tempdir().unwrap();
        let mode = |path: &Path| fs::metadata(path).unwrap().permissions().mode() & 0o777;
        let ordinary = folder.path().join("ordinary");
        fs::write(&ordinary, "").unwrap();
        let new = folder.path().join("new");
        Output::create(&new).unwrap().commit(|_| Ok(())).unwrap();
        assert_eq!(mode(&new), mode(&ordinary));
        fs::set_permissions(&new, fs::Permissions::from_mode(0o600)).unwrap();
        Output::create(&new).unwrap().commit(|_| Ok(())).unwrap();
        assert_eq!(mode(&new), 0o600);
    }

    #[cfg(unix)]
    #[test]
    fn devices_and_write_protected_files_are_not_replaced() {
        let folder = tempfile::tempdir().unwrap();
        assert!(Output::create(Path::new("/dev/null")).is_err());
        let path = folder.path().join("kept");
        fs::write(&path, "kept").unwrap();
        let mut permissions = fs::metadata(&path).unwrap().permissions();
        permissions.set_readonly(true);
        fs::set_permissions(&path, permissions).unwrap();
        assert!(Output::create(&path).err().unwrap().to_string().contains("write-protected"));
    }

    #[cfg(unix)]
    #[test]
    fn a_link_is_followed() {
        let folder = tempfile::tempdir().unwrap();
        let (target, link) = (folder.path().join("target"), folder.path().join("link"));
        fs::write(&target, "old").unwrap();
        std::os::unix::fs::symlink(&target, &link).unwrap();
        Output::create(&link).unwrap().commit(|out| out.write_all(b"new")).unwrap();
        assert!(link.is_symlink());
        assert_eq!(fs::read_to_string(&target).unwrap(), "new");
    }
}
