//! The motion over one interval between samples, with the columns of the linearised equations.

use crate::configuration::{AXES, Configuration, ITERATIONS, PARAMETERS, WHEELS};
#[cfg(not(feature = "std"))]
use nalgebra::ComplexField;
use nalgebra::{ArrayStorage, SVector, SymmetricEigen};
use poinsot_dynamics::Composite;
use poinsot_dynamics::propagation::{
    BaseMotion, HALF, LockedVehicle, PoseMomentum, PoseMomentumRate, Rates, STATE, StateRows,
    StepPoint, StepRows, pose_change, runge_kutta_step, state_in_middle,
};
use poinsot_spatial::{Matrix3, TENSOR, Vector3, Vector6, tensor_regressor};

/// Largest turn of one step, rad.
const TURN: f64 = 0.1;
/// Most steps of an interval.
const STEPS: u32 = 64;
/// Samples that an excitation is remembered for.
const MEMORY: f64 = 1000.0;
/// Mean square of a velocity that may be noise of the wheel speeds, in their variance.
const JITTER: f64 = 4.0;
/// Sum of squares of a velocity that may be the error of the estimate at its beginning, in the variance of gyro and bias.
const STARTING: f64 = 40.0;
/// Factor on the noise that a direction must exceed to be added: then it is accurate.
const ADDED: f64 = 25.0;

/// Numbers of a column.
pub type StateVector = SVector<f64, STATE>;

/// What acts between two samples.
#[derive(Debug, Clone, Copy)]
pub struct Interval {
    /// Wheel speeds that were read at both ends, rad/s; straight between them but for the bend.
    pub speeds: [[f64; WHEELS]; 2],
    /// What the most likely speeds are above those read, so far as they are known.
    pub found: [[f64; WHEELS]; 2],
    pub bend: Bend,
    /// Force and torque about `Bo` in B, constant.
    pub force_B: Vector3,
    pub torque_B: Vector3,
    /// Length, s.
    pub dt: f64,
}

/// What lies between two samples and is not straight: readings that were left out.
#[derive(Debug, Clone, Copy)]
pub struct Bend {
    /// Momentum of the wheels less the impulse, about `Bo` in B, above the straight line between both ends; integral over the
    /// interval, N s2 and N m s2.
    pub offset: [f64; 2 * AXES],
    /// Intervals between readings.
    pub readings: u32,
}

impl Bend {
    /// No reading in between.
    pub const NONE: Self = Self {
        offset: [0.0; 2 * AXES],
        readings: 1,
    };

    /// What an error of the speed at the beginning is at `x` of the interval. It has a share of `1 / 2n` in the mean of `n + 1`
    /// readings (trapezoids).
    fn of_begin(&self, x: f64) -> f64 {
        let mean = 0.5 / f64::from(self.readings.max(1));
        1.0 - x - 3.0 * x * (1.0 - x) * (1.0 - 2.0 * mean)
    }

    /// Error of the mean by the readings in between, in that of one.
    pub fn of_mean(&self) -> f64 {
        let n = f64::from(self.readings.max(1));
        (n - 1.0).sqrt() / n
    }

    /// What one at the end is.
    fn of_end(&self, x: f64) -> f64 {
        self.of_begin(1.0 - x)
    }
}

/// The state at the end of an interval over what it depends on.
#[derive(Debug, Clone, Copy)]
pub struct Columns {
    pub state: [StateVector; STATE],
    /// Over the noise of each wheel speed at both ends, one sigma.
    pub wheels: [[StateVector; WHEELS]; 2],
    /// Over all parameters of the unknown body.
    pub parameters: [StateVector; PARAMETERS],
}

impl Columns {
    pub fn new() -> Self {
        let none = StateVector::zeros();
        let unit = |k: usize| StateVector::from_fn(|i, _| if i == k { 1.0 } else { 0.0 });
        Self {
            state: core::array::from_fn(unit),
            wheels: [[none; WHEELS]; 2],
            parameters: [none; PARAMETERS],
        }
    }
}

/// The vehicle at one value of the parameters.
pub struct Moving<'a> {
    pub configuration: &'a Configuration,
    pub body: &'a [f64; PARAMETERS],
}

