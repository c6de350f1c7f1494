use super::{NuisanceFile, SensorUncertaintyFile, SourceFile};
use poinsot_dynamics::SensorKind;
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::Error;
use serde::{Deserialize, Deserializer};
use std::borrow::Cow;

/// A sensor. The unit of `noise_<unit>` and `quantisation_<unit>` is that of its channels: gyro rad_s;
/// attitude and direction rad; position m; velocity and velocity_increment m_s; accelerometer m_s2; joint_position rad
/// or m; joint_rate rad_s or m_s; wheel_speed rad_s; thrust N. A noise is one sigma per sample: a number,
/// three numbers (one per sensor axis), or the 3 x 3 symmetric positive definite square root S of the
/// covariance S S.
#[derive(Debug, Clone, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[allow(non_snake_case)]
pub(crate) struct SensorFile {
    /// Name, unique among sensors of its type.
    #[schemars(required)]
    pub name: Option<String>,
    /// What it measures.
    #[serde(rename = "type")]
    #[schemars(required)]
    pub kind: Option<SensorType>,
    /// Name of its body. Default: the base.
    pub body: Option<String>,
    /// Name of the body from which the sensor sees `body`, as a camera on a servicer sees the captured target. Types that
    /// measure pose or motion in inertial axes can have it. An attitude is that of `body` in the axes of this body; all
    /// else is from the origin of this body, in its axes. The names of its columns begin with `relative_`. Default: seen
    /// from inertial space.
    pub seen_from: Option<String>,
    /// Names of the joints, wheels or thrusters that a joint_position, joint_rate, wheel_speed or thrust
    /// sensor reads: one name or a list. Default: all whose unit fits.
    pub of: Option<NamesFile>,
    /// One sigma per sample of an attitude (small rotation in body axes), a direction (angle across it; one number) or a revolute joint's position, rad.
    pub noise_rad: Option<NoiseFile>,
    /// One sigma per sample of an angular velocity, a revolute joint's rate or a wheel speed, rad/s.
    pub noise_rad_s: Option<NoiseFile>,
    /// One sigma per sample of a position or a prismatic joint's position, m.
    pub noise_m: Option<NoiseFile>,
    /// One sigma per sample of a velocity, a velocity increment or a prismatic joint's rate, m/s.
    pub noise_m_s: Option<NoiseFile>,
    /// One sigma per sample of a specific force, m/s2.
    pub noise_m_s2: Option<NoiseFile>,
    /// One sigma per sample of a thrust, N.
    pub noise_N: Option<NoiseFile>,
    /// Correlation time of the noise of each axis, to 1/e, s (Gauss-Markov). Default: white.
    pub correlation_s: Option<f64>,
    /// Least significant bit, rad. Its variance is LSB^2/12.
    pub quantisation_rad: Option<f64>,
    /// Least significant bit, rad/s.
    pub quantisation_rad_s: Option<f64>,
    /// Least significant bit, m.
    pub quantisation_m: Option<f64>,
    /// Least significant bit, m/s.
    pub quantisation_m_s: Option<f64>,
    /// Least significant bit, m/s2.
    pub quantisation_m_s2: Option<f64>,
    /// Least significant bit, N.
    pub quantisation_N: Option<f64>,
    /// Constant bias: "none" (default), "estimate", or { sigma_<unit> = x } in the unit of the channel. A sensor of joints or
    /// wheels has one for each of them.
    pub bias: Option<NuisanceFile>,
    /// Scale factor error: "none" (default), "estimate", or { sigma = x }. A joint_position or joint_rate sensor has one for each
    /// joint; that of a wheel_speed sensor is part of the wheel's spin inertia, that of a thrust sensor is written on the
    /// thruster.
    pub scale: Option<NuisanceFile>,
    /// Small rotation of the sensor: "none" (default), "estimate", or { sigma_rad = x }.
    pub misalignment: Option<NuisanceFile>,
    /// Small turn of one axis towards another: "none" (default), "estimate", or { sigma_rad = x }.
    pub nonorthogonality: Option<NuisanceFile>,
    /// Delay of the samples, s: "none" (default), "estimate", or { sigma_s = x }.
    pub lag: Option<NuisanceFile>,
    /// Body from sensor: quaternion, Hamilton, scalar last. Default identity. Columns of telemetry are in body axes in
    /// any case: this rotation gives the axes of the sensor's errors (noise, bias, scale).
    pub rotation_xyzw: Option<[f64; 4]>,
    /// The same as a matrix of rows: takes components in the sensor's axes to components in the body's.
    pub rotation_matrix: Option<[[f64; 3]; 3]>,
    /// Position of the sensor from the origin of the body's frame, m. Default zero.
    pub position_m: Option<[f64; 3]>,
    /// Direction: the vector in inertial axes whose direction it measures, of any length. Without it the columns `reference_x reference_y reference_z` of the sensor give it.
    pub reference_N: Option<[f64; 3]>,
    /// Where the known numbers come from: "measured" or "cad", by default that of the
    /// whole model. It sets how uncertain they are.
    pub source: Option<SourceFile>,
    /// true: all known numbers of this table are exact.
    pub exact: Option<bool>,
    /// One sigma of known numbers; overrides source and `exact`.
    pub uncertainty: Option<SensorUncertaintyFile>,
}

/// What a sensor measures: a kind that a model file names.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) struct SensorType(pub SensorKind);

impl<'de> Deserialize<'de> for SensorType {
    fn deserialize<D: Deserializer<'de>>(reader: D) -> Result<Self, D::Error> {
        let word = String::deserialize(reader)?;
        let kind = SensorKind::declared().find(|kind| kind.word() == word);
        kind.map(Self)
            .ok_or_else(|| D::Error::custom(format!("no type of sensor is \"{word}\"")))
    }
}

impl JsonSchema for SensorType {
    fn schema_name() -> Cow<'static, str> {
        "SensorType".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        let one = |kind: SensorKind| json_schema!({ "type": "string", "const": kind.word(), "description": kind.about() });
        let all: Vec<Schema> = SensorKind::declared().map(one).collect();
        json_schema!({ "description": "What a sensor measures.", "oneOf": all })
    }
}

/// One sigma per sample.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(untagged)]
pub(crate) enum NoiseFile {
    /// The same for every axis.
    Scalar(f64),
    /// One per axis of the sensor.
    Axes([f64; 3]),
    /// Symmetric positive definite square root of the covariance.
    Matrix([[f64; 3]; 3]),
}

/// One name or several.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(untagged)]
pub(crate) enum NamesFile {
    /// One.
    One(String),
    /// Several.
    Many(Vec<String>),
}

impl NamesFile {
    /// The names.
    pub fn as_slice(&self) -> &[String] {
        match self {
            Self::One(name) => std::slice::from_ref(name),
            Self::Many(names) => names,
        }
    }
}
