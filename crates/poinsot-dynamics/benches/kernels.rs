//! The kernels of momentum at changing states of the arm, sines included: `cargo bench` against the
//! last run.

mod xu_arm;

use criterion::{Criterion, criterion_group, criterion_main};
use poinsot_dynamics::{Kinematics, composite, momentum, momentum_regressor};
use std::hint::black_box;
use xu_arm::{COLUMNS, RING};

fn kernels(criterion: &mut Criterion) {
    let tree = xu_arm::tree();
    let parameters = xu_arm::parameters();
    let states = xu_arm::states();
    let mut kinematics = Kinematics::new(&tree);
    let mut regressor = vec![[0.0; 6]; COLUMNS];
    let mut at = 0;
    let mut next = move || {
        at = (at + 1) % RING;
        at
    };
    criterion.bench_function("momentum_regressor", |b| {
        b.iter(|| {
            let s = &states[next()];
            kinematics.place(&tree, &s.q);
            kinematics.set_velocities(&tree, &s.v, &s.w, &s.rates);
            momentum_regressor(&kinematics, &mut regressor);
            black_box(&mut regressor);
        });
    });
    criterion.bench_function("momentum", |b| {
        b.iter(|| {
            let s = &states[next()];
            kinematics.place(&tree, &s.q);
            kinematics.set_velocities(&tree, &s.v, &s.w, &s.rates);
            momentum(&parameters, &kinematics)
        });
    });
    criterion.bench_function("composite", |b| {
        b.iter(|| {
            kinematics.place(&tree, &states[next()].q);
            composite(&parameters, &kinematics)
        });
    });
}

criterion_group!(benches, kernels);
criterion_main!(benches);
