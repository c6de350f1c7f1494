//! Full disk, disk errors, a kill at every call that changes a file, closed and full standard output.
#![cfg(target_os = "linux")]

use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

fn example(path: &str) -> String {
    let shipped = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data");
    shipped.join(path).display().to_string()
}

fn poinsot(arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_poinsot"));
    command.args(arguments).stdin(Stdio::null());
    command
}

fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// The library that makes the n-th call fail. The tests need a C compiler, as CONTRIBUTING says.
fn shim(folder: &Path) -> PathBuf {
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/all/environment/faults.c");
    let library = folder.join("faults.so");
    let compiled = Command::new("cc")
        .args(["-shared", "-fPIC", "-O1", "-o"])
        .arg(&library)
        .arg(&source)
        .arg("-ldl")
        .status();
    assert!(
        compiled.is_ok_and(|s| s.success()),
        "the C compiler `cc` does not run, or cannot build {}",
        source.display()
    );
    library
}

/// A command that writes, and its files.
struct Question {
    arguments: Vec<String>,
    /// What `--out` names.
    out: &'static str,
    files: &'static [&'static str],
}

/// The first rows of a record: the same write calls, with short runs.
fn short_record() -> String {
    static FOLDER: std::sync::OnceLock<tempfile::TempDir> = std::sync::OnceLock::new();
    let folder = FOLDER.get_or_init(|| {
        let folder = tempfile::tempdir().unwrap();
        let whole =
            std::fs::read_to_string(example("stsat3/multiaxis/telemetry_noisy.csv")).unwrap();
        let rows: Vec<&str> = whole.lines().take(300).collect();
        std::fs::write(folder.path().join("t.csv"), rows.join("\n") + "\n").unwrap();
        folder
    });
    folder.path().join("t.csv").display().to_string()
}

fn identify() -> Question {
    let arguments = [
        "identify",
        "--model",
        &example("stsat3/model.toml"),
        "--telemetry",
        &short_record(),
        "--method",
        "linear",
        "--report",
        "--quiet",
    ];
    Question {
        arguments: arguments.map(str::to_owned).to_vec(),
        out: "out",
        files: &["estimate.json", "report_data.json", "report.html"],
    }
}

fn simulate() -> Question {
    let arguments = ["simulate", &example("cases/stsat3_spin.toml"), "--quiet"];
    Question {
        arguments: arguments.map(str::to_owned).to_vec(),
        out: "out",
        files: &["telemetry.csv", "truth.json"],
    }
}

/// An answer of `identify`, written once.
fn answer() -> String {
    static FOLDER: std::sync::OnceLock<tempfile::TempDir> = std::sync::OnceLock::new();
    let folder = FOLDER.get_or_init(|| {
        let folder = tempfile::tempdir().unwrap();
        good(&identify(), folder.path());
        folder
    });
    folder.path().join("out").display().to_string()
}

fn export() -> Question {
    let arguments = ["export", &answer(), "--to", "csv", "--accept-unreliable"];
    Question {
        arguments: arguments.map(str::to_owned).to_vec(),
        out: "out/numbers.csv",
        files: &["numbers.csv"],
    }
}

/// Two trials of a small box.
fn campaign() -> Question {
    let plan = Path::new(env!("CARGO_MANIFEST_DIR")).join("../poinsot/doc/plan.toml");
    let plan = plan.display().to_string();
    let arguments = ["campaign", &plan, "--trials", "2", "--quiet"];
    Question {
        arguments: arguments.map(str::to_owned).to_vec(),
        out: "out",
        files: &["campaign.json", "campaign.html"],
    }
}

/// The bytes written by a run without failure, independent of the folder's name.
fn good(question: &Question, folder: &Path) -> Vec<Vec<u8>> {
    let done = run(question, folder, |_| {});
    assert!(
        done.status.code().is_some_and(|c| c <= 1),
        "{}",
        stderr(&done)
    );
    contents(question, folder)
        .into_iter()
        .map(Option::unwrap)
        .collect()
}

