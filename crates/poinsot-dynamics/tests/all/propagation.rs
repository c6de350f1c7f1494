//! The step of pose and momentum.

use crate::setup;
use crate::xu_arm;
use poinsot_dynamics::propagation::{
    Inputs, Linearisation, PoseMomentum, Propagation, STATE, StepError,
};
use poinsot_dynamics::*;
use poinsot_spatial::{InertialParameters, MassProperties, Matrix3, UnitQuaternion, Vector3};
use poinsot_testkit::compare::attitude_apart;
use poinsot_testkit::momentum_sum::{KitJoint, KitWheel};
use poinsot_testkit::rigid_body::{AsymmetricTop, Spin};
use poinsot_testkit::trees::{TreeCase, load_trees};

type Column = [f64; STATE];

/// A vehicle with what drives it over one step.
#[derive(Clone)]
struct Case {
    tree: Tree,
    bodies: Vec<InertialParameters>,
    spin: Vec<f64>,
    state: PoseMomentum,
    /// Joint positions, joint rates and wheel speeds at the three times.
    inputs: [[Vec<f64>; 3]; 3],
    wrench: Option<Wrench>,
    dt: f64,
}

impl Case {
    fn inputs(&self) -> [Inputs<'_>; 3] {
        [0, 1, 2].map(|at| {
            let [q, rates, wheel_speed] = &self.inputs[at];
            Inputs {
                q,
                rates,
                wheel_speed,
            }
        })
    }

    fn end(&self) -> PoseMomentum {
        let mut vehicle = Propagation::new(&self.tree, &self.bodies, &self.spin).unwrap();
        let wrench = self.wrench.as_ref();
        let step = vehicle.step(&self.state, self.inputs(), wrench, self.dt);
        step.unwrap()
    }

    fn linearised(&self) -> Linearisation {
        let mut vehicle = Propagation::new(&self.tree, &self.bodies, &self.spin).unwrap();
        let mut out = Linearisation::new(&self.tree);
        let wrench = self.wrench.as_ref();
        let done = vehicle.linearise(&self.state, self.inputs(), wrench, self.dt, &mut out);
        done.unwrap();
        out
    }

    /// Round-off of a difference over a step, of each block of the state.
    fn round_off(&self, step: f64) -> [f64; 4] {
        let s = &self.state;
        let sizes = [1.0, s.p_NoBo_N.norm(), s.P.norm(), s.h_SScm_N.norm()];
        sizes.map(|size| 4.0 * f64::EPSILON * size / step)
    }

    /// Central difference of the end over what `change` moves by a step.
    fn difference(&self, step: f64, change: impl Fn(&mut Self, f64)) -> Column {
        let at = |step: f64| {
            let mut moved = self.clone();
            change(&mut moved, step);
            off(&self.end(), &moved.end())
        };
        let (further, back) = (at(step), at(-step));
        std::array::from_fn(|k| (further[k] - back[k]) / (2.0 * step))
    }
}

/// `[dphi_B, dp_N, dP_N, dh_N]` from one state to another.
fn off(from: &PoseMomentum, to: &PoseMomentum) -> Column {
    let phi = (from.R_NB.inverse() * to.R_NB).scaled_axis();
    let parts = [
        phi,
        to.p_NoBo_N - from.p_NoBo_N,
        to.P - from.P,
        to.h_SScm_N - from.h_SScm_N,
    ];
    std::array::from_fn(|k| parts[k / 3][k % 3])
}

fn shift(state: &mut PoseMomentum, k: usize, step: f64) {
    let mut change = Vector3::zeros();
    change[k % 3] = step;
    match k / 3 {
        0 => state.R_NB *= UnitQuaternion::from_scaled_axis(change),
        1 => state.p_NoBo_N += change,
        2 => state.P += change,
        _ => state.h_SScm_N += change,
    }
}

/// The recorded trees that have joints of both kinds.
fn jointed() -> Vec<TreeCase> {
    let has = |case: &TreeCase, kind: KitJoint| case.bodies.iter().any(|b| b.joint == kind);
    let mut all = load_trees().unwrap();
    all.retain(|c| has(c, KitJoint::Revolute) && has(c, KitJoint::Prismatic));
    all
}

