//! Rows into a triangle: 1,000 samples of six rows, 71 columns each, shaped like the momentum regressor of a six-joint
//! arm: the three linear rows are zero in the six inertia columns of each body.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use poinsot_solve::BlockQr;

const SAMPLES: usize = 1000;
/// Different samples in memory, used in turn.
const RING: usize = 64;
/// Ten parameters of seven bodies, and the right-hand side.
const COLUMNS: usize = 71;

/// Column of one sample: four of ten unknowns of a body show in linear momentum, all in angular momentum.
fn column(k: usize, j: usize) -> [f64; 6] {
    let linear = j % 10 < 4;
    std::array::from_fn(|r| {
        let shown = r >= 3 || linear;
        f64::from(shown) * ((k * 61 + r * 17 + j * 29 + k * j * 7) as f64).sin()
    })
}

fn block_qr(criterion: &mut Criterion) {
    let samples: Vec<Vec<[f64; 6]>> = (0..RING)
        .map(|k| (0..COLUMNS).map(|j| column(k, j)).collect())
        .collect();
    let mut group = criterion.benchmark_group("block_qr");
    group.throughput(Throughput::Elements(SAMPLES as u64));
    group.sample_size(20);
    group.bench_function("1000_samples_x_71", |b| {
        b.iter(|| {
            let mut qr = BlockQr::new(COLUMNS);
            for k in 0..SAMPLES {
                qr.push_six(&samples[k % RING]);
            }
            qr.finish()
        });
    });
    group.finish();
}

criterion_group!(benches, block_qr);
criterion_main!(benches);
