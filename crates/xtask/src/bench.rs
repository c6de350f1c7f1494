//! Benchmarks of the kernels, with the peers beside them where they are found.

mod counts;
mod figures;
pub mod fit;
pub mod flame_graph;
mod machine;
pub mod read;

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
    println!();
    bench.ratios();
    bench.batches();
    bench.ratios_of_numpy();
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

    fn ratios(&self) {
        let (ours, peer) = (
            format!("poinsot_{REGRESSOR}"),
            format!("pinocchio_{REGRESSOR}"),
        );
        for (what, unit) in [("least time", "ns_min"), ("instructions", "instructions")] {
            self.figures.ratio(
                &format!("momentum regressor 6 x 70, {what}"),
                (&ours, unit),
                (&peer, unit),
            );
        }
        for engine in ENGINES {
            for unit in ["ns_min", "instructions"] {
                let what = format!("forward dynamics against {engine}, {unit}");
                let peer = format!("{engine}_forward_dynamics");
                self.figures
                    .ratio(&what, ("poinsot_forward_dynamics", unit), (&peer, unit));
            }
            let ours = self
                .figures
                .most("poinsot_sim_rk4_10ms", "simulated_s_per_s");
            if let (Some(peer), Some(ours)) = (self.simulated(engine), ours) {
                let times = ours / peer;
                println!(
                    "simulated seconds per second against {engine}, Runge-Kutta at 10 ms: {times:.2} times"
                );
            }
        }
    }

    /// Seconds that an engine simulates in one second.
    fn simulated(&self, engine: &str) -> Option<f64> {
        self.figures
            .most(&format!("{engine}_sim_rk4_10ms"), "simulated_s_per_s")
    }

    /// Batches of 4,096 beside one call of the peers, a vehicle or a state; a step beside the peers' simulated time.
    fn batches(&self) {
        self.batch("momentum regressor", "pinocchio", REGRESSOR);
        self.batch("momentum regressor", "numpy", REGRESSOR);
        for engine in ENGINES {
            self.batch("forward dynamics", engine, "forward_dynamics");
            let ours = self.figures.least("poinsot_batch_rk4_10ms_step", "ns_min");
            if let (Some(peer), Some(ours)) = (self.simulated(engine), ours) {
                let times = STEP_NS / ours / peer;
                println!(
                    "batch: Runge-Kutta at 10 ms against {engine}, a vehicle: {times:.2} times as fast"
                );
            }
        }
    }

    fn batch(&self, what: &str, engine: &str, name: &str) {
        let (ours, peer) = (format!("poinsot_batch_{name}"), format!("{engine}_{name}"));
        self.figures.ratio(
            &format!("batch: {what} against {engine}"),
            (&ours, "ns_min"),
            (&peer, "ns_min"),
        );
    }

    fn ratios_of_numpy(&self) {
        let samples = self.samples;
        let what = format!("least squares, {samples} samples, processor time, one thread");
        let ours = format!("poinsot_least_squares_{samples}_samples_1_threads_processor");
        let peer = format!("numpy_least_squares_{samples}_samples_processor");
        self.figures.ratio(&what, (&ours, "s"), (&peer, "s"));
        for part in ["objective", "iteration"] {
            let what = format!("swarm {part}, 50 particles x 600 samples, one thread");
            let (ours, peer) = (
                format!("poinsot_swarm_{part}_50x600"),
                format!("numpy_swarm_{part}_50x600"),
            );
            self.figures.ratio(&what, (&ours, "us"), (&peer, "us"));
        }
    }
}
