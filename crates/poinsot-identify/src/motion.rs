//! The pose-momentum equation with its forward sensitivities, on measured joint and wheel motion.
//!
//! State, step and linearisation are those of `poinsot_dynamics::propagation`. Here stand the inputs, forces and unknowns of a
//! segment. About the mass centre the position does not enter, so its integration error cannot turn into a false rate
//! (`dp x P`), and unobservable directions stay exactly unobservable.

mod acceleration;
mod advance;
mod chord;
mod environment;
mod grid;
pub(crate) mod input_curves;
pub(crate) mod input_noise;
mod input_slopes;
mod inputs;
mod joint_scales;
mod mass_loss;
mod point_kinematics;
mod steps;
mod variation;
mod vehicle;
mod virtual_joints;

use acceleration::ForceScratch;
pub(crate) use acceleration::{BodyPoint, Input};
pub(crate) use inputs::joint_between;
pub(crate) use joint_scales::{cubic_between, joint_scales};
pub(crate) use mass_loss::impulse_before;
pub(crate) use poinsot_dynamics::propagation::{
    Column, FlexibleMotion as Instant, FlexibleState as State, Matrix6x12, pose_change,
};
pub(crate) use point_kinematics::PointKinematics;
pub(crate) use steps::{Fineness, Grid};
pub(crate) use vehicle::{Running, Vehicle, parabola_slope, slope_weights, tilted};

use crate::problem::parameters::UnknownKind;
use crate::problem::segment::{Firing, Observations, Segment};
use chord::{Chord, ColumnChord};
use grid::{TURN, gyration, joint_frequency};
use inputs::InputChange;
use poinsot_dynamics::propagation::{Flexibility, Hinge, LockedVehicle, MassCentre};
use poinsot_dynamics::{
    JointEffect, JointSlopes, Kinematics, Tree, composite, composite_and_momentum, wheel_momentum,
};
use poinsot_spatial::{
    InertialParameters, Matrix3, UnitQuaternion, Vector3, Vector6, parallel_axis,
};
use std::borrow::Cow;
use std::cell::RefCell;
use std::sync::Arc;
use variation::Variation;
use vehicle::{Thrust, ThrustPlan};

/// Corrected inputs at one instant, and all quantities that depend on them alone.
#[derive(Default)]
struct InputState {
    q: Vec<f64>,
    rates: Vec<f64>,
    wheels: Vec<f64>,
    /// Effect of sensor errors on the inputs.
    changes: Vec<InputChange>,
    /// Slopes of the momentum over the joints, if sensor errors need them.
    joint_slopes: JointSlopes,
    /// Position of the reference orbit, in N, m; where a gravity gradient acts.
    orbit_N: Vector3,
    /// Time, s.
    time_s: f64,
    kinematics: Kinematics,
    /// The bodies with the propellant that is left.
    bodies: Vec<InertialParameters>,
    /// Impulse of each thruster so far, N s, and velocities of the bodies with the base still; empty where no mass is lost.
    impulse: Vec<f64>,
    velocities: Vec<(Vector3, Vector3)>,
    /// Axis of each wheel in B, and its speed if the base did not turn, where wheels run along a chord; empty elsewhere.
    free: Vec<(Vector3, f64)>,
    /// `None` where the parameters have no positive mass or inertia.
    locked: Option<LockedVehicle>,
    /// Its modes and passive joints, where it has any. Boxed: it is large, and inputs are exchanged at every step.
    flexible: Option<Box<Flexibility>>,
    /// The vehicle while base and passive joints are at rest, and its joints with virtual ones as they are among the passive ones.
    still: JointSlopes,
    hinges: Vec<Hinge>,
    /// The grid time before, and the share of the interval behind it.
    interval: usize,
    share: f64,
}

/// An evaluated state, from which another propagation of the same segment can resume; its inputs are those in
/// [`Motion::input_state`].
#[derive(Clone)]
pub(crate) struct EvaluatedState {
    /// Grid time, and share of the interval after it.
    at: (usize, f64),
    pub state: State,
    instant: Instant,
    /// Where sensitivities are wanted.
    variation: Option<Arc<Variation>>,
}

/// Evaluations that are no longer needed: nothing is allocated from step to step.
#[derive(Default)]
struct Spare {
    #[expect(clippy::vec_box, reason = "the boxes are what is kept")]
    boxes: Vec<Box<EvaluatedState>>,
    variations: Vec<Arc<Variation>>,
    drives: Vec<Vec<Vector6>>,
    forces: Vec<Force>,
    chord: Chord,
    column_chord: ColumnChord,
    effects: Vec<Vec<(usize, JointEffect)>>,
}

