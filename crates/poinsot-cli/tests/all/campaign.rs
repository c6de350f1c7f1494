//! `poinsot campaign` and `poinsot sweep` run by a user and a scheduler: killed, out of disk, in shares.
//!
//! `POINSOT_KILLS=200` kills that many processes (docs/validation/shards.md); otherwise a few.
#![cfg(target_os = "linux")]

use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};
use tempfile::TempDir;

const KILLS: u64 = 8;

fn repository(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../..")
        .join(path)
}

/// A folder with a plan of cheap trials.
fn bench(trials: u64, block: u64) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    for name in ["tug_thrusters.toml", "tug_truth.toml"] {
        std::fs::copy(
            repository("data/cases").join(name),
            folder.path().join(name),
        )
        .unwrap();
    }
    let plan = format!(
        "schema = \"poinsot.plan/1\"\nname = \"small\"\ntrials = {trials}\ntrials_per_shard = {block}\n\n\
         [[experiment]]\ncase = \"tug_thrusters.toml\"\nevery = 20\n\n[[vary]]\nnumber = \"noise\"\nvalues = [1.0, 2.0]\n"
    );
    std::fs::write(folder.path().join("plan.toml"), plan).unwrap();
    folder
}

fn poinsot(bench: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_poinsot"));
    command.current_dir(bench).args(arguments);
    command.stdout(Stdio::piped()).stderr(Stdio::piped());
    command
}

fn run(bench: &Path, arguments: &[&str]) -> Output {
    poinsot(bench, arguments).output().unwrap()
}

#[track_caller]
fn succeeded(output: &Output) {
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{}: {said}", output.status);
}

/// The result without times, which differ between runs.
fn result(out: &Path) -> Value {
    let text = std::fs::read_to_string(out.join("campaign.json")).unwrap();
    let mut value: Value = serde_json::from_str(&text).unwrap();
    for cell in value["cells"].as_array_mut().unwrap() {
        for method in cell["methods"].as_array_mut().unwrap() {
            method["seconds_per_trial"] = Value::Null;
        }
    }
    value.as_object_mut().unwrap().remove("sha256");
    value
}

fn undisturbed(bench: &Path) -> Value {
    succeeded(&run(
        bench,
        &["campaign", "plan.toml", "--out", "whole", "--quiet"],
    ));
    result(&bench.join("whole"))
}

fn kill(child: &mut Child) {
    child.kill().unwrap();
    child.wait().unwrap();
}

#[test]
fn cli_workers_that_are_killed_lose_nothing_and_count_nothing_twice() {
    let kills = std::env::var("POINSOT_KILLS")
        .ok()
        .and_then(|n| n.parse().ok())
        .unwrap_or(KILLS);
    // About one shard in two is finished between kills, so that work remains until the last.
    let bench = bench((kills * 4).max(32), 4);
    let bench = bench.path();
    let whole = undisturbed(bench);
    let start = Instant::now();
    let alone = [
        "campaign",
        "plan.toml",
        "--out",
        "one",
        "--trials",
        "4",
        "--quiet",
    ];
    succeeded(&run(bench, &alone));
    let two_shards = start.elapsed().as_millis() as u64;
    let mut done = 0;
    for k in 0..kills {
        let mut child = poinsot(
            bench,
            &[
                "campaign",
                "plan.toml",
                "--out",
                "killed",
                "--resume",
                "--quiet",
            ],
        )
        .spawn()
        .unwrap();
        // Multiples of the golden ratio: spread over the duration of two shards, equal in every run.
        let share = (k as f64 * 0.618_033_988_75).fract();
        std::thread::sleep(Duration::from_millis(
            (share * 1.5 * two_shards as f64) as u64,
        ));
        if child.try_wait().unwrap().is_none() {
            kill(&mut child);
            done += 1;
        }
    }
    println!("{done} of {kills} processes were killed at work");
    assert!(done > 0);
    succeeded(&run(
        bench,
        &[
            "campaign",
            "plan.toml",
            "--out",
            "killed",
            "--resume",
            "--quiet",
        ],
    ));
    assert_eq!(result(&bench.join("killed")), whole);
    // The draft of the last killed process may be too recent to be removed; the next run removes it (poinsot-files,
    // stage).
}

/// Child processes, from the system's list.
fn children(parent: u32) -> Vec<u32> {
    let tasks = std::fs::read_dir(format!("/proc/{parent}/task"));
    let tasks = tasks.into_iter().flatten().flatten();
    let texts = tasks.filter_map(|task| std::fs::read_to_string(task.path().join("children")).ok());
    let all: Vec<String> = texts.collect();
    let words = all.iter().flat_map(|text| text.split_whitespace());
    words.filter_map(|p| p.parse().ok()).collect()
}

