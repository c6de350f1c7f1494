//! The equations of one sample as whitened rows: momentum now = momentum at the start + impulse.

use crate::likelihood::impulse::Impulses;
use crate::problem::parameters::{Equations, Parameters, UnknownKind};
use crate::problem::segment::{Noise, Segment};
use nalgebra::Cholesky;
use poinsot_dynamics::{
    Kinematics, SensorError, Tree, composite, momentum, momentum_regressor, shift_to_body,
    wheel_momentum, wheel_regressor,
};
use poinsot_model::{Momentum, MomentumKnowledge};
use poinsot_spatial::{Matrix3, Matrix6, Vector3, Vector6, skew, tensor_regressor};

/// Columns of a momentum at the start: one for each unknown component.
pub(crate) fn start_columns(start: &Momentum) -> usize {
    let count = |k: &MomentumKnowledge| 3 * usize::from(*k == MomentumKnowledge::Estimate);
    count(&start.linear) + count(&start.angular)
}

/// Everything that stays the same from sample to sample.
pub struct RowSetting<'a> {
    /// Kinematics of the vehicle.
    pub tree: &'a Tree,
    /// Unknowns.
    pub parameters: &'a Parameters,
    /// Spin inertia of each wheel, kg m2; zero where it is unknown.
    pub spin_inertia: &'a [f64],
    /// Nominal spin inertia of each wheel, kg m2.
    pub nominal_spin: &'a [f64],
    /// Declared noise.
    pub noise: &'a Noise,
}

/// Builds the rows of one segment.
pub struct Rows<'a> {
    setting: &'a RowSetting<'a>,
    segment: &'a Segment,
    impulses: &'a Impulses,
    /// In N; the angular momentum about the inertial origin, or the mass centre where only rotation is seen.
    start: Momentum,
    kinematics: Kinematics,
    unit: Kinematics,
    regressor: Vec<[f64; 6]>,
    wheels: Vec<[f64; 6]>,
    columns: Vec<[f64; 6]>,
    /// Positions or rates of the joints.
    joints: Vec<f64>,
}

impl<'a> Rows<'a> {
    /// Scratch for a segment.
    pub fn new(
        setting: &'a RowSetting<'a>,
        segment: &'a Segment,
        impulses: &'a Impulses,
        start: Momentum,
    ) -> Self {
        let tree = setting.tree;
        Self {
            kinematics: Kinematics::new(tree),
            unit: Kinematics::new(tree),
            regressor: vec![[0.0; 6]; 10 * tree.bodies()],
            wheels: vec![[0.0; 6]; tree.rotors.len()],
            columns: Vec::with_capacity(start_columns(&start) + setting.parameters.len() + 1),
            joints: Vec::with_capacity(tree.dof()),
            setting,
            segment,
            impulses,
            start,
        }
    }

    /// The whitened rows of sample k, one array of six per column.
    pub fn at(&mut self, k: usize) -> &[[f64; 6]] {
        self.place(k);
        self.columns.clear();
        match self.setting.parameters.equations {
            Equations::Momentum => self.momentum_columns(k),
            Equations::Rotation => self.rotation_columns(k),
        }
        let covariance = self.covariance(k);
        whiten(&mut self.columns, covariance);
        &self.columns
    }

    fn place(&mut self, k: usize) {
        let (tree, s) = (self.setting.tree, &self.segment.samples);
        let dof = tree.dof();
        self.kinematics
            .place(tree, &s.joint_position[k * dof..(k + 1) * dof]);
        let v = match &s.translation {
            Some(t) => s.R_NB[k].inverse() * t.v_NBo_N[k],
            None => Vector3::zeros(),
        };
        let rates = &s.joint_rate[k * dof..(k + 1) * dof];
        self.kinematics
            .set_velocities(tree, &v, &s.w_NB_B[k], rates);
    }

