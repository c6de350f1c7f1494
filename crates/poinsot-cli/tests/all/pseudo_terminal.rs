//! The command on a pseudo terminal: questions without progress over them, and tables within the width.
#![cfg(target_os = "linux")]

use clap::CommandFactory;
use poinsot_cli::arguments::Arguments;
use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};
use rustix::termios::{Winsize, tcsetwinsize};
use std::collections::HashSet;
use std::fs::{File, OpenOptions};
use std::io::{Read, Write};
use std::os::unix::ffi::OsStrExt;
use std::os::unix::fs::OpenOptionsExt;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::sync::{Arc, Mutex};
use std::thread::{JoinHandle, sleep};
use std::time::{Duration, Instant};

/// The command on a terminal of its own.
struct Terminal {
    keys: File,
    shown: Arc<Mutex<Vec<u8>>>,
    reader: JoinHandle<()>,
    child: Child,
}

impl Terminal {
    fn start(folder: &Path, columns: u16, words: &[&str], shows_errors: bool) -> Self {
        let flags = OpenptFlags::RDWR | OpenptFlags::NOCTTY | OpenptFlags::CLOEXEC;
        let main = openpt(flags).unwrap();
        grantpt(&main).unwrap();
        unlockpt(&main).unwrap();
        let name = ptsname(&main, Vec::new()).unwrap();
        let name = Path::new(std::ffi::OsStr::from_bytes(name.as_bytes()));
        let mut options = OpenOptions::new();
        let options = options.read(true).write(true);
        let side = options.custom_flags(libc::O_NOCTTY).open(name).unwrap();
        let size = Winsize {
            ws_row: 40,
            ws_col: columns,
            ws_xpixel: 0,
            ws_ypixel: 0,
        };
        tcsetwinsize(&side, size).unwrap();
        let end = || side.try_clone().unwrap();
        let child = Command::new(env!("CARGO_BIN_EXE_poinsot"))
            .args(words)
            .current_dir(folder)
            .env("NO_COLOR", "1")
            .env("TERM", "xterm")
            .stdin(end())
            .stdout(end())
            .stderr(if shows_errors {
                end().into()
            } else {
                Stdio::null()
            })
            .spawn()
            .unwrap();
        let keys = File::from(main);
        let shown = Arc::new(Mutex::new(Vec::new()));
        let (mut source, all) = (keys.try_clone().unwrap(), shown.clone());
        // Linux ends the reading by an error where no process has the terminal open.
        let reader = std::thread::spawn(move || {
            let mut buffer = [0; 4096];
            while let Ok(count @ 1..) = source.read(&mut buffer) {
                all.lock().unwrap().extend_from_slice(&buffer[..count]);
            }
        });
        Self {
            keys,
            shown,
            reader,
            child,
        }
    }

    fn shown(&self) -> String {
        String::from_utf8_lossy(&self.shown.lock().unwrap()).replace("\r\n", "\n")
    }

    fn wait_for(&self, text: &str) {
        let begun = Instant::now();
        while !self.shown().contains(text) {
            assert!(
                begun.elapsed() < Duration::from_secs(60),
                "{}",
                self.shown()
            );
            sleep(Duration::from_millis(20));
        }
    }

    /// Everything that was shown, and the exit code.
    fn end(mut self) -> (String, Option<i32>) {
        let code = self.child.wait().unwrap().code();
        let shown = self.shown.clone();
        self.reader.join().unwrap();
        let text = String::from_utf8_lossy(&shown.lock().unwrap()).replace("\r\n", "\n");
        (text, code)
    }
}

fn data(path: &str) -> String {
    let shipped = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data");
    shipped.join(path).display().to_string()
}

/// Longer than the delay after which progress is drawn.
const LONG: Duration = Duration::from_secs(3);
/// Ctrl-D: the end of what is typed.
const END: &[u8] = b"\x04";

#[test]
fn cli_no_progress_is_drawn_while_the_program_waits_for_a_person() {
    let folder = tempfile::tempdir().unwrap();
    let telemetry = data("stsat3/paper/telemetry_noisy.csv");
    let waiting = |words: &[&str]| Terminal::start(folder.path(), 100, words, true);
    let mut init = waiting(&["init", &telemetry]);
    let mut rows = waiting(&["inspect", "-"]);
    init.wait_for("An empty answer leaves a question open.");
    sleep(LONG);
    // An answer, then none.
    for typed in [b"\n".as_slice(), END] {
        init.keys.write_all(typed).unwrap();
        sleep(Duration::from_millis(300));
    }
    rows.keys.write_all(END).unwrap();
    let (asked, code) = init.end();
    assert_eq!(code, Some(1), "{asked}");
    assert!(asked.contains("written: model.toml"), "{asked}");
    for text in [asked, rows.end().0] {
        assert!(!text.contains("working"), "{text}");
    }
}

const SWEEP: [&str; 6] = ["--vary", "noise=1,3", "--trials", "2", "--out", "points"];

