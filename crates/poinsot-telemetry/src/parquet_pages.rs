//! Checksums of Parquet pages (CRC-32 of the bytes as stored, field `crc` of the page header) and the place of the
//! first mismatch.
//!
//! The decoder reports neither the pages with a checksum nor the rows of a bad page. The page headers are therefore
//! parsed here (`parquet.thrift`, Thrift compact protocol).

use crate::parquet_bytes::{FromByte, ParquetBytes};
use crc32fast::Hasher;
use parquet::file::metadata::ParquetMetaData;
use std::io::{self, BufReader, Read, Take};

/// Deepest nesting in a page header; the format has 3.
const DEPTH: usize = 8;

/// Bytes hashed per read.
const CHUNK: usize = 1 << 16;

/// Checksums of the selected columns.
#[derive(Debug, Default)]
pub(crate) struct Checksums {
    /// Number of pages.
    pub pages: usize,
    /// Number of pages with a checksum.
    pub compared: usize,
    /// The bad page with the earliest row.
    pub bad: Option<BadPage>,
}

/// A page whose bytes do not match its checksum.
#[derive(Debug, PartialEq, Eq)]
pub(crate) struct BadPage {
    /// First affected row, from zero.
    pub row: u64,
    /// Column.
    pub column: String,
}

/// Compares the checksums of all pages of the selected columns. A header that cannot be parsed ends its column chunk;
/// the decoder reports the fault.
///
/// # Errors
/// Reading fails.
pub(crate) fn compare(
    file: &ParquetBytes,
    metadata: &ParquetMetaData,
    leaves: &[usize],
) -> io::Result<Checksums> {
    let mut found = Checksums::default();
    let mut first_row = 0;
    for group in metadata.row_groups() {
        let chosen = group.columns().iter().enumerate();
        for (_, column) in chosen.filter(|(k, _)| leaves.contains(k)) {
            let (start, length) = column.byte_range();
            let mut pages = BufReader::with_capacity(CHUNK, file.reader_at(start)).take(length);
            if let Some(rows_before) = compare_chunk(&mut pages, &mut found)? {
                let row = first_row + rows_before;
                if found.bad.as_ref().is_none_or(|bad| row < bad.row) {
                    let column = column.column_path().string();
                    found.bad = Some(BadPage { row, column });
                }
            }
        }
        first_row += u64::try_from(group.num_rows()).unwrap_or(0);
    }
    Ok(found)
}

/// Compares the pages of a column chunk; returns the rows before the first bad page.
fn compare_chunk(pages: &mut Pages, found: &mut Checksums) -> io::Result<Option<u64>> {
    let mut rows = 0;
    while pages.limit() > 0 {
        let Some(page) = Header::read(pages)? else {
            return Ok(None);
        };
        let Some(crc) = hash(pages, page.size)? else {
            return Ok(None);
        };
        found.pages += 1;
        if let Some(stored) = page.crc {
            found.compared += 1;
            if crc != stored {
                return Ok(Some(rows));
            }
        }
        rows += page.rows;
    }
    Ok(None)
}

type Pages = Take<BufReader<FromByte>>;

/// CRC-32 of the next bytes; `None` if there are fewer.
fn hash(pages: &mut Pages, size: u64) -> io::Result<Option<u32>> {
    let mut hasher = Hasher::new();
    let mut buffer = vec![0; CHUNK];
    let mut left = size;
    while left > 0 {
        let most = usize::try_from(left).map_or(CHUNK, |n| n.min(CHUNK));
        let n = pages.read(buffer.get_mut(..most).unwrap_or_default())?;
        if n == 0 {
            return Ok(None);
        }
        hasher.update(buffer.get(..n).unwrap_or_default());
        left -= n as u64;
    }
    Ok(Some(hasher.finalize()))
}

/// Required fields of a page header.
#[derive(Default)]
struct Header {
    /// Stored size of the page, bytes.
    size: u64,
    crc: Option<u32>,
    /// Rows of a data page of a flat column; zero for a dictionary.
    rows: u64,
}