/// Directions of the angular velocity that the record has shown: the regressor of the inertia takes the velocity along them alone. A
/// velocity that is noise of the estimate would find information about inertia that does not show. The directions come from the
/// first window; from then on some are added, but none changes, for a change would be such a velocity. What the rest of the velocity
/// does to a common factor of the inertia is kept: without wheels and torque momentum and inertia have a common factor that does not
/// show either.
#[derive(Debug, Clone, Copy)]
pub struct Excitation {
    /// Sum of `w w^T` with a memory of [`MEMORY`] samples.
    scatter: Matrix3,
    samples: f64,
    projector: Matrix3,
    /// Whether directions may be added.
    pub grows: bool,
}

impl Excitation {
    /// No direction.
    pub const NONE: Self = Self {
        scatter: Matrix3::from_array_storage(ArrayStorage([[0.0; AXES]; AXES])),
        samples: 0.0,
        projector: Matrix3::from_array_storage(ArrayStorage([[0.0; AXES]; AXES])),
        grows: false,
    };

    /// All directions, until [`Self::settle`].
    pub fn new() -> Self {
        Self {
            projector: Matrix3::identity(),
            ..Self::NONE
        }
    }

    /// Begins to collect anew; the directions stay.
    pub fn begin(&mut self) {
        (self.scatter, self.samples) = (Matrix3::zeros(), 0.0);
    }

    /// Takes the directions from what was collected.
    pub fn settle(&mut self, configuration: &Configuration, motion: &BaseMotion) {
        let noise = self.noise(configuration, motion);
        let eigen = SymmetricEigen::try_new(self.scatter, f64::EPSILON, ITERATIONS);
        let Some(eigen) = eigen else {
            return;
        };
        self.projector = Matrix3::zeros();
        for (k, value) in eigen.eigenvalues.iter().enumerate() {
            if *value > noise {
                let direction = eigen.eigenvectors.column(k);
                self.projector += direction * direction.transpose();
            }
        }
    }

    /// One sample more at this motion.
    pub fn add(&mut self, configuration: &Configuration, motion: &BaseMotion) {
        let w = &motion.twist.w;
        let kept = if self.samples < MEMORY {
            1.0
        } else {
            1.0 - 1.0 / MEMORY
        };
        self.samples = (self.samples + 1.0).min(MEMORY);
        self.scatter = self.scatter * kept + w * w.transpose();
        if !self.grows {
            return;
        }
        let rest = Matrix3::identity() - self.projector;
        let noise = ADDED * self.noise(configuration, motion);
        let across = rest * self.scatter * rest;
        if across.trace() <= noise {
            return;
        }
        let eigen = SymmetricEigen::try_new(across, f64::EPSILON, ITERATIONS);
        let Some(eigen) = eigen else {
            return;
        };
        let (largest, value) = eigen.eigenvalues.argmax();
        if value > noise {
            let direction = rest * eigen.eigenvectors.column(largest);
            let direction = direction.normalize();
            self.projector += direction * direction.transpose();
        }
    }

    /// Sum of squares of a velocity that may be noise.
    fn noise(&self, configuration: &Configuration, motion: &BaseMotion) -> f64 {
        let (of_gyro, of_bias) = (configuration.noise.gyro, configuration.noise.bias);
        let wheels = wheel_twists(configuration, motion);
        let of_wheels: f64 = wheels.iter().map(|t| angular(t).norm_squared()).sum();
        // At the most likely speeds, by gyro and tachometers together.
        let gyro = AXES as f64 * of_gyro * of_gyro;
        let jitter = gyro * of_wheels / (gyro + of_wheels).max(f64::MIN_POSITIVE);
        STARTING * (of_gyro * of_gyro + of_bias * of_bias) + JITTER * self.samples * jitter
    }

    /// Relative change of the inertia along the shown directions, `tr(P dI) / tr(P I)`, per unit of each element; zero where nothing is
    /// shown.
    pub fn shares(&self, I: &Matrix3) -> [f64; 6] {
        let whole = (self.projector * I).trace();
        core::array::from_fn(|k| {
            let (i, j) = TENSOR[k];
            let both = if i == j { 1.0 } else { 2.0 };
            match whole > 0.0 {
                true => both * self.projector[(i, j)] / whole,
                false => 0.0,
            }
        })
    }
}

/// Angular part of a twist.
pub fn angular(twist: &Vector6) -> Vector3 {
    Vector3::new(twist.w, twist.a, twist.b)
}

/// Change of the base's twist with one sigma of each wheel speed.
pub fn wheel_twists(configuration: &Configuration, motion: &BaseMotion) -> [Vector6; WHEELS] {
    let mut out = [Vector6::zeros(); WHEELS];
    for (out, wheel) in out.iter_mut().zip(configuration.wheels()) {
        let h = Vector3::from(wheel.axis_B) * (wheel.spin_inertia * wheel.noise);
        let momentum = Vector6::new(0.0, 0.0, 0.0, h.x, h.y, h.z);
        *out = motion.twist_slope(&momentum, &Vector3::zeros());
    }
    out
}

