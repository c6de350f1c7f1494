//! Kernels over many states: the arrays of the Python package, C-contiguous, one state a row, filled in place.
//!
//! Blocks of states go to all cores; between blocks the interpreter is asked for signals.

use crate::arrays::rows;
use crate::fault::Fault;
use crate::model::CoreModel;
use numpy::{PyReadonlyArrayDyn, PyReadwriteArrayDyn};
use poinsot_dynamics::batch::{self, BatchError};
use poinsot_dynamics::{
    Flight, ForceProfile, JointDrive, Kinematics, MassMatrix, PiecewisePolynomial, Plan,
    SpringDamper, Start, StartVelocity, Tolerance, Tree, Vehicle, WheelMotion, generalise_jacobian,
    joint_jacobian, point_of_body,
};
use poinsot_spatial::{InertialParameters, UnitQuaternion, Vector3, Vector6};
use pyo3::prelude::*;

/// States between two looks at signals: a few hundredths of a second.
const BLOCK: usize = 1 << 15;
/// Fewest states for which a thread is started.
const SHARE: usize = 1 << 11;

type Input<'py> = PyReadonlyArrayDyn<'py, f64>;
type Output<'py> = PyReadwriteArrayDyn<'py, f64>;

/// Fills `width` numbers of `out` per state by `work(first, rows)`, which may refuse a state.
fn fill(
    py: Python<'_>,
    out: &mut [f64],
    width: usize,
    work: impl Fn(usize, &mut [f64]) -> Result<(), Fault> + Sync,
) -> PyResult<()> {
    for (block, part) in out.chunks_mut(BLOCK * width).enumerate() {
        let work = &work;
        py.detach(|| {
            let states = part.len() / width.max(1);
            let first = block * BLOCK;
            if states <= SHARE {
                return work(first, part);
            }
            // Asked only here: it reads files of the system, as long as some hundred states take.
            let cores = std::thread::available_parallelism().map_or(1, |n| n.get());
            let share = states.div_ceil(cores).max(SHARE);
            std::thread::scope(|scope| {
                let pieces = part.chunks_mut(share * width).enumerate();
                let threads: Vec<_> = pieces
                    .map(|(k, rows)| scope.spawn(move || work(first + k * share, rows)))
                    .collect();
                let ended = threads.into_iter().map(|t| t.join().unwrap_or(Ok(())));
                ended.collect::<Result<Vec<()>, Fault>>().map(|_| ())
            })
        })?;
        py.check_signals()?;
    }
    Ok(())
}

/// [`fill`] with one state a call: `one(scratch, state, row)`.
fn fill_each<S>(
    py: Python<'_>,
    out: &mut [f64],
    width: usize,
    scratch: impl Fn() -> S + Sync,
    one: impl Fn(&mut S, usize, &mut [f64]) -> Result<(), Fault> + Sync,
) -> PyResult<()> {
    fill(py, out, width, |first, rows| {
        let mut scratch = scratch();
        let mut rows = rows.chunks_exact_mut(width).enumerate();
        rows.try_for_each(|(k, row)| one(&mut scratch, first + k, row))
    })
}

/// The contiguous numbers of an output.
fn output<'a>(out: &'a mut Output<'_>) -> Result<&'a mut [f64], Fault> {
    out.as_slice_mut()
        .map_err(|_| Fault::argument("out", "", "it is not C-contiguous", "use np.empty"))
}

/// Inertial parameters of each body: those given, ten a body, else the nominal ones.
fn bodies(model: &CoreModel, given: Option<&Input<'_>>) -> Result<Vec<InertialParameters>, Fault> {
    let Some(given) = given else {
        return Ok(model.nominal.clone());
    };
    let numbers = rows("parameters", given, 10)?;
    let sets: Vec<_> = numbers
        .as_chunks::<10>()
        .0
        .iter()
        .map(InertialParameters::from_array)
        .collect();
    if sets.len() != model.nominal.len() {
        let why = format!("{} sets, expected {}", sets.len(), model.nominal.len());
        let advice = "give ten numbers a body";
        return Err(Fault::argument("parameters", sets.len(), why, advice));
    }
    Ok(sets)
}