impl Header {
    /// `None` if the bytes are not a page header.
    fn read(pages: &mut Pages) -> io::Result<Option<Self>> {
        let mut header = Self::default();
        let read = fields(pages, |pages, id, kind| {
            match (id, kind) {
                (3, I32) => {
                    header.size = u64::try_from(zigzag(pages)?).map_err(|_| HeaderError::No)?
                }
                // The CRC is stored as a signed number.
                (4, I32) => header.crc = Some(zigzag(pages)? as u32),
                // Headers of data pages, versions 1 and 2: the first field is the number of values.
                (5 | 8, STRUCT) => fields(pages, |pages, id, kind| match (id, kind) {
                    (1, I32) => {
                        header.rows = u64::try_from(zigzag(pages)?).map_err(|_| HeaderError::No)?;
                        Ok(())
                    }
                    _ => skip(pages, kind, DEPTH),
                })?,
                _ => skip(pages, kind, DEPTH)?,
            }
            Ok(())
        });
        match read {
            Ok(()) => Ok(Some(header)),
            Err(HeaderError::No) => Ok(None),
            Err(HeaderError::Disk(error)) => Err(error),
        }
    }
}

/// Type codes of the compact protocol.
const I32: u8 = 5;
const STRUCT: u8 = 12;

/// Why a header cannot be read.
enum HeaderError {
    /// Invalid bytes.
    No,
    /// Reading failed.
    Disk(io::Error),
}

/// Parses the fields of a struct; `each` receives id and type of a field and consumes its value.
fn fields(
    pages: &mut Pages,
    mut each: impl FnMut(&mut Pages, i64, u8) -> Result<(), HeaderError>,
) -> Result<(), HeaderError> {
    let mut id = 0;
    loop {
        let head = byte(pages)?;
        if head == 0 {
            return Ok(());
        }
        id = match head >> 4 {
            0 => zigzag(pages)?,
            step => id + i64::from(step),
        };
        each(pages, id, head & 15)?;
    }
}

/// Skips a value. Every value takes at least one byte, except a flag in a field header, so the size of the chunk
/// bounds the work.
fn skip(pages: &mut Pages, kind: u8, depth: usize) -> Result<(), HeaderError> {
    let depth = depth.checked_sub(1).ok_or(HeaderError::No)?;
    match kind {
        1 | 2 => {}
        3 => {
            byte(pages)?;
        }
        4..=6 => {
            varint(pages)?;
        }
        7 => skip_bytes(pages, 8)?,
        8 => {
            let length = varint(pages)?;
            skip_bytes(pages, length)?;
        }
        9 | 10 => {
            let head = byte(pages)?;
            let count = match head >> 4 {
                15 => varint(pages)?,
                count => u64::from(count),
            };
            for _ in 0..count {
                skip_element(pages, head & 15, depth)?;
            }
        }
        11 => {
            let count = varint(pages)?;
            let kinds = if count > 0 { byte(pages)? } else { 0 };
            for _ in 0..count {
                skip_element(pages, kinds >> 4, depth)?;
                skip_element(pages, kinds & 15, depth)?;
            }
        }
        STRUCT => fields(pages, |pages, _, kind| skip(pages, kind, depth))?,
        _ => return Err(HeaderError::No),
    }
    Ok(())
}

/// Skips an element of a list, where a flag takes one byte.
fn skip_element(pages: &mut Pages, kind: u8, depth: usize) -> Result<(), HeaderError> {
    skip(pages, if kind <= 2 { 3 } else { kind }, depth)
}

fn skip_bytes(pages: &mut Pages, count: u64) -> Result<(), HeaderError> {
    let skipped = io::copy(&mut pages.take(count), &mut io::sink()).map_err(HeaderError::Disk)?;
    match skipped == count {
        true => Ok(()),
        false => Err(HeaderError::No),
    }
}

