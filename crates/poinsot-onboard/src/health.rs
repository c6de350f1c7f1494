//! Tests of the innovations, and what becomes of them.

use crate::information::OfParameters;
use crate::numbers::{AXES, NUMBERS, Numbers};
#[cfg(not(feature = "std"))]
use nalgebra::ComplexField;

/// Gyro, attitude, position.
pub(crate) const SENSORS: usize = 3;
/// Samples of a block, and of a long one.
const BLOCK: u32 = 32;
const LONG: u32 = 512;
/// Limit of each test in sigma of a normal deviate: a false alarm of 1e-6, both sides together.
const LIMIT: f64 = 4.9;
/// Innovations of a sensor in a block from which on it is tested.
const FEWEST: u32 = 8;
/// Gated measurements of one sensor in a row, and share of all in a block, that no random outliers are.
const IN_A_ROW: u32 = 5;
const GATED: f64 = 0.15;

/// What the numbers of an answer are worth.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
pub enum Health {
    /// Not all unknown parameters are determined yet.
    Converging = 0,
    /// All unknown parameters have less than half the sigma of the prior, and the innovations are those of the declared noise.
    Determined = 1,
    /// The innovations are not those of the declared noise. The filter returned to a state before that; no number counts until a
    /// block of samples is consistent again.
    Inconsistent = 2,
    /// No sample came for longer than the declared time.
    Stale = 3,
}

/// Measurements of one sensor so far.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct SensorCounts {
    /// Used.
    pub accepted: u64,
    /// Left out, since the innovation was no noise.
    pub gated: u64,
}

/// What a sample's tests say.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Verdict {
    /// The block goes on.
    Open,
    /// A block ended, consistent.
    Clean,
    /// A long block and a short one ended, both consistent.
    LongClean,
    /// The passes over a window did not end.
    Lost,
    Alarm,
    LongAlarm,
}

#[derive(Debug, Clone, Copy)]
struct OfSensor {
    accepted: u32,
    gated: u32,
    squares: f64,
    sums: [f64; AXES],
}

#[derive(Debug, Clone, Copy)]
struct Block {
    samples: u32,
    sensors: [OfSensor; SENSORS],
}

/// Tests of the innovations, which are white and of unit variance where model and noise are right (Kailath 1968).
#[derive(Debug, Clone, Copy)]
pub(crate) struct Tests {
    blocks: [Block; 2],
    in_a_row: [u32; SENSORS],
    counts: [SensorCounts; SENSORS],
    /// Whether the parameters walk.
    forgets: bool,
    /// Whether a block was consistent since the last alarm.
    pub consistent: bool,
}

impl OfSensor {
    const NEW: Self = Self {
        accepted: 0,
        gated: 0,
        squares: 0.0,
        sums: [0.0; AXES],
    };

    fn add(&mut self, innovation: &[f64; AXES], accepted: bool) {
        if !accepted {
            self.gated += 1;
            return;
        }
        self.accepted += 1;
        for (sum, x) in self.sums.iter_mut().zip(innovation) {
            *sum += x;
            self.squares += x * x;
        }
    }

    fn is_consistent(&self, forgets: bool) -> bool {
        let number = f64::from(self.accepted);
        let all = f64::from(self.accepted + self.gated);
        if f64::from(self.gated) > GATED * all + f64::from(IN_A_ROW) {
            return false;
        }
        if self.accepted < FEWEST {
            return true;
        }
        // Chi-square by the cube root of Wilson and Hilferty (1931).
        let freedom = 3.0 * number;
        let spread = 2.0 / (9.0 * freedom);
        let deviate = ((self.squares / freedom).cbrt() - 1.0 + spread) / spread.sqrt();
        let largest = self.sums.iter().fold(0.0_f64, |a, x| a.max(x.abs()));
        // A declared walk may be wider than what the body does.
        let least = if forgets { f64::NEG_INFINITY } else { -LIMIT };
        (least..=LIMIT).contains(&deviate) && largest <= LIMIT * number.sqrt()
    }
}

impl Block {
    const NEW: Self = Self {
        samples: 0,
        sensors: [OfSensor::NEW; SENSORS],
    };

