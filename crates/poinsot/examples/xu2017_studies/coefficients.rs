//! Sec. 5.6 as printed: (63)-(75) along the runs, and how tight the bounds (75) are.

use crate::setup::{data, truth};
use poinsot_dynamics::Kinematics;
use poinsot_papers::xu2017::sensitivity::{mass_coefficient, tensor_bounds, tensor_coefficients};
use poinsot_spatial::{UnitQuaternion, Vector3};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal};

/// The paper's largest angular rate of the base, rad/s (74).
pub const RATE: f64 = 0.03;
/// Draws of attitude and direction of the rate.
const DRAWS: usize = 200_000;
const COLUMNS: [&str; 6] = ["xx", "xy", "xz", "yy", "yz", "zz"];

/// Largest of each of the eighteen coefficients, row by row, over random attitudes and directions.
pub fn largest(rate: f64, draws: usize) -> [[f64; 6]; 3] {
    let mut rng = ChaCha8Rng::seed_from_u64(75);
    let mut normal = || -> f64 { StandardNormal.sample(&mut rng) };
    let mut most = [[0.0_f64; 6]; 3];
    for _ in 0..draws {
        let q = nalgebra::Quaternion::new(normal(), normal(), normal(), normal());
        let A = UnitQuaternion::new_normalize(q)
            .to_rotation_matrix()
            .into_inner();
        let w = Vector3::new(normal(), normal(), normal()).normalize() * rate;
        let K = tensor_coefficients(&A, &w);
        for (i, row) in most.iter_mut().enumerate() {
            for (k, m) in row.iter_mut().enumerate() {
                *m = m.max(K[(i, k)].abs());
            }
        }
    }
    most
}

fn row(name: &str, values: [f64; 6]) {
    let cells: Vec<String> = values.iter().map(|x| format!("{x:9.5}")).collect();
    println!("  {name:28}{}", cells.join(""));
}

pub fn run() {
    println!("(75): largest coefficient of each element of the base's tensor, rate {RATE} rad/s");
    println!(
        "  {:28}{}",
        "element",
        COLUMNS.map(|c| format!("{c:>9}")).join("")
    );
    row("bound (75)", tensor_bounds(RATE));
    let most = largest(RATE, DRAWS);
    for (axis, most) in ["x", "y", "z"].into_iter().zip(most) {
        row(&format!("largest of {DRAWS}, dL_{axis}"), most);
    }
    println!(
        "along the runs: largest rate, |dP/dm0| = |v0 - v1| as corrected and |v0| as (68) prints, largest coefficients (73)"
    );
    let names = ["C2", "C3", "C4", "C5", "C6", "C7"];
    for (joint, name) in names.into_iter().enumerate() {
        let d = data(&[name]);
        let s = &d.bound.segments[0].samples;
        let Some(translation) = &s.translation else {
            continue;
        };
        let dof = d.tree.dof();
        let bodies = truth();
        let mut kinematics = Kinematics::new(&d.tree);
        let (mut rate, mut corrected, mut printed) = (0.0_f64, 0.0_f64, 0.0_f64);
        let mut most = [0.0_f64; 6];
        for k in 0..s.time_s.len() {
            let at = k * dof..(k + 1) * dof;
            let v = s.R_NB[k].inverse() * translation.v_NBo_N[k];
            kinematics.place(&d.tree, &s.joint_position[at.clone()]);
            kinematics.set_velocities(&d.tree, &v, &s.w_NB_B[k], &s.joint_rate[at]);
            // Velocities of the mass centres of both sides.
            let mut sides = [(0.0, Vector3::zeros()); 2];
            for (b, body) in bodies.iter().enumerate() {
                let side = &mut sides[usize::from(b > joint)];
                let r = kinematics.R[b] * body.mc_B;
                side.0 += body.mass;
                side.1 += kinematics.v[b] * body.mass + kinematics.w[b].cross(&r);
            }
            let [v0, v1] = sides.map(|(m, p)| p / m);
            corrected = corrected.max(mass_coefficient(&v0, &v1).norm());
            printed = printed.max(v0.norm());
            let A = s.R_NB[k].to_rotation_matrix().into_inner();
            let w = A * s.w_NB_B[k];
            rate = rate.max(w.norm());
            let K = tensor_coefficients(&A, &w);
            for (c, m) in most.iter_mut().enumerate() {
                *m = m.max(K.column(c).amax());
            }
        }
        println!(
            "  joint {}: rate {rate:.5} rad/s, {corrected:.2e} and {printed:.2e} m/s",
            joint + 1
        );
        row("", most);
    }
}
