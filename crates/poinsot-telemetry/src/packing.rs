//! Files compressed with gzip or Zstandard, and standard input.

use crate::bytes::{Opened, unreadable};
use poinsot_files::{Faults, Place};
use std::io::{self, Read};
use std::path::Path;

/// Largest ratio of unpacked to packed bytes; telemetry in which most channels stand still reaches a few hundred.
const LARGEST_RATIO: u64 = 1000;
/// Bytes to which any file may unpack.
const LEAST_BOUND: u64 = 256 << 20;

/// Compression of a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Packing {
    None,
    Gzip,
    Zstd,
}

impl Packing {
    /// Detects the compression from the first bytes.
    pub(crate) fn of(opened: &Opened) -> io::Result<Self> {
        Ok(match opened.first(4)?.as_slice() {
            [0x1f, 0x8b, ..] => Self::Gzip,
            // The second is a frame to be skipped, as parallel packers write it first.
            [0x28, 0xb5, 0x2f, 0xfd] | [0x50..=0x5f, 0x2a, 0x4d, 0x18] => Self::Zstd,
            _ => Self::None,
        })
    }

    /// Reader of the decompressed bytes.
    pub(crate) fn reader(self, opened: &Opened) -> io::Result<Box<dyn Read>> {
        let file = opened.file.reader_at(0);
        let most = LEAST_BOUND.max(opened.file.len.saturating_mul(LARGEST_RATIO));
        let bounded = |inner: Box<dyn Read>| Box::new(Bounded { inner, left: most });
        Ok(match self {
            Self::None => Box::new(file),
            Self::Gzip => bounded(Box::new(flate2::read::MultiGzDecoder::new(
                io::BufReader::new(file),
            ))),
            #[cfg(feature = "zstd")]
            Self::Zstd => bounded(Box::new(zstd::stream::read::Decoder::new(file)?)),
            #[cfg(not(feature = "zstd"))]
            Self::Zstd => {
                let what = "this build does not read Zstandard; unpack the file";
                return Err(io::Error::other(what));
            }
        })
    }
}

/// Reader that stops at data which were made to fill memory and time.
struct Bounded {
    inner: Box<dyn Read>,
    left: u64,
}

impl Read for Bounded {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let count = self.inner.read(buffer)?;
        self.left = self.left.checked_sub(count as u64).ok_or_else(|| {
            let what = format!("they unpack to more than {LARGEST_RATIO} times their size");
            io::Error::new(io::ErrorKind::InvalidData, what)
        })?;
        Ok(count)
    }
}

/// The name without the suffix of the compression.
pub(crate) fn unpacked_name(path: &Path) -> &Path {
    let ending = path
        .extension()
        .and_then(|e| e.to_str())
        .map(str::to_lowercase);
    match ending.as_deref() {
        Some("gz" | "gzip" | "zst" | "zstd") => path.file_stem().map_or(path, Path::new),
        _ => path,
    }
}

/// Converts a read error: damaged data give a format error, others an I/O error.
pub(crate) fn damaged(path: &Path, source: io::Error) -> Faults {
    use io::ErrorKind as Kind;
    match source.kind() {
        Kind::InvalidData | Kind::InvalidInput | Kind::UnexpectedEof | Kind::Other => {
            let problem = format!("the packed data are damaged ({source})");
            Faults::one("E0202", Place::file(path), problem, "copy the file again")
        }
        _ => unreadable(path)(source),
    }
}
