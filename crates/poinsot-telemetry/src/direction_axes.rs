//! Directions against the gyro: a direction that rests in inertial axes turns in the body by the opposite of its rate, so other
//! axes of its sensor show.

use crate::hypothesis::{Axes, DECISIVE, EXPLAINED};
use crate::rate_pairs::integrals;
use crate::{Channel, Table, full_name, rotation};
use nalgebra::{Rotation3, Vector3};
use poinsot_files::{Faults, Place, rounded};

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

/// Tests every direction against the first gyro.
///
/// # Errors
/// E0215 names the axes that fit best.
pub(crate) fn check(table: &Table) -> Result<(), Faults> {
    let named = table.channels.iter().filter(|c| c.name == "direction_x");
    for sensor in named.map(|c| c.sensor.as_str()) {
        if let Some((least, declared, best)) = contradicted(table, sensor) {
            let (least, declared) = (rounded(least, 4), rounded(declared, 4));
            let direction = full_name(sensor, "direction_x..z");
            return Err(Faults::one(
                "E0215",
                Place::default(),
                format!(
                    "direction '{direction}' and gyro contradict each other: residual {declared} rad/s, but {least} rad/s with body axes = sensor {best}"
                ),
                "correct the map or the file",
            ));
        }
    }
    Ok(())
}

/// The residual in the best axes and as declared, rad/s, and those axes, where they contradict the declared ones.
fn contradicted(table: &Table, sensor: &str) -> Option<(f64, f64, Axes)> {
    let all = intervals(table, sensor)?;
    let length: f64 = all.iter().map(|i| i.length_s).sum::<f64>() / all.len() as f64;
    let mean = |of: &dyn Fn(&Interval) -> f64| {
        (all.iter().map(of).sum::<f64>() / all.len() as f64).sqrt() / length
    };
    let residual = |axes: Axes| {
        let read = |v: &Vector3<f64>| turned(axes, v);
        mean(&|i| (i.turn * read(&i.to) - read(&i.from)).norm_squared())
    };
    let rate = mean(&|i| (i.to - i.from).norm_squared());
    let mut each: Vec<(f64, Axes)> = Axes::all().map(|a| (residual(a), a)).collect();
    each.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (least, best) = *each.first()?;
    let declared = residual(Axes::IDENTITY);
    let contradicted = least < EXPLAINED * rate && declared > DECISIVE * least;
    contradicted.then_some((least, declared, best))
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
    let angles = integrals(gyro, times);
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