fn run(question: &Question, folder: &Path, change: impl FnOnce(&mut Command)) -> Output {
    let arguments: Vec<&str> = question.arguments.iter().map(String::as_str).collect();
    let mut command = poinsot(&arguments);
    // A relative name, because the command line is in the result.
    command.args(["--out", question.out]).current_dir(folder);
    command.env("RAYON_NUM_THREADS", "1");
    change(&mut command);
    command.output().unwrap()
}

fn contents(question: &Question, folder: &Path) -> Vec<Option<Vec<u8>>> {
    let read = |name: &&str| std::fs::read(folder.join("out").join(name)).ok();
    question.files.iter().map(read).collect()
}

/// Content of every target before a run, if any.
const EARLIER: &[u8] = b"an earlier answer";

#[derive(Clone, Copy)]
struct Failure {
    how: &'static str,
    /// Whether only one call fails, or all later ones too.
    once: bool,
    /// Whether an earlier result exists.
    earlier: bool,
}

/// Fails every call in turn. Afterwards each file is complete, unchanged or absent, and the exit code is correct.
fn at_every_call(question: &Question, failure: Failure) {
    let workshop = tempfile::tempdir().unwrap();
    let shim = shim(workshop.path());
    let reference = tempfile::tempdir().unwrap();
    let whole = good(question, reference.path());
    let before = failure.earlier.then_some(EARLIER);
    let mut calls = 0;
    for n in 1..10_000 {
        let folder = tempfile::tempdir().unwrap();
        if failure.earlier {
            std::fs::create_dir(folder.path().join("out")).unwrap();
            for name in question.files {
                std::fs::write(folder.path().join("out").join(name), EARLIER).unwrap();
            }
        }
        let fired = workshop.path().join("fired");
        let _ = std::fs::remove_file(&fired);
        let done = run(question, folder.path(), |command| {
            command.env("LD_PRELOAD", &shim);
            command.env("FAULT_AT", n.to_string());
            command.env("FAULT_HOW", failure.how);
            command.env("FAULT_FIRED", &fired);
            if failure.once {
                command.env("FAULT_ONCE", "1");
            }
        });
        let after = After {
            here: contents(question, folder.path()),
            left: left(folder.path()),
            place: format!(
                "call {n}, {}, once {}, earlier {}: {}",
                failure.how,
                failure.once,
                failure.earlier,
                stderr(&done)
            ),
            done,
        };
        if !fired.exists() {
            assert!(after.is(&whole), "{}", after.place);
            calls = n - 1;
            break;
        }
        after.check(question, failure, &whole, before);
    }
    println!(
        "{} {} once={} earlier={}: {calls} calls, each failed in turn",
        question.arguments[0], failure.how, failure.once, failure.earlier
    );
    assert!(calls >= 8, "only {calls} calls were seen");
}

/// Hidden folders left by a run.
fn left(folder: &Path) -> Vec<PathBuf> {
    std::fs::read_dir(folder.join("out"))
        .into_iter()
        .flatten()
        .flatten()
        .map(|e| e.path())
        .filter(|p| {
            p.file_name()
                .is_some_and(|n| n.to_string_lossy().starts_with(".poinsot-"))
        })
        .collect()
}

/// State after a run.
struct After {
    here: Vec<Option<Vec<u8>>>,
    left: Vec<PathBuf>,
    place: String,
    done: Output,
}

impl After {
    fn is(&self, whole: &[Vec<u8>]) -> bool {
        self.here.iter().flatten().eq(whole)
    }

    fn is_unchanged(&self, before: Option<&[u8]>) -> bool {
        self.here.iter().all(|f| f.as_deref() == before)
    }

