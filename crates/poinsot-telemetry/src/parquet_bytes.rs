//! Byte source of a Parquet file; the decoder can read repeatedly at its end.

use crate::bytes::{FromByte, SharedFile};
use bytes::Bytes;
use parquet::errors::{ParquetError, Result};
use parquet::file::reader::{ChunkReader, Length};
use std::io::{self, BufReader, Read};

/// Allowed empty reads at the end of the file before an error is returned.
const PATIENCE: u32 = 16;

impl Length for SharedFile {
    fn len(&self) -> u64 {
        self.len
    }
}

impl ChunkReader for SharedFile {
    type T = UntilEnd<BufReader<FromByte>>;

    fn get_read(&self, start: u64) -> Result<Self::T> {
        Ok(UntilEnd {
            inner: BufReader::new(self.reader_at(start)),
            nothing: 0,
        })
    }

    fn get_bytes(&self, start: u64, length: usize) -> Result<Bytes> {
        let mut bytes = Vec::with_capacity(length.min(self.len as usize));
        let read = self.reader_at(start).take(length as u64);
        match { read }.read_to_end(&mut bytes)? == length {
            true => Ok(bytes.into()),
            false => Err(ParquetError::EOF("the file ends early".to_owned())),
        }
    }
}

/// Returns an error after repeated reads at the end. Without it, a damaged page header with a list of 2e9 elements makes
/// the decoder skip them one by one.
pub(crate) struct UntilEnd<R> {
    inner: R,
    nothing: u32,
}

impl<R: Read> Read for UntilEnd<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let n = self.inner.read(buffer)?;
        if n == 0 && !buffer.is_empty() {
            self.nothing += 1;
            if self.nothing > PATIENCE {
                let why = "the file ends inside a page header";
                return Err(io::Error::new(io::ErrorKind::UnexpectedEof, why));
            }
        }
        Ok(n)
    }
}
