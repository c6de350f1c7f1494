//! Bounded work, usage errors and strange names, by the command as a user runs it.
#![cfg(target_os = "linux")]

use serde_json::Value;
use std::ffi::{OsStr, OsString};
use std::os::unix::ffi::OsStrExt;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};

const PROGRAM: &str = env!("CARGO_BIN_EXE_poinsot");

fn data(path: &str) -> PathBuf {
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data");
    data.join(path)
}

fn run<S: AsRef<OsStr>>(folder: &Path, words: &[S]) -> Output {
    let mut command = Command::new(PROGRAM);
    command.current_dir(folder).args(words).output().unwrap()
}

/// Runs the program by a shell; `$P` is the program.
fn shell(folder: &Path, script: &str) -> Output {
    let mut command = Command::new("sh");
    command.args(["-c", script]).env("P", PROGRAM);
    command.current_dir(folder).output().unwrap()
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

#[track_caller]
fn refused(output: &Output, exit: i32, start: &str) {
    assert_eq!(output.status.code(), Some(exit), "{}", said(output));
    assert!(said(output).starts_with(start), "{}", said(output));
}

/// A folder with the spinning satellite at another rate, and a plan of it.
fn satellite(rate_hz: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let case = std::fs::read_to_string(data("cases/stsat3_spin.toml")).unwrap();
    let case = case.replacen("rate_hz = 10\n", &format!("rate_hz = {rate_hz}\n"), 1);
    let case = case.replace("rate_hz = 2 ", &format!("rate_hz = {rate_hz} "));
    std::fs::write(folder.path().join("case.toml"), case).unwrap();
    let truth = "stsat3_truth.toml";
    std::fs::copy(data("cases").join(truth), folder.path().join(truth)).unwrap();
    let plan = "schema = \"poinsot.plan/1\"\nname = \"p\"\ntrials = 2\n[[experiment]]\ncase = \"case.toml\"\n";
    std::fs::write(folder.path().join("plan.toml"), plan).unwrap();
    folder
}

#[test]
fn cli_a_usage_error_has_a_code_and_is_json_where_json_is_asked() {
    let folder = tempfile::tempdir().unwrap();
    let plain = run(folder.path(), &["check", "--nope"]);
    refused(&plain, 2, "E0001 unexpected argument '--nope' found; ");
    assert!(plain.stdout.is_empty());
    assert!(
        said(&plain).contains("Usage: poinsot check"),
        "{}",
        said(&plain)
    );
    for words in [
        &["check", "m.toml", "--json", "--nope"][..],
        &["identify", "--json"],
        &["campaign", "p.toml", "--json", "--trials", "many"],
        &["--json"],
    ] {
        let output = run(folder.path(), words);
        refused(&output, 2, "E0001 ");
        let file: Value = serde_json::from_slice(&output.stdout).unwrap();
        assert_eq!(file["exit_code"], 2, "{words:?}");
        assert_eq!(file["errors"][0]["code"], "E0001", "{words:?}");
    }
}

#[test]
fn cli_help_is_printed_or_its_loss_is_an_error() {
    let folder = tempfile::tempdir().unwrap();
    let [model, rows] = ["stsat3/model.toml", "stsat3/paper/telemetry_noisy.csv"].map(data);
    let follow = format!("follow {} {} --quiet", model.display(), rows.display());
    let full = shell(folder.path(), &format!("\"$P\" {follow} > /dev/full"));
    refused(&full, 3, "E0003 standard output: ");
    for words in ["--help", "identify --help", "--version"] {
        let full = shell(folder.path(), &format!("\"$P\" {words} > /dev/full"));
        refused(&full, 3, "E0003 standard output: ");
        let plain = shell(folder.path(), &format!("\"$P\" {words}"));
        assert_eq!(plain.status.code(), Some(0));
        assert!(plain.stdout.starts_with(b"poinsot 0.") || plain.stdout.len() > 500);
    }
    let bare = shell(folder.path(), "\"$P\"");
    assert_eq!(bare.status.code(), Some(2));
    assert!(said(&bare).contains("identify"), "{}", said(&bare));
}

#[test]
fn cli_names_that_are_not_utf8_are_read() {
    let folder = tempfile::tempdir().unwrap();
    let name = |text: &[u8]| OsStr::from_bytes(text).to_owned();
    let (model, rows) = (name(b"m\xff.toml"), name(b"t\xff.csv"));
    let place = |name: &OsString| folder.path().join(name);
    std::fs::copy(data("stsat3/model.toml"), place(&model)).unwrap();
    std::fs::copy(data("stsat3/paper/telemetry_noisy.csv"), place(&rows)).unwrap();
    let word = |text: &str| OsString::from(text);
    let inspect = run(folder.path(), &[word("inspect"), rows.clone()]);
    assert_eq!(inspect.status.code(), Some(0), "{}", said(&inspect));
    let identify = run(
        folder.path(),
        &[
            word("identify"),
            word("--model"),
            model.clone(),
            word("--telemetry"),
            rows.clone(),
            word("--out"),
            name(b"o\xff"),
            word("--json"),
        ],
    );
    assert!(
        matches!(identify.status.code(), Some(0 | 1)),
        "{}",
        said(&identify)
    );
    assert!(place(&name(b"o\xff")).join("estimate.json").exists());
    let against = [
        word("validate"),
        word("--model"),
        model,
        word("--against"),
        rows,
    ];
    let validate = run(folder.path(), &against);
    assert!(!said(&validate).contains("E0001"), "{}", said(&validate));
    let other = satellite("1");
    let names = [name(b"c\xff.toml"), name(b"n\xff.toml")];
    for (from, to) in ["case.toml", "stsat3_truth.toml"].iter().zip(&names) {
        std::fs::copy(other.path().join(from), other.path().join(to)).unwrap();
    }
    let [case, nominal] = names;
    let mut sweep = ["sweep", "--trials", "2", "--vary", "noise=1", "--model"]
        .map(word)
        .to_vec();
    sweep.extend([nominal, case]);
    let sweep = run(other.path(), &sweep);
    assert_eq!(sweep.status.code(), Some(0), "{}", said(&sweep));
}

#[test]
fn cli_a_small_stack_is_enough() {
    for verb in ["check m.toml", "schema", "simulate case.toml --out out"] {
        let folder = satellite("10");
        std::fs::copy(data("stsat3/model.toml"), folder.path().join("m.toml")).unwrap();
        let output = shell(folder.path(), &format!("ulimit -s 256; exec \"$P\" {verb}"));
        assert_eq!(output.status.code(), Some(0), "{verb}: {}", said(&output));
    }
}

#[test]
fn cli_a_folder_of_shards_that_is_not_there_is_refused() {
    let folder = satellite("10");
    let words = [
        "campaign",
        "plan.toml",
        "--out",
        "o",
        "--partial",
        "--merge",
        "gone",
    ];
    let output = run(folder.path(), &words);
    refused(&output, 2, "E0603 gone: there is no such folder of shards");
}

/// A frame of Zstandard (RFC 8878) in blocks that repeat one byte.
fn repeated(byte: u8, blocks: u32) -> Vec<u8> {
    let mut frame = vec![0x28, 0xb5, 0x2f, 0xfd, 0x00, 0x38];
    for k in 0..blocks {
        let header = (128 << 10 << 3) | (1 << 1) | u32::from(k + 1 == blocks);
        frame.extend(&header.to_le_bytes()[..3]);
        frame.push(byte);
    }
    frame
}

#[test]
fn cli_data_packed_to_fill_memory_and_time_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    for byte in [b'\n', 0, b'1'] {
        // 362 kB that unpack to 11.8 GB.
        std::fs::write(folder.path().join("t.csv.zst"), repeated(byte, 90_000)).unwrap();
        let started = Instant::now();
        let output = run(folder.path(), &["inspect", "t.csv.zst"]);
        assert_eq!(output.status.code(), Some(2), "{}", said(&output));
        assert!(started.elapsed() < Duration::from_secs(20), "{byte}");
    }
}

