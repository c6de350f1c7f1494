//! Kernels over many states against the kernels of one state.

use crate::setup;
use crate::xu_arm::{self, State, Stream};

use poinsot_dynamics::batch::{self, BatchError, States};
use poinsot_dynamics::*;
use poinsot_spatial::InertialParameters;
use poinsot_testkit::trees::load_trees;

/// Largest difference to one state, relative to the largest number of the row.
const TOLERANCE: f64 = 1e-12;

/// Rows of joint positions, rates, twists and joint forces, a wrench on the base.
struct Batch {
    tree: Tree,
    bodies: Vec<InertialParameters>,
    states: Vec<State>,
    q: Vec<f64>,
    rates: Vec<f64>,
    twist: Vec<f64>,
    forces: Vec<f64>,
    wrench: Vec<f64>,
}

impl Batch {
    /// The benchmark arm at many states.
    fn arm(count: usize) -> Self {
        let mut stream = Stream(1);
        let states: Vec<State> = (0..count).map(|_| stream.state()).collect();
        let mut numbers = |n: usize| (0..n).map(|_| stream.number()).collect();
        Self {
            tree: xu_arm::tree(),
            bodies: xu_arm::parameters(),
            q: states.iter().flat_map(|s| s.q).collect(),
            rates: states.iter().flat_map(|s| s.rates).collect(),
            twist: states.iter().flat_map(twist).collect(),
            forces: numbers(6 * count),
            wrench: numbers(6 * count),
            states,
        }
    }

    fn count(&self) -> usize {
        self.twist.len() / 6
    }

    /// Regressor, momentum and accelerations (none where a vehicle has no inertia) of the states from `first` on, `count` of them.
    fn of(&self, first: usize, count: usize) -> [Vec<f64>; 3] {
        let (dof, bodies) = (self.tree.dof(), self.tree.bodies());
        let part = |rows: &'_ [f64], width: usize| rows[first * width..][..count * width].to_vec();
        let (q, rates) = (part(&self.q, dof), part(&self.rates, dof));
        let twist = part(&self.twist, 6);
        let states = States {
            q: &q,
            rates: &rates,
            twist: &twist,
        };
        let mut Y = vec![f64::NAN; 60 * bodies * count];
        let mut momentum = vec![f64::NAN; 6 * count];
        let mut a = vec![f64::NAN; (6 + dof) * count];
        batch::momentum_regressor(&self.tree, states, &mut Y).unwrap();
        batch::momentum(&self.tree, &self.bodies, states, &mut momentum).unwrap();
        let (forces, wrench) = (part(&self.forces, dof), part(&self.wrench, 6));
        let (tree, bodies) = (&self.tree, &self.bodies);
        match batch::forward_dynamics(tree, bodies, states, &forces, &wrench, &mut a) {
            Ok(()) => {}
            Err(BatchError::Singular(..)) => a.clear(),
            Err(error) => panic!("{error}"),
        }
        [Y, momentum, a]
    }

    /// The same of state `k` by the kernels of one state.
    fn alone(&self, k: usize) -> [Vec<f64>; 3] {
        let dof = self.tree.dof();
        let mut kinematics = Kinematics::new(&self.tree);
        let rates = &self.rates[k * dof..][..dof];
        let V = &self.twist[6 * k..][..6];
        let (v, w) = (V[..3].to_vec(), V[3..].to_vec());
        kinematics.place(&self.tree, &self.q[k * dof..][..dof]);
        let (v, w) = (vector(&v), vector(&w));
        kinematics.set_velocities(&self.tree, &v, &w, rates);
        let mut Y = vec![[0.0; 6]; 10 * self.tree.bodies()];
        momentum_regressor(&kinematics, &mut Y);
        let momentum = momentum(&self.bodies, &kinematics).as_slice().to_vec();
        let mut dynamics = ForwardDynamics::new(&self.tree);
        dynamics.set_bodies(&self.tree, &self.bodies, &kinematics);
        let wrench = &self.wrench[6 * k..][..6];
        dynamics.add_wrench(0, &vector(&wrench[..3]), &vector(&wrench[3..]));
        let inputs: Vec<_> = self.forces[k * dof..][..dof]
            .iter()
            .map(|f| JointInput::Force(*f))
            .collect();
        let mut joints = vec![0.0; dof];
        let (tree, found) = (&self.tree, &mut joints);
        let solved = dynamics.solve(tree, &kinematics, rates, &inputs, found);
        if solved.is_err() {
            return [Y.as_flattened().to_vec(), momentum, Vec::new()];
        }
        let (a, alpha) = dynamics.acceleration(0);
        let base = [a.as_slice(), alpha.as_slice(), &joints].concat();
        [Y.as_flattened().to_vec(), momentum, base]
    }
}

