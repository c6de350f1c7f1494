//! Benchmarks of the kernels, with the peers beside them where they are found.

mod counts;
mod figures;
pub mod fit;
pub mod flame_graph;
mod machine;
pub mod read;
mod table;

use crate::fault::Fault;
use crate::repository::{on_path, stdout_of};
use figures::Figures;
use machine::Machine;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Samples for NumPy, which needs a gigabyte of memory for them.
pub const SAMPLES: u64 = 100_000;
/// Samples of our least squares; NumPy needs 10 GB of memory for them.
const MANY_SAMPLES: u64 = 1_000_000;
/// Rounds: peer, ours, peer, ours; what drifts on the machine drifts for both.
const ROUNDS: usize = 2;
/// Nanoseconds that one step of 10 ms simulates.
const STEP_NS: f64 = 1e7;
const ENGINES: [&str; 2] = ["mujoco", "pinocchio"];
const NUMPY_LEAST_SQUARES: &str = "benches/peers/numpy_least_squares.py";
const REGRESSOR: &str = "momentum_regressor_6x70";

/// Programs and what they have printed.
struct Bench {
    machine: Machine,
    figures: Figures,
    samples: u64,
    kernels: PathBuf,
    dynamics: PathBuf,
    pinocchio: Option<PathBuf>,
    mujoco: Option<PathBuf>,
}

/// Runs all benchmarks with so many samples for NumPy, or counts `instructions`, or writes the `record` of them.
pub fn run(what: &str) -> Result<(), Fault> {
    let counted = ["instructions", "record"].contains(&what);
    let samples = if counted { Ok(SAMPLES) } else { what.parse() };
    let samples = samples.map_err(|_| {
        Fault::Use(format!(
            "bench: '{what}' is no number of samples; or use: instructions, record"
        ))
    })?;
    let (kernels, dynamics) = (machine::ours("figures")?, machine::ours("dynamics")?);
    if counted {
        return counts::run(what == "record", &kernels, &dynamics);
    }
    let (least_squares, swarm) = (machine::ours("least_squares")?, machine::ours("swarm")?);
    let machine = Machine::new()?;
    let (pinocchio, mujoco) = (machine.pinocchio()?, machine.mujoco()?);
    let figures = Figures::default();
    let mut bench = Bench {
        machine,
        figures,
        samples,
        kernels,
        dynamics,
        pinocchio,
        mujoco,
    };
    println!("name,value,unit");
    bench.kernels()?;
    bench.least_squares(&least_squares)?;
    bench.swarm(&swarm)?;
    bench.instructions()?;
    bench.steps();
    println!();
    table::print(&bench.figures, bench.samples);
    Ok(())
}

impl Bench {
    fn show(&mut self, mut command: Command) -> Result<(), Fault> {
        let printed = stdout_of(&mut command)?;
        self.figures.show(&printed);
        Ok(())
    }

    /// Runs a program on one core and keeps its figures.
    fn show_pinned(&mut self, program: &Path, arguments: &[&str]) -> Result<(), Fault> {
        let mut command = self.machine.pinned(program);
        command.args(arguments);
        self.show(command)
    }

    fn show_numpy(&mut self, modules: &str, arguments: &[&str]) -> Result<(), Fault> {
        match self.machine.python_peer(modules, arguments) {
            Some(command) => self.show(command),
            None => Ok(()),
        }
    }

    fn engines(&mut self) -> Result<(), Fault> {
        for program in [self.pinocchio.clone(), self.mujoco.clone()]
            .into_iter()
            .flatten()
        {
            self.show_pinned(&program, &[])?;
        }
        Ok(())
    }

    fn kernels(&mut self) -> Result<(), Fault> {
        for _ in 0..ROUNDS {
            self.engines()?;
            self.show_pinned(&self.kernels.clone(), &[])?;
            self.show_pinned(&self.dynamics.clone(), &[])?;
            self.show_numpy("numpy, scipy", &[NUMPY_LEAST_SQUARES, "regressor"])?;
        }
        self.engines()
    }

    fn least_squares(&mut self, program: &Path) -> Result<(), Fault> {
        let (many, samples) = (MANY_SAMPLES.to_string(), self.samples.to_string());
        for _ in 0..ROUNDS {
            self.show_pinned(program, &[&many, "1"])?;
        }
        // Two threads: on no core alone.
        let mut two_threads = machine::single(program);
        two_threads.args([&many, "2"]);
        self.show(two_threads)?;
        if self.samples != MANY_SAMPLES {
            self.show_pinned(program, &[&samples, "1"])?;
        }
        self.show_numpy("numpy, scipy", &[NUMPY_LEAST_SQUARES, &samples])
    }

    /// Swarm of Xu et al. (2017).
    fn swarm(&mut self, program: &Path) -> Result<(), Fault> {
        for _ in 0..ROUNDS {
            self.show_numpy("numpy", &["benches/peers/numpy_swarm.py"])?;
            let mut ours = self.machine.pinned(program);
            ours.env("RAYON_NUM_THREADS", "1");
            self.show(ours)?;
        }
        Ok(())
    }

    fn instructions(&mut self) -> Result<(), Fault> {
        if !on_path("valgrind") {
            return Ok(());
        }
        self.figures.show(&counts::lines(&counts::of_kernels(
            &self.kernels,
            &self.dynamics,
        )?));
        for name in [REGRESSOR, "forward_dynamics", "sim_rk4_10ms"] {
            // MuJoCo has no momentum regressor.
            let mujoco = self.mujoco.as_ref().filter(|_| name != REGRESSOR);
            for (engine, program) in [("pinocchio", self.pinocchio.as_ref()), ("mujoco", mujoco)] {
                if let Some(program) = program {
                    let name = format!("{engine}_{name}");
                    let count = counts::of_call(&name, "PEER_COUNT", &name, program)?;
                    self.figures.show(&counts::lines(&[count]));
                }
            }
        }
        Ok(())
    }

    /// Time of one step of the peers, from the time that they simulate, for the batches.
    fn steps(&mut self) {
        for engine in ENGINES {
            let simulated = format!("{engine}_sim_rk4_10ms");
            if let Some(most) = self.figures.most(&simulated, "simulated_s_per_s") {
                let step = STEP_NS / most;
                self.figures
                    .show(&format!("{engine}_rk4_10ms_step,{step:.1},ns_min\n"));
            }
        }
    }
}
