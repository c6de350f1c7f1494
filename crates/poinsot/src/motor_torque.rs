//! Compares the measured motor torque of wheels with their speed. The fit follows the torque between tachometer samples
//! whatever its scale, so a wrong scale, unit or sign is told here.

use crate::bind::Bound;
use nalgebra::{DMatrix, DVector};
use poinsot_dynamics::{Kinematics, Tree};
use poinsot_identify::{Samples, Segment};
use poinsot_model::{Model, Wheel};
use poinsot_spatial::Vector3;
use poinsot_telemetry::checks::{Check, Finding};
use poinsot_telemetry::{Channel, Table, integral, resample};

/// Sigma of the scale of an uncalibrated torque (current times nominal constant).
const SCALE: f64 = 0.05;
/// Significance, in sigmas, of a contradiction.
const CONTRADICTED: f64 = 5.0;
/// Samples over which one speed change is taken, so that its noise is comparatively small.
const WINDOW: usize = 10;
/// Unknowns: scale, offset, Coulomb and viscous friction.
const UNKNOWNS: usize = 4;
/// Fewest changes: enough for the unknowns and a scatter.
const FEWEST: usize = 3 * UNKNOWNS;

/// Wheels whose speed change contradicts their motor torque.
///
/// `Js d(Omega + a . w) = s int tau dt - b dt - c0 int sign(Omega) dt - c1 int Omega dt` over windows, with the measured
/// rate `w` of the host: scale and offset of the torque, Coulomb and viscous friction.
pub(crate) fn contradictions(
    (model, tree): (&Model, &Tree),
    tables: &[Table],
    bound: &Bound,
) -> Vec<Finding> {
    // A requested spin inertia is determined by the body's reaction.
    let known = model.wheels.iter().filter(|w| !w.estimate);
    known
        .filter_map(|w| contradiction((w, tree), tables, bound))
        .collect()
}

fn contradiction(
    (wheel, tree): (&Wheel, &Tree),
    tables: &[Table],
    bound: &Bound,
) -> Option<Finding> {
    let speed = format!("{}_rad_s", wheel.name);
    let torque = format!("{}_Nm", wheel.name);
    let mut segments = bound.segments.as_slice();
    let mut changes = Vec::new();
    for (table, pieces) in tables.iter().zip(&bound.pieces) {
        let (own, others) = segments.split_at(*pieces);
        segments = others;
        if let Some((w, t)) = table.channel(&speed).zip(table.channel(&torque)) {
            changes.extend(windows(w, t, &host_rate(wheel, tree, own, w)));
        }
    }
    let (scale, sigma) = scale(&changes, wheel.spin_inertia)?;
    let sigma = sigma.hypot(SCALE);
    let text = format!(
        "the speed of {0} changes {scale:.2} +- {sigma:.2} times as much as its motor torque predicts ({torque}, spin inertia {1} kg m2); check spin inertia, units and signs",
        wheel.name, wheel.spin_inertia
    );
    let contradicted = (scale - 1.0).abs() > CONTRADICTED * sigma;
    contradicted.then(|| Finding::new(Check::MotorTorque, speed, 0, Vec::new(), text))
}

/// Rate of a wheel's host about its axis, rad/s, at the times of the wheel's tachometer.
fn host_rate(
    wheel: &Wheel,
    tree: &Tree,
    segments: &[Segment],
    tachometer: &Channel,
) -> Vec<Option<f64>> {
    let mut kinematics = Kinematics::new(tree);
    let mut rate = |samples: &Samples, k: usize| {
        let row = k * tree.dof()..(k + 1) * tree.dof();
        kinematics.place(tree, &samples.joint_position[row.clone()]);
        let (w, rates) = (&samples.w_NB_B[k], &samples.joint_rate[row]);
        kinematics.set_velocities(tree, &Vector3::zeros(), w, rates);
        let axis = kinematics.R[wheel.body] * wheel.axis_B;
        axis.dot(&kinematics.w[wheel.body])
    };
    let samples = segments.iter().map(|s| &s.samples);
    let times = samples.clone().flat_map(|s| &s.time_s).copied();
    let rates = samples.flat_map(|s| (0..s.time_s.len()).map(move |k| (s, k)));
    let host = Channel {
        time_s: times.collect(),
        values: rates.map(|(s, k)| rate(s, k)).collect(),
        ..tachometer.clone()
    };
    resample(&host, &tachometer.time_s, None)
}

