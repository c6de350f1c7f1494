//! Attitudes and rates of the base from which a fit starts, where no sensor measures them: attitudes from gyro and directions or
//! from directions alone, across gaps of the attitude sensor by the gyro, and rates from attitudes.

use super::sensors::{HALF_WIDTH, rotation, sensor_columns};
use nalgebra::{Matrix4, Quaternion};
use poinsot_model::{Model, SensorKind};
use poinsot_spatial::{Matrix3, Matrix6, UnitQuaternion, Vector3, Vector6, skew};
use poinsot_telemetry::{Channel, GAP, Table, differentiate, median_step};

/// First interval, s; each is twice the previous one. A gyro bias of 1e-3 rad/s rotates the attitude by 0.03 rad in
/// it.
const FIRST_S: f64 = 30.0;
/// Gauss-Newton steps per interval; bias and initial attitude are nearly linear in it.
const STEPS: usize = 3;
/// Prior sigma of a direction, of the attitude and of the gyro bias, rad, rad and rad/s. The priors fix what the
/// directions do not determine.
const DIRECTION: f64 = 1.0e-2;
const ATTITUDE: f64 = 1.0;
const BIAS: f64 = 5.0e-2;

/// Sine of the angle between two directions from which they determine an attitude.
const APART: f64 = 0.05;

/// A direction measured by the base: time, s, measured in B, known in N.
pub(super) type Direction = (f64, Vector3, Vector3);

type Turn = Option<UnitQuaternion>;
type Attitudes = Vec<Turn>;

/// Directions measured by sensors of the base, one list a sensor.
pub(super) fn base_directions(model: &Model, table: &Table) -> Vec<Vec<Direction>> {
    let all = sensor_columns(model, table).into_iter();
    let own = all.filter(|c| c.kind == SensorKind::Direction);
    let on_base = own.filter(|c| c.sensor.is_some_and(|k| model.sensors[k].body == 0));
    on_base.map(|c| c.directions(model)).collect()
}

/// Attitudes from directions alone, as channels: at the times of the sensor that has most samples, where another one has
/// samples around that determine the rotation about its direction. `None` without such a time.
pub(super) fn from_directions(sensors: &[Vec<Direction>]) -> Option<[Channel; 4]> {
    let leading = sensors.iter().max_by_key(|s| s.len())?;
    let others = || sensors.iter().filter(|s| !std::ptr::eq(*s, leading));
    let attitude = |(t, seen_B, known_N): &Direction| {
        let pairs = others().filter_map(|s| direction_at(s, *t));
        let apart = pairs.filter(|(_, known)| known_N.cross(known).norm() > APART);
        let mut profile = Matrix3::zeros();
        apart.for_each(|(seen, known)| profile += known * seen.transpose());
        let some = profile != Matrix3::zeros();
        some.then(|| (*t, wahba(&(profile + known_N * seen_B.transpose()))))
    };
    let all: Vec<(f64, UnitQuaternion)> = leading.iter().filter_map(attitude).collect();
    (!all.is_empty()).then(|| attitude_channels(&all))
}

/// A direction between two samples that are no gap apart: in B, and known in N.
fn direction_at(samples: &[Direction], t: f64) -> Option<(Vector3, Vector3)> {
    let times: Vec<f64> = samples.iter().map(|s| s.0).collect();
    let k = times.partition_point(|x| *x <= t).checked_sub(1)?;
    let (a, b) = (&samples[k], samples.get(k + 1).unwrap_or(&samples[k]));
    let h = b.0 - a.0;
    if h > GAP * median_step(&times)? || t - b.0 > 0.0 {
        return None;
    }
    let share = if h > 0.0 { (t - a.0) / h } else { 0.0 };
    let between = |a: &Vector3, b: &Vector3| (a + (b - a) * share).try_normalize(0.0);
    Some((between(&a.1, &b.1)?, between(&a.2, &b.2)?))
}

