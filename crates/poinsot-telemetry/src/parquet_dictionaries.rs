//! Checks the declared sizes of Parquet dictionaries before the decoder allocates memory for them.

use crate::parquet_bytes::ParquetBytes;
use parquet::basic::Type;
use parquet::column::page::{Page, PageReader};
use parquet::errors::Result;
use parquet::file::metadata::{ColumnChunkMetaData, ParquetMetaData};
use parquet::file::serialized_reader::SerializedPageReader;
use std::sync::Arc;

/// Describes the first dictionary in the selected columns that declares more values than its bytes can hold. Other
/// pages are skipped by their headers.
///
/// # Errors
/// A page header cannot be read, or a dictionary cannot be decompressed.
pub(crate) fn excess(
    file: &ParquetBytes,
    metadata: &ParquetMetaData,
    leaves: &[usize],
) -> Result<Option<String>> {
    let source = Arc::new(file.clone());
    for group in metadata.row_groups() {
        let rows = usize::try_from(group.num_rows()).unwrap_or(0);
        let chosen = group.columns().iter().enumerate();
        for (_, column) in chosen.filter(|(k, _)| leaves.contains(k)) {
            let mut pages = SerializedPageReader::new(source.clone(), column, rows, None)?;
            while let Some(page) = pages.peek_next_page()? {
                if !page.is_dict {
                    pages.skip_next_page()?;
                } else if let Some(why) = pages.get_next_page()?.and_then(|p| more(&p, column)) {
                    return Ok(Some(why));
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
        format!(
            "a dictionary of column '{}' declares {num_values} values in {} bytes",
            column.column_path().string(),
            buf.len()
        )
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
