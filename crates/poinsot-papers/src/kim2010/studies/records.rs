//! Numbers printed in the paper, its slew, simulated from its case without noise, and noisy records of it.

use crate::kim2010::{Manoeuvre, StartRate, Sums, wheel_momentum};
use crate::study::statistics::Normals;
use crate::study::{Context, StudyError};
use nalgebra::Quaternion;
use poinsot_files::Faults;
use poinsot_spatial::{Matrix3, Matrix6, UnitQuaternion, Vector3, Vector6};

/// Columns of Table 2, by variant.
pub const COLUMNS: [&str; 4] = ["batch", "conventional", "pre-estimate", "suggested"];
/// Table 2, kg m2; elements in the order xx, yy, zz, xy, yz, zx.
pub const PRINTED: [[f64; 6]; 4] = [
    [4.2859, 7.1157, 6.1224, 4.8224, 6.1667, 6.2786],
    [14.1181, 17.5350, 20.6816, 16.3578, 19.1201, 17.4000],
    [14.1181, 17.5350, 20.6816, -0.0019, 0.0062, 0.0589],
    [14.1181, 17.5350, 20.6816, 0.1197, 0.1538, 0.1560],
];
/// Table 1: the tensor in the same order, kg m2.
pub const TRUE: [f64; 6] = [13.916, 16.954, 19.894, 0.085, 0.5896, 0.133];
/// Table 1: gyro noise, rad/s.
const SIGMA: f64 = 1.0e-4;
/// Rows per second of the record.
pub const RATE: usize = 10;
/// Length of the longest record, s.
const LENGTH: usize = 600;
/// Number of noisy records.
pub const SEEDS: u64 = 200;
/// Length of the paper's record, s, and the row step to 1 Hz, for noise-free tables.
pub const PAPER: (usize, usize) = (350, 10);

/// A noise-free record.
pub struct Slew {
    /// Times, s.
    pub time: Vec<f64>,
    /// Attitude.
    pub R_NB: Vec<UnitQuaternion>,
    /// Rates, rad/s.
    pub w: Vec<Vector3>,
    /// Momentum of the wheels, N m s.
    pub h: Vec<Vector3>,
    /// Torque of the controller on the body, N m (17).
    pub u: Vec<Vector3>,
    /// The tensor, kg m2.
    pub I: Matrix3,
}

impl Slew {
    /// Simulates the case of the paper.
    pub fn of(context: &Context) -> Result<Self, StudyError> {
        let case = context.case("stsat3_kim2010.toml")?.with(&[
            ("duration_s = 350.0", &format!("duration_s = {LENGTH}")),
            ("sensors_only = true", "sensors_only = false"),
        ]);
        let mut model = context.tools.vehicle(&case)?;
        model.sensors.clear();
        let table = context.tools.simulate(&case, &model, 0)?;
        let column = |name: &str| {
            let channel = table.channel(name).map(|c| c.values.clone());
            channel.ok_or_else(|| format!("the simulation has no channel {name}"))
        };
        let three = |names: [&str; 3]| -> Result<Vec<Vector3>, StudyError> {
            let [x, y, z] = [column(names[0])?, column(names[1])?, column(names[2])?];
            let row = |k: usize| Vector3::new(x[k], y[k], z[k]);
            Ok((0..x.len()).map(row).collect())
        };
        let (vector, scalar) = (three(["q_x", "q_y", "q_z"])?, column("q_w")?);
        let quaternion = |k: usize| Quaternion::from_parts(scalar[k], vector[k]);
        let attitude = |k| UnitQuaternion::new_normalize(quaternion(k));
        let R_NB: Vec<UnitQuaternion> = (0..vector.len()).map(attitude).collect();
        let w = three(["omega_x", "omega_y", "omega_z"])?;
        let speed = three(["wheel1_rad_s", "wheel2_rad_s", "wheel3_rad_s"])?;
        let axes: Vec<Vector3> = model.wheels.iter().map(|w| w.axis_B).collect();
        let spin: Vec<f64> = model.wheels.iter().map(|w| w.spin_inertia).collect();
        let momentum = |s: &Vector3| wheel_momentum(&axes, &spin, s.as_slice());
        let I = model.bodies[0].nominal.I_BBcm_B;
        // Table 1: natural frequency, rad/s, and damping of the controller.
        let (wn, zeta) = (0.043, 0.707);
        let law = |(q, w): (&UnitQuaternion, &Vector3)| {
            -(I * q.imag()) * (2.0 * wn * wn) - (I * w) * (2.0 * zeta * wn)
        };
        Ok(Self {
            time: (0..w.len()).map(|k| k as f64 / RATE as f64).collect(),
            u: R_NB.iter().zip(&w).map(law).collect(),
            h: speed.iter().map(momentum).collect(),
            R_NB,
            w,
            I,
        })
    }

