//! Errors of many sensors without one dense matrix.
//!
//! Where the samples have no noise but that of the sensors, the errors of a sensor act in its own rows alone. Each sensor then has
//! a triangle of its own, and the other sensors enter it by the triangle of what was fitted: the same scores at a cost that is
//! linear in the number of sensors.

use super::candidates::Candidate;
use crate::fit::experiment::{Experiment, Iterate};
use crate::likelihood::Evaluated;
use crate::problem::parameters::UnknownKind;
use poinsot_dynamics::SensorError;
use poinsot_solve::{BlockQr, Triangle};

/// The candidates of one sensor.
pub(super) struct SensorBlock {
    /// Places of its numbers among those of all candidates.
    pub numbers: Vec<usize>,
    /// Columns `[fitted unknowns | its numbers | residual]`, of all rows.
    pub stacked: Triangle,
}

/// A number that acts in the rows of one sensor alone.
pub(super) struct OwnError {
    /// Its place among those of all candidates.
    pub place: usize,
    pub sensor: usize,
    pub error: SensorError,
}

/// Numbers of the candidates that act in the rows of one sensor alone; none where noise of inputs is in the rows of all. Lags
/// are not among them: those of several sensors are tested together.
pub(super) fn own_errors(experiment: &Experiment, candidates: &[Candidate]) -> Vec<OwnError> {
    if !is_apart(experiment) {
        return Vec::new();
    }
    let numbers = candidates.iter().flat_map(|c| &c.unknowns).enumerate();
    let own = numbers.filter_map(|(place, unknown)| match unknown.kind {
        UnknownKind::Sensor { sensor, error } if error != SensorError::Lag => Some(OwnError {
            place,
            sensor,
            error,
        }),
        _ => None,
    });
    own.collect()
}

/// Whether the noise of every row is that of one sensor.
fn is_apart(experiment: &Experiment) -> bool {
    let problem = experiment.problem;
    let noise = problem.noise;
    let joints = noise.joint_position.iter().chain(&noise.joint_rate);
    let mut inputs = joints.chain(&noise.wheel_speed);
    let once = problem.segments.iter().all(|s| {
        let records = &s.observations.sensors;
        let of = |k: usize| records[k].sensor.map(|own| (k, own));
        let mut all = (0..records.len()).filter_map(of);
        all.all(|(k, own)| records[..k].iter().all(|r| r.sensor != Some(own)))
    });
    once && inputs.all(|variance| *variance == 0.0)
        && problem.model.environment.random_torque.is_none()
        && !experiment.parameters.has_known()
}

/// Rows of a triangle from one on, each of whose columns is another one of it or zero.
fn push(qr: &mut BlockQr, of: &Triangle, first: usize, from: impl Fn(usize) -> Option<usize>) {
    let rows = of.r.nrows().saturating_sub(first);
    qr.push(rows, |i, j| {
        from(j).map_or(0.0, |column| of.r[(first + i, column)])
    });
}

/// Adds the triangle of a block to others, without the columns between its first ones and the residual.
fn with(before: Option<&Triangle>, first: usize, more: &Triangle) -> Triangle {
    let mut qr = BlockQr::new(first + 1);
    if let Some(before) = before {
        push(&mut qr, before, 0, Some);
    }
    let last = more.r.ncols() - 1;
    push(&mut qr, more, 0, |j| Some(if j < first { j } else { last }));
    qr.finish()
}

/// Triangles of what was fitted in one segment: of all sensors before each, and of all from each on.
struct Others {
    before: Vec<Triangle>,
    from: Vec<Triangle>,
}

impl Others {
    /// `fitted` is the number of columns of the start and of what was fitted.
    fn new(one: &Evaluated, fitted: usize) -> Self {
        let none = || BlockQr::new(fitted + 1).finish();
        let shared = one.triangle.as_ref();
        let mut before = vec![shared.map_or_else(none, |t| with(None, fitted, t))];
        for own in &one.by_sensor {
            before.push(with(before.last(), fitted, own));
        }
        let mut from = vec![none()];
        for own in one.by_sensor.iter().rev() {
            from.push(with(from.last(), fitted, own));
        }
        from.reverse();
        Self { before, from }
    }
}

