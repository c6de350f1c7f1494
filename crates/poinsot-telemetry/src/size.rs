//! How many rows a file has, before it is read: what does not fit is refused at once, with a step that fits.

use crate::error::Place;
use crate::plan::Plan;
use crate::{ReadOptions, TelemetryError};
use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom};
use std::path::Path;

/// Places at which lines are counted, and bytes counted there.
const WINDOWS: u64 = 16;
const WINDOW: u64 = 1 << 16;
/// By how much more rows than estimated are reckoned with.
const MARGIN: f64 = 1.05;
/// An estimate beyond this multiple of what fits is believed before the rows are read.
const SURELY: f64 = 1.5;

/// Rows of a file.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Rows {
    /// As a footer declares them, or counted.
    Declared(u64),
    /// From lines counted here and there.
    Estimated(u64),
}

impl Rows {
    /// Lines of a text file, from their mean length in windows spread over it. The file is left at its start.
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

    /// Rows that will not be exceeded, or hardly.
    pub(crate) fn most(self) -> u64 {
        match self {
            Self::Declared(n) => n,
            Self::Estimated(n) => (n as f64 * MARGIN).ceil() as u64,
        }
    }
}

/// What may be kept of a file.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Limit {
    /// Memory for samples, bytes.
    pub bytes: usize,
    /// Of the rows chosen each n-th is kept.
    pub every: usize,
}

impl Limit {
    /// Samples that fit: per row a time, its place in the file, and a value in each channel.
    pub(crate) fn samples(&self, channels: usize) -> usize {
        self.bytes / (8 * (channels + 2))
    }

    /// Refuses before anything is read where every row is asked for and there are clearly too many.
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

    /// The error for so many rows to choose from; names the step with which they fit.
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
