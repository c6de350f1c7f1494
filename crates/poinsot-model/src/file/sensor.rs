use super::rows::{SensorUncertaintyFile, Sigma, Step};
use super::{NuisanceFile, Sigmas};
use crate::knowledge::Origin;
use poinsot_dynamics::SensorKind;
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::Error;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use serde_json::{Value, json};
use std::borrow::Cow;
use std::collections::BTreeMap;

/// A sensor. The unit of `noise_<unit>` and `quantisation_<unit>` is that of its channels: gyro rad_s;
/// attitude and direction rad; position m; velocity and velocity_increment m_s; accelerometer m_s2; joint_position rad
/// or m; joint_rate rad_s or m_s; wheel_speed rad_s; thrust N. A noise is one sigma per sample: a number,
/// three numbers (one per sensor axis), or the 3 x 3 symmetric positive definite square root S of the
/// covariance S S. A sensor with axes may have an error that lasts beside it, `slow_<unit>`, and a random walk of its bias,
/// `walk_<unit>_s05`, written alike.
#[derive(Debug, Clone, Default, Serialize, Deserialize, JsonSchema)]
#[schemars(deny_unknown_fields, extend("x-code" = "E0118"))]
#[allow(non_snake_case)]
pub(crate) struct SensorFile {
    /// Name, unique among sensors of its type.
    #[schemars(required, extend("x-name" = true))]
    pub name: Option<String>,
    /// What it measures.
    #[serde(rename = "type")]
    #[schemars(required)]
    pub kind: Option<SensorType>,
    /// Name of its body. Default: the base.
    #[schemars(extend("x-names" = "body"))]
    pub body: Option<String>,
    /// Name of the body from which the sensor sees `body`, as a camera on a servicer sees the captured target. Types that
    /// measure pose or motion in inertial axes can have it. An attitude is that of `body` in the axes of this body; all
    /// else is from the origin of this body, in its axes. The names of its columns begin with `relative_`. Default: seen
    /// from inertial space.
    #[schemars(extend("x-names" = "body"))]
    pub seen_from: Option<String>,
    /// Names of the joints, wheels or thrusters that a joint_position, joint_rate, wheel_speed or thrust
    /// sensor reads: one name or a list. Default: all whose unit fits.
    #[schemars(extend("x-only" = of_type(SensorKind::is_scalar)))]
    pub of: Option<NamesFile>,
    /// By key: `noise_<unit>`, `slow_<unit>`, `walk_<unit>_s05` and `quantisation_<unit>`.
    #[serde(flatten)]
    #[schemars(with = "SampleErrorFile")]
    pub sample_errors: BTreeMap<String, toml::Value>,
    /// Correlation time of `slow_<unit>`, to 1/e, s (Gauss-Markov); without that key all noise is correlated. Default: white.
    #[schemars(extend("x-only" = with_axes(), "x-only-code" = "E0106", "exclusiveMinimum" = 0))]
    pub correlation_s: Option<f64>,
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
    /// Body from sensor: quaternion, Hamilton, scalar last. Default identity. The columns of a gyro,
    /// accelerometer, direction or attitude sensor are in its axes, and reading turns them to those of its body; of the
    /// other types the rotation gives only the axes of the sensor's errors (noise, bias, scale).
    #[schemars(extend("x-only" = with_axes()))]
    pub rotation_xyzw: Option<[f64; 4]>,
    /// The same as a matrix of rows: takes components in the sensor's axes to components in the body's.
    #[schemars(extend("x-only" = with_axes()))]
    pub rotation_matrix: Option<[[f64; 3]; 3]>,
    /// Position of the sensor from the origin of the body's frame, m. Default zero.
    #[schemars(extend("x-only" = with_axes()))]
    pub position_m: Option<[f64; 3]>,
    /// Direction: the vector in inertial axes whose direction it measures, of any length. Without it the columns `reference_x reference_y reference_z` of the sensor give it.
    #[schemars(extend("x-only" = of_type(|kind| kind == SensorKind::Direction)))]
    pub reference_N: Option<[f64; 3]>,
    /// Where the known numbers come from: "measured" or "cad", by default that of the
    /// whole model. It sets how uncertain they are.
    pub source: Option<Origin>,
    /// true: all known numbers of this table are exact.
    pub exact: Option<bool>,
    /// One sigma of known numbers; overrides source and `exact`.
    #[schemars(with = "Option<SensorUncertaintyFile>")]
    pub uncertainty: Option<Sigmas>,
}

/// What a sensor measures: a kind that a model file names.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) struct SensorType(pub SensorKind);

