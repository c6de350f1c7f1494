//! A record as it would be read by another convention.

use super::table::{Change, Convention, Place, changed};
use crate::fit::experiment::Experiment;
use crate::problem::segment::Segment;
use poinsot_model::SensorKind;

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
            for k in which {
                if let Some(spin) = other.nominal_spin.get_mut(*k) {
                    *spin *= x;
                }
            }
            ask(&other)
        }
        (Place::Thruster(k), Change::Factor(x)) => {
            if let Some(thruster) = other.thrusters.get_mut(*k) {
                thruster.direction_B *= x;
            }
            ask(&other)
        }
        _ => {
            let mut segments = experiment.problem.segments.to_vec();
            for segment in &mut segments {
                put_segment_right(segment, convention, experiment);
            }
            let problem = experiment.problem.with_segments(&segments);
            ask(&experiment.with_problem(&problem))
        }
    }
}

fn put_segment_right(segment: &mut Segment, convention: &Convention, experiment: &Experiment) {
    let (dof, wheels) = (
        experiment.problem.tree.dof(),
        experiment.problem.model.wheels.len(),
    );
    let o = &mut segment.observations;
    let s = &mut segment.samples;
    match (&convention.place, convention.change) {
        (Place::Wheels(which), Change::ExchangedWith(j)) => {
            for i in which {
                exchange(&mut o.wheel_speed, wheels, *i, j);
                exchange(&mut o.smooth_wheel_speed, wheels, *i, j);
                exchange(&mut s.wheel_speed, wheels, *i, j);
                let all = o.wheels.len();
                exchange(&mut o.wheels, all, *i, j);
            }
        }
        (Place::Joint(i), Change::ExchangedWith(j)) => {
            for rows in [
                &mut o.joint_position,
                &mut o.joint_rate,
                &mut s.joint_position,
                &mut s.joint_rate,
            ] {
                exchange(rows, dof, *i, j);
            }
            let all = o.joints.len();
            exchange(&mut o.joints, all, *i, j);
        }
        (Place::Joint(k), Change::Factor(x)) => {
            for rows in [
                &mut o.joint_position,
                &mut o.joint_rate,
                &mut s.joint_position,
                &mut s.joint_rate,
            ] {
                rows.iter_mut().skip(*k).step_by(dof).for_each(|q| *q *= x);
            }
        }
        (Place::Joint(k), Change::Offset(x)) => {
            for rows in [&mut o.joint_position, &mut s.joint_position] {
                rows.iter_mut().skip(*k).step_by(dof).for_each(|q| *q += x);
            }
        }
        // The impulse tells the length: the edges stay.
        (Place::Pulses, Change::Offset(x)) => {
            for firing in &mut segment.firings {
                let length = firing.end_s - firing.start_s;
                firing.force *= (1.0 + x / length).max(0.0);
            }
        }
        (Place::Sensor(k), change) => {
            let Some(sensor) = o.sensors.get_mut(*k) else {
                return;
            };
            for sample in &mut sensor.samples {
                sample.value = changed(sample.value, change);
            }
            if sensor.kind == SensorKind::Gyro && sensor.body == 0 {
                for w in &mut s.w_NB_B {
                    *w = match change {
                        Change::Axes(m) => m * *w,
                        Change::Factor(x) => x * *w,
                        _ => *w,
                    };
                }
            }
        }
        _ => {}
    }
}

/// Exchanges two places of every row.
fn exchange<T>(rows: &mut [T], width: usize, i: usize, j: usize) {
    if width > i.max(j) {
        rows.chunks_exact_mut(width).for_each(|row| row.swap(i, j));
    }
}
