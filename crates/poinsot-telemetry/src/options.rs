//! What is asked of telemetry files.

use crate::{Mounting, Origin, TelemetryMap};
use std::collections::BTreeSet;

/// What is asked of the files of one segment.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ReadOptions {
    /// What the files hold where it is not standard names in SI.
    pub map: TelemetryMap,
    /// What the times count from; `None`: the first row read decides, see [`Table::origin`](crate::Table::origin).
    pub origin: Option<Origin>,
    /// Channels asked for: `omega_x` (of any sensor) or `imu2.omega_x`. `None` takes every column with a
    /// standard name. Mapped columns count as asked for. All others are not parsed and listed in [`Table::ignored`](crate::Table::ignored).
    pub wanted: Option<BTreeSet<String>>,
    /// No repairs: what would be repaired is an error.
    pub strict: bool,
    /// Keep the whole rows of a file that ends inside a row.
    pub recover: bool,
    /// Encoding of CSV text.
    pub encoding: Encoding,
    /// Rows with times outside of this are not kept, s.
    pub time_s: Option<[f64; 2]>,
    /// Of the rows kept only each n-th; 0 and 1 keep all.
    pub every: usize,
    /// Most memory for the samples of one file, MiB; 0 stands for [`MEMORY_MIB`].
    pub memory_mib: usize,
    /// Sensors whose columns are in axes of their own; the table is in those of their bodies.
    pub mountings: Vec<Mounting>,
    /// Refuse a table whose attitude and gyro contradict the declared conventions ([`check_conventions`](crate::check_conventions)).
    pub check_conventions: bool,
    /// Refuse a file that holds several runs, far apart: each is a segment of its own.
    pub one_run: bool,
}

/// Usual limit of the memory for the samples of one file, MiB.
pub const MEMORY_MIB: usize = 256;

/// How the bytes of a CSV file are text.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Encoding {
    /// UTF-8, with or without byte order mark.
    #[default]
    Utf8,
    /// ISO 8859-1, where each byte is one character.
    Latin1,
}