/// Change of a wheel's axial speed over a window, and integrals of torque, one, sign of speed, and speed.
struct Change {
    speed: f64,
    of: [f64; UNKNOWNS],
}

fn windows(speed: &Channel, torque: &Channel, host: &[Option<f64>]) -> Vec<Change> {
    let at = |channel: &Channel| resample(&integral(channel), &speed.time_s, None);
    let sense = Channel {
        values: speed.values.iter().map(|x| x.signum()).collect(),
        ..speed.clone()
    };
    let (impulse, sense, angle) = (at(torque), at(&sense), at(speed));
    let ends: Vec<usize> = (0..speed.time_s.len()).step_by(WINDOW).collect();
    let pairs = ends.windows(2);
    let one = |pair: &[usize]| {
        let [a, b] = *pair else { return None };
        let between = |column: &[Option<f64>]| Some((*column.get(b)?)? - (*column.get(a)?)?);
        Some(Change {
            speed: speed.values[b] - speed.values[a] + between(host)?,
            of: [
                between(&impulse)?,
                speed.time_s[b] - speed.time_s[a],
                between(&sense)?,
                between(&angle)?,
            ],
        })
    };
    pairs.filter_map(one).collect()
}

/// Scale between speed change and torque, and its sigma from the scatter; `None` if the torque does not determine it.
fn scale(changes: &[Change], spin_inertia: f64) -> Option<(f64, f64)> {
    if changes.len() < FEWEST {
        return None;
    }
    let y = DVector::from_iterator(
        changes.len(),
        changes.iter().map(|c| spin_inertia * c.speed),
    );
    let sizes: [f64; UNKNOWNS] =
        std::array::from_fn(|k| changes.iter().map(|c| c.of[k].abs()).fold(0.0, f64::max));
    // Scale columns to unit size. The torque comes last: what the others leave of it counts, however parallel they are.
    let size = |k: usize| if sizes[k] > 0.0 { sizes[k] } else { 1.0 };
    let torque = UNKNOWNS - 1;
    let column = |k: usize| (k + 1) % UNKNOWNS;
    let A = DMatrix::from_fn(changes.len(), UNKNOWNS, |i, k| {
        changes[i].of[column(k)] / size(column(k))
    });
    let qr = A.qr();
    let along = qr.q().tr_mul(&y);
    let own = qr.r()[(torque, torque)];
    let left = (y.norm_squared() - along.norm_squared()).max(0.0);
    let variance = left / (changes.len() - UNKNOWNS) as f64;
    let scale = along[torque] / (own * size(0));
    let sigma = variance.sqrt() / (own * size(0)).abs();
    (sizes[0] > 0.0 && scale.is_finite() && sigma.is_finite()).then_some((scale, sigma))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Time, sense and angle of a wheel at constant speed are parallel: the noise of its tachometer is no scale.
    #[test]
    fn unit_a_wheel_at_constant_speed_contradicts_no_torque() {
        let changes: Vec<Change> = (0..15)
            .map(|k| {
                let k = f64::from(k);
                Change {
                    speed: 0.05 * (3.1 * k).sin(),
                    of: [
                        1.0e-6 * (1.7 * k).sin(),
                        20.0,
                        20.0,
                        3000.0 + 0.01 * k.cos(),
                    ],
                }
            })
            .collect();
        let (found, sigma) = scale(&changes, 0.045).unwrap();
        assert!(sigma > 100.0, "{sigma}");
        assert!(
            (found - 1.0).abs() < CONTRADICTED * sigma,
            "{found} {sigma}"
        );
    }
}
