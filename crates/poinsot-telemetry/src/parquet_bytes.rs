//! Byte source of a Parquet file; the decoder can read repeatedly at its end.

use bytes::Bytes;
use parquet::errors::Result;
use parquet::file::reader::{ChunkReader, Length};
use std::fs::File;
use std::io::{self, BufReader, Read, Seek, SeekFrom};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Allowed empty reads at the end of the file before an error is returned.
const PATIENCE: u32 = 16;

/// A file for several readers, on several threads: its one position is moved and used under a lock. It returns an error
/// after repeated reads at its end. Without it, a damaged page header with a list of 2e9 elements makes the decoder skip
/// them one by one.
#[derive(Clone)]
pub(crate) struct ParquetBytes(Arc<Mutex<File>>);

impl ParquetBytes {
    pub fn new(file: File) -> Self {
        Self(Arc::new(Mutex::new(file)))
    }

    /// A reader of its own, from this byte.
    pub fn reader_at(&self, start: u64) -> FromByte {
        let file = self.clone();
        FromByte { file, at: start }
    }

    fn lock(&self) -> MutexGuard<'_, File> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Length for ParquetBytes {
    fn len(&self) -> u64 {
        Length::len(&*self.lock())
    }
}

impl ChunkReader for ParquetBytes {
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

/// Reads a shared file from a byte on.
pub(crate) struct FromByte {
    file: ParquetBytes,
    at: u64,
}

impl Read for FromByte {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let mut file = self.file.lock();
        file.seek(SeekFrom::Start(self.at))?;
        let n = file.read(buffer)?;
        self.at += n as u64;
        Ok(n)
    }
}

/// Counts empty reads.
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
