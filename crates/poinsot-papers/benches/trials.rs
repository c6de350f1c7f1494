//! Noisy trials of both steps of Ma et al. (2008): ten samples, momentum known.
//!
//! Prints `name,value,unit`: least time of a trial, drawing of the noise included, and the median mass.
#![allow(non_snake_case)]

use poinsot_papers::ma2008::{Arm, Known, Reading, Trials};
use poinsot_spatial::{Matrix3, UnitQuaternion, Vector3, parallel_axis};
use std::time::Instant;

/// Samples, as in the paper.
const SAMPLES: u32 = 10;
/// Mass of base and arm, kg.
const BASE: f64 = 1000.0;
const ARM: f64 = 93.184;
/// Inertia of the base about its mass centre and origin, kg m2.
const INERTIA: f64 = 166.67;
/// Noise relative to the velocities of these samples.
const NOISE: f64 = 0.01;
/// Groups of eight trials between two readings of the clock, and how often.
const GROUPS: u64 = 125;
const REPEATS: u64 = 400;

/// The sample at a time between 0 and 1. The arm does not move relative to the base: the time of a trial is the same.
fn sample(t: f64, known: &Known) -> Reading {
    let turn = UnitQuaternion::from_scaled_axis(Vector3::new(0.3 * t, -0.2 * t, 0.5 * t));
    let rho_R = Vector3::new(
        0.5 + 0.6 * (4.0 * t).sin(),
        0.6 * (5.0 * t).cos(),
        0.7 + 0.6 * t * (3.0 * t).sin(),
    );
    let I_R = Matrix3::from_diagonal(&Vector3::new(
        12.0 + 8.0 * (3.0 * t).sin(),
        15.0 + 6.0 * (2.0 * t).cos(),
        9.0 + 5.0 * t,
    ));
    let reduced = BASE * ARM / (BASE + ARM);
    let I = Matrix3::from_diagonal_element(INERTIA) + I_R + parallel_axis(reduced, &rho_R);
    let inverse = I.try_inverse().unwrap_or_else(Matrix3::zeros);
    let w_NB_B = inverse * (turn.inverse() * known.h_C_N);
    let p = turn.inverse() * known.p_C_N;
    Reading {
        R_NB: *turn.to_rotation_matrix().matrix(),
        v_NBo_B: (p - w_NB_B.cross(&rho_R) * ARM) / (BASE + ARM),
        w_NB_B,
        arm: Arm {
            mass: ARM,
            rho_R,
            I_R,
            u: Vector3::zeros(),
            h_R: Vector3::zeros(),
        },
    }
}

fn main() {
    let known = Known {
        p_C_N: Vector3::new(5.5, -3.3, 2.2),
        h_C_N: Vector3::new(2.0, 4.0, 20.0),
    };
    let time = |k: u32| f64::from(k) / f64::from(SAMPLES - 1);
    let samples: Vec<Reading> = (0..SAMPLES).map(|k| sample(time(k), &known)).collect();
    let largest =
        |of: fn(&Reading) -> Vector3| samples.iter().map(|s| of(s).amax()).fold(0.0, f64::max);
    let (v, w) = (largest(|s| s.v_NBo_B), largest(|s| s.w_NB_B));
    let trials = Trials::new(&samples, Some(known), [NOISE * v; 3], [NOISE * w; 3]);
    let mut masses = Vec::new();
    let mut least = f64::INFINITY;
    for repeat in 0..REPEATS {
        let start = Instant::now();
        let first = repeat * GROUPS;
        trials.run(1, first..first + GROUPS, |group| masses.push(group[0]));
        let count = 8 * GROUPS;
        least = least.min(start.elapsed().as_secs_f64() / count as f64);
    }
    let masses = masses.as_flattened_mut();
    masses.sort_by(f64::total_cmp);
    println!("poinsot_trial_two_steps,{:.1},ns_min", 1.0e9 * least);
    println!(
        "poinsot_trial_median_mass,{:.3},kg",
        masses[masses.len() / 2]
    );
}