impl Spare {
    fn retire(&mut self, mut evaluated: Box<EvaluatedState>) {
        if let Some(mut variation) = evaluated.variation.take()
            && Arc::get_mut(&mut variation).is_some()
        {
            self.variations.push(variation);
        }
        self.boxes.push(evaluated);
    }

    fn boxed(&mut self, evaluated: EvaluatedState) -> Box<EvaluatedState> {
        match self.boxes.pop() {
            Some(mut place) => {
                *place = evaluated;
                place
            }
            None => Box::new(evaluated),
        }
    }

    /// An empty list.
    fn drive(&mut self) -> Vec<Vector6> {
        let mut drive = self.drives.pop().unwrap_or_default();
        drive.clear();
        drive
    }

    /// One without another owner.
    fn variation(&mut self) -> Arc<Variation> {
        self.variations.pop().unwrap_or_default()
    }
}

/// Workspace of one propagation.
pub(crate) struct Motion<'a> {
    vehicle: &'a Vehicle<'a>,
    /// Integration steps that may still be made.
    steps_left: f64,
    /// Integration steps in the interval after each grid time.
    grid: Cow<'a, [u32]>,
    /// Wheel motion in the current interval, if not linear.
    chord: Option<Chord>,
    column_chord: Option<ColumnChord>,
    /// Radius of gyration of the vehicle, m.
    pub gyration: f64,
    observations: &'a Observations,
    firings: &'a [Firing],
    /// Thrust in the interval after each grid time.
    thrust: ThrustPlan,
    /// Displacement of each joint coordinate at grid time k over its play: row k; empty where no play is an unknown.
    play: Vec<f64>,
    /// Impulse of each thruster up to grid time k: row k; empty where no mass is lost.
    impulses: Vec<f64>,
    /// The current inputs, and those in the middle of a step.
    input_state: InputState,
    middle: InputState,
    /// By body: how the momentum moves with its parameters, of bodies that unknowns move.
    regressor: Vec<[[f64; 6]; 10]>,
    wheel_columns: Vec<[f64; 6]>,
    /// Sensitivity columns: initial state first, then unknowns; empty where only the motion is wanted.
    pub columns: Vec<Column>,
    twist_columns: Vec<Vector6>,
    /// Index in `columns` of the first unknown.
    initial_columns: usize,
    /// Boxed: it is large and moves at every step.
    evaluated: Option<Box<EvaluatedState>>,
    /// What was evaluated before and may be overwritten.
    spare: Spare,
    /// Scratch of the specific force: only where an accelerometer is read.
    force_scratch: RefCell<Option<Box<ForceScratch>>>,
}

/// Largest total rotation of a propagated base, relative to the measured one.
const FASTER: f64 = 3.0;

/// Integration steps for a run: some for each interval, those of its joints, and those of a base faster than the measured one.
fn steps_allowed(tree: &Tree, o: &Observations, gyration: f64) -> f64 {
    let t = &o.time_s;
    let joints = o.joint_rate.chunks_exact(tree.dof().max(1));
    let joints = joints.map(|rates| joint_frequency(tree, rates, gyration));
    let of_joints = joints.zip(t.windows(2)).map(|(w, t)| w * (t[1] - t[0]));
    let of_joints = of_joints.sum::<f64>() / TURN;
    let seen = o.rates().count();
    if seen == 0 {
        return 1.0e4 * o.time_s.len() as f64 + of_joints;
    }
    // Between the samples of a slow gyro the turn is that of the gap.
    let seen = seen as f64;
    let share = o.time_s.len() as f64 / seen;
    1000.0 + 6.0 * o.time_s.len() as f64 + of_joints + FASTER * share * o.turned() / TURN
}

impl InputState {
    fn new(vehicle: &Vehicle) -> Self {
        let tree = vehicle.tree;
        Self {
            bodies: vehicle.bodies.clone(),
            q: vec![0.0; tree.dof()],
            rates: vec![0.0; tree.dof()],
            wheels: vec![0.0; tree.rotors.len()],
            kinematics: Kinematics::new(tree),
            ..Self::default()
        }
    }

    /// Velocities of the bodies at those of the base, in B.
    fn set_velocities(&mut self, tree: &Tree, v: &Vector3, w: &Vector3) {
        self.kinematics.set_velocities(tree, v, w, &self.rates);
    }
}