/// Attitudes as the channels of an attitude sensor, of continuous sign.
fn attitude_channels(all: &[(f64, UnitQuaternion)]) -> [Channel; 4] {
    let time_s: Vec<f64> = all.iter().map(|a| a.0).collect();
    let mut q: Vec<[f64; 4]> = all.iter().map(|(_, R)| (*R.as_vector()).into()).collect();
    for k in 1..q.len() {
        let dot: f64 = q[k - 1].iter().zip(&q[k]).map(|(a, b)| a * b).sum();
        if dot < 0.0 {
            q[k] = q[k].map(|x| -x);
        }
    }
    [("q_x", 0), ("q_y", 1), ("q_z", 2), ("q_w", 3)].map(|(name, k)| Channel {
        name: name.to_owned(),
        time_s: time_s.as_slice().into(),
        values: q.iter().map(|q| q[k]).collect(),
        ..Channel::default()
    })
}

/// Body rates as the derivative of an attitude, `w = 2 q* q'`, by the quartic through five samples.
pub(super) fn differentiated(attitude: [&Channel; 4]) -> [Channel; 3] {
    let whole = |k: usize| {
        let part = |c: &Channel| c.values.get(k).copied();
        let [x, y, z, w] = attitude.map(part);
        Some((*attitude[0].time_s.get(k)?, rotation([x?, y?, z?, w?])))
    };
    let all: Vec<_> = (0..attitude[0].values.len()).filter_map(whole).collect();
    let smooth = attitude_channels(&all);
    let slopes = smooth.each_ref().map(|c| differentiate(c, HALF_WIDTH));
    let times = &slopes[0].time_s;
    let rate = |(i, t): (usize, &f64)| {
        let k = smooth[0].time_s.partition_point(|x| x < t);
        let quaternion = |c: [f64; 4]| Quaternion::new(c[3], c[0], c[1], c[2]);
        let q = quaternion(smooth.each_ref().map(|c| c.values[k]));
        let slope = quaternion(slopes.each_ref().map(|c| c.values[i]));
        2.0 * (q.conjugate() * slope).imag()
    };
    let rates: Vec<Vector3> = times.iter().enumerate().map(rate).collect();
    [("omega_x", 0), ("omega_y", 1), ("omega_z", 2)].map(|(name, k)| Channel {
        name: name.to_owned(),
        unit: "rad/s".to_owned(),
        time_s: times.clone(),
        values: rates.iter().map(|w| w[k]).collect(),
        ..Channel::default()
    })
}

/// Attitudes where none was measured, carried by the rates: from the last one before and from the next one after, and between
/// both where there are both. A gap of the rates ends it.
pub(super) fn carried(times: &[f64], rate: &[Option<Vector3>], measured: Attitudes) -> Attitudes {
    if measured.iter().all(Option::is_some) {
        return measured;
    }
    let longest = GAP * median_step(times).unwrap_or(f64::INFINITY);
    // Turn over the interval before time k, in the axes at its start.
    let turn = |k: usize| {
        let h = times[k] - times[k - 1];
        let (a, b) = (rate[k - 1]?, rate[k]?);
        (h <= longest).then(|| turn_over(h, &a, &b))
    };
    let n = times.len();
    let reached = |order: &mut dyn Iterator<Item = usize>, turn: &dyn Fn(usize) -> Turn| {
        let (mut all, mut last) = (vec![None; n], None::<(f64, UnitQuaternion)>);
        for k in order {
            let carried = || last.and_then(|(since, R)| Some((since, R * turn(k)?)));
            last = measured[k].map(|R| (times[k], R)).or_else(carried);
            all[k] = last;
        }
        all
    };
    let before = reached(&mut (0..n), &turn);
    let after = reached(&mut (0..n).rev(), &|k| Some(turn(k + 1)?.inverse()));
    let between = |k: usize| match (before[k], after[k]) {
        (Some((from, a)), Some((to, b))) if to > from => {
            let error = (a.inverse() * b).scaled_axis();
            let share = (times[k] - from) / (to - from);
            Some(a * UnitQuaternion::from_scaled_axis(error * share))
        }
        (a, b) => a.or(b).map(|(_, R)| R),
    };
    (0..n).map(between).collect()
}

/// The turn over an interval of length `h` between two rates: the rotation vector of the fourth-order Magnus expansion for a
/// rate linear in time, `h (w0 + w1)/2 + h^2 (w0 x w1)/12` (Iserles et al. 2000, eq. 4.16).
fn turn_over(h: f64, w0: &Vector3, w1: &Vector3) -> UnitQuaternion {
    UnitQuaternion::from_scaled_axis((w0 + w1) * (0.5 * h) + w0.cross(w1) * (h * h / 12.0))
}

