//! The motion over one interval between samples, with the columns of the linearised equations.

use crate::configuration::{Configuration, INPUTS, of_joint, of_rate};
use crate::excitation::Excitation;
use crate::numbers::{AXES, CURVE, MOUNTING, NUMBERS, Numbers, WHEELS};
use crate::placed::Placed;
use crate::posture::{AT_REST, Posture, momentum};
use crate::sample::Sample;
use crate::slopes::Slopes;
#[cfg(not(feature = "std"))]
use nalgebra::ComplexField;
use nalgebra::{ArrayStorage, SMatrix};
use poinsot_dynamics::propagation::{
    BaseMotion, COLUMN, Column, Drives, Flexibility, FlexibleMotion, FlexibleRate, FlexibleState,
    Internal, LockedVehicle, ModeRows, PoseMomentumRate, Rates, StateRows, StepPoint, StepRows,
    pose_change, runge_kutta_step, state_in_middle,
};
use poinsot_spatial::{Matrix3, Vector3, Vector6, stacked};

/// Largest turn of one step, and of the phase of a mode, rad.
const TURN: f64 = 0.1;
const SWING: f64 = 0.2;
/// Most steps of an interval.
const STEPS: u32 = 64;

/// Momentum of the wheels about `Bo`, and twist of the base by the joints, both in B.
pub type Acting = SMatrix<f64, 6, 2>;

/// What acts between two samples.
#[derive(Debug, Clone, Copy)]
pub struct Interval {
    /// Inputs that were read at both ends; wheel speeds are straight between them but for the bend, joints have positions and
    /// rates of both ends (a cubic).
    pub read: [[f64; INPUTS]; 2],
    /// What the most likely ones are above those read, so far as they are known.
    pub found: [[f64; INPUTS]; 2],
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
    /// Momentum of the wheels less the impulse, about `Bo` in B, and twist of the base by the joints, above those of the inputs between
    /// both ends; integrals over the interval, N s2 and N m s2, m and rad.
    pub offset: [[f64; 2 * AXES]; 2],
    /// The same of the angular momentum per unit of the number [`CURVE`].
    pub curve: [f64; AXES],
    /// Readings in between.
    pub between: u32,
}

impl Bend {
    /// No reading in between.
    pub const NONE: Self = Self {
        offset: [[0.0; 2 * AXES]; 2],
        curve: [0.0; AXES],
        between: 0,
    };

    /// What an error of the speed at the beginning is at `x` of the interval. It has a share of `1 / 2n` in the mean of `n + 1`
    /// readings (trapezoids).
    fn of_begin(&self, x: f64) -> f64 {
        let mean = 0.5 / (f64::from(self.between) + 1.0);
        1.0 - x - 3.0 * x * (1.0 - x) * (1.0 - 2.0 * mean)
    }

    /// Error of the mean by the readings in between, in that of one.
    pub fn of_mean(&self) -> f64 {
        let between = f64::from(self.between);
        between.sqrt() / (between + 1.0)
    }
}

/// The state at the end of an interval over what it depends on.
#[derive(Debug, Clone, Copy)]
pub struct Columns {
    pub state: [Column; COLUMN],
    /// Over the noise of each input at both ends, one sigma.
    pub inputs: [[Column; INPUTS]; 2],
    /// Over the uncertain numbers.
    pub numbers: [Column; NUMBERS],
}

impl Columns {
    pub const NONE: Self = {
        let none = Column::from_array_storage(ArrayStorage([[0.0; COLUMN]]));
        Self {
            state: [none; COLUMN],
            inputs: [[none; INPUTS]; 2],
            numbers: [none; NUMBERS],
        }
    };

    /// Inverse of what the `D` components of the state become.
    // Its matrices are not on the stack of every sample.
    #[inline(never)]
    pub fn inverse<const D: usize>(&self, components: &[usize]) -> Option<SMatrix<f64, D, D>> {
        SMatrix::<f64, D, D>::from_fn(|i, j| self.state[components[j]][components[i]]).try_inverse()
    }

    /// At the beginning of an interval.
    fn begin(&mut self, configuration: &Configuration, over: Over) {
        if let Over::Numbers = over {
            for k in configuration.uncertain() {
                self.numbers[k] = Column::zeros();
            }
            return;
        }
        for (k, column) in self.state.iter_mut().enumerate() {
            *column = Column::zeros();
            column[k] = 1.0;
        }
        for k in configuration.driven() {
            for of_end in &mut self.inputs {
                of_end[k] = Column::zeros();
            }
        }
    }
}