/// Joint positions, rates and base twists of many states.
struct States<'a> {
    tree: &'a Tree,
    q: &'a [f64],
    dq: &'a [f64],
    V: &'a [f64],
}

impl<'a> States<'a> {
    fn new(
        model: &'a CoreModel,
        q: &'a Input<'_>,
        dq: &'a Input<'_>,
        V: &'a Input<'_>,
    ) -> Result<Self, Fault> {
        let tree = &model.tree;
        Ok(Self {
            tree,
            q: rows("q", q, tree.dof())?,
            dq: rows("dq", dq, tree.dof())?,
            V: rows("V", V, 6)?,
        })
    }

    /// `count` states from `first` on.
    fn part(&self, first: usize, count: usize) -> batch::States<'a> {
        let n = self.tree.dof();
        batch::States {
            q: of_states(self.q, n, first, count),
            rates: of_states(self.dq, n, first, count),
            twist: of_states(self.V, 6, first, count),
        }
    }
}

/// The rows of `count` states from `first` on; fewer where there are no more.
fn of_states(all: &[f64], width: usize, first: usize, count: usize) -> &[f64] {
    let rest = all.get(first * width..).unwrap_or_default();
    rest.get(..count * width).unwrap_or(rest)
}

/// The argument or the state that a batch from state `first` on refuses.
fn refused(first: usize, error: BatchError) -> Fault {
    match error {
        BatchError::Singular(k, why) => singular(first + k, &why.to_string()),
        BatchError::Halted(k, why) => singular(first + k, &why.to_string()),
        BatchError::Length(name, found, _) => Fault::argument(name, found, error.to_string(), ""),
    }
}

/// `out`: `(n, 10 bodies, 6)`.
#[pyfunction]
pub fn momentum_regressor(
    py: Python<'_>,
    model: &CoreModel,
    q: Input<'_>,
    dq: Input<'_>,
    V: Input<'_>,
    mut out: Output<'_>,
) -> PyResult<()> {
    let states = States::new(model, &q, &dq, &V)?;
    let width = 60 * states.tree.bodies();
    fill(py, output(&mut out)?, width, |first, rows| {
        let part = states.part(first, rows.len() / width);
        batch::momentum_regressor(states.tree, part, rows).map_err(|e| refused(first, e))
    })
}

/// `out`: `(n, 6)`.
#[pyfunction]
#[pyo3(signature = (model, q, dq, V, out, parameters=None))]
pub fn momentum(
    py: Python<'_>,
    model: &CoreModel,
    q: Input<'_>,
    dq: Input<'_>,
    V: Input<'_>,
    mut out: Output<'_>,
    parameters: Option<Input<'_>>,
) -> PyResult<()> {
    let states = States::new(model, &q, &dq, &V)?;
    let bodies = bodies(model, parameters.as_ref())?;
    fill(py, output(&mut out)?, 6, |first, rows| {
        let part = states.part(first, rows.len() / 6);
        batch::momentum(states.tree, &bodies, part, rows).map_err(|e| refused(first, e))
    })
}

