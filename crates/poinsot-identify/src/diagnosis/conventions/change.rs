//! A record as it would be read by another convention.

use super::table::{Convention, Place, turned};
use crate::fit::experiment::Experiment;
use crate::problem::segment::{Segment, SensorValue};
use poinsot_model::SensorKind;
use poinsot_spatial::{UnitQuaternion, Vector3};
use poinsot_telemetry::Change;

/// The experiment with a convention put right.
pub(super) fn put_right<T>(
    experiment: &Experiment,
    convention: &Convention,
    ask: impl FnOnce(&Experiment) -> T,
) -> T {
    let mut other = experiment.with_parameters(experiment.parameters);
    match (&convention.place, convention.change) {
        // With the spin inertia in place of the speed, its process stays.
        (Place::Wheels(which), Change::Factor(x)) => {
            which.iter().for_each(|k| other.nominal_spin[*k] *= x);
        }
        (Place::Thrusters(which), Change::Factor(x)) => {
            let thrusters = &mut other.thrusters;
            which.iter().for_each(|k| thrusters[*k].direction_B *= x);
        }
        _ => {
            let mut segments = experiment.problem.segments.to_vec();
            for segment in &mut segments {
                put_segment_right(segment, convention, experiment);
            }
            let problem = experiment.problem.with_segments(&segments);
            return ask(&experiment.with_problem(&problem));
        }
    }
    ask(&other)
}

fn put_segment_right(segment: &mut Segment, convention: &Convention, experiment: &Experiment) {
    let problem = experiment.problem;
    let (dof, wheels) = (problem.tree.dof(), problem.model.wheels.len());
    let o = &mut segment.observations;
    let s = &mut segment.samples;
    let positions = [&mut o.joint_position, &mut s.joint_position];
    let rates = [&mut o.joint_rate, &mut s.joint_rate];
    match (&convention.place, convention.change) {
        (Place::Wheels(two), Change::Exchanged) => {
            exchange(&mut o.wheel_speed, wheels, two);
            exchange(&mut o.smooth_wheel_speed, wheels, two);
            exchange(&mut s.wheel_speed, wheels, two);
            let all = o.wheels.len();
            exchange(&mut o.wheels, all, two);
        }
        (Place::Joints(two), Change::Exchanged) => {
            let rows = positions.into_iter().chain(rates);
            rows.for_each(|rows| exchange(rows, dof, two));
            let all = o.joints.len();
            exchange(&mut o.joints, all, two);
        }
        (Place::Joints(which), Change::Factor(x)) => {
            let rows = positions.into_iter().chain(rates);
            rows.for_each(|rows| each(rows, dof, which, |q| *q *= x));
            let joints = o.joints.iter_mut().enumerate();
            let own = joints.filter(|(j, _)| which.contains(j));
            own.for_each(|(_, joint)| joint.acceleration.iter_mut().for_each(|a| *a *= x));
        }
        (Place::Joints(which), Change::Offset(x)) => {
            let rows = positions.into_iter();
            rows.for_each(|rows| each(rows, dof, which, |q| *q += x));
        }
        (Place::Thrusters(two), Change::Exchanged) => {
            for firing in &mut segment.firings {
                if let Some(place) = two.iter().position(|k| *k == firing.thruster) {
                    firing.thruster = two[two.len() - 1 - place];
                }
            }
        }
        // The grid holds the edges; the impulse stays.
        (Place::Pulses, Change::Late(x)) => {
            for firing in &mut segment.firings {
                let edges = [firing.start_s, firing.end_s].map(|t| nearest(&o.time_s, t - x));
                let length = firing.end_s - firing.start_s;
                let [start_s, end_s] = edges.map(|k| o.time_s[k]);
                if end_s > start_s {
                    firing.force *= length / (end_s - start_s);
                    (firing.start_s, firing.end_s) = (start_s, end_s);
                }
            }
        }
        // The impulse tells the length: the edges stay.
        (Place::Pulses, Change::ClosesLate(x)) => {
            for firing in &mut segment.firings {
                let length = firing.end_s - firing.start_s;
                firing.force *= (1.0 + x / length).max(0.0);
            }
        }
        (Place::Frame, Change::OrbitalAxes(rate, rates)) => turn_frame(segment, rate, rates),
        (Place::Sensor(k), Change::Late(x)) => {
            if let Some(sensor) = o.sensors.get_mut(*k) {
                for sample in &mut sensor.samples {
                    let [from, to] = [sample.from, sample.to].map(|k| o.time_s[k] - x);
                    (sample.from, sample.to) = (nearest(&o.time_s, from), nearest(&o.time_s, to));
                }
                sensor.samples.dedup_by_key(|sample| sample.to);
            }
        }
        (Place::Sensor(k), change) => {
            let Some(sensor) = o.sensors.get_mut(*k) else {
                return;
            };
            for sample in &mut sensor.samples {
                let R_NB = s.R_NB.get(nearest(&s.time_s, o.time_s[sample.to]));
                if let SensorValue::Vector(v) = &mut sample.value {
                    *v = turned(change, R_NB, v);
                }
            }
            let start = &mut s.translation;
            let read: Vec<&mut Vec<Vector3>> = match sensor.kind {
                _ if sensor.body != 0 => Vec::new(),
                SensorKind::Gyro => vec![&mut s.w_NB_B],
                // Of a velocity or a position alone, the other is made from it.
                _ => start
                    .iter_mut()
                    .flat_map(|t| [&mut t.v_NBo_N, &mut t.p_NoBo_N])
                    .collect(),
            };
            for values in read {
                let all = values.iter_mut().zip(&s.R_NB);
                all.for_each(|(v, R_NB)| *v = turned(change, Some(R_NB), v));
            }
        }
        _ => {}
    }
}

