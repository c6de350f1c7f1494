//! Options of reading telemetry.

use crate::{FileMap, Mounting, Origin, TelemetryMap};
use std::collections::{BTreeMap, BTreeSet};

/// Options for the files of one segment.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ReadOptions {
    /// Map of columns that are not standard names in SI.
    pub map: TelemetryMap,
    /// Origin of the times; `None`: set by the first row, see [`Table::origin`](crate::Table::origin).
    pub origin: Option<Origin>,
    /// Requested channels: `omega_x` (of any sensor) or `imu2.omega_x`. `None` takes every column with a standard
    /// name. Mapped columns count as requested. Others are not parsed, and are listed in
    /// [`Table::ignored`](crate::Table::ignored).
    pub wanted: Option<BTreeSet<String>>,
    /// Treat every repair as an error.
    pub strict: bool,
    /// Keep the complete rows of a file that ends inside a row.
    pub recover: bool,
    /// Encoding of CSV text.
    pub encoding: Encoding,
    /// Keep rows with times in this range, s: of the files' own count, or since the origin where the range ends before 1e7 s.
    pub time_s: Option<[f64; 2]>,
    /// Keep every n-th of these rows; 0 and 1 keep all.
    pub every: usize,
    /// Memory limit for the samples of one file, MiB; 0 means [`MEMORY_MIB`].
    pub memory_mib: usize,
    /// Sensors whose columns are in sensor axes; the table is in body axes.
    pub mountings: Vec<Mounting>,
    /// Spin inertia of each wheel, kg m2, over which a momentum is its speed; `None`: no model is known, and momenta are left out.
    pub spin_inertia: Option<BTreeMap<String, f64>>,
    /// Return an error if attitude and gyro contradict the declared conventions
    /// ([`check_conventions`](crate::check_conventions)).
    pub check_conventions: bool,
    /// Return an error if a file holds several runs far apart: each must be its own segment.
    pub one_run: bool,
}

impl ReadOptions {
    /// These options for a source with its own map.
    pub(crate) fn with_map(&self, all: FileMap) -> Self {
        Self {
            map: TelemetryMap {
                all,
                ..TelemetryMap::default()
            },
            ..self.clone()
        }
    }

    /// Memory limit with its default, MiB; at most what the limit of the command leaves.
    pub(crate) fn memory_limit_mib(&self) -> usize {
        let asked = match self.memory_mib {
            0 => MEMORY_MIB,
            mib => mib,
        };
        let most = poinsot_files::memory_limit() / COPIES / f64::from(1 << 20);
        asked.min(most as usize).max(1)
    }
}

/// Memory that a reader needs over that of the samples.
const COPIES: f64 = 2.0;

/// Default memory limit for the samples of one file, MiB.
pub const MEMORY_MIB: usize = 256;

/// Encoding of a CSV file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Encoding {
    /// UTF-8, with or without byte order mark.
    #[default]
    Utf8,
    /// ISO 8859-1: one byte per character.
    Latin1,
}

impl Encoding {
    /// Names for the command line.
    pub const NAMES: [&'static str; 2] = ["utf8", "latin1"];

    /// By its name.
    pub fn from_name(name: &str) -> Option<Self> {
        let at = Self::NAMES.iter().position(|own| *own == name)?;
        [Self::Utf8, Self::Latin1].get(at).copied()
    }
}