/// One of these trees with two wheels, in general motion.
fn case(tree: usize, pushed: bool) -> Case {
    let case = jointed().swap_remove(tree);
    let wheel = |host, axis: [f64; 3], spin_inertia| KitWheel {
        host,
        axis_C: Vector3::from(axis).normalize(),
        spin_inertia,
    };
    let wheels = [
        wheel(0, [0.0, 0.0, 1.0], 0.2),
        wheel(case.bodies.len() - 1, [2.0, -1.0, 2.0], 0.04),
    ];
    let model = setup::model(&case.bodies, &wheels);
    let tree = Tree::new(&model);
    let bodies: Vec<_> = model
        .bodies
        .iter()
        .map(|b| b.nominal.parameters())
        .collect();
    let s = &case.state;
    let dt = 0.005;
    // Every input changes within the step.
    let inputs = [0.0, 0.5 * dt, dt].map(|t| {
        let q = s.q.iter().zip(&s.qd).map(|(q, rate)| q + rate * t);
        let rates = s.qd.iter().map(|rate| rate + 0.3 * t);
        [q.collect(), rates.collect(), vec![300.0 - 40.0 * t, -90.0]]
    });
    let mut kinematics = Kinematics::new(&tree);
    kinematics.place(&tree, &s.q);
    kinematics.set_velocities(&tree, &s.v_NBo_B, &s.w_NB_B, &s.qd);
    let whole = composite(&bodies, &kinematics);
    let both = momentum(&bodies, &kinematics);
    let l: Vector3 = both.fixed_rows::<3>(0).into();
    let h: Vector3 = both.fixed_rows::<3>(3).into();
    let R_NB = UnitQuaternion::from_euler_angles(0.4, -0.7, 1.9);
    let state = PoseMomentum {
        R_NB,
        p_NoBo_N: Vector3::new(3.0, -2.0, 1.0),
        P: R_NB * l,
        h_SScm_N: R_NB * (h - whole.p_BoScm_B().cross(&l)),
    };
    let size = whole.mass * 0.1;
    let wrench = pushed.then(|| Wrench {
        force: Vector3::new(size, -0.5 * size, 0.2 * size),
        torque: Vector3::new(0.1 * size, 0.3 * size, -0.2 * size),
    });
    Case {
        tree,
        bodies,
        spin: vec![0.2, 0.04],
        state,
        inputs,
        wrench,
        dt,
    }
}

/// Relative to the largest number of the difference, of an angle, a length, and both momenta each.
fn close(found: &Column, expected: &Column, scale: &[f64; 4], what: &str, most: f64) -> f64 {
    let mut worst: f64 = 0.0;
    for (k, (a, b)) in found.iter().zip(expected).enumerate() {
        let error = (a - b).abs() / scale[k / 3].max(1.0e-9);
        assert!(error < most, "{what}: row {k}: {a:e}, {b:e}, {error:e}");
        worst = worst.max(error);
    }
    worst
}

/// Largest difference of a slope relative to the largest of its block: the step of the differences, and the variational equation is
/// integrated by the rule, not the rule differentiated (both of fourth order).
const LINEAR: f64 = 1.0e-6;
/// The same for an input that changes at one point of the step alone: no smooth input, so the two differ to a lower order. Measured:
/// 1.0e-5.
const AT_ONE_POINT: f64 = 3.0e-5;

fn scales(columns: &[Column]) -> [f64; 4] {
    std::array::from_fn(|block| {
        let rows = columns.iter().flat_map(|c| &c[3 * block..3 * block + 3]);
        rows.fold(0.0, |m: f64, x| m.max(x.abs()))
    })
}

/// Columns with their differences, `step` as large as the unknown.
fn compare(what: &str, found: &[Column], expected: &[Column]) -> f64 {
    assert_eq!(found.len(), expected.len());
    let scale = scales(expected);
    let each = found.iter().zip(expected).enumerate();
    let each = each.map(|(k, (a, b))| close(a, b, &scale, &format!("{what}, column {k}"), LINEAR));
    each.fold(0.0, f64::max)
}

