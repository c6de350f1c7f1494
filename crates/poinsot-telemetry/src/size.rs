//! Estimates the number of rows before reading.

use crate::bytes::Opened;
use std::io::{self, Read};

/// Number of windows in which lines are counted, and their size in bytes.
const WINDOWS: u64 = 16;
const WINDOW: u64 = 1 << 16;
/// Safety factor on an estimated number of rows.
const MARGIN: f64 = 1.05;
/// Ratio of estimate to limit above which a file is rejected before reading.
const SURELY: f64 = 1.5;

/// Number of rows of a file.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Rows {
    /// Declared in a footer, or counted.
    Declared(u64),
    /// Estimated from sampled windows.
    Estimated(u64),
}

impl Rows {
    /// Lines of a text file, from their mean length in windows spread over it.
    pub(crate) fn of_text(opened: &Opened) -> io::Result<Self> {
        let bytes = opened.file.len;
        let step = (bytes / WINDOWS).max(WINDOW);
        let (mut read, mut lines) = (0_u64, 0_u64);
        let mut buffer = Vec::new();
        for at in (0..WINDOWS).map(|k| k * step).take_while(|at| *at < bytes) {
            buffer.clear();
            let mut window = opened.file.reader_at(at).take(WINDOW);
            read += window.read_to_end(&mut buffer)? as u64;
            lines += line_ends(&buffer);
        }
        let length = read as f64 / lines.max(1) as f64;
        Ok(Self::Estimated((bytes as f64 / length) as u64))
    }

    /// Lines of a stream, counted.
    pub(crate) fn of_lines(mut stream: impl Read) -> io::Result<Self> {
        let mut buffer = vec![0_u8; WINDOW as usize];
        let mut lines = 0;
        loop {
            let n = stream.read(&mut buffer)?;
            if n == 0 {
                return Ok(Self::Declared(lines));
            }
            lines += line_ends(buffer.get(..n).unwrap_or_default());
        }
    }

    /// Lower bound: fewer than an estimate surely says.
    pub(crate) fn least(self) -> f64 {
        match self {
            Self::Declared(n) => n as f64,
            Self::Estimated(n) => n as f64 / SURELY,
        }
    }

    /// Upper bound of the rows, with margin for an estimate.
    pub(crate) fn most(self) -> u64 {
        match self {
            Self::Declared(n) => n,
            Self::Estimated(n) => (n as f64 * MARGIN).ceil() as u64,
        }
    }
}

fn line_ends(text: &[u8]) -> u64 {
    let count = |end: u8| text.iter().filter(|b| **b == end).count() as u64;
    count(b'\n').max(count(b'\r'))
}