#[test]
fn cli_a_frame_to_be_skipped_may_come_first() {
    let folder = tempfile::tempdir().unwrap();
    let rows = "time_s,omega_x\n0,0.1\n1,0.2\n2,0.3\n";
    let mut packed = vec![0x5a, 0x2a, 0x4d, 0x18, 3, 0, 0, 0, 1, 2, 3];
    packed.extend([0x28, 0xb5, 0x2f, 0xfd, 0x20, rows.len() as u8]);
    packed.extend(&(((rows.len() as u32) << 3) | 1).to_le_bytes()[..3]);
    packed.extend(rows.as_bytes());
    std::fs::write(folder.path().join("t.csv"), packed).unwrap();
    let output = run(folder.path(), &["inspect", "t.csv", "--json"]);
    assert_eq!(output.status.code(), Some(0), "{}", said(&output));
    assert!(String::from_utf8_lossy(&output.stdout).contains("omega_x"));
}

#[test]
fn cli_work_above_the_memory_or_time_is_refused_with_both_figures() {
    let verbs = [
        "simulate case.toml --out o",
        "predict case.toml",
        "validate case.toml --against stsat3_truth.toml",
        "sweep case.toml --vary noise=1,2 --trials 2",
        "campaign plan.toml --out o",
        "campaign plan.toml --estimate",
    ];
    let refuses = |words: &str, rate: &str, parts: [&str; 2]| {
        let folder = satellite(rate);
        let output = shell(folder.path(), &format!("exec \"$P\" {words}"));
        let rows = 120.0 * rate.parse::<f64>().unwrap();
        refused(&output, 3, &format!("E0006 the {rows:e} rows of "));
        let text = said(&output);
        assert!(parts.iter().all(|part| text.contains(part)), "{text}");
    };
    // 120 s.
    let memory = [" GiB of memory, and the limit is ", "--limit-memory"];
    let time = [" hours, and the limit is 24; ", "--limit-hours"];
    for words in verbs {
        refuses(words, "1e12", time);
        if !words.starts_with("simulate") {
            refuses(words, "1e8", memory);
        }
    }
    // Ten hours at least.
    refuses(
        "simulate case.toml --out o --limit-hours 1",
        "1e9",
        [" hours, and the limit is 1; ", "--limit-hours"],
    );
    // 10^12 trials.
    let folder = satellite("10");
    for words in [
        "campaign plan.toml --out o --trials 1000000000000",
        "campaign plan.toml --out o --trials 1000000000000 --resume --shard 1/2",
    ] {
        let script = format!("ulimit -v 4194304; exec \"$P\" {words}");
        refused(&shell(folder.path(), &script), 3, "E0006 the 1.000e");
    }
}