#[test]
fn exact_linearisation_is_that_of_differences() {
    let (mut worst, mut at_one_point): (f64, f64) = (0.0, 0.0);
    for (tree, pushed) in [(0, false), (1, true), (2, true), (3, false), (4, true)] {
        let case = case(tree, pushed);
        let step = case.linearised();
        assert!(off(&step.f, &case.end()).iter().all(|x| *x == 0.0));
        let A: Vec<Column> = (0..STATE)
            .map(|k| {
                // Of a radian, a metre, or the momentum.
                let unit = [1.0, 1.0, case.state.P.norm(), case.state.h_SScm_N.norm()][k / 3];
                case.difference(1.0e-4 * unit, |c, x| shift(&mut c.state, k, x))
            })
            .collect();
        worst = worst.max(compare(&format!("tree {tree}, A"), &step.A, &A));
        let blocks = [&step.B_q, &step.B_rates, &step.B_wheels];
        for (kind, found) in blocks.into_iter().enumerate() {
            let size = [4.0e-4, 1.0e-2, 1.0][kind];
            let inputs = 0..found.len();
            let expected: Vec<Column> = inputs
                .clone()
                .map(|j| {
                    case.difference(size, |c, x| {
                        c.inputs.iter_mut().for_each(|lists| lists[kind][j] += x);
                    })
                })
                .collect();
            let sum =
                |three: &[Column; 3]| std::array::from_fn(|k| three.iter().map(|c| c[k]).sum());
            let sums: Vec<Column> = found.iter().map(sum).collect();
            let what = format!("tree {tree}, B_u {kind}");
            worst = worst.max(compare(&what, &sums, &expected));
            let scale = scales(&expected);
            for (j, found) in inputs.zip(found) {
                for (at, column) in found.iter().enumerate() {
                    let one = case.difference(size, |c, x| c.inputs[at][kind][j] += x);
                    let off = close(column, &one, &scale, &what, AT_ONE_POINT);
                    at_one_point = at_one_point.max(off);
                }
            }
        }
        for (i, found) in step.B_bodies.iter().enumerate() {
            for (k, found) in found.iter().enumerate() {
                // Bodies without mass are among them.
                let size = case.bodies[i].to_array()[if k == 0 { 0 } else { 9 }];
                let size = 1.0e-4 * size.max(1.0);
                let expected = case.difference(size, |c, x| {
                    let mut ten = c.bodies[i].to_array();
                    ten[k] += x;
                    c.bodies[i] = InertialParameters::from_array(&ten);
                });
                let mut scale = scales(&[expected]);
                for (scale, floor) in scale.iter_mut().zip(case.round_off(size)) {
                    *scale = scale.max(floor / LINEAR);
                }
                let what = format!("tree {tree}, body {i}, parameter {k}");
                worst = worst.max(close(found, &expected, &scale, &what, LINEAR));
            }
        }
        let expected: Vec<Column> = (0..2)
            .map(|j| case.difference(1.0e-3, |c, x| c.spin[j] += x))
            .collect();
        worst = worst.max(compare("B_spin", &step.B_spin, &expected));
        let with = |case: &Case| case.wrench.unwrap_or(Wrench::ZERO);
        let expected: Vec<Column> = (0..6)
            .map(|k| {
                case.difference(1.0, |c, x| {
                    let mut wrench = with(c);
                    let part = [&mut wrench.force, &mut wrench.torque];
                    part.into_iter().nth(k / 3).unwrap()[k % 3] += x;
                    c.wrench = Some(wrench);
                })
            })
            .collect();
        worst = worst.max(compare("B_wrench", &step.B_wrench, &expected));
    }
    println!(
        "largest relative difference {worst:.1e}, of an input at one point {at_one_point:.1e}"
    );
}

#[test]
fn exact_torque_free_body_turns_as_the_elliptic_functions_say() {
    let I_BBcm_B = Matrix3::new(12.0, 0.4, -0.3, 0.4, 15.0, 0.6, -0.3, 0.6, 9.0);
    let body = MassProperties {
        mass: 80.0,
        p_BoBcm_B: Vector3::new(0.1, -0.2, 0.3),
        I_BBcm_B,
    };
    let tree = Tree {
        links: vec![Link::base()],
        rotors: Vec::new(),
        coordinates: Vec::new(),
    };
    let start = Spin {
        R_NB: Matrix3::identity(),
        w_NB_B: Vector3::new(0.2, -0.3, 0.4),
    };
    let top = AsymmetricTop::new(&I_BBcm_B, &start).unwrap();
    let mut vehicle = Propagation::new(&tree, &[body.parameters()], &[]).unwrap();
    let still = Inputs {
        q: &[],
        rates: &[],
        wheel_speed: &[],
    };
    let P = Vector3::new(8.0, -4.0, 1.6);
    let seconds = 20.0;
    let mut error = |steps: u32| {
        let mut state = PoseMomentum {
            R_NB: UnitQuaternion::identity(),
            p_NoBo_N: Vector3::zeros(),
            P,
            h_SScm_N: I_BBcm_B * start.w_NB_B,
        };
        for _ in 0..steps {
            let dt = seconds / f64::from(steps);
            state = vehicle.step(&state, [still; 3], None, dt).unwrap();
        }
        let exact = top.at(seconds);
        let turned = attitude_apart(&state.R_NB.to_rotation_matrix().into_inner(), &exact.R_NB);
        // The mass centre goes straight.
        let p_NoScm_N = state.p_NoBo_N + exact.R_NB * body.p_BoBcm_B;
        let straight = body.p_BoBcm_B + P * (seconds / body.mass);
        turned.max((p_NoScm_N - straight).norm())
    };
    let (coarse, fine) = (error(200), error(400));
    println!("error {coarse:.1e} at 0.1 s, {fine:.1e} at 0.05 s");
    assert!(fine < 1.0e-7, "{fine:e}");
    let order = (coarse / fine).log2();
    assert!((order - 4.0).abs() < 0.3, "order {order}");
}

