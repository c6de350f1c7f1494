//! Standard column names: quantity, unit and axes.

use crate::Dimension;

/// A parsed column name.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ChannelName {
    /// The standard name without its sensor, for example `omega_x` or `joint1_rad_s`.
    pub name: String,
    /// Sensor of a column `<sensor>.<name>`; empty otherwise.
    pub sensor: String,
    /// The joint, wheel or thruster of a `<name>_<unit>` column; empty otherwise.
    pub subject: String,
    /// Dimension; values are in its SI unit.
    pub dimension: Dimension,
    /// `body`, `inertial`, or empty for a scalar.
    pub frame: &'static str,
}

impl ChannelName {
    /// Prefix and axis of a component of a vector or quaternion, such as `omega` and `x`.
    pub fn vector(&self) -> Option<(&str, &str)> {
        let parts = self.name.rsplit_once('_');
        parts.filter(|_| !self.frame.is_empty())
    }

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

/// Prefix, dimension and axes of a vector, or of a quaternion.
type Vector = (&'static str, Dimension, &'static str);

const VECTORS: [Vector; 13] = {
    use Dimension as D;
    [
        // Angular velocity and acceleration of the base.
        ("omega", D::AngularVelocity, "body"),
        ("domega", D::AngularAcceleration, "body"),
        // Position relative to the attracting body on the reference orbit.
        ("orbit", D::Length, "inertial"),
        ("r", D::Length, "inertial"),
        ("v", D::Velocity, "inertial"),
        // Velocity increment, specific force.
        ("dv", D::Velocity, "inertial"),
        ("acc", D::Acceleration, "body"),
        // A measured direction, and the vector whose direction it is.
        ("direction", D::One, "body"),
        ("reference", D::One, "inertial"),
        // Attitude of the base, Hamilton, body to inertial.
        ("q", D::One, "inertial"),
        // Attitude, position and velocity of a body in the axes of the body from which it is seen.
        ("relative_q", D::One, "body"),
        ("relative_r", D::Length, "body"),
        ("relative_v", D::Velocity, "body"),
    ]
};

/// Components of a vector with this prefix: four of a quaternion.
pub(crate) fn components(prefix: &str) -> &'static [&'static str] {
    match prefix {
        "q" | "relative_q" => &["x", "y", "z", "w"],
        _ => &["x", "y", "z"],
    }
}

/// Suffix of a named scalar, longest first, and its dimension: an angle, a displacement, a speed of a joint or wheel, a torque or force.
const SUFFIXES: [(&str, Dimension); 8] = [
    ("_rad_s2", Dimension::AngularAcceleration),
    ("_rad_s", Dimension::AngularVelocity),
    ("_m_s2", Dimension::Acceleration),
    ("_rad", Dimension::Angle),
    ("_m_s", Dimension::Velocity),
    ("_Nm", Dimension::Torque),
    ("_m", Dimension::Length),
    ("_N", Dimension::Force),
];

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
/// use poinsot_telemetry::classify;
///
/// let gyro = classify("imu2.omega_x").unwrap();
/// assert_eq!((gyro.sensor.as_str(), gyro.dimension.si()), ("imu2", "rad/s"));
/// assert_eq!(gyro.vector(), Some(("omega", "x")));
/// let wheel = classify("wheel1_rad_s").unwrap();
/// assert_eq!((wheel.subject.as_str(), wheel.dimension.si()), ("wheel1", "rad/s"));
/// assert!(classify("GYR_X").is_none());
/// ```
pub fn classify(column: &str) -> Option<ChannelName> {
    let (sensor, name) = match column.rsplit_once('.') {
        Some((sensor, name)) if !sensor.is_empty() => (sensor, name),
        Some(_) => return None,
        None => ("", column),
    };
    let built = |dimension, frame, subject: &str| ChannelName {
        name: name.to_owned(),
        sensor: sensor.to_owned(),
        subject: subject.to_owned(),
        dimension,
        frame,
    };
    if name == "time_s" {
        return sensor.is_empty().then(|| built(Dimension::Time, "", ""));
    }
    if let Some((prefix, axis)) = name.rsplit_once('_') {
        let known = components(prefix).contains(&axis);
        let vector = VECTORS.iter().find(|v| v.0 == prefix);
        if let (true, Some((_, dimension, frame))) = (known, vector) {
            return Some(built(*dimension, frame, ""));
        }
    }
    for (suffix, dimension) in SUFFIXES {
        if let Some(subject) = name.strip_suffix(suffix).filter(|s| !s.is_empty()) {
            return Some(built(dimension, "", subject));
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unit_the_longest_suffix_wins() {
        for (column, subject, si) in [
            ("joint1_rad", "joint1", "rad"),
            ("joint1_rad_s", "joint1", "rad/s"),
            ("joint1_rad_s2", "joint1", "rad/s2"),
            ("boom_m", "boom", "m"),
            ("boom_m_s", "boom", "m/s"),
            ("boom_m_s2", "boom", "m/s2"),
            ("wheel2_Nm", "wheel2", "N m"),
            ("thr12_N", "thr12", "N"),
            ("my_rad_m", "my_rad", "m"),
        ] {
            let name = classify(column).unwrap();
            assert_eq!((name.subject.as_str(), name.dimension.si()), (subject, si));
            assert_eq!(name.vector(), None);
        }
    }

    #[test]
    fn unit_vectors_carry_their_axes() {
        let name = classify("imu2.omega_z").unwrap();
        assert_eq!((name.sensor.as_str(), name.frame), ("imu2", "body"));
        assert_eq!(name.vector(), Some(("omega", "z")));
        assert_eq!(name.full(), "imu2.omega_z");
        assert_eq!(classify("v_y").unwrap().frame, "inertial");
        assert_eq!(classify("q_w").unwrap().vector(), Some(("q", "w")));
        let name = classify("camera.relative_q_w").unwrap();
        assert_eq!(name.vector(), Some(("relative_q", "w")));
        assert_eq!((name.sensor.as_str(), name.frame), ("camera", "body"));
        assert_eq!(classify("dv_x").unwrap().vector(), Some(("dv", "x")));
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