/// Attitudes at the gyro's times that fit directions best, with one common gyro bias.
///
/// The initial attitude is Davenport's solution of Wahba's problem on the first interval (Wahba 1965, Markley and
/// Crassidis 2014, section 5.3). Attitude and bias are then refined by Gauss-Newton over growing intervals, so that
/// the drift stays small.
pub(super) fn attitudes(
    times: &[f64],
    rate: &[Option<Vector3>],
    directions: &[Direction],
) -> Attitudes {
    let mut Q = integrate_rate(times, rate);
    let first = Q.iter().zip(times).find_map(|(q, t)| q.map(|_| t));
    let (Some(first), Some(last)) = (first, times.last()) else {
        return Q;
    };
    let mut span = FIRST_S;
    let within = |span: f64| directions.iter().filter(move |d| d.0 <= first + span);
    let mut R = start(times, &Q, within(span));
    let mut bias = Vector3::zeros();
    loop {
        for _ in 0..STEPS {
            let Some((turn, more)) = step(times, (&R, &Q, &bias), within(span)) else {
                break;
            };
            R = UnitQuaternion::from_scaled_axis(turn) * R;
            bias += more;
            let free: Vec<Option<Vector3>> = rate.iter().map(|w| w.map(|w| w - bias)).collect();
            Q = integrate_rate(times, &free);
        }
        if first + span >= *last {
            break;
        }
        span *= 2.0;
    }
    for attitude in Q.iter_mut().flatten() {
        *attitude = R * *attitude;
    }
    Q
}

/// Attitude from body rates.
pub(super) fn integrate_rate(times: &[f64], rate: &[Option<Vector3>]) -> Attitudes {
    let mut out = vec![None; times.len()];
    let mut last: Option<(usize, UnitQuaternion, Vector3)> = None;
    for (k, w) in rate.iter().enumerate() {
        let Some(w) = w else { continue };
        let q = match &last {
            None => UnitQuaternion::identity(),
            Some((before, q, w0)) => q * turn_over(times[k] - times[*before], w0, w),
        };
        out[k] = Some(q);
        last = Some((k, q, *w));
    }
    out
}

/// The attitude at a time, or at the next sample.
fn at(times: &[f64], Q: &Attitudes, t: f64) -> Option<(usize, UnitQuaternion)> {
    let k = times.partition_point(|x| *x < t);
    Some((k, (*Q.get(k)?)?))
}

/// The rotation `R` for which `R Q(t)` maps the measured directions best to the known ones; identity without
/// directions.
fn start<'a>(
    times: &[f64],
    Q: &Attitudes,
    directions: impl Iterator<Item = &'a Direction>,
) -> UnitQuaternion {
    let mut profile = Matrix3::zeros();
    for (t, seen_B, known_N) in directions {
        if let Some((_, Q)) = at(times, Q, *t) {
            profile += known_N * (Q * seen_B).transpose();
        }
    }
    if profile == Matrix3::zeros() {
        return UnitQuaternion::identity();
    }
    wahba(&profile)
}

/// Davenport's solution for a profile `sum n_N s_B^T`: the rotation that maps `s_B` to `n_N` best.
fn wahba(profile: &Matrix3) -> UnitQuaternion {
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
    rotation([q[0], q[1], q[2], q[3]])
}

