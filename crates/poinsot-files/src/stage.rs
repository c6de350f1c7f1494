//! Writes the files of one result all or none: drafts in a hidden folder, then put in place together.
//!
//! The hidden folder (`.poinsot-XXXXXX`) holds the drafts, the earlier files during replacement, and a lock file of
//! the running process. It is removed at the end, and by [`remove_stages`] on a signal. After a killed process, the
//! next stage in the same folder removes it.

use crate::Faults;
use std::collections::BTreeSet;
use std::fs::{self, File};
use std::hash::{DefaultHasher, Hash, Hasher};
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, SystemTime};
use tempfile::TempDir;

/// Prefix of the hidden folder's name.
const PREFIX: &str = ".poinsot-";

/// Lock file in the hidden folder, locked by its process.
const LOCK: &str = "lock";

/// A younger hidden folder may not have its lock yet.
const FRESH: Duration = Duration::from_secs(60);

/// Attempts to remove a folder that another thread still fills.
const TRIES: usize = 10;

/// Hidden folders of this process; locked while files are put in place, so that an interruption waits.
static OPEN: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());

fn open_stages() -> MutexGuard<'static, BTreeSet<PathBuf>> {
    OPEN.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Creates a file that grows while others read it, with its folder: the one output that is not put in place when it is complete.
///
/// # Errors
/// The folder or the file cannot be created.
///
/// ```
/// use std::io::Write;
///
/// let folder = tempfile::tempdir()?;
/// let path = folder.path().join("answer/rows.csv");
/// poinsot_files::growing(&path)?.write_all(b"time_s\n")?;
/// assert_eq!(std::fs::read_to_string(&path)?, "time_s\n");
/// # Ok::<(), std::io::Error>(())
/// ```
pub fn growing(path: &Path) -> io::Result<File> {
    if let Some(folder) = path.parent() {
        std::fs::create_dir_all(folder)?;
    }
    File::create(path)
}

/// Removes the drafts of this process after a running commit has finished. Call it only at the end of the process:
/// stages cannot continue.
pub fn remove_stages() {
    let open = open_stages();
    for folder in open.iter() {
        // Another thread may still add drafts; the next attempt removes them.
        let _ = (0..TRIES).any(|_| fs::remove_dir_all(folder).is_ok());
    }
    std::mem::forget(open);
}

struct Draft {
    target: PathBuf,
    draft: PathBuf,
}

/// Drafts of the files of one answer in a folder.
pub struct Stage {
    folder: PathBuf,
    drafts: Vec<Draft>,
    /// Folders created by this stage, outermost first.
    made: Vec<PathBuf>,
    lock: Option<File>,
    hidden: Option<TempDir>,
}

impl Stage {
    /// Creates the folder if missing, removes hidden folders of killed processes, and creates a new one.
    ///
    /// # Errors
    /// Writing fails.
    pub fn new(folder: &Path) -> Result<Self, Faults> {
        let mut made = Vec::new();
        let opened = make_folders(folder, &mut made)
            .map_err(|e| Faults::io(folder, "its folder cannot be made", &e))
            .and_then(|()| {
                sweep(folder);
                open_hidden(folder).map_err(|e| Faults::io(folder, "it is not writable", &e))
            });
        match opened {
            Ok((hidden, lock)) => Ok(Self {
                folder: folder.to_owned(),
                drafts: Vec::new(),
                made,
                lock: Some(lock),
                hidden: Some(hidden),
            }),
            Err(error) => {
                remove_folders(&made);
                Err(error)
            }
        }
    }

    /// Target path of a file; `name` is relative to the folder.
    pub fn target(&self, name: &Path) -> PathBuf {
        self.folder.join(name)
    }

    /// Drafts a file; `name` is relative to the folder.
    ///
    /// # Errors
    /// Writing fails.
    pub fn add(&mut self, name: &Path, bytes: &[u8]) -> Result<(), Faults> {
        let target = self.target(name);
        self.fill(name, |file| {
            io::Write::write_all(file, bytes)
                .map_err(|e| Faults::io(&target, "cannot be written", &e))
        })
    }

    /// Drafts a file that `write` fills.
    ///
    /// # Errors
    /// As `write`, or writing fails.
    pub fn fill<T>(
        &mut self,
        name: &Path,
        write: impl FnOnce(&mut File) -> Result<T, Faults>,
    ) -> Result<T, Faults> {
        let target = self.target(name);
        let failed = |e| Faults::io(&target, "cannot be written", &e);
        let draft = self.hidden().join(format!("new-{}", self.drafts.len()));
        let mut options = File::options();
        let options = options.read(true).write(true).create_new(true);
        let mut file = options.open(&draft).map_err(failed)?;
        let written = write(&mut file)?;
        file.sync_all().map_err(failed)?;
        self.drafts.push(Draft { target, draft });
        Ok(written)
    }