/// What a motion is linearised with.
pub struct Linear<'a> {
    pub columns: &'a mut Columns,
    pub shown: &'a Excitation,
    pub scratch: &'a mut Scratch,
    pub over: Over<'a>,
}

/// Columns that are asked for.
#[derive(Debug, Clone, Copy)]
pub enum Over<'a> {
    /// Over these components of the state, and the inputs.
    State(&'a [usize]),
    Numbers,
}

/// The vehicle at one value of the numbers.
pub struct Moving<'a> {
    pub configuration: &'a Configuration,
    pub numbers: &'a Numbers,
    /// Angular momentum of each wheel per unit of its speed.
    wheels: [Vector3; WHEELS],
}

/// The vehicle and the equations at one point of a step.
#[derive(Debug, Clone)]
struct Point {
    at: [f64; INPUTS],
    posture: Posture,
    pose: StateRows,
    push: StateRows,
    inputs: [Vector6; INPUTS],
    numbers: [Vector6; NUMBERS],
    pushes: [Vector6; NUMBERS],
}

/// The modes at one point of a step, and what the linearised equations need beside those of the base.
#[derive(Debug, Clone)]
pub struct Flexing {
    pub flexible: Flexibility,
    pub rows: ModeRows,
    inputs: [Internal; INPUTS],
    numbers: [Internal; NUMBERS],
}

impl Default for Flexing {
    fn default() -> Self {
        Self {
            flexible: Flexibility::default(),
            rows: ModeRows::default(),
            inputs: [Internal::zeros(); INPUTS],
            numbers: [Internal::zeros(); NUMBERS],
        }
    }
}

/// What a step is computed in: too large for the stack.
#[derive(Debug, Clone)]
pub struct Scratch {
    /// The vehicle as it was placed last.
    pub posture: Posture,
    /// Of a vehicle with modes.
    pub flexing: [Option<Flexing>; 3],
    points: [Point; 3],
}

impl Point {
    const NONE: Self = {
        let none = Vector6::from_array_storage(ArrayStorage([[0.0; 6]]));
        Self {
            at: [0.0; INPUTS],
            posture: Posture::NONE,
            pose: StateRows::NONE,
            push: StateRows::NONE,
            inputs: [none; INPUTS],
            numbers: [none; NUMBERS],
            pushes: [none; NUMBERS],
        }
    };
}

impl Scratch {
    /// For a vehicle without modes.
    pub const NONE: Self = Self {
        posture: Posture::NONE,
        flexing: [const { None }; 3],
        points: [Point::NONE; 3],
    };
}

/// The locked vehicle at the three points of a step.
struct OverStep<'a> {
    locked: &'a [LockedVehicle; 3],
    flexing: &'a [Option<Flexing>; 3],
    interval: &'a Interval,
}

impl Rates<FlexibleState> for OverStep<'_> {
    fn rate(&mut self, at: StepPoint, state: &FlexibleState) -> Option<FlexibleRate> {
        let at = match at {
            StepPoint::Begin => 0,
            StepPoint::Middle => 1,
            StepPoint::End => 2,
        };
        let flexible = self.flexing[at].as_ref().map(|f| &f.flexible);
        let motion = motion_of(&self.locked[at], flexible, state)?;
        let torque = self.interval.central_torque(&motion);
        let force = &self.interval.force_B;
        let of_modes = flexible.map(|f| f.rate(&motion, &state.internal, force));
        Some(FlexibleRate {
            rigid: PoseMomentumRate::new(state, &motion.twist, (force, &torque)),
            internal: of_modes.unwrap_or_default(),
        })
    }
}

/// Motion of a vehicle, with modes where it has some.
pub fn motion_of(
    locked: &LockedVehicle,
    flexible: Option<&Flexibility>,
    state: &FlexibleState,
) -> Option<FlexibleMotion> {
    match flexible {
        Some(flexible) => flexible.motion(locked, state),
        None => Some(locked.base_motion(state).into()),
    }
}

impl Interval {
    /// Whether anything acts from outside: otherwise the momenta stay.
    fn pushes(&self) -> bool {
        self.force_B != Vector3::zeros() || self.torque_B != Vector3::zeros()
    }

