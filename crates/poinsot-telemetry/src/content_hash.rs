//! SHA-256 of a file; of a long one on a thread of its own, beside the parser.

use crate::bytes::{Opened, unreadable};
use poinsot_files::Faults;
use sha2::{Digest, Sha256};
use std::io::{self, Read};
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::{self, Builder};

/// Bytes from which a thread is worth its start.
const LONG: u64 = 4 << 20;

/// The result of `work`, and SHA-256 of the file, hexadecimal. A thread beside it ends early if the work fails.
pub(crate) fn hashed<T>(
    path: &Path,
    opened: &Opened,
    work: impl FnOnce() -> Result<T, Faults>,
) -> Result<(T, String), Faults> {
    let failed = AtomicBool::new(false);
    let hash = || sha256(opened.file.reader_at(0), &failed);
    thread::scope(|scope| {
        let beside = match opened.file.len > LONG {
            true => Builder::new().spawn_scoped(scope, hash).ok(),
            false => None,
        };
        let done = work();
        failed.store(done.is_err(), Ordering::Relaxed);
        let done = done?;
        let ended = |_| Err(io::Error::other("the thread that hashes the file ended"));
        let sha256 = match beside {
            Some(thread) => thread.join().unwrap_or_else(ended),
            None => hash(),
        };
        Ok((done, sha256.map_err(unreadable(path))?))
    })
}

/// SHA-256, hexadecimal; of the first part only where `ended` turns true.
pub(crate) fn sha256(mut file: impl Read, ended: &AtomicBool) -> io::Result<String> {
    let mut hash = Sha256::new();
    let mut buffer = vec![0_u8; 1 << 16];
    loop {
        let n = file.read(&mut buffer)?;
        if n == 0 || ended.load(Ordering::Relaxed) {
            return Ok(hex(hash));
        }
        hash.update(buffer.get(..n).unwrap_or_default());
    }
}

/// The digest, hexadecimal.
pub(crate) fn hex(hash: Sha256) -> String {
    hash.finalize().iter().map(|b| format!("{b:02x}")).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Write;

    /// FIPS 180-4, a million times "a", and the same digest beside as here.
    #[test]
    fn exact_digests_are_those_of_the_standard() {
        let digest = |bytes: &[u8]| {
            let mut file = tempfile::tempfile().unwrap();
            file.write_all(bytes).unwrap();
            let opened = Opened::stream(file).unwrap();
            hashed(Path::new("a"), &opened, || Ok(())).unwrap().1
        };
        assert_eq!(
            digest(&vec![b'a'; 1_000_000]),
            "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0"
        );
        let long: Vec<u8> = (0..3 * LONG).map(|k| (k * k % 251) as u8).collect();
        assert_eq!(digest(&long), hex(Sha256::new_with_prefix(&long)));
    }
}