    /// Opens the last draft.
    ///
    /// # Errors
    /// There is none, or it cannot be read.
    pub fn last(&self) -> io::Result<File> {
        let last = self.drafts.last().ok_or(ErrorKind::NotFound)?;
        File::open(&last.draft)
    }

    fn hidden(&self) -> &Path {
        self.hidden.as_ref().map_or(Path::new(""), TempDir::path)
    }

    /// Puts all drafts in place in the order in which they were added. Returns their paths.
    ///
    /// # Errors
    /// A file cannot be put in place; all targets are then unchanged.
    pub fn commit(mut self) -> Result<Vec<PathBuf>, Faults> {
        // Locked until the end, so that another process waits, and an interruption.
        let _folder = locked(&self.folder);
        let open = open_stages();
        let earlier = match self.earlier_files() {
            Ok(earlier) => earlier,
            Err(error) => {
                drop(open);
                return Err(error);
            }
        };
        for (done, draft) in self.drafts.iter().enumerate() {
            if let Err(source) = fs::rename(&draft.draft, &draft.target) {
                let kept = match self.roll_back(done, &earlier) {
                    true => None,
                    false => self.hidden.take().map(TempDir::keep),
                };
                drop(open);
                return Err(match kept {
                    Some(kept) => Faults::kept(&draft.target, &source, &kept),
                    None => Faults::io(&draft.target, "cannot be written to its path", &source),
                });
            }
        }
        self.made.clear();
        self.flush_folders();
        drop(open);
        Ok(self.drafts.iter().map(|d| d.target.clone()).collect())
    }

    /// Checks every target, creates its folder and keeps a copy of the earlier file. One entry per draft.
    fn earlier_files(&mut self) -> Result<Vec<Option<PathBuf>>, Faults> {
        let mut earlier = Vec::with_capacity(self.drafts.len());
        for (k, draft) in self.drafts.iter().enumerate() {
            check_target(&draft.target)?;
            make_folders(folder_of(&draft.target), &mut self.made)
                .map_err(|e| Faults::io(&draft.target, "its folder cannot be made", &e))?;
            let kept = self.hidden().join(format!("old-{k}"));
            let found = keep(&draft.target, &kept)
                .map_err(|e| Faults::io(&draft.target, "the earlier file cannot be kept", &e))?;
            earlier.push(found.then_some(kept));
        }
        Ok(earlier)
    }

    /// Undoes the first `done` replacements. Returns whether all are undone.
    fn roll_back(&self, done: usize, earlier: &[Option<PathBuf>]) -> bool {
        let mut whole = true;
        for (draft, kept) in self.drafts.iter().zip(earlier).take(done).rev() {
            whole &= match kept {
                Some(kept) => fs::rename(kept, &draft.target).is_ok(),
                None => fs::remove_file(&draft.target).is_ok(),
            };
        }
        whole
    }

    /// Flushes folders, so that renames survive a power loss; some systems do not support it.
    fn flush_folders(&self) {
        let folders: BTreeSet<&Path> = self.drafts.iter().map(|d| folder_of(&d.target)).collect();
        for folder in folders {
            if let Ok(handle) = File::open(folder) {
                let _ = handle.sync_all();
            }
        }
    }
}

impl Drop for Stage {
    fn drop(&mut self) {
        // Some systems cannot remove an open file.
        self.lock = None;
        if let Some(hidden) = self.hidden.take() {
            // An interruption waits here, and removes what this code could not.
            let mut open = open_stages();
            open.remove(hidden.path());
            let _ = hidden.close();
        }
        remove_folders(&self.made);
    }
}

/// Locks a folder until the handle is dropped. Windows and some file systems lock no folders: then the file that stands for it.
fn locked(folder: &Path) -> Option<File> {
    let mut options = File::options();
    let mut stand_in = || {
        options
            .read(true)
            .append(true)
            .create(true)
            .open(stand_in(folder))
    };
    let lock = |file: File| file.lock().ok().map(|()| file);
    let own = File::open(folder).ok().and_then(lock);
    own.or_else(|| stand_in().ok().and_then(lock))
}

/// Path of an empty file among the temporary ones of this machine, named after a folder.
fn stand_in(folder: &Path) -> PathBuf {
    let mut name = DefaultHasher::new();
    let whole = fs::canonicalize(folder);
    whole.as_deref().unwrap_or(folder).hash(&mut name);
    std::env::temp_dir().join(format!("poinsot-{:016x}.lock", name.finish()))
}