fn vector(numbers: &[f64]) -> poinsot_spatial::Vector3 {
    poinsot_spatial::Vector3::from_column_slice(numbers)
}

fn twist(state: &State) -> [f64; 6] {
    let (v, w) = (&state.v, &state.w);
    [v.x, v.y, v.z, w.x, w.y, w.z]
}

fn apart(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    let scale = b.iter().fold(f64::MIN_POSITIVE, |m, b| m.max(b.abs()));
    let differences = a.iter().zip(b).map(|(a, b)| (a - b).abs() / scale);
    // NaN counts as the largest.
    differences.fold(0.0, |m, d| if d <= m { m } else { d })
}

#[test]
fn exact_many_states_are_those_one_by_one() {
    let batch = Batch::arm(1000);
    let all = batch.of(0, batch.count());
    for k in 0..batch.count() {
        for (all, one) in all.iter().zip(batch.alone(k)) {
            let difference = apart(&all[k * one.len()..][..one.len()], &one);
            assert!(difference < TOLERANCE, "state {k}: {difference:e}");
        }
    }
}

#[test]
fn xval_recorded_trees_give_the_same_in_a_batch() {
    // Trees with branches, fixed, prismatic and oblique joints; one state each.
    for (i, case) in load_trees().unwrap().into_iter().enumerate() {
        let model = setup::model(&case.bodies, &[]);
        let (tree, s) = (Tree::new(&model), &case.state);
        let bodies = model.bodies.iter().map(|b| b.nominal.parameters());
        let batch = Batch {
            bodies: bodies.collect(),
            states: Vec::new(),
            q: s.q.clone(),
            rates: s.qd.clone(),
            twist: [s.v_NBo_B.as_slice(), s.w_NB_B.as_slice()].concat(),
            forces: vec![0.3; tree.dof()],
            wrench: vec![0.2; 6],
            tree,
        };
        for (found, one) in batch.of(0, 1).iter().zip(batch.alone(0)) {
            let difference = apart(found, &one);
            assert!(difference < TOLERANCE, "tree {i}: {difference:e}");
        }
    }
}

#[test]
fn exact_bits_do_not_depend_on_the_batch() {
    let batch = Batch::arm(41);
    let all = batch.of(0, batch.count());
    for size in [1, 2, 3, 5, 8, 13] {
        for first in (0..batch.count()).step_by(size) {
            let count = size.min(batch.count() - first);
            for (all, part) in all.iter().zip(batch.of(first, count)) {
                let width = part.len() / count;
                let same = &all[first * width..(first + count) * width];
                let bits = |x: &[f64]| x.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
                assert_eq!(bits(same), bits(&part), "{count} states from {first}");
            }
        }
    }
}