    fn check(
        &self,
        question: &Question,
        failure: Failure,
        whole: &[Vec<u8>],
        before: Option<&[u8]>,
    ) {
        let place = &self.place;
        for (found, wanted) in self.here.iter().zip(whole) {
            let found = found.as_deref();
            assert!(
                found == before || found == Some(wanted),
                "a partial file: {place}"
            );
        }
        let code = self.done.status.code();
        match failure.how {
            "kill" => {
                assert_eq!(code, None, "{place}");
                // The result is put in place last: if it exists, the others do too.
                let answer = self.here[0].as_deref() == Some(whole[0].as_slice());
                let answer = answer && question.files[0] == "estimate.json";
                assert!(!answer || self.is(whole), "{place}");
                return;
            }
            "enospc" | "eio" if code == Some(3) => {
                assert!(stderr(&self.done).starts_with("E0"), "{place}");
                assert_eq!(stderr(&self.done).lines().count(), 1, "{place}");
                if stderr(&self.done).starts_with("E0004") {
                    self.check_kept();
                    return;
                }
                assert!(self.is_unchanged(before), "files of a failed run: {place}");
            }
            "enospc" | "eio" => {
                // The call was optional: flushing a folder, which some systems do not support.
                assert!(code.is_some_and(|c| c <= 1), "{place}");
                assert!(self.is(whole), "{place}");
            }
            // Interrupted before the commit, or after all files were in place.
            _ => {
                assert!(code.is_none_or(|c| c <= 1), "{place}");
                assert!(self.is_unchanged(before) || self.is(whole), "{place}");
            }
        }
        assert!(self.left.is_empty(), "a temporary file stays: {place}");
    }

    /// Every earlier file is in its place, or in the folder named in the message.
    fn check_kept(&self) {
        let kept: Vec<PathBuf> = std::fs::read_dir(&self.left[0])
            .unwrap()
            .map(|e| e.unwrap().path())
            .filter(|p| std::fs::read(p).is_ok_and(|bytes| bytes == EARLIER))
            .collect();
        let standing = self.here.iter().flatten().filter(|f| *f == EARLIER);
        assert!(
            kept.len() + standing.count() >= self.here.len(),
            "{}",
            self.place
        );
        let name = self.left[0]
            .file_name()
            .unwrap()
            .to_string_lossy()
            .into_owned();
        assert!(self.place.contains(&name), "{}", self.place);
    }
}

const fn failure(how: &'static str, once: bool, earlier: bool) -> Failure {
    Failure { how, once, earlier }
}

#[test]
fn cli_disk_full_at_every_call_of_identify() {
    at_every_call(&identify(), failure("enospc", true, false));
    at_every_call(&identify(), failure("enospc", false, false));
}

#[test]
fn regress_disk_full_at_every_call_keeps_the_earlier_answer() {
    at_every_call(&identify(), failure("enospc", true, true));
    at_every_call(&simulate(), failure("enospc", false, true));
}

#[test]
fn cli_disk_error_at_every_call_of_simulate() {
    at_every_call(&simulate(), failure("eio", true, false));
}

#[test]
fn cli_killed_at_every_call_of_identify() {
    at_every_call(&identify(), failure("kill", true, true));
}

#[test]
fn cli_killed_at_every_call_of_simulate() {
    at_every_call(&simulate(), failure("kill", true, false));
}

#[test]
fn regress_an_interruption_at_any_call_leaves_nothing_behind() {
    for how in ["int", "term", "hup"] {
        at_every_call(&simulate(), failure(how, true, false));
    }
    at_every_call(&identify(), failure("term", true, true));
}

#[test]
fn cli_disk_full_at_every_call_of_export() {
    at_every_call(&export(), failure("enospc", true, false));
    at_every_call(&export(), failure("enospc", false, true));
    at_every_call(&export(), failure("kill", true, true));
}

/// What a campaign says, without its times.
fn statistics(folder: &Path) -> Option<serde_json::Value> {
    let text = std::fs::read(folder.join("out/campaign.json")).ok()?;
    let mut file: serde_json::Value = serde_json::from_slice(&text).expect("a partial file");
    file["sha256"].take();
    file["cells"][0]["methods"][0]["seconds_per_trial"].take();
    Some(file)
}

