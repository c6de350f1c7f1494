//! Opens inputs: regular files only, read up to a size limit.

use crate::{Fault, FaultKind, Faults, Place, check_memory, rounded};
use std::fs::{File, Metadata, OpenOptions};
use std::io::{self, ErrorKind, Read};
use std::path::Path;

/// Memory of what is made of a file, of its size at most: 66 was measured, of JSON whose objects have one short member each.
const PARSED: f64 = 80.0;

/// Why an input cannot be read.
#[derive(Debug)]
pub enum InputError {
    /// File not found, with the error of the operating system.
    Missing(io::Error),
    /// A folder.
    Folder,
    /// A pipe, a device or a socket: reading it may never end.
    NotRegular,
    /// File larger than the limit.
    TooLarge {
        /// The limit, bytes.
        limit: u64,
    },
    /// What is made of it needs more memory than its limit: E0006.
    Memory(Faults),
    /// Not UTF-8.
    NotText {
        /// First byte that is not UTF-8, from zero.
        byte: usize,
    },
    /// Error of the operating system.
    System(io::Error),
}

impl InputError {
    /// The faults of a file that cannot be read.
    pub fn fault(self, code: &'static str, path: &Path) -> Faults {
        let kind = match self {
            Self::Memory(faults) => return faults,
            Self::System(_) => FaultKind::System,
            _ => FaultKind::Input,
        };
        let fault = Fault::new(code, Place::file(path), self.to_string(), self.advice());
        fault.of_kind(kind).into()
    }

    /// The faults of a result that cannot be read: E0601, of the system E0002.
    pub fn of_result(self, path: &Path) -> Faults {
        match self {
            Self::Memory(faults) => faults,
            Self::System(source) => Faults::io(path, "cannot be read", &source),
            Self::Missing(_) => {
                let advice = "give the folder of identify --out";
                Faults::report(path, "there is no such file", advice)
            }
            other => Faults::report(path, &other, other.advice()),
        }
    }

    /// Advice to the user.
    pub fn advice(&self) -> &'static str {
        match self {
            Self::Missing(_) => "check the path",
            Self::Folder => "name the file in it",
            Self::NotRegular => "name a file; save the output of a pipe to a file first",
            Self::TooLarge { .. } => "name a file of the right kind",
            Self::Memory(_) => "raise --limit-memory",
            Self::NotText { .. } => "save the file as UTF-8 text",
            Self::System(_) => "check disk and permission",
        }
    }
}

impl std::fmt::Display for InputError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Missing(_) => write!(f, "there is no such file"),
            Self::Folder => write!(f, "this is a folder"),
            Self::NotRegular => write!(f, "this is not a regular file"),
            Self::TooLarge { limit } => write!(f, "the file is larger than {} MiB", limit >> 20),
            Self::Memory(faults) => write!(f, "{faults}"),
            Self::NotText { byte } => write!(f, "byte {byte} is not UTF-8"),
            Self::System(source) => write!(f, "cannot be read: {source}"),
        }
    }
}

impl std::error::Error for InputError {}

impl From<io::Error> for InputError {
    fn from(source: io::Error) -> Self {
        match source.kind() {
            // "a.csv/b", where "a.csv" is a file.
            ErrorKind::NotFound | ErrorKind::NotADirectory | ErrorKind::InvalidFilename => {
                Self::Missing(source)
            }
            ErrorKind::IsADirectory => Self::Folder,
            _ => Self::System(source),
        }
    }
}

/// Opens a regular file for reading.
///
/// # Errors
/// The file is missing, not a regular file, or cannot be opened.
pub fn open(path: &Path) -> Result<(File, Metadata), InputError> {
    check_kind(&std::fs::metadata(path)?)?;
    let mut options = OpenOptions::new();
    options.read(true);
    #[cfg(unix)]
    {
        use std::os::unix::fs::OpenOptionsExt;
        // Without O_NONBLOCK, opening a pipe that has replaced the file would block.
        options.custom_flags(libc::O_NONBLOCK);
    }
    let file = options.open(path)?;
    let metadata = file.metadata()?;
    check_kind(&metadata)?;
    Ok((file, metadata))
}