/// `out`: `(n, 6 + dof, 6 + dof)`.
#[pyfunction]
#[pyo3(signature = (model, q, out, parameters=None))]
pub fn mass_matrix(
    py: Python<'_>,
    model: &CoreModel,
    q: Input<'_>,
    mut out: Output<'_>,
    parameters: Option<Input<'_>>,
) -> PyResult<()> {
    let tree = &*model.tree;
    let q = rows("q", &q, tree.dof())?;
    let bodies = bodies(model, parameters.as_ref())?;
    let (dof, size) = (tree.dof(), 6 + tree.dof());
    let scratch = || (Kinematics::new(tree), MassMatrix::new(tree));
    let (out, width) = (output(&mut out)?, size * size);
    fill_each(py, out, width, scratch, |(kinematics, H), k, row| {
        kinematics.place(tree, q.get(k * dof..(k + 1) * dof).unwrap_or_default());
        H.set(tree, &bodies, kinematics);
        for i in 0..6 {
            for j in 0..6 {
                row[i * size + j] = H.H_b[(i, j)];
            }
            for j in 0..dof {
                row[i * size + 6 + j] = H.H_bm[j][i];
                row[(6 + j) * size + i] = H.H_bm[j][i];
            }
        }
        for i in 0..dof {
            let from = &H.H_m[i * dof..(i + 1) * dof];
            row[(6 + i) * size + 6..(7 + i) * size].copy_from_slice(from);
        }
        Ok(())
    })
}

/// `out`: `(n, 6, 6 + dof)`, or `(n, 6, dof)` without momentum.
#[pyfunction]
#[pyo3(signature = (model, body, point, q, out, generalised=false, parameters=None))]
#[allow(clippy::too_many_arguments)]
pub fn jacobian(
    py: Python<'_>,
    model: &CoreModel,
    body: usize,
    point: [f64; 3],
    q: Input<'_>,
    mut out: Output<'_>,
    generalised: bool,
    parameters: Option<Input<'_>>,
) -> PyResult<()> {
    let tree = &*model.tree;
    let q = rows("q", &q, tree.dof())?;
    let bodies = bodies(model, parameters.as_ref())?;
    let dof = tree.dof();
    let base = if generalised { 0 } else { 6 };
    let width = 6 * (base + dof);
    let point = Vector3::from(point);
    let scratch = || {
        let columns = vec![Vector6::zeros(); dof];
        (Kinematics::new(tree), MassMatrix::new(tree), columns)
    };
    let out = output(&mut out)?;
    fill_each(py, out, width, scratch, |(kinematics, H, J), k, row| {
        kinematics.place(tree, q.get(k * dof..(k + 1) * dof).unwrap_or_default());
        let place = point_of_body(kinematics, body, &point);
        joint_jacobian(tree, kinematics, body, &place, J);
        if generalised {
            H.set(tree, &bodies, kinematics);
            generalise_jacobian(H, &place, J)
                .ok_or_else(|| singular(k, "the vehicle has no mass or no inertia"))?;
        } else {
            let J_b = poinsot_dynamics::base_jacobian(&place);
            for i in 0..6 {
                for j in 0..6 {
                    row[i * (6 + dof) + j] = J_b[(i, j)];
                }
            }
        }
        for (j, column) in J.iter().enumerate() {
            for i in 0..6 {
                row[i * (base + dof) + base + j] = column[i];
            }
        }
        Ok(())
    })
}

fn singular(state: usize, why: &str) -> Fault {
    Fault::argument("state", state.to_string(), why, "give it mass and inertia")
}

/// `out`: `(n, 6 + dof)`: `a_NBo_B`, `alpha_NB_B`, joint accelerations. `wrench` on the base about `Bo`.
#[pyfunction]
#[pyo3(signature = (model, q, dq, V, tau, wrench, out, parameters=None))]
#[allow(clippy::too_many_arguments)]
pub fn forward_dynamics(
    py: Python<'_>,
    model: &CoreModel,
    q: Input<'_>,
    dq: Input<'_>,
    V: Input<'_>,
    tau: Input<'_>,
    wrench: Input<'_>,
    mut out: Output<'_>,
    parameters: Option<Input<'_>>,
) -> PyResult<()> {
    let states = States::new(model, &q, &dq, &V)?;
    let dof = states.tree.dof();
    let tau = rows("tau", &tau, dof)?;
    let wrench = rows("wrench", &wrench, 6)?;
    let bodies = bodies(model, parameters.as_ref())?;
    let width = 6 + dof;
    fill(py, output(&mut out)?, width, |first, rows| {
        let count = rows.len() / width;
        let part = states.part(first, count);
        let tau = of_states(tau, dof, first, count);
        let wrench = of_states(wrench, 6, first, count);
        batch::forward_dynamics(states.tree, &bodies, part, tau, wrench, rows)
            .map_err(|e| refused(first, e))
    })
}

