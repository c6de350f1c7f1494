//! Rows into a triangle: 1,000 samples of the arm, six rows of 71 columns each, regressors ready made.

#[path = "../../poinsot-dynamics/benches/xu_arm/mod.rs"]
mod xu_arm;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use poinsot_dynamics::{Kinematics, momentum_regressor};
use poinsot_identify::BlockQr;
use xu_arm::{COLUMNS, RING};

const SAMPLES: usize = 1000;

fn block_qr(criterion: &mut Criterion) {
    let tree = xu_arm::tree();
    let mut kinematics = Kinematics::new(&tree);
    let regressors: Vec<Vec<[f64; 6]>> = xu_arm::states()
        .iter()
        .map(|s| {
            let mut columns = vec![[1.0; 6]; COLUMNS + 1];
            kinematics.place(&tree, &s.q);
            kinematics.set_velocities(&tree, &s.v, &s.w, &s.rates);
            momentum_regressor(&kinematics, &mut columns);
            columns
        })
        .collect();
    let mut group = criterion.benchmark_group("block_qr");
    group.throughput(Throughput::Elements(SAMPLES as u64));
    group.sample_size(20);
    group.bench_function("1000_samples_x_71", |b| {
        b.iter(|| {
            let mut qr = BlockQr::new(COLUMNS + 1);
            for k in 0..SAMPLES {
                qr.push_six(&regressors[k % RING]);
            }
            qr.finish()
        });
    });
    group.finish();
}

criterion_group!(benches, block_qr);
criterion_main!(benches);
