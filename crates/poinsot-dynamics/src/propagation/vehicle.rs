//! Whole steps of one vehicle.

use super::locked::{BaseMotion, LockedVehicle};
use super::rows::{StateRows, pose_rate};
use super::state::{
    PoseMomentum, PoseMomentumRate, Rates, StepPoint, runge_kutta_step, state_in_middle,
};
use super::{HALF, STATE, StepRows};
use crate::algebra::{M3, Real, V3};
use crate::inertial::Inertial;
use crate::inverse_dynamics::Wrench;
use crate::joint_slopes::JointSlopes;
use crate::kinematics::Kinematics;
use crate::momentum::{of_bodies, whole};
use crate::quaternion;
use crate::regressor::body_columns;
use crate::tree::Tree;
use alloc::vec;
use alloc::vec::Vec;
use nalgebra::Vector3;
use poinsot_spatial::InertialParameters;

/// Inertial parameters of a body.
const PARAMETERS: usize = 10;
/// Evaluations of a step: at its start, in its middle and at its end.
const POINTS: usize = 3;
/// A unit of each of these directions of force and torque.
const AXES: usize = 3;

/// What drives a vehicle at one time.
#[derive(Debug, Clone, Copy)]
pub struct Inputs<'a, T = f64> {
    /// Joint positions, rad or m.
    pub q: &'a [T],
    /// Joint rates, rad/s or m/s.
    pub rates: &'a [T],
    /// Wheel speeds relative to their hosts, rad/s.
    pub wheel_speed: &'a [T],
}

impl<T> Inputs<'_, T> {
    fn check(&self, tree: &Tree) -> Result<(), StepError> {
        expect("q", self.q.len(), tree.dof())?;
        expect("rates", self.rates.len(), tree.dof())?;
        expect("wheel_speed", self.wheel_speed.len(), tree.rotors.len())
    }
}

/// Why a step has no result.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum StepError {
    /// A list has another length than the vehicle has coordinates, wheels or bodies.
    #[error("{0}: {1} numbers, expected {2}; give one per joint coordinate, wheel or body")]
    Length(&'static str, usize, usize),
    /// No positive mass or inertia.
    #[error("the vehicle has no positive mass or inertia; check its bodies")]
    Singular,
}

/// A step with its linearisation. Matrices are lists of columns; a column is a change `[dphi_B, dp_N, dP_N, dh_N]` of the state at
/// the end. Inputs have one column for a change at the start, one in the middle and one at the end of the step: their sum is
/// that of a change that is constant over the step.
#[derive(Debug, Clone)]
pub struct Linearisation<T = f64> {
    /// State at the end.
    pub f: PoseMomentum<T>,
    /// Over the state at the start.
    pub A: [[T; STATE]; STATE],
    /// Over joint positions, the wrench held, per rad or m.
    pub B_q: Vec<[[T; STATE]; POINTS]>,
    /// Over joint rates, per rad/s or m/s.
    pub B_rates: Vec<[[T; STATE]; POINTS]>,
    /// Over wheel speeds, per rad/s.
    pub B_wheels: Vec<[[T; STATE]; POINTS]>,
    /// Over force (N) and torque (N m) of the wrench, constant over the step.
    pub B_wrench: [[T; STATE]; HALF],
    /// Over the ten parameters of each body, in the order of `poinsot_spatial::PARAMETER_NAMES`.
    pub B_bodies: Vec<[[T; STATE]; PARAMETERS]>,
    /// Over the spin inertia of each wheel, per kg m2.
    pub B_spin: Vec<[T; STATE]>,
}

/// The vehicle at one time of a step.
#[derive(Debug, Clone)]
struct Point<T> {
    kinematics: Kinematics<T>,
    locked: Option<LockedVehicle<T>>,
    pose: StateRows<T>,
    /// Of the wrench, where one acts.
    momentum: Option<StateRows<T>>,
    /// Change of the state's rate with each input and parameter.
    q: Vec<[T; STATE]>,
    rates: Vec<[T; STATE]>,
    wheels: Vec<[T; STATE]>,
    wrench: [[T; STATE]; HALF],
    bodies: Vec<[[T; STATE]; PARAMETERS]>,
    spin: Vec<[T; STATE]>,
}

