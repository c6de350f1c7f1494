//! Bytes of a file: shared by several readers, and rejected if they are not text.

use memchr::{memchr, memrchr};
use poinsot_files::{Faults, InputError, Place, standard_input};
use std::fmt::Debug;
use std::fs::{File, Metadata};
use std::io::{self, Cursor, Read, Seek, SeekFrom};
use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};

/// Longest line accepted, bytes; a file without line ends would otherwise fill the memory.
const MAX_LINE: usize = 16 << 20;

/// Bytes before the text that some programs write in UTF-8.
const BYTE_ORDER_MARK: &[u8] = b"\xef\xbb\xbf";

/// E0202: bytes that are no text; the reader of the text names the file.
fn no_text(problem: String, advice: &str) -> io::Error {
    io::Error::other(Faults::one("E0202", Place::default(), problem, advice))
}

/// What a file holds, on disk or in memory.
pub(crate) trait Content: Read + Seek + Send + Debug {}

impl<T: Read + Seek + Send + Debug> Content for T {}

/// A file for several readers, on several threads: its one position is moved and used under a lock.
#[derive(Debug, Clone)]
pub(crate) struct SharedFile {
    content: Arc<Mutex<dyn Content>>,
    /// Length at opening, bytes.
    pub len: u64,
}

impl SharedFile {
    /// A reader of its own, from this byte.
    pub fn reader_at(&self, start: u64) -> FromByte {
        let file = self.clone();
        FromByte { file, at: start }
    }
}

/// Reads a shared file from a byte on.
pub(crate) struct FromByte {
    file: SharedFile,
    at: u64,
}

impl Read for FromByte {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let content = self.file.content.lock();
        let mut file = content.unwrap_or_else(PoisonError::into_inner);
        file.seek(SeekFrom::Start(self.at))?;
        let n = file.read(buffer)?;
        self.at += n as u64;
        Ok(n)
    }
}

/// An opened file of telemetry.
#[derive(Debug, Clone)]
pub(crate) struct Opened {
    pub file: SharedFile,
    /// Metadata at opening; `None` for a stream or bytes.
    before: Option<Metadata>,
}

impl Opened {
    fn new(content: impl Content + 'static, len: u64, before: Option<Metadata>) -> Self {
        let content = Arc::new(Mutex::new(content));
        let file = SharedFile { content, len };
        Self { file, before }
    }

    /// Opens a stream that was copied to a file.
    pub(crate) fn stream(file: File) -> io::Result<Self> {
        let len = file.metadata()?.len();
        Ok(Self::new(file, len, None))
    }

    /// The content of a file in memory.
    pub(crate) fn bytes(bytes: Vec<u8>) -> Self {
        let len = bytes.len() as u64;
        Self::new(Cursor::new(bytes), len, None)
    }

    /// The first bytes; fewer if the file is shorter.
    pub(crate) fn first(&self, count: u64) -> io::Result<Vec<u8>> {
        let mut first = Vec::new();
        self.file.reader_at(0).take(count).read_to_end(&mut first)?;
        Ok(first)
    }
}

/// Turns an error of the operating system into that of a file which cannot be read.
pub(crate) fn unreadable(path: &Path) -> impl Fn(io::Error) -> Faults + '_ {
    |source| crate::error::unreadable(path, "cannot be read", &source)
}

pub(crate) fn is_standard_input(path: &Path) -> bool {
    path.as_os_str() == "-"
}

/// Opens a regular file, or standard input.
pub(crate) fn open(path: &Path) -> Result<Opened, Faults> {
    if is_standard_input(path) {
        let stream = standard_input().and_then(Opened::stream);
        return stream.map_err(unreadable(path));
    }
    let opened = poinsot_files::open(path).map_err(|error| match error {
        InputError::System(source) | InputError::Missing(source) => unreadable(path)(source),
        _ => Faults::one(
            "E0202",
            Place::file(path),
            "not a regular file",
            "give a .csv or .parquet file",
        ),
    });
    let (file, before) = opened?;
    Ok(Opened::new(file, before.len(), Some(before)))
}

