//! How long reading takes, beside pyarrow and polars.

use super::figures::Figures;
use super::machine::variable;
use crate::fault::Fault;
use crate::repository::{cargo, root, scratch, stdout_of, succeed};
use std::path::Path;
use std::process::Command;

/// Rows: a CSV file of 231 MB, which is read in about a second.
pub const ROWS: u64 = 400_000;
const PEERS: &str = "benches/peers/reading.py";

/// Writes a table and reads it with each program.
pub fn run(rows: u64) -> Result<(), Fault> {
    let python = variable("POINSOT_BENCH_PYTHON").unwrap_or_else(|| "python3".to_owned());
    let work = scratch()?;
    succeed(&mut cargo(&[
        "build",
        "--quiet",
        "--locked",
        "--release",
        "--workspace",
        "--example",
        "read_speed",
    ]))?;
    let peers = |more: &[&str]| {
        let mut command = Command::new(&python);
        command
            .arg(PEERS)
            .arg(work.path())
            .args(more)
            .current_dir(root());
        command
    };
    succeed(&mut peers(&["--write", &rows.to_string()]))?;
    let mut figures = Figures::default();
    println!("name,value,unit");
    // Ours, peers, ours: what drifts on the machine drifts for both.
    figures.show(&stdout_of(&mut ours(work.path()))?);
    figures.show(&stdout_of(&mut peers(&[]))?);
    figures.show(&stdout_of(&mut ours(work.path()))?);
    println!();
    for kind in ["csv", "parquet"] {
        for peer in ["pyarrow", "polars"] {
            ratio(&figures, kind, peer);
        }
    }
    Ok(())
}

fn ours(work: &Path) -> Command {
    let mut command = Command::new(root().join("target/release/examples/read_speed"));
    command
        .args([work.join("table.csv"), work.join("table.parquet")])
        .current_dir(root());
    command
}

fn ratio(figures: &Figures, kind: &str, name: &str) {
    let least = |name: String| figures.least(&name, "s");
    let ours = least(format!("poinsot_read_{kind}"));
    let (peer, hash) = (
        least(format!("{name}_read_{kind}")),
        least(format!("hash_{kind}")),
    );
    if let (Some(ours), Some(peer), Some(hash)) = (ours, peer, hash) {
        let times = (peer + hash) / ours;
        println!(
            "{kind}: ours with hash {ours:.3} s, {name} {peer:.3} s, its hash {hash:.3} s: {times:.2} times as fast"
        );
    }
}
