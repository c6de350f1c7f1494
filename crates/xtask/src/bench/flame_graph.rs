//! A flame graph of fits of the payload, one thread.

use super::machine::variable;
use crate::fault::Fault;
use crate::repository::{
    cannot_start, cargo, failed, on_path, pattern, root, scratch, stdout_of, succeed, write,
};
use std::path::Path;
use std::process::{Command, Stdio};

/// The frames of an evaluation are large: perf copies up to 64 kB of stack.
const STACKS: &str = "dwarf,65000";
/// Samples a second; more and perf loses some.
const RATE: &str = "700";
/// Parts of names that say nothing: generic parameters, closures, our crates, libraries, gaps.
const CUT: [(&str, &str); 5] = [
    (r"<[^;>]*(<[^;>]*>)?[^;>]*>", ""),
    (r"::\{\{closure\}\}", ""),
    (r"poinsot_(identify|solve|dynamics)::", ""),
    (r";(rayon|std|core)::[^;]*", ""),
    (r"::::", "::"),
];
/// Stacks are drawn from here on.
const FIRST: &str = "methods::maximum_likelihood::maximum_likelihood;";
const LOOK: [&str; 8] = [
    "--title",
    "Processor time of one fit with its diagnosis",
    "--width",
    "1000",
    "--minwidth",
    "0.4",
    "--deterministic",
    "--no-javascript",
];

/// Records fits with perf and writes the graph.
pub fn run(out: &Path) -> Result<(), Fault> {
    let programs = [
        ("perf", "perf"),
        ("inferno-flamegraph", "inferno: cargo install inferno"),
    ];
    if let Some((_, needed)) = programs.iter().find(|(program, _)| !on_path(program)) {
        return Err(Fault::Use(format!("needs {needed}")));
    }
    let work = scratch()?;
    let data = work.path().join("perf.data");
    succeed(&mut cargo(&[
        "build",
        "--quiet",
        "--locked",
        "--release",
        "--workspace",
        "--example",
        "fit_speed",
    ]))?;
    let python = variable("POINSOT_BENCH_SYSID").unwrap_or_else(|| "python3".to_owned());
    let mut record = Command::new(python);
    record
        .arg("benches/peers/mujoco_sysid.py")
        .arg(work.path())
        .stdout(Stdio::null())
        .current_dir(root());
    succeed(&mut record)?;
    let mut perf = Command::new("perf");
    perf.args(["record", "--quiet", "--output"])
        .arg(&data)
        .args(["--call-graph", STACKS, "--freq", RATE]);
    perf.args(["target/release/examples/fit_speed", "payload"])
        .arg(work.path().join("telemetry.csv"));
    succeed(
        perf.env("RAYON_NUM_THREADS", "1")
            .stdout(Stdio::null())
            .current_dir(root()),
    )?;
    let stacks = work.path().join("stacks");
    write(&stacks, of_fit(&collapsed(&data)?)?)?;
    write(
        &root().join(out),
        stdout_of(Command::new("inferno-flamegraph").args(LOOK).arg(&stacks))?,
    )
}

/// Stacks of the record, one a line.
fn collapsed(data: &Path) -> Result<String, Fault> {
    let mut script = Command::new("perf");
    script
        .args(["script", "--input"])
        .arg(data)
        .stdout(Stdio::piped())
        .stderr(Stdio::null());
    let mut running = script.spawn().map_err(|why| cannot_start(&script, &why))?;
    let mut collapse = Command::new("inferno-collapse-perf");
    if let Some(output) = running.stdout.take() {
        collapse.stdin(output);
    }
    let stacks = stdout_of(&mut collapse)?;
    let ended = running.wait().map_err(|why| cannot_start(&script, &why))?;
    ended
        .success()
        .then_some(stacks)
        .ok_or_else(|| failed(&script, ended))
}

/// Stacks from the maximum-likelihood method on, with short names.
fn of_fit(stacks: &str) -> Result<String, Fault> {
    let mut text = stacks.to_owned();
    for (from, to) in CUT {
        text = pattern(from)?.replace_all(&text, to).into_owned();
    }
    let marker = format!(";{FIRST}");
    let lines = text
        .lines()
        .filter_map(|line| Some(&line[line.rfind(&marker)? + 1..]));
    Ok(lines.map(|line| format!("{line}\n")).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unit_stacks_are_cut_to_the_fit() {
        let stacks = "fit_speed;main;poinsot_identify::methods::maximum_likelihood::maximum_likelihood;poinsot_solve::qr<f64>;\
                      rayon::join;core::ops::f::{{closure}};a::{{closure}} 7\nmain;b 3\n";
        let expected = "methods::maximum_likelihood::maximum_likelihood;qr;a 7\n";
        assert_eq!(of_fit(stacks).unwrap(), expected);
    }
}