    fn central_torque(&self, motion: &BaseMotion) -> Vector3 {
        self.torque_B - motion.centre.p_BoScm_B.cross(&self.force_B)
    }

    /// What acts above the inputs: a parabola.
    fn beyond(&self, share: f64, numbers: &Numbers) -> Acting {
        let h = self.curved(share) * numbers[CURVE];
        let mut out = Acting::from(self.bend.offset) * self.parabola(share);
        out.set_column(0, &(out.column(0) + stacked(&Vector3::zeros(), &h)));
        out
    }

    /// What the number [`CURVE`] adds to the angular momentum of the wheels.
    fn curved(&self, share: f64) -> Vector3 {
        Vector3::from(self.bend.curve) * self.parabola(share)
    }

    /// Of the integral 1.
    fn parabola(&self, share: f64) -> f64 {
        6.0 * share * (1.0 - share) / self.dt
    }

    /// What the reading of an input at an end gives to inputs at a share of the interval: to itself, and for a joint to the other one of
    /// it.
    fn curve(&self, k: usize, end: usize, share: f64) -> [(usize, f64); 2] {
        // From the other end time runs backwards, and so do rates.
        let (x, dt) = match end {
            0 => (share, self.dt),
            _ => (1.0 - share, -self.dt),
        };
        let left = 1.0 - x;
        if k < WHEELS {
            [(k, left), (k, 0.0)]
        } else if k < of_rate(0) {
            let rate = k - of_joint(0) + of_rate(0);
            let own = (1.0 + 2.0 * x) * left * left;
            [(k, own), (rate, -6.0 * x * left / dt)]
        } else {
            let position = k - of_rate(0) + of_joint(0);
            let own = left * (1.0 - 3.0 * x);
            [(k, own), (position, dt * x * left * left)]
        }
    }

    /// What an error of that reading gives. Of a wheel readings in between say how far it went, of a joint the positions at both ends.
    fn error(&self, k: usize, end: usize, share: f64) -> [(usize, f64); 2] {
        let x = if end == 0 { share } else { 1.0 - share };
        match k < WHEELS {
            true => [(k, self.bend.of_begin(x)), (k, 0.0)],
            false => self.curve(k, end, share),
        }
    }

    /// The inputs at a share of the interval.
    pub fn inputs_at(&self, share: f64) -> [f64; INPUTS] {
        let mut out = [0.0; INPUTS];
        let mut add = |x: f64, weights: [(usize, f64); 2]| {
            weights.iter().for_each(|(k, weight)| out[*k] += weight * x);
        };
        for (end, (read, found)) in self.read.iter().zip(&self.found).enumerate() {
            for k in 0..INPUTS {
                if read[k] != 0.0 {
                    add(read[k], self.curve(k, end, share));
                }
                if found[k] != 0.0 {
                    add(found[k], self.error(k, end, share));
                }
            }
        }
        out
    }
}

impl<'a> Moving<'a> {
    pub fn new(configuration: &'a Configuration, numbers: &'a Numbers) -> Self {
        Self {
            configuration,
            numbers,
            wheels: configuration.wheel_momenta(numbers),
        }
    }

    /// Angular momentum of the wheels relative to the base at these speeds, in B, N m s.
    pub fn wheel_momentum(&self, speeds: &[f64]) -> Vector3 {
        let each = self.wheels.iter().zip(speeds);
        each.map(|(wheel, speed)| wheel * *speed).sum()
    }

    /// What acts with these inputs.
    ///
    /// Of the joints it is the twist, not the momentum: errors of positions take it along a path that they close again, and what is left of
    /// that in the integral is small where each is divided by the inertia at its own place.
    pub fn acting(&self, inputs: &[f64; INPUTS]) -> Option<Acting> {
        let h = self.wheel_momentum(inputs);
        let mut twist = Vector6::zeros();
        if self.configuration.joint_count > 0 {
            let posture = self.posture(inputs);
            let by_joints = posture
                .locked(&Vector6::zeros())?
                .base_motion(&AT_REST)
                .twist;
            twist = stacked(&by_joints.v, &by_joints.w);
        }
        let momentum = stacked(&Vector3::zeros(), &h);
        Some(Acting::from_columns(&[momentum, twist]))
    }