#[test]
fn exact_every_state_can_have_its_own_vehicle() {
    let count = 19;
    let mut batch = Batch::arm(count);
    let of = |k: usize| {
        let heavier = |body: &InertialParameters| {
            InertialParameters::from_array(&body.to_array().map(|x| x * (1.0 + 0.1 * k as f64)))
        };
        let mut bodies = xu_arm::parameters();
        bodies[3] = heavier(&bodies[3]);
        bodies
    };
    let vehicles: Vec<_> = (0..count).flat_map(of).collect();
    let states = States {
        q: &batch.q,
        rates: &batch.rates,
        twist: &batch.twist,
    };
    let (mut out, tree) = (vec![0.0; 12 * count], batch.tree.clone());
    let (forces, wrench) = (&batch.forces, &batch.wrench);
    batch::forward_dynamics(&tree, &vehicles, states, forces, wrench, &mut out).unwrap();
    for k in 0..count {
        batch.bodies = of(k);
        let [.., one] = batch.alone(k);
        let difference = apart(&out[12 * k..][..12], &one);
        assert!(difference < TOLERANCE, "vehicle {k}: {difference:e}");
    }
}

#[test]
fn exact_many_vehicles_move_as_one_by_one() {
    let (tree, count) = (xu_arm::tree(), 11);
    let of = |k: usize| {
        let mut bodies = xu_arm::parameters();
        bodies[6].mass += k as f64;
        bodies
    };
    let plan = Plan {
        joints: xu_arm::drives(),
        ..Plan::default()
    };
    let driven = |k| {
        let vehicle = Vehicle::new(tree.clone(), of(k), Vec::new(), Vec::new());
        Flight::new(vehicle, &plan, Integrator::RungeKutta4(0.01)).unwrap()
    };
    let start = xu_arm::start();
    let state = |k| driven(k).state(&start, 0.0).unwrap();
    let mut states: Vec<f64> = (0..count).flat_map(state).collect();
    let steps = batch::Steps {
        start: 0.0,
        step: 0.01,
        count: 50,
    };
    let bodies: Vec<_> = (0..count).flat_map(of).collect();
    let motors: Vec<ForceProfile> = plan
        .joints
        .iter()
        .map(|joint| match joint {
            JointDrive::Force { motor, .. } => motor.clone(),
            JointDrive::Motion(_) => ForceProfile::none(),
        })
        .collect();
    batch::integrate(&tree, &bodies, &motors, steps, &mut states).unwrap();
    for (k, y) in states.chunks_exact(25).enumerate() {
        let mut ends = Vec::new();
        driven(k)
            .run(&start, &[0.0, 0.5], |m| {
                let place = [m.R_NB.coords.as_slice(), m.p_NoScm_N.as_slice()].concat();
                let momenta = [m.l_S_N.as_slice(), m.h_SScm_N.as_slice()].concat();
                ends.push([place, momenta, m.q.clone(), m.rates.clone()].concat());
            })
            .unwrap();
        let difference = apart(y, &ends[1]);
        assert!(difference < TOLERANCE, "vehicle {k}: {difference:e}");
    }
}

#[test]
fn unit_errors_name_the_array_and_the_state() {
    let count = 11;
    let batch = Batch::arm(count);
    let states = States {
        q: &batch.q,
        rates: &batch.rates[1..],
        twist: &batch.twist,
    };
    let tree = &batch.tree;
    let error = batch::momentum(tree, &batch.bodies, states, &mut [0.0; 66]).unwrap_err();
    assert_eq!(error, BatchError::Length("dq", 65, 66));
    let states = States {
        rates: &batch.rates,
        ..states
    };
    let error = batch::momentum_regressor(tree, states, &mut [0.0; 7]).unwrap_err();
    assert_eq!(error, BatchError::Length("out", 7, 420 * count));
    // Nothing on the last joint of one vehicle.
    let mut vehicles: Vec<_> = (0..count).flat_map(|_| batch.bodies.clone()).collect();
    vehicles[7 * 9 + 6] = InertialParameters::from_array(&[0.0; 10]);
    let (forces, wrench) = (&batch.forces, &batch.wrench);
    let mut out = vec![0.0; 12 * count];
    let error = batch::forward_dynamics(tree, &vehicles, states, forces, wrench, &mut out);
    assert_eq!(error, Err(BatchError::Singular(9, Singular::Joint(5))));
    assert_eq!(batch.states.len(), count);
}
