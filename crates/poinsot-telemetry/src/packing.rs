//! Files that are packed by gzip or Zstandard, and standard input.

use crate::TelemetryError;
use crate::error::Place;
use std::fs::File;
use std::io::{self, Read, Seek};
use std::path::Path;
use std::sync::OnceLock;

/// How the bytes of a file are packed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Packing {
    None,
    Gzip,
    Zstd,
}

impl Packing {
    /// By the first bytes; the file is left at its start.
    pub(crate) fn of(file: &mut File) -> io::Result<Self> {
        let mut first = Vec::new();
        file.by_ref().take(4).read_to_end(&mut first)?;
        file.rewind()?;
        Ok(match first.as_slice() {
            [0x1f, 0x8b, ..] => Self::Gzip,
            [0x28, 0xb5, 0x2f, 0xfd] => Self::Zstd,
            _ => Self::None,
        })
    }

    /// What the file holds, unpacked as it is read.
    pub(crate) fn reader(self, mut file: File) -> io::Result<Box<dyn Read>> {
        file.rewind()?;
        Ok(match self {
            Self::None => Box::new(file),
            Self::Gzip => Box::new(flate2::read::MultiGzDecoder::new(io::BufReader::new(file))),
            Self::Zstd => Box::new(zstd::stream::read::Decoder::new(file)?),
        })
    }
}

/// The name without the ending of a packed file.
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

/// A fault of the packed data, not of the disk.
pub(crate) fn damaged(path: &Path, source: io::Error) -> TelemetryError {
    use io::ErrorKind as Kind;
    match source.kind() {
        Kind::InvalidData | Kind::InvalidInput | Kind::UnexpectedEof | Kind::Other => {
            TelemetryError::Format {
                place: Place::file(path),
                why: format!("the packed data are damaged ({source}); copy the file again"),
            }
        }
        _ => TelemetryError::Io {
            path: path.to_owned(),
            what: "cannot be read",
            source,
        },
    }
}

/// Whether a path stands for standard input.
pub(crate) fn is_standard_input(path: &Path) -> bool {
    path.as_os_str() == "-"
}

/// All of standard input, on disk: it is read once and looked at several times.
pub(crate) fn standard_input() -> io::Result<File> {
    static SPOOLED: OnceLock<File> = OnceLock::new();
    let mut file = match SPOOLED.get() {
        Some(file) => file.try_clone()?,
        None => {
            let mut file = tempfile::tempfile()?;
            io::copy(&mut io::stdin().lock(), &mut file)?;
            SPOOLED.get_or_init(|| file).try_clone()?
        }
    };
    file.rewind()?;
    Ok(file)
}
