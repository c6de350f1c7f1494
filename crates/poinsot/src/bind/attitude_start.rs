//! The attitude at the start, from directions where no attitude is measured.

use super::sensors::sensor_columns;
use nalgebra::{Matrix3, Matrix4, Quaternion, UnitQuaternion, Vector3};
use poinsot_model::{Model, SensorKind};
use poinsot_telemetry::Table;

/// Time after the first sample in which directions are used, s: a gyro bias of 1e-3 rad/s turns by 0.1 rad until then.
const SPAN_S: f64 = 100.0;

/// A direction as the base sees it: time, s, measured in B, known in N.
pub(super) type Direction = (f64, Vector3<f64>, Vector3<f64>);

/// Directions that sensors of the base see.
pub(super) fn base_directions(model: &Model, table: &Table) -> Vec<Direction> {
    let all = sensor_columns(model, table).into_iter();
    let own = all.filter(|c| c.kind == SensorKind::Direction);
    let on_base = own.filter(|c| c.sensor.is_some_and(|k| model.sensors[k].body == 0));
    on_base.flat_map(|c| c.directions(model)).collect()
}

/// The turn `R` for which `R Q(t) seen` fits the known directions best, `Q` being attitudes from an unknown start: Davenport's
/// q-method for Wahba's problem (Wahba 1965, Markley and Crassidis 2014, section 5.3). The identity without directions.
pub(super) fn attitude_from_directions(
    times: &[f64],
    Q: &[Option<UnitQuaternion<f64>>],
    directions: &[Direction],
) -> UnitQuaternion<f64> {
    let first = Q
        .iter()
        .position(Option::is_some)
        .and_then(|k| times.get(k));
    let until = first.map_or(f64::NEG_INFINITY, |t| t + SPAN_S);
    let mut profile = Matrix3::zeros();
    for (t, seen_B, known_N) in directions.iter().filter(|d| d.0 <= until) {
        let next = times
            .partition_point(|x| x < t)
            .min(times.len().saturating_sub(1));
        if let Some(Some(Q)) = Q.get(next) {
            profile += known_N * (Q * seen_B).transpose();
        }
    }
    if profile == Matrix3::zeros() {
        return UnitQuaternion::identity();
    }
    let symmetric = profile + profile.transpose();
    let z = Vector3::new(
        profile[(2, 1)] - profile[(1, 2)],
        profile[(0, 2)] - profile[(2, 0)],
        profile[(1, 0)] - profile[(0, 1)],
    );
    let trace = profile.trace();
    let mut K = Matrix4::zeros();
    K.fixed_view_mut::<3, 3>(0, 0)
        .copy_from(&(symmetric - Matrix3::identity() * trace));
    K.fixed_view_mut::<3, 1>(0, 3).copy_from(&z);
    K.fixed_view_mut::<1, 3>(3, 0).copy_from(&z.transpose());
    K[(3, 3)] = trace;
    let eigen = K.symmetric_eigen();
    let q = eigen.eigenvectors.column(eigen.eigenvalues.imax());
    UnitQuaternion::from_quaternion(Quaternion::new(q[3], q[0], q[1], q[2]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exact_two_directions_give_the_attitude() {
        let R = UnitQuaternion::from_scaled_axis(Vector3::new(1.9, -0.7, 1.1));
        let Q = [0.0, 0.5, 1.0].map(|t: f64| {
            Some(UnitQuaternion::from_scaled_axis(Vector3::new(
                t,
                0.3 * t,
                -t,
            )))
        });
        let times = [0.0, 1.0, 2.0];
        let known = [Vector3::x(), Vector3::new(0.0, 0.6, 0.8)];
        let mut directions = Vec::new();
        for (t, Q) in times.iter().zip(&Q) {
            for n in known {
                directions.push((*t, Q.unwrap().inverse() * (R.inverse() * n), n));
            }
        }
        let found = attitude_from_directions(&times, &Q, &directions);
        assert!(found.angle_to(&R) < 1e-7, "{}", found.angle_to(&R));
    }
}