/// Checks that the path still names the opened file.
pub(crate) fn check_unchanged(path: &Path, opened: &Opened) -> Result<(), Faults> {
    let same = opened.before.as_ref().is_none_or(|before| {
        let same = |now: Metadata| {
            now.len() == before.len() && now.modified().ok() == before.modified().ok()
        };
        std::fs::metadata(path).is_ok_and(same)
    });
    if same {
        return Ok(());
    }
    let problem = "the file changed during reading";
    let advice = "use it when it is complete";
    Err(Faults::one("E0202", Place::file(path), problem, advice))
}

/// Reader that stops at bytes that are not text. It converts line ends to `\n`, so that line numbers are consistent.
pub(crate) struct TextBytes<R> {
    inner: R,
    offset: u64,
    line: usize,
    after_cr: bool,
    last: u8,
    /// Lines still to be skipped.
    skip: u64,
}

impl<R: Read> TextBytes<R> {
    /// Creates a reader that skips the first `skip` lines.
    pub(crate) fn new(inner: R, skip: u64) -> Self {
        Self {
            inner,
            offset: 0,
            line: 0,
            after_cr: false,
            last: 0,
            skip,
        }
    }

    /// Removes the skipped lines; returns the number of bytes left.
    fn without_head(&mut self, bytes: &mut [u8]) -> usize {
        let mut from = 0;
        while self.skip > 0 {
            let rest = bytes.get(from..).unwrap_or_default();
            match memchr(b'\n', rest) {
                Some(at) => {
                    from += at + 1;
                    self.skip -= 1;
                }
                None => return 0,
            }
        }
        bytes.copy_within(from.., 0);
        bytes.len() - from
    }

    /// Whether the last byte read ends a line.
    pub(crate) fn ends_a_line(&self) -> bool {
        self.last == b'\n'
    }

    /// Converts `\r` and `\r\n` to `\n` in place; returns the number of bytes left.
    fn plain_line_ends(&mut self, bytes: &mut [u8]) -> usize {
        if !self.after_cr && memchr(b'\r', bytes).is_none() {
            return bytes.len();
        }
        let mut kept = 0;
        for k in 0..bytes.len() {
            let Some(&byte) = bytes.get(k) else { break };
            let second_half = self.after_cr && byte == b'\n';
            self.after_cr = byte == b'\r';
            if second_half {
                continue;
            }
            if let Some(slot) = bytes.get_mut(kept) {
                *slot = if self.after_cr { b'\n' } else { byte };
            }
            kept += 1;
        }
        kept
    }
}

impl<R: Read> Read for TextBytes<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        loop {
            let mut n = self.inner.read(buffer)?;
            if n == 0 {
                return Ok(0);
            }
            let begins = buffer.get(..n).unwrap_or_default();
            if self.offset == 0 && begins.starts_with(BYTE_ORDER_MARK) {
                let mark = BYTE_ORDER_MARK.len();
                buffer.copy_within(mark..n, 0);
                self.offset = mark as u64;
                n -= mark;
            }
            let read = buffer.get_mut(..n).unwrap_or_default();
            if let Some(at) = memchr(0, read) {
                let byte = self.offset + at as u64;
                let problem = format!("byte {byte} is NUL: the file is not text, or is UTF-16");
                return Err(no_text(problem, "save it as UTF-8"));
            }
            self.offset += n as u64;
            let mut kept = self.plain_line_ends(read);
            if self.skip > 0 {
                kept = self.without_head(read.get_mut(..kept).unwrap_or_default());
            }
            let text = read.get(..kept).unwrap_or_default();
            match memrchr(b'\n', text) {
                Some(at) => self.line = kept - at - 1,
                None => self.line += kept,
            }
            if self.line > MAX_LINE {
                let problem = format!(
                    "a line is longer than 16 MiB (at byte {}): the file is damaged or is not CSV",
                    self.offset
                );
                return Err(no_text(problem, "write it again, a line for each row"));
            }
            if let Some(&last) = text.last() {
                self.last = last;
                return Ok(kept);
            }
        }
    }
}
