//! Rows of CSV text. A row without a quote is split only as far as its cells are used; csv-core reads the others.

use crate::bytes::TextBytes;
use csv_core::{ReadRecordResult, Reader, ReaderBuilder};
use memchr::{memchr_iter, memchr2};
use std::io::{self, Read};
use std::ops::Range;

/// A separator of which several are one, and which separates nothing at the ends of a line.
const BLANK: u8 = b' ';

/// Bytes read at a time.
const BLOCK: usize = 1 << 16;

/// A row: its line, its number of cells, and the cells that are used.
pub(crate) struct Row<'a> {
    /// Line from one; the first of the empty lines and comments before it.
    pub line: u64,
    pub len: usize,
    text: &'a [u8],
    cells: &'a [Range<usize>],
}

impl<'a> Row<'a> {
    /// All cells of a row that was read with quotes.
    pub fn cells(&self) -> impl Iterator<Item = &'a [u8]> {
        (0..self.cells.len()).map(|k| self.cell(k))
    }

    /// A cell that is used; no byte where the row has none.
    pub fn cell(&self, index: usize) -> &'a [u8] {
        let cell = self.cells.get(index);
        let text = cell.and_then(|cell| self.text.get(cell.clone()));
        text.unwrap_or_default()
    }
}

/// Reads rows one by one.
pub(crate) struct CsvRows<R> {
    bytes: TextBytes<R>,
    delimiter: u8,
    comment: Option<u8>,
    /// Number of cells that are used, from the first; the others are counted.
    pub used: usize,
    /// Text, of which `left` is still to be split.
    buffer: Vec<u8>,
    left: Range<usize>,
    line: u64,
    cells: Vec<Range<usize>>,
    quoted: Quoted,
}

/// Reader of rows with quotes, and the texts without quotes that it writes.
struct Quoted {
    reader: Reader,
    text: Vec<u8>,
    ends: Vec<usize>,
}

impl<R: Read> CsvRows<R> {
    pub fn new(bytes: TextBytes<R>, delimiter: u8, comment: Option<u8>) -> Self {
        let mut reader = ReaderBuilder::new();
        let reader = reader.delimiter(delimiter).comment(comment).build();
        Self {
            bytes,
            delimiter,
            comment,
            used: usize::MAX,
            buffer: Vec::new(),
            left: 0..0,
            line: 1,
            cells: Vec::new(),
            quoted: Quoted {
                reader,
                text: vec![0; BLOCK],
                ends: vec![0; 64],
            },
        }
    }

    /// How many lines were read.
    pub fn lines(&self) -> u64 {
        self.line - 1
    }

    /// Whether the last byte read ends a line.
    pub fn ends_a_line(&self) -> bool {
        self.bytes.ends_a_line()
    }

