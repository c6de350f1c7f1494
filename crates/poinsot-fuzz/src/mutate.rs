//! Deterministic mutations of corpus files, for the tests; the fuzzer has its own.

/// Tokens significant to readers.
const TOKENS: [&[u8]; 28] = [
    b",",
    b"\n",
    b"\r\n",
    b"\"",
    b"'",
    b"NaN",
    b"1e999",
    b"-0",
    b"1e-320",
    b"nan",
    b"inf",
    b"\xef\xbb\xbf",
    b"\xff",
    b"\x00",
    b"time_s",
    b"omega_x",
    b"q_w",
    b"[[body]]",
    b"[",
    b"]",
    b"=",
    b"<",
    b"/>",
    b"<link name=\"a\">",
    b"PAR1",
    b"estimate",
    b"9223372036854775807",
    b"0.1",
];

/// Largest input, bytes.
const LONGEST: usize = 1 << 16;

/// Makes new inputs from old ones, deterministically for a seed.
pub struct Mutator {
    state: u64,
}

impl Mutator {
    /// Creates a generator; use a different seed for each target.
    pub fn new(seed: u64) -> Self {
        Self { state: seed }
    }

    /// Next number of SplitMix64 (Steele, Lea, Flood 2014).
    fn next(&mut self) -> u64 {
        self.state = self.state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.state;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// A number below `n`; 0 if `n` is 0.
    fn below(&mut self, n: usize) -> usize {
        usize::try_from(self.next() % n.max(1) as u64).unwrap_or(0)
    }

    /// An input of the corpus, changed in one to eight places.
    pub fn input(&mut self, corpus: &[Vec<u8>]) -> Vec<u8> {
        let pick = self.below(corpus.len());
        let mut bytes = corpus.get(pick).cloned().unwrap_or_default();
        for _ in 0..=self.below(8) {
            self.change(&mut bytes, corpus);
        }
        bytes.truncate(LONGEST);
        bytes
    }

    fn change(&mut self, bytes: &mut Vec<u8>, corpus: &[Vec<u8>]) {
        let at = self.below(bytes.len() + 1);
        let end = (at + self.below(32)).min(bytes.len());
        match self.below(7) {
            0 => {
                let bit = 1_u8 << self.below(8);
                if let Some(byte) = bytes.get_mut(at) {
                    *byte ^= bit;
                }
            }
            1 => {
                let new = self.next().to_le_bytes()[0];
                if let Some(byte) = bytes.get_mut(at) {
                    *byte = new;
                }
            }
            2 => drop(bytes.drain(at..end)),
            3 => {
                let piece = bytes.get(at..end).unwrap_or_default().to_vec();
                let to = self.below(bytes.len() + 1);
                bytes.splice(to..to, piece);
            }
            4 => {
                let token = TOKENS[self.below(TOKENS.len())];
                let to = if self.below(2) == 0 { at } else { end };
                bytes.splice(at..to, token.iter().copied());
            }
            5 => bytes.truncate(at),
            _ => {
                let other = self.below(corpus.len());
                let other = corpus.get(other).map_or(&[][..], Vec::as_slice);
                let from = self.below(other.len() + 1);
                bytes.truncate(at);
                bytes.extend_from_slice(other.get(from..).unwrap_or_default());
            }
        }
    }
}
