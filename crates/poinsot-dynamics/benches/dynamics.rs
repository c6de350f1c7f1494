//! Forward and inverse dynamics, and simulated seconds per second of processor time under joint torques, for the
//! benchmark arm: one line `name,value,unit` per figure.
//!
//! `POINSOT_BENCH_COUNT=<name>:<calls>` runs one kernel a fixed number of times instead, for instruction
//! counters; `sim_rk4_10ms:<steps>` runs that many steps.
#![allow(non_snake_case)]

mod least_time;
mod xu_arm;

use least_time::{measure, measure_batch, processor_seconds};
use poinsot_dynamics::*;
use poinsot_spatial::{UnitQuaternion, Vector3};
use std::hint::black_box;
use xu_arm::{BATCH, RING, Rows};

/// Length of the simulation, s, and how often it is repeated.
const SECONDS: f64 = 20.0;
const REPEATS: usize = 40;

/// Constant joint torques, the same in the peers, N m.
const TORQUES: [f64; 6] = [1.0, -0.8, 0.6, 0.1, -0.05, 0.02];

fn main() {
    kernels();
    batches();
    measurements();
    let tolerance = |relative| Tolerance {
        relative,
        ..Tolerance::default()
    };
    for (name, integrator) in [
        ("rk4_10ms", Integrator::RungeKutta4(0.01)),
        ("rk4_1ms", Integrator::RungeKutta4(0.001)),
        (
            "dp8_adaptive_1e-10",
            Integrator::DormandPrince8(tolerance(1e-10)),
        ),
        (
            "dp8_adaptive_1e-11",
            Integrator::DormandPrince8(tolerance(1e-11)),
        ),
    ] {
        simulate(name, integrator);
    }
}

fn kernels() {
    let (tree, parameters) = (xu_arm::tree(), xu_arm::parameters());
    let states = xu_arm::states();
    let mut kinematics = Kinematics::new(&tree);
    let mut at = 0;
    let mut next = move || {
        at = (at + 1) % RING;
        at
    };
    let mut dynamics = ForwardDynamics::new(&tree);
    let mut found = [0.0; 6];
    let inputs = TORQUES.map(JointInput::Force);
    let mut forward = |s: &xu_arm::State| {
        kinematics.place(&tree, &s.q);
        kinematics.set_velocities(&tree, &s.v, &s.w, &s.rates);
        dynamics.set_bodies(&tree, &parameters, &kinematics);
        let solved = dynamics.solve(&tree, &kinematics, &s.rates, &inputs, &mut found);
        black_box(solved.is_ok());
        black_box(&mut found)
            .iter()
            .map(|a| a * a)
            .sum::<f64>()
            .sqrt()
    };
    println!(
        "poinsot_joint_acceleration_at_state_1,{:.12e},norm",
        forward(&states[1])
    );
    measure("forward_dynamics", || {
        black_box(forward(black_box(&states[next()])));
    });
    let mut kinematics = Kinematics::new(&tree);
    let mut matrix = MassMatrix::new(&tree);
    measure("mass_matrix", || {
        kinematics.place(&tree, &black_box(&states[next()]).q);
        matrix.set(&tree, &parameters, &kinematics);
        black_box(&mut matrix);
    });
    let mut inverse = InverseDynamics::new(&tree);
    let mut accelerations = Accelerations::new(&tree);
    measure("inverse_dynamics", || {
        let s = black_box(&states[next()]);
        kinematics.place(&tree, &s.q);
        kinematics.set_velocities(&tree, &s.v, &s.w, &s.rates);
        accelerations.set_without_base(&tree, &kinematics, &s.rates, &s.rates);
        accelerations.add_base(&kinematics, &s.v, &s.w);
        let (p, k, a) = (&parameters, &kinematics, &accelerations);
        black_box(inverse.solve(&tree, p, k, a, &[], &mut found));
    });
}

/// Many vehicles side by side: forward dynamics, and one step of 10 ms under the torques of the simulation.
fn batches() {
    let (tree, parameters, rows) = (xu_arm::tree(), xu_arm::parameters(), Rows::new());
    let forces = TORQUES.repeat(BATCH);
    let wrench = vec![0.0; 6 * BATCH];
    let mut found = vec![0.0; 12 * BATCH];
    measure_batch("batch_forward_dynamics", BATCH, || {
        let (states, out) = (states_of(&rows), &mut found);
        let done = batch::forward_dynamics(&tree, &parameters, states, &forces, &wrench, out);
        black_box(done.is_ok());
    });
    let plan = Plan {
        joints: xu_arm::drives(),
        ..Plan::default()
    };
    let motors: Vec<ForceProfile> = plan.joints.iter().filter_map(motor).cloned().collect();
    let vehicle = Vehicle::new(tree.clone(), parameters.clone(), Vec::new(), Vec::new());
    let vehicle = Flight::new(vehicle, &plan, Tolerance::default());
    let Ok(start) = vehicle.and_then(|v| v.state(&xu_arm::start(), 0.0)) else {
        return;
    };
    let mut states = start.repeat(BATCH);
    let steps = batch::Steps {
        start: 0.0,
        step: 0.01,
        count: 1,
    };
    measure_batch("batch_rk4_10ms_step", BATCH, || {
        black_box(batch::integrate(&tree, &parameters, &motors, steps, &mut states).is_ok());
    });
}

