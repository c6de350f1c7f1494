//! One linearised step of many vehicles of one tree.

use super::error::{BatchError, expect};
use super::kernels::spread;
use super::rows::{Group, Groups, Rows, TWIST};
use crate::algebra::V3;
use crate::inverse_dynamics::Wrench;
use crate::lanes::{Lanes, Work, in_lanes};
use crate::propagation::{Inputs, Linearisation, PoseMomentum, Propagation, STATE};
use crate::tree::Tree;
use fearless_simd::Simd;
use poinsot_spatial::InertialParameters;

/// Numbers of a pose with its momentum: `q_NB` (xyzw), `p_NoBo_N`, `P`, `h_SScm_N`.
const POSE_MOMENTUM: usize = 13;
/// Columns of an input.
const POINTS: usize = 3;
/// Inertial parameters of a body.
const PARAMETERS: usize = 10;

/// Inputs of many vehicles at one time, one row a vehicle.
#[derive(Debug, Clone, Copy)]
pub struct InputRows<'a> {
    /// Joint positions, rad or m.
    pub q: &'a [f64],
    /// Joint rates, rad/s or m/s.
    pub rates: &'a [f64],
    /// Wheel speeds relative to their hosts, rad/s.
    pub wheel_speed: &'a [f64],
}

/// A step of many vehicles.
#[derive(Debug, Clone, Copy)]
pub struct LinearSteps<'a> {
    /// Attitude (xyzw), position, linear momentum, angular momentum about the system's mass centre: 13 a vehicle, in N.
    pub states: &'a [f64],
    /// At the start, in the middle and at the end of the step.
    pub inputs: [InputRows<'a>; POINTS],
    /// Force and torque about `Bo` from outside in B, six a vehicle, constant over the step; `None` in free fall.
    pub wrench: Option<&'a [f64]>,
    /// Length of the step, s.
    pub dt: f64,
}

/// Numbers of a row of [`linearised_step`].
///
/// ```
#[doc = include_str!("../../doc/arm.txt")]
/// // 13 numbers of the state. Columns of 12: state 12, three times joint, rate and wheel, wrench 6, bodies 20, wheel 1.
/// assert_eq!(batch::linearised_width(&tree), 13 + 12 * (12 + 9 + 6 + 20 + 1));
/// ```
pub fn linearised_width(tree: &Tree) -> usize {
    let inputs = POINTS * (2 * tree.dof() + tree.rotors.len());
    let parameters = PARAMETERS * tree.bodies() + tree.rotors.len();
    POSE_MOMENTUM + STATE * (STATE + inputs + TWIST + parameters)
}

/// Fills `out`, one row of [`linearised_width`] numbers a vehicle: the state at the end, then the columns of
/// [`Linearisation`] in the order of its fields.
///
/// `bodies` are those of all vehicles, or those of each; `spin_inertia` is that of the wheels of all.
///
/// # Errors
/// An array has the wrong length, or a vehicle has no positive mass or inertia.
///
/// ```
#[doc = include_str!("../../doc/arm.txt")]
/// // Two vehicles at rest drift at 1 and 2 m/s along x: 3 kg each.
/// let mut states = [0.0; 26];
/// (states[3], states[16]) = (1.0, 1.0);
/// (states[7], states[20]) = (3.0, 6.0);
/// let still = batch::InputRows { q: &[0.0; 2], rates: &[0.0; 2], wheel_speed: &[0.0; 2] };
/// let steps = batch::LinearSteps { states: &states, inputs: [still; 3], wrench: None, dt: 0.5 };
/// let width = batch::linearised_width(&tree);
/// let mut out = vec![0.0; 2 * width];
/// batch::linearised_step(&tree, &bodies, &[0.01], steps, &mut out)?;
/// assert!((out[4] - 0.5).abs() < 1.0e-12);
/// assert!((out[width + 4] - 1.0).abs() < 1.0e-12);
/// # Ok::<(), batch::BatchError>(())
/// ```
pub fn linearised_step(
    tree: &Tree,
    bodies: &[InertialParameters],
    spin_inertia: &[f64],
    steps: LinearSteps,
    out: &mut [f64],
) -> Result<(), BatchError> {
    let count = steps.states.len() / POSE_MOMENTUM;
    expect("states", steps.states.len(), count * POSE_MOMENTUM)?;
    expect("spin_inertia", spin_inertia.len(), tree.rotors.len())?;
    for inputs in &steps.inputs {
        expect("q", inputs.q.len(), count * tree.dof())?;
        expect("dq", inputs.rates.len(), count * tree.dof())?;
        let wheels = inputs.wheel_speed.len();
        expect("wheel_speed", wheels, count * tree.rotors.len())?;
    }
    if let Some(wrench) = steps.wrench {
        expect("wrench", wrench.len(), count * TWIST)?;
    }
    if bodies.len() != tree.bodies() {
        expect("bodies", bodies.len(), count * tree.bodies())?;
    }
    expect("out", out.len(), count * linearised_width(tree))?;
    in_lanes(Stepping {
        tree,
        bodies,
        spin_inertia,
        steps,
        out,
    })
}

