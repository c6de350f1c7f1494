//! Estimates the number of rows before reading. A file that is too large is rejected at once, with a row step that
//! fits.

use crate::error::Place;
use crate::plan::Plan;
use crate::{ReadOptions, TelemetryError};
use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom};
use std::path::Path;

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
    /// Lines of a text file, from their mean length in windows spread over it. Rewinds the file.
    pub(crate) fn of_text(file: &mut File, bytes: u64) -> io::Result<Self> {
        let step = (bytes / WINDOWS).max(WINDOW);
        let (mut read, mut lines) = (0_u64, 0_u64);
        let mut buffer = Vec::new();
        for at in (0..WINDOWS).map(|k| k * step).take_while(|at| *at < bytes) {
            file.seek(SeekFrom::Start(at))?;
            buffer.clear();
            read += file.by_ref().take(WINDOW).read_to_end(&mut buffer)? as u64;
            let ends = |end: u8| buffer.iter().filter(|b| **b == end).count() as u64;
            lines += ends(b'\n').max(ends(b'\r'));
        }
        file.rewind()?;
        let length = read as f64 / lines.max(1) as f64;
        Ok(Self::Estimated((bytes as f64 / length) as u64))
    }

    /// Lines of a stream, counted.
    pub(crate) fn of_lines(mut stream: impl Read) -> io::Result<Self> {
        let mut buffer = vec![0_u8; WINDOW as usize];
        let mut lines = 0;
        loop {
            let n = stream.read(&mut buffer)?;
            let read = buffer.get(..n).unwrap_or_default();
            if read.is_empty() {
                return Ok(Self::Declared(lines));
            }
            let ends = |end: u8| read.iter().filter(|b| **b == end).count() as u64;
            lines += ends(b'\n').max(ends(b'\r'));
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

/// Limit on the rows kept of a file.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Limit {
    /// Memory for samples, bytes.
    pub bytes: usize,
    /// Every n-th selected row is kept.
    pub every: usize,
}

impl Limit {
    /// Samples that fit: each row needs a time, a row number and one value per channel.
    pub(crate) fn samples(&self, channels: usize) -> usize {
        self.bytes / (8 * (channels + 2))
    }

    /// Returns an error before reading if all rows are requested and clearly exceed the limit.
    ///
    /// # Errors
    /// [`TelemetryError::TooLarge`].
    pub(crate) fn check_ahead(
        &self,
        path: &Path,
        plan: &Plan,
        options: &ReadOptions,
        rows: Rows,
    ) -> Result<(), TelemetryError> {
        if options.time_s.is_some() || !plan.filter.is_empty() {
            return Ok(());
        }
        let believed = match rows {
            Rows::Declared(n) => n as f64,
            Rows::Estimated(n) => n as f64 / SURELY,
        };
        let fit = self.samples(plan.channels.len());
        if believed / self.every as f64 <= fit as f64 {
            return Ok(());
        }
        Err(self.refusal(path, plan, rows.most()))
    }

    /// The error for this many selectable rows; names the row step that fits.
    pub(crate) fn refusal(&self, path: &Path, plan: &Plan, rows: u64) -> TelemetryError {
        let channels = plan.channels.len();
        let fit = self.samples(channels);
        let every = rows.div_ceil(fit.max(1) as u64);
        TelemetryError::TooLarge {
            place: Place::file(path),
            samples: rows.div_ceil(self.every as u64),
            fit,
            channels,
            mib: self.bytes >> 20,
            every: every.max(self.every as u64 + 1),
        }
    }
}
