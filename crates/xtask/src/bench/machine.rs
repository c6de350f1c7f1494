//! Programs of the benchmarks: ours, the peers', and how they are run.

use crate::fault::Fault;
use crate::repository::{cargo, on_path, root, stdout_of, succeed};
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// Prints the folder where the wheels of Pinocchio have put headers and libraries.
const PREFIX: &str = "import os, site; print(next((p for d in site.getsitepackages() \
    if os.path.isdir(p := os.path.join(d, 'cmeel.prefix'))), ''))";
const MUJOCO: &str = "import mujoco, os; print(os.path.dirname(mujoco.__file__))";
const COMPILE: [&str; 3] = ["-std=c++17", "-O3", "-DNDEBUG"];
/// As the wheel of Pinocchio was compiled.
const DEFINES: [&str; 4] = [
    "-DPINOCCHIO_ENABLE_TEMPLATE_INSTANTIATION",
    "-DBOOST_FUSION_INVOKE_MAX_ARITY=10",
    "-DBOOST_MPL_LIMIT_LIST_SIZE=30",
    "-DBOOST_MPL_CFG_NO_PREPROCESSED_HEADERS",
];

/// What the environment says of this machine.
pub struct Machine {
    pinned: Vec<String>,
    /// Python of the peers.
    pub python: Option<String>,
    eigen: PathBuf,
    /// Scratch folder for what is compiled.
    pub work: tempfile::TempDir,
}

impl Machine {
    /// Reads POINSOT_BENCH_PYTHON, POINSOT_BENCH_EIGEN and POINSOT_BENCH_CORE.
    pub fn new() -> Result<Self, Fault> {
        let core = variable("POINSOT_BENCH_CORE").unwrap_or_else(|| "0".to_owned());
        let pinned = ["taskset", "-c", &core].map(str::to_owned);
        Ok(Self {
            pinned: if on_path("taskset") {
                pinned.to_vec()
            } else {
                Vec::new()
            },
            python: variable("POINSOT_BENCH_PYTHON"),
            eigen: variable("POINSOT_BENCH_EIGEN")
                .unwrap_or_else(|| "/usr/include/eigen3".to_owned())
                .into(),
            work: crate::repository::scratch()?,
        })
    }

    /// A program on one core.
    pub fn pinned(&self, program: &Path) -> Command {
        match self.pinned.split_first() {
            None => single(program),
            Some((first, rest)) => {
                let mut command = single(Path::new(first));
                command.args(rest).arg(program);
                command
            }
        }
    }

    /// A script of benches/peers on one core, where Python has these modules.
    pub fn python_peer(&self, modules: &str, arguments: &[&str]) -> Option<Command> {
        let python = self.python.as_ref()?;
        self.asked(&format!("import {modules}"))?;
        let mut command = self.pinned(Path::new(python));
        command.args(arguments);
        Some(command)
    }

    /// What Python prints for a line, where it succeeds.
    fn asked(&self, line: &str) -> Option<String> {
        let output = single(Path::new(self.python.as_ref()?))
            .args(["-c", line])
            .stderr(Stdio::null())
            .output()
            .ok()?;
        output
            .status
            .success()
            .then(|| String::from_utf8_lossy(&output.stdout).trim().to_owned())
    }

    /// Pinocchio, compiled against the headers and the library of its wheel.
    pub fn pinocchio(&self) -> Result<Option<PathBuf>, Fault> {
        let Some(prefix) = self.asked(PREFIX).map(PathBuf::from) else {
            return Ok(None);
        };
        let (headers, libraries) = (prefix.join("include"), prefix.join("lib"));
        if !headers.join("pinocchio/multibody.hpp").is_file()
            || !self.eigen.is_dir()
            || !on_path("g++")
        {
            return Ok(None);
        }
        let out = self.work.path().join("pinocchio");
        let mut compiler = compiler();
        compiler
            .args(DEFINES)
            .arg("-I")
            .arg(headers)
            .arg("-isystem")
            .arg(&self.eigen);
        compiler
            .arg("benches/peers/pinocchio.cpp")
            .arg("-L")
            .arg(&libraries);
        compiler
            .arg(format!("-Wl,-rpath,{}", libraries.display()))
            .args(["-lpinocchio_default", "-o"])
            .arg(&out);
        succeed(&mut compiler)?;
        Ok(Some(out))
    }