/// One vehicle, prepared once. No step allocates.
///
/// ```
/// use poinsot_dynamics::propagation::{Inputs, Linearisation, PoseMomentum, Propagation};
/// use poinsot_dynamics::{Link, Tree};
/// use poinsot_spatial::{MassProperties, Matrix3, UnitQuaternion, Vector3};
///
/// let satellite = MassProperties {
///     mass: 100.0,
///     p_BoBcm_B: Vector3::new(0.0, 0.0, 0.1),
///     I_BBcm_B: Matrix3::from_diagonal(&Vector3::new(10.0, 12.0, 8.0)),
/// };
/// let tree = Tree { links: vec![Link::base()], rotors: vec![], coordinates: vec![] };
/// let mut vehicle = Propagation::new(&tree, &[satellite.parameters()], &[])?;
/// let start = PoseMomentum {
///     R_NB: UnitQuaternion::identity(),
///     p_NoBo_N: Vector3::zeros(),
///     P: Vector3::zeros(),
///     h_SScm_N: Vector3::new(0.0, 0.0, 0.8),
/// };
/// let still = Inputs { q: &[], rates: &[], wheel_speed: &[] };
/// let mut step = Linearisation::new(&tree);
/// vehicle.linearise(&start, [still; 3], None, 0.1, &mut step)?;
/// // It turns at 0.1 rad/s about z; 1 % more inertia about z would make that 0.1 / 1.01 rad/s.
/// assert!((step.f.R_NB.angle() - 0.01).abs() < 1.0e-12);
/// let per_I_zz = step.B_bodies[0][9][2];
/// assert!((per_I_zz + 0.01 / 8.0).abs() < 1.0e-12);
/// # Ok::<(), poinsot_dynamics::propagation::StepError>(())
/// ```
#[derive(Debug, Clone)]
pub struct Propagation<'a, T = f64> {
    tree: &'a Tree,
    pub(crate) bodies: Vec<Inertial<T>>,
    spin: Vec<T>,
    points: [Point<T>; POINTS],
    joints: JointSlopes<T>,
}

impl<'a> Propagation<'a> {
    /// Ten parameters of each body about its own origin, and the spin inertia of each wheel, kg m2.
    ///
    /// # Errors
    /// A list has the wrong length.
    pub fn new(
        tree: &'a Tree,
        bodies: &[InertialParameters],
        spin_inertia: &[f64],
    ) -> Result<Self, StepError> {
        expect("bodies", bodies.len(), tree.bodies())?;
        expect("spin_inertia", spin_inertia.len(), tree.rotors.len())?;
        let bodies = bodies.iter().map(Inertial::of).collect();
        Ok(Self::over(tree, bodies, spin_inertia, 0.0))
    }
}

impl Linearisation {
    /// Room for a vehicle; filled by [`Propagation::linearise`].
    pub fn new(tree: &Tree) -> Self {
        Self::over(tree, 0.0)
    }
}

impl<T: Real> Linearisation<T> {
    #[inline(always)]
    pub(crate) fn over(tree: &Tree, zero: T) -> Self {
        let nothing = V3::all(zero);
        let column = [zero; STATE];
        let at_rest = [zero, zero, zero, zero.all(1.0)];
        Self {
            f: PoseMomentum::from_parts(at_rest, &nothing, &nothing, &nothing),
            A: [column; STATE],
            B_q: vec![[column; POINTS]; tree.dof()],
            B_rates: vec![[column; POINTS]; tree.dof()],
            B_wheels: vec![[column; POINTS]; tree.rotors.len()],
            B_wrench: [column; HALF],
            B_bodies: vec![[column; PARAMETERS]; tree.bodies()],
            B_spin: vec![column; tree.rotors.len()],
        }
    }
}