#[test]
fn cli_a_process_that_is_killed_is_named_and_started_again() {
    let bench = bench(48, 4);
    let bench = bench.path();
    let whole = undisturbed(bench);
    let arguments = ["campaign", "plan.toml", "--out", "many", "--processes", "2"];
    let driver = poinsot(bench, &arguments).spawn().unwrap();
    let begun = Instant::now();
    let victim = loop {
        if let Some(child) = children(driver.id()).first() {
            break *child;
        }
        assert!(
            begun.elapsed() < Duration::from_secs(20),
            "no process was started"
        );
    };
    let killed = Command::new("kill")
        .args(["-9", &victim.to_string()])
        .status()
        .unwrap();
    assert!(killed.success());
    let output = driver.wait_with_output().unwrap();
    succeeded(&output);
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(
        said.contains("signal: 9") && said.contains("it is restarted"),
        "{said}"
    );
    assert_eq!(result(&bench.join("many")), whole);
}

#[test]
fn cli_a_driver_that_is_killed_is_resumed() {
    let bench = bench(40, 4);
    let bench = bench.path();
    let whole = undisturbed(bench);
    let arguments = [
        "campaign",
        "plan.toml",
        "--out",
        "many",
        "--processes",
        "2",
        "--quiet",
    ];
    let mut driver = poinsot(bench, &arguments).spawn().unwrap();
    std::thread::sleep(Duration::from_millis(300));
    let orphans = children(driver.id());
    kill(&mut driver);
    // The orphaned processes write the same shards as the next driver: nothing is counted twice.
    succeeded(&run(
        bench,
        &[
            "campaign",
            "plan.toml",
            "--out",
            "many",
            "--resume",
            "--quiet",
        ],
    ));
    assert_eq!(result(&bench.join("many")), whole);
    for orphan in orphans {
        let _ = Command::new("kill")
            .args(["-9", &orphan.to_string()])
            .status();
    }
}

#[test]
fn cli_a_full_disk_ends_with_exit_code_3_and_is_resumed() {
    let bench = bench(16, 4);
    let bench = bench.path();
    let whole = undisturbed(bench);
    // No file may exceed 8 blocks of 512 bytes; the rows do.
    let script = format!(
        "ulimit -f 8; exec '{}' campaign plan.toml --out full",
        env!("CARGO_BIN_EXE_poinsot")
    );
    let output = Command::new("sh")
        .current_dir(bench)
        .args(["-c", &script])
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(3), "{said}");
    assert!(said.starts_with("E0002 full/shards/000000/"), "{said}");
    assert!(!bench.join("full/campaign.json").exists());
    succeeded(&run(
        bench,
        &[
            "campaign",
            "plan.toml",
            "--out",
            "full",
            "--resume",
            "--quiet",
        ],
    ));
    assert_eq!(result(&bench.join("full")), whole);
}

#[test]
fn cli_shares_are_merged_to_the_bits_of_one_run() {
    let bench = bench(16, 4);
    let bench = bench.path();
    let whole = undisturbed(bench);
    for share in ["3/3", "1/3"] {
        succeeded(&run(
            bench,
            &["campaign", "plan.toml", "--out", "a", "--shard", share],
        ));
    }
    let gap = run(bench, &["campaign", "plan.toml", "--out", "a", "--merge"]);
    assert_eq!(gap.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&gap.stderr).starts_with("E0603"));
    let partial = run(
        bench,
        &[
            "campaign",
            "plan.toml",
            "--out",
            "a",
            "--merge",
            "--partial",
        ],
    );
    assert_eq!(partial.status.code(), Some(1));
    succeeded(&run(
        bench,
        &["campaign", "plan.toml", "--out", "b", "--shard", "2/3"],
    ));
    succeeded(&run(
        bench,
        &["campaign", "plan.toml", "--out", "a", "--merge", "b"],
    ));
    assert_eq!(result(&bench.join("a")), whole);
}

/// The scripts of an array, run by a substitute for `sbatch` that runs every task at once, and checked by shellcheck
/// if installed.
#[test]
fn cli_scripts_for_slurm_run_the_campaign() {
    let bench = bench(16, 4);
    let bench = bench.path();
    let whole = undisturbed(bench);
    succeeded(&run(
        bench,
        &["campaign", "plan.toml", "--out", "it's", "--emit", "slurm"],
    ));
    let folder = bench.join("it's/slurm");
    let scripts = ["campaign.sbatch", "merge.sbatch", "submit.sh"].map(|n| folder.join(n));
    match Command::new("shellcheck").args(&scripts).output() {
        Ok(checked) => assert!(
            checked.status.success(),
            "{}",
            String::from_utf8_lossy(&checked.stdout)
        ),
        Err(_) => println!("shellcheck is not installed"),
    }
    let bin = bench.join("bin");
    std::fs::create_dir(&bin).unwrap();
    let program = env!("CARGO_BIN_EXE_poinsot");
    std::fs::write(
        bin.join("poinsot"),
        format!("#!/bin/sh\nexec '{program}' \"$@\"\n"),
    )
    .unwrap();
    std::fs::write(bin.join("sbatch"), SBATCH).unwrap();
    for name in ["poinsot", "sbatch"] {
        let done = Command::new("chmod")
            .arg("+x")
            .arg(bin.join(name))
            .status()
            .unwrap();
        assert!(done.success());
    }
    let path = format!("{}:{}", bin.display(), std::env::var("PATH").unwrap());
    let output = Command::new("sh")
        .arg(&scripts[2])
        .env("PATH", path)
        .output()
        .unwrap();
    succeeded(&output);
    assert_eq!(result(&bench.join("it's")), whole);
}