fn of_type(fit: impl Fn(SensorKind) -> bool) -> Value {
    let fitting = SensorKind::declared().filter(|kind| fit(*kind));
    json!({ "type": fitting.map(SensorKind::word).collect::<Vec<_>>() })
}

fn with_axes() -> Value {
    of_type(|kind| !kind.is_scalar())
}

/// Gives each row of the errors of samples the types of sensors that have it: those with the unit in which its key ends, and
/// with axes where the error lasts over samples.
fn by_unit(schema: &mut Schema) {
    let rows = schema.get_mut("properties").and_then(Value::as_object_mut);
    for (key, row) in rows.into_iter().flatten() {
        let (what, unit) = key.split_once('_').unwrap_or_default();
        let unit = unit.strip_suffix("_s05").unwrap_or(unit);
        let lasts = ["slow", "walk"].contains(&what);
        row["x-only"] =
            of_type(|kind| kind.units().contains(&unit) && !(lasts && kind.is_scalar()));
    }
}

impl Serialize for SensorType {
    fn serialize<S: Serializer>(&self, writer: S) -> Result<S::Ok, S::Error> {
        writer.serialize_str(self.0.word())
    }
}

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
#[derive(Debug, Clone, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub(crate) enum NoiseFile {
    /// The same for every axis.
    Scalar(#[schemars(with = "Sigma")] f64),
    /// One per axis of the sensor.
    Axes(#[schemars(with = "[Sigma; 3]")] [f64; 3]),
    /// Symmetric positive definite square root of the covariance.
    Matrix([[f64; 3]; 3]),
}

/// One name or several.
#[derive(Debug, Clone, Serialize, Deserialize, JsonSchema)]
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

/// Noise and quantisation of a sensor.
#[derive(JsonSchema)]
#[schemars(transform = by_unit)]
#[allow(non_snake_case)]
#[expect(dead_code, reason = "rows for the schema; their values are in maps")]
struct SampleErrorFile {
    /// One sigma per sample of an attitude (small rotation in body axes), a direction (angle across it; one number) or a revolute joint's position, rad.
    noise_rad: Option<NoiseFile>,
    /// One sigma per sample of an angular velocity, a revolute joint's rate or a wheel speed, rad/s.
    noise_rad_s: Option<NoiseFile>,
    /// One sigma per sample of a position or a prismatic joint's position, m.
    noise_m: Option<NoiseFile>,
    /// One sigma per sample of a velocity, a velocity increment or a prismatic joint's rate, m/s.
    noise_m_s: Option<NoiseFile>,
    /// One sigma per sample of a specific force, m/s2.
    noise_m_s2: Option<NoiseFile>,
    /// One sigma per sample of a thrust, N.
    noise_N: Option<NoiseFile>,
    /// One sigma of an error of an attitude or a direction that lasts over samples, rad; `correlation_s` says how long.
    slow_rad: Option<NoiseFile>,
    /// One sigma that a random walk of the bias gains in 1 s, rad (it grows with the root of time).
    walk_rad_s05: Option<NoiseFile>,
    /// One sigma of an error of an angular velocity that lasts over samples, rad/s; `correlation_s` says how long.
    slow_rad_s: Option<NoiseFile>,
    /// One sigma that a random walk of the bias gains in 1 s, rad/s (it grows with the root of time).
    walk_rad_s_s05: Option<NoiseFile>,
    /// One sigma of an error of a position that lasts over samples, m; `correlation_s` says how long.
    slow_m: Option<NoiseFile>,
    /// One sigma that a random walk of the bias gains in 1 s, m (it grows with the root of time).
    walk_m_s05: Option<NoiseFile>,
    /// One sigma of an error of a velocity or a velocity increment that lasts over samples, m/s; `correlation_s` says how long.
    slow_m_s: Option<NoiseFile>,
    /// One sigma that a random walk of the bias gains in 1 s, m/s (it grows with the root of time).
    walk_m_s_s05: Option<NoiseFile>,
    /// One sigma of an error of a specific force that lasts over samples, m/s2; `correlation_s` says how long.
    slow_m_s2: Option<NoiseFile>,
    /// One sigma that a random walk of the bias gains in 1 s, m/s2 (it grows with the root of time).
    walk_m_s2_s05: Option<NoiseFile>,
    /// Least significant bit, rad. Its variance is LSB^2/12.
    quantisation_rad: Option<Step>,
    /// Least significant bit, rad/s.
    quantisation_rad_s: Option<Step>,
    /// Least significant bit, m.
    quantisation_m: Option<Step>,
    /// Least significant bit, m/s.
    quantisation_m_s: Option<Step>,
    /// Least significant bit, m/s2.
    quantisation_m_s2: Option<Step>,
    /// Least significant bit, N.
    quantisation_N: Option<Step>,
}
