//! Order and clock of the samples.

use crate::configuration::{Configuration, HELD_BACK};
use crate::motion::{Acting, Bend, Moving};
use crate::sample::Sample;
use core::f64::consts::TAU;
use nalgebra::ArrayStorage;
#[cfg(not(feature = "std"))]
use nalgebra::ComplexField;
use poinsot_spatial::{Vector3, Vector6};

/// No momentum and no twist.
const NOTHING: Acting = Acting::from_array_storage(ArrayStorage([[0.0; 6]; 2]));
/// No force and no torque.
const NONE: Vector6 = Vector6::from_array_storage(ArrayStorage([[0.0; 6]]));

/// Largest turn between the samples of a window that is thinned, of the vehicle or of the phase of a mode, rad.
const TURN: f64 = 0.25;
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

/// How the wheels went on up to the last sample.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Course {
    /// Time, s, and angular momentum of the wheels in B.
    last: Option<(f64, Vector3)>,
    /// Length of the interval before it, s, and the mean torque in it.
    before: Option<(f64, Vector3)>,
}

impl Course {
    pub const NEW: Self = Self {
        last: None,
        before: None,
    };

    /// The next sample, with the bend of the last three.
    pub fn next(&mut self, time: f64, h: Vector3, longest_gap_s: f64) -> Bend {
        let last = self.last.replace((time, h));
        let last = last.map(|(from, h_from)| (time - from, h - h_from));
        let here = last.filter(|(dt, _)| *dt > 0.0 && *dt <= longest_gap_s);
        let here = here.map(|(dt, change)| (dt, change / dt));
        let before = core::mem::replace(&mut self.before, here);
        let mut bend = Bend::NONE;
        if let (Some((dt, torque)), Some((dt_before, torque_before))) = (here, before) {
            // Below a parabola through all three, from the second to the third.
            let second = (torque - torque_before) / (dt + dt_before);
            let finite = |x: f64| if x.is_finite() { x } else { 0.0 };
            bend.curve = (second * (-dt.powi(3) / 6.0)).map(finite).into();
        }
        bend
    }
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

/// The first samples, all of them or every second, fourth, eighth.
#[derive(Debug, Clone)]
pub(crate) struct Window<const WINDOW: usize> {
    pub samples: [Sample; WINDOW],
    /// What was left out before each of them.
    pub bends: [Bend; WINDOW],
    pub count: usize,
    /// Whether they were replayed, and the window takes no more.
    pub done: bool,
    /// Whether what is known comes from a replay.
    pub replayed: bool,
    /// How many there were when they were replayed last.
    seen: usize,
    /// How often every second one was left out.
    thinned: u32,
    /// Samples left out since the one that was kept last.
    left_out: u32,
    since: Since,
}

/// What acted since the sample that was kept last.
#[derive(Debug, Clone, Copy)]
struct Since {
    /// The last sample.
    last: Sample,
    /// Impulse of force and torque.
    impulse: Vector6,
    /// Per unit of the curve, see [`Bend::curve`].
    curve: Vector3,
    /// What acts less the impulse: at the beginning, at the last sample, its integral.
    begin: Acting,
    acting: Acting,
    integral: Acting,
    readings: u32,
}

impl Since {
    const NOTHING: Self = Self {
        last: Sample::at(0.0),
        impulse: NONE,
        curve: Vector3::new(0.0, 0.0, 0.0),
        begin: NOTHING,
        acting: NOTHING,
        integral: NOTHING,
        readings: 0,
    };

    /// From a sample on.
    fn new(sample: &Sample, acting: Acting) -> Self {
        Self {
            last: *sample,
            begin: acting,
            acting,
            ..Self::NOTHING
        }
    }

    /// Up to the next sample, what lies before it included; `acting` is that in the middle and at the sample.
    fn add(&mut self, sample: &Sample, bend: &Bend, [mut middle, mut end]: [Acting; 2]) {
        let dt = sample.time_s - self.last.time_s;
        let [fx, fy, fz] = self.last.force_B;
        let [tx, ty, tz] = self.last.torque_B;
        let impulse = Vector6::new(fx, fy, fz, tx, ty, tz) * dt;
        middle.set_column(0, &(middle.column(0) - self.impulse - impulse * 0.5));
        self.impulse += impulse;
        end.set_column(0, &(end.column(0) - self.impulse));
        self.integral += simpson(&self.acting, &middle, &end) * dt + Acting::from(bend.offset);
        (self.acting, self.last) = (end, *sample);
        self.curve += Vector3::from(bend.curve);
        self.readings += bend.between + 1;
    }

