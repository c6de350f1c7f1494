//! Order and clock of the samples.

use crate::configuration::HELD_BACK;
use crate::sample::Sample;

/// Refused samples in a row, each soon after the one before, that show a new clock.
const NEW_CLOCK: u32 = 3;

/// Why a sample is not used. The numbers are the codes of the C interface.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
pub enum Refusal {
    /// A number is NaN or infinite.
    NotFinite = 1,
    /// The quaternion has not length one.
    Quaternion = 2,
    /// A sample of the same time was taken.
    Duplicate = 3,
    /// It is older than the samples that are held back.
    Late = 4,
    /// Its time is further from the newest than the longest gap. The third such sample in a row is taken, and the motion starts
    /// anew.
    ClockJump = 5,
}

/// Samples that wait for their turn.
#[derive(Debug, Clone)]
pub(crate) struct Stream {
    pending: [Sample; HELD_BACK + 1],
    count: usize,
    /// Newest time of those accepted.
    newest: Option<f64>,
    /// Time of the last one given on.
    taken: Option<f64>,
    /// Time of the last refused sample, and how many were refused in a row.
    refused: Option<(f64, u32)>,
}

impl Stream {
    pub const NEW: Self = Self {
        pending: [Sample::at(0.0); HELD_BACK + 1],
        count: 0,
        newest: None,
        taken: None,
        refused: None,
    };

    /// Newest time, s.
    pub fn newest(&self) -> Option<f64> {
        self.newest
    }

    /// Puts a sample in its place.
    pub fn insert(&mut self, sample: Sample, longest_gap_s: f64) -> Result<(), Refusal> {
        let time = sample.time_s;
        let waiting = self.pending.iter().take(self.count);
        if self.taken == Some(time) || waiting.clone().any(|s| s.time_s == time) {
            return Err(Refusal::Duplicate);
        }
        let late = self.taken.is_some_and(|taken| time < taken);
        let far = self
            .newest
            .is_some_and(|newest| (time - newest).abs() > longest_gap_s);
        if late || far {
            let follows = |last: f64| time > last && time - last <= longest_gap_s;
            let before = self.refused.filter(|(last, _)| follows(*last));
            let in_a_row = before.map_or(1, |(_, n)| n + 1);
            self.refused = Some((time, in_a_row));
            if in_a_row < NEW_CLOCK {
                return Err(if far {
                    Refusal::ClockJump
                } else {
                    Refusal::Late
                });
            }
            (self.count, self.taken, self.newest) = (0, None, None);
        }
        self.refused = None;
        self.newest = Some(self.newest.map_or(time, |newest| newest.max(time)));
        let place = waiting_before(&self.pending[..self.count], time);
        self.pending[place..=self.count].rotate_right(1);
        self.pending[place] = sample;
        self.count += 1;
        Ok(())
    }

    /// The oldest sample, where more than `held` wait.
    pub fn next(&mut self, held: usize) -> Option<Sample> {
        if self.count <= held.min(HELD_BACK) {
            return None;
        }
        let first = self.pending[0];
        self.pending[..self.count].rotate_left(1);
        self.count -= 1;
        self.taken = Some(first.time_s);
        Some(first)
    }
}

/// How many of the waiting samples are older.
fn waiting_before(waiting: &[Sample], time: f64) -> usize {
    waiting.iter().filter(|s| s.time_s < time).count()
}

/// The first samples.
#[derive(Debug, Clone)]
pub(crate) struct Window<const WINDOW: usize> {
    pub samples: [Sample; WINDOW],
    pub count: usize,
    /// Whether they were replayed.
    pub done: bool,
}

impl<const WINDOW: usize> Window<WINDOW> {
    pub const NEW: Self = Self {
        samples: [Sample::at(0.0); WINDOW],
        count: 0,
        done: false,
    };
}
