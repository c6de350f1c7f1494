//! The checksum of a Parquet file of telemetry: SHA-256 of all its bytes, in the place of 64 zeros of its footer.
//! Checksums of pages, which other writers have, are compared by the decoder, which cannot write them.

use crate::bytes::{Opened, SharedFile};
use crate::content_hash::sha256;
use parquet::file::metadata::{KeyValue, ParquetMetaData};
use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::sync::atomic::AtomicBool;

/// Key of the checksum among those that an application adds to a footer.
const KEY: &str = "sha256";
/// Digits of a checksum.
const DIGITS: usize = 64;
/// Bytes behind a footer: its length in four, and the name of the format.
const END: u64 = 8;

/// What a footer holds until the file is sealed.
pub(crate) fn unsealed() -> KeyValue {
    KeyValue::new(KEY.to_owned(), "0".repeat(DIGITS))
}

/// Writes the checksum of a whole file into its footer.
pub(crate) fn seal(file: &mut File) -> io::Result<()> {
    let shared = Opened::stream(file.try_clone()?)?.file;
    let no_place = || io::Error::other("the footer has no place for the checksum");
    let at = place(&shared, &"0".repeat(DIGITS))?.ok_or_else(no_place)?;
    let sum = sum(&shared, at)?;
    file.seek(SeekFrom::Start(at))?;
    file.write_all(sum.as_bytes())
}

/// Whether a file is as it was sealed; a file without checksum is.
pub(crate) fn is_intact(file: &SharedFile, metadata: &ParquetMetaData) -> io::Result<bool> {
    let entries = metadata.file_metadata().key_value_metadata();
    let sealed = entries.into_iter().flatten().find(|e| e.key == KEY);
    let Some(stated) = sealed.and_then(|e| e.value.as_deref()) else {
        return Ok(true);
    };
    match place(file, stated)? {
        Some(at) if stated.len() == DIGITS => Ok(sum(file, at)? == stated),
        _ => Ok(false),
    }
}

/// Where the footer holds this text.
fn place(file: &SharedFile, text: &str) -> io::Result<Option<u64>> {
    let mut length = [0_u8; 4];
    let end = file.len.saturating_sub(END);
    file.reader_at(end).read_exact(&mut length)?;
    let start = end.saturating_sub(u64::from(u32::from_le_bytes(length)));
    let mut footer = Vec::new();
    file.reader_at(start)
        .take(end - start)
        .read_to_end(&mut footer)?;
    let at = memchr::memmem::rfind(&footer, text.as_bytes());
    Ok(at.map(|at| start + at as u64))
}

/// SHA-256 of a file with zeros in the place of its checksum.
fn sum(file: &SharedFile, at: u64) -> io::Result<String> {
    let before = file.reader_at(0).take(at);
    let zeros = io::repeat(b'0').take(DIGITS as u64);
    let after = file.reader_at(at + DIGITS as u64);
    sha256(before.chain(zeros).chain(after), &AtomicBool::new(false))
}