/// The small case of a design at a rate.
fn design(rate_hz: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let doc = Path::new(env!("CARGO_MANIFEST_DIR")).join("../poinsot-design/doc");
    let case = std::fs::read_to_string(doc.join("case.toml")).unwrap();
    let case = case.replacen("rate_hz = 1.0", &format!("rate_hz = {rate_hz}"), 1);
    std::fs::write(folder.path().join("case.toml"), case).unwrap();
    std::fs::copy(doc.join("model.toml"), folder.path().join("model.toml")).unwrap();
    folder
}

#[test]
fn cli_a_design_above_the_memory_or_time_is_refused() {
    for (rate, words) in [
        ("1e12", " hours, and the limit is 24; "),
        ("1e8", " GiB of memory, and the limit is "),
    ] {
        let folder = design(rate);
        let output = run(folder.path(), &["design", "case.toml", "--out", "o"]);
        refused(&output, 3, "E0006 the 1");
        assert!(said(&output).contains(words), "{}", said(&output));
    }
    let folder = design("1.0");
    for (flights, start) in [
        (
            "1000000000000",
            "E0006 the 1000000000000 trial flights need about ",
        ),
        (
            "1000000000",
            "E0006 the 1000000000 trial flights take at least ",
        ),
    ] {
        let words = [
            "design",
            "case.toml",
            "--verify",
            flights,
            "--limit-hours",
            "1",
        ];
        let limited = [&words[..], &["--limit-memory", "200000"]].concat();
        refused(&run(folder.path(), &limited), 3, start);
    }
}

/// Rows whose least time is small, of a spring that takes a thousand steps between two of them: 1,000 rows take minutes.
#[test]
fn cli_a_motion_that_begins_too_slowly_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let read = |name: &str| std::fs::read_to_string(data("cases").join(name)).unwrap();
    let model = read("hinged_panel_truth.toml");
    let stiff = model.replacen(
        "stiffness_N_m_per_rad = 8.0",
        "stiffness_N_m_per_rad = 1e9",
        1,
    );
    assert_ne!(model, stiff);
    std::fs::write(folder.path().join("hinged_panel_truth.toml"), stiff).unwrap();
    let case = read("hinged_panel.toml").replacen("duration_s = 200.0", "duration_s = 2e6", 1);
    std::fs::write(folder.path().join("case.toml"), case).unwrap();
    let started = Instant::now();
    let output = run(folder.path(), &["simulate", "case.toml", "--out", "o"]);
    refused(&output, 3, "E0006 the 1e7 rows of case.toml take at least ");
    assert!(!folder.path().join("o").exists());
    assert!(started.elapsed() < Duration::from_secs(60));
}