    /// The same half-way between two samples.
    pub fn between(&self, from: &Sample, to: &Sample) -> Option<Acting> {
        let interval = Interval {
            read: [from.inputs(), to.inputs()],
            found: [[0.0; INPUTS]; 2],
            bend: Bend::NONE,
            force_B: Vector3::zeros(),
            torque_B: Vector3::zeros(),
            dt: to.time_s - from.time_s,
        };
        self.acting(&interval.inputs_at(0.5))
    }

    /// Positions and rates of its joints.
    pub fn posture(&self, inputs: &[f64; INPUTS]) -> Posture {
        Posture::new(self.configuration, self.numbers, inputs)
    }

    /// The vehicle in a posture, with what acts beside its inputs and its modes.
    pub fn place(
        &self,
        posture: &Posture,
        more: &Acting,
        flexing: &mut Option<Flexing>,
    ) -> Option<LockedVehicle> {
        let h = self.wheel_momentum(&posture.speeds);
        let h = stacked(&Vector3::zeros(), &h) + more.column(0);
        let of_twist = momentum(&posture.whole, &more.column(1).into_owned());
        let locked = posture.locked(&(h - of_twist))?;
        if let Some(flexing) = flexing {
            let modes = self.configuration.modes();
            flexing.flexible.place_on_base(modes, &locked)?;
        }
        Some(locked)
    }

    /// Follows a state over an interval, with its columns.
    pub fn follow(
        &self,
        state: &FlexibleState,
        interval: &Interval,
        mut linear: Linear,
    ) -> Option<FlexibleState> {
        linear.columns.begin(self.configuration, linear.over);
        let inputs = interval.inputs_at(0.0);
        let scratch = &mut *linear.scratch;
        let (posture, first) = (&mut scratch.posture, &mut scratch.flexing[0]);
        posture.set(self.configuration, self.numbers, &inputs);
        let start = self.place(posture, &Acting::zeros(), first)?;
        let flexible = first.as_ref().map(|f| &f.flexible);
        let joints = inputs[of_rate(0)..].iter().map(|rate| rate.abs());
        let swings = flexible.map_or(0.0, |f| f.fastest(&start, true));
        let turn = motion_of(&start, flexible, state)?.twist.w.norm();
        let fastest = (turn + joints.sum::<f64>()) / TURN + swings / SWING;
        let turns = (fastest * interval.dt.abs()).ceil();
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
        state: &FlexibleState,
        interval: &Interval,
        (shares, dt): ([f64; 3], f64),
        linear: &mut Linear,
    ) -> Option<FlexibleState> {
        let scratch = &mut *linear.scratch;
        let (flexing, points) = (&mut scratch.flexing, &mut scratch.points);
        let mut place = |at: usize| {
            let point = &mut points[at];
            point.at = interval.inputs_at(shares[at]);
            (point.posture).set(self.configuration, self.numbers, &point.at);
            let beyond = interval.beyond(shares[at], self.numbers);
            self.place(&point.posture, &beyond, &mut flexing[at])
        };
        let locked = &[place(0)?, place(1)?, place(2)?];
        let mut over = OverStep {
            locked,
            flexing,
            interval,
        };
        let rate = over.rate(StepPoint::Begin, state)?;
        let end = runge_kutta_step(state, &rate, dt, &mut over)?;
        let last = over.rate(StepPoint::End, &end)?;
        let middle = state_in_middle((state, &rate), (&end, &last), dt);
        for (at, state) in [state, &middle, &end].into_iter().enumerate() {
            let scratch = &mut *linear.scratch;
            let place = (&mut scratch.flexing[at], &mut scratch.points[at]);
            let about = (state, &locked[at]);
            let seen = (linear.shown, linear.over);
            self.point(about, (interval, shares[at]), seen, place)?;
        }
        self.carry((shares, interval), dt, linear);
        Some(end)
    }

    /// The uncertain numbers that the motion depends on.
    fn moving_numbers(&self) -> impl Iterator<Item = usize> {
        let of_sensors = MOUNTING..CURVE;
        self.configuration
            .uncertain()
            .filter(move |k| !of_sensors.contains(k))
    }