/// Whatever fails, shards that are there are whole: the campaign resumes to the result of an undisturbed one.
#[test]
fn cli_a_failure_at_any_call_of_a_campaign_is_resumed() {
    let workshop = tempfile::tempdir().unwrap();
    let (shim, fired) = (shim(workshop.path()), workshop.path().join("fired"));
    good(&campaign(), workshop.path());
    let whole = statistics(workshop.path());
    let mut calls = [0; 3];
    for ((how, once), calls) in [("enospc", "1"), ("eio", "1"), ("kill", "")]
        .into_iter()
        .zip(&mut calls)
    {
        for n in 1.. {
            let folder = tempfile::tempdir().unwrap();
            let _ = std::fs::remove_file(&fired);
            let done = run(&campaign(), folder.path(), |command| {
                command.env("LD_PRELOAD", &shim).env("FAULT_FIRED", &fired);
                command.env("FAULT_AT", n.to_string()).env("FAULT_HOW", how);
                command.env("FAULT_ONCE", once);
            });
            if !fired.exists() {
                break;
            }
            *calls = n;
            let place = format!("call {n}, {how}: {}", stderr(&done));
            let expected = match how {
                "kill" => done.status.code().is_none(),
                _ => matches!(done.status.code(), Some(0 | 1 | 3)),
            };
            assert!(expected, "{place}");
            let stands = statistics(folder.path());
            assert!(stands.is_none() || stands == whole, "{place}");
            let again = run(&campaign(), folder.path(), |command| {
                command.arg("--resume");
            });
            assert!(again.status.code().is_some_and(|c| c <= 1), "{place}");
            assert_eq!(statistics(folder.path()), whole, "{place}");
        }
    }
    println!("campaign: {calls:?} calls, each failed in turn");
    assert!(calls.iter().all(|n| *n >= 8), "{calls:?}");
}

/// Failed allocations: the files are whole, earlier ones stay, and the exit code is 3 where the work could not go on.
#[test]
fn cli_a_failed_allocation_loses_nothing() {
    let trials: u64 = std::env::var("POINSOT_TRIALS").map_or(20, |n| n.parse().unwrap());
    let workshop = tempfile::tempdir().unwrap();
    let shim = shim(workshop.path());
    let count = workshop.path().join("allocations");
    for question in [identify(), export(), campaign()] {
        let name = question.arguments[0].clone();
        let reference = tempfile::tempdir().unwrap();
        let done = run(&question, reference.path(), |command| {
            command.env("LD_PRELOAD", &shim).env("ALLOC_COUNT", &count);
        });
        assert!(
            done.status.code().is_some_and(|c| c <= 1),
            "{}",
            stderr(&done)
        );
        let whole: Vec<_> = contents(&question, reference.path());
        let all: u64 = std::fs::read_to_string(&count)
            .unwrap()
            .trim()
            .parse()
            .unwrap();
        let mut ended = std::collections::BTreeMap::<i32, u64>::new();
        for trial in 0..trials {
            // Drawn with a golden ratio: spread evenly over the run.
            let at = 1 + (all as f64 * (trial as f64 * 0.618_033_988_75).fract()) as u64;
            let folder = tempfile::tempdir().unwrap();
            std::fs::create_dir(folder.path().join("out")).unwrap();
            for file in question.files {
                std::fs::write(folder.path().join("out").join(file), EARLIER).unwrap();
            }
            let done = run(&question, folder.path(), |command| {
                command
                    .env("LD_PRELOAD", &shim)
                    .env("ALLOC_AT", at.to_string());
            });
            let place = format!(
                "{name}, allocation {at} of {all}: {:?} {}",
                done.status,
                stderr(&done)
            );
            let code = done.status.code().unwrap_or(-1);
            assert!(matches!(code, 0 | 1 | 3), "{place}");
            *ended.entry(code).or_default() += 1;
            let after = contents(&question, folder.path());
            let earlier = |file: &Option<Vec<u8>>| file.as_deref() == Some(EARLIER);
            match name.as_str() {
                // Its times differ.
                "campaign" => assert!(
                    earlier(&after[0]) || statistics(folder.path()) == statistics(reference.path()),
                    "{place}"
                ),
                _ => assert!(after.iter().all(earlier) || after == whole, "{place}"),
            }
        }
        println!("{name}: of {all} allocations {trials} failed; by exit code {ended:?}");
    }
}

