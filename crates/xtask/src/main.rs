//! Maintenance commands of the project: quoted outputs, benchmarks, the book.

mod bench;
mod book;
mod fault;
mod outputs;
mod python;
mod repository;

use clap::{Parser, Subcommand};
use fault::Fault;
use std::path::PathBuf;
use std::process::ExitCode;

/// Maintenance commands of the project. `scripts/NAME` runs the command NAME.
#[derive(Debug, Parser)]
#[command(name = "xtask")]
struct Arguments {
    #[command(subcommand)]
    command: Task,
}

#[derive(Debug, Subcommand)]
enum Task {
    /// Run the commands that README, docs and examples quote, and fill in what they print.
    ///
    /// A line `<!-- output of: COMMAND -->` names a command; the block fenced by ```text after it is its standard output.
    /// The block fenced by ```console after `<!-- run: COMMAND -->` shows the command too; `&&` begins a new line.
    /// Between `<!-- lines of: COMMAND -->` and `<!-- end of lines -->` is every line of the output with the sentence of
    /// docs/reference/output_lines.txt that explains it; a line without a sentence is an error. `poinsot` in a command is
    /// the program built from this checkout; pipes work. Commands of a page run in the order of the page.
    #[command(verbatim_doc_comment)]
    Outputs {
        /// Fail if a block is not what its command prints, instead of writing.
        #[arg(long)]
        check: bool,
        /// Program to use; default: build it with cargo.
        #[arg(long)]
        poinsot: Option<PathBuf>,
    },
    /// Run benchmarks of the kernels on the arm of Xu et al. (2017), with the peers beside them where they are found.
    ///
    /// Prints name,value,unit, then the ratios. BENCHMARKS.md says how to install the peers.
    ///
    /// POINSOT_BENCH_PYTHON   Python with numpy and scipy (and, for Pinocchio, the wheel `pin`)
    /// POINSOT_BENCH_EIGEN    folder of the Eigen headers (default /usr/include/eigen3)
    /// POINSOT_BENCH_CORE     processor core to stay on (default 0)
    #[command(verbatim_doc_comment)]
    Bench {
        /// Samples for NumPy (10^6 need 10 GB of memory and a minute), or `instructions`: ours counted by valgrind,
        /// against benches/instructions.csv, exit code 1 beyond 15 %, or `record`: the same, written there.
        #[arg(default_value_t = bench::SAMPLES.to_string())]
        what: String,
    },
    /// Measure how long reading takes: eight of thirty columns, with the hash, beside pyarrow and polars on one thread.
    ///
    /// Prints name,value,unit, then the ratios. BENCHMARKS.md says what is compared. POINSOT_BENCH_PYTHON names a Python
    /// with numpy, pyarrow and polars.
    BenchRead {
        /// Rows of the table.
        #[arg(default_value_t = bench::read::ROWS)]
        rows: u64,
    },
    /// Measure how long a fit takes: beside MuJoCo's identification toolbox on one problem, and over the number of samples.
    ///
    /// Prints name,value,unit, then the ratios. BENCHMARKS.md says what is compared. POINSOT_BENCH_SYSID names a Python with
    /// mujoco[sysid]==3.8.1; without it only ours is measured.
    BenchFit {
        /// Samples of the longest record; 1000000 takes minutes.
        #[arg(default_value_t = bench::fit::SAMPLES)]
        samples: u64,
    },
    /// Draw a flame graph of fits of the payload (BENCHMARKS.md, "A whole fit"), one thread.
    ///
    /// Needs perf, and inferno 0.12 on the path (cargo install inferno). POINSOT_BENCH_SYSID names a Python with
    /// mujoco[sysid]==3.8.1, which writes the record.
    FlameGraph {
        /// SVG file to write.
        out: PathBuf,
    },
    /// Build the program of the book with the features of the tests, and run it: `build`, `generate`, `check`.
    Book {
        /// Arguments of poinsot-book.
        #[arg(trailing_var_arg = true, allow_hyphen_values = true)]
        arguments: Vec<String>,
    },
    #[command(flatten)]
    Python(python::Program),
}

fn main() -> ExitCode {
    match run(Arguments::parse().command) {
        Ok(()) => ExitCode::SUCCESS,
        Err(fault) => {
            if let Some(text) = fault.text() {
                eprintln!("{text}");
            }
            ExitCode::from(fault.code())
        }
    }
}

fn run(task: Task) -> Result<(), Fault> {
    match task {
        Task::Outputs { check, poinsot } => outputs::run(check, poinsot),
        Task::Bench { what } => bench::run(&what),
        Task::BenchRead { rows } => bench::read::run(rows),
        Task::BenchFit { samples } => bench::fit::run(samples),
        Task::FlameGraph { out } => bench::flame_graph::run(&out),
        Task::Book { arguments } => book::run(&arguments),
        Task::Python(program) => program.run(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;
    use repository::{files_below, name_of, read, root};
    use std::collections::BTreeSet;

    /// These scripts are programs of their own: they work before anything is built.
    #[test]
    fn unit_every_script_calls_its_command() {
        let command = Arguments::command();
        let commands: BTreeSet<_> = command
            .get_subcommands()
            .map(clap::Command::get_name)
            .collect();
        let mut scripts = BTreeSet::new();
        for path in files_below(&root().join("scripts")).unwrap() {
            let name = name_of(&path).replace("scripts/", "");
            if ["test", "size", "planted", "fuzz"].contains(&name.as_str()) {
                continue;
            }
            let text = read(&path).unwrap();
            let call = format!("-p xtask -- {name} \"$@\"\n");
            assert!(
                text.lines().count() == 3 && text.ends_with(&call),
                "scripts/{name}"
            );
            scripts.insert(name);
        }
        assert_eq!(scripts, commands.into_iter().map(str::to_owned).collect());
    }
}
