//! Least time of many short batches, one line `name,value,unit` per kernel: the figure to set against
//! a peer, because the least is what another user of the machine disturbs least.
//!
//! `POINSOT_BENCH_COUNT=<name>:<calls>` runs one kernel a fixed number of times instead, for
//! instruction counters.
#![allow(non_snake_case)]

mod least_time;
mod xu_arm;

use least_time::{measure, measure_batch};
use poinsot_dynamics::{Kinematics, Tree, batch, composite, momentum, momentum_regressor};
use poinsot_spatial::{InertialParameters, Vector6};
use std::hint::black_box;
use xu_arm::{BATCH, COLUMNS, RING, Rows, State};

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
    measure("composite", || {
        let s = black_box(&states[next()]);
        kinematics.place(&tree, &s.q);
        black_box(composite(&parameters, &kinematics));
    });
    batches(&tree, &parameters);
}

/// Many states side by side, into memory that is used again.
fn batches(tree: &Tree, parameters: &[InertialParameters]) {
    let rows = Rows::new();
    let mut Y = vec![0.0; BATCH * COLUMNS * 6];
    measure_batch("batch_momentum_regressor_6x70", BATCH, || {
        black_box(batch::momentum_regressor(tree, states_of(&rows), &mut Y).is_ok());
    });
    let mut out = vec![0.0; BATCH * 6];
    measure_batch("batch_momentum", BATCH, || {
        black_box(batch::momentum(tree, parameters, states_of(&rows), &mut out).is_ok());
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

/// Rows as the kernels take them.
fn states_of(rows: &xu_arm::Rows) -> batch::States<'_> {
    batch::States {
        q: &rows.q,
        rates: &rows.rates,
        twist: &rows.twist,
    }
}