impl<T: Real> Point<T> {
    #[inline(always)]
    fn over(tree: &Tree, zero: T) -> Self {
        let column = [zero; STATE];
        Self {
            kinematics: Kinematics::over(tree, zero),
            locked: None,
            pose: StateRows::nothing(zero),
            momentum: None,
            q: vec![column; tree.dof()],
            rates: vec![column; tree.dof()],
            wheels: vec![column; tree.rotors.len()],
            wrench: [column; HALF],
            bodies: vec![[column; PARAMETERS]; tree.bodies()],
            spin: vec![column; tree.rotors.len()],
        }
    }

    /// The locked vehicle at these inputs.
    #[inline(always)]
    fn set(&mut self, tree: &Tree, bodies: &[Inertial<T>], spin: &[T], inputs: &Inputs<T>) {
        let Some(first) = bodies.first() else {
            self.locked = None;
            return;
        };
        let zero = first.mass.all(0.0);
        let still = V3::all(zero).stored();
        self.kinematics.place(tree, inputs.q);
        self.kinematics
            .set_velocities(tree, &still, &still, inputs.rates);
        let (l, mut h) = of_bodies(bodies.iter().copied(), &self.kinematics, zero);
        let speeds = spin.iter().zip(inputs.wheel_speed);
        for (j, (spin, speed)) in speeds.enumerate() {
            h += self.axis(tree, j) * (*spin * *speed);
        }
        let whole = whole(bodies.iter().copied(), &self.kinematics, zero);
        self.locked = LockedVehicle::over(&whole, &whole, (&l, &h));
    }

    /// Axis of a wheel in B.
    #[inline(always)]
    fn axis(&self, tree: &Tree, wheel: usize) -> V3<T> {
        let rotor = &tree.rotors[wheel];
        M3::of(&self.kinematics.R[rotor.body]).times(&V3::of(&rotor.axis_B))
    }

    /// Rate of a state at the inputs last set.
    #[inline(always)]
    fn rate(
        &self,
        state: &PoseMomentum<T>,
        wrench: Option<&Wrench<T>>,
    ) -> Option<PoseMomentumRate<T>> {
        let motion = self.locked.as_ref()?.base_motion(state);
        let (force, torque) = central(wrench, &motion);
        Some(PoseMomentumRate::new(
            state,
            &motion.twist,
            (&force, &torque),
        ))
    }
}

/// Force and torque about the mass centre, in B.
#[inline(always)]
fn central<T: Real>(
    wrench: Option<&Wrench<T>>,
    motion: &BaseMotion<T>,
) -> (Vector3<T>, Vector3<T>) {
    let Some(wrench) = wrench else {
        let nothing = V3::all(motion.centre.mass.all(0.0)).stored();
        return (nothing, nothing);
    };
    let (F, T) = (V3::of(&wrench.force), V3::of(&wrench.torque));
    let c = V3::of(&motion.centre.p_BoScm_B);
    (wrench.force, (T - c.cross(&F)).stored())
}

/// The change of a state's rate with an input or parameter: by the twist, and by the arm of the wrench.
struct Forcing<'m, T> {
    motion: &'m BaseMotion<T>,
    R_NB: M3<T>,
    force: V3<T>,
}

impl<T: Real> Forcing<'_, T> {
    /// Where the momentum about `Bo` at fixed twist changes by `l`, `h` and the mass centre by `dc`.
    #[inline(always)]
    fn of(&self, l: &V3<T>, h: &V3<T>, dc: &V3<T>) -> [T; STATE] {
        let (v, w) = self.motion.slope(l, h, dc);
        let torque = self.R_NB.times(&self.force.cross(dc));
        let [a, b, c, d, e, f] = pose_rate(&self.R_NB, &v, &w);
        let zero = l.x.all(0.0);
        let V3 { x, y, z } = torque;
        [a, b, c, d, e, f, zero, zero, zero, x, y, z]
    }
}

/// The points of a step as what moves it.
struct OverPoints<'p, T> {
    points: &'p [Point<T>; POINTS],
    wrench: Option<&'p Wrench<T>>,
}

impl<T: Real> Rates<PoseMomentum<T>> for OverPoints<'_, T> {
    #[inline(always)]
    fn rate(&mut self, at: StepPoint, state: &PoseMomentum<T>) -> Option<PoseMomentumRate<T>> {
        let [begin, middle, end] = self.points;
        let point = match at {
            StepPoint::Begin => begin,
            StepPoint::Middle => middle,
            StepPoint::End => end,
        };
        point.rate(state, self.wrench)
    }
}