/// A Gauss-Newton step of the initial attitude, in N, and of the bias.
///
/// With `A = R Q`, a rotation `d` of the initial attitude in N changes the measured direction `A^T n` by
/// `A^T (n x d)`. A bias `b` rotates `Q` by `-int Q b dt` in the axes of the initial attitude.
fn step<'a>(
    times: &[f64],
    (R, Q, bias): (&UnitQuaternion, &Attitudes, &Vector3),
    directions: impl Iterator<Item = &'a Direction>,
) -> Option<(Vector3, Vector3)> {
    let matrix = |q: &UnitQuaternion| *q.to_rotation_matrix().matrix();
    let mut turned = vec![Matrix3::zeros(); times.len()];
    let mut sum = Matrix3::zeros();
    let mut before: Option<(f64, Matrix3)> = None;
    for ((t, Q), turned) in times.iter().zip(Q).zip(&mut turned) {
        if let Some(now) = Q.as_ref().map(matrix) {
            if let Some((then, was)) = before {
                sum += (was + now) * (0.5 * (t - then));
            }
            before = Some((*t, now));
        }
        *turned = sum;
    }
    let mut normal = Matrix6::zeros();
    let mut right = Vector6::zeros();
    for k in 0..3 {
        normal[(k, k)] = (DIRECTION / ATTITUDE).powi(2);
        normal[(3 + k, 3 + k)] = (DIRECTION / BIAS).powi(2);
        right[3 + k] = -bias[k] * (DIRECTION / BIAS).powi(2);
    }
    for (t, seen_B, known_N) in directions {
        let Some((k, Q)) = at(times, Q, *t) else {
            continue;
        };
        let to_body = matrix(&(R * Q)).transpose();
        let by_start = to_body * skew(known_N);
        let by_bias = -matrix(&Q).transpose() * skew(&(R.inverse() * known_N)) * turned[k];
        let mut slopes = nalgebra::SMatrix::<f64, 3, 6>::zeros();
        slopes.fixed_view_mut::<3, 3>(0, 0).copy_from(&by_start);
        slopes.fixed_view_mut::<3, 3>(0, 3).copy_from(&by_bias);
        normal += slopes.transpose() * slopes;
        right += slopes.transpose() * (seen_B - to_body * known_N);
    }
    let x = normal.cholesky()?.solve(&right);
    let finite = x.iter().all(|x| x.is_finite());
    finite.then(|| (x.fixed_rows::<3>(0).into(), x.fixed_rows::<3>(3).into()))
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Tumble {
        times: Vec<f64>,
        read: Vec<Option<Vector3>>,
        truth: Attitudes,
        seen: Vec<Direction>,
    }

    /// A tumbling base with a gyro bias, and its measurements of the known vectors.
    fn tumble(bias: Vector3, known: &[Vector3]) -> Tumble {
        let times: Vec<f64> = (0..3000).map(|k| 0.1 * f64::from(k)).collect();
        let w = |t: &f64| Vector3::new(0.02, -0.03 * (0.05 * t).cos(), 0.025 * (0.03 * t).sin());
        let true_rate: Vec<_> = times.iter().map(|t| Some(w(t))).collect();
        let R = UnitQuaternion::from_scaled_axis(Vector3::new(1.9, -0.7, 1.1));
        let truth: Attitudes = integrate_rate(&times, &true_rate)
            .into_iter()
            .map(|q| q.map(|q| R * q))
            .collect();
        let read = true_rate.iter().map(|w| w.map(|w| w + bias)).collect();
        let mut seen = Vec::new();
        for (t, q) in times.iter().zip(&truth).step_by(10) {
            seen.extend(known.iter().map(|n| (*t, q.unwrap().inverse() * n, *n)));
        }
        Tumble {
            times,
            read,
            truth,
            seen,
        }
    }

    #[test]
    fn exact_two_directions_give_the_attitude_whatever_the_bias() {
        let known = [Vector3::x(), Vector3::new(0.0, 0.6, 0.8)];
        let bias = Vector3::new(5.0e-3, -2.0e-3, 8.0e-3);
        let t = tumble(bias, &known);
        let found = attitudes(&t.times, &t.read, &t.seen);
        for (found, truth) in found.iter().zip(&t.truth) {
            let off = found.unwrap().angle_to(&truth.unwrap());
            assert!(off < 1.0e-5, "{off}");
        }
    }

    /// One direction does not determine the rotation about itself.
    #[test]
    fn exact_one_direction_is_seen_as_read_whatever_the_bias() {
        let bias = Vector3::new(5.0e-3, -2.0e-3, 8.0e-3);
        let all = tumble(bias, &[Vector3::new(0.0, 0.6, 0.8)]);
        let found = attitudes(&all.times, &all.read, &all.seen);
        for (t, seen_B, known_N) in &all.seen {
            let (_, A) = at(&all.times, &found, *t).unwrap();
            let off = (A * seen_B - known_N).norm();
            assert!(off < 1.0e-5, "{t}: {off}");
        }
    }
}
