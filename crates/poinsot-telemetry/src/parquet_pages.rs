//! Pages of a Parquet file: the declared sizes of dictionaries, before the decoder allocates memory for them, and the place
//! of a page that does not match its checksum (CRC-32, which the decoder compares).

use crate::bytes::SharedFile;
use parquet::basic::Type;
use parquet::column::page::{Page, PageReader};
use parquet::errors::{ParquetError, Result};
use parquet::file::metadata::{ColumnChunkMetaData, ParquetMetaData, RowGroupMetaData};
use parquet::file::serialized_reader::SerializedPageReader;
use std::sync::Arc;

/// Whether the decoder found a page that does not match its checksum.
pub(crate) fn is_mismatch(error: &ParquetError) -> bool {
    error.to_string().contains("CRC checksum mismatch")
}

/// Rows of a group before the first page that does not match its checksum, and its column.
pub(crate) fn mismatch(
    file: &SharedFile,
    group: &RowGroupMetaData,
    leaves: &[usize],
) -> Option<(u64, String)> {
    let rows_before = |column: &ColumnChunkMetaData| {
        let mut rows = 0;
        let mut pages = reader(file, group, column).ok()?;
        loop {
            match pages.get_next_page() {
                Ok(Some(page)) if page.is_data_page() => rows += u64::from(page.num_values()),
                Ok(Some(_)) => {}
                Ok(None) => return None,
                Err(e) => return is_mismatch(&e).then_some(rows),
            }
        }
    };
    let columns = leaves.iter().filter_map(|&k| group.columns().get(k));
    let bad = columns.filter_map(|c| Some((rows_before(c)?, c.column_path().string())));
    bad.min_by_key(|bad| bad.0)
}

fn reader(
    file: &SharedFile,
    group: &RowGroupMetaData,
    column: &ColumnChunkMetaData,
) -> Result<SerializedPageReader<SharedFile>> {
    let rows = usize::try_from(group.num_rows()).unwrap_or(0);
    SerializedPageReader::new(Arc::new(file.clone()), column, rows, None)
}

/// Describes the first dictionary in the selected columns that declares more values than its bytes can hold. Other
/// pages are skipped by their headers.
///
/// # Errors
/// A page header cannot be read, or a dictionary cannot be decompressed.
pub(crate) fn excess(
    file: &SharedFile,
    metadata: &ParquetMetaData,
    leaves: &[usize],
) -> Result<Option<String>> {
    for group in metadata.row_groups() {
        for column in leaves.iter().filter_map(|&k| group.columns().get(k)) {
            let mut pages = reader(file, group, column)?;
            while let Some(page) = pages.peek_next_page()? {
                if !page.is_dict {
                    pages.skip_next_page()?;
                    continue;
                }
                match pages.get_next_page() {
                    // The decoder meets it again.
                    Err(e) if is_mismatch(&e) => break,
                    Err(e) => return Err(e),
                    Ok(page) => {
                        if let Some(why) = page.and_then(|p| more(&p, column)) {
                            return Ok(Some(why));
                        }
                    }
                }
            }
        }
    }
    Ok(None)
}

fn more(page: &Page, column: &ColumnChunkMetaData) -> Option<String> {
    let Page::DictionaryPage {
        buf, num_values, ..
    } = page
    else {
        return None;
    };
    let fits = buf.len() / width(column);
    (*num_values as usize > fits).then(|| {
        let (name, bytes) = (column.column_path().string(), buf.len());
        format!("a dictionary of column '{name}' declares {num_values} values in {bytes} bytes")
    })
}

/// Least size of one value, bytes.
fn width(column: &ColumnChunkMetaData) -> usize {
    match column.column_type() {
        Type::INT64 | Type::DOUBLE => 8,
        Type::INT96 => 12,
        Type::INT32 | Type::FLOAT | Type::BYTE_ARRAY => 4,
        Type::FIXED_LEN_BYTE_ARRAY => {
            usize::try_from(column.column_descr().type_length()).map_or(1, |n| n.max(1))
        }
        Type::BOOLEAN => 1,
    }
}
