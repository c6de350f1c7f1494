//! Linear identification at full length: for every sample the momentum regressor of the arm, six rows
//! folded into a triangle, then the rank, the base columns and the solution from the triangle alone.
//!
//! Prints `name,value,unit`. Arguments: number of samples (10^6), number of threads (1). States come
//! from a stream of cheap random numbers inside the timed part, so no data set is ever held.
#![allow(non_snake_case)]

#[path = "../../poinsot-dynamics/benches/xu_arm/mod.rs"]
mod xu_arm;

use faer::Mat;
use poinsot_dynamics::{Kinematics, Tree, momentum_regressor};
use poinsot_solve::{BlockQr, Triangle};
use rayon::prelude::*;
use std::time::Instant;
use xu_arm::{COLUMNS, Stream};

/// Samples of one task: fixed, so that the answer has the same bits on any number of threads.
const CHUNK: usize = 8192;
/// Tasks in flight: bounds the memory.
const WAVE: usize = 16;
/// Noise of the six momentum rows.
const SIGMA: f64 = 1.0e-4;

fn main() {
    let mut numbers = std::env::args().filter_map(|a| a.parse::<usize>().ok());
    let samples = numbers.next().unwrap_or(1_000_000);
    let threads = numbers.next().unwrap_or(1);
    let Ok(pool) = rayon::ThreadPoolBuilder::new().num_threads(threads).build() else {
        return eprintln!("no threads");
    };
    let tree = xu_arm::tree();
    let truth: Vec<f64> = xu_arm::parameters()
        .iter()
        .flat_map(|p| p.to_array())
        .collect();
    let start = Instant::now();
    let triangle = pool.install(|| reduce(&tree, &truth, samples));
    let reduced = start.elapsed().as_secs_f64();
    let base = base_columns(&triangle);
    let x = solve(&triangle, &base);
    let total = start.elapsed().as_secs_f64();
    let name = format!("poinsot_least_squares_{samples}_samples_{threads}_threads");
    println!("{name},{total:.3},s");
    println!("{name}_rows_and_qr,{reduced:.3},s");
    if let Some(cpu) = processor_seconds() {
        println!("{name}_processor,{cpu:.2},s");
    }
    println!("{name}_base_columns,{},columns", base.len());
    println!("{name}_residual_rms,{:.4e},N s", rms(&triangle, &base, &x));
    println!("{name}_checksum,{:016x},bits", checksum(&triangle));
    if let Some(kib) = peak_memory_kib() {
        println!("{name}_peak_memory,{:.1},MiB", kib / 1024.0);
    }
}

fn reduce(tree: &Tree, truth: &[f64], samples: usize) -> Triangle {
    let chunks: Vec<usize> = (0..samples).step_by(CHUNK).collect();
    let mut total = BlockQr::new(COLUMNS + 1);
    for wave in chunks.chunks(WAVE) {
        let triangles: Vec<Triangle> = wave
            .par_iter()
            .map(|&from| chunk(tree, truth, from, (from + CHUNK).min(samples)))
            .collect();
        for triangle in &triangles {
            total.merge(triangle);
        }
    }
    total.finish()
}

fn chunk(tree: &Tree, truth: &[f64], from: usize, to: usize) -> Triangle {
    let mut stream = Stream(from as u64);
    let mut kinematics = Kinematics::new(tree);
    let mut rows = vec![[0.0; 6]; COLUMNS + 1];
    let mut qr = BlockQr::new(COLUMNS + 1);
    for _ in from..to {
        let s = stream.state();
        kinematics.place(tree, &s.q);
        kinematics.set_velocities(tree, &s.v, &s.w, &s.rates);
        momentum_regressor(&kinematics, &mut rows);
        let mut rhs = [(); 6].map(|()| SIGMA * 3.0_f64.sqrt() * stream.number());
        for (column, pi) in rows.iter().zip(truth) {
            for (sum, y) in rhs.iter_mut().zip(column) {
                *sum += y * pi;
            }
        }
        rows[COLUMNS] = rhs;
        qr.push_six(&rows);
    }
    qr.finish()
}

/// Columns that span all others, by QR with column pivoting of the triangle.
fn base_columns(triangle: &Triangle) -> Vec<usize> {
    let R = triangle.r.as_ref().submatrix(0, 0, COLUMNS, COLUMNS);
    let qr = R.col_piv_qr();
    let diagonal = qr.thin_R();
    let floor = 1.0e-9 * diagonal[(0, 0)].abs();
    let rank = (0..COLUMNS)
        .filter(|&k| diagonal[(k, k)].abs() > floor)
        .count();
    let (order, _) = qr.P().arrays();
    order[..rank].to_vec()
}

/// Least squares over the base columns: the triangle of their columns and the right-hand side.
fn solve(triangle: &Triangle, base: &[usize]) -> Vec<f64> {
    let n = base.len();
    let mut qr = BlockQr::new(n + 1);
    qr.push(COLUMNS + 1, |i, j| {
        triangle.r[(i, base.get(j).copied().unwrap_or(COLUMNS))]
    });
    let small: Mat<f64> = qr.finish().r;
    let mut x = vec![0.0; n];
    for i in (0..n).rev() {
        let known: f64 = (i + 1..n).map(|j| small[(i, j)] * x[j]).sum();
        x[i] = (small[(i, n)] - known) / small[(i, i)];
    }
    x
}

fn rms(triangle: &Triangle, base: &[usize], x: &[f64]) -> f64 {
    let sum: f64 = (0..=COLUMNS)
        .map(|i| {
            let model: f64 = base
                .iter()
                .zip(x)
                .map(|(&j, x)| triangle.r[(i, j)] * x)
                .sum();
            (triangle.r[(i, COLUMNS)] - model).powi(2)
        })
        .sum();
    (sum / triangle.rows as f64).sqrt()
}

/// All bits of the triangle in one number: equal on any number of threads.
fn checksum(triangle: &Triangle) -> u64 {
    let mut sum = 0_u64;
    for j in 0..=COLUMNS {
        for i in 0..=j {
            sum = sum.rotate_left(7) ^ triangle.r[(i, j)].to_bits();
        }
    }
    sum
}

/// Processor time of this process so far, all threads (Linux only): on a shared machine the honest figure.
fn processor_seconds() -> Option<f64> {
    let stat = std::fs::read_to_string("/proc/self/stat").ok()?;
    // Fields 14 and 15, in hundredths of a second; the name in field 2 may hold blanks.
    let fields: Vec<&str> = stat.rsplit(')').next()?.split_whitespace().collect();
    let ticks = fields.get(11)?.parse::<f64>().ok()? + fields.get(12)?.parse::<f64>().ok()?;
    Some(ticks / 100.0)
}

/// Largest resident memory of this process so far (Linux only).
fn peak_memory_kib() -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|l| l.starts_with("VmHWM:"))?;
    line.split_whitespace().nth(1)?.parse().ok()
}