    /// Against the inputs of both ends and a straight impulse, over an interval with these inputs in its middle.
    fn bend(&self, dt: f64, mut middle: Acting) -> Bend {
        middle.set_column(0, &(middle.column(0) - self.impulse * 0.5));
        let plain = simpson(&self.begin, &middle, &self.acting);
        Bend {
            offset: (self.integral - plain * dt).into(),
            curve: self.curve.into(),
            between: self.readings.saturating_sub(1),
        }
    }
}

/// Mean of what has these values at the beginning, in the middle and at the end.
fn simpson(begin: &Acting, middle: &Acting, end: &Acting) -> Acting {
    (begin + middle * 4.0 + end) / 6.0
}

impl<const WINDOW: usize> Window<WINDOW> {
    pub const NEW: Self = Self {
        samples: [Sample::at(0.0); WINDOW],
        bends: [Bend::NONE; WINDOW],
        count: 0,
        done: false,
        replayed: false,
        seen: 0,
        thinned: 0,
        left_out: 0,
        since: Since::NOTHING,
    };

    /// Begins anew.
    pub fn restart(&mut self) {
        (self.count, self.thinned, self.left_out) = (0, 0, 0);
        self.seen = 0;
        (self.done, self.replayed) = (false, false);
    }

    /// Time from the first sample to the last, s.
    pub fn length_s(&self) -> f64 {
        let of = &self.samples[..self.count];
        let ends = of.first().zip(of.last());
        ends.map_or(0.0, |(first, last)| last.time_s - first.time_s)
    }

    /// Takes a sample with what lies before it, or leaves it out; whether it took it.
    pub fn gather(&mut self, sample: &Sample, lying: (&Bend, &Moving)) -> bool {
        self.gather_every(sample, lying, 1 << self.thinned)
    }

    /// Whether it is to be replayed: first at a tenth, with modes when it is full, since few samples do not tell them from turns; from
    /// one time to the next it grows by a third.
    pub fn is_due(&mut self, configuration: &Configuration) -> bool {
        let first = match configuration.mode_count {
            0 => WINDOW.div_ceil(10),
            _ => WINDOW,
        };
        let grown = self.seen + self.seen.div_ceil(3);
        let due = self.count >= grown.clamp(first, WINDOW);
        if due {
            self.seen = self.count;
        }
        due
    }

    /// Whether it was not full yet.
    pub fn is_filling(&self) -> bool {
        self.thinned == 0 && self.count < WINDOW
    }

    /// Keeps one sample of so many, and one that measures what the kept one before does not. Of what acted in between the impulse and
    /// what it moves are kept.
    fn gather_every(
        &mut self,
        sample: &Sample,
        (bend, moving): (&Bend, &Moving),
        every: u32,
    ) -> bool {
        // Without a vehicle that moves nothing is known to act.
        let acting = moving.acting(&sample.inputs()).unwrap_or(NOTHING);
        let half_way = |from: &Sample| moving.between(from, sample).unwrap_or(NOTHING);
        let mut before = Bend::NONE;
        let kept = self
            .count
            .checked_sub(1)
            .and_then(|k| self.samples.get_mut(k));
        if let Some(kept) = kept {
            let middle = half_way(&self.since.last);
            self.since.add(sample, bend, [middle, acting]);
            let tells = (sample.attitude.is_some() && kept.attitude.is_none())
                || (sample.position.is_some() && kept.position.is_none());
            if self.left_out + 1 < every && !tells {
                self.left_out += 1;
                return false;
            }
            let dt = sample.time_s - kept.time_s;
            if self.left_out > 0 {
                let [fx, fy, fz, tx, ty, tz] = (self.since.impulse / dt).into();
                (kept.force_B, kept.torque_B) = ([fx, fy, fz], [tx, ty, tz]);
            }
            before = self.since.bend(dt, half_way(kept));
        }
        if let Some((place, bend)) = self
            .samples
            .get_mut(self.count)
            .zip(self.bends.get_mut(self.count))
        {
            (*place, *bend) = (*sample, before);
            self.count += 1;
        }
        (self.since, self.left_out) = (Since::new(sample, acting), 0);
        true
    }

    /// Leaves out every second sample of a full window, so that it can go on, unless the vehicle turns too far between them.
    pub fn thin(&mut self, moving: &Moving) -> bool {
        let Some(last) = self.samples.last() else {
            return false;
        };
        let next = 2.0 * (last.time_s - self.samples[0].time_s) / (WINDOW - 1).max(1) as f64;
        let turn = |s: &Sample| {
            let joints: f64 = s.joint_rate.iter().map(|x| x * x).sum();
            s.gyro.map(|[x, y, z]| x * x + y * y + z * z + joints)
        };
        let squares = self.samples.iter().filter_map(turn);
        let fastest = squares.fold(0.0, f64::max);
        let modes = moving.configuration.modes().iter();
        let swings = modes.fold(0.0, |most: f64, m| most.max(TAU * m.frequency_Hz));
        let turn = next * fastest.sqrt().max(swings);
        if next > moving.configuration.longest_gap_s || turn > TURN {
            return false;
        }
        (self.count, self.left_out) = (0, 0);
        for k in 0..WINDOW {
            let (sample, bend) = (self.samples[k], self.bends[k]);
            self.gather_every(&sample, (&bend, moving), 2);
        }
        self.seen = self.count;
        self.left_out <<= self.thinned;
        self.thinned += 1;
        true
    }
}