/// A program told to ignore a signal continues.
#[test]
fn cli_nohup_is_obeyed() {
    let folder = tempfile::tempdir().unwrap();
    let shim = shim(folder.path());
    let done = Command::new("sh")
        .args([
            "-c",
            "trap '' HUP; exec \"$@\"",
            "sh",
            env!("CARGO_BIN_EXE_poinsot"),
        ])
        .args(simulate().arguments)
        .args(["--out", "out"])
        .envs([("FAULT_AT", "5"), ("FAULT_HOW", "hup"), ("FAULT_ONCE", "1")])
        .env("LD_PRELOAD", &shim)
        .current_dir(folder.path())
        .output()
        .unwrap();
    assert_eq!(done.status.code(), Some(0), "{}", stderr(&done));
    assert!(
        contents(&simulate(), folder.path())
            .iter()
            .all(Option::is_some)
    );
}

/// An obstacle is found before anything is replaced.
#[test]
fn regress_what_stands_in_the_way_keeps_the_earlier_answer() {
    let question = identify();
    for (in_the_way, is_folder, option) in [
        ("report.html", true, &[][..]),
        ("figures", false, &["--figures", "svg"][..]),
    ] {
        let folder = tempfile::tempdir().unwrap();
        let out = folder.path().join("out");
        std::fs::create_dir(&out).unwrap();
        for name in ["estimate.json", "report_data.json"] {
            std::fs::write(out.join(name), EARLIER).unwrap();
        }
        match is_folder {
            true => std::fs::create_dir(out.join(in_the_way)).unwrap(),
            false => std::fs::write(out.join(in_the_way), "").unwrap(),
        }
        let done = run(&question, folder.path(), |command| {
            command.args(option);
        });
        assert_eq!(done.status.code(), Some(3), "{}", stderr(&done));
        let said = format!("E0002 out/{in_the_way}: ");
        assert!(stderr(&done).starts_with(&said), "{}", stderr(&done));
        for name in ["estimate.json", "report_data.json"] {
            assert_eq!(std::fs::read(out.join(name)).unwrap(), EARLIER, "{name}");
        }
    }
}

#[test]
fn regress_a_file_size_limit_is_an_error_of_the_environment() {
    let folder = tempfile::tempdir().unwrap();
    let script = "ulimit -f 8; exec \"$@\"";
    let done = Command::new("sh")
        .args(["-c", script, "sh", env!("CARGO_BIN_EXE_poinsot")])
        .args(identify().arguments)
        .args(["--out", "out"])
        .current_dir(folder.path())
        .output()
        .unwrap();
    assert_eq!(done.status.code(), Some(3), "{}", stderr(&done));
    assert!(stderr(&done).starts_with("E0002 out/"), "{}", stderr(&done));
    assert!(
        contents(&identify(), folder.path())
            .iter()
            .all(Option::is_none)
    );
}

#[test]
fn regress_threads_are_at_most_the_cores() {
    let folder = tempfile::tempdir().unwrap();
    let shim = shim(folder.path());
    let log = folder.path().join("threads");
    let started = |threads: Option<&str>| {
        let _ = std::fs::remove_file(&log);
        let done = run(&identify(), folder.path(), |command| {
            command.env("LD_PRELOAD", &shim);
            command.env("THREADS_LOG", &log);
            match threads {
                Some(n) => command.env("RAYON_NUM_THREADS", n),
                None => command.env_remove("RAYON_NUM_THREADS"),
            };
        });
        assert!(
            done.status.code().is_some_and(|c| c <= 1),
            "{}",
            stderr(&done)
        );
        std::fs::read(&log).unwrap().len()
    };
    let cores = std::thread::available_parallelism().unwrap().get();
    let cores = started(Some(&cores.to_string()));
    assert_eq!(started(Some("100000")), cores);
    assert_eq!(started(None), cores);
}

/// Starts of the lines that the standard library prints where an allocation fails.
const NO_MEMORY: [&str; 3] = [
    "memory allocation of ",
    "note: run with `RUST_BACKTRACE=1`",
    "skipping backtrace printing",
];