    /// MuJoCo, against the library of its wheel.
    pub fn mujoco(&self) -> Result<Option<PathBuf>, Fault> {
        let Some(home) = self.asked(MUJOCO).map(PathBuf::from) else {
            return Ok(None);
        };
        let Some(library) = mujoco_library(&home).filter(|_| on_path("g++")) else {
            return Ok(None);
        };
        let out = self.work.path().join("mujoco");
        let mut compiler = compiler();
        compiler
            .arg("-I")
            .arg(home.join("include"))
            .arg("benches/peers/mujoco.cpp")
            .arg(library);
        succeed(
            compiler
                .arg(format!("-Wl,-rpath,{}", home.display()))
                .arg("-o")
                .arg(&out),
        )?;
        Ok(Some(out))
    }
}

/// Processor, cores and load of this machine, as far as the system says.
pub fn in_words() -> String {
    let read = |path: &str| std::fs::read_to_string(path).unwrap_or_default();
    let processors = read("/proc/cpuinfo");
    let name = processors
        .lines()
        .find(|line| line.starts_with("model name"));
    let name = name.and_then(|line| line.split_once(':'));
    let name = name.map_or("unknown processor", |(_, name)| name.trim());
    let cores = std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
    let load = read("/proc/loadavg");
    let load = load.split_whitespace().next().unwrap_or("unknown");
    format!("{name}, {cores} cores, load {load}")
}

/// A variable of the environment that is set and not empty.
pub fn variable(name: &str) -> Option<String> {
    std::env::var(name).ok().filter(|value| !value.is_empty())
}

/// A program in the repository whose linear algebra has one thread.
pub fn single(program: &Path) -> Command {
    let mut command = Command::new(program);
    command
        .current_dir(root())
        .env("OPENBLAS_NUM_THREADS", "1")
        .env("OMP_NUM_THREADS", "1");
    command
}

fn compiler() -> Command {
    let mut compiler = single(Path::new("g++"));
    compiler.args(COMPILE);
    compiler
}

fn mujoco_library(home: &Path) -> Option<PathBuf> {
    let files = std::fs::read_dir(home)
        .ok()?
        .flatten()
        .map(|entry| entry.path());
    let name = |path: &PathBuf| {
        path.file_name()
            .is_some_and(|name| name.to_string_lossy().starts_with("libmujoco.so."))
    };
    files.filter(name).min()
}

/// A benchmark program of ours, built with the features of the workspace, as the tests are.
pub fn ours(name: &str) -> Result<PathBuf, Fault> {
    let build = [
        "bench",
        "--quiet",
        "--locked",
        "--workspace",
        "--bench",
        name,
        "--no-run",
        "--message-format=json",
    ];
    let messages = stdout_of(&mut cargo(&build))?;
    executable(&messages, name)
        .ok_or_else(|| Fault::Failed(format!("bench: cargo names no program for '{name}'")))
}

/// The last program of this name among messages of cargo.
fn executable(messages: &str, name: &str) -> Option<PathBuf> {
    let messages = messages
        .lines()
        .filter_map(|line| serde_json::from_str::<Value>(line).ok());
    let mut paths =
        messages.filter_map(|message| message["executable"].as_str().map(PathBuf::from));
    let start = format!("{name}-");
    paths.rfind(|path| {
        path.file_name()
            .is_some_and(|file| file.to_string_lossy().starts_with(&start))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unit_the_last_program_of_a_name_is_taken() {
        let messages = "{\"executable\":\"/t/swarm-1\"}\n{\"executable\":null}\nnoise\n{\"executable\":\"/t/swarm-2\"}\n{\"executable\":\"/t/swarms-3\"}";
        assert_eq!(
            executable(messages, "swarm"),
            Some(PathBuf::from("/t/swarm-2"))
        );
        assert_eq!(executable(messages, "figures"), None);
    }
}