    /// Fills the equations at one point.
    fn point(
        &self,
        (state, locked): (&FlexibleState, &LockedVehicle),
        (interval, share): (&Interval, f64),
        (shown, over): (&Excitation, Over),
        (flexing, out): (&mut Option<Flexing>, &mut Point),
    ) -> Option<()> {
        let mut locked = *locked;
        let calm = shown.calm(&out.at);
        if calm != out.at {
            (out.posture).set(self.configuration, self.numbers, &calm);
            let beyond = interval.beyond(share, self.numbers);
            locked = self.place(&out.posture, &beyond, flexing)?;
        }
        let (mut flexible, mut modes) = (None, None);
        if let Some(f) = flexing {
            flexible = Some(&f.flexible);
            modes = Some((&mut f.rows, &mut f.inputs, &mut f.numbers));
        }
        let motion = &motion_of(&locked, flexible, state)?;
        let placed = Placed {
            posture: &out.posture,
            motion,
            modes: flexible.map(|f| (f, &state.internal)),
        };
        let R: Matrix3 = state.R_NB.to_rotation_matrix().into_inner();
        let force = &interval.force_B;
        if let Over::State(_) = over {
            for k in self.configuration.driven() {
                let change = placed.input_slope(self.configuration, k);
                out.inputs[k] = pose_change(&R, &change.twist);
                if let Some((_, inputs, _)) = &mut modes {
                    inputs[k] = placed.mode_rates(&change, &Vector3::zeros());
                }
            }
        } else {
            let slopes = Slopes::new(self.configuration, placed, shown);
            for k in self.moving_numbers() {
                let slope = match k {
                    CURVE => slopes.of_momentum(&interval.curved(share)),
                    _ => slopes.of(k),
                };
                let h = R * force.cross(&slope.centre);
                out.numbers[k] = pose_change(&R, &slope.change.twist);
                out.pushes[k] = Vector6::new(0.0, 0.0, 0.0, h.x, h.y, h.z);
                if let Some((_, _, numbers)) = &mut modes {
                    let lighter = force * (-slope.mass / motion.centre.mass);
                    numbers[k] = placed.mode_rates(&slope.change, &lighter);
                }
            }
        }
        let mut map = motion.twist_rows(state);
        if let Some((flexible, (rows, _, _))) = flexible.zip(modes) {
            flexible.rows(motion, state, (&mut map, rows), force);
        }
        out.pose = motion.pose_rows(state, &map);
        out.push = StateRows::of_wrench(state, force, &interval.central_torque(motion));
        Some(())
    }

    /// Carries all columns over a step.
    fn carry(&self, (shares, interval): ([f64; 3], &Interval), dt: f64, linear: &mut Linear) {
        let points = linear.scratch.points.each_ref();
        let flexing = linear.scratch.flexing.each_ref().map(Option::as_ref);
        let rows = StepRows {
            pose: points.map(|p| &p.pose),
            momentum: points.map(|p| interval.pushes().then_some(&p.push)),
            modes: flexing.map(|f| f.map(|f| &f.rows)),
        };
        let columns = &mut *linear.columns;
        let Over::State(components) = linear.over else {
            for k in self.moving_numbers() {
                let of_modes = flexing.map(|f| f.map_or_else(Internal::zeros, |f| f.numbers[k]));
                let drives = Drives {
                    pose: points.map(|p| p.numbers[k].into()),
                    push: points.map(|p| p.pushes[k].into()),
                    internal: of_modes.map(Into::into),
                };
                rows.carry_column(&mut columns.numbers[k], &drives, dt);
            }
            return;
        };
        for k in components {
            rows.carry_column(&mut columns.state[*k], &Drives::default(), dt);
        }
        for (end, of_end) in columns.inputs.iter_mut().enumerate() {
            for (k, column) in of_end.iter_mut().enumerate() {
                let noise = self.configuration.input_noise(k);
                if noise > 0.0 {
                    let mut drives = Drives::default();
                    for at in 0..3 {
                        let [(a, of_a), (b, of_b)] = interval.error(k, end, shares[at]);
                        let inputs = &points[at].inputs;
                        let pose = (inputs[a] * of_a + inputs[b] * of_b) * noise;
                        drives.pose[at] = pose.into();
                        if let Some(own) = flexing[at].map(|f| &f.inputs) {
                            drives.internal[at] = ((own[a] * of_a + own[b] * of_b) * noise).into();
                        }
                    }
                    rows.carry_column(column, &drives, dt);
                }
            }
        }
    }
}
