//! The paper's slew, simulated from its case file without noise.

use poinsot::case::{parse_case, read_case};
use poinsot::simulate::simulate_case;
use poinsot_model::read_model;
use poinsot_papers::kim2010::{Kim2010Error, Manoeuvre, StartRate, Sums, wheel_momentum};
use poinsot_spatial::{Matrix3, UnitQuaternion, Vector3};
use std::path::PathBuf;

/// Rows per second of the record.
pub const RATE: usize = 10;
/// Its length, s.
pub const LENGTH: usize = 600;

/// Folder of the cases.
pub fn cases() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../examples/cases")
}

/// A record without noise.
pub struct Slew {
    pub time: Vec<f64>,
    pub R_NB: Vec<UnitQuaternion>,
    pub w: Vec<Vector3>,
    pub h: Vec<Vector3>,
    /// Torque of the controller on the body, N m (17).
    pub u: Vec<Vector3>,
    pub I: Matrix3,
}

impl Slew {
    pub fn simulate() -> Result<Self, Box<dyn std::error::Error>> {
        let path = cases().join("stsat3_kim2010.toml");
        let text = std::fs::read_to_string(&path)?
            .replace("duration_s = 350.0", &format!("duration_s = {LENGTH}"))
            .replace("sensors_only = true", "sensors_only = false");
        let mut model = read_model(&read_case(&path)?.model)?;
        model.sensors.clear();
        let table = simulate_case(&parse_case(&path, text)?, &model)?.table;
        let column = |name: &str| {
            let channel = table.channel(name).ok_or(format!("no channel {name}"));
            channel.map(|c| (c.time_s.to_vec(), c.values.clone()))
        };
        let three = |names: [&str; 3]| -> Result<Vec<Vector3>, String> {
            let [x, y, z] = [
                column(names[0])?.1,
                column(names[1])?.1,
                column(names[2])?.1,
            ];
            let all = x.iter().zip(&y).zip(&z);
            Ok(all.map(|((x, y), z)| Vector3::new(*x, *y, *z)).collect())
        };
        let vector = three(["q_x", "q_y", "q_z"])?;
        let (time, scalar) = column("q_w")?;
        let R_NB: Vec<UnitQuaternion> = vector
            .iter()
            .zip(&scalar)
            .map(|(v, w)| {
                UnitQuaternion::new_normalize(nalgebra::Quaternion::new(*w, v.x, v.y, v.z))
            })
            .collect();
        let w = three(["omega_x", "omega_y", "omega_z"])?;
        let speed = three(["wheel1_rad_s", "wheel2_rad_s", "wheel3_rad_s"])?;
        let axes: Vec<Vector3> = model.wheels.iter().map(|w| w.axis_B).collect();
        let spin: Vec<f64> = model.wheels.iter().map(|w| w.spin_inertia).collect();
        let momentum = |s: &Vector3| wheel_momentum(&axes, &spin, s.as_slice());
        let I = model.bodies[0].nominal.I_BBcm_B;
        let (wn, zeta) = (0.043, 0.707);
        let law = |(q, w): (&UnitQuaternion, &Vector3)| {
            -(I * q.imag()) * (2.0 * wn * wn) - (I * w) * (2.0 * zeta * wn)
        };
        Ok(Self {
            u: R_NB.iter().zip(&w).map(law).collect(),
            h: speed.iter().map(momentum).collect(),
            time,
            R_NB,
            w,
            I,
        })
    }

    /// The sums of the paper's estimators for the first `seconds` at `rate` samples per second, with
    /// `noise` (one vector per sample) on the rates.
    pub fn sums(
        &self,
        seconds: usize,
        step: usize,
        noise: &[Vector3],
    ) -> Result<Sums, Kim2010Error> {
        let rows = || (0..=seconds * RATE).step_by(step);
        let zero = Vector3::zeros();
        let w: Vec<Vector3> = rows()
            .enumerate()
            .map(|(k, i)| self.w[i] + noise.get(k).unwrap_or(&zero))
            .collect();
        let R: Vec<UnitQuaternion> = rows().map(|i| self.R_NB[i]).collect();
        let h: Vec<Vector3> = rows().map(|i| self.h[i]).collect();
        Sums::of(&[Manoeuvre {
            R_NB: &R,
            w_NB_B: &w,
            h_W_B: &h,
            start: StartRate::Rest,
        }])
    }
}