impl<'a> Motion<'a> {
    /// Scratch; `columns` are the sensitivities at the first grid time, `initial_columns` of them before the unknowns.
    pub fn new(
        vehicle: &'a Vehicle<'a>,
        segment: &'a Segment,
        columns: Vec<Column>,
        initial_columns: usize,
    ) -> Self {
        let tree = vehicle.tree;
        let o = &segment.observations;
        let thrust = ThrustPlan::new(segment);
        let gyration = gyration(&composite(&vehicle.bodies, &Kinematics::new(tree)));
        let grid = match vehicle.grid {
            Some(grid) => Cow::Borrowed(grid.steps.as_slice()),
            None => Cow::Owned(Grid::new(vehicle, o).steps),
        };
        Self {
            grid,
            chord: None,
            column_chord: None,
            gyration,
            input_state: InputState::new(vehicle),
            middle: InputState::new(vehicle),
            regressor: vec![[[0.0; 6]; 10]; tree.bodies()],
            wheel_columns: vec![[0.0; 6]; tree.rotors.len()],
            firings: &segment.firings,
            impulses: mass_loss::impulses(vehicle, &thrust, o),
            thrust,
            play: inputs::play(vehicle, o),
            steps_left: steps_allowed(tree, o, gyration),
            observations: o,
            initial_columns,
            twist_columns: vec![Vector6::zeros(); columns.len()],
            columns,
            vehicle,
            evaluated: None,
            spare: Spare::default(),
            force_scratch: RefCell::new(None),
        }
    }

    /// Velocity at grid time k and, for each sensitivity column, its change `[dv; dw]`.
    ///
    /// `None` where the parameters have no positive mass or inertia there.
    pub fn velocity(&mut self, state: &State, k: usize) -> Option<(Instant, &[Vector6])> {
        self.evaluate_at_grid_time(state, k)?;
        let evaluated = self.evaluated.as_ref()?;
        if let Some(variation) = &evaluated.variation {
            variation.twists(&self.columns, self.initial_columns, &mut self.twist_columns);
        }
        Some((evaluated.instant, &self.twist_columns))
    }

    /// State at grid time k.
    pub fn evaluated_state(&mut self, state: &State, k: usize) -> Option<EvaluatedState> {
        self.evaluate_at_grid_time(state, k)?;
        self.evaluated.as_deref().cloned()
    }

    /// Resumes at grid time k from another propagation and these sensitivities.
    pub fn resume_from(&mut self, known: &EvaluatedState, columns: &[Column], k: usize) {
        self.columns.copy_from_slice(columns);
        self.return_to(k, &known.state, &known.instant);
        self.keep(known.clone());
    }

    /// Joint positions, joint rates, wheel speeds and bodies that the last evaluation of the velocity used.
    pub fn used(&self) -> (&[f64], &[f64], &[f64], &[InertialParameters]) {
        let now = &self.input_state;
        (&now.q, &now.rates, &now.wheels, &now.bodies)
    }

    /// Evaluates the state at grid time k; reuses the end of the previous interval if no sensor error moves the inputs.
    fn evaluate_at_grid_time(&mut self, state: &State, k: usize) -> Option<()> {
        let moved = self.vehicle.input_faults.iter().any(|f| f.value != 0.0);
        // Thrust drives modes at once.
        let other_force = |before: usize| {
            self.vehicle.is_flexible()
                && (self.thrust.at(before) != self.thrust.at(k)
                    || !self.vehicle.input_faults.is_empty())
        };
        let end = |at: (usize, f64)| !moved && at.1 == 1.0 && at.0 + 1 == k && !other_force(at.0);
        match self.evaluated.take() {
            Some(evaluated) if evaluated.state != *state => self.spare.retire(evaluated),
            Some(evaluated) if evaluated.at == (k, 0.0) => {
                self.evaluated = Some(evaluated);
                return Some(());
            }
            Some(mut evaluated) if end(evaluated.at) => {
                self.cross_grid_time(&mut evaluated, k);
                self.evaluated = Some(evaluated);
                return Some(());
            }
            Some(evaluated) => self.spare.retire(evaluated),
            None => {}
        }
        self.set_inputs(k, 0.0);
        self.evaluate_here((k, 0.0), state)
    }

    /// Evaluates a state at the current inputs.
    fn evaluate_here(&mut self, at: (usize, f64), state: &State) -> Option<()> {
        let instant = self.instant(state)?;
        let variation = match self.columns.is_empty() {
            true => None,
            false => {
                let mut variation = self.spare.variation();
                // A spare one has no other owner: nothing is copied.
                self.linearise(state, &instant, Arc::make_mut(&mut variation));
                Some(variation)
            }
        };
        self.keep(EvaluatedState {
            at,
            state: *state,
            instant,
            variation,
        });
        Some(())
    }