/// Its table would take 0.2 GB.
#[test]
fn cli_the_memory_of_simulate_does_not_grow_with_the_rows() {
    let folder = satellite("6000");
    let space = (1 << 10) * (48 + program_mib());
    let script = format!(
        "ulimit -v {space}; exec \"$P\" simulate case.toml --out o --limit-memory 48 --quiet"
    );
    let output = shell(folder.path(), &script);
    assert_eq!(output.status.code(), Some(0), "{}", said(&output));
    let text = std::fs::read(folder.path().join("o/telemetry.csv")).unwrap();
    assert_eq!(text.iter().filter(|byte| **byte == b'\n').count(), 720_002);
}

/// Its samples would take 0.12 GB.
#[test]
fn cli_a_file_above_the_memory_is_read_in_parts() {
    let folder = satellite("5000");
    let made = shell(
        folder.path(),
        "exec \"$P\" simulate case.toml --out o --quiet",
    );
    assert_eq!(made.status.code(), Some(0), "{}", said(&made));
    let space = (1 << 10) * (24 + program_mib());
    for verb in ["inspect o/telemetry.csv", "init o/telemetry.csv -o m.toml"] {
        let script = format!("ulimit -v {space}; exec \"$P\" {verb} --limit-memory 24 --quiet");
        let output = shell(folder.path(), &script);
        assert!(
            matches!(output.status.code(), Some(0 | 1)),
            "{verb}: {}",
            said(&output)
        );
    }
}

/// Trials are refused by what the least of them takes.
#[test]
fn cli_trials_above_the_time_are_refused() {
    let folder = satellite("10");
    let words = "campaign plan.toml --out o --trials 100000000 --limit-hours 1";
    let output = shell(folder.path(), &format!("exec \"$P\" {words}"));
    refused(&output, 3, "E0006 the 100000000 trials take at least ");
}

/// Of so few rows the least time of 10^9 trials is some hours; that of the first ones is years.
#[test]
fn cli_trials_that_begin_too_slowly_are_refused_and_only_those_that_are_left_count() {
    let folder = satellite("0.1");
    let plan = std::fs::read_to_string(folder.path().join("plan.toml")).unwrap();
    let plan = plan.replace("trials = 2", "trials = 2\ntrials_per_shard = 1000000");
    std::fs::write(folder.path().join("plan.toml"), plan).unwrap();
    let run = |words: &str| shell(folder.path(), &format!("exec \"$P\" {words}"));
    for words in [
        "campaign plan.toml --out o --trials 1000000000",
        "sweep case.toml --vary noise=1 --trials 1000000000",
    ] {
        refused(&run(words), 3, "E0006 the 1000000000 trials take at least ");
    }
    let few = "campaign plan.toml --out few --limit-hours 1e-6";
    let output = run("campaign plan.toml --out few");
    assert_eq!(output.status.code(), Some(0), "{}", said(&output));
    let output = run(&format!("{few} --resume"));
    assert_eq!(output.status.code(), Some(0), "{}", said(&output));
    let output = run(&format!("{few} --resume --trials 1000 --processes 2"));
    assert_eq!(output.status.code(), Some(3), "{}", said(&output));
    assert!(said(&output).contains("E0006 the 1000 trials take at least "));
}

