//! Attitudes and rates relative to orbital axes, turned to inertial ones.

use crate::mounting::each_row;
use crate::{Channel, OrbitalMap, Table, resample_attitude};
use nalgebra::{Quaternion, UnitQuaternion, Vector3};

/// Replaces attitudes relative to the orbital frame, and rates if they are too, by those relative to inertial axes: the orbital
/// axes at time zero (x along the velocity, y opposite to the orbit normal, z down), which turn about -y.
pub(crate) fn to_inertial(table: &mut Table, map: &OrbitalMap) {
    // Of orbital axes in those at time zero.
    let turn = |t: f64| UnitQuaternion::from_axis_angle(&-Vector3::y_axis(), map.rate_rad_s * t);
    let attitudes = table.vectors("q");
    let first: Option<[Channel; 4]> = attitudes.first().and_then(|places| {
        let own = places
            .iter()
            .filter_map(|k| table.channels.get(*k).cloned());
        own.collect::<Vec<_>>().try_into().ok()
    });
    if let (true, Some(attitude)) = (map.rates, first) {
        let times = attitude[0].time_s.clone();
        let within = |t: f64| match (times.first(), times.last()) {
            (Some(from), Some(to)) => t.clamp(*from, *to),
            _ => t,
        };
        for places in table.vectors("omega") {
            each_row(&mut table.channels, &places, |time, row| {
                let q = resample_attitude(attitude.each_ref(), None, &[within(time)], None);
                if let ([x, y, z], [Some([a, b, c, d])]) = (row, q.as_slice()) {
                    let q = UnitQuaternion::new_normalize(Quaternion::new(*d, *a, *b, *c));
                    let w = q.inverse() * -Vector3::y() * map.rate_rad_s;
                    (*x, *y, *z) = (*x + w.x, *y + w.y, *z + w.z);
                }
            });
        }
    }
    for places in attitudes {
        each_row(&mut table.channels, &places, |time, row| {
            if let [x, y, z, w] = row {
                let q = turn(time) * UnitQuaternion::new_unchecked(Quaternion::new(*w, *x, *y, *z));
                (*x, *y, *z, *w) = (q.i, q.j, q.k, q.w);
            }
        });
    }
    let rates = if map.rates { " and rates" } else { "" };
    table.repairs.push(format!(
        "attitudes{rates} turned from orbital axes, which turn by {} rad/s about -y, to those at time zero",
        map.rate_rad_s
    ));
}