/// Motion under constant joint torques: rows of `out`, one per state, hold `times` times
/// `q, dq, v_NBo_N, w_NB_B, q_NB xyzw, p_NoBo_N`; `start` holds `V, q_NB xyzw, p_NoBo_N`.
#[pyfunction]
#[pyo3(signature = (model, times, q, dq, start, tau, out, parameters=None))]
#[allow(clippy::too_many_arguments)]
pub fn integrate(
    py: Python<'_>,
    model: &CoreModel,
    times: Vec<f64>,
    q: Input<'_>,
    dq: Input<'_>,
    start: Input<'_>,
    tau: Input<'_>,
    mut out: Output<'_>,
    parameters: Option<Input<'_>>,
) -> PyResult<()> {
    let dof = model.tree.dof();
    let q = rows("q", &q, dof)?;
    let dq = rows("dq", &dq, dof)?;
    let tau = rows("tau", &tau, dof)?;
    let start = rows("start", &start, 13)?;
    let bodies = bodies(model, parameters.as_ref())?;
    let wheels = model.model.wheels.len();
    let spin = model.model.spin_inertias();
    let one_time = 2 * dof + 13;
    let width = one_time * times.len();
    let out = output(&mut out)?;
    fill_each(
        py,
        out,
        width,
        || (),
        |(), k, row| {
            let joint = |j: usize| JointDrive::Force {
                motor: ForceProfile::Nodes(PiecewisePolynomial::constant(tau[k * dof + j])),
                spring: SpringDamper::default(),
                initial_position: q[k * dof + j],
                initial_rate: dq[k * dof + j],
            };
            let plan = Plan {
                joints: (0..dof).map(joint).collect(),
                wheels: vec![WheelMotion::constant(0.0); wheels],
                ..Plan::default()
            };
            let refused = |e: poinsot_dynamics::MotionError| singular(k, &e.to_string());
            let tree = (*model.tree).clone();
            let vehicle = Vehicle::new(tree, bodies.clone(), spin.clone(), Vec::new());
            let flight = Flight::new(vehicle, &plan, Tolerance::default()).map_err(refused)?;
            let mut rows = row.chunks_exact_mut(one_time);
            let start = start_of(&start[13 * k..13 * k + 13]);
            let put = |sample: &_| {
                if let Some(row) = rows.next() {
                    put(row, dof, sample);
                }
            };
            flight.run(&start, &times, put).map_err(refused)?;
            Ok(())
        },
    )
}

/// Twist in B, attitude scalar last, position.
fn start_of(numbers: &[f64]) -> Start {
    let vector = |k: usize| Vector3::from_column_slice(&numbers[k..k + 3]);
    let q = &numbers[6..10];
    let R_NB = UnitQuaternion::from_quaternion(nalgebra::Quaternion::new(q[3], q[0], q[1], q[2]));
    Start {
        R_NB,
        p_NoBo_N: vector(10),
        velocity: StartVelocity::Twist {
            v_NBo_N: R_NB * vector(0),
            w_NB_B: vector(3),
        },
    }
}

fn put(row: &mut [f64], dof: usize, motion: &poinsot_dynamics::MotionSample) {
    row[..dof].copy_from_slice(&motion.q);
    row[dof..2 * dof].copy_from_slice(&motion.rates);
    let v_NBo_B = motion.R_NB.inverse() * motion.v_NBo_N;
    let q = motion.R_NB.coords;
    let rest = [
        v_NBo_B.as_slice(),
        motion.w_NB_B.as_slice(),
        q.as_slice(),
        motion.p_NoBo_N.as_slice(),
    ]
    .concat();
    row[2 * dof..].copy_from_slice(&rest);
}