#[test]
fn cli_a_fit_above_the_time_is_ended() {
    let folder = tempfile::tempdir().unwrap();
    let [model, rows] = ["stsat3/model.toml", "stsat3/paper/telemetry_noisy.csv"].map(data);
    for method in ["auto", "maximum_likelihood", "linear", "kim2010"] {
        let words = [
            OsStr::new("identify"),
            model.as_os_str(),
            rows.as_os_str(),
            OsStr::new("--method"),
            OsStr::new(method),
            OsStr::new("--out"),
            OsStr::new("o"),
            OsStr::new("--limit-hours"),
        ];
        let limited =
            |hours: &str| run(folder.path(), &[&words[..], &[OsStr::new(hours)]].concat());
        let output = limited("24");
        assert!(
            matches!(output.status.code(), Some(0 | 1)),
            "{}",
            said(&output)
        );
        std::fs::remove_dir_all(folder.path().join("o")).unwrap();
        refused(&limited("1e-9"), 3, "E0006 the fits of ");
        assert!(!folder.path().join("o").exists());
    }
    let swarm = |set: &str| {
        let [model, rows] = ["xu2017/model.toml", "xu2017/C1/telemetry.parquet"].map(data);
        let (model, rows) = (model.display(), rows.display());
        let words = format!("identify -m {model} {rows} --method xu2017 --variant swarm {set}");
        shell(folder.path(), &format!("exec \"$P\" {words}"))
    };
    for (set, start) in [
        (
            "--set particles=10000000 --limit-memory 4096",
            "E0006 the 10000000 particles of the swarm need about ",
        ),
        (
            "--set particles=1000000 --set iterations=10000000 --set patience=10000000",
            "E0006 the 1000000 particles of the swarm take at least ",
        ),
        (
            "--set iterations=4000 --limit-hours 1e-5",
            "E0006 the 50 particles of the swarm take at least ",
        ),
    ] {
        refused(&swarm(set), 3, start);
    }
    refused(
        &run(folder.path(), &["schema", "--limit-hours", "-1"]),
        2,
        "E0001 ",
    );
}

/// Limit of the tests of memory, MiB; `scripts/test long memory` sets 4096.
fn limit_mib() -> u64 {
    std::env::var("POINSOT_LIMIT_MIB").map_or(24, |mib| mib.parse().unwrap())
}

/// Runs a command within an address space of so many MiB and what the program takes without any work.
fn within(folder: &Path, verb: &str, mib: u64) -> Output {
    let space = (1 << 10) * (mib + program_mib());
    let limit = format!("--limit-memory {mib} --quiet");
    shell(
        folder,
        &format!("ulimit -v {space}; exec \"$P\" {verb} {limit}"),
    )
}

/// A folder with the satellite, so many more gyros of which a model says this beside their noise, and their telemetry.
fn with_gyros(rate_hz: &str, gyros: usize, more: &str) -> tempfile::TempDir {
    let folder = satellite(rate_hz);
    let gyro = |k: usize| {
        let noise = format!("noise_rad_s = 2.0e-5\n{more}");
        format!("\n[[sensor]]\nname = \"more{k}\"\ntype = \"gyro\"\n{noise}")
    };
    let sensors: String = (0..gyros).map(gyro).collect();
    let with = |from: &Path, to: &str| {
        let text = std::fs::read_to_string(from).unwrap();
        std::fs::write(folder.path().join(to), text + &sensors).unwrap();
    };
    with(&data("cases/stsat3_truth.toml"), "stsat3_truth.toml");
    with(&data("stsat3/model.toml"), "many.toml");
    let made = run(
        folder.path(),
        &["simulate", "case.toml", "--out", "o", "--quiet"],
    );
    assert!(made.status.success(), "{}", said(&made));
    folder
}

/// Identifies them within so many MiB; what is said, and the most memory that was held, MiB.
fn identified_within(folder: &Path, mib: u64) -> (Output, f64) {
    let words = "identify --model many.toml o/telemetry.csv --out i --quiet --limit-memory";
    let mut command = Command::new(PROGRAM);
    let command = command.current_dir(folder).args(words.split(' '));
    let command = command.arg(mib.to_string()).stderr(Stdio::piped());
    let mut child = command.spawn().unwrap();
    let status = format!("/proc/{}/status", child.id());
    let mut most: f64 = 0.0;
    while child.try_wait().unwrap().is_none() {
        let held = poinsot_files::stated(&status, "VmHWM:", 1.0 / 1024.0);
        most = most.max(held.unwrap_or(0.0));
        std::thread::sleep(Duration::from_millis(2));
    }
    (child.wait_with_output().unwrap(), most)
}

/// Every cause that is tried has the covariance of all unknown numbers: 600 took 3.3 GB, which no limit saw.
#[test]
fn cli_many_unknown_numbers_need_memory() {
    let with = |gyros: usize| {
        let folder = with_gyros("2", gyros, "bias = \"estimate\"\n");
        identified_within(folder.path(), 100).0
    };
    refused(&with(60), 3, "E0006 the fits of 186 unknown numbers");
    let few = with(2);
    assert!(matches!(few.status.code(), Some(0 | 1)), "{}", said(&few));
}

