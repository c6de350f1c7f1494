//! `poinsot follow`

use super::{Outcome, command_line, exit_of, note, noted};
use crate::arguments::Follow;
use poinsot::{Error, Follower, IdentifyRequest, check_outputs, identify, write_result};
use poinsot_design::interrupt::{Listening, is_requested};
use poinsot_files::{Faults, growing, open};
use std::io::{ErrorKind, Read, Write};
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, RecvTimeoutError, sync_channel};
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
            check_outputs(
                "--out",
                &[folder.join("estimate.json")],
                &[&arguments.model],
            )?;
            let path = folder.join(ROWS);
            let create = || growing(&path).map_err(|e| unwritable(&path, &e));
            from_stream.then(create).transpose()?
        }
        None => None,
    };
    let map = arguments.map.as_deref();
    let mut follower = Follower::new(&arguments.model, map, arguments.line_s)?;
    if !arguments.quiet {
        follower.assumed().iter().for_each(|line| note(line));
    }
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
                .map_err(|e| unwritable(&arguments.file, &e))?;
        }
        kept.extend(chunk);
        for line in follower.push(&whole_text(&mut kept))? {
            if !printed(&line) {
                return Ok(exit_of(true));
            }
        }
        if is_requested() {
            break;
        }
    }
    let last = follower.end();
    let determined = last
        .as_ref()
        .is_some_and(|l| l.contains("\"health\":\"determined\""));
    last.iter().for_each(|line| {
        printed(line);
    });
    if let Some(folder) = &arguments.out {
        let rows = if from_stream {
            folder.join(ROWS)
        } else {
            arguments.file.clone()
        };
        files(arguments, folder, rows)?;
    }
    Ok(exit_of(determined))
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

/// Prints a line at once; false where the reader has closed the stream.
fn printed(line: &str) -> bool {
    let mut out = std::io::stdout().lock();
    writeln!(out, "{line}").and_then(|()| out.flush()).is_ok()
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
            let (file, _) = opened.map_err(|e| Faults::from(e.fault("E0201", &arguments.file)))?;
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
