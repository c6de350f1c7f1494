//! The command on a pseudo terminal: questions without progress over them.
#![cfg(target_os = "linux")]

use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};
use rustix::termios::{Winsize, tcsetwinsize};
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