/// The errors of all sensors were the columns of one matrix where wheels are noisy: those of 160 gyros took 190 MiB, which no
/// limit saw.
#[test]
fn cli_many_known_sensors_stay_within_their_limit() {
    /// What the program and its threads take without any work.
    const PROGRAM_MIB: f64 = 64.0;
    let folder = with_gyros("1", 160, "");
    let (output, most) = identified_within(folder.path(), 64);
    let code = output.status.code();
    assert!(matches!(code, Some(0 | 1)), "{}", said(&output));
    assert!(10.0 < most && most < 64.0 + PROGRAM_MIB, "{most} MiB");
    let (output, _) = identified_within(folder.path(), 12);
    refused(&output, 3, "E0006 the fits of ");
    assert!(
        said(&output).contains(" samples need about "),
        "{}",
        said(&output)
    );
}

/// A file of so many bytes, of units made from their number.
fn filled(path: &Path, parts: [&str; 2], bytes: u64, unit: &dyn Fn(u64) -> String) {
    let [head, tail] = parts;
    let mut text = head.to_owned();
    for k in 0.. {
        let next = unit(k);
        if text.len() + next.len() + tail.len() > bytes as usize {
            break;
        }
        text.push_str(&next);
    }
    text.push_str(tail);
    std::fs::create_dir_all(path.parent().unwrap()).unwrap();
    std::fs::write(path, text).unwrap();
}

/// Files of what takes the most memory for its bytes, just within the limit of what is read whole and above it, under the
/// verbs that read them: each is answered or refused, and no allocation fails.
#[test]
fn cli_each_reader_stays_within_its_limit() {
    let (folder, limit) = (tempfile::tempdir().unwrap(), limit_mib());
    let (model, rows) = (
        data("stsat3/model.toml"),
        data("stsat3/paper/telemetry_noisy.csv"),
    );
    let (model, rows) = (model.display(), rows.display());
    let words = format!("exec \"$P\" identify -m {model} {rows} --out a --report --quiet");
    assert!(shell(folder.path(), &words).status.code() < Some(2));
    let answer = std::fs::read_to_string(folder.path().join("a/estimate.json")).unwrap();
    // An earlier version has no checksum.
    let answer = answer.replace("poinsot.estimate/3", "poinsot.estimate/2");
    let answer = format!("{}\n}}", answer.rsplit_once(",\n  \"sha256\"").unwrap().0);
    let (before, after) = answer.split_once("\"warnings\": [").unwrap();
    let comma = if after.trim_start().starts_with(']') {
        "\"\""
    } else {
        "\"\","
    };
    let warnings = [
        &format!("{before}\"warnings\": ["),
        &format!("{comma}{after}"),
    ];
    let warnings = warnings.map(String::as_str);
    let answers = [
        "check FILE",
        "report DIR",
        "compare DIR a",
        "export DIR --to csv -o x.csv --accept-unreliable",
        &format!("validate -m {model} --estimate DIR --against {rows}"),
    ];
    let models = ["check FILE", &format!("inspect {rows} --model FILE")];
    let robots = [
        "check FILE",
        "import FILE -o y.toml",
        &format!("init {rows} --urdf FILE -o z.toml"),
    ];
    type Unit = fn(u64) -> String;
    let files: [(&str, [&str; 2], Unit, &[&str]); 10] = [
        (
            "e/estimate.json",
            warnings,
            |_| "\"\",".to_owned(),
            &answers,
        ),
        (
            "e/estimate.json",
            ["[", "0]"],
            |_| "{\"\":0},".to_owned(),
            &answers,
        ),
        (
            "r/report_data.json",
            ["{\"segments\":[", "{}]}"],
            |_| "{},".to_owned(),
            &["report DIR"],
        ),
        (
            "c/campaign.json",
            ["{\"files\":{", "\"\":\"\"}}"],
            |k| format!("\"{k:x}\":\"\","),
            &["report FILE"],
        ),
        (
            "m.toml",
            ["schema = \"poinsot.model/1\"\n", ""],
            |k| format!("{k:x}=0\n"),
            &models,
        ),
        (
            "d.toml",
            ["", ""],
            |k| format!("{k:x}.a.a.a.a.a=1\n"),
            &["check FILE"],
        ),
        (
            "i.toml",
            ["a=[", "0]"],
            |_| "{b=1},".to_owned(),
            &["check FILE"],
        ),
        (
            "s.toml",
            ["schema = \"poinsot.model/1\"\n", ""],
            |k| format!("[[sensor]]\nname=\"{k}\"\ntype=\"gyro\"\nnoise_rad_s=1e-5\n"),
            &["check FILE"],
        ),
        (
            "m.urdf",
            ["<robot name=\"m\">", "</robot>"],
            |k| format!("<link name=\"{k:x}\"/>"),
            &robots,
        ),
        (
            "n.urdf",
            ["<robot name=\"m\">", "</robot>"],
            |_| "<a/>".to_owned(),
            &robots,
        ),
    ];
    for (name, parts, unit, verbs) in files {
        let path = folder.path().join(name);
        let dir = path.parent().unwrap();
        // A file is refused whose 80-fold is above the limit, one of tables and keys earlier.
        let tables = ["toml", "urdf"].iter().any(|ending| name.ends_with(ending));
        let most = (limit << 20) / 80;
        for bytes in [most - 1000, most + 1000, 2 * most, 250 << 20] {
            if bytes > 250 << 20 || bytes > 20 * most {
                continue;
            }
            filled(&path, parts, bytes, &unit);
            if name.starts_with('r') {
                std::fs::copy(
                    folder.path().join("a/estimate.json"),
                    dir.join("estimate.json"),
                )
                .unwrap();
            }
            for verb in verbs {
                let verb = verb.replace("FILE", name).replace("DIR", &name[..1]);
                let output = within(folder.path(), &verb, limit);
                let text = said(&output);
                match output.status.code() {
                    Some(0 | 1) => assert!(bytes <= most, "{verb} of {bytes} bytes"),
                    Some(2) => assert!(text.starts_with("E0"), "{verb}: {text}"),
                    Some(3) if text.starts_with("E0006 the ") => {
                        assert!(tables || bytes > most, "{text}");
                    }
                    other => panic!("{verb} of {bytes} bytes: {other:?} {text}"),
                }
            }
        }
    }
}

