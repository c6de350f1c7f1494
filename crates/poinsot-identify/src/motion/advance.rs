//! From one grid time to the next.
//!
//! The state goes by the classical Runge-Kutta of fourth order. Its sensitivities follow the variational equation along
//! the path found: at both ends of a step and in its middle, of which the next step shares the end.

use super::grid::{TURN, joint_frequency};
use super::variation::{ColumnForcing, StepEquation};
use super::{Instant, Motion, State};
use nalgebra::Quaternion;
use poinsot_spatial::{UnitQuaternion, Vector3};
use std::sync::Arc;

/// Derivative of the state.
#[derive(Clone, Copy)]
struct Slope {
    R: Quaternion<f64>,
    p: Vector3,
    P: Vector3,
    h: Vector3,
}

impl Slope {
    fn sum<const N: usize>(parts: [(f64, Slope); N]) -> Self {
        let mut sum = Self {
            R: Quaternion::new(0.0, 0.0, 0.0, 0.0),
            p: Vector3::zeros(),
            P: Vector3::zeros(),
            h: Vector3::zeros(),
        };
        for (weight, part) in parts {
            sum.R += part.R * weight;
            sum.p += part.p * weight;
            sum.P += part.P * weight;
            sum.h += part.h * weight;
        }
        sum
    }
}

