//! Commands that are programs in Python: what draws, drives a browser, or measures the Python package.

use crate::fault::Fault;
use crate::repository::{build_programs, code, root, status};
use clap::{Args, Subcommand};
use std::process::Command;

/// What a command passes on. `--help` is that of the program.
#[derive(Debug, Args)]
#[command(disable_help_flag = true)]
pub struct Passed {
    #[arg(trailing_var_arg = true, allow_hyphen_values = true)]
    arguments: Vec<String>,
}

/// Programs in Python. POINSOT_PYTHON names another Python than python3.
#[derive(Debug, Subcommand)]
pub enum Program {
    /// Draw docs/picture.svg and the figures of the explanation pages from output of the program, or check them.
    Figures(Passed),
    /// Build the gallery: ten reports from shipped data, in target/gallery.
    Gallery(Passed),
    /// Use the gallery's reports in headless Chromium as a reader would, and compare their screens with validation/screens.
    BrowserTest(Passed),
    /// Write docs/reference/python_api.md from the docstrings of the Python package, or check it.
    PythonApi(Passed),
    /// Measure processor time and memory of `identify` over samples, bodies, unknowns, sensors, segments, firings.
    BenchGrowth(Passed),
    /// Measure memory and time of reading long telemetry.
    BenchMemory(Passed),
    /// Measure the Python package.
    BenchPython(Passed),
    /// Run the scripts of `poinsot campaign --emit slurm` by a Slurm of one node.
    Slurm(Passed),
}

impl Program {
    /// The file, whether it runs the program, and what to pass on.
    fn parts(&self) -> (&'static str, bool, &[String]) {
        let (file, runs, passed) = match self {
            Self::Figures(passed) => ("python/pages/figures.py", true, passed),
            Self::Gallery(passed) => ("validation/screens/gallery.py", true, passed),
            Self::BrowserTest(passed) => ("validation/screens/browser_test.py", true, passed),
            Self::PythonApi(passed) => ("python/pages/api.py", false, passed),
            Self::BenchGrowth(passed) => ("benches/growth.py", true, passed),
            Self::BenchMemory(passed) => ("benches/memory.py", true, passed),
            Self::BenchPython(passed) => ("benches/peers/python_package.py", false, passed),
            Self::Slurm(passed) => ("validation/slurm.py", true, passed),
        };
        (file, runs, &passed.arguments)
    }

    /// Runs the file; builds target/release/poinsot first where it is the program to run.
    pub fn run(&self) -> Result<(), Fault> {
        let (file, runs, arguments) = self.parts();
        if runs && !brings_program(arguments) {
            build_programs()?;
        }
        let python = std::env::var_os("POINSOT_PYTHON").unwrap_or_else(|| "python3".into());
        let mut program = Command::new(python);
        let ended = status(program.arg(file).args(arguments).current_dir(root()))?;
        ended
            .success()
            .then_some(())
            .ok_or(Fault::Ended(code(ended)))
    }
}

/// Whether the arguments name a program, or ask for help alone.
fn brings_program(arguments: &[String]) -> bool {
    arguments.iter().any(|word| {
        word == "-h" || word == "--help" || word == "--poinsot" || word.starts_with("--poinsot=")
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unit_a_named_program_is_not_built() {
        let words = |text: &str| text.split(' ').map(str::to_owned).collect::<Vec<_>>();
        assert!(brings_program(&words("--check --poinsot x")));
        assert!(brings_program(&words("--poinsot=x")));
        assert!(brings_program(&words("--help")));
        assert!(!brings_program(&words("--check")));
    }

    #[test]
    fn unit_every_program_is_there() {
        for make in [
            Program::Figures,
            Program::Gallery,
            Program::BrowserTest,
            Program::PythonApi,
            Program::BenchGrowth,
            Program::BenchMemory,
            Program::BenchPython,
            Program::Slurm,
        ] {
            let program = make(Passed {
                arguments: Vec::new(),
            });
            let (file, ..) = program.parts();
            assert!(root().join(file).is_file(), "{file}");
        }
    }
}
