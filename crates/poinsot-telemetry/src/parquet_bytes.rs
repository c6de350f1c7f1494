//! Byte source of a Parquet file; the decoder can read repeatedly at its end.

use crate::bytes::{FromByte, SharedFile};
use bytes::Bytes;
use parquet::errors::Result;
use parquet::file::reader::{ChunkReader, Length};
use std::io::{self, BufReader, Read};

/// Allowed empty reads at the end of the file before an error is returned.
const PATIENCE: u32 = 16;

impl Length for SharedFile {
    fn len(&self) -> u64 {
        Length::len(&*self.lock())
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
        self.lock().get_bytes(start, length)
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
