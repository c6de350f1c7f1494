//! Attitudes and rates in other axes than the usual ones: relative to orbital axes, and rates in inertial axes.

use crate::error::map_of;
use crate::mounting::each_row;
use crate::{Channel, OrbitalMap, Table, resample_attitude};
use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use poinsot_files::{Faults, counted};

/// Replaces attitudes relative to the orbital frame, and rates if they are too, by those relative to inertial axes: the orbital
/// axes at time zero (x along the velocity, y opposite to the orbit normal, z down), which turn about -y.
///
/// # Errors
/// The rates are relative to it, and there is no attitude.
pub(crate) fn to_inertial(table: &mut Table, map: &OrbitalMap) -> Result<(), Faults> {
    // Of orbital axes in those at time zero.
    let turn = |t: f64| UnitQuaternion::from_axis_angle(&-Vector3::y_axis(), map.rate_rad_s * t);
    if map.rates {
        each_rate(table, "orbital_frame", |q, w| {
            w + q.inverse() * -Vector3::y() * map.rate_rad_s
        })?;
    }
    for places in table.vectors("q") {
        each_row(&mut table.channels, &places, |time, row| {
            if let [x, y, z, w] = row {
                let q = turn(time) * UnitQuaternion::new_unchecked(Quaternion::new(*w, *x, *y, *z));
                (*x, *y, *z, *w) = (q.i, q.j, q.k, q.w);
            }
            Some(())
        });
    }
    let rates = if map.rates { " and rates" } else { "" };
    table.repairs.push(format!(
        "attitudes{rates} turned from orbital axes, which turn by {} rad/s about -y, to those at time zero",
        map.rate_rad_s
    ));
    Ok(())
}

/// Turns rates in inertial axes to those of the body.
///
/// # Errors
/// There is no attitude.
pub(crate) fn to_body(table: &mut Table) -> Result<(), Faults> {
    each_rate(table, "inertial_rates", |q, w| q.inverse() * w)?;
    let repair = "rates turned from inertial axes to those of the body";
    table.repairs.push(repair.to_owned());
    Ok(())
}

/// Changes each angular velocity by the first attitude at its time; those without one are left out and counted.
fn each_rate(
    table: &mut Table,
    key: &str,
    change: impl Fn(UnitQuaternion<f64>, Vector3<f64>) -> Vector3<f64>,
) -> Result<(), Faults> {
    let first: Option<[Channel; 4]> = table.vectors("q").first().and_then(|places| {
        let own = places
            .iter()
            .filter_map(|k| table.channels.get(*k).cloned());
        own.collect::<Vec<_>>().try_into().ok()
    });
    let attitude = first.ok_or_else(|| {
        let problem = "the rates can be turned only by an attitude, and the files have none";
        map_of(
            "E0212",
            key,
            problem.to_owned(),
            "add the attitude, or remove the key",
        )
    })?;
    for places in table.vectors("omega") {
        let mut lost = 0;
        each_row(&mut table.channels, &places, |time, row| {
            let q = resample_attitude(attitude.each_ref(), None, &[time]);
            if let ([x, y, z], [Some([a, b, c, d])]) = (row, q.as_slice()) {
                let q = UnitQuaternion::new_normalize(Quaternion::new(*d, *a, *b, *c));
                let w = change(q, Vector3::new(*x, *y, *z));
                (*x, *y, *z) = (w.x, w.y, w.z);
                return Some(());
            }
            lost += 1;
            None
        });
        if lost > 0 {
            table.repairs.push(format!(
                "{} of the angular velocity left out: no attitude at the same time",
                counted(lost, "sample")
            ));
        }
    }
    Ok(())
}