impl Motion<'_> {
    /// Carries state and sensitivities from grid time k to k + 1, in the steps of the grid.
    pub fn advance(&mut self, state: &State, k: usize) -> Option<State> {
        let t = &self.observations.time_s;
        let h = t[k + 1] - t[k];
        self.evaluate_at_grid_time(state, k)?;
        let joints = joint_frequency(self.vehicle.tree, &self.input_state.rates, self.gyration);
        let fastest = self.evaluated.as_ref()?.instant.twist.w.norm() + joints;
        // A motion far faster than measured is not propagated.
        self.steps_left -= (h * fastest / TURN).ceil().max(1.0);
        if self.steps_left.is_nan() || self.steps_left < 0.0 {
            return None;
        }
        let now = self.late_thrust(state, k);
        if now != *state {
            self.evaluate_here((k, 0.0), &now)?;
        }
        let of_grid = self.grid.get(k).copied().unwrap_or(1);
        let steps = of_grid as usize * self.vehicle.steps.factor as usize;
        if let Some(chord) = self.chord.take() {
            self.spare.chord = chord;
        }
        self.column_chord = None;
        if self.vehicle.steps.bends {
            self.find_chord(k, steps)?;
            self.column_chord = self.open_columns();
        }
        let end = self.follow(k, steps)?;
        if let Some(chord) = self.column_chord.take() {
            self.close_columns(chord)?;
        }
        if let Some(chord) = self.chord.take() {
            self.spare.chord = chord;
        }
        Some(end)
    }

    /// One step from the evaluated state to the next one.
    pub(super) fn step(&mut self, k: usize, from: f64, to: f64, h: f64) -> Option<State> {
        let dt = (to - from) * h;
        let start = self.evaluated.take()?;
        let state = &start.state;
        let a = self.slope(state, &start.instant, k);
        let push_at_start = start
            .variation
            .as_ref()
            .and_then(|v| self.push(state, &start.instant, v, k));

        std::mem::swap(&mut self.input_state, &mut self.middle);
        self.set_inputs(k, 0.5 * (from + to));
        let half = moved(state, &a, 0.5 * dt);
        let b = self.slope(&half, &self.instant(&half)?, k);
        let half = moved(state, &b, 0.5 * dt);
        let c = self.slope(&half, &self.instant(&half)?, k);

        std::mem::swap(&mut self.input_state, &mut self.middle);
        self.set_inputs(k, to);
        let full = moved(state, &c, dt);
        let d = self.slope(&full, &self.instant(&full)?, k);
        let sixth = 1.0 / 6.0;
        let mean = Slope::sum([(sixth, a), (2.0 * sixth, b), (2.0 * sixth, c), (sixth, d)]);
        let end = moved(state, &mean, dt);
        self.evaluate_here((k, to), &end)?;

        if let Some(at_start) = &start.variation {
            let evaluated = self.evaluated.take()?;
            let at_end = evaluated.variation.as_ref()?;
            let e = self.slope(&end, &evaluated.instant, k);
            let push_at_end = self.push(&end, &evaluated.instant, at_end, k);
            // The cubic through both ends, in its middle: as good as the step itself.
            let halfway =
                Slope::sum([(0.5 / dt, difference(state, &end)), (0.125, a), (-0.125, e)]);
            let half = moved(state, &halfway, dt);
            std::mem::swap(&mut self.input_state, &mut self.middle);
            let instant = self.instant(&half)?;
            let mut variation = self.spare.variation();
            self.linearise(&half, &instant, Arc::make_mut(&mut variation));
            let in_middle = &*variation;
            let push_in_middle = self.push(&half, &instant, in_middle, k);
            std::mem::swap(&mut self.input_state, &mut self.middle);
            let along = StepEquation {
                variation: [at_start, in_middle, at_end],
                push: match (push_at_start, push_in_middle, push_at_end) {
                    (Some(start), Some(middle), Some(end)) => Some([start, middle, end]),
                    _ => None,
                },
            };
            let initial_columns = self.initial_columns;
            for (j, column) in self.columns.iter_mut().enumerate() {
                along.carry(
                    column,
                    ColumnForcing::Unknown(j.checked_sub(initial_columns)),
                    dt,
                );
            }
            if let Some(chord) = &mut self.column_chord {
                let shares = [from, 0.5 * (from + to), to];
                for j in 0..chord.columns.len() {
                    let drive = ColumnForcing::Chord(shares.map(|share| chord.drive(j, share)));
                    along.carry(&mut chord.columns[j], drive, dt);
                }
            }
            let pushes = along.push.into_iter().flatten();
            self.spare.drives.extend(pushes.map(|push| push.drive));
            self.spare.variations.push(variation);
            self.evaluated = Some(evaluated);
        }
        self.spare.retire(start);
        Some(end)
    }

    fn slope(&self, state: &State, instant: &Instant, k: usize) -> Slope {
        let (v, w) = (instant.twist.v, instant.twist.w);
        let mut slope = Slope {
            R: state.R_NB.quaternion() * Quaternion::from_imag(w) * 0.5,
            p: state.R_NB * v,
            P: Vector3::zeros(),
            h: Vector3::zeros(),
        };
        if self.has_external_wrench(k) {
            let mut torque = self.environment_torque(state, &w, &instant.centre);
            for force in self.thrust_now(instant, k) {
                slope.P += state.R_NB * force.F_B;
                torque += force.arm_B.cross(&force.F_B);
            }
            let (l_out, h_out) = self.momentum_loss(instant, k);
            slope.P -= state.R_NB * l_out;
            torque -= h_out;
            slope.h = state.R_NB * torque;
        }
        slope
    }
}

fn moved(state: &State, slope: &Slope, dt: f64) -> State {
    State {
        R_NB: UnitQuaternion::from_quaternion(state.R_NB.quaternion() + slope.R * dt),
        p_NoBo_N: state.p_NoBo_N + slope.p * dt,
        P: state.P + slope.P * dt,
        h_SScm_N: state.h_SScm_N + slope.h * dt,
    }
}

/// `to - from`, the quaternions in one hemisphere.
fn difference(from: &State, to: &State) -> Slope {
    let (a, b) = (from.R_NB.quaternion(), to.R_NB.quaternion());
    let b = if a.coords.dot(&b.coords) < 0.0 {
        -b
    } else {
        *b
    };
    Slope {
        R: b - a,
        p: to.p_NoBo_N - from.p_NoBo_N,
        P: to.P - from.P,
        h: to.h_SScm_N - from.h_SScm_N,
    }
}
