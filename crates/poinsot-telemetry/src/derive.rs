//! Groups of columns that give channels together: attitudes in any form, positions in Earth-fixed axes.
#![allow(non_snake_case)]

use crate::columns::Columns;
use crate::conversion::{Conversion, Transform};
use crate::error::map_of;
use crate::instant::EARTH_RATE;
use crate::map::AttitudeForm;
use crate::plan::{Group, Plan, PlannedChannel};
use crate::{Order, Sense, classify};
use nalgebra::{Matrix3, Quaternion, Rotation3, UnitQuaternion, Vector3};
use poinsot_files::{Faults, Place, rounded};
use std::path::Path;

/// Largest |R'R - 1| of a rotation matrix with rounded elements.
const ORTHONORMAL: f64 = 1e-2;

/// Replaces the columns of every group by the derived channels.
///
/// # Errors
/// A matrix is not a rotation, or Earth-fixed axes are used without dates.
pub(crate) fn derive(
    path: &Path,
    plan: &Plan,
    columns: &mut Columns,
) -> Result<Vec<PlannedChannel>, Faults> {
    if plan.groups.is_empty() {
        return Ok(plan.channels.clone());
    }
    let mut channels = Vec::new();
    let (mut values, mut nan_cells) = (Vec::new(), Vec::new());
    let mut parts: Vec<Vec<(usize, Vec<f64>)>> = vec![Vec::new(); plan.groups.len()];
    let read = std::mem::take(&mut columns.values);
    for ((channel, value), nan) in plan.channels.iter().zip(read).zip(&columns.nan_cells) {
        match channel.part {
            Some((group, place)) => {
                if let Some(list) = parts.get_mut(group) {
                    list.push((place, value));
                }
            }
            None => {
                channels.push(channel.clone());
                values.push(value);
                nan_cells.push(*nan);
            }
        }
    }
    for ((k, group), mut parts) in plan.groups.iter().enumerate().zip(parts) {
        parts.sort_by_key(|p| p.0);
        let parts: Vec<Vec<f64>> = parts.into_iter().map(|p| p.1).collect();
        // Every part, or no row has any of them.
        if parts.is_empty() {
            continue;
        }
        let first = plan
            .channels
            .iter()
            .find(|c| c.part.is_some_and(|p| p.0 == k));
        let (index, column) = first.map_or((0, ""), |c| (c.index, c.column.as_str()));
        let mut transform = Transform::from(Conversion::Linear(1.0, 0.0));
        transform.late_s = first.map_or(0.0, |c| c.transform.late_s);
        let (names, made): (Vec<String>, Vec<Vec<f64>>) = match group {
            Group::Attitude { names, form, sense } => {
                let made = attitude(path, column, &columns.rows, &parts, *form, *sense)?;
                (names.to_vec(), made)
            }
            Group::EarthFixed => {
                let made = inertial(path, plan, columns, &parts)?;
                let names = ["orbit_x", "orbit_y", "orbit_z", "v_x", "v_y", "v_z"];
                let names = names.iter().take(made.len());
                (names.map(|n| (*n).to_owned()).collect(), made)
            }
        };
        for (name, value) in names.iter().zip(made) {
            let Some(name) = classify(name) else { continue };
            channels.push(PlannedChannel {
                index,
                column: column.to_owned(),
                name,
                transform: transform.clone(),
                part: None,
                choice: None,
            });
            values.push(value);
            nan_cells.push((0, 0));
        }
    }
    (columns.values, columns.nan_cells) = (values, nan_cells);
    Ok(channels)
}

/// One row of a group; `None` if a cell is empty.
fn row<const N: usize>(parts: &[Vec<f64>], k: usize) -> Option<[f64; N]> {
    let mut out = [0.0; N];
    for (slot, part) in out.iter_mut().zip(parts) {
        *slot = *part.get(k).filter(|x| !x.is_nan())?;
    }
    Some(out)
}

/// Quaternion x, y, z, w of the rotation from body to inertial axes.
fn attitude(
    path: &Path,
    column: &str,
    rows: &[u64],
    parts: &[Vec<f64>],
    form: AttitudeForm,
    sense: Sense,
) -> Result<Vec<Vec<f64>>, Faults> {
    let mut out = vec![Vec::new(); 4];
    // The inverse rotation has the negative vector part.
    let sign = if sense == Sense::InertialToBody {
        -1.0
    } else {
        1.0
    };
    if let AttitudeForm::Quaternion(order) = form {
        let places = match order {
            Order::Xyzw => [0, 1, 2, 3],
            Order::Wxyz => [1, 2, 3, 0],
        };
        let component = |(axis, place): (usize, usize)| {
            let cells = parts.get(place).into_iter().flatten();
            let sign = if axis < 3 { sign } else { 1.0 };
            cells.map(|x| sign * x).collect()
        };
        return Ok(places.into_iter().enumerate().map(component).collect());
    }
    for (k, line) in rows.iter().enumerate() {
        let q = match form {
            AttitudeForm::Matrix => match row::<9>(parts, k) {
                None => None,
                Some(cells) => Some(from_matrix(&cells).map_err(|problem| {
                    let place = Place::cell(path, *line, column);
                    let advice = "correct the row or the order of the columns";
                    Faults::one("E0214", place, problem, advice)
                })?),
            },
            AttitudeForm::Euler(axes) => row::<3>(parts, k).map(|a| euler(axes, a)),
            AttitudeForm::Mrp => row::<3>(parts, k).map(mrp),
            AttitudeForm::VectorPart => match row::<3>(parts, k).map(with_scalar) {
                Some(None) => {
                    let place = Place::cell(path, *line, column);
                    let problem = "the vector part of the quaternion is longer than 1";
                    let advice = "correct the row, or the scale of the columns";
                    return Err(Faults::one("E0214", place, problem, advice));
                }
                q => q.flatten(),
            },
            AttitudeForm::Quaternion(_) => None,
        };
        let q = q.map(|q| match sense {
            Sense::BodyToInertial => q,
            Sense::InertialToBody => q.inverse(),
        });
        let cells = q.map_or([f64::NAN; 4], |q| q.coords.into());
        out.iter_mut().zip(cells).for_each(|(list, x)| list.push(x));
    }
    Ok(out)
}

