//! Files compressed with gzip or Zstandard, and standard input.

use crate::bytes::{Opened, unreadable};
use poinsot_files::{Faults, Place};
use std::io::{self, Read};
use std::path::Path;

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
            [0x28, 0xb5, 0x2f, 0xfd] => Self::Zstd,
            _ => Self::None,
        })
    }

    /// Reader of the decompressed bytes.
    pub(crate) fn reader(self, opened: &Opened) -> io::Result<Box<dyn Read>> {
        let file = opened.file.reader_at(0);
        Ok(match self {
            Self::None => Box::new(file),
            Self::Gzip => Box::new(flate2::read::MultiGzDecoder::new(io::BufReader::new(file))),
            #[cfg(feature = "zstd")]
            Self::Zstd => Box::new(zstd::stream::read::Decoder::new(file)?),
            #[cfg(not(feature = "zstd"))]
            Self::Zstd => {
                return Err(io::Error::other(
                    "this build does not read Zstandard; unpack the file",
                ));
            }
        })
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
        Kind::InvalidData | Kind::InvalidInput | Kind::UnexpectedEof | Kind::Other => Faults::one(
            "E0202",
            Place::file(path),
            format!("the packed data are damaged ({source})"),
            "copy the file again",
        ),
        _ => unreadable(path)(source),
    }
}
