//! Standard column names: quantity, unit and axes.

use crate::Dimension;
use serde::Serialize;

/// What a standard channel measures.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Quantity {
    /// `time_s`: the time of the row.
    Time,
    /// `q_x q_y q_z q_w`: attitude of the base, Hamilton, body to inertial; the index is 0..=3 for x, y, z, w.
    Attitude(usize),
    /// `omega_x..`: angular velocity of the base, body axes.
    AngularVelocity(usize),
    /// `domega_x..`: angular acceleration of the base, body axes.
    AngularAcceleration(usize),
    /// `r_x..`: position, inertial axes.
    Position(usize),
    /// `v_x..`: velocity, inertial axes.
    Velocity(usize),
    /// `dv_x..`: velocity increment, inertial axes.
    VelocityIncrement(usize),
    /// `acc_x..`: specific force, body axes.
    SpecificForce(usize),
    /// `direction_x..`: measured direction, body axes.
    Direction(usize),
    /// `reference_x..`: the vector whose direction is measured, inertial axes.
    Reference(usize),
    /// `relative_q_x relative_q_y relative_q_z relative_q_w`: attitude of a body in the axes of the body from which it is
    /// seen, Hamilton; the index is 0..=3 for x, y, z, w.
    RelativeAttitude(usize),
    /// `relative_r_x..`: position from the origin of the body from which it is seen, in its axes.
    RelativePosition(usize),
    /// `relative_v_x..`: rate of change of that position, in the same axes.
    RelativeVelocity(usize),
    /// `orbit_x..`: position relative to the attracting body on the reference orbit, inertial axes.
    OrbitPosition(usize),
    /// `<name>_rad`: angle of a joint.
    Angle,
    /// `<name>_rad_s`: rate of a joint or speed of a wheel.
    AngleRate,
    /// `<name>_rad_s2`: second derivative of a joint angle.
    AngleAcceleration,
    /// `<name>_Nm`: torque of a joint or a wheel's motor.
    Torque,
    /// `<name>_m`: displacement of a prismatic joint.
    Displacement,
    /// `<name>_m_s`: rate of a prismatic joint.
    DisplacementRate,
    /// `<name>_m_s2`: second derivative of a prismatic joint's displacement.
    DisplacementAcceleration,
    /// `<name>_N`: thrust, or force of a prismatic joint.
    Force,
}

/// A parsed column name.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ChannelName {
    /// The standard name without its sensor, for example `omega_x` or `joint1_rad_s`.
    pub name: String,
    /// Sensor of a column `<sensor>.<name>`; empty otherwise.
    pub sensor: String,
    /// The joint, wheel or thruster of a `<name>_<unit>` column; empty otherwise.
    pub subject: String,
    /// Measured quantity.
    pub quantity: Quantity,
    /// Dimension; values are in its SI unit.
    pub dimension: Dimension,
    /// `body`, `inertial`, or empty for a scalar.
    pub frame: &'static str,
}

impl ChannelName {
    /// Column header: `<sensor>.<name>` or `<name>`.
    pub fn full(&self) -> String {
        full_name(&self.sensor, &self.name)
    }
}

/// `<sensor>.<name>`, or `<name>` if the sensor is empty.
///
/// ```
/// use poinsot_telemetry::full_name;
///
/// assert_eq!(full_name("imu2", "omega_x"), "imu2.omega_x");
/// assert_eq!(full_name("", "omega_x"), "omega_x");
/// ```
pub fn full_name(sensor: &str, name: &str) -> String {
    if sensor.is_empty() {
        name.to_owned()
    } else {
        format!("{sensor}.{name}")
    }
}

type Vector = (&'static str, fn(usize) -> Quantity, Dimension, &'static str);

/// Prefix of a three-vector's columns, quantity, dimension, axes.
const VECTORS: [Vector; 13] = {
    use Dimension as D;
    use Quantity as Q;
    [
        ("omega", Q::AngularVelocity, D::AngularVelocity, "body"),
        (
            "domega",
            Q::AngularAcceleration,
            D::AngularAcceleration,
            "body",
        ),
        ("orbit", Q::OrbitPosition, D::Length, "inertial"),
        ("r", Q::Position, D::Length, "inertial"),
        ("v", Q::Velocity, D::Velocity, "inertial"),
        ("dv", Q::VelocityIncrement, D::Velocity, "inertial"),
        ("acc", Q::SpecificForce, D::Acceleration, "body"),
        ("direction", Q::Direction, D::One, "body"),
        ("reference", Q::Reference, D::One, "inertial"),
        ("q", Q::Attitude, D::One, "inertial"),
        ("relative_q", Q::RelativeAttitude, D::One, "body"),
        ("relative_r", Q::RelativePosition, D::Length, "body"),
        ("relative_v", Q::RelativeVelocity, D::Velocity, "body"),
    ]
};

/// Components of a vector with this prefix: four of a quaternion.
pub(crate) fn components(prefix: &str) -> &'static [&'static str] {
    match prefix {
        "q" | "relative_q" => &["x", "y", "z", "w"],
        _ => &["x", "y", "z"],
    }
}