    /// The next row; `None` at the end.
    pub fn next_row(&mut self) -> io::Result<Option<Row<'_>>> {
        let line = self.line;
        while let Some(len) = self.plain_line()? {
            let text = self.left.start..self.left.start + len;
            self.left.start = text.end + 1;
            self.line += 1;
            if !self.is_no_row(&text) {
                return Ok(Some(self.split(line, text)));
            }
        }
        self.quoted(line)
    }

    /// The next row with all its cells; `None` at the end.
    pub fn next_whole_row(&mut self) -> io::Result<Option<Row<'_>>> {
        self.quoted(self.line)
    }

    /// Length of the next line; `None` if it has a quote or no line end.
    fn plain_line(&mut self) -> io::Result<Option<usize>> {
        let mut searched = 0;
        loop {
            let left = self.buffer.get(self.left.clone()).unwrap_or_default();
            let rest = left.get(searched..).unwrap_or_default();
            if let Some(at) = memchr2(b'\n', b'"', rest) {
                let is_end = rest.get(at) == Some(&b'\n');
                return Ok(is_end.then_some(searched + at));
            }
            searched = left.len();
            if !self.fill()? {
                return Ok(None);
            }
        }
    }

    /// The next row as csv-core reads it, with this line.
    fn quoted(&mut self, line: u64) -> io::Result<Option<Row<'_>>> {
        self.quoted.reader.set_line(self.line);
        let (mut written, mut len) = (0, 0);
        loop {
            if self.left.is_empty() {
                self.fill()?;
            }
            let Quoted { reader, text, ends } = &mut self.quoted;
            let (result, read, more, cells) = reader.read_record(
                self.buffer.get(self.left.clone()).unwrap_or_default(),
                text.get_mut(written..).unwrap_or_default(),
                ends.get_mut(len..).unwrap_or_default(),
            );
            self.left.start += read;
            written += more;
            len += cells;
            self.line = reader.line();
            match result {
                ReadRecordResult::InputEmpty => {}
                ReadRecordResult::OutputFull => text.resize(2 * text.len(), 0),
                ReadRecordResult::OutputEndsFull => ends.resize(2 * ends.len(), 0),
                ReadRecordResult::End => return Ok(None),
                ReadRecordResult::Record => return Ok(Some(self.unquoted(line, len))),
            }
        }
    }

    /// The row that csv-core wrote.
    fn unquoted(&mut self, line: u64, len: usize) -> Row<'_> {
        self.cells.clear();
        let mut start = 0;
        for &end in self.quoted.ends.iter().take(len) {
            self.cells.push(start..end);
            start = end;
        }
        if self.delimiter == BLANK {
            self.cells.retain(|cell| !cell.is_empty());
        }
        Row {
            line,
            len: self.cells.len(),
            text: &self.quoted.text,
            cells: &self.cells,
        }
    }

    /// Reads more text behind what is left; `false` at the end.
    fn fill(&mut self) -> io::Result<bool> {
        if self.left.start > 0 {
            self.buffer.copy_within(self.left.clone(), 0);
            self.left = 0..self.left.len();
        }
        if self.buffer.len() < self.left.end + BLOCK {
            self.buffer.resize(2 * (self.left.end + BLOCK), 0);
        }
        let block = self.left.end..self.left.end + BLOCK;
        let n = self
            .bytes
            .read(self.buffer.get_mut(block).unwrap_or_default())?;
        self.left.end += n;
        Ok(n > 0)
    }

    /// Whether a line is empty or a comment.
    fn is_no_row(&self, text: &Range<usize>) -> bool {
        let mut text = self.buffer.get(text.clone()).unwrap_or_default().iter();
        let first = text.find(|byte| self.delimiter != BLANK || **byte != BLANK);
        first.is_none_or(|first| Some(*first) == self.comment)
    }

    /// The row of a line without quotes.
    fn split(&mut self, line: u64, text: Range<usize>) -> Row<'_> {
        let text = self.buffer.get(text).unwrap_or_default();
        let mut ends = memchr_iter(self.delimiter, text);
        let used = match self.delimiter {
            BLANK => usize::MAX,
            _ => self.used,
        };
        self.cells.clear();
        let mut start = 0;
        for end in ends.by_ref().take(used) {
            self.cells.push(start..end);
            start = end + 1;
        }
        let mut len = self.cells.len() + 1;
        match len > used {
            true => len += ends.count(),
            false => self.cells.push(start..text.len()),
        }
        if self.delimiter == BLANK {
            self.cells.retain(|cell| !cell.is_empty());
            len = self.cells.len();
        }
        let cells = &self.cells;
        Row {
            line,
            len,
            text,
            cells,
        }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Gives a few bytes at a time.
    struct Drops<'a>(&'a [u8], usize);

    impl Read for Drops<'_> {
        fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
            let n = self.0.len().min(self.1).min(buffer.len());
            let (now, later) = self.0.split_at(n);
            buffer[..n].copy_from_slice(now);
            self.0 = later;
            Ok(n)
        }
    }

    proptest! {
        /// Lines, numbers of cells and cells are those of the crate csv.
        #[test]
        fn xval_rows_are_those_of_a_general_reader(
            text in "(([a#,\" ]|\"\"){0,6}[,\n\r]){0,12}[a#,\"]{0,3}",
            drops in 1_usize..20,
            used in 1_usize..5,
            comment in prop::option::of(Just(b'#')),
        ) {
            let bytes = || TextBytes::new(Drops(text.as_bytes(), drops), 0);
            let mut reader = csv::ReaderBuilder::new();
            reader.has_headers(false).flexible(true).comment(comment);
            let mut reader = reader.from_reader(bytes());
            let mut rows = CsvRows::new(bytes(), b',', comment);
            rows.used = used;
            let mut record = csv::ByteRecord::new();
            while reader.read_byte_record(&mut record).unwrap() {
                let row = rows.next_row().unwrap().unwrap();
                prop_assert_eq!(row.line, record.position().unwrap().line());
                prop_assert_eq!(row.len, record.len());
                for k in 0..used {
                    prop_assert_eq!(row.cell(k), record.get(k).unwrap_or_default());
                }
            }
            prop_assert!(rows.next_row().unwrap().is_none());
            prop_assert_eq!(rows.ends_a_line(), reader.get_ref().ends_a_line());
        }
    }
}