    /// Takes what was evaluated last.
    fn keep(&mut self, evaluated: EvaluatedState) {
        let old = self.evaluated.take();
        let kept = self.spare.boxed(evaluated);
        self.evaluated = Some(kept);
        if let Some(old) = old {
            self.spare.retire(old);
        }
    }

    /// Sets the inputs at a share of the interval after grid time k.
    fn set_inputs(&mut self, k: usize, at: f64) {
        if let Some(old) = self.evaluated.take() {
            self.spare.retire(old);
        }
        self.inputs(k, at);
        self.input_state.share = at;
        // Passive joints are placed with a state.
        if !self.vehicle.has_passive_joints() {
            self.place_bodies();
        }
    }

    /// Places the passive joints of a state, with all that depends on them.
    fn place_state(&mut self, state: &State) {
        let (k, at) = (self.input_state.interval, self.input_state.share);
        if !self.input_state.free.is_empty() {
            // Their speeds were those of another placement.
            self.inputs(k, at);
        }
        let first = self.vehicle.modes.len();
        for (i, joint) in self.vehicle.passive.joints().iter().enumerate() {
            self.input_state.q[joint.coordinate] = state.internal[2 * (first + i)];
            self.input_state.rates[joint.coordinate] = 0.0;
        }
        self.place_bodies();
    }

    /// Places the vehicle at its inputs, passive joints at rest.
    fn place_bodies(&mut self) {
        let (k, at) = (self.input_state.interval, self.input_state.share);
        let (v, input_state) = (self.vehicle, &mut self.input_state);
        let zero = Vector3::zeros();
        input_state.kinematics.place(v.tree, &input_state.q);
        input_state.set_velocities(v.tree, &zero, &zero);
        self.use_propellant(k, at);
        let input_state = &mut self.input_state;
        let (whole, joints) = composite_and_momentum(&input_state.bodies, &input_state.kinematics);
        let mut turning = whole;
        input_state.free.clear();
        if let Some(chord) = self.chord.as_ref().filter(|_| at > 0.0 && at < 1.0) {
            for (j, (rotor, spin)) in v.tree.rotors.iter().zip(&v.spin).enumerate() {
                let axis = input_state.kinematics.R[rotor.body] * rotor.axis_B;
                // The base is still: its host turns with the joints alone.
                input_state.wheels[j] +=
                    chord.at(j, at) - axis.dot(&input_state.kinematics.w[rotor.body]);
                input_state.free.push((axis, input_state.wheels[j]));
                turning.I_BBo_B -= Matrix3::identity() * *spin - parallel_axis(*spin, &axis);
            }
        }
        let wheels = wheel_momentum(
            v.tree,
            &input_state.kinematics,
            &v.spin,
            &input_state.wheels,
        );
        let joints = joints + Vector6::new(0.0, 0.0, 0.0, wheels.x, wheels.y, wheels.z);
        input_state.locked = LockedVehicle::new(&whole, &turning, &joints);
        if v.is_flexible() {
            self.place_flexible();
        }
    }

    /// Places modes and passive joints on the vehicle.
    fn place_flexible(&mut self) {
        let (v, now) = (self.vehicle, &mut self.input_state);
        let kinematics = &now.kinematics;
        now.hinges.clear();
        if !v.joint_motions.is_empty() {
            let (still, bodies) = (&mut now.still, &now.bodies);
            still.fill(v.tree, bodies, kinematics, &v.spin, &now.wheels);
            let place = |motion| v.passive.hinge(motion, &now.still, kinematics);
            now.hinges.extend(v.joint_motions.iter().map(place));
        }
        let still = (&v.passive, &now.still);
        let flexible = now.flexible.get_or_insert_default();
        let placed = now.locked.as_ref().filter(|_| v.is_stable());
        let placed = placed.and_then(|l| flexible.place(&v.modes, still, kinematics, l));
        if placed.is_none() {
            now.locked = None;
        }
    }

    /// Velocity of a state at the current inputs.
    fn instant(&mut self, state: &State) -> Option<Instant> {
        if self.vehicle.has_passive_joints() {
            self.place_state(state);
        }
        let locked = self.input_state.locked.as_ref()?;
        let Some(flexible) = &self.input_state.flexible else {
            return Some(locked.base_motion(&state.rigid).into());
        };
        let instant = flexible.motion(locked, state)?;
        self.swing(&instant);
        Some(instant)
    }