    /// Ends the block after `length` samples; whether it was consistent.
    fn end(&mut self, length: u32, forgets: bool) -> Option<bool> {
        self.samples += 1;
        if self.samples < length {
            return None;
        }
        let consistent = self.sensors.iter().all(|s| s.is_consistent(forgets));
        *self = Self::NEW;
        Some(consistent)
    }
}

impl Tests {
    /// Without a sample, and not consistent.
    pub const NONE: Self = Self {
        blocks: [Block::NEW; 2],
        in_a_row: [0; SENSORS],
        counts: [SensorCounts {
            accepted: 0,
            gated: 0,
        }; SENSORS],
        forgets: false,
        consistent: false,
    };

    pub fn new(forgets: bool) -> Self {
        Self {
            forgets,
            consistent: true,
            ..Self::NONE
        }
    }

    /// Begins a pass over the window: samples of the pass before do not count.
    pub fn begin_pass(&mut self) {
        self.begin();
        self.counts = Default::default();
    }

    /// Begins new blocks.
    fn begin(&mut self) {
        self.blocks = [Block::NEW; 2];
        self.in_a_row = [0; SENSORS];
    }

    pub fn alarm(&mut self) {
        self.begin();
        self.consistent = false;
    }

    pub fn counts(&self) -> [SensorCounts; SENSORS] {
        self.counts
    }

    pub fn add(&mut self, sensor: usize, innovation: &[f64; AXES], accepted: bool) {
        for block in &mut self.blocks {
            block.sensors[sensor].add(innovation, accepted);
        }
        let counts = &mut self.counts[sensor];
        if accepted {
            counts.accepted += 1;
            self.in_a_row[sensor] = 0;
        } else {
            counts.gated += 1;
            self.in_a_row[sensor] += 1;
        }
    }

    /// Ends the tests of a sample.
    pub fn verdict(&mut self) -> Verdict {
        let [short, long] = &mut self.blocks;
        if self.in_a_row.iter().any(|n| *n >= IN_A_ROW) {
            return Verdict::Alarm;
        }
        let verdict = match (short.end(BLOCK, self.forgets), long.end(LONG, self.forgets)) {
            (Some(false), _) => Verdict::Alarm,
            (_, Some(false)) => Verdict::LongAlarm,
            (_, Some(true)) => Verdict::LongClean,
            (Some(true), None) => Verdict::Clean,
            (None, None) => Verdict::Open,
        };
        self.consistent |= matches!(verdict, Verdict::Clean | Verdict::LongClean);
        verdict
    }
}

/// What was known of the parameters.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Checkpoint {
    pub numbers: Numbers,
    pub info: OfParameters,
    /// Up to when they were forgotten, s.
    pub known_s: Option<f64>,
    pub is_prior: bool,
}

/// The parameters at the ends of the last two consistent blocks, short and long ones. The last but one is returned to: the last
/// block may hold the beginning of what is wrong.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Checkpoints {
    short: [Checkpoint; 2],
    long: [Checkpoint; 2],
}

impl Checkpoints {
    /// Nothing is known.
    pub const NONE: Self = Self::of(Checkpoint {
        numbers: [0.0; NUMBERS],
        info: OfParameters::NONE,
        known_s: None,
        is_prior: false,
    });

    /// Nothing but the prior is known.
    pub fn begin(&mut self, numbers: &Numbers, prior: &OfParameters) {
        for checkpoint in self.short.iter_mut().chain(&mut self.long) {
            (checkpoint.numbers, checkpoint.info) = (*numbers, *prior);
            (checkpoint.known_s, checkpoint.is_prior) = (None, true);
        }
    }

    const fn of(first: Checkpoint) -> Self {
        Self {
            short: [first; 2],
            long: [first; 2],
        }
    }

    pub fn keep(&mut self, here: Checkpoint, long: bool) {
        self.short = [here, self.short[0]];
        if long {
            self.long = [here, self.long[0]];
        }
    }

    /// The checkpoint to return to, which all that are younger become.
    pub fn back(&mut self, long: bool) -> Checkpoint {
        let back = if long { self.long[1] } else { self.short[1] };
        self.short = [back; 2];
        if long {
            self.long = [back; 2];
        }
        back
    }
}