/// What one parameter does at the present motion.
#[derive(Debug, Clone, Copy)]
pub struct ParameterSlope {
    /// To the base's twist, pose and momentum held.
    pub twist: Vector6,
    /// To the momentum about the mass centre in B, pose and twist held.
    pub momentum: Vector6,
    /// To the mass centre in B.
    pub centre: Vector3,
}

/// What each parameter does, with the rates of `held`.
pub fn parameter_slopes(motion: &BaseMotion, shown: &Excitation) -> [ParameterSlope; PARAMETERS] {
    let (c, l_B) = (motion.centre.p_BoScm_B, motion.centre.l_B);
    let w = shown.projector * motion.twist.w;
    let v = motion.twist.v + (motion.twist.w - w).cross(&c);
    let tensor = tensor_regressor(&w);
    let rest = motion.centre.I_SScm_B * (motion.twist.w - w);
    let shares = shown.shares(&motion.centre.I_SScm_B);
    core::array::from_fn(|k| {
        let (l, h) = match k {
            0 => (v, Vector3::zeros()),
            1..=AXES => {
                let axis = Vector3::from_fn(|i, _| if i + 1 == k { 1.0 } else { 0.0 });
                (w.cross(&axis), axis.cross(&v))
            }
            _ => {
                let element = k - AXES - 1;
                let h = tensor.column(element) + rest * shares[element];
                (Vector3::zeros(), h)
            }
        };
        let centre = motion.mass_centre_slope(&Matrix3::identity(), &Vector3::zeros(), k);
        let about_Bo = Vector6::new(l.x, l.y, l.z, h.x, h.y, h.z);
        let about_centre = h - c.cross(&l) - centre.cross(&l_B);
        ParameterSlope {
            twist: motion.twist_slope(&about_Bo, &centre),
            momentum: Vector6::new(
                l.x,
                l.y,
                l.z,
                about_centre.x,
                about_centre.y,
                about_centre.z,
            ),
            centre,
        }
    })
}

/// The equations at one point of a step.
struct Point {
    pose: StateRows,
    push: StateRows,
    wheels: [Vector6; WHEELS],
    parameters: [Vector6; PARAMETERS],
    pushes: [Vector6; PARAMETERS],
}

/// The locked vehicle at the three points of a step.
struct OverStep<'a> {
    locked: &'a [LockedVehicle; 3],
    interval: &'a Interval,
}

impl Rates for OverStep<'_> {
    fn rate(&mut self, at: StepPoint, state: &PoseMomentum) -> Option<PoseMomentumRate> {
        let locked = match at {
            StepPoint::Begin => &self.locked[0],
            StepPoint::Middle => &self.locked[1],
            StepPoint::End => &self.locked[2],
        };
        let motion = locked.base_motion(state);
        let torque = self.interval.central_torque(&motion);
        let wrench = (&self.interval.force_B, &torque);
        Some(PoseMomentumRate::new(state, &motion.twist, wrench))
    }
}

impl Interval {
    fn central_torque(&self, motion: &BaseMotion) -> Vector3 {
        self.torque_B - motion.centre.p_BoScm_B.cross(&self.force_B)
    }

    /// Momentum above the straight line: a parabola.
    fn momentum_at(&self, share: f64) -> Vector6 {
        Vector6::from(self.bend.offset) * (6.0 * share * (1.0 - share) / self.dt)
    }

    fn speeds_at(&self, share: f64) -> [f64; WHEELS] {
        let [from, to] = &self.speeds;
        let (begin, end) = (self.bend.of_begin(share), self.bend.of_end(share));
        core::array::from_fn(|k| {
            let found = begin * self.found[0][k] + end * self.found[1][k];
            from[k] + share * (to[k] - from[k]) + found
        })
    }
}