impl<'a, T: Real> Propagation<'a, T> {
    #[inline(always)]
    pub(crate) fn over(
        tree: &'a Tree,
        bodies: Vec<Inertial<T>>,
        spin_inertia: &[f64],
        zero: T,
    ) -> Self {
        let mut spin = vec![zero; spin_inertia.len()];
        for (lanes, spin) in spin.iter_mut().zip(spin_inertia) {
            *lanes = zero.all(*spin);
        }
        let point = Point::over(tree, zero);
        Self {
            tree,
            bodies,
            spin,
            points: [point.clone(), point.clone(), point],
            joints: JointSlopes::with_room(tree),
        }
    }

    /// Motion of the base in a state at these inputs.
    ///
    /// # Errors
    /// A list has the wrong length, or the vehicle has no positive mass or inertia.
    pub fn base_motion(
        &mut self,
        state: &PoseMomentum<T>,
        inputs: Inputs<T>,
    ) -> Result<BaseMotion<T>, StepError> {
        inputs.check(self.tree)?;
        let point = &mut self.points[0];
        point.set(self.tree, &self.bodies, &self.spin, &inputs);
        let locked = point.locked.as_ref().ok_or(StepError::Singular)?;
        Ok(locked.base_motion(state))
    }

    /// The state after `dt` seconds. `inputs` are those at the start, in the middle and at the end; `wrench` is the force and torque
    /// about `Bo` from outside in B, constant over the step.
    ///
    /// # Errors
    /// A list has the wrong length, or the vehicle has no positive mass or inertia.
    #[inline(always)]
    pub fn step(
        &mut self,
        state: &PoseMomentum<T>,
        inputs: [Inputs<T>; POINTS],
        wrench: Option<&Wrench<T>>,
        dt: f64,
    ) -> Result<PoseMomentum<T>, StepError> {
        self.set(&inputs)?;
        let end = self.follow(state, wrench, dt).ok_or(StepError::Singular)?;
        Ok(end.0)
    }

    /// [`Self::step`] with its slopes: the columns follow the variational equation along the path found.
    ///
    /// # Errors
    /// A list has the wrong length, or the vehicle has no positive mass or inertia.
    #[inline(always)]
    pub fn linearise(
        &mut self,
        state: &PoseMomentum<T>,
        inputs: [Inputs<T>; POINTS],
        wrench: Option<&Wrench<T>>,
        dt: f64,
        out: &mut Linearisation<T>,
    ) -> Result<(), StepError> {
        self.set(&inputs)?;
        let (end, rate) = self.follow(state, wrench, dt).ok_or(StepError::Singular)?;
        let at_end = self.points[2].rate(&end, wrench);
        let at_end = at_end.ok_or(StepError::Singular)?;
        let middle = state_in_middle((state, &rate), (&end, &at_end), dt);
        for (at, state) in [state, &middle, &end].into_iter().enumerate() {
            self.slopes(at, state, &inputs[at], wrench)?;
        }
        out.f = end;
        self.columns(wrench.is_some(), dt, out);
        Ok(())
    }

    #[inline(always)]
    fn set(&mut self, inputs: &[Inputs<T>; POINTS]) -> Result<(), StepError> {
        for (point, inputs) in self.points.iter_mut().zip(inputs) {
            inputs.check(self.tree)?;
            point.set(self.tree, &self.bodies, &self.spin, inputs);
        }
        Ok(())
    }

    /// The state at the end, and the rate at the start.
    #[inline(always)]
    fn follow(
        &self,
        state: &PoseMomentum<T>,
        wrench: Option<&Wrench<T>>,
        dt: f64,
    ) -> Option<(PoseMomentum<T>, PoseMomentumRate<T>)> {
        let points = &self.points;
        let rate = points[0].rate(state, wrench)?;
        let end = runge_kutta_step(state, &rate, dt, &mut OverPoints { points, wrench })?;
        Some((end, rate))
    }

