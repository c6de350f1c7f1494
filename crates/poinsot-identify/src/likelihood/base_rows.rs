//! Rows of the sensors of the base's motion: rate and velocity, attitude and position.

use super::ideal::slope;
use super::{ATTITUDE, Compare, GYRO, POSITION, VELOCITY};
use crate::motion::{Column, Instant, Motion, State, matrix, small_turn};
use crate::parameters::UnknownKind;
use nalgebra::Matrix6;
use poinsot_spatial::{Matrix3, Vector3, Vector6};

impl Compare<'_> {
    /// Angular acceleration at grid time k from the predicted rates on both sides, rad/s2.
    pub(super) fn acceleration(&self, k: usize) -> Vector3 {
        slope(&self.segment.observations.time_s, &self.ideal.rate, k)
    }

    /// The rate where no velocity is read: half as many rows.
    fn rate_rows(&mut self, reading: &Vector3, instant: &Instant, twists: &[Vector6], k: usize) {
        let noise = self.setting.noise;
        let w = instant.twist.w;
        let acceleration = self.acceleration(k);
        let residual = reading - self.gyro.reading(&w, &acceleration);
        let seen = |twist: &Vector6, unknown: Option<&UnknownKind>| {
            let dw: Vector3 = twist.fixed_rows::<3>(3).into();
            self.gyro.change(&w, &acceleration, &dw, unknown)
        };
        let mut white_noise = noise.gyro;
        for (gain, variance) in self.inputs.rate_gain.iter().zip(&self.joint_rate) {
            if *variance > 0.0 {
                let g = seen(gain, None);
                white_noise += g * g.transpose() * *variance;
            }
        }
        let errors = self.inputs.twists.iter();
        let mut slopes: Vec<Vector3> = errors.map(|t| seen(t, None)).collect();
        let mut rows: Vec<Vector3> = Vec::with_capacity(twists.len() + 1);
        if self.qr.is_some() {
            let kinds = &self.setting.parameters.unknowns;
            rows.extend(twists.iter().enumerate().map(|(j, twist)| {
                let unknown = j.checked_sub(self.head).map(|u| &kinds[u].kind);
                seen(twist, unknown)
            }));
        }
        rows.push(residual);
        self.coloured((GYRO, 0, k), &mut rows, &mut slopes);
        if let Some(white) = self.take(&slopes, &white_noise, &noise.gyro, rows) {
            self.note(GYRO, &residual, white);
        }
    }

    /// Velocity and rate together: the noise of joints and wheels is common to both.
    pub(super) fn twist_rows(
        &mut self,
        motion: &Motion,
        state: &State,
        instant: &Instant,
        twists: &[Vector6],
        k: usize,
    ) {
        let o = &self.segment.observations;
        let Some(velocity) = o.velocity[k] else {
            if let Some(rate) = o.rate[k] {
                self.rate_rows(&rate, instant, twists, k);
            }
            return;
        };
        let noise = self.setting.noise;
        let R = matrix(&state.R_NB);
        let arm = o.velocity_arm_B;
        let v_S = instant.twist.v + instant.twist.w.cross(&arm);
        let acceleration = self.acceleration(k);
        let expected = self.gyro.reading(&instant.twist.w, &acceleration);
        let gain_of_v = R.transpose() * slope(&o.time_s, &self.ideal.velocity, k);
        // In body axes a reading turns with the attitude.
        let v_read = R.transpose() * velocity;
        let r_v = v_read - v_S + gain_of_v * self.translation_lag[0];
        let residual_w = o.rate[k].map(|w| w - expected);
        // How a change of state and twist shows in the two readings; nothing where the rate is missing.
        let seen = |column: &Column, twist: &Vector6, unknown: Option<&UnknownKind>| {
            let mut d = at_sensor(twist, &arm);
            // R (v) measured in N: a turn of the body moves it by -[v]x dphi, in body axes.
            let dphi: Vector3 = column.fixed_rows::<3>(0).into();
            let mut dv = d.fixed_rows::<3>(0) + dphi.cross(&v_read);
            if unknown == Some(&UnknownKind::VelocityLag) {
                dv -= gain_of_v;
            }
            let dw: Vector3 = d.fixed_rows::<3>(3).into();
            let dw = self
                .gyro
                .change(&instant.twist.w, &acceleration, &dw, unknown);
            d.fixed_rows_mut::<3>(0).copy_from(&dv);
            d.fixed_rows_mut::<3>(3)
                .copy_from(&residual_w.map_or_else(Vector3::zeros, |_| dw));
            d
        };
        // Velocity is compared in body axes: there its noise and that of the joints add plainly. A missing rate
        // is given a variance without information, and is not counted.
        let blind = Matrix3::identity() * (1.0e12 * (noise.velocity + noise.gyro).diagonal().max());
        let velocity_B = R.transpose() * noise.velocity * R;
        let mut sensors = Matrix6::zeros();
        sensors.fixed_view_mut::<3, 3>(0, 0).copy_from(&velocity_B);
        sensors
            .fixed_view_mut::<3, 3>(3, 3)
            .copy_from(&residual_w.map_or(blind, |_| noise.gyro));
        let mut white_noise = sensors;
        for (gain, variance) in self.inputs.rate_gain.iter().zip(&self.joint_rate) {
            if *variance > 0.0 {
                let g = seen(&Column::zeros(), gain, None);
                white_noise += g * g.transpose() * *variance;
            }
        }
        let errors = self.inputs.columns.iter().zip(&self.inputs.twists);
        let mut slopes: Vec<Vector6> = errors.map(|(c, t)| seen(c, t, None)).collect();
        let mut rows: Vec<Vector6> = Vec::with_capacity(twists.len() + 1);
        if self.qr.is_some() {
            let kinds = &self.setting.parameters.unknowns;
            let columns = motion.columns.iter().zip(twists).enumerate();
            rows.extend(columns.map(|(j, (column, twist))| {
                let unknown = j.checked_sub(self.head).map(|u| &kinds[u].kind);
                seen(column, twist, unknown)
            }));
        }
        let w = residual_w.unwrap_or_default();
        rows.push(Vector6::new(r_v.x, r_v.y, r_v.z, w.x, w.y, w.z));
        self.coloured((VELOCITY, 0, k), &mut rows, &mut slopes);
        if residual_w.is_some() {
            self.coloured((GYRO, 3, k), &mut rows, &mut slopes);
        }
        let Some(white) = self.take(&slopes, &white_noise, &sensors, rows) else {
            return;
        };
        self.note(VELOCITY, &r_v, white.fixed_rows::<3>(0).into());
        if let Some(r) = residual_w {
            self.note(GYRO, &r, white.fixed_rows::<3>(3).into());
        }
    }

    pub(super) fn pose_rows(&mut self, motion: &Motion, state: &State, k: usize) {
        let o = &self.segment.observations;
        let noise = self.setting.noise;
        if let Some(measured) = o.attitude[k] {
            let late = self.ideal.rate.get(k).copied().unwrap_or_default();
            let residual = small_turn(&state.R_NB, &measured) + late * self.attitude_lag;
            self.pose(
                motion,
                (ATTITUDE, k),
                &noise.attitude,
                &residual,
                |column, unknown| {
                    let own: Vector3 = column.fixed_rows::<3>(0).into();
                    match unknown {
                        Some(UnknownKind::AttitudeLag) => own - late,
                        _ => own,
                    }
                },
            );
        }
        if let Some(measured) = o.position[k] {
            let R = matrix(&state.R_NB);
            let arm = o.position_arm_B;
            let moving = slope(&o.time_s, &self.ideal.position, k);
            let residual = measured - state.p_NoBo_N - R * arm + moving * self.translation_lag[1];
            let seen = |column: &Column, unknown: Option<&UnknownKind>| {
                let dphi: Vector3 = column.fixed_rows::<3>(0).into();
                let own = column.fixed_rows::<3>(3) + R * dphi.cross(&arm);
                match unknown {
                    Some(UnknownKind::PositionLag) => own - moving,
                    _ => own,
                }
            };
            self.pose(motion, (POSITION, k), &noise.position, &residual, seen);
        }
    }

    /// Three rows of a sensor of the pose.
    fn pose(
        &mut self,
        motion: &Motion,
        (channel, k): (usize, usize),
        covariance: &Matrix3,
        residual: &Vector3,
        seen: impl Fn(&Column, Option<&UnknownKind>) -> Vector3,
    ) {
        let errors = self.inputs.columns.iter();
        let mut slopes: Vec<Vector3> = errors.map(|c| seen(c, None)).collect();
        let mut rows: Vec<Vector3> = Vec::with_capacity(motion.columns.len() + 1);
        if self.qr.is_some() {
            let kinds = &self.setting.parameters.unknowns;
            let columns = motion.columns.iter().enumerate();
            rows.extend(
                columns.map(|(j, column)| {
                    seen(column, j.checked_sub(self.head).map(|u| &kinds[u].kind))
                }),
            );
        }
        rows.push(*residual);
        self.coloured((channel, 0, k), &mut rows, &mut slopes);
        if let Some(white) = self.take(&slopes, covariance, covariance, rows) {
            self.note(channel, residual, white);
        }
    }
}

/// A change of the base twist as seen by a velocity sensor at `arm`, and by the gyro.
fn at_sensor(twist: &Vector6, arm: &Vector3) -> Vector6 {
    let w: Vector3 = twist.fixed_rows::<3>(3).into();
    let v: Vector3 = twist.fixed_rows::<3>(0) + w.cross(arm);
    Vector6::new(v.x, v.y, v.z, w.x, w.y, w.z)
}