/// Copies the earlier file, so that the target is never missing. Returns whether there was one.
fn keep(target: &Path, kept: &Path) -> io::Result<bool> {
    match fs::hard_link(target, kept) {
        Ok(()) => Ok(true),
        Err(e) if e.kind() == ErrorKind::NotFound => Ok(false),
        // Some file systems have no hard links.
        Err(_) => fs::copy(target, kept).map(|_| true),
    }
}

/// Checks that a target is free or a regular file, and that no file has the name of one of its folders.
///
/// # Errors
/// The obstacle.
pub fn check_target(target: &Path) -> Result<(), Faults> {
    let refuse = |path: &Path, what, kind: ErrorKind| Err(Faults::io(path, what, &kind.into()));
    let occupied = "cannot be written to its path";
    match fs::metadata(target) {
        Ok(found) if found.is_dir() => return refuse(target, occupied, ErrorKind::IsADirectory),
        Ok(found) if !found.is_file() => return refuse(target, occupied, ErrorKind::AlreadyExists),
        Ok(_) => return Ok(()),
        Err(_) => {}
    }
    let above = target.ancestors().skip(1).find(|a| a.exists());
    match above {
        Some(file) if !file.is_dir() => {
            refuse(file, "a folder is needed here", ErrorKind::NotADirectory)
        }
        _ => Ok(()),
    }
}

/// Whether two paths name the same existing file.
pub fn is_same_file(a: &Path, b: &Path) -> bool {
    let (Ok(found), Ok(other)) = (fs::metadata(a), fs::metadata(b)) else {
        return false;
    };
    #[cfg(unix)]
    {
        use std::os::unix::fs::MetadataExt;
        (found.dev(), found.ino()) == (other.dev(), other.ino())
    }
    #[cfg(not(unix))]
    {
        let _ = (found, other);
        fs::canonicalize(a).ok() == fs::canonicalize(b).ok()
    }
}

/// The folder of a file; `.` for a bare name.
pub fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(p) if !p.as_os_str().is_empty() => p,
        _ => Path::new("."),
    }
}

/// Creates a folder and its parents; appends the new ones to `made`.
fn make_folders(folder: &Path, made: &mut Vec<PathBuf>) -> io::Result<()> {
    let missing: Vec<&Path> = folder
        .ancestors()
        .take_while(|a| !a.as_os_str().is_empty() && !a.exists())
        .collect();
    for folder in missing.into_iter().rev() {
        match fs::create_dir(folder) {
            Ok(()) => made.push(folder.to_owned()),
            // Another process created it first.
            Err(e) if e.kind() == ErrorKind::AlreadyExists && folder.is_dir() => {}
            Err(e) => return Err(e),
        }
    }
    match folder.is_dir() || folder.as_os_str().is_empty() {
        true => Ok(()),
        false => Err(ErrorKind::NotADirectory.into()),
    }
}

/// Removes created folders that are still empty.
fn remove_folders(made: &[PathBuf]) {
    for folder in made.iter().rev() {
        let _ = fs::remove_dir(folder);
    }
}

fn open_hidden(folder: &Path) -> io::Result<(TempDir, File)> {
    let mut open = open_stages();
    let hidden = tempfile::Builder::new().prefix(PREFIX).tempdir_in(folder)?;
    open.insert(hidden.path().to_owned());
    drop(open);
    let lock = File::create(hidden.path().join(LOCK)).inspect_err(|_| {
        open_stages().remove(hidden.path());
    })?;
    // Without file locks on the file system, no stale folder is removed either.
    let _ = lock.lock();
    Ok((hidden, lock))
}

/// Removes hidden folders of ended processes.
fn sweep(folder: &Path) {
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let ours = entry.file_name().to_string_lossy().starts_with(PREFIX);
        if ours && is_stale(&entry.path()) {
            let _ = fs::remove_dir_all(entry.path());
        }
    }
}