#[test]
fn xval_steps_follow_the_simulated_motion() {
    let mut tree = xu_arm::tree();
    tree.rotors.push(Rotor {
        body: 2,
        axis_B: Vector3::new(0.6, 0.0, 0.8),
    });
    let bodies = xu_arm::parameters();
    let joints = (0..6).map(|k| {
        JointMotion::Fourier(Fourier {
            offset: 0.2 * k as f64,
            base_frequency_hz: 0.05 + 0.01 * k as f64,
            sine: vec![0.4, -0.1],
            cosine: vec![0.2],
        })
    });
    let speed = PiecewisePolynomial::linear(&[0.0, 10.0], &[20.0, 120.0]).unwrap();
    let plan = Plan {
        joints: joints.map(Into::into).collect(),
        wheels: vec![WheelMotion::Speed(speed)],
        firings: vec![Firing {
            thruster: 0,
            on: -1.0,
            off: 20.0,
            force: 5.0,
        }],
        ..Plan::default()
    };
    let nozzle = Nozzle {
        body: 0,
        p_BoT_B: Vector3::new(0.5, 0.2, -0.4),
        direction_B: Vector3::new(0.0, 0.6, 0.8),
        propellant: None,
    };
    let vehicle = Vehicle {
        modes: Vec::new(),
        tree: tree.clone(),
        bodies: bodies.clone(),
        spin_inertia: vec![0.1],
        nozzles: vec![nozzle],
        locked_at: vec![0.0; 6],
        gravity: Gravity::default(),
    };
    let (steps, dt) = (500, 0.01);
    let times: Vec<f64> = (0..=2 * steps).map(|k| 0.5 * dt * f64::from(k)).collect();
    let mut samples = Vec::new();
    Flight::new(vehicle, &plan, Tolerance::default())
        .unwrap()
        .run(&xu_arm::start(), &times, |s| samples.push(s.clone()))
        .unwrap();
    let state = |s: &MotionSample| PoseMomentum {
        R_NB: s.R_NB,
        p_NoBo_N: s.p_NoBo_N,
        P: s.l_S_N,
        h_SScm_N: s.h_SScm_N,
    };
    fn inputs(s: &MotionSample) -> Inputs<'_> {
        Inputs {
            q: &s.q,
            rates: &s.rates,
            wheel_speed: &s.wheel_speed,
        }
    }
    let force = nozzle.direction_B * 5.0;
    let wrench = Wrench {
        force,
        torque: nozzle.p_BoT_B.cross(&force),
    };
    let mut vehicle = Propagation::new(&tree, &bodies, &[0.1]).unwrap();
    let mut now = state(&samples[0]);
    for three in samples.windows(3).step_by(2) {
        let inputs = [inputs(&three[0]), inputs(&three[1]), inputs(&three[2])];
        now = vehicle.step(&now, inputs, Some(&wrench), dt).unwrap();
    }
    let last = samples.last().unwrap();
    let error = off(&state(last), &now);
    let worst = error.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
    println!("after {} s off by {worst:.1e}", last.time);
    assert!(worst < 1.0e-7, "{error:?}");
    let twist = vehicle
        .base_motion(&state(last), inputs(last))
        .unwrap()
        .twist;
    assert!((twist.w - last.w_NB_B).norm() < 1.0e-11);
    assert!((last.R_NB * twist.v - last.v_NBo_N).norm() < 1.0e-11);
}

#[test]
fn unit_errors_name_the_list() {
    let case = case(2, false);
    let short = Propagation::new(&case.tree, &case.bodies[1..], &case.spin);
    let bodies = case.bodies.len();
    let expected = StepError::Length("bodies", bodies - 1, bodies);
    assert_eq!(short.err(), Some(expected));
    let mut vehicle = Propagation::new(&case.tree, &case.bodies, &case.spin).unwrap();
    let mut inputs = case.inputs();
    inputs[2].wheel_speed = &[1.0];
    let error = vehicle.step(&case.state, inputs, None, 0.1).err();
    assert_eq!(error, Some(StepError::Length("wheel_speed", 1, 2)));
    let nothing = vec![InertialParameters::ZERO; bodies];
    let mut vehicle = Propagation::new(&case.tree, &nothing, &case.spin).unwrap();
    let error = vehicle.step(&case.state, case.inputs(), None, 0.1).err();
    assert_eq!(error, Some(StepError::Singular));
}
