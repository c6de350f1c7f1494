//! Sec. 5.6: (63)-(75) as printed, and the sensitivity of candidate paths of each joint.

use super::robot::{ARM, Robot};
use crate::study::statistics::{Normals, largest};
use crate::study::{Context, Digits, Findings, StudyError, Table};
use crate::xu2017::sensitivity::{
    mass_coefficient, path_sensitivity, tensor_bounds, tensor_coefficients,
};
use nalgebra::Quaternion;
use poinsot_dynamics::{Kinematics, Tree};
use poinsot_spatial::{Matrix3, UnitQuaternion, Vector3, Vector6};

/// The paper's largest angular rate of the base, rad/s (74).
pub const RATE: f64 = 0.03;
/// Random draws of attitude and direction of the rate.
const DRAWS: usize = 200_000;
const COLUMNS: &str = " | xx :.4 | xy :.4 | xz :.4 | yy :.4 | yz :.4 | zz :.4";

/// Maximum of each of the eighteen coefficients, row by row, over random attitudes and rate directions.
pub fn largest_coefficients(rate: f64, draws: usize) -> [[f64; 6]; 3] {
    let mut normals = Normals::new(75, 0);
    let mut most = [[0.0_f64; 6]; 3];
    for _ in 0..draws {
        let (v, w) = (normals.vector(), normals.number());
        let q = UnitQuaternion::new_normalize(Quaternion::from_parts(w, v));
        let A = q.to_rotation_matrix().into_inner();
        let K = tensor_coefficients(&A, &(normals.vector().normalize() * rate));
        for (i, row) in most.iter_mut().enumerate() {
            for (k, m) in row.iter_mut().enumerate() {
                *m = m.max(K[(i, k)].abs());
            }
        }
    }
    most
}

/// Relative difference between `K` times the elements and `A I A^T w`.
fn difference(A: &Matrix3, w: &Vector3, I: &Matrix3) -> f64 {
    let elements = [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)].map(|e| I[e]);
    let K = tensor_coefficients(A, w) * Vector6::from(elements);
    let L = A * I * A.transpose() * w;
    (K - L).norm() / L.norm().max(f64::MIN_POSITIVE)
}

/// (63)-(75) for the runs, and how tight the bounds (75) are.
pub fn coefficients(context: &Context) -> Result<Findings, StudyError> {
    let robot = Robot::new(context)?;
    let title = format!(
        "(75) at {RATE} rad/s: bound, and largest of {DRAWS} random attitudes and directions"
    );
    let mut bounds = Table::new("bounds", title, COLUMNS);
    bounds.row("bound (75)", tensor_bounds(RATE));
    let most = largest_coefficients(RATE, DRAWS);
    for (axis, row) in ["dL_x", "dL_y", "dL_z"].into_iter().zip(most) {
        bounds.row(axis, row);
    }
    let title = "Along C2 to C7: rate, rad/s; |dP/dm0| as corrected, |v0 - v1|, and as (68) prints, |v0|, m/s";
    let head = "joint | largest rate :.5 | corrected | printed";
    let mut runs = Table::new("runs", title, head);
    let (mut wrong, mut fastest): (f64, f64) = (0.0, 0.0);
    for (joint, name) in ARM.into_iter().enumerate() {
        let d = robot.data(&[name])?;
        let s = &d.segments[0].samples;
        let translation = s.translation.as_ref().ok_or("the run has no velocity")?;
        let dof = d.tree.dof();
        let mut kinematics = Kinematics::new(&d.tree);
        let (mut rate, mut corrected, mut printed): (f64, f64, f64) = (0.0, 0.0, 0.0);
        for k in 0..s.time_s.len() {
            let at = k * dof..(k + 1) * dof;
            let v = s.R_NB[k].inverse() * translation.v_NBo_N[k];
            kinematics.place(&d.tree, &s.joint_position[at.clone()]);
            kinematics.set_velocities(&d.tree, &v, &s.w_NB_B[k], &s.joint_rate[at]);
            // Velocities of the mass centres of both sides.
            let mut sides = [(0.0, Vector3::zeros()); 2];
            for (b, body) in robot.truth.iter().enumerate() {
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
            if w.norm() > 0.1 * rate {
                wrong = wrong.max(difference(&A, &w, &robot.properties()[0].I_BBcm_B));
            }
        }
        fastest = fastest.max(corrected);
        runs.row(format!("{}", joint + 1), [rate, corrected, printed]);
    }
    let mut findings = Findings::of([bounds, runs]);
    let text = format!("{} m/s at most", Digits::Figures(2).text(fastest));
    findings.state("(63)-(68) sensitivity of the mass", text);
    let text = format!("{wrong:.0e} from A I A^T w");
    findings.state("(69)-(73) sensitivity of the tensor", text);
    let products = largest([most[0][1], most[1][1], most[2][1]]);
    let text = format!("{products:.4} for {:.2}", tensor_bounds(RATE)[1]);
    findings.state("(74), (75) bounds", text);
    Ok(findings)
}

/// Candidate paths: amplitude, deg, and period, s. The second is close to the paper's.
const PATHS: [(f64, f64); 5] = [
    (15.0, 60.0),
    (30.0, 60.0),
    (30.0, 30.0),
    (60.0, 60.0),
    (90.0, 60.0),
];
const SAMPLES: u32 = 600;

/// Angle and rate over one period of a sine.
fn path(degrees: f64, period: f64) -> Vec<(f64, f64)> {
    let (a, w) = (degrees.to_radians(), std::f64::consts::TAU / period);
    let at = |k| {
        let t = period * f64::from(k) / f64::from(SAMPLES);
        (a * (w * t).sin(), a * w * (w * t).cos())
    };
    (0..SAMPLES).map(at).collect()
}

/// Sensitivity of candidate paths of each joint, and the best one.
pub fn paths(context: &Context) -> Result<Findings, StudyError> {
    let robot = Robot::new(context)?;
    let tree = Tree::new(&robot.model);
    let bodies = robot.model.nominal_parameters();
    let normal = vec![0.0; tree.dof()];
    let titles = PATHS.map(|(angle, period)| format!("+-{angle} deg in {period} s"));
    let title = format!(
        "Weakest of the seven directions that a joint shows, N s or N m s per natural unit, {SAMPLES} samples"
    );
    let head = format!("joint | {}", titles.join(" | "));
    let mut weakest = Table::new("weakest", title, &head);
    for joint in 0..tree.dof() {
        let score = |(angle, period)| {
            let found = path_sensitivity(&tree, &bodies, &normal, joint, &path(angle, period));
            found.and_then(|s| s.last().copied()).unwrap_or(f64::NAN)
        };
        weakest.row(format!("{}", joint + 1), PATHS.map(score));
    }
    let near_paper = || (0..tree.dof()).map(|joint| weakest.at(joint, 2));
    let least = near_paper().fold(f64::INFINITY, f64::min);
    let [low, high] = [least, largest(near_paper())].map(|x| Digits::Figures(2).text(x));
    let mut findings = Findings::of([weakest]);
    findings.state("sensitivity chooses the path", format!("{low} to {high}"));
    Ok(findings)
}