fn zigzag(pages: &mut Pages) -> Result<i64, HeaderError> {
    let n = varint(pages)?;
    Ok((n >> 1) as i64 ^ -((n & 1) as i64))
}

fn varint(pages: &mut Pages) -> Result<u64, HeaderError> {
    let mut value = 0;
    for shift in (0..63).step_by(7) {
        let byte = byte(pages)?;
        value |= u64::from(byte & 127) << shift;
        if byte < 128 {
            return Ok(value);
        }
    }
    Err(HeaderError::No)
}

fn byte(pages: &mut Pages) -> Result<u8, HeaderError> {
    let mut one = [0];
    match pages.read(&mut one) {
        Ok(0) => Err(HeaderError::No),
        Ok(_) => Ok(one[0]),
        Err(error) => Err(HeaderError::Disk(error)),
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use parquet::file::reader::{FileReader, SerializedFileReader};
    use std::path::Path;

    fn data(version: &str) -> Vec<u8> {
        let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data");
        std::fs::read(data.join(format!("checksums_{version}.parquet"))).unwrap()
    }

    fn metadata(bytes: &[u8]) -> ParquetMetaData {
        let reader = SerializedFileReader::new(bytes::Bytes::copy_from_slice(bytes)).unwrap();
        reader.metadata().clone()
    }

    fn all(metadata: &ParquetMetaData) -> Vec<usize> {
        (0..metadata.row_group(0).num_columns()).collect()
    }

    fn file(bytes: &[u8]) -> ParquetBytes {
        let mut file = tempfile::tempfile().unwrap();
        io::Write::write_all(&mut file, bytes).unwrap();
        ParquetBytes::new(file)
    }

    /// Offset and length of each page, with column and first row.
    fn pages(bytes: &[u8], metadata: &ParquetMetaData) -> Vec<(usize, usize, String, u64)> {
        let mut all = Vec::new();
        let mut first = 0;
        for group in metadata.row_groups() {
            for column in group.columns() {
                let (start, length) = column.byte_range();
                let mut left = BufReader::new(file(bytes).reader_at(start)).take(length);
                let mut row = first;
                while left.limit() > 0 {
                    let header = Header::read(&mut left).unwrap().unwrap();
                    assert!(header.crc.is_some());
                    let at = start + length - left.limit();
                    let name = column.column_path().string();
                    all.push((at as usize, header.size as usize, name, row));
                    hash(&mut left, header.size).unwrap().unwrap();
                    row += header.rows;
                }
            }
            first += group.num_rows() as u64;
        }
        all
    }

    #[test]
    fn xval_every_byte_of_every_page_of_another_writer_is_covered() {
        for version in ["v1", "v2"] {
            let good = data(version);
            let metadata = metadata(&good);
            let mut sound = compare(&file(&good), &metadata, &all(&metadata)).unwrap();
            assert_eq!((sound.bad.take(), sound.pages), (None, sound.compared));
            let pages = pages(&good, &metadata);
            assert_eq!(pages.len(), sound.pages);
            assert!(pages.len() > 20, "{version}: {} pages", pages.len());
            for (at, length, column, row) in pages {
                for byte in (at..at + length).step_by(5).chain([at + length - 1]) {
                    let mut bad = good.clone();
                    bad[byte] ^= 1;
                    let found = compare(&file(&bad), &metadata, &all(&metadata)).unwrap();
                    let column = column.clone();
                    assert_eq!(
                        found.bad,
                        Some(BadPage { row, column }),
                        "{version}, {byte}"
                    );
                }
            }
        }
    }

    #[test]
    fn prop_no_header_hangs_or_panics() {
        let good = data("v1");
        let metadata = metadata(&good);
        for at in 4..1500 {
            let mut bad = good.clone();
            bad[at] = 255;
            compare(&file(&bad), &metadata, &all(&metadata)).unwrap();
            bad[at] = 0;
            compare(&file(&bad), &metadata, &all(&metadata)).unwrap();
        }
    }
}
