//! Least time of many short batches, one line `name,value,unit` per kernel: the figure to set against
//! a peer, because the least is what another user of the machine disturbs least.
//!
//! `POINSOT_BENCH_COUNT=<name>:<calls>` runs one kernel a fixed number of times instead, for
//! instruction counters.
#![allow(non_snake_case)]

mod xu_arm;

use poinsot_dynamics::{
    ForwardDynamics, JointInput, Kinematics, Tree, composite, momentum, momentum_regressor,
};
use poinsot_spatial::{InertialParameters, Vector6};
use std::hint::black_box;
use std::time::Instant;
use xu_arm::{COLUMNS, RING, State};

/// Batches per kernel and calls per batch.
const BATCHES: usize = 400;
const CALLS: usize = 4096;

fn main() {
    let tree = xu_arm::tree();
    let parameters = xu_arm::parameters();
    let states = xu_arm::states();
    let mut kinematics = Kinematics::new(&tree);
    let mut Y = vec![[0.0; 6]; COLUMNS];
    let mut at = 0;
    let mut next = move || {
        at = (at + 1) % RING;
        at
    };
    check(&tree, &parameters, &states[1]);
    measure("momentum_regressor_6x70", || {
        let s = black_box(&states[next()]);
        kinematics.place(&tree, &s.q);
        kinematics.set_velocities(&tree, &s.v, &s.w, &s.rates);
        momentum_regressor(&kinematics, &mut Y);
        black_box(&mut Y);
    });
    measure("kinematics", || {
        let s = black_box(&states[next()]);
        kinematics.place(&tree, &s.q);
        kinematics.set_velocities(&tree, &s.v, &s.w, &s.rates);
        black_box(&mut kinematics);
    });
    measure("place", || {
        let s = black_box(&states[next()]);
        kinematics.place(&tree, &s.q);
        black_box(&mut kinematics);
    });
    measure("sines_of_6_joints", || {
        let s = black_box(&states[next()]);
        black_box(s.q.map(f64::sin_cos));
    });
    measure("regressor_alone", || {
        momentum_regressor(black_box(&kinematics), &mut Y);
        black_box(&mut Y);
    });
    measure("momentum", || {
        let s = black_box(&states[next()]);
        kinematics.place(&tree, &s.q);
        kinematics.set_velocities(&tree, &s.v, &s.w, &s.rates);
        black_box(momentum(&parameters, &kinematics));
    });
    let mut dynamics = ForwardDynamics::new(&tree);
    let mut found = [0.0; 6];
    let inputs = [1.0, -0.8, 0.6, 0.1, -0.05, 0.02].map(JointInput::Force);
    measure("forward_dynamics", || {
        let s = black_box(&states[next()]);
        kinematics.place(&tree, &s.q);
        kinematics.set_velocities(&tree, &s.v, &s.w, &s.rates);
        dynamics.set_bodies(&tree, &parameters, &kinematics);
        let _ = dynamics.solve(&tree, &kinematics, &s.rates, &inputs, &mut found);
        black_box(&mut found);
    });
    measure("composite", || {
        let s = black_box(&states[next()]);
        kinematics.place(&tree, &s.q);
        black_box(composite(&parameters, &kinematics));
    });
}

/// Prints the size of the momentum at one state: the peer prints the same number.
fn check(tree: &Tree, parameters: &[InertialParameters], state: &State) {
    let mut kinematics = Kinematics::new(tree);
    let mut Y = vec![[0.0; 6]; COLUMNS];
    kinematics.place(tree, &state.q);
    kinematics.set_velocities(tree, &state.v, &state.w, &state.rates);
    momentum_regressor(&kinematics, &mut Y);
    let pi = parameters.iter().flat_map(|p| p.to_array());
    let sum: Vector6 = Y.iter().zip(pi).map(|(y, p)| Vector6::from(*y) * p).sum();
    println!("poinsot_momentum_at_state_1,{:.12e},norm", sum.norm());
}

fn measure(name: &str, mut kernel: impl FnMut()) {
    if let Ok(count) = std::env::var("POINSOT_BENCH_COUNT") {
        if let Some((wanted, calls)) = count.split_once(':')
            && wanted == name
        {
            for _ in 0..calls.parse().unwrap_or(0) {
                kernel();
            }
        }
        return;
    }
    let mut times: Vec<f64> = (0..BATCHES)
        .map(|_| {
            let start = Instant::now();
            for _ in 0..CALLS {
                kernel();
            }
            start.elapsed().as_secs_f64() / CALLS as f64 * 1e9
        })
        .collect();
    times.sort_by(f64::total_cmp);
    println!("poinsot_{name},{:.1},ns_min", times[0]);
    println!("poinsot_{name},{:.1},ns_median", times[BATCHES / 2]);
}