    fn speeds(&self, k: usize) -> &'a [f64] {
        let n = self.setting.tree.rotors.len();
        &self.segment.samples.wheel_speed[k * n..(k + 1) * n]
    }

    /// Six rows: `Y_u x - X [P0; H0] = X J - Y pi_known - c_w` (DESIGN section 2, "Linear").
    fn momentum_columns(&mut self, k: usize) {
        let setting = self.setting;
        let s = &self.segment.samples;
        let inverse = s.R_NB[k].inverse();
        let p = position(s, k);
        let zero = Vector3::zeros();
        let unknown = |of: MomentumKnowledge| of == MomentumKnowledge::Estimate;
        let linear = basis().into_iter().filter(|_| unknown(self.start.linear));
        let angular = basis().into_iter().filter(|_| unknown(self.start.angular));
        let all = linear.map(|e| (e, zero)).chain(angular.map(|e| (zero, e)));
        for (P, H) in all {
            let (l, h) = shift_to_body(&s.R_NB[k], &p, &P, &H);
            self.columns.push(stack(&-l, &-h));
        }
        momentum_regressor(&self.kinematics, &mut self.regressor);
        let speeds = self.speeds(k);
        wheel_regressor(setting.tree, &self.kinematics, speeds, &mut self.wheels);
        let mut scaled = self.impulses.scaled.iter();
        let mut bias_map: Option<Matrix6> = None;
        for unknown in &setting.parameters.unknowns {
            let column = match &unknown.kind {
                UnknownKind::Barycentric(parts) => combine(&self.regressor, parts),
                UnknownKind::SpinInertia(w) => self.wheels[*w],
                UnknownKind::ThrusterScale(_) => {
                    let j = scaled.next().map(|list| list[k]);
                    let j = j.unwrap_or(self.impulses.total[k]);
                    let (l, h) = shift_to_body(&s.R_NB[k], &p, &j.linear, &j.angular);
                    stack(&-l, &-h)
                }
                UnknownKind::Sensor {
                    sensor,
                    error: SensorError::Bias(axis),
                } if Some(*sensor) == setting.noise.gyro_sensor => {
                    // The measured rate is too large by the bias: Y(w - b) pi = Y(w) pi - H_w b.
                    let h = bias_map.get_or_insert_with(|| {
                        composite(&setting.parameters.nominal, &self.kinematics).locked_inertia()
                    });
                    let c = h.column(3 + axis);
                    [-c[0], -c[1], -c[2], -c[3], -c[4], -c[5]]
                }
                _ => [0.0; 6],
            };
            self.columns.push(column);
        }
        let known = momentum(&setting.parameters.known, &self.kinematics);
        let wheels = wheel_momentum(setting.tree, &self.kinematics, setting.spin_inertia, speeds);
        let j = &self.impulses.total[k];
        let (mut P, mut H) = (j.linear, j.angular);
        if let MomentumKnowledge::Known(start) = self.start.linear {
            P += start;
        }
        if let MomentumKnowledge::Known(start) = self.start.angular {
            H += start;
        }
        let l = inverse * P;
        let h = inverse * (H - p.cross(&P));
        let l = l - known.fixed_rows::<3>(0);
        let h = h - known.fixed_rows::<3>(3) - wheels;
        self.columns.push(stack(&l, &h));
    }

    /// Covariance of the six rows to first order in the noise of every measurement, at the nominal
    /// parameters.
    fn momentum_covariance(&mut self, k: usize) -> Matrix6 {
        let setting = self.setting;
        let (noise, tree) = (setting.noise, setting.tree);
        let s = &self.segment.samples;
        let nominal = &setting.parameters.nominal;
        let H = composite(nominal, &self.kinematics).locked_inertia();
        let now = momentum(nominal, &self.kinematics);
        let l: Vector3 = now.fixed_rows::<3>(0).into();
        let speeds = self.speeds(k);
        let wheels = wheel_momentum(tree, &self.kinematics, setting.nominal_spin, speeds);
        let h: Vector3 = now.fixed_rows::<3>(3) + wheels;
        let R = *s.R_NB[k].to_rotation_matrix().matrix();
        let velocity_B = R.transpose() * noise.velocity * R;
        let (Hv, Hw) = (H.fixed_columns::<3>(0), H.fixed_columns::<3>(3));
        let mut C: Matrix6 = Hv * velocity_B * Hv.transpose() + Hw * noise.gyro * Hw.transpose();
        if noise.attitude != Matrix3::zeros() {
            // A small turn moves the measured velocity and the inertial momentum alike.
            let mut d = Hv * skew(&self.kinematics.v[0]);
            let mut top = d.fixed_rows_mut::<3>(0);
            top -= skew(&l);
            let mut bottom = d.fixed_rows_mut::<3>(3);
            bottom -= skew(&h);
            C += d * noise.attitude * d.transpose();
        }
        if noise.position != Matrix3::zeros() {
            let d = skew(&l) * R.transpose();
            let mut block = C.fixed_view_mut::<3, 3>(3, 3);
            block += d * noise.position * d.transpose();
        }
        let dof = tree.dof();
        let rates = &s.joint_rate[k * dof..(k + 1) * dof];
        let (v, w) = (self.kinematics.v[0], self.kinematics.w[0]);
        for j in 0..dof {
            if noise.joint_rate[j] > 0.0 {
                self.joints.clear();
                self.joints.resize(dof, 0.0);
                self.joints[j] = 1.0;
                self.set_unit(&Vector3::zeros(), &Vector3::zeros());
                let d = momentum(nominal, &self.unit);
                C += d * d.transpose() * noise.joint_rate[j];
            }
            if noise.joint_position[j] > 0.0 {
                let at = &s.joint_position[k * dof..(k + 1) * dof];
                self.joints.clear();
                self.joints.extend_from_slice(at);
                let step = 1.0e-5;
                let mut ends = [Vector6::zeros(); 2];
                for (end, sign) in ends.iter_mut().zip([1.0, -1.0]) {
                    self.joints[j] = at[j] + sign * step;
                    self.unit.place(tree, &self.joints);
                    self.unit.set_velocities(tree, &v, &w, rates);
                    *end = momentum(nominal, &self.unit);
                }
                let d = (ends[0] - ends[1]) / (2.0 * step);
                C += d * d.transpose() * noise.joint_position[j];
            }
        }
        let mut block = C.fixed_view_mut::<3, 3>(3, 3);
        block += self.wheel_covariance();
        C
    }

    /// The bodies where they are, at other velocities of the base and at rates of the joints in hand.
    fn set_unit(&mut self, v: &Vector3, w: &Vector3) {
        self.unit.R.clone_from(&self.kinematics.R);
        self.unit.p.clone_from(&self.kinematics.p);
        self.unit
            .set_velocities(self.setting.tree, v, w, &self.joints);
    }

    fn wheel_covariance(&self) -> Matrix3 {
        let setting = self.setting;
        let rotors = setting.tree.rotors.iter().zip(setting.nominal_spin);
        rotors
            .zip(&setting.noise.wheel_speed)
            .map(|((rotor, js), variance)| {
                let a = self.kinematics.R[rotor.body] * rotor.axis_B * *js;
                a * a.transpose() * *variance
            })
            .sum()
    }

    /// Three rows about the mass centre of one rigid body: `I w - R^T (H0 + K c) = R^T J - c_w`.
    fn rotation_columns(&mut self, k: usize) {
        let setting = self.setting;
        let s = &self.segment.samples;
        let inverse = s.R_NB[k].inverse();
        let w = s.w_NB_B[k];
        let zero = Vector3::zeros();
        if self.start.angular == MomentumKnowledge::Estimate {
            for e in basis() {
                self.columns.push(stack(&zero, &-(inverse * e)));
            }
        }
        let speeds = self.speeds(k);
        wheel_regressor(setting.tree, &self.kinematics, speeds, &mut self.wheels);
        let given = &setting.parameters.nominal_properties[0];
        let asked = setting.parameters.estimate[0];
        let total = &self.impulses.total[k];
        let mut scaled = self.impulses.scaled.iter();
        let mut sees_com = false;
        for unknown in &setting.parameters.unknowns {
            let column = match &unknown.kind {
                UnknownKind::CentralInertia(n) => {
                    stack(&zero, &tensor_regressor(&w).column(*n).into())
                }
                UnknownKind::MassCentre(axis) => {
                    sees_com = true;
                    let h = inverse * total.per_mass_centre.column(*axis).into_owned();
                    stack(&zero, &-h)
                }
                UnknownKind::SpinInertia(n) => self.wheels[*n],
                UnknownKind::ThrusterScale(_) => {
                    let j = scaled.next().map(|list| list[k]).unwrap_or(*total);
                    let about_cm = j.angular + j.per_mass_centre * given.p_BoBcm_B;
                    stack(&zero, &-(inverse * about_cm))
                }
                UnknownKind::Sensor {
                    sensor,
                    error: SensorError::Bias(axis),
                } if Some(*sensor) == setting.noise.gyro_sensor => {
                    let h = given.I_BBcm_B.column(*axis).into_owned();
                    stack(&zero, &-h)
                }
                _ => [0.0; 6],
            };
            self.columns.push(column);
        }
        let mut H = total.angular;
        if !sees_com {
            H += total.per_mass_centre * given.p_BoBcm_B;
        }
        if let MomentumKnowledge::Known(start) = self.start.angular {
            H += start;
        }
        let wheels = wheel_momentum(setting.tree, &self.kinematics, setting.spin_inertia, speeds);
        let mut h = inverse * H - wheels;
        if !asked.inertia {
            h -= given.I_BBcm_B * w;
        }
        self.columns.push(stack(&zero, &h));
    }

    fn rotation_covariance(&self, k: usize) -> Matrix6 {
        let setting = self.setting;
        let noise = setting.noise;
        let I = setting.parameters.nominal_properties[0].I_BBcm_B;
        let w = self.segment.samples.w_NB_B[k];
        let speeds = self.speeds(k);
        let wheels = wheel_momentum(setting.tree, &self.kinematics, setting.nominal_spin, speeds);
        let turn = skew(&(I * w + wheels));
        let C = I * noise.gyro * I.transpose()
            + turn * noise.attitude * turn.transpose()
            + self.wheel_covariance();
        // The linear rows are empty: any positive variance leaves them so.
        let mut out = Matrix6::identity();
        out.fixed_view_mut::<3, 3>(3, 3).copy_from(&C);
        out
    }

    fn covariance(&mut self, k: usize) -> Matrix6 {
        match self.setting.parameters.equations {
            Equations::Momentum => self.momentum_covariance(k),
            Equations::Rotation => self.rotation_covariance(k),
        }
    }

    /// Squared size that measurement noise alone gives to the whitened columns of the unknowns at
    /// sample k: `E[dA^T dA]`, added to `sum` (unknowns x unknowns, row by row).
    pub fn add_regressor_noise(&mut self, k: usize, weight: f64, sum: &mut [f64]) {
        self.place(k);
        self.columns.clear();
        let covariance = self.covariance(k);
        let noise = self.setting.noise;
        let dof = self.setting.tree.dof();
        let R = *self.segment.samples.R_NB[k].to_rotation_matrix().matrix();
        let velocity_B = R.transpose() * noise.velocity * R;
        let zero = Vector3::zeros();
        self.joints.clear();
        self.joints.resize(dof, 0.0);
        for (axis, e) in basis().iter().enumerate() {
            let variance = noise.gyro[(axis, axis)] * noise.seen_gyro;
            self.add_one_source(&covariance, &zero, e, variance * weight, sum);
            if self.setting.parameters.equations == Equations::Momentum {
                let variance = velocity_B[(axis, axis)] * noise.seen_velocity;
                self.add_one_source(&covariance, e, &zero, variance * weight, sum);
            }
        }
        for j in 0..dof {
            self.joints[j] = 1.0;
            let variance = noise.joint_rate[j] * noise.seen_joint_rate;
            self.add_one_source(&covariance, &zero, &zero, variance * weight, sum);
            self.joints[j] = 0.0;
        }
    }

    fn add_one_source(
        &mut self,
        covariance: &Matrix6,
        v: &Vector3,
        w: &Vector3,
        variance: f64,
        sum: &mut [f64],
    ) {
        if variance <= 0.0 {
            return;
        }
        let setting = self.setting;
        self.set_unit(v, w);
        momentum_regressor(&self.unit, &mut self.regressor);
        self.columns.clear();
        for unknown in &setting.parameters.unknowns {
            let column = match &unknown.kind {
                UnknownKind::Barycentric(parts) => combine(&self.regressor, parts),
                UnknownKind::CentralInertia(n) => {
                    let h = tensor_regressor(w).column(*n).into();
                    stack(&Vector3::zeros(), &h)
                }
                _ => [0.0; 6],
            };
            self.columns.push(column);
        }
        whiten(&mut self.columns, *covariance);
        let n = self.columns.len();
        for (i, a) in self.columns.iter().enumerate() {
            for (j, b) in self.columns.iter().enumerate() {
                let dot: f64 = a.iter().zip(b).map(|(x, y)| x * y).sum();
                sum[i * n + j] += variance * dot;
            }
        }
    }
}