    /// Axis of the slew.
    pub fn normal(&self) -> Vector3 {
        self.R_NB[0].axis().map_or(self.w[0], |a| a.into_inner())
    }

    /// The sums of the paper's estimators over the first `seconds`, every `step`-th row; `noise` (one vector per
    /// sample) is added to the rates.
    pub fn sums(&self, seconds: usize, step: usize, noise: &[Vector3]) -> Result<Sums, Faults> {
        let rows = || (0..=seconds * RATE).step_by(step);
        let zero = Vector3::zeros();
        let noisy = |(k, i): (usize, usize)| self.w[i] + noise.get(k).unwrap_or(&zero);
        let w: Vec<Vector3> = rows().enumerate().map(noisy).collect();
        let R: Vec<UnitQuaternion> = rows().map(|i| self.R_NB[i]).collect();
        let h: Vec<Vector3> = rows().map(|i| self.h[i]).collect();
        Sums::of(&[Manoeuvre {
            R_NB: &R,
            w_NB_B: &w,
            h_W_B: &h,
            start: StartRate::Rest,
        }])
    }

    /// The sums of every noisy record for each length at one rate; longer records extend shorter ones.
    pub fn noisy(&self, step: usize, lengths: &[usize]) -> Result<Vec<Vec<Sums>>, Faults> {
        let longest = lengths.iter().max().copied().unwrap_or(0) * RATE / step + 1;
        let mut all: Vec<Vec<Sums>> = lengths.iter().map(|_| Vec::new()).collect();
        for seed in 0..SEEDS {
            let noise = noise(seed * 16 + step as u64 % 16, longest);
            for (list, length) in all.iter_mut().zip(lengths) {
                list.push(self.sums(*length, step, &noise)?);
            }
        }
        Ok(all)
    }
}

/// Noise of one record.
fn noise(seed: u64, samples: usize) -> Vec<Vector3> {
    let mut normals = Normals::new(seed, 0);
    (0..samples).map(|_| normals.vector() * SIGMA).collect()
}

/// The four columns of Table 2.
pub fn columns(sums: &Sums) -> Result<[[f64; 6]; 4], Faults> {
    Ok([
        sums.batch()?.0.printed,
        sums.conventional()?.printed,
        sums.pre_estimate()?.printed,
        sums.suggested()?.printed,
    ])
}

/// Squared Mahalanobis distance of the suggested column as printed to the mean of the trials.
pub fn chi_square(trials: &[[f64; 6]]) -> f64 {
    let n = trials.len() as f64;
    let trials: Vec<Vector6> = trials.iter().map(|t| Vector6::from(*t)).collect();
    let mean = trials.iter().sum::<Vector6>() / n;
    let squares = trials.iter().map(|t| (t - mean) * (t - mean).transpose());
    let covariance = squares.sum::<Matrix6>() / (n - 1.0);
    let gap = Vector6::from(PRINTED[3]) - mean;
    let cholesky = covariance.cholesky();
    cholesky.map_or(f64::NAN, |c| gap.dot(&c.solve(&gap)))
}