fn check_kind(metadata: &Metadata) -> Result<(), InputError> {
    match metadata.file_type() {
        kind if kind.is_file() => Ok(()),
        kind if kind.is_dir() => Err(InputError::Folder),
        _ => Err(InputError::NotRegular),
    }
}

/// Reads a regular file of at most `limit` bytes, of which values are made in memory.
///
/// # Errors
/// As [`open`], the file is larger, or the memory of its values is not there.
pub fn read(path: &Path, limit: u64) -> Result<Vec<u8>, InputError> {
    let (file, metadata) = open(path)?;
    if metadata.len() > limit {
        return Err(InputError::TooLarge { limit });
    }
    let length = metadata.len() as f64;
    let what = format!("the {} bytes of {}", rounded(length, 3), path.display());
    check_memory(&what, PARSED * length).map_err(InputError::Memory)?;
    let mut bytes = Vec::new();
    // The file may grow while it is read, and some system files declare no size.
    file.take(limit + 1).read_to_end(&mut bytes)?;
    match bytes.len() as u64 > limit {
        true => Err(InputError::TooLarge { limit }),
        false => Ok(bytes),
    }
}

/// Reads a regular file of at most `limit` bytes as UTF-8 text.
///
/// # Errors
/// As [`read`], or the bytes are not UTF-8.
pub fn read_text(path: &Path, limit: u64) -> Result<String, InputError> {
    String::from_utf8(read(path, limit)?).map_err(|error| InputError::NotText {
        byte: error.utf8_error().valid_up_to(),
    })
}

/// Reads a model, a case or a plan: at most 16 MiB of UTF-8 text, whose tables are made in memory.
///
/// # Errors
/// As [`read_text`]; the memory is estimated of the characters that begin tables and values.
pub fn read_tree(path: &Path) -> Result<String, InputError> {
    let text = read_text(path, 16 << 20)?;
    // Measured of TOML at most: 1,140 bytes of a dotted key, 1,430 of `{b=1},`, 490 of `[1],`, 185 of a comma out of place; a
    // model has 8,100 of a sensor of 54 characters.
    let bytes = |byte| match byte {
        b'.' | b'=' => 2000.0,
        b'[' | b',' => 150.0,
        _ => 50.0,
    };
    let what = format!("the tables and values of {}", path.display());
    check_memory(&what, text.bytes().map(bytes).sum()).map_err(InputError::Memory)?;
    Ok(text)
}

/// Copies standard input to an unnamed temporary file, so that it can be read several times.
///
/// # Errors
/// Standard input cannot be read, or the disk is full.
pub fn standard_input() -> std::io::Result<File> {
    static SPOOLED: std::sync::OnceLock<File> = std::sync::OnceLock::new();
    let mut file = match SPOOLED.get() {
        Some(file) => file.try_clone()?,
        None => {
            let file = spooled(&mut std::io::stdin().lock())?;
            SPOOLED.get_or_init(|| file).try_clone()?
        }
    };
    std::io::Seek::rewind(&mut file)?;
    Ok(file)
}

/// Copies a stream to an unnamed temporary file.
///
/// # Errors
/// The stream cannot be read, or the disk is full.
pub fn spooled(stream: &mut dyn Read) -> std::io::Result<File> {
    let mut file = tempfile::tempfile()?;
    std::io::copy(stream, &mut file)?;
    Ok(file)
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn exact_the_limit_is_the_largest_size_that_is_read() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("x");
        std::fs::write(&path, "0123456789").unwrap();
        assert_eq!(read_text(&path, 10).unwrap(), "0123456789");
        assert!(matches!(
            read(&path, 9),
            Err(InputError::TooLarge { limit: 9 })
        ));
        assert!(matches!(read(folder.path(), 9), Err(InputError::Folder)));
        let below = path.join("y");
        assert!(matches!(read(&below, 9), Err(InputError::Missing(_))));
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn regress_devices_and_files_without_a_size_do_not_fill_the_memory() {
        let zero = read(Path::new("/dev/zero"), 1 << 20);
        assert!(matches!(zero, Err(InputError::NotRegular)));
        // A regular file of declared size 0 that has content.
        let long = read(Path::new("/proc/self/status"), 16);
        assert!(matches!(long, Err(InputError::TooLarge { limit: 16 })));
    }
}