/// The blocks of all sensors. Every segment gets the triangle of all its sensors, with the columns that they share.
pub(super) fn sensor_blocks(
    (experiment, at): (&Experiment, &Iterate),
    evaluated: &mut [Evaluated],
    (shared, own): (usize, &[OwnError]),
) -> Vec<SensorBlock> {
    let base = experiment.parameters.len();
    let starts = || experiment.unknown.iter().map(|u| u.count());
    let others: Vec<Others> = evaluated
        .iter()
        .zip(starts())
        .map(|(one, h)| Others::new(one, h + base))
        .collect();
    let priors = experiment.prior_rows(at, true);
    let mut blocks = Vec::new();
    for errors in own.chunk_by(|a, b| a.sensor == b.sensor) {
        let (sensor, n) = (errors[0].sensor, errors.len());
        let mut stacked = BlockQr::new(base + n + 1);
        let segments = experiment.problem.segments.iter().zip(&*evaluated);
        for (((segment, one), h), others) in segments.zip(starts()).zip(&others) {
            let fitted = h + base;
            let mut qr = BlockQr::new(fitted + n + 1);
            let narrow = |j: usize| match j {
                j if j < fitted => Some(j),
                j if j < fitted + n => None,
                _ => Some(fitted),
            };
            let records = &segment.observations.sensors;
            let which = records.iter().position(|r| r.sensor == Some(sensor));
            match which.and_then(|k| Some((k, one.by_sensor.get(k)?))) {
                None => others
                    .before
                    .last()
                    .into_iter()
                    .for_each(|all| push(&mut qr, all, 0, narrow)),
                Some((k, rows)) => {
                    push(&mut qr, &others.before[k], 0, narrow);
                    push(&mut qr, &others.from[k + 1], 0, narrow);
                    let skip = |j: usize| Some(if j < fitted { j } else { j + shared });
                    push(&mut qr, rows, 0, skip);
                }
            }
            push(&mut stacked, &qr.finish(), h, |j| Some(h + j));
        }
        priors
            .iter()
            .for_each(|row| row.add_to(&mut stacked, base, n));
        blocks.push(SensorBlock {
            numbers: errors.iter().map(|e| e.place).collect(),
            stacked: stacked.finish(),
        });
    }
    for (one, h) in evaluated.iter_mut().zip(starts()) {
        let width = h + base + shared;
        let mut all: Option<Triangle> = one.triangle.take();
        for own in std::mem::take(&mut one.by_sensor) {
            all = Some(with(all.as_ref(), width, &own));
        }
        one.triangle = all;
    }
    blocks
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::problem::Problem;
    use crate::problem::parameters::{Parameters, Unknown};
    use crate::problem::segment::{
        Noise, Observations, Samples, Segment, SensorRecord, SensorValue,
    };
    use nalgebra::{Matrix3, UnitQuaternion, Vector3};
    use poinsot_dynamics::Tree;
    use poinsot_model::{SensorKind, parse_model};

    const MODEL: &str = r#"
schema = "poinsot.model/1"
name = "box"
exact = true
[[body]]
name = "box"
mass_kg = 10.0
com_m = [0.0, 0.0, 0.0]
inertia_kg_m2 = { xx = 1.0, yy = 2.0, zz = 2.0 }
estimate = ["inertia"]
[[sensor]]
name = "first"
type = "gyro"
noise_rad_s = 1.0e-4
[[sensor]]
name = "second"
type = "gyro"
noise_rad_s = 3.0e-4
[momentum]
linear_N_s = [0.0, 0.0, 0.0]
angular_N_m_s = "estimate"
"#;

    fn gyro(sensor: usize, sigma: f64, rates: &[Vector3<f64>]) -> SensorRecord {
        let variance = Matrix3::identity() * (sigma * sigma);
        let values = rates.iter().enumerate().map(|(k, w)| {
            // Each has residuals of its own.
            let error = sigma * ((7 * k + 3 * sensor) as f64).sin();
            SensorValue::Vector(w.add_scalar(error))
        });
        let mut record = SensorRecord::of_base(SensorKind::Gyro, variance).at_every_time(values);
        record.sensor = Some(sensor);
        record
    }

    fn products(t: &Triangle, columns: &[usize]) -> Vec<f64> {
        let dot = |a: usize, b: usize| (0..t.r.nrows()).map(|k| t.r[(k, a)] * t.r[(k, b)]).sum();
        let pairs = columns
            .iter()
            .flat_map(|a| columns.iter().map(move |b| (*a, *b)));
        pairs.map(|(a, b)| dot(a, b)).collect()
    }

    /// Both gyros along one turning motion.
    fn segment() -> Segment {
        let time_s: Vec<f64> = (0..40).map(|k| 0.1 * f64::from(k)).collect();
        let turn = |t: &f64| Vector3::new(0.3 * t.sin(), 0.2, 0.1 * t.cos());
        let rates: Vec<Vector3<f64>> = time_s.iter().map(turn).collect();
        let samples = Samples {
            time_s: time_s.clone(),
            R_NB: vec![UnitQuaternion::identity(); time_s.len()],
            w_NB_B: rates.clone(),
            ..Samples::default()
        };
        let observations = Observations {
            time_s,
            sensors: vec![gyro(0, 1.0e-4, &rates), gyro(1, 3.0e-4, &rates)],
            ..Observations::default()
        };
        Segment {
            samples,
            observations,
            ..Segment::default()
        }
    }

    fn noise() -> Noise {
        Noise {
            gyro_sensor: None,
            gyro: Matrix3::identity() * 1.0e-8,
            attitude: Matrix3::zeros(),
            velocity: Matrix3::zeros(),
            position: Matrix3::zeros(),
            joint_position: vec![],
            joint_rate: vec![],
            wheel_speed: vec![],
            seen_gyro: 1.0,
            seen_velocity: 0.0,
            seen_joint_rate: 0.0,
        }
    }

    /// The unknowns, and errors of sensors behind them.
    fn with(parameters: &Parameters, errors: &[(usize, SensorError)]) -> Parameters {
        let mut extended = parameters.clone();
        let unknown = |(sensor, error): &(usize, SensorError)| Unknown {
            kind: UnknownKind::Sensor {
                sensor: *sensor,
                error: *error,
            },
            name: String::new(),
            unit: "1",
            nominal: 0.0,
            natural: 1.0,
        };
        extended.unknowns.extend(errors.iter().map(unknown));
        extended
    }

    /// Sensor by sensor the products of the columns are those of one dense triangle.
    #[test]
    fn exact_blocks_of_sensors_are_those_of_the_dense_triangle() {
        let model = parse_model(MODEL, "box.toml").unwrap();
        let tree = Tree::new(&model);
        let (segments, noise) = ([segment()], noise());
        let problem = Problem {
            model: &model,
            tree: &tree,
            segments: &segments,
            noise: &noise,
            relative_accuracy: 1.0,
            pace: None,
        };
        let parameters = problem.likelihood_parameters().unwrap();
        let experiment = Experiment::new(&problem, &parameters);
        assert!(is_apart(&experiment));
        let errors = [
            (0, SensorError::Scale(0)),
            (0, SensorError::Bias(2)),
            (1, SensorError::Misalignment(1)),
        ];
        let own: Vec<OwnError> = (1..)
            .zip(errors)
            .map(|(place, (sensor, error))| OwnError {
                place,
                sensor,
                error,
            })
            .collect();
        let shared = [(1, SensorError::Lag)];
        let all: Vec<_> = shared.iter().chain(&errors).copied().collect();
        let (narrow, wide) = (with(&parameters, &shared), with(&parameters, &all));
        let at = experiment.nominal_point();
        let point = |more: usize| {
            let mut at = at.clone();
            at.x.extend(std::iter::repeat_n(0.0, more));
            at
        };
        let dense = experiment.with_parameters(&wide);
        let evaluated = dense.evaluate(&point(all.len()), true).unwrap();
        let dense = dense.stack(&point(all.len()), &evaluated, true);

        let mut apart = experiment.with_parameters(&narrow);
        apart.own_errors = errors.to_vec();
        let mut evaluated = apart.evaluate(&point(1), true).unwrap();
        let blocks = sensor_blocks((&experiment, &at), &mut evaluated, (1, &own));
        let merged = apart.stack(&point(1), &evaluated, true);

        let base = parameters.len();
        let compare = |name: &str, t: &Triangle, numbers: &[usize]| {
            let last = base + all.len();
            let columns = (0..base)
                .chain(numbers.iter().map(|k| base + k))
                .chain([last]);
            let wanted = products(&dense, &columns.collect::<Vec<_>>());
            let found = products(t, &(0..t.r.ncols()).collect::<Vec<_>>());
            let largest = wanted.iter().fold(0.0_f64, |a, x| a.max(x.abs()));
            assert_eq!(wanted.len(), found.len(), "{name}");
            for (a, b) in wanted.iter().zip(&found) {
                assert!((a - b).abs() < 1.0e-10 * largest, "{name}: {a} {b}");
            }
        };
        compare("shared", &merged, &[0]);
        assert_eq!(blocks.len(), 2);
        for block in &blocks {
            compare("own", &block.stacked, &block.numbers);
        }
    }
}