    /// The linearised equations at a point of the step.
    #[inline(always)]
    fn slopes(
        &mut self,
        at: usize,
        state: &PoseMomentum<T>,
        inputs: &Inputs<T>,
        wrench: Option<&Wrench<T>>,
    ) -> Result<(), StepError> {
        let (tree, point) = (self.tree, &mut self.points[at]);
        let locked = point.locked.as_ref().ok_or(StepError::Singular)?;
        let motion = &locked.base_motion(state);
        let (force, torque) = central(wrench, motion);
        point.pose = motion.pose_rows(state, &motion.twist_rows(state));
        point.momentum = match wrench {
            Some(_) => Some(StateRows::of_wrench(state, &force, &torque)),
            None => None,
        };
        let twist = &motion.twist;
        point
            .kinematics
            .set_velocities(tree, &twist.v, &twist.w, inputs.rates);
        let forcing = Forcing {
            motion,
            R_NB: quaternion::rotation(&state.quaternion()),
            force: V3::of(&force),
        };
        let zero = motion.centre.mass.all(0.0);
        let none = V3::all(zero);
        let bodies = self.bodies.iter().copied();
        let wheels = (self.spin.as_slice(), inputs.wheel_speed);
        self.joints
            .fill_over(tree, bodies, &point.kinematics, wheels);
        for (j, slope) in self.joints.of.iter().enumerate() {
            let dc = V3::of(&slope.first_moment) / motion.centre.mass;
            let (l, h) = halves(&slope.position);
            point.q[j] = forcing.of(&l, &h, &dc);
            let (l, h) = halves(&slope.rate);
            point.rates[j] = forcing.of(&l, &h, &none);
        }
        for (j, (spin, speed)) in self.spin.iter().zip(inputs.wheel_speed).enumerate() {
            let axis = point.axis(tree, j);
            point.wheels[j] = forcing.of(&none, &(axis * *spin), &none);
            point.spin[j] = forcing.of(&none, &(axis * *speed), &none);
        }
        for (i, out) in point.bodies.iter_mut().enumerate() {
            let k = &point.kinematics;
            let mut columns = [[zero; HALF]; PARAMETERS];
            body_columns(&k.R[i], &k.p[i], &k.v[i], &k.w[i], &mut columns);
            let (R, p) = (M3::of(&k.R[i]), V3::of(&k.p[i]));
            for (parameter, (out, [a, b, c, d, e, f])) in out.iter_mut().zip(columns).enumerate() {
                let dc = motion.centre_slope(&R, &p, parameter);
                *out = forcing.of(&V3::new(a, b, c), &V3::new(d, e, f), &dc);
            }
        }
        point.wrench = of_unit_wrench(&forcing.R_NB, &V3::of(&motion.centre.p_BoScm_B));
        Ok(())
    }

    /// Carries all columns over the step.
    #[inline(always)]
    fn columns(&self, pushed: bool, dt: f64, out: &mut Linearisation<T>) {
        let points = &self.points;
        let [begin, middle, end] = points;
        let zero = out.f.P.x.all(0.0);
        let carrier = Carrier {
            rows: StepRows {
                pose: [&begin.pose, &middle.pose, &end.pose],
                momentum: [
                    begin.momentum.as_ref(),
                    middle.momentum.as_ref(),
                    end.momentum.as_ref(),
                ],
                modes: [None; 3],
            },
            pushed,
            zero,
            dt,
        };
        let none = [zero; STATE];
        for (j, column) in out.A.iter_mut().enumerate() {
            *column = none;
            column[j] = zero.all(1.0);
            carrier.carry(column, [&none; POINTS]);
        }
        // Lists of one loop: every carrying is inlined, and four places are enough.
        let inputs = [
            (&mut out.B_q, [&begin.q, &middle.q, &end.q]),
            (&mut out.B_rates, [&begin.rates, &middle.rates, &end.rates]),
            (
                &mut out.B_wheels,
                [&begin.wheels, &middle.wheels, &end.wheels],
            ),
        ];
        for (columns, [b, m, e]) in inputs {
            for (j, column) in columns.iter_mut().enumerate() {
                carrier.each(column, [&b[j], &m[j], &e[j]]);
            }
        }
        for (j, column) in out.B_wrench.iter_mut().enumerate() {
            *column = none;
            let forcing = [&begin.wrench[j], &middle.wrench[j], &end.wrench[j]];
            carrier.carry_pushed(column, forcing);
        }
        let parameters = [
            (
                out.B_bodies.as_flattened_mut(),
                [&begin.bodies, &middle.bodies, &end.bodies].map(|of| of.as_flattened()),
            ),
            (
                out.B_spin.as_mut_slice(),
                [&begin.spin, &middle.spin, &end.spin].map(|of| of.as_slice()),
            ),
        ];
        for (columns, [b, m, e]) in parameters {
            for (j, column) in columns.iter_mut().enumerate() {
                *column = none;
                carrier.carry(column, [&b[j], &m[j], &e[j]]);
            }
        }
    }
}

