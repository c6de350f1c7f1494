//! A folder with a valid model and telemetry, in which each row changes one thing.

use assert_cmd::Command;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

/// A satellite with three wheels, a gyro and a star tracker.
pub const MODEL: &str = r#"schema = "poinsot.model/1"
name = "sat"

[[body]]
name = "bus"
mass_kg = 150.0
com_m = [0.0, 0.0, 0.0]
inertia_kg_m2 = { xx = 15.0, yy = 16.0, zz = 21.0, xy = 0.0, xz = 0.0, yz = 0.0 }
estimate = ["inertia"]

[[wheel]]
name = "wheel1"
body = "bus"
axis = [1.0, 0.0, 0.0]
spin_inertia_kg_m2 = 0.0004113

[[wheel]]
name = "wheel2"
body = "bus"
axis = [0.0, 1.0, 0.0]
spin_inertia_kg_m2 = 0.0004113

[[wheel]]
name = "wheel3"
body = "bus"
axis = [0.0, 0.0, 1.0]
spin_inertia_kg_m2 = 0.0004113

[[sensor]]
name = "gyro"
type = "gyro"
noise_rad_s = 0.0001

[[sensor]]
name = "tracker"
type = "attitude"
noise_rad = 5e-05

[momentum]
linear_N_s = "estimate"
angular_N_m_s = "estimate"
"#;

/// The wheels rotate it while the whole vehicle spins slowly.
pub const CASE: &str = r#"schema = "poinsot.case/1"
model = "truth.toml"
duration_s = 100.0

[initial]
q_xyzw = [0.1, -0.2, 0.05, 0.9733961166965892]
momentum_zero = false
angular_N_m_s = [0.2, -0.3, 0.25]
linear_N_s = [0.0, 0.0, 0.0]

[[wheel_motion]]
wheel = "wheel1"
time_s = [0.0, 20.0, 40.0, 80.0, 100.0]
speed_rad_s = [0.0, 150.0, 60.0, -120.0, 0.0]
interpolation = "cubic_clamped"

[[wheel_motion]]
wheel = "wheel2"
time_s = [0.0, 30.0, 60.0, 100.0]
speed_rad_s = [20.0, -100.0, 130.0, -50.0]
interpolation = "cubic_clamped"

[[wheel_motion]]
wheel = "wheel3"
time_s = [0.0, 25.0, 70.0, 100.0]
speed_rad_s = [-30.0, 90.0, -110.0, 40.0]
interpolation = "cubic_clamped"

[output]
rate_hz = 5
seed = 3
"#;

/// The model with the true inertia.
pub fn truth() -> String {
    MODEL.replace(
        "xx = 15.0, yy = 16.0, zz = 21.0, xy = 0.0, xz = 0.0, yz = 0.0",
        "xx = 13.916, yy = 16.954, zz = 19.894, xy = 0.085, xz = 0.133, yz = 0.5896",
    )
}

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

/// Telemetry as text: a header and cells.
#[derive(Clone)]
pub struct Sheet {
    pub header: Vec<String>,
    pub rows: Vec<Vec<String>>,
}

impl Sheet {
    fn parse(text: &str) -> Self {
        let mut lines = text
            .lines()
            .map(|l| l.split(',').map(str::to_owned).collect());
        let header: Vec<String> = lines.next().unwrap_or_default();
        let all: Vec<Vec<String>> = lines.collect();
        let keep: Vec<usize> = COLUMNS
            .iter()
            .map(|c| header.iter().position(|h| h == c).unwrap())
            .collect();
        let pick = |row: &Vec<String>| keep.iter().map(|&k| row[k].clone()).collect();
        Self {
            header: pick(&header),
            rows: all.iter().map(pick).collect(),
        }
    }

    pub fn text(&self) -> String {
        let mut out = self.header.join(",") + "\n";
        for row in &self.rows {
            out.push_str(&(row.join(",") + "\n"));
        }
        out
    }

    pub fn column(&self, name: &str) -> usize {
        self.header.iter().position(|h| h == name).unwrap()
    }

    /// Sets a cell; rows count from 0.
    pub fn set(&mut self, row: usize, name: &str, value: impl ToString) {
        let k = self.column(name);
        self.rows[row][k] = value.to_string();
    }

    pub fn get(&self, row: usize, name: &str) -> f64 {
        self.rows[row][self.column(name)].parse().unwrap()
    }

    /// Changes all numbers of the columns with this prefix.
    pub fn map(&mut self, prefix: &str, change: impl Fn(usize, f64) -> f64) {
        let columns: Vec<usize> = (0..self.header.len())
            .filter(|&k| self.header[k].starts_with(prefix))
            .collect();
        for (n, row) in self.rows.iter_mut().enumerate() {
            for &k in &columns {
                if let Ok(x) = row[k].parse::<f64>() {
                    row[k] = format!("{:?}", change(n, x));
                }
            }
        }
    }

    pub fn without(&mut self, prefix: &str) {
        let keep: Vec<bool> = self.header.iter().map(|h| !h.starts_with(prefix)).collect();
        for row in std::iter::once(&mut self.header).chain(&mut self.rows) {
            let mut keep = keep.iter();
            row.retain(|_| *keep.next().unwrap());
        }
    }
}

/// The valid telemetry, simulated once.
pub fn sheet() -> Sheet {
    static TEXT: OnceLock<String> = OnceLock::new();
    let text = TEXT.get_or_init(|| {
        let bench = Bench::empty();
        bench.write("truth.toml", truth());
        bench.write("case.toml", CASE);
        let done = bench.run(&["simulate", "case.toml", "--out", "sim"]);
        assert_eq!(done.exit, 0, "{}", done.stderr);
        std::fs::read_to_string(bench.path("sim/telemetry.csv")).unwrap()
    });
    Sheet::parse(text)
}

/// Output of a run.
pub struct Done {
    pub exit: i32,
    pub stdout: String,
    pub stderr: String,
}

/// A folder in which a row runs.
pub struct Bench(tempfile::TempDir);

impl Bench {
    pub fn empty() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    /// Model and telemetry of the satellite: `m.toml`, `t.csv`.
    pub fn good() -> Self {
        let bench = Self::empty();
        bench.write("m.toml", MODEL);
        bench.write("t.csv", sheet().text());
        bench
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    pub fn write(&self, name: &str, content: impl AsRef<[u8]>) {
        std::fs::write(self.path(name), content).unwrap();
    }

    /// The telemetry with a change.
    pub fn spoil(&self, change: impl FnOnce(&mut Sheet)) {
        let mut sheet = sheet();
        change(&mut sheet);
        self.write("t.csv", sheet.text());
    }

    /// The model with a text replaced.
    pub fn model(&self, from: &str, to: &str) {
        let text = std::fs::read_to_string(self.path("m.toml")).unwrap();
        assert!(text.contains(from), "{from}");
        self.write("m.toml", text.replacen(from, to, 1));
    }

    /// Runs the program in the folder.
    pub fn run(&self, arguments: &[&str]) -> Done {
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