#[test]
fn regress_little_memory_is_an_error_of_the_environment() {
    let mut codes = Vec::new();
    let program = std::fs::metadata(env!("CARGO_BIN_EXE_poinsot")).unwrap();
    let program = program.len() >> 20;
    for mib in (program..program + 32).step_by(3) {
        let folder = tempfile::tempdir().unwrap();
        let script = format!("ulimit -v {}; exec \"$@\"", mib << 10);
        let done = Command::new("sh")
            .args(["-c", &script, "sh", env!("CARGO_BIN_EXE_poinsot")])
            .args(identify().arguments)
            .args(["--out", "out"])
            .env_remove("RUST_BACKTRACE")
            .current_dir(folder.path())
            .output()
            .unwrap();
        let code = done.status.code();
        // 127: the program itself does not fit.
        assert!(
            matches!(code, Some(0 | 1 | 3 | 127)),
            "{mib} MiB: {:?} {}",
            done.status,
            stderr(&done)
        );
        // The standard library has lines of its own for each thread that finds no memory; two may at once.
        let ours = |line: &&str| !NO_MEMORY.iter().any(|start| line.starts_with(start));
        assert!(
            stderr(&done).lines().filter(ours).count() <= 1,
            "{mib} MiB: {}",
            stderr(&done)
        );
        codes.push((mib, code));
    }
    println!("{codes:?}");
    assert!(codes.iter().any(|c| c.1 == Some(3)), "{codes:?}");
}

#[test]
fn regress_no_thread_is_one_line_and_exit_3() {
    let folder = tempfile::tempdir().unwrap();
    let shim = shim(folder.path());
    let done = run(&identify(), folder.path(), |command| {
        command.env("LD_PRELOAD", &shim);
        command.env("THREADS_FAIL", "1");
    });
    assert_eq!(done.status.code(), Some(3), "{}", stderr(&done));
    assert!(
        stderr(&done).starts_with("E0005 the system cannot start a thread: "),
        "{}",
        stderr(&done)
    );
    assert_eq!(stderr(&done).lines().count(), 1);
}

#[test]
fn cli_full_standard_output_is_exit_3() {
    let full = std::fs::File::options()
        .write(true)
        .open("/dev/full")
        .unwrap();
    let done = poinsot(&["schema"]).stdout(full).output().unwrap();
    assert_eq!(done.status.code(), Some(3));
    assert_eq!(
        stderr(&done),
        "E0003 standard output: No space left on device (os error 28); free space, or write to another place\n"
    );
}

#[test]
fn cli_closed_standard_output_is_no_error() {
    let mut child = poinsot(&["schema"]).stdout(Stdio::piped()).spawn().unwrap();
    drop(child.stdout.take());
    assert_eq!(child.wait().unwrap().code(), Some(0));
}

#[test]
fn cli_closed_standard_error_is_no_error_either() {
    let mut child = poinsot(&["explain", "E9999"])
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stderr.take());
    assert_eq!(child.wait().unwrap().code(), Some(2));
}

/// Notes after the result is written: a closed stream is ignored, and the result is kept.
#[test]
fn regress_notes_on_a_closed_standard_error_are_no_fault() {
    let folder = tempfile::tempdir().unwrap();
    let case = example("cases/stsat3_spin.toml");
    let mut child = poinsot(&["simulate", &case, "--out", "out"])
        .current_dir(folder.path())
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stderr.take());
    assert_eq!(child.wait().unwrap().code(), Some(0));
}

#[test]
fn cli_a_folder_without_permission_is_exit_3() {
    use std::os::unix::fs::PermissionsExt;
    let folder = tempfile::tempdir().unwrap();
    let locked = folder.path().join("locked");
    std::fs::create_dir(&locked).unwrap();
    std::fs::set_permissions(&locked, std::fs::Permissions::from_mode(0o555)).unwrap();
    if std::fs::write(locked.join("probe"), "").is_ok() {
        eprintln!("skipped: this user may write everywhere");
        return;
    }
    let out = locked.join("out").display().to_string();
    let mut arguments = identify().arguments;
    arguments.extend(["--out".to_owned(), out]);
    let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let done = poinsot(&arguments).output().unwrap();
    assert_eq!(done.status.code(), Some(3));
    assert!(
        stderr(&done).contains("Permission denied"),
        "{}",
        stderr(&done)
    );
}
