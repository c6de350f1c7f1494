//! Wheels within an interval: the axial momentum of a rotor is linear in time, not its relative speed.
//!
//! A motor torque that is constant between two grid times changes the axial momentum of its rotor evenly (Hughes 1986,
//! axisymmetric rotor), `Js (Omega + a . w_host)' = tau`. So `L = Omega + a . w_host` is straight between
//! `Omega_k + a . w_k` and `Omega_k+1 + a . w_k+1`, and within the interval
//!
//! ```text
//! h = (I - sum Js a a^T) w + h_joints + sum Js (L - a . w_joints) a
//! ```
//!
//! with `w_joints` the turn of the host by joint rates. With nutation of the base, `Omega` deviates from linear as `a .
//! w` does from its chord. The rate at the end is from the previous pass; the error of each pass is `Js / I` of the
//! previous one.
//!
//! A sensitivity column depends on both ends of the chord linearly. Two further columns a wheel, one driven with the
//! chord's share `1 - s` and one with `s`, hold this; the end is solved for after the last step.

use super::variation::Variation;
use super::{Column, EvaluatedState, Motion, State};
use crate::problem::parameters::UnknownKind;
use nalgebra::DMatrix;
use poinsot_spatial::{Vector3, Vector6};
use std::sync::Arc;

/// Error of the chord, relative to the bend, below which no further pass is made.
const CLOSE: f64 = 1.0e-3;
/// Largest number of passes before the last one.
const PASSES: usize = 4;

/// Deviation of each wheel's axial momentum per spin inertia from its speed, `a . w_host`, at both ends of an interval,
/// rad/s.
#[derive(Debug, Clone, Default)]
pub(super) struct Chord {
    from: Vec<f64>,
    to: Vec<f64>,
}

impl Chord {
    /// Straight between the ends.
    pub fn at(&self, wheel: usize, share: f64) -> f64 {
        self.from[wheel] + share * (self.to[wheel] - self.from[wheel])
    }
}

/// Rates of the columns about the wheel axes at the start of an interval.
#[derive(Default)]
pub(super) struct ColumnChord {
    /// One row per column, one entry per wheel.
    from: Vec<f64>,
    /// Columns driven with `1 - s`, then with `s`, of every wheel.
    pub columns: Vec<Column>,
    axes: WheelAxes,
    /// What the ends of the columns do to themselves; then its inverse.
    own: DMatrix<f64>,
    rates: Vec<f64>,
    to: Vec<f64>,
}

impl ColumnChord {
    /// Wheel of one of the columns, and its share of the chord's unit at a place in the interval.
    pub fn drive(&self, column: usize, share: f64) -> (usize, f64) {
        let wheels = self.columns.len() / 2;
        match column.checked_sub(wheels) {
            None => (column, 1.0 - share),
            Some(wheel) => (wheel, share),
        }
    }
}