/// Carries columns over one step.
struct Carrier<'v, T> {
    rows: StepRows<'v, T>,
    /// Whether a wrench acts: the momentum of columns changes.
    pushed: bool,
    zero: T,
    dt: f64,
}

impl<T: Real> Carrier<'_, T> {
    /// A column under a forcing at the three points.
    #[inline(always)]
    fn carry(&self, column: &mut [T; STATE], forcing: [&[T; STATE]; POINTS]) {
        if self.pushed {
            self.carry_pushed(column, forcing);
            return;
        }
        let mut pose = [[self.zero; HALF]; POINTS];
        for (pose, forcing) in pose.iter_mut().zip(forcing) {
            pose.copy_from_slice(&forcing[..HALF]);
        }
        let mut momentum = [self.zero; HALF];
        momentum.copy_from_slice(&column[HALF..]);
        let held = self.rows.held(&momentum, &pose);
        self.rows.carry_pose(column, &held, self.dt);
    }

    /// The same where the momentum changes.
    #[inline(always)]
    fn carry_pushed(&self, column: &mut [T; STATE], forcing: [&[T; STATE]; POINTS]) {
        let mut pose = [[self.zero; HALF]; POINTS];
        let mut momentum = pose;
        for (at, forcing) in forcing.into_iter().enumerate() {
            pose[at].copy_from_slice(&forcing[..HALF]);
            momentum[at].copy_from_slice(&forcing[HALF..]);
        }
        self.rows.carry(column, &pose, &momentum, self.dt);
    }

    /// Three columns, each under the forcing at one of the points alone.
    #[inline(always)]
    fn each(&self, columns: &mut [[T; STATE]; POINTS], forcing: [&[T; STATE]; POINTS]) {
        let none = [self.zero; STATE];
        for (at, column) in columns.iter_mut().enumerate() {
            *column = none;
            let mut alone = [&none; POINTS];
            alone[at] = forcing[at];
            self.carry(column, alone);
        }
    }
}

/// Change of the state's rate with a unit of force and torque about `Bo` along each axis of B.
#[inline(always)]
fn of_unit_wrench<T: Real>(R_NB: &M3<T>, c: &V3<T>) -> [[T; STATE]; HALF] {
    let zero = c.x.all(0.0);
    let mut out = [[zero; STATE]; HALF];
    for axis in 0..AXES {
        let force = R_NB.0[axis];
        // -c x e, turned to N.
        let torque = force.cross(&R_NB.times(c));
        let (V3 { x, y, z }, V3 { x: a, y: b, z: c }) = (force, torque);
        out[axis][HALF..].copy_from_slice(&[x, y, z, a, b, c]);
        out[AXES + axis][HALF + AXES..].copy_from_slice(&[x, y, z]);
    }
    out
}

#[inline(always)]
fn halves<T: Real>(x: &nalgebra::Vector6<T>) -> (V3<T>, V3<T>) {
    (V3::new(x.x, x.y, x.z), V3::new(x.w, x.a, x.b))
}

#[inline(always)]
fn expect(name: &'static str, found: usize, length: usize) -> Result<(), StepError> {
    match found == length {
        true => Ok(()),
        false => Err(StepError::Length(name, found, length)),
    }
}
