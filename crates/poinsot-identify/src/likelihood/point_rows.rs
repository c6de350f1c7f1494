//! Rows of the instruments at points of bodies: specific force, and increments of velocity.

use super::ideal::slope;
use super::{ACCELEROMETER, Compare, INCREMENT};
use crate::input_noise::is_increment;
use crate::motion::{Instant, Motion, Point, State, matrix};
use crate::parameters::{Parameters, UnknownKind};
use crate::point_sensor::{
    Fault, InstrumentErrors, PointKind, PointReading, PointReadings, fault_of,
};
use crate::segment::Segment;
use crate::vehicle::Vehicle;
use poinsot_spatial::Vector3;

/// A point's velocity in N at a grid time, with its change per column.
struct Velocity {
    at: usize,
    value: Vector3,
    columns: Vec<Vector3>,
}

/// One instrument in the course of a segment.
struct One {
    errors: InstrumentErrors,
    /// Index of the next reading.
    next: usize,
    /// Where the interval in hand began.
    began: Option<Velocity>,
    /// Reading of a perfect instrument (of an increment: the velocity) at all grid times, where its lag is
    /// unknown; empty otherwise.
    ideal: Vec<Vector3>,
    late: bool,
}

/// The instruments of a segment.
pub(super) struct PointCompare {
    all: Vec<One>,
}

impl PointCompare {
    pub fn new(parameters: &Parameters, segment: &Segment, x: &[f64]) -> Self {
        let lag = |sensor| UnknownKind::Instrument {
            sensor,
            fault: Fault::Lag,
        };
        let points = segment.observations.points.iter();
        Self {
            all: points
                .map(|p| One {
                    errors: InstrumentErrors::of(parameters, x, p.sensor),
                    next: 0,
                    began: None,
                    ideal: Vec::new(),
                    late: parameters.unknowns.iter().any(|u| u.kind == lag(p.sensor)),
                })
                .collect(),
        }
    }

    /// Perfect readings at all grid times of the instruments whose lag is unknown. `None` where the vehicle
    /// cannot move.
    pub fn predict(&mut self, vehicle: &Vehicle, segment: &Segment, start: &State) -> Option<()> {
        if self.all.iter().all(|one| !one.late) {
            return Some(());
        }
        let mut motion = Motion::new(vehicle, segment, Vec::new(), 0);
        let samples = segment.observations.time_s.len();
        let mut state = *start;
        for k in 0..samples {
            let (instant, _) = motion.velocity(&state, k)?;
            for (one, p) in self.all.iter_mut().zip(&segment.observations.points) {
                if one.late {
                    one.ideal.push(perfect(&mut motion, &state, &instant, p, k));
                }
            }
            if k + 1 < samples {
                state = motion.advance(&state, k)?;
            }
        }
        Some(())
    }

    /// Whether any instrument has a reading, or an interval that begins, at grid time k.
    pub fn wanted(&self, points: &[PointReadings], k: usize) -> bool {
        let mut pairs = self.all.iter().zip(points);
        pairs.any(|(one, p)| (one.next..one.next + 2).any(|i| touches(p.readings.get(i), k)))
    }
}

fn touches(reading: Option<&PointReading>, k: usize) -> bool {
    reading.is_some_and(|r| r.to == k || r.from == k)
}

/// What a perfect instrument reads; of an increment the velocity in N.
pub(crate) fn perfect(
    motion: &mut Motion,
    state: &State,
    instant: &Instant,
    p: &PointReadings,
    k: usize,
) -> Vector3 {
    let point: Point = (p.body, p.p_BoS_B);
    match p.kind {
        PointKind::SpecificForce => motion
            .specific_force(state, k, instant, &[point])
            .first()
            .map_or_else(Vector3::zeros, |f| f.value),
        PointKind::VelocityIncrement => {
            state.R_NB * motion.point_velocity(&instant.twist, &point).0
        }
    }
}

