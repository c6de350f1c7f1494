//! SHA-256 of a byte stream; of a long one on a thread of its own, beside the parser.

use sha2::{Digest, Sha256};
use std::io;
use std::sync::mpsc::{Receiver, SyncSender, channel, sync_channel};
use std::thread::{Builder, JoinHandle};

/// Bytes from which a thread is worth its start.
pub(crate) const LONG: u64 = 4 << 20;
/// Blocks that may wait for the thread.
const WAITING: usize = 16;

/// A hash in progress.
pub(crate) struct ContentHash {
    bytes: u64,
    state: State,
}

enum State {
    Here(Sha256),
    Beside(Beside),
    /// No thread can be started.
    Alone(Sha256),
}

struct Beside {
    blocks: SyncSender<Vec<u8>>,
    /// Blocks that were hashed, to be filled again.
    done: Receiver<Vec<u8>>,
    thread: JoinHandle<Sha256>,
}

impl Beside {
    /// The hash itself where no thread can be started.
    fn new(hash: Sha256) -> Result<Self, Sha256> {
        let (blocks, next) = sync_channel::<Vec<u8>>(WAITING);
        let (give_back, done) = channel();
        let mut own = hash.clone();
        let work = move || {
            for block in next {
                own.update(&block);
                // Nobody fills blocks any more once the stream has ended.
                let _ = give_back.send(block);
            }
            own
        };
        let thread = Builder::new().spawn(work).map_err(|_| hash)?;
        Ok(Self {
            blocks,
            done,
            thread,
        })
    }
}

impl ContentHash {
    pub fn new() -> Self {
        Self {
            bytes: 0,
            state: State::Here(Sha256::new()),
        }
    }

    pub fn update(&mut self, bytes: &[u8]) {
        self.bytes += bytes.len() as u64;
        if let State::Here(hash) = &self.state
            && self.bytes > LONG
        {
            self.state = match Beside::new(hash.clone()) {
                Ok(beside) => State::Beside(beside),
                Err(hash) => State::Alone(hash),
            };
        }
        match &mut self.state {
            State::Here(hash) | State::Alone(hash) => hash.update(bytes),
            State::Beside(beside) => {
                let mut block = beside.done.try_recv().unwrap_or_default();
                block.clear();
                block.extend_from_slice(bytes);
                // The thread takes blocks until the sender is dropped.
                let _ = beside.blocks.send(block);
            }
        }
    }

    /// The digest, hexadecimal.
    ///
    /// # Errors
    /// The thread failed.
    pub fn finish(self) -> io::Result<String> {
        let hash = match self.state {
            State::Here(hash) | State::Alone(hash) => hash,
            State::Beside(beside) => {
                drop(beside.blocks);
                beside.thread.join().map_err(|_| ended())?
            }
        };
        Ok(hex(hash))
    }
}

/// The error where the thread failed.
pub(crate) fn ended() -> io::Error {
    io::Error::other("the thread that hashes the file ended")
}

/// The digest, hexadecimal.
pub(crate) fn hex(hash: Sha256) -> String {
    hash.finalize().iter().map(|b| format!("{b:02x}")).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// FIPS 180-4, a million times "a", and the same digest beside as here.
    #[test]
    fn exact_digests_are_those_of_the_standard() {
        let digest = |bytes: &[u8], block: usize| {
            let mut hash = ContentHash::new();
            bytes.chunks(block).for_each(|b| hash.update(b));
            hash.finish().unwrap()
        };
        assert_eq!(
            digest(&vec![b'a'; 1_000_000], 1000),
            "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0"
        );
        let long: Vec<u8> = (0..3 * LONG).map(|k| (k * k % 251) as u8).collect();
        let whole = Sha256::digest(&long);
        let whole: String = whole.iter().map(|b| format!("{b:02x}")).collect();
        assert_eq!(digest(&long, 65_521), whole);
    }
}