struct Stepping<'a> {
    tree: &'a Tree,
    bodies: &'a [InertialParameters],
    spin_inertia: &'a [f64],
    steps: LinearSteps<'a>,
    out: &'a mut [f64],
}

/// Inputs of a group at one time.
struct Lists<S: Simd> {
    q: Vec<Lanes<S>>,
    rates: Vec<Lanes<S>>,
    wheel_speed: Vec<Lanes<S>>,
}

impl<S: Simd> Lists<S> {
    #[inline(always)]
    fn gather(&mut self, group: &Group<S>, from: &InputRows) {
        let (dof, wheels) = (self.q.len(), self.wheel_speed.len());
        let (q, rates) = (group.rows(from.q, dof), group.rows(from.rates, dof));
        for j in 0..dof {
            self.q[j] = q.number(group.simd, j);
            self.rates[j] = rates.number(group.simd, j);
        }
        let speeds = group.rows(from.wheel_speed, wheels);
        for (j, speed) in self.wheel_speed.iter_mut().enumerate() {
            *speed = speeds.number(group.simd, j);
        }
    }

    #[inline(always)]
    fn inputs(&self) -> Inputs<'_, Lanes<S>> {
        Inputs {
            q: &self.q,
            rates: &self.rates,
            wheel_speed: &self.wheel_speed,
        }
    }
}

impl Work for Stepping<'_> {
    type Output = Result<(), BatchError>;

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> Self::Output {
        let Self {
            tree,
            bodies,
            spin_inertia,
            steps,
            out,
        } = self;
        let zero = Lanes::new(simd, 0.0);
        let width = linearised_width(tree);
        let vehicles = spread(tree, bodies, zero);
        let mut vehicle = Propagation::over(tree, vehicles, spin_inertia, zero);
        let mut step = Linearisation::over(tree, zero);
        let mut lists = [(); POINTS].map(|()| Lists {
            q: vec![zero; tree.dof()],
            rates: vec![zero; tree.dof()],
            wheel_speed: vec![zero; tree.rotors.len()],
        });
        for (group, of) in Groups::new(tree, simd, width, out) {
            group.gather(bodies, &mut vehicle.bodies);
            for (lists, from) in lists.iter_mut().zip(&steps.inputs) {
                lists.gather(&group, from);
            }
            let state = state(&group, steps.states);
            let wrench = steps.wrench.map(|all| {
                let [force, torque] = group.rows(all, TWIST).pair(simd);
                Wrench { force, torque }
            });
            let [begin, middle, end] = &lists;
            let inputs = [begin.inputs(), middle.inputs(), end.inputs()];
            let done = vehicle.linearise(&state, inputs, wrench.as_ref(), steps.dt, &mut step);
            done.map_err(|why| BatchError::Step(group.first, why))?;
            put(&mut Rows::new(of, width), &step);
        }
        Ok(())
    }
}

#[inline(always)]
fn state<S: Simd>(group: &Group<S>, states: &[f64]) -> PoseMomentum<Lanes<S>> {
    let rows = group.rows(states, POSE_MOMENTUM);
    let mut numbers = [Lanes::new(group.simd, 0.0); POSE_MOMENTUM];
    for (k, number) in numbers.iter_mut().enumerate() {
        *number = rows.number(group.simd, k);
    }
    let [a, b, c, d, px, py, pz, Px, Py, Pz, hx, hy, hz] = numbers;
    PoseMomentum::from_parts(
        [a, b, c, d],
        &V3::new(px, py, pz),
        &V3::new(Px, Py, Pz),
        &V3::new(hx, hy, hz),
    )
}

/// A step in the order of its fields.
#[inline(always)]
fn put<S: Simd>(rows: &mut Rows, step: &Linearisation<Lanes<S>>) {
    let (f, q) = (&step.f, step.f.quaternion());
    rows.put(0, &q);
    for (k, v) in [&f.p_NoBo_N, &f.P, &f.h_SScm_N].into_iter().enumerate() {
        rows.put(q.len() + 3 * k, &[v.x, v.y, v.z]);
    }
    let mut at = POSE_MOMENTUM;
    let inputs = [&step.B_q, &step.B_rates, &step.B_wheels];
    put_columns(rows, &mut at, &step.A);
    for columns in inputs.into_iter().flatten() {
        put_columns(rows, &mut at, columns);
    }
    put_columns(rows, &mut at, &step.B_wrench);
    for columns in &step.B_bodies {
        put_columns(rows, &mut at, columns);
    }
    put_columns(rows, &mut at, &step.B_spin);
}

#[inline(always)]
fn put_columns<S: Simd>(rows: &mut Rows, at: &mut usize, columns: &[[Lanes<S>; STATE]]) {
    for column in columns {
        rows.put(*at, column);
        *at += STATE;
    }
}
