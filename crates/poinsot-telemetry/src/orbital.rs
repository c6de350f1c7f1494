//! Channels in other axes than the usual ones: relative to orbital axes, rates in inertial axes, velocities and positions in body axes.

use crate::error::map_of;
use crate::mounting::each_row;
use crate::{Channel, OrbitalMap, Table, TelemetryMap, resample_attitude};
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
        each_vector(table, "omega", "orbital_frame", |q, w| {
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

/// Vectors that are in other axes than usual, and that the attitude turns to these.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Turned {
    /// Angular velocities in inertial axes.
    Rates,
    /// Velocities in body axes.
    Velocities,
    /// Positions in body axes.
    Positions,
}

impl Turned {
    pub(crate) const ALL: [Self; 3] = [Self::Rates, Self::Velocities, Self::Positions];

    /// The key of the map that declares them.
    pub fn key(self) -> &'static str {
        match self {
            Self::Rates => "inertial_rates",
            Self::Velocities => "body_velocities",
            Self::Positions => "body_positions",
        }
    }

    pub(crate) fn declared(self, map: &mut TelemetryMap) -> &mut bool {
        match self {
            Self::Rates => &mut map.inertial_rates,
            Self::Velocities => &mut map.body_velocities,
            Self::Positions => &mut map.body_positions,
        }
    }

    /// What is in which axes, and in which it should be.
    pub(crate) fn words(self) -> [&'static str; 3] {
        match self {
            Self::Rates => ["gyro", "inertial", "body"],
            Self::Velocities => ["velocity", "body", "inertial"],
            Self::Positions => ["position", "body", "inertial"],
        }
    }

    /// Turns them.
    ///
    /// # Errors
    /// There is no attitude.
    pub(crate) fn turn(self, table: &mut Table) -> Result<(), Faults> {
        let key = self.key();
        match self {
            Self::Rates => each_vector(table, "omega", key, |q, w| q.inverse() * w)?,
            Self::Velocities => each_vector(table, "v", key, |q, v| q * v)?,
            Self::Positions => each_vector(table, "r", key, |q, r| q * r)?,
        }
        let [what, from, to] = self.words();
        let repair = format!("{what} turned from {from} axes to {to} axes");
        table.repairs.push(repair);
        Ok(())
    }
}

/// Changes each vector with this prefix by the first attitude at its time; those without one are left out and counted.
fn each_vector(
    table: &mut Table,
    prefix: &str,
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
        let problem = "vectors can be turned only by an attitude, and the files have none";
        map_of(
            "E0212",
            key,
            problem.to_owned(),
            "add the attitude, or remove the key",
        )
    })?;
    for places in table.vectors(prefix) {
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
                "{} of {prefix}_x..z left out: no attitude at the same time",
                counted(lost, "sample")
            ));
        }
    }
    Ok(())
}