fn from_matrix(cells: &[f64; 9]) -> Result<UnitQuaternion<f64>, String> {
    let R = Matrix3::from_row_slice(cells);
    let error = (R.transpose() * R - Matrix3::identity()).amax();
    if error > ORTHONORMAL || R.determinant() < 0.0 {
        return Err(format!(
            "the matrix is no rotation (R'R differs from 1 by {}, determinant {})",
            rounded(error, 3),
            rounded(R.determinant(), 3)
        ));
    }
    // The matrix is orthonormal up to rounding, so the normalised quaternion is the nearest rotation to first order.
    let q = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(R));
    Ok(UnitQuaternion::new_normalize(q.into_inner()))
}

/// Intrinsic rotations about the given axes in order.
fn euler(axes: [usize; 3], angles: [f64; 3]) -> UnitQuaternion<f64> {
    let turns = axes.into_iter().zip(angles).map(|(axis, angle)| {
        UnitQuaternion::from_axis_angle(
            &[Vector3::x_axis(), Vector3::y_axis(), Vector3::z_axis()][axis.min(2)],
            angle,
        )
    });
    turns.fold(UnitQuaternion::identity(), |q, turn| q * turn)
}

/// The quaternion with this vector part and a scalar part that is not negative; `None` beyond rounding of length one.
fn with_scalar(v: [f64; 3]) -> Option<UnitQuaternion<f64>> {
    let v = Vector3::from(v);
    let square = 1.0 - v.norm_squared();
    let q = Quaternion::new(square.max(0.0).sqrt(), v.x, v.y, v.z);
    (square > -ORTHONORMAL).then(|| UnitQuaternion::new_normalize(q))
}

/// The quaternion of modified Rodrigues parameters (Schaub and Junkins, 4th ed., eq. 3.144).
fn mrp(sigma: [f64; 3]) -> UnitQuaternion<f64> {
    let s = Vector3::from(sigma);
    let s2 = s.norm_squared();
    let v = s * (2.0 / (1.0 + s2));
    UnitQuaternion::new_normalize(Quaternion::new((1.0 - s2) / (1.0 + s2), v.x, v.y, v.z))
}

/// Rotates positions and velocities by the Earth rotation angle.
fn inertial(
    path: &Path,
    plan: &Plan,
    columns: &Columns,
    parts: &[Vec<f64>],
) -> Result<Vec<Vec<f64>>, Faults> {
    let dated = columns.origin.filter(|o| o.date().is_some());
    let origin = dated.ok_or_else(|| map_of("E0212", "orbit", format!("{}: axes that turn with the Earth need the date, and '{}' counts from an unknown epoch", path.display(), plan.time_column), "name its epoch in [telemetry] time"))?;
    let (position, velocity) = parts.split_at(parts.len().min(3));
    let mut out = vec![Vec::new(); parts.len()];
    for (k, time) in columns.time_s.iter().enumerate() {
        let turn = Rotation3::from_axis_angle(&Vector3::z_axis(), origin.earth_rotation(*time));
        let turned = |parts: &[Vec<f64>]| row::<3>(parts, k).map(|x| turn * Vector3::from(x));
        let nan = Vector3::repeat(f64::NAN);
        let r = turned(position).unwrap_or(nan);
        // Velocity of the rotating axes at this position.
        let carried = Vector3::z() * EARTH_RATE;
        let v = turned(velocity).map_or(nan, |v| v + carried.cross(&r));
        let cells = r.iter().chain(v.iter());
        out.iter_mut()
            .zip(cells)
            .for_each(|(list, x)| list.push(*x));
    }
    Ok(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exact_one_attitude_in_every_form() {
        let (yaw, pitch, roll) = (0.7_f64, -0.3_f64, 1.1_f64);
        let about = |axis: usize, a: f64| {
            let (s, c) = a.sin_cos();
            let mut R = Matrix3::identity();
            let (i, j) = [(1, 2), (2, 0), (0, 1)][axis];
            (R[(i, i)], R[(j, j)], R[(i, j)], R[(j, i)]) = (c, c, -s, s);
            R
        };
        let R = about(2, yaw) * about(1, pitch) * about(0, roll);
        let q = euler([2, 1, 0], [yaw, pitch, roll]);
        assert!((q.to_rotation_matrix().matrix() - R).amax() < 1e-15);
        let rows: [f64; 9] = R.transpose().as_slice().try_into().unwrap();
        assert!(from_matrix(&rows).unwrap().angle_to(&q) < 1e-14);
        let turn = q.scaled_axis();
        let sigma = turn.normalize() * (turn.norm() / 4.0).tan();
        assert!(mrp(sigma.into()).angle_to(&q) < 1e-14);
        let mirrored = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, -1.0];
        assert!(from_matrix(&mirrored).is_err());
    }
}