/// Folders and files of answers whose tables are shown.
fn prepare(folder: &Path) {
    let [model, one, two] = [
        "ma2008/model_noisy.toml",
        "ma2008/traj1/telemetry_noisy.csv",
        "ma2008/traj2b/telemetry_noisy.parquet",
    ]
    .map(data);
    let tug = data("cases/tug_thrusters.toml");
    let plan = format!(
        "schema = \"poinsot.plan/1\"\nname = \"small\"\ntrials = 4\n\n[[experiment]]\ncase = \"{}\"\nevery = 20\n",
        tug
    );
    std::fs::write(folder.join("plan.toml"), plan).unwrap();
    let design = std::fs::read_to_string(data("../examples/05_design/design.toml")).unwrap();
    let design = design
        .replace("evaluations = 300", "evaluations = 5")
        .replace("../../data/", &data(""));
    std::fs::write(folder.join("design.toml"), design).unwrap();
    for words in [
        &["identify", &model, &one, "--out", "one"][..],
        &["identify", &model, &two, "--out", "two"],
        &["campaign", "plan.toml", "--out", "trials"],
        &[&["sweep", &tug], &SWEEP[..]].concat(),
    ] {
        let terminal = Terminal::start(folder, 100, words, false);
        let (shown, code) = terminal.end();
        assert!(code < Some(2), "{words:?}: {shown}");
    }
}

/// Commands that show every table of a verb; none where it prints no table.
fn of_verb(verb: &str) -> Vec<Vec<String>> {
    let [ma, first] = [
        "ma2008/model_noisy.toml",
        "ma2008/traj1/telemetry_noisy.csv",
    ]
    .map(data);
    let [stsat, paper] = ["stsat3/model.toml", "stsat3/paper/telemetry_noisy.csv"].map(data);
    let [tug, target] = ["cases/tug_thrusters.toml", "cases/xu2017_c1.toml"].map(data);
    let second = data("ma2008/traj2b/telemetry_noisy.parquet");
    let shipped = data("");
    let all: Vec<Vec<&str>> = match verb {
        "identify" => vec![vec![&stsat, &paper], vec![&ma, &first, "--verbose"]],
        "follow" => vec![vec![&stsat, &paper]],
        "predict" => vec![
            vec![&target],
            vec![&tug, "--durations"],
            vec![&tug, &target],
        ],
        "design" => vec![vec!["design.toml"]],
        "validate" => vec![vec![
            "--model",
            &ma,
            "--estimate",
            "one",
            "--against",
            &second,
        ]],
        "compare" => vec![vec!["one", "two"]],
        "campaign" => vec![vec!["plan.toml", "--out", "trials", "--merge"]],
        "sweep" => vec![[&[&*tug], &SWEEP[..], &["--resume"]].concat()],
        "study" => vec![vec!["kim2010", "table2", "--data", &shipped]],
        "inspect" => vec![vec![&first]],
        "simulate" | "report" | "init" | "check" | "import" | "export" | "explain" | "units"
        | "methods" | "schema" | "completions" | "man" => vec![],
        _ => panic!("say which tables {verb} prints"),
    };
    let words = all.into_iter().map(|words| [vec![verb], words].concat());
    words
        .map(|words| words.into_iter().map(str::to_owned).collect())
        .collect()
}

/// What a command shows at a width, up to what is meant to be pasted into a file.
fn shown(folder: &Path, words: &[String], columns: u16) -> String {
    let words: Vec<&str> = words.iter().map(String::as_str).collect();
    let (text, code) = Terminal::start(folder, columns, &words, false).end();
    assert!(code < Some(2), "{words:?}: {text}");
    // The table of `follow` is drawn again over the one before.
    let text = text.rsplit("\u{1b}[J").next().unwrap_or_default();
    text.split("\n\nProposed")
        .next()
        .unwrap_or_default()
        .to_owned()
}

/// Whether a word stands in a text unbroken, or broken after `.`, `_` or `/` outside numbers.
fn is_unbroken(word: &str, text: &HashSet<&str>) -> bool {
    let breaks = word.char_indices().zip(word.chars().skip(1));
    let mut breaks =
        breaks.filter(|((_, c), next)| "._/".contains(*c) && !(*c == '.' && next.is_ascii_digit()));
    text.contains(word)
        || breaks.any(|((at, _), _)| {
            let (head, tail) = word.split_at(at + 1);
            text.contains(head) && is_unbroken(tail, text)
        })
}

#[test]
fn cli_no_table_breaks_a_word_or_a_number_or_leaves_the_terminal() {
    let folder = tempfile::tempdir().unwrap();
    prepare(folder.path());
    for verb in Arguments::command().get_subcommands() {
        for words in of_verb(verb.get_name()) {
            let wide = shown(folder.path(), &words, 1000);
            for columns in [60, 80, 100, 120] {
                let narrow = shown(folder.path(), &words, columns);
                let of = words.join(" ");
                for line in narrow.lines() {
                    let fits = line.chars().count() <= usize::from(columns);
                    let is_one_word = !line.trim().contains(' ');
                    assert!(fits || is_one_word, "{of}, {columns}: {line}\n{narrow}");
                }
                let found = narrow.split_whitespace();
                let found = found.flat_map(|word| [word, word.trim_end_matches(':')]);
                let found: HashSet<&str> = found.collect();
                for word in wide.split_whitespace() {
                    assert!(
                        is_unbroken(word, &found),
                        "{of}, {columns}: {word}\n{narrow}"
                    );
                }
            }
        }
    }
}
