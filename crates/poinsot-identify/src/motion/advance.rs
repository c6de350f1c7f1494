//! From one grid time to the next.
//!
//! The state goes by the classical Runge-Kutta of fourth order. Its sensitivities follow the variational equation along
//! the path found: at both ends of a step and in its middle, of which the next step shares the end.

use super::grid::{TURN, joint_frequency};
use super::variation::StepEquation;
use super::{Instant, Motion, State};
use poinsot_dynamics::propagation::{
    FlexibleRate, Internal, PoseMomentumRate, Rates, StepPoint, runge_kutta_step, state_in_middle,
};
use poinsot_spatial::Vector3;
use std::sync::Arc;

/// Motion within a step from share `from` to share `to` of the interval after grid time k, its inputs in the middle set.
struct WithinStep<'m, 'a> {
    motion: &'m mut Motion<'a>,
    k: usize,
    to: f64,
    at: StepPoint,
}

impl Rates<State> for WithinStep<'_, '_> {
    fn rate(&mut self, at: StepPoint, state: &State) -> Option<FlexibleRate> {
        let motion = &mut *self.motion;
        if at != self.at {
            self.at = at;
            std::mem::swap(&mut motion.input_state, &mut motion.middle);
            motion.set_inputs(self.k, self.to);
        }
        let instant = motion.instant(state)?;
        Some(motion.rate(state, &instant, self.k))
    }
}

impl Motion<'_> {
    /// Carries state and sensitivities from grid time k to k + 1, in the steps of the grid; after the last one they stay.
    pub fn advance(&mut self, state: &State, k: usize) -> Option<State> {
        let t = &self.observations.time_s;
        if k + 1 == t.len() {
            return Some(*state);
        }
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
        let steps = of_grid as usize * self.vehicle.fineness.factor as usize;
        if self.vehicle.fineness.bends {
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
        let a = self.rate(state, &start.instant, k);
        let push_at_start = start
            .variation
            .as_ref()
            .and_then(|v| self.push(state, &start.instant, v, k));

        std::mem::swap(&mut self.input_state, &mut self.middle);
        self.set_inputs(k, 0.5 * (from + to));
        let end = runge_kutta_step(
            state,
            &a,
            dt,
            &mut WithinStep {
                motion: self,
                k,
                to,
                at: StepPoint::Middle,
            },
        )?;
        self.evaluate_here((k, to), &end)?;

        if let Some(at_start) = &start.variation {
            let evaluated = self.evaluated.take()?;
            let at_end = evaluated.variation.as_ref()?;
            let e = self.rate(&end, &evaluated.instant, k);
            let push_at_end = self.push(&end, &evaluated.instant, at_end, k);
            let half = state_in_middle((state, &a), (&end, &e), dt);
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
            let columns = self.columns.split_at_mut(self.initial_columns);
            along.carry(columns, &self.vehicle.moving, dt);
            if let Some(chord) = &mut self.column_chord {
                let shares = [from, 0.5 * (from + to), to];
                for j in 0..chord.columns.len() {
                    let wheels = shares.map(|share| chord.drive(j, share));
                    along.carry_chord(&mut chord.columns[j], wheels, dt);
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

    fn rate(&self, state: &State, instant: &Instant, k: usize) -> FlexibleRate {
        let (force, torque) = match self.has_external_wrench(k) {
            true => self.external_wrench(state, instant, k),
            false => (Vector3::zeros(), Vector3::zeros()),
        };
        let flexible = self.input_state.flexible.as_ref();
        FlexibleRate {
            rigid: PoseMomentumRate::new(state, &instant.twist, (&force, &torque)),
            internal: flexible.map_or_else(Internal::zeros, |f| {
                f.rate(instant, &state.internal, &force)
            }),
        }
    }
}
