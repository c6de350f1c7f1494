//! `poinsot follow`

use super::{Outcome, command_line, exit_of, is_printed, note, noted};
use crate::arguments::Follow;
use crate::live::{Feed, serve};
use crate::terminal;
use poinsot::{Error, Followed, Follower, IdentifyRequest, Question, Reading};
use poinsot::{check_outputs, estimate_file, identify, identify_records, write_result};
use poinsot_design::interrupt::{Listening, is_requested};
use poinsot_files::{growing, open};
use poinsot_model::Model;
use poinsot_report::{Detail, estimate_document, followed_document, live_page, no_page};
use poinsot_telemetry::Part;
use serde::Serialize;
use serde_json::{Value, json};
use std::io::{ErrorKind, IsTerminal, Read, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, RecvTimeoutError, sync_channel};
use std::thread::JoinHandle;
use std::time::Duration;

/// Bytes that are read at once.
const CHUNK: usize = 1 << 16;
/// Chunks that may wait.
const WAITING: usize = 16;
/// Time between two looks for more rows or an interruption.
const LOOK: Duration = Duration::from_millis(100);
/// Copy of the rows from standard input.
const ROWS: &str = "rows.csv";

pub fn run(arguments: &Follow) -> Outcome {
    let from_stream = arguments.file == Path::new("-");
    let mut copy = match &arguments.out {
        Some(folder) => {
            let answer = [folder.join("estimate.json")];
            check_outputs("--out", &answer, &[&arguments.model])?;
            let path = folder.join(ROWS);
            let create = || growing(&path).map_err(|e| unwritable(&path, &e));
            from_stream.then(create).transpose()?
        }
        None => None,
    };
    let map = arguments.map.as_deref();
    let follower = Follower::new(&arguments.model, map, arguments.line_s)?;
    let rows = if from_stream {
        Path::new("standard input")
    } else {
        &arguments.file
    };
    let mut follower = follower.wanting(rows, arguments.relative_accuracy)?;
    if !arguments.quiet {
        follower.assumed().iter().for_each(|line| note(line));
    }
    let mut shown = Shown::new(arguments, follower.model())?;
    let _listening = Listening::begin();
    let chunks = chunks(arguments, from_stream)?;
    let mut kept = Vec::new();
    loop {
        let chunk = match chunks.recv_timeout(LOOK) {
            Ok(chunk) => chunk.map_err(|e| Error::io(&arguments.file, "cannot be read", &e))?,
            Err(RecvTimeoutError::Timeout) if !is_requested() => continue,
            Err(_) => break,
        };
        if let Some(copy) = &mut copy {
            copy.write_all(&chunk)
                .map_err(|e| unwritable(Path::new(ROWS), &e))?;
        }
        kept.extend(chunk);
        let text = whole_text(&mut kept);
        shown.certifier.iter_mut().for_each(|c| c.rows += &text);
        for known in follower.push(&text)? {
            if !shown.show(&known) {
                return Ok(exit_of(true));
            }
        }
        if is_requested() {
            break;
        }
    }
    let last = follower.end();
    if last.is_none() {
        note("fewer than two rows arrived: nothing is known");
    }
    shown.certifier.iter_mut().for_each(|c| c.end(&last));
    last.as_ref().map(|known| shown.show(known));
    shown.feed.iter().for_each(|feed| feed.end());
    if let Some(folder) = &arguments.out {
        let rows = if from_stream {
            folder.join(ROWS)
        } else {
            arguments.file.clone()
        };
        files(arguments, folder, rows)?;
    }
    let determined = last.is_some_and(|known| known.is_determined());
    Ok(exit_of(determined))
}

/// Where lines go: JSON on standard output, or a table on a terminal that is renewed in place; and a page.
struct Shown {
    vehicle: String,
    /// Lines of the table on the screen; `None` without a terminal.
    table: Option<usize>,
    feed: Option<Arc<Feed>>,
    certifier: Option<Certifier>,
}

impl Shown {
    fn new(arguments: &Follow, model: &Model) -> Result<Self, Error> {
        let vehicle = model.name.clone();
        let feed = arguments.serve.map(|address| {
            let page = live_page(&vehicle)
                .map_err(|e| Error::report(&arguments.model, no_page(&e), ""))?;
            let feed = Arc::new(Feed::default());
            let place = serve(address, page, &feed)?;
            note(&format!("live at {place}"));
            Ok::<_, Error>(feed)
        });
        Ok(Self {
            table: std::io::stdout().is_terminal().then_some(0),
            feed: feed.transpose()?,
            certifier: arguments.certify.map(|every_s| Certifier {
                model: model.clone(),
                every_s,
                due_s: f64::NEG_INFINITY,
                rows: String::new(),
                running: None,
                last: Value::Null,
            }),
            vehicle,
        })
    }

    /// False where standard output takes no more.
    fn show(&mut self, known: &Followed) -> bool {
        let line = Line {
            known,
            certified: self.certifier.as_mut().map(|c| c.at(known.time_s)),
        };
        let text = serde_json::to_string(&line).unwrap_or_default();
        let out = match &mut self.table {
            None => is_printed(&format!("{text}\n")),
            Some(height) => {
                let table = terminal::document_text(&followed_document(&self.vehicle, &line));
                let up = match *height {
                    0 => String::new(),
                    lines => format!("\x1b[{lines}F\x1b[J"),
                };
                *height = table.lines().count();
                is_printed(&format!("{up}{table}"))
            }
        };
        self.feed.iter().for_each(|feed| feed.push(text.clone()));
        out
    }
}