    /// Sets the inputs at grid time k as when a state was evaluated there.
    fn return_to(&mut self, k: usize, state: &State, instant: &Instant) {
        self.set_inputs(k, 0.0);
        if self.vehicle.has_passive_joints() {
            self.place_state(state);
            self.swing(instant);
        }
    }

    /// Sets the rates of passive joints.
    fn swing(&mut self, instant: &Instant) {
        let first = self.vehicle.modes.len();
        for (i, joint) in self.vehicle.passive.joints().iter().enumerate() {
            self.input_state.rates[joint.coordinate] = instant.rates[first + i];
        }
    }

    /// Sum of the thrust in the interval in hand, N, in B.
    fn force_now(&self, instant: &Instant) -> Vector3 {
        let forces = self.thrust_now(instant, self.input_state.interval);
        forces.map(|f| f.F_B).sum()
    }

    /// A thruster at a placement, with its arm from a point.
    fn force(&self, now: &Thrust, kinematics: &Kinematics, from_B: &Vector3) -> Force {
        let (at, declared) = (now.thruster, now.force);
        let thruster = &self.vehicle.thrusters[at];
        let R_BT = &kinematics.R[thruster.body];
        let p_BoT_B = kinematics.p[thruster.body] + R_BT * thruster.p_BoT_B;
        let thrust = declared * self.vehicle.thrust_factor[at];
        Force {
            thruster: at,
            firing: (self.vehicle.segment, now.firing),
            R_BT: *R_BT,
            thrust,
            declared,
            direction_T: thruster.direction_B,
            F_B: R_BT * thruster.direction_B * thrust,
            arm_B: p_BoT_B - from_B,
        }
    }

    /// Thrusters at the inputs in hand with their arms from the system's mass centre.
    fn forces(&self, thrust: &[Thrust], instant: &Instant) -> impl Iterator<Item = Force> {
        let (placed, centre) = (&self.input_state.kinematics, instant.centre.p_BoScm_B);
        thrust
            .iter()
            .map(move |now| self.force(now, placed, &centre))
    }

    /// Those that fire in the interval after grid time k.
    fn thrust_now(&self, instant: &Instant, k: usize) -> impl Iterator<Item = Force> {
        self.forces(self.thrust.at(k), instant)
    }

    /// Change of the base twist per unit of a wheel's speed at the instant given: `-H^-1 [0; Js a]`.
    pub fn wheel_gain(&self, instant: &Instant, wheel: usize) -> Vector6 {
        let rotor = &self.vehicle.tree.rotors[wheel];
        let h = self.input_state.kinematics.R[rotor.body] * rotor.axis_B * self.vehicle.spin[wheel];
        let momentum = Vector6::new(0.0, 0.0, 0.0, h.x, h.y, h.z);
        instant.twist_slope(&momentum, &Vector3::zeros())
    }
}

/// One thruster at one instant, in B.
struct Force {
    thruster: usize,
    /// Segment, and firing in it.
    firing: (usize, usize),
    /// Axes of the body that holds it.
    R_BT: Matrix3,
    thrust: f64,
    /// Thrust before its factor.
    declared: f64,
    direction_T: Vector3,
    F_B: Vector3,
    /// From the point that was asked for.
    arm_B: Vector3,
}

impl Force {
    /// Change of the force and of its torque about the mass centre with an unknown of the thruster.
    fn change(&self, kind: &UnknownKind) -> (Vector3, Vector3) {
        let none = Vector3::zeros();
        let (dF, dp) = match kind {
            kind if kind.thruster() != Some(self.thruster) => (none, none),
            UnknownKind::ThrusterScale(_) => (self.R_BT * self.direction_T * self.declared, none),
            UnknownKind::Firing {
                segment, firing, ..
            } if self.firing == (*segment, *firing) => (self.F_B, none),
            UnknownKind::ThrusterPlace {
                direction_B,
                p_BoT_B,
                ..
            } => (self.R_BT * direction_B * self.thrust, self.R_BT * p_BoT_B),
            _ => (none, none),
        };
        (dF, self.arm_B.cross(&dF) + dp.cross(&self.F_B))
    }
}

/// `[a]x` of a small rotation between two attitudes, body axes of the first.
pub(crate) fn small_rotation(from: &UnitQuaternion, to: &UnitQuaternion) -> Vector3 {
    (from.inverse() * to).scaled_axis()
}

/// Matrix of a unit quaternion.
pub(crate) fn matrix(R: &UnitQuaternion) -> Matrix3 {
    *R.to_rotation_matrix().matrix()
}