impl Compare<'_> {
    /// Rows of all instruments that read, or begin an interval, at grid time k.
    pub(super) fn point_rows(
        &mut self,
        motion: &mut Motion,
        state: &State,
        instant: &Instant,
        k: usize,
    ) {
        let points = &self.segment.observations.points;
        for (i, p) in points.iter().enumerate() {
            let next = self.points.all[i].next;
            let here = p.readings.get(next).filter(|r| r.to == k).copied();
            match p.kind {
                PointKind::SpecificForce => {
                    if let Some(reading) = here {
                        self.force_rows(motion, state, instant, (i, p), &reading);
                    }
                }
                PointKind::VelocityIncrement => {
                    let begins = (next..next + 2).any(|j| {
                        let reading = p.readings.get(j);
                        reading.is_some_and(|r| r.from == k)
                    });
                    if here.is_some() || begins {
                        let now = self.velocity_at(motion, state, instant, p, k);
                        let point: Point = (p.body, p.p_BoS_B);
                        let errors =
                            self.inputs
                                .velocity_slopes(motion, (state, k), instant, &point);
                        let which = points[..i].iter().filter(|p| is_increment(p)).count();
                        if let Some(reading) = here {
                            let errors = self.inputs.less_kept(which, errors.clone());
                            self.increment_rows(&now, (i, p), &reading, &errors);
                        }
                        self.points.all[i].began = Some(now);
                        self.inputs.keep(which, &errors);
                    }
                }
            }
            if here.is_some() {
                self.points.all[i].next += 1;
            }
        }
    }

    fn force_rows(
        &mut self,
        motion: &mut Motion,
        state: &State,
        instant: &Instant,
        (i, p): (usize, &PointReadings),
        reading: &PointReading,
    ) {
        let k = reading.to;
        if motion.thrust_after_unknown(k) {
            return;
        }
        let point: Point = (p.body, p.p_BoS_B);
        let forces = motion.specific_force(state, k, instant, &[point]);
        let Some(force) = forces.first() else { return };
        let t = &self.segment.observations.time_s;
        if t.len() < 2 {
            return;
        }
        let rate = slope(t, &self.points.all[i].ideal, k);
        let errors = self.points.all[i].errors;
        let residual = reading.value - errors.reading(&force.value, &rate);
        let slopes = self
            .inputs
            .force_slopes(motion, (state, k), instant, &point);
        let seen = slopes
            .iter()
            .map(|d| errors.change(&force.value, &rate, d, None));
        let slopes: Vec<Vector3> = seen.collect();
        let (kinds, head) = (&self.setting.parameters.unknowns, self.head);
        self.three((ACCELEROMETER, &slopes), &p.covariance, &residual, |j| {
            let fault = j
                .checked_sub(head)
                .and_then(|u| fault_of(&kinds[u].kind, p.sensor));
            let own = force.columns.get(j).copied().unwrap_or_default();
            errors.change(&force.value, &rate, &own, fault)
        });
    }

    fn increment_rows(
        &mut self,
        now: &Velocity,
        (i, p): (usize, &PointReadings),
        reading: &PointReading,
        slopes: &[Vector3],
    ) {
        let one = &self.points.all[i];
        let Some(began) = one.began.as_ref().filter(|v| v.at == reading.from) else {
            return;
        };
        let t = &self.segment.observations.time_s;
        let rate = slope(t, &one.ideal, reading.to) - slope(t, &one.ideal, reading.from);
        let errors = one.errors;
        let increment = now.value - began.value;
        let residual = reading.value - errors.reading(&increment, &rate);
        let seen = slopes
            .iter()
            .map(|d| errors.change(&increment, &rate, d, None));
        let slopes: Vec<Vector3> = seen.collect();
        let columns: Vec<Vector3> = now
            .columns
            .iter()
            .zip(&began.columns)
            .map(|(b, a)| b - a)
            .collect();
        let (kinds, head) = (&self.setting.parameters.unknowns, self.head);
        self.three((INCREMENT, &slopes), &p.covariance, &residual, |j| {
            let fault = j
                .checked_sub(head)
                .and_then(|u| fault_of(&kinds[u].kind, p.sensor));
            let own = columns.get(j).copied().unwrap_or_default();
            errors.change(&increment, &rate, &own, fault)
        });
    }

    fn velocity_at(
        &self,
        motion: &mut Motion,
        state: &State,
        instant: &Instant,
        p: &PointReadings,
        k: usize,
    ) -> Velocity {
        let point: Point = (p.body, p.p_BoS_B);
        let R = matrix(&state.R_NB);
        let (velocity, columns) = motion.point_velocity_columns(&instant.twist, &point);
        Velocity {
            at: k,
            value: R * velocity,
            columns: columns.iter().map(|d| R * d).collect(),
        }
    }
}