/// Sensors on the last body of the arm, with their slopes over the base and six joints.
fn measurements() {
    let tree = xu_arm::tree();
    let place = Vector3::new(0.3, -0.2, 0.1);
    let body = tree.bodies() - 1;
    let pose = BasePose {
        R_NB: UnitQuaternion::from_euler_angles(0.1, 0.2, 0.3),
        p_NoBo_N: Vector3::new(1.0, 2.0, 3.0),
    };
    let one = xu_arm::states();
    let mut kinematics = Kinematics::new(&tree);
    for kind in [
        SensorKind::Gyro,
        SensorKind::Attitude,
        SensorKind::Position,
        SensorKind::Velocity,
        SensorKind::RelativePosition,
    ] {
        let mut at = 0;
        measure(&format!("measure_{}", kind.word()), || {
            at = (at + 1) % RING;
            let s = black_box(&one[at]);
            kinematics.place(&tree, &s.q);
            kinematics.set_velocities(&tree, &s.v, &s.w, &s.rates);
            let scene = Scene {
                pose: &pose,
                point: &PointMotion::new(&kinematics, body, &place),
                from: &PointMotion::new(&kinematics, 0, &Vector3::zeros()),
                reference_N: None,
                a_NP_B: None,
            };
            black_box(kind.measure(&scene));
            for link in 1..=body {
                let effect = JointEffect::new(&tree, &kinematics, link, scene.point);
                black_box(kind.over_joint(&scene, Carried::Point(&effect)));
            }
        });
    }
}

fn motor(joint: &JointDrive) -> Option<&ForceProfile> {
    match joint {
        JointDrive::Force { motor, .. } => Some(motor),
        JointDrive::Motion(_) => None,
    }
}

/// Where the simulation ended, as far as the peers print it.
struct End {
    q: Vec<f64>,
    P: Vector3,
    L: Vector3,
}

fn end(sample: &MotionSample) -> End {
    // Momentum by the definition, not from the state that carries it.
    let motion = sample;
    let R: &UnitQuaternion = &motion.R_NB;
    let m = momentum(&xu_arm::parameters(), &motion.kinematics);
    let whole = composite(&xu_arm::parameters(), &motion.kinematics);
    let (l, h) = (
        Vector3::new(m[0], m[1], m[2]),
        Vector3::new(m[3], m[4], m[5]),
    );
    End {
        q: motion.q.clone(),
        P: R * l,
        L: R * (h - whole.p_BoScm_B().cross(&l)),
    }
}

fn simulate(name: &str, integrator: Integrator) {
    let plan = Plan {
        joints: xu_arm::drives(),
        ..Plan::default()
    };
    let parts = (xu_arm::tree(), xu_arm::parameters());
    let vehicle = Vehicle::new(parts.0, parts.1, Vec::new(), Vec::new());
    let Ok(vehicle) = Flight::new(vehicle, &plan, integrator) else {
        return;
    };
    let run = |seconds: f64, sink: &mut dyn FnMut(&MotionSample)| {
        let done = vehicle.run(&xu_arm::start(), &[0.0, seconds], sink);
        if let Err(error) = done {
            println!("# {name}: {error}");
        }
    };
    if let Ok(count) = std::env::var("POINSOT_BENCH_COUNT") {
        if let (Some((wanted, steps)), Integrator::RungeKutta4(step)) =
            (count.split_once(':'), integrator)
            && wanted == format!("sim_{name}")
        {
            run(steps.parse().unwrap_or(0.0) * step, &mut |_| {});
        }
        return;
    }
    let mut ends = Vec::new();
    run(SECONDS, &mut |sample| ends.push(end(sample)));
    let [first, last] = ends.as_slice() else {
        return;
    };
    let differences = last.q.iter().zip(&xu_arm::JOINTS_AT_20_S);
    let error = differences.fold(0.0, |m: f64, (a, b)| m.max((a - b).abs()));
    let least = (0..REPEATS)
        .map(|_| {
            let start = processor_seconds();
            run(SECONDS, &mut |sample| {
                black_box(sample);
            });
            processor_seconds() - start
        })
        .fold(f64::INFINITY, f64::min);
    println!(
        "poinsot_sim_{name},{:.1},simulated_s_per_s",
        SECONDS / least
    );
    println!("poinsot_sim_{name},{error:.2e},joint_error_rad");
    println!(
        "poinsot_sim_{name},{:.2e},P_drift_N_s",
        (last.P - first.P).norm()
    );
    println!(
        "poinsot_sim_{name},{:.2e},L_drift_N_m_s",
        (last.L - first.L).norm()
    );
}

/// Rows as the kernels take them.
fn states_of(rows: &xu_arm::Rows) -> batch::States<'_> {
    batch::States {
        q: &rows.q,
        rates: &rows.rates,
        twist: &rows.twist,
    }
}