impl Moving<'_> {
    /// The locked vehicle at these wheel speeds, with a momentum about `Bo` more.
    pub fn locked(&self, speeds: &[f64; WHEELS], more: &Vector6) -> Option<LockedVehicle> {
        let whole = self.configuration.whole(self.body);
        let composite = Composite {
            mass: whole.mass,
            mc: whole.mc_B,
            I_SBo_B: whole.I_BBo_B,
        };
        let h = self.configuration.wheel_momentum(speeds);
        let joints = Vector6::new(0.0, 0.0, 0.0, h.x, h.y, h.z) + more;
        LockedVehicle::new(&composite, &composite, &joints)
    }

    /// Follows a state over an interval, and its columns where they are asked for.
    pub fn follow(
        &self,
        state: &PoseMomentum,
        interval: &Interval,
        mut linear: Option<(&mut Columns, &Excitation)>,
    ) -> Option<PoseMomentum> {
        let start = self
            .locked(&interval.speeds_at(0.0), &Vector6::zeros())?
            .base_motion(state);
        let turns = (start.twist.w.norm() * interval.dt.abs() / TURN).ceil();
        if !turns.is_finite() || turns > f64::from(STEPS) {
            return None;
        }
        // At least one, at most STEPS.
        let steps = turns.max(1.0);
        let mut state = *state;
        let mut step = 0.0;
        while step < steps {
            let shares = [step, step + 0.5, step + 1.0].map(|x| x / steps);
            let dt = interval.dt / steps;
            state = self.step(&state, interval, (shares, dt), &mut linear)?;
            step += 1.0;
        }
        Some(state)
    }

    fn step(
        &self,
        state: &PoseMomentum,
        interval: &Interval,
        (shares, dt): ([f64; 3], f64),
        linear: &mut Option<(&mut Columns, &Excitation)>,
    ) -> Option<PoseMomentum> {
        let [a, b, c] = shares
            .map(|share| self.locked(&interval.speeds_at(share), &interval.momentum_at(share)));
        let locked = &[a?, b?, c?];
        let mut over = OverStep { locked, interval };
        let rate = over.rate(StepPoint::Begin, state)?;
        let end = runge_kutta_step(state, &rate, dt, &mut over)?;
        if let Some((columns, shown)) = linear {
            let last = over.rate(StepPoint::End, &end)?;
            let middle = state_in_middle((state, &rate), (&end, &last), dt);
            let [first, second, third] = locked;
            let points = [(first, state), (second, &middle), (third, &end)];
            let points = points.map(|(locked, state)| {
                self.point(&locked.base_motion(state), state, interval, shown)
            });
            carry(&points, (shares, &interval.bend), dt, columns);
        }
        Some(end)
    }

    fn point(
        &self,
        motion: &BaseMotion,
        state: &PoseMomentum,
        interval: &Interval,
        shown: &Excitation,
    ) -> Point {
        let R: Matrix3 = state.R_NB.to_rotation_matrix().into_inner();
        let torque = interval.central_torque(motion);
        let slopes = parameter_slopes(motion, shown);
        Point {
            pose: motion.pose_rows(state, &motion.twist_rows(state)),
            push: StateRows::of_wrench(state, &interval.force_B, &torque),
            wheels: wheel_twists(self.configuration, motion).map(|t| pose_change(&R, &t)),
            parameters: slopes.map(|s| pose_change(&R, &s.twist)),
            pushes: slopes.map(|s| {
                let h = R * interval.force_B.cross(&s.centre);
                Vector6::new(0.0, 0.0, 0.0, h.x, h.y, h.z)
            }),
        }
    }
}

/// Carries all columns over a step.
fn carry(points: &[Point; 3], (shares, bend): ([f64; 3], &Bend), dt: f64, columns: &mut Columns) {
    let [begin, middle, end] = points;
    let rows = StepRows {
        pose: [&begin.pose, &middle.pose, &end.pose],
        momentum: [Some(&begin.push), Some(&middle.push), Some(&end.push)],
        modes: [None; 3],
    };
    let none = [[0.0; HALF]; 3];
    for column in &mut columns.state {
        rows.carry(&mut column.data.0[0], &none, &none, dt);
    }
    let [at_start, at_end] = &mut columns.wheels;
    for k in 0..WHEELS {
        let drive = |weight: fn(&Bend, f64) -> f64| {
            [0, 1, 2].map(|at| (points[at].wheels[k] * weight(bend, shares[at])).into())
        };
        rows.carry(
            &mut at_start[k].data.0[0],
            &drive(Bend::of_begin),
            &none,
            dt,
        );
        rows.carry(&mut at_end[k].data.0[0], &drive(Bend::of_end), &none, dt);
    }
    for (k, column) in columns.parameters.iter_mut().enumerate() {
        let pose = points.each_ref().map(|p| p.parameters[k].into());
        let push = points.each_ref().map(|p| p.pushes[k].into());
        rows.carry(&mut column.data.0[0], &pose, &push, dt);
    }
}
