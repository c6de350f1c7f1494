//! Attitudes and rates in other axes than the usual ones: relative to orbital axes, and rates in inertial axes.

use crate::mounting::each_row;
use crate::{Channel, OrbitalMap, Table, resample_attitude};
use nalgebra::{Quaternion, UnitQuaternion, Vector3};

/// Replaces attitudes relative to the orbital frame, and rates if they are too, by those relative to inertial axes: the orbital
/// axes at time zero (x along the velocity, y opposite to the orbit normal, z down), which turn about -y.
pub(crate) fn to_inertial(table: &mut Table, map: &OrbitalMap) {
    // Of orbital axes in those at time zero.
    let turn = |t: f64| UnitQuaternion::from_axis_angle(&-Vector3::y_axis(), map.rate_rad_s * t);
    if map.rates {
        each_rate(table, |q, w| {
            w + q.inverse() * -Vector3::y() * map.rate_rad_s
        });
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
}

/// Turns rates in inertial axes to those of the body.
pub(crate) fn to_body(table: &mut Table) {
    each_rate(table, |q, w| q.inverse() * w);
    let repair = "rates turned from inertial axes to those of the body";
    table.repairs.push(repair.to_owned());
}

/// Changes each angular velocity by the first attitude at its time; those without one are left out.
fn each_rate(
    table: &mut Table,
    change: impl Fn(UnitQuaternion<f64>, Vector3<f64>) -> Vector3<f64>,
) {
    let first: Option<[Channel; 4]> = table.vectors("q").first().and_then(|places| {
        let own = places
            .iter()
            .filter_map(|k| table.channels.get(*k).cloned());
        own.collect::<Vec<_>>().try_into().ok()
    });
    let Some(attitude) = first else { return };
    for places in table.vectors("omega") {
        each_row(&mut table.channels, &places, |time, row| {
            let q = resample_attitude(attitude.each_ref(), None, &[time], None);
            if let ([x, y, z], [Some([a, b, c, d])]) = (row, q.as_slice()) {
                let q = UnitQuaternion::new_normalize(Quaternion::new(*d, *a, *b, *c));
                let w = change(q, Vector3::new(*x, *y, *z));
                (*x, *y, *z) = (w.x, w.y, w.z);
                return Some(());
            }
            None
        });
    }
}