/// Whether a hidden folder is stale: not fresh, its lock free, and holding only files of a stage.
fn is_stale(hidden: &Path) -> bool {
    let Ok(found) = fs::symlink_metadata(hidden) else {
        return false;
    };
    let changed = found.modified().unwrap_or_else(|_| SystemTime::now());
    let fresh = SystemTime::now()
        .duration_since(changed)
        .is_ok_and(|age| age < FRESH);
    if fresh || !found.is_dir() {
        return false;
    }
    let names: Vec<String> = fs::read_dir(hidden)
        .into_iter()
        .flatten()
        .flatten()
        .map(|e| e.file_name().to_string_lossy().into_owned())
        .collect();
    let strange =
        |name: &String| name != LOCK && !name.starts_with("new-") && !name.starts_with("old-");
    if names.iter().any(strange) {
        return false;
    }
    match File::open(hidden.join(LOCK)) {
        Ok(lock) => lock.try_lock().is_ok(),
        // The process was killed before it created its lock.
        Err(_) => names.is_empty(),
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        let mut names: Vec<String> = fs::read_dir(folder)
            .unwrap()
            .map(|e| e.unwrap().file_name().to_string_lossy().into_owned())
            .collect();
        names.sort();
        names
    }

    fn stage(folder: &Path, files: &[(&str, &str)]) -> Stage {
        let mut stage = Stage::new(folder).unwrap();
        for (name, text) in files {
            stage.add(Path::new(name), text.as_bytes()).unwrap();
        }
        stage
    }

    #[test]
    fn exact_all_files_appear_and_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let out = folder.path().join("a/b");
        let paths = stage(&out, &[("x", "1"), ("figures/y", "2")])
            .commit()
            .unwrap();
        assert_eq!(paths, [out.join("x"), out.join("figures/y")]);
        assert_eq!(names(&out), ["figures", "x"]);
        assert_eq!(fs::read_to_string(out.join("figures/y")).unwrap(), "2");
    }

    #[test]
    fn exact_what_is_not_committed_leaves_no_folder() {
        let folder = tempfile::tempdir().unwrap();
        drop(stage(&folder.path().join("a/b"), &[("x", "1")]));
        assert!(names(folder.path()).is_empty());
    }

    #[test]
    fn regress_a_folder_in_the_way_changes_no_earlier_file() {
        let folder = tempfile::tempdir().unwrap();
        let out = folder.path();
        fs::write(out.join("data"), "earlier").unwrap();
        fs::create_dir(out.join("page")).unwrap();
        let error = stage(out, &[("data", "new"), ("new/x", "new"), ("page", "new")])
            .commit()
            .unwrap_err();
        assert_eq!(
            error.list[0].place.file,
            out.join("page").display().to_string()
        );
        assert_eq!(names(out), ["data", "page"]);
        assert_eq!(fs::read_to_string(out.join("data")).unwrap(), "earlier");
    }

    #[test]
    fn regress_a_rename_that_fails_is_undone() {
        let folder = tempfile::tempdir().unwrap();
        let out = folder.path();
        fs::write(out.join("data"), "earlier").unwrap();
        let stage = stage(out, &[("data", "new"), ("other", "new"), ("last", "new")]);
        fs::remove_file(&stage.drafts[2].draft).unwrap();
        let error = stage.commit().unwrap_err();
        assert_eq!(error.code(), "E0002");
        assert_eq!(names(out), ["data"]);
        assert_eq!(fs::read_to_string(out.join("data")).unwrap(), "earlier");
    }

    #[test]
    fn exact_a_sweep_takes_the_dead_and_leaves_the_living() {
        let folder = tempfile::tempdir().unwrap();
        let out = folder.path();
        let old = SystemTime::now() - 2 * FRESH;
        let age = |path: &Path| File::open(path).unwrap().set_modified(old).unwrap();
        let alive = stage(out, &[("x", "1")]);
        age(alive.hidden());
        let dead = out.join(".poinsot-dead");
        fs::create_dir(&dead).unwrap();
        fs::write(dead.join(LOCK), "").unwrap();
        fs::write(dead.join("new-0"), "").unwrap();
        age(&dead);
        let young = out.join(".poinsot-young");
        fs::create_dir(&young).unwrap();
        let strange = out.join(".poinsot-notes");
        fs::create_dir(&strange).unwrap();
        fs::write(strange.join("mine.txt"), "").unwrap();
        age(&strange);
        sweep(out);
        assert!(!dead.exists() && young.exists() && strange.exists());
        alive.commit().unwrap();
        assert_eq!(names(out), [".poinsot-notes", ".poinsot-young", "x"]);
    }

    #[test]
    fn exact_a_file_stands_for_a_folder_that_cannot_be_opened() {
        let folder = tempfile::tempdir().unwrap();
        let gone = folder.path().join("gone");
        let first = locked(&gone).unwrap();
        let second = File::open(stand_in(&gone)).unwrap();
        assert!(second.try_lock().is_err());
        drop(first);
        second.try_lock().unwrap();
        fs::remove_file(stand_in(&gone)).unwrap();
    }

    #[test]
    fn exact_a_second_writer_waits() {
        let folder = tempfile::tempdir().unwrap();
        let out = folder.path();
        let first = locked(out).unwrap();
        let second = stage(out, &[("x", "2")]);
        let writer = std::thread::spawn(move || second.commit().unwrap());
        std::thread::sleep(Duration::from_millis(50));
        assert!(!out.join("x").exists());
        drop(first);
        writer.join().unwrap();
        assert!(out.join("x").exists());
    }

    #[test]
    fn exact_links_and_copies_of_a_path_name_one_file() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("x");
        fs::write(&file, "").unwrap();
        assert!(is_same_file(&file, &folder.path().join("./x")));
        assert!(!is_same_file(&file, &folder.path().join("y")));
    }
}
