//! Directions against the gyro: a direction that rests in inertial axes turns in the body by the opposite of its rate, so other
//! axes of its sensor show.

use super::pairs::integrals;
use super::reading::{Axes, GyroUnit, Hypothesis};
use super::{Search, search};
use crate::{Channel, Table, rotation};
use nalgebra::{Rotation3, Vector3};

/// Turn between compared samples, rad.
const TURN: f64 = 0.1;
/// Share of that by which the reference may turn in inertial axes.
const AT_REST: f64 = 0.1;
/// Fewest compared intervals.
const FEW: usize = 8;

/// An interval: the direction at both ends, the turn of the body in between, and its length.
struct Interval {
    from: Vector3<f64>,
    to: Vector3<f64>,
    turn: Rotation3<f64>,
    length_s: f64,
}

/// A direction in all axes of its sensor against the first gyro.
pub(super) fn test(table: &Table, sensor: &str) -> Option<Search> {
    let all = intervals(table, sensor)?;
    let length: f64 = all.iter().map(|i| i.length_s).sum::<f64>() / all.len() as f64;
    let mean = |of: &dyn Fn(&Interval) -> f64| {
        (all.iter().map(of).sum::<f64>() / all.len() as f64).sqrt() / length
    };
    let read = |axes: Axes| {
        let apart = |i: &Interval| i.turn * turned(axes, &i.to) - turned(axes, &i.from);
        let residual = mean(&|i| apart(i).norm_squared());
        Hypothesis::of_rates(GyroUnit::AsDeclared, axes, residual)
    };
    let rate = mean(&|i| (i.to - i.from).norm_squared());
    search(Axes::all().map(read).collect(), rate, false)
}

fn turned(axes: Axes, v: &Vector3<f64>) -> Vector3<f64> {
    Vector3::from_fn(|i, _| f64::from(axes.sign[i]) * v[axes.axis[i]])
}

fn vector(table: &Table, sensor: &str, names: [&str; 3]) -> Option<Vec<Vector3<f64>>> {
    let [x, y, z] = names.map(|name| table.sensor_channel(sensor, name));
    let (x, y, z) = (x?, y?, z?);
    let same = x.time_s == y.time_s && x.time_s == z.time_s;
    let all = x.values.iter().zip(&y.values).zip(&z.values);
    same.then(|| {
        all.map(|((x, y), z)| Vector3::new(*x, *y, *z).normalize())
            .collect()
    })
}

/// Intervals in which the body turns enough; `None` where they are few, or the reference turns too.
fn intervals(table: &Table, sensor: &str) -> Option<Vec<Interval>> {
    let seen = vector(table, sensor, ["direction_x", "direction_y", "direction_z"])?;
    let times = &table.sensor_channel(sensor, "direction_x")?.time_s;
    let gyro =
        ["omega_x", "omega_y", "omega_z"].map(|n| table.channels.iter().find(|c| c.name == n));
    let [x, y, z] = gyro;
    let gyro: [&Channel; 3] = [x?, y?, z?];
    let angles = integrals(&gyro, times);
    let known = ["reference_x", "reference_y", "reference_z"];
    let reference = vector(table, sensor, known).filter(|r| r.len() == seen.len());
    let mut list = Vec::new();
    let mut from: Option<usize> = None;
    for to in 0..seen.len() {
        let at = |k: usize| angles.get(k).copied().flatten();
        let (Some((run, angle)), Some(start)) = (at(to), from) else {
            from = at(to).map(|_| to);
            continue;
        };
        let (before, begun) = at(start)?;
        let phi = Vector3::from_fn(|i, _| angle[i] - begun[i]);
        if before != run {
            from = Some(to);
        } else if phi.norm() > TURN {
            let turn = rotation::of_vector(phi.into());
            let (a, b) = (*seen.get(start)?, *seen.get(to)?);
            let rests = reference
                .as_ref()
                .is_none_or(|r| (r[to] - r[start]).norm() < AT_REST * TURN);
            if rests {
                list.push(Interval {
                    from: a,
                    to: b,
                    turn,
                    length_s: times[to] - times[start],
                });
            }
            from = Some(to);
        }
    }
    (list.len() >= FEW).then_some(list)
}
