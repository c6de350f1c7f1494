//! Instructions, counted by valgrind, and their record.

use super::machine::single;
use crate::fault::Fault;
use crate::repository::{cannot_start, cargo, read, root, scratch, succeed, write};
use std::collections::HashMap;
use std::path::Path;
use std::process::Command;

const RECORD: &str = "benches/instructions.csv";
/// More by 15 % is a fault: counts of one program differ by less between machines. Fewer are a reason to record.
const MOST_GROWTH: f64 = 1.15;
/// Instructions of one call are the difference of two run lengths.
const FEW_CALLS: u64 = 100;
const MANY_CALLS: u64 = 1100;
/// The record of flight that is identified.
const MODEL: &str = "data/stsat3/model.toml";
const TELEMETRY: &str = "data/stsat3/multiaxis/telemetry_noisy.csv";

/// Name and instructions.
pub type Count = (String, u64);

/// Instructions that valgrind counts for a run.
fn collected(run: &Command) -> Result<u64, Fault> {
    let mut valgrind = single(Path::new("valgrind"));
    valgrind
        .args(["--tool=callgrind", "--callgrind-out-file=/dev/null"])
        .arg(run.get_program())
        .args(run.get_args());
    for (name, value) in run.get_envs() {
        valgrind.env(name, value.unwrap_or_default());
    }
    let output = valgrind
        .output()
        .map_err(|why| cannot_start(&valgrind, &why))?;
    let said = String::from_utf8_lossy(&output.stderr);
    count_in(&said).ok_or_else(|| Fault::Failed(format!("valgrind: no line 'Collected :'\n{said}")))
}

fn count_in(said: &str) -> Option<u64> {
    said.lines()
        .find_map(|line| line.split_once("Collected : ")?.1.trim().parse().ok())
}

/// Instructions of one call of a benchmark; the variable says which one and how often.
pub fn of_call(name: &str, variable: &str, prefix: &str, program: &Path) -> Result<Count, Fault> {
    let counted =
        |calls: u64| collected(single(program).env(variable, format!("{prefix}:{calls}")));
    let (few, many) = (counted(FEW_CALLS)?, counted(MANY_CALLS)?);
    Ok((
        name.to_owned(),
        many.saturating_sub(few) / (MANY_CALLS - FEW_CALLS),
    ))
}

/// Our kernels.
pub fn of_kernels(figures: &Path, dynamics: &Path) -> Result<Vec<Count>, Fault> {
    let ours = |name: &str, program| {
        of_call(
            &format!("poinsot_{name}"),
            "POINSOT_BENCH_COUNT",
            name,
            program,
        )
    };
    Ok(vec![
        ours("momentum_regressor_6x70", figures)?,
        ours("forward_dynamics", dynamics)?,
        ours("sim_rk4_10ms", dynamics)?,
    ])
}

/// One identification of a shipped record, with reading, diagnosis and writing.
fn of_identification() -> Result<Count, Fault> {
    succeed(&mut cargo(&[
        "build",
        "--quiet",
        "--locked",
        "--release",
        "--workspace",
        "--bin",
        "poinsot",
    ]))?;
    let out = scratch()?;
    let mut run = Command::new(root().join("target/release/poinsot"));
    run.args([
        "identify",
        "--quiet",
        "--model",
        MODEL,
        "--telemetry",
        TELEMETRY,
        "--out",
    ]);
    run.arg(out.path().join("answer"))
        .env("RAYON_NUM_THREADS", "1");
    Ok((
        "poinsot_identify_stsat3_multiaxis".to_owned(),
        collected(&run)?,
    ))
}

/// Counts as lines of `name,value,unit`.
pub fn lines(counts: &[Count]) -> String {
    counts
        .iter()
        .map(|(name, count)| format!("{name},{count},instructions\n"))
        .collect()
}

/// Counts kernels and one identification; writes them, or compares them with what is written.
pub fn run(record: bool, figures: &Path, dynamics: &Path) -> Result<(), Fault> {
    let mut counts = of_kernels(figures, dynamics)?;
    counts.push(of_identification()?);
    let path = root().join(RECORD);
    if record {
        print!("{}", lines(&counts));
        return write(&path, lines(&counts));
    }
    let before = read(&path)?;
    let (said, worse) = compared(&counts, &before)?;
    print!("{said}");
    // The lines above say which count has grown.
    (!worse).then_some(()).ok_or(Fault::Ended(1))
}

/// A line for each count, and whether one has grown by too much.
fn compared(counts: &[Count], record: &str) -> Result<(String, bool), Fault> {
    let recorded = record.lines().filter_map(|line| {
        let mut parts = line.split(',');
        Some((parts.next()?, parts.next()?.parse::<f64>().ok()?))
    });
    let recorded: HashMap<_, _> = recorded.collect();
    let (mut said, mut worse) = (String::new(), false);
    for (name, count) in counts {
        let before = recorded.get(name.as_str()).ok_or_else(|| {
            Fault::Failed(format!(
                "{RECORD}: no line for {name}; write it with scripts/bench record"
            ))
        })?;
        let growth = *count as f64 / before;
        said += &format!(
            "{name}: {count} instructions, {:+.1} % against the record\n",
            100.0 * (growth - 1.0)
        );
        worse |= growth > MOST_GROWTH;
    }
    Ok((said, worse))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unit_counts_are_read_and_compared() {
        assert_eq!(
            count_in("==1== Events : Ir\n==1== Collected : 1234\n"),
            Some(1234)
        );
        let record = "a,1000,instructions\nb,1000,instructions\n";
        let (said, worse) =
            compared(&[("a".to_owned(), 1150), ("b".to_owned(), 900)], record).unwrap();
        assert!(!worse);
        assert_eq!(
            said.lines().last(),
            Some("b: 900 instructions, -10.0 % against the record")
        );
        assert!(compared(&[("a".to_owned(), 1151)], record).unwrap().1);
        assert!(compared(&[("c".to_owned(), 1)], record).is_err());
    }
}