/// Substitute for `sbatch`: runs the tasks of an array one after the other, the second twice, as after a requeue.
const SBATCH: &str = r#"#!/bin/sh
set -eu
for script in "$@"; do :; done
tasks=$(sed -n 's/^#SBATCH --array=1-//p' "$script")
if [ -z "$tasks" ]; then sh "$script" >&2; echo 2; exit; fi
k=1
while [ "$k" -le "$tasks" ]; do
    SLURM_ARRAY_TASK_ID=$k sh "$script" >&2
    [ "$k" -ne 2 ] || SLURM_ARRAY_TASK_ID=$k sh "$script" >&2
    k=$((k + 1))
done
echo 1
"#;

#[test]
fn cli_a_campaign_says_what_it_costs_and_what_it_found() {
    let bench = bench(8, 4);
    let bench = bench.path();
    let cost = run(bench, &["campaign", "plan.toml", "--estimate"]);
    succeeded(&cost);
    let text = String::from_utf8_lossy(&cost.stdout).into_owned();
    for word in [
        "16 this plan",
        "1000000000",
        "core-hours",
        "a shard of 10 to 120 s has",
    ] {
        assert!(text.contains(word), "{word}: {text}");
    }
    let output = run(bench, &["campaign", "plan.toml", "--out", "c", "--follow"]);
    succeeded(&output);
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    for word in [
        "small: 16 fits (2 cells, 1 method, 8 trials of each)",
        "interval, noise=2",
        "coverage %",
    ] {
        assert!(text.contains(word), "{word}: {text}");
    }
    let page = std::fs::read_to_string(bench.join("c/campaign.html")).unwrap();
    assert!(
        page.contains("error of bus.mass_kg")
            && page.contains("every number with its 95 % interval")
    );
    assert!(
        bench.join("c/shards/000000").read_dir().unwrap().any(|f| f
            .unwrap()
            .path()
            .extension()
            .unwrap()
            == "parquet")
    );
}

#[test]
fn cli_until_stops_at_a_complete_look() {
    let folder = tempfile::tempdir().unwrap();
    let bench = folder.path();
    for name in ["pyramid.toml", "pyramid_truth.toml"] {
        std::fs::copy(repository("data/cases").join(name), bench.join(name)).unwrap();
    }
    let plan = "schema = \"poinsot.plan/1\"\ntrials = 2500\n\n[[experiment]]\ncase = \"pyramid.toml\"\nevery = 25\n\n\
         [[method]]\nname = \"linear\"\n";
    std::fs::write(bench.join("plan.toml"), plan).unwrap();
    // The first test is after 1000 trials, which suffice for such a wide interval.
    let words = [
        "campaign",
        "plan.toml",
        "--out",
        "u",
        "--until",
        "coverage=20%",
        "--json",
    ];
    let output = run(bench, &words);
    succeeded(&output);
    let found: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(
        (&found["trials"], &found["planned"]),
        (&1000.into(), &2500.into())
    );
    let number = &found["cells"][0]["methods"][0]["numbers"]["bus.inertia_kg_m2.xx"];
    assert_eq!(number["trials"], 1000);
    let shards = std::fs::read_dir(bench.join("u/shards/000000")).unwrap();
    assert_eq!(shards.count(), 20, "ten shards with their rows");
}

#[test]
fn cli_a_sweep_is_a_campaign_of_one_case() {
    let bench = bench(8, 4);
    let bench = bench.path();
    let words = [
        "sweep",
        "tug_thrusters.toml",
        "--vary",
        "output.rate_hz=2,4",
        "--vary",
        "bus.mass_kg=400:500:2",
        "--method",
        "auto",
        "--method",
        "linear",
        "--trials",
        "4",
        "--out",
        "s",
    ];
    let output = run(bench, &words);
    succeeded(&output);
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(
        text.contains("sweep: 32 fits (4 cells, 2 methods, 4 trials of each)"),
        "{text}"
    );
    assert!(text.contains("output.rate_hz=2"), "{text}");
    for (more, says) in [
        (["--vary", "bus.mas_kg=1"], "E0542"),
        (
            ["--set", "particles=3"],
            "E0001 --set 'particles=3': no method of this sweep has this setting",
        ),
    ] {
        let refused = run(bench, &[&words[..2], &more[..]].concat());
        let said = String::from_utf8_lossy(&refused.stderr).into_owned();
        assert_eq!(refused.status.code(), Some(2), "{said}");
        assert!(said.contains(says), "{said}");
    }
}