/// Address space that the program takes without any work, MiB.
fn program_mib() -> u64 {
    let threads = std::thread::available_parallelism().unwrap().get() as u64;
    256 + 8 + 64 * (1 + threads)
}

/// Every verb whose memory grows with the request, with the largest request of a limit: inside of the limit it works,
/// just above it is refused. The address space is held to the limit and what the program takes without any work.
#[test]
fn cli_each_verb_stays_within_its_limit() {
    let limit = limit_mib();
    let model = data("stsat3/model.toml").display().to_string();
    for verb in [
        "predict case.toml",
        "validate case.toml --against stsat3_truth.toml",
        "sweep case.toml --vary noise=1 --trials 2",
        "campaign plan.toml --out o",
        "inspect o/telemetry.csv",
        "init o/telemetry.csv -o new.toml",
        &format!("follow {model} o/telemetry.csv"),
        &format!("identify --model {model} o/telemetry.csv --out i"),
    ] {
        let fits = |rate: u64| {
            let folder = satellite(&rate.to_string());
            if verb.contains("o/telemetry.csv") {
                let made = shell(
                    folder.path(),
                    "exec \"$P\" simulate case.toml --out o --quiet",
                );
                assert_eq!(made.status.code(), Some(0), "{}", said(&made));
            }
            let output = within(folder.path(), verb, limit);
            match output.status.code() {
                Some(0 | 1) => true,
                Some(3) if said(&output).starts_with("E0006 the ") => false,
                // More than the reader keeps of a file.
                Some(2) if said(&output).starts_with("E0221 ") => false,
                other => panic!("{verb} at {rate} Hz: {other:?} {}", said(&output)),
            }
        };
        let highest = 20 * limit;
        let streams = ["inspect", "init", "follow"]
            .iter()
            .any(|v| verb.starts_with(v));
        let mut rate = highest;
        while !fits(rate) {
            rate = rate * 3 / 4;
        }
        println!("{verb}: {rate} Hz within {limit} MiB");
        let expected = if streams {
            highest..=highest
        } else {
            limit..=highest - 1
        };
        assert!(expected.contains(&rate), "{verb}: {rate}");
    }
}