/// Position of the base origin at sample k; zero where only rotation is seen.
fn position(s: &crate::problem::segment::Samples, k: usize) -> Vector3 {
    s.translation
        .as_ref()
        .map_or_else(Vector3::zeros, |t| t.p_NoBo_N[k])
}

fn basis() -> [Vector3; 3] {
    [Vector3::x(), Vector3::y(), Vector3::z()]
}

#[inline]
fn stack(l: &Vector3, h: &Vector3) -> [f64; 6] {
    [l.x, l.y, l.z, h.x, h.y, h.z]
}

#[inline]
fn combine(regressor: &[[f64; 6]], parts: &[(usize, f64)]) -> [f64; 6] {
    let mut sum = [0.0; 6];
    for (at, coefficient) in parts {
        for (s, r) in sum.iter_mut().zip(&regressor[*at]) {
            *s += coefficient * r;
        }
    }
    sum
}

/// Multiplies every column by the inverse square root of the covariance of the rows.
fn whiten(columns: &mut [[f64; 6]], covariance: Matrix6) {
    let Some(cholesky) = Cholesky::new(covariance) else {
        return;
    };
    let inverse = cholesky
        .l()
        .solve_lower_triangular(&Matrix6::identity())
        .unwrap_or_else(Matrix6::identity);
    for column in columns {
        *column = (inverse * Vector6::from(*column)).into();
    }
}