/// Suffix of a named scalar, longest first, with quantity and dimension.
const SUFFIXES: [(&str, Quantity, Dimension); 8] = {
    use Dimension as D;
    use Quantity as Q;
    [
        ("_rad_s2", Q::AngleAcceleration, D::AngularAcceleration),
        ("_rad_s", Q::AngleRate, D::AngularVelocity),
        ("_m_s2", Q::DisplacementAcceleration, D::Acceleration),
        ("_rad", Q::Angle, D::Angle),
        ("_m_s", Q::DisplacementRate, D::Velocity),
        ("_Nm", Q::Torque, D::Torque),
        ("_m", Q::Displacement, D::Length),
        ("_N", Q::Force, D::Force),
    ]
};

/// Standard names that belong to no joint, wheel or thruster.
///
/// ```
/// let names = poinsot_telemetry::vector_channels();
/// assert_eq!(names[0], "time_s");
/// assert!(names.contains(&"q_w".to_owned()) && names.contains(&"omega_z".to_owned()));
/// ```
pub fn vector_channels() -> Vec<String> {
    let all = VECTORS.iter().flat_map(|(prefix, ..)| {
        let names = components(prefix).iter();
        names.map(move |axis| format!("{prefix}_{axis}"))
    });
    std::iter::once("time_s".to_owned()).chain(all).collect()
}

/// Parses a column name; `None` if it is not a standard name.
///
/// ```
/// use poinsot_telemetry::{Quantity, classify};
///
/// let gyro = classify("imu2.omega_x").unwrap();
/// assert_eq!((gyro.sensor.as_str(), gyro.dimension.si()), ("imu2", "rad/s"));
/// assert_eq!(gyro.quantity, Quantity::AngularVelocity(0));
/// let wheel = classify("wheel1_rad_s").unwrap();
/// assert_eq!((wheel.subject.as_str(), wheel.quantity), ("wheel1", Quantity::AngleRate));
/// assert!(classify("GYR_X").is_none());
/// ```
pub fn classify(column: &str) -> Option<ChannelName> {
    let (sensor, name) = match column.rsplit_once('.') {
        Some((sensor, name)) if !sensor.is_empty() => (sensor, name),
        Some(_) => return None,
        None => ("", column),
    };
    let built = |quantity, dimension, frame, subject: &str| ChannelName {
        name: name.to_owned(),
        sensor: sensor.to_owned(),
        subject: subject.to_owned(),
        quantity,
        dimension,
        frame,
    };
    if name == "time_s" {
        return sensor
            .is_empty()
            .then(|| built(Quantity::Time, Dimension::Time, "", ""));
    }
    if let Some((prefix, axis)) = name.rsplit_once('_') {
        let axis = components(prefix).iter().position(|own| *own == axis);
        let vector = VECTORS.iter().find(|v| v.0 == prefix);
        if let (Some(axis), Some(&(_, quantity, dimension, frame))) = (axis, vector) {
            return Some(built(quantity(axis), dimension, frame, ""));
        }
    }
    for (suffix, quantity, dimension) in SUFFIXES {
        if let Some(subject) = name.strip_suffix(suffix).filter(|s| !s.is_empty()) {
            return Some(built(quantity, dimension, "", subject));
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unit_the_longest_suffix_wins() {
        for (column, subject, quantity, si) in [
            ("joint1_rad", "joint1", Quantity::Angle, "rad"),
            ("joint1_rad_s", "joint1", Quantity::AngleRate, "rad/s"),
            (
                "joint1_rad_s2",
                "joint1",
                Quantity::AngleAcceleration,
                "rad/s2",
            ),
            ("boom_m", "boom", Quantity::Displacement, "m"),
            ("boom_m_s", "boom", Quantity::DisplacementRate, "m/s"),
            (
                "boom_m_s2",
                "boom",
                Quantity::DisplacementAcceleration,
                "m/s2",
            ),
            ("wheel2_Nm", "wheel2", Quantity::Torque, "N m"),
            ("thr12_N", "thr12", Quantity::Force, "N"),
            ("my_rad_m", "my_rad", Quantity::Displacement, "m"),
        ] {
            let name = classify(column).unwrap();
            assert_eq!(
                (name.subject.as_str(), name.quantity, name.dimension.si()),
                (subject, quantity, si)
            );
        }
    }

    #[test]
    fn unit_vectors_carry_their_axes() {
        let name = classify("imu2.omega_z").unwrap();
        assert_eq!((name.sensor.as_str(), name.frame), ("imu2", "body"));
        assert_eq!(name.quantity, Quantity::AngularVelocity(2));
        assert_eq!(name.full(), "imu2.omega_z");
        assert_eq!(classify("v_y").unwrap().frame, "inertial");
        assert_eq!(classify("q_w").unwrap().quantity, Quantity::Attitude(3));
        let name = classify("camera.relative_q_w").unwrap();
        assert_eq!(name.quantity, Quantity::RelativeAttitude(3));
        assert_eq!((name.sensor.as_str(), name.frame), ("camera", "body"));
        assert_eq!(
            classify("dv_x").unwrap().quantity,
            Quantity::VelocityIncrement(0)
        );
    }

    #[test]
    fn unit_other_names_are_not_guessed() {
        for column in [
            "wx", "omega_w", "_rad", "", ".omega_x", "t_s", "a.time_s", "Mode",
        ] {
            assert_eq!(classify(column), None, "{column}");
        }
    }
}
