//! How long a fit takes, beside MuJoCo's identification toolbox.

use super::figures::{Figures, significant};
use super::machine::variable;
use crate::fault::Fault;
use crate::repository::{cargo, root, scratch, stdout_of, succeed};
use std::path::Path;
use std::process::Command;

/// Samples of the longest record.
pub const SAMPLES: u64 = 100_000;
const LENGTHS: [u64; 4] = [1_000, 10_000, 100_000, 1_000_000];
const PEER: &str = "benches/peers/mujoco_sysid.py";
/// What is compared: words, our figure, the peer's.
const RATIOS: [(&str, &str, &str); 3] = [
    (
        "payload, on the clock",
        "poinsot_payload",
        "mujoco_sysid_exact_torque",
    ),
    (
        "payload, processor time",
        "poinsot_payload_processor",
        "mujoco_sysid_exact_torque_processor",
    ),
    (
        "a trial of a campaign, without diagnosis",
        "poinsot_payload_trial_processor",
        "mujoco_sysid_exact_torque_processor",
    ),
];

/// Measures records of up to so many samples, and the payload with the peer where it is found.
pub fn run(most: u64) -> Result<(), Fault> {
    let work = scratch()?;
    succeed(&mut cargo(&[
        "build",
        "--quiet",
        "--locked",
        "--release",
        "--workspace",
        "--example",
        "fit_speed",
    ]))?;
    let mut figures = Figures::default();
    println!("name,value,unit");
    if let Some(python) = variable("POINSOT_BENCH_SYSID") {
        beside_peer(&mut figures, &python, work.path())?;
    }
    for samples in LENGTHS.into_iter().filter(|samples| *samples <= most) {
        figures.show(&stdout_of(ours().arg("growth").arg(samples.to_string()))?);
    }
    println!();
    for (what, ours, peer) in RATIOS {
        if let (Some(ours), Some(peer)) = (figures.least(ours, "s"), figures.least(peer, "s")) {
            println!("{what}: {} times as fast", significant(peer / ours));
        }
    }
    Ok(())
}

/// Ours, peer, ours: what drifts on the machine drifts for both.
fn beside_peer(figures: &mut Figures, python: &str, work: &Path) -> Result<(), Fault> {
    let peer = || {
        let mut command = Command::new(python);
        command.arg(PEER).arg(work).current_dir(root());
        command
    };
    let record = work.join("telemetry.csv");
    succeed(&mut peer())?;
    figures.show(&stdout_of(ours().arg("payload").arg(&record))?);
    figures.show(&stdout_of(peer().arg("--fit"))?);
    figures.show(&stdout_of(ours().arg("payload").arg(&record))?);
    Ok(())
}

fn ours() -> Command {
    let mut command = Command::new(root().join("target/release/examples/fit_speed"));
    command.current_dir(root());
    command
}