#[derive(Serialize)]
struct Line<'a> {
    #[serde(flatten)]
    known: &'a Followed,
    #[serde(skip_serializing_if = "Option::is_none")]
    certified: Option<Value>,
}

/// Identifies all rows so far from time to time, beside the filter.
struct Certifier {
    model: Model,
    every_s: f64,
    /// Time of the record at which the next one begins, s.
    due_s: f64,
    rows: String,
    running: Option<JoinHandle<Value>>,
    /// The newest verdict.
    last: Value,
}

impl Certifier {
    /// The verdict of all rows.
    fn end(&mut self, last: &Option<Followed>) {
        let rows = std::mem::take(&mut self.rows);
        let time_s = last.as_ref().map_or(0.0, |known| known.time_s);
        self.last = certified(self.model.clone(), rows, time_s);
        (self.running, self.due_s) = (None, f64::INFINITY);
    }

    /// The newest verdict at a time of the record, s; begins the next one where it is due.
    fn at(&mut self, time_s: f64) -> Value {
        if self.running.as_ref().is_some_and(JoinHandle::is_finished) {
            let found = self.running.take().map(JoinHandle::join);
            self.last = found.and_then(Result::ok).unwrap_or_default();
        }
        if self.due_s == f64::NEG_INFINITY {
            self.due_s = time_s + self.every_s;
        }
        if time_s >= self.due_s && self.running.is_none() {
            self.due_s = time_s + self.every_s;
            let end = self.rows.rfind('\n').map_or(0, |at| at + 1);
            let (model, rows) = (self.model.clone(), self.rows[..end].to_owned());
            let work = move || certified(model, rows, time_s);
            self.running = std::thread::Builder::new().spawn(work).ok();
        }
        self.last.clone()
    }
}

/// What `identify` says of rows.
fn certified(model: Model, rows: String, time_s: f64) -> Value {
    let records = [vec![Part::bytes(ROWS, rows.into_bytes())]];
    let found = identify_records(model, &records, &Reading::default(), &Question::default());
    let (passes, verdict) = match &found {
        Ok(identified) => {
            let file = estimate_file(identified);
            let document = estimate_document(&file, Detail::Answer);
            (identified.passes(), document.verdict)
        }
        Err(error) => (false, error.to_string()),
    };
    json!({ "time_s": time_s, "passes": passes, "verdict": verdict })
}

/// The files of `identify` for the rows.
fn files(arguments: &Follow, folder: &Path, rows: PathBuf) -> Result<(), Error> {
    let mut request = IdentifyRequest::new(&arguments.model, [rows]);
    request.reading.map.clone_from(&arguments.map);
    let identified = identify(&request)?;
    let written = write_result(folder, &identified, command_line(), false, &[])?;
    noted(&written, arguments.quiet);
    Ok(())
}

fn unwritable(path: &Path, error: &std::io::Error) -> Error {
    Error::io(path, "cannot be written", error)
}

/// The bytes that are whole characters, as text; the rest waits. Bytes that are no UTF-8 are replaced.
fn whole_text(bytes: &mut Vec<u8>) -> String {
    let end = match std::str::from_utf8(bytes) {
        Err(e) if e.error_len().is_none() => e.valid_up_to(),
        _ => bytes.len(),
    };
    let rest = bytes.split_off(end);
    String::from_utf8_lossy(&std::mem::replace(bytes, rest)).into_owned()
}

type Chunks = Receiver<std::io::Result<Vec<u8>>>;

/// A thread reads, so that an interruption is noticed while nothing arrives.
fn chunks(arguments: &Follow, from_stream: bool) -> Result<Chunks, Error> {
    let unreadable = |e: std::io::Error| Error::io(&arguments.file, "cannot be read", &e);
    let mut source: Box<dyn Read + Send> = match from_stream {
        true => Box::new(std::io::stdin()),
        false => {
            let opened = open(&arguments.file);
            let (file, _) = opened.map_err(|e| e.fault("E0201", &arguments.file))?;
            Box::new(file)
        }
    };
    let waits = arguments.wait && !from_stream;
    let (sender, receiver) = sync_channel(WAITING);
    let read = move || {
        let mut buffer = vec![0; CHUNK];
        loop {
            let chunk = match source.read(&mut buffer) {
                Ok(0) if waits => {
                    std::thread::sleep(LOOK);
                    continue;
                }
                Ok(0) => return,
                Ok(count) => Ok(buffer[..count].to_vec()),
                Err(e) if e.kind() == ErrorKind::Interrupted => continue,
                Err(e) => Err(e),
            };
            let failed = chunk.is_err();
            if sender.send(chunk).is_err() || failed {
                return;
            }
        }
    };
    let thread = std::thread::Builder::new().spawn(read);
    thread.map_err(unreadable)?;
    Ok(receiver)
}