/// Attitudes of the base, and rates if they are too, relative to axes that turn about -y, relative to those at time zero.
fn turn_frame(segment: &mut Segment, rate: f64, rates: bool) {
    let turn = |t: f64| UnitQuaternion::from_axis_angle(&-Vector3::y_axis(), rate * t);
    let (o, s) = (&mut segment.observations, &mut segment.samples);
    let carried: Vec<Vector3> = s
        .R_NB
        .iter()
        .filter(|_| rates)
        .map(|R| R.inverse() * -Vector3::y() * rate)
        .collect();
    for sensor in o.sensors.iter_mut().filter(|sensor| sensor.body == 0) {
        for sample in &mut sensor.samples {
            let t = o.time_s[sample.to];
            match (sensor.kind, &mut sample.value) {
                (SensorKind::Attitude, SensorValue::Attitude(R)) => *R = turn(t) * *R,
                (SensorKind::Gyro, SensorValue::Vector(w)) if !carried.is_empty() => {
                    *w += carried[nearest(&s.time_s, t)];
                }
                _ => {}
            }
        }
    }
    s.w_NB_B
        .iter_mut()
        .zip(carried)
        .for_each(|(w, own)| *w += own);
    for (R, t) in s.R_NB.iter_mut().zip(&s.time_s) {
        *R = turn(*t) * *R;
    }
}

/// The place of the nearest of times.
fn nearest(times: &[f64], t: f64) -> usize {
    let next = times.partition_point(|x| *x < t).min(times.len() - 1);
    let before = next.saturating_sub(1);
    match times[next] - t < t - times[before] {
        true => next,
        false => before,
    }
}

/// Changes these places of every row.
fn each(rows: &mut [f64], width: usize, places: &[usize], change: impl Fn(&mut f64)) {
    for k in places {
        rows.iter_mut().skip(*k).step_by(width).for_each(&change);
    }
}

/// Exchanges two places of every row.
fn exchange<T>(rows: &mut [T], width: usize, two: &[usize]) {
    if let [i, j] = *two
        && width > i.max(j)
    {
        rows.chunks_exact_mut(width).for_each(|row| row.swap(i, j));
    }
}