impl Motion<'_> {
    /// Finds the chord of the interval after grid time k by passes that follow the state alone.
    pub(super) fn find_chord(&mut self, k: usize, steps: usize) -> Option<()> {
        let start = self.evaluated.take()?;
        let columns = std::mem::take(&mut self.columns);
        let mut chord = std::mem::take(&mut self.spare.chord);
        self.along_axes(&start.instant.twist.w, &mut chord.from);
        let gain = self.axes().zip(&self.vehicle.spin).map(|(a, spin)| {
            let momentum = Vector6::new(0.0, 0.0, 0.0, a.x, a.y, a.z);
            let turn: Vector3 = start.instant.twist_of(&momentum).fixed_rows::<3>(3).into();
            (spin * a.dot(&turn)).abs()
        });
        let gain = gain.fold(0.0, f64::max);
        let mut error = 1.0;
        for _ in 0..PASSES {
            self.return_to(k, &start.state, &start.instant);
            self.keep(EvaluatedState {
                at: (k, 0.0),
                variation: None,
                ..*start
            });
            self.follow(k, steps)?;
            let w = self.evaluated.as_ref()?.instant.twist.w;
            // Of the pass before.
            let mut now = self
                .chord
                .take()
                .unwrap_or_else(|| std::mem::take(&mut chord));
            self.along_axes(&w, &mut now.to);
            self.chord = Some(now);
            error *= gain;
            if error <= CLOSE {
                break;
            }
        }
        self.columns = columns;
        self.return_to(k, &start.state, &start.instant);
        self.evaluated = Some(start);
        Some(())
    }

    /// The sensitivities at the start of an interval whose chord is known.
    pub(super) fn open_columns(&mut self) -> Option<ColumnChord> {
        let variation = Arc::clone(self.evaluated.as_ref()?.variation.as_ref()?);
        let mut chord = std::mem::take(&mut self.spare.column_chord);
        self.turns(&mut chord.axes)?;
        let wheels = chord.axes.axes.len();
        chord.columns.clear();
        chord.columns.resize(2 * wheels, Column::zeros());
        chord.from.clear();
        for (j, column) in self.columns.iter().enumerate() {
            let unknown = j.checked_sub(self.initial_columns);
            chord
                .axes
                .rates(&variation, column, unknown, &mut chord.rates);
            chord.from.extend_from_slice(&chord.rates);
        }
        Some(chord)
    }

    /// Adds to every column at the end of the interval what the two ends of the chord do to it.
    pub(super) fn close_columns(&mut self, mut chord: ColumnChord) -> Option<()> {
        let variation = Arc::clone(self.evaluated.as_ref()?.variation.as_ref()?);
        self.turns(&mut chord.axes)?;
        let (axes, rates, to) = (&chord.axes, &mut chord.rates, &mut chord.to);
        let wheels = axes.axes.len();
        let (first, last) = chord.columns.split_at(wheels);
        if chord.own.nrows() != wheels {
            chord.own = DMatrix::zeros(wheels, wheels);
        }
        for (j, x) in last.iter().enumerate() {
            axes.rates(&variation, x, None, rates);
            for (i, rate) in rates.iter().enumerate() {
                chord.own[(i, j)] = f64::from(u8::from(i == j)) - rate;
            }
        }
        if !chord.own.try_inverse_mut() {
            return None;
        }
        let all = self.columns.iter_mut().zip(chord.from.chunks_exact(wheels));
        for (j, (column, from)) in all.enumerate() {
            for (x, share) in first.iter().zip(from) {
                *column += x * *share;
            }
            axes.rates(
                &variation,
                column,
                j.checked_sub(self.initial_columns),
                rates,
            );
            to.clear();
            to.extend(chord.own.row_iter().map(|row| {
                let parts = row.iter().zip(rates.iter());
                parts.map(|(a, b)| a * b).sum::<f64>()
            }));
            for (x, share) in last.iter().zip(to.iter()) {
                *column += x * *share;
            }
        }
        self.spare.column_chord = chord;
        Some(())
    }

    /// The wheel axes at the evaluated state.
    fn turns(&mut self, axes: &mut WheelAxes) -> Option<()> {
        let w = self.evaluated.as_ref()?.instant.twist.w;
        self.host_rates(&w);
        axes.changes = self.axial_changes();
        axes.axes.clear();
        axes.axes.extend(self.axes());
        Some(())
    }

    /// Effect of unknowns on `a . w_host` at the current velocities and a fixed base rate: tilts of the axis, and
    /// faults of the joints before the host, `(e x a) . w` and `a . e` with the joint's axis e and the rate w of the body that holds it.
    pub(super) fn axial_changes(&self) -> Vec<AxialChange> {
        let (v, kinematics) = (self.vehicle, &self.input_state.kinematics);
        let tilts = v.kinds.iter().enumerate().filter_map(|(unknown, kind)| {
            let UnknownKind::WheelTilt(wheel, _) = *kind else {
                return None;
            };
            let host = v.tree.rotors[wheel].body;
            let tilt = kinematics.R[host] * v.tilt_slopes[unknown];
            let turn = tilt.dot(&kinematics.w[host]);
            Some(AxialChange {
                unknown,
                wheel,
                turn,
            })
        });
        let mut all: Vec<AxialChange> = tilts.collect();
        for change in &self.input_state.changes {
            let Some((joint, dq, drate)) = change.joint else {
                continue;
            };
            let Some(motion) = v.joint_motions.get(joint).filter(|m| m.turns) else {
                continue;
            };
            for (wheel, (rotor, a)) in v.tree.rotors.iter().zip(self.axes()).enumerate() {
                let (e, _) = self.turned_by(rotor.body, joint);
                all.push(AxialChange {
                    unknown: change.unknown,
                    wheel,
                    turn: e.cross(&a).dot(&kinematics.w[motion.frame]) * dq + a.dot(&e) * drate,
                });
            }
        }
        all
    }

    /// Axes of the wheels at the inputs in hand, in B.
    fn axes(&self) -> impl Iterator<Item = Vector3> {
        let R = &self.input_state.kinematics.R;
        let rotors = self.vehicle.tree.rotors.iter();
        rotors.map(move |rotor| R[rotor.body] * rotor.axis_B)
    }

    /// Velocities of the bodies at a rate of the base.
    fn host_rates(&mut self, w: &Vector3) {
        let still = Vector3::zeros();
        self.input_state
            .set_velocities(self.vehicle.tree, &still, w);
    }

    /// `a . w_host` of every wheel at a rate of the base, rad/s.
    fn along_axes(&mut self, w: &Vector3, out: &mut Vec<f64>) {
        self.host_rates(w);
        let host = &self.input_state.kinematics.w;
        let rotors = self.vehicle.tree.rotors.iter().zip(self.axes());
        out.clear();
        out.extend(rotors.map(|(rotor, a)| a.dot(&host[rotor.body])));
    }

    /// Steps through an interval from the point that is ready.
    pub(super) fn follow(&mut self, k: usize, steps: usize) -> Option<State> {
        let t = &self.observations.time_s;
        let h = t[k + 1] - t[k];
        let mut now = self.evaluated.as_ref()?.state;
        for i in 0..steps {
            let from = i as f64 / steps as f64;
            let to = (i + 1) as f64 / steps as f64;
            now = self.step(k, from, to, h)?;
        }
        Some(now)
    }
}

/// Effect of an unknown on a wheel's `a . w_host`, per unit of it, rad/s.
pub(super) struct AxialChange {
    pub unknown: usize,
    pub wheel: usize,
    pub turn: f64,
}

/// Axes of the wheels in B at one time.
#[derive(Default)]
struct WheelAxes {
    axes: Vec<Vector3>,
    changes: Vec<AxialChange>,
}

impl WheelAxes {
    /// Change of `a . w_host` of every wheel with a column, wheel speeds held.
    fn rates(
        &self,
        variation: &Variation,
        column: &Column,
        unknown: Option<usize>,
        out: &mut Vec<f64>,
    ) {
        let twist = variation.twist(column, unknown);
        let dw: Vector3 = twist.fixed_rows::<3>(3).into();
        out.clear();
        out.extend(self.axes.iter().map(|a| a.dot(&dw)));
        for own in self.changes.iter().filter(|c| unknown == Some(c.unknown)) {
            out[own.wheel] += own.turn;
        }
    }
}
