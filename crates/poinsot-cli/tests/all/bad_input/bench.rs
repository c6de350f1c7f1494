//! A folder with a valid model and telemetry, in which each case changes one thing.

use crate::bad_input::case::set_up;
use crate::bad_input::changes::shared;
use crate::bad_input::sheet::Sheet;
use assert_cmd::Command;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

/// Why a change of a case cannot be made.
pub type Problem = String;

/// The columns that the satellite needs.
const COLUMNS: [&str; 11] = [
    "time_s",
    "omega_x",
    "omega_y",
    "omega_z",
    "q_x",
    "q_y",
    "q_z",
    "q_w",
    "wheel1_rad_s",
    "wheel2_rad_s",
    "wheel3_rad_s",
];

/// The valid telemetry, simulated once.
fn telemetry() -> &'static str {
    static TEXT: OnceLock<String> = OnceLock::new();
    TEXT.get_or_init(|| {
        let bench = Bench::empty();
        bench.write("m.toml", shared("m.toml").unwrap());
        set_up(&bench, "simulation").unwrap();
        let done = bench.run(&["simulate", "case.toml", "--out", "sim"]);
        assert_eq!(done.exit, 0, "{}", done.stderr);
        let text = std::fs::read_to_string(bench.path("sim/telemetry.csv")).unwrap();
        Sheet::parse(&text).of(&COLUMNS).text()
    })
}

/// Output of a run.
pub struct Done {
    pub exit: i32,
    pub stdout: String,
    pub stderr: String,
}

/// A folder in which a case runs.
pub struct Bench(tempfile::TempDir);

impl Bench {
    fn empty() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    /// Model and telemetry of the satellite: `m.toml`, `t.csv`.
    pub fn good() -> Self {
        let bench = Self::empty();
        bench.write("m.toml", shared("m.toml").unwrap());
        bench.write("t.csv", telemetry());
        bench
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    pub fn read(&self, name: &str) -> Result<Vec<u8>, Problem> {
        std::fs::read(self.path(name)).map_err(|e| format!("{name}: {e}"))
    }

    pub fn write(&self, name: &str, content: impl AsRef<[u8]>) {
        let path = self.path(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, content).unwrap();
    }

    /// Changes a file; a change that changes nothing is a fault of the case.
    pub fn edit(
        &self,
        name: &str,
        change: impl FnOnce(Vec<u8>) -> Result<Vec<u8>, Problem>,
    ) -> Result<(), Problem> {
        let old = self.read(name)?;
        let new = change(old.clone()).map_err(|e| format!("{name}: {e}"))?;
        if new == old {
            return Err(format!("{name}: a change finds nothing to change"));
        }
        self.write(name, new);
        Ok(())
    }

    /// Runs the program in the folder.
    pub fn run(&self, arguments: &[impl AsRef<std::ffi::OsStr>]) -> Done {
        // Limit CPU time, not wall-clock time: the machine may be busy.
        let output = Command::new("sh")
            .args([
                "-c",
                "ulimit -t 60; exec \"$@\"",
                "sh",
                env!("CARGO_BIN_EXE_poinsot"),
            ])
            .current_dir(self.0.path())
            .env("RAYON_NUM_THREADS", "1")
            .args(arguments)
            .output()
            .unwrap();
        Done {
            exit: output.status.code().unwrap_or(-1),
            stdout: String::from_utf8_lossy(&output.stdout).into_owned(),
            stderr: String::from_utf8_lossy(&output.stderr).into_owned(),
        }
    }

    /// All files below the folder.
    pub fn files(&self) -> BTreeSet<PathBuf> {
        let mut all = BTreeSet::new();
        let mut folders = vec![self.0.path().to_owned()];
        while let Some(folder) = folders.pop() {
            for entry in std::fs::read_dir(&folder).into_iter().flatten().flatten() {
                match entry.file_type() {
                    Ok(kind) if kind.is_dir() => folders.push(entry.path()),
                    _ => {
                        all.insert(relative(self.0.path(), &entry.path()));
                    }
                }
            }
        }
        all
    }
}

fn relative(folder: &Path, path: &Path) -> PathBuf {
    path.strip_prefix(folder).unwrap_or(path).to_owned()
}
