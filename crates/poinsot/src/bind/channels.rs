//! Finding the channels of a sensor in a table.

use super::attitude_start::{base_directions, differentiated, from_directions};
use super::driven_wheels::{DrivenWheels, speed_column, torque_column};
use super::sensors::{BaseSensors, REFERENCE, is_locked};
use crate::channel_names::{XYZ, joint_channels, of_parts};
use crate::error::{Error, missing};
use poinsot_dynamics::Tree;
use poinsot_model::{Axes, Model, SensorKind};
use poinsot_spatial::{Matrix3, Vector3};
use poinsot_telemetry::{Channel, ChannelName, Mounting, Table, classify, suggestions};
use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet};

/// A table with the model to which it is bound, and its name for messages.
#[derive(Clone, Copy)]
pub(super) struct Channels<'a> {
    pub model: &'a Model,
    pub tree: &'a Tree,
    pub table: &'a Table,
    pub label: &'a str,
    /// Sensors that provide the aligned samples.
    pub leading: &'a BaseSensors<'a>,
    /// Wheels whose measured torque drives them between tachometer samples.
    pub driven: &'a DrivenWheels,
}

/// The three channels of a vector sensor, and its position. Columns of a rotated sensor were rotated to body axes on
/// reading.
pub(super) struct VectorChannels<'a> {
    pub axes: [&'a Channel; 3],
    pub p_BoS_B: Vector3,
}

/// Body rates of the base.
pub(super) struct BaseRates<'a> {
    pub axes: [Cow<'a, Channel>; 3],
    /// The attitude of which they are the derivative, where no sensor measures it either.
    pub attitude: Option<[Channel; 4]>,
}

impl BaseRates<'_> {
    /// Times of the first axis, s.
    pub fn time_s(&self) -> &[f64] {
        &self.axes[0].time_s
    }

    /// Whether they are measured.
    pub fn are_measured(&self) -> bool {
        matches!(self.axes[0], Cow::Borrowed(_))
    }
}

/// The columns of a joint.
pub(super) struct JointColumns<'a> {
    /// Index in the model.
    pub at: usize,
    pub position_name: String,
    pub rate_name: String,
    pub position: Option<&'a Channel>,
    pub rate: Option<&'a Channel>,
    /// Whether the rounded position never changes: the joint is locked.
    pub locked: bool,
}

/// A wheel's tachometer, and its speed: at the tachometer's samples, and at those of its motor torque where that drives it.
pub(super) struct WheelSpeed<'a> {
    pub tachometer: &'a Channel,
    pub speed: Cow<'a, Channel>,
    pub driven: bool,
}

impl<'a> JointColumns<'a> {
    /// The position, if the joint is not locked.
    pub fn moving(&self) -> Option<&'a Channel> {
        self.position.filter(|_| !self.locked)
    }
}

impl<'a> Channels<'a> {
    /// A channel without a sensor name.
    pub fn find(&self, name: &str) -> Option<&'a Channel> {
        self.table.sensor_channel("", name)
    }

    /// The columns of the leading sensor of a kind: see [`BaseSensors::columns`].
    pub fn leading(&self, kind: SensorKind) -> Option<Vec<&'a Channel>> {
        self.leading.columns(self.table, kind)
    }

    /// The columns of the leading three-axis sensor of a kind.
    pub fn vector(&self, kind: SensorKind) -> Option<VectorChannels<'a>> {
        let sensor = self.leading.sensor(kind);
        let axes: [&Channel; 3] = self.leading(kind)?.try_into().ok()?;
        Some(VectorChannels {
            axes,
            p_BoS_B: sensor.map_or_else(Vector3::zeros, |s| s.p_BoS_B),
        })
    }

    /// The body rates at whose times the linear method works: those of the gyro; without a gyro in the model, the derivative
    /// of the attitude.
    pub fn base_rates(&self) -> Result<BaseRates<'a>, Error> {
        let gyro = self.vector(SensorKind::Gyro);
        if let Some(gyro) = gyro.as_ref().filter(|g| !g.axes[0].time_s.is_empty()) {
            return Ok(BaseRates {
                axes: gyro.axes.map(Cow::Borrowed),
                attitude: None,
            });
        }
        let mut gyros = self.model.sensors_of(SensorKind::Gyro);
        let (purpose, advice) = match (gyros.next(), gyro) {
            (None, _) => {
                if let Some(derived) = self.derived_rates() {
                    return Ok(derived);
                }
                (
                    "every fit starts from body rates, measured or differentiated from the attitude",
                    "add the columns of a gyro, of an attitude, or of two directions",
                )
            }
            (Some(_), None) => (
                "the model has a gyro",
                "map its columns in [telemetry.columns], or take it out of the model: an attitude starts a fit too",
            ),
            (Some(_), Some(_)) => (
                "the columns of the gyro hold no sample",
                "correct them, or take the gyro out of the model: an attitude starts a fit too",
            ),
        };
        let absent = SensorKind::Gyro.columns().iter().copied();
        let absent = absent.filter(|c| self.table.sensor_channel("", c).is_none());
        let absent = absent.collect::<Vec<_>>().join(" ");
        let name = match absent.is_empty() {
            true => "omega_x omega_y omega_z",
            false => &absent,
        };
        Err(self.missing(name, purpose, advice))
    }

    fn derived_rates(&self) -> Option<BaseRates<'a>> {
        let measured = self.quaternion();
        let attitude = match measured {
            Some(_) => None,
            None => Some(from_directions(&base_directions(self.model, self.table))?),
        };
        let parts = measured.or_else(|| attitude.as_ref().map(|a| a.each_ref()))?;
        let axes = differentiated(parts);
        let some = axes[0].values.len() > 1;
        some.then(|| BaseRates {
            axes: axes.map(Cow::Owned),
            attitude,
        })
    }

    /// The columns of the leading attitude sensor.
    pub fn quaternion(&self) -> Option<[&'a Channel; 4]> {
        self.leading(SensorKind::Attitude)?.try_into().ok()
    }

    /// The columns of the moving joints, by coordinate.
    pub fn joints(&self) -> impl Iterator<Item = JointColumns<'a>> {
        self.tree.coordinates.iter().map(|at| self.joint(*at))
    }

    /// The columns of a joint, by its index in the model.
    fn joint(&self, at: usize) -> JointColumns<'a> {
        let joint = &self.model.joints[at];
        let [position_name, rate_name, ..] = joint_channels(joint);
        let position = self.find(&position_name);
        JointColumns {
            at,
            rate: self.find(&rate_name),
            locked: position.is_some_and(|q| is_locked(self.model, at, q)),
            position,
            position_name,
            rate_name,
        }
    }

    /// The tachometer of every wheel.
    pub fn tachometers(&self) -> impl Iterator<Item = Option<&'a Channel>> {
        let wheels = self.model.wheels.iter();
        wheels.map(|wheel| self.find(&speed_column(&wheel.name)))
    }

    /// Every wheel with a tachometer, and its speed as its torque drives it.
    pub fn wheels(&self) -> Vec<Option<WheelSpeed<'a>>> {
        let of = |(wheel, tachometer): (usize, Option<&'a Channel>)| {
            let tachometer = tachometer?;
            let torque = self.find(&torque_column(&self.model.wheels[wheel].name));
            Some(WheelSpeed {
                tachometer,
                speed: self.driven.speed(wheel, tachometer, torque),
                driven: self.driven.drives(wheel),
            })
        };
        self.tachometers().enumerate().map(of).collect()
    }

    /// The error of channels that are not there, with the lines that map unused columns to them; without any, the unused column whose name is
    /// most like them. The name of another vector is its own.
    pub fn missing(&self, channel: &str, purpose: &str, advice: &str) -> Error {
        let wanted = |line: &String| {
            channel
                .split(' ')
                .any(|name| line.starts_with(&format!("{name} =")))
        };
        let lines = suggestions(&self.table.ignored).into_iter().filter(wanted);
        let lines = lines.collect::<Vec<_>>().join(", ");
        let similar = |column: &String| strsim::jaro_winkler(&column.to_lowercase(), channel);
        let is_other = |of: ChannelName| of.vector().is_some() && !channel.contains(&of.name);
        let own = |column: &String| classify(column).is_some_and(is_other);
        let unused = self.table.ignored.iter().filter(|column| !own(column));
        let unused = unused.map(|c| (similar(c), c));
        // The first of equal ones.
        let nearest = unused.rev().max_by(|a, b| a.0.total_cmp(&b.0));
        let purpose = match nearest {
            Some(_) if !lines.is_empty() => format!("{purpose} (it may be: {lines})"),
            Some((_, column)) => format!("{purpose} (nearest unused column: '{column}')"),
            None => purpose.to_owned(),
        };
        missing(self.label, channel, &purpose, advice)
    }
}

/// Names of all channels that a model can use; translation and specific force only if the model has a sensor for them.
///
/// ```
#[doc = include_str!("../../doc/case.txt")]
/// let wanted = bind::wanted_channels(&model);
/// assert!(wanted.contains("omega_x") && wanted.contains("wx_rad_s"));
/// // The box has no accelerometer.
/// assert!(!wanted.contains("acc_x"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn wanted_channels(model: &Model) -> BTreeSet<String> {
    // Translation and similar channels need a sensor with declared noise.
    let always = [SensorKind::Gyro, SensorKind::Attitude];
    let used = SensorKind::with_axes()
        .filter(|kind| always.contains(kind) || model.sensors_of(*kind).next().is_some());
    let mut wanted: BTreeSet<String> = used
        .flat_map(SensorKind::columns)
        .map(|column| (*column).to_owned())
        .collect();
    if model.sensors_of(SensorKind::Direction).next().is_some() {
        wanted.extend(XYZ.map(|k| format!("{REFERENCE}_{k}")));
    }
    if model.environment.gravity_gradient {
        wanted.extend(XYZ.map(|k| format!("orbit_{k}")));
    }
    wanted.extend(of_parts(model));
    wanted
}

/// Spin inertia of each wheel that has a known one, kg m2, over which a momentum is its speed.
///
/// ```
#[doc = include_str!("../../doc/case.txt")]
/// assert!(bind::spin_inertias(&model).values().all(|inertia| *inertia > 0.0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn spin_inertias(model: &Model) -> BTreeMap<String, f64> {
    let known = model.wheels.iter().filter(|wheel| !wheel.estimate);
    known.map(|w| (w.name.clone(), w.spin_inertia)).collect()
}

/// Mountings of all rotated sensors of the model.
///
/// ```
#[doc = include_str!("../../doc/case.txt")]
/// // Its gyro measures in the axes of its body.
/// assert!(bind::mountings(&model).is_empty());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn mountings(model: &Model) -> Vec<Mounting> {
    let of_columns = |(kind, prefix): (SensorKind, &'static str)| {
        let alone = model.sensors_of(kind).nth(1).is_none();
        let first = model.sensors_of(kind).find(|s| s.body == 0);
        let turned = model
            .sensors_of(kind)
            .filter(|s| s.R_BS != Matrix3::identity());
        turned.map(move |sensor| Mounting {
            sensor: sensor.name.clone(),
            unnamed: alone || first == Some(sensor),
            prefix,
            R_BS: [0, 1, 2].map(|i| [0, 1, 2].map(|j| sensor.R_BS[(i, j)])),
        })
    };
    let in_own_axes = SensorKind::with_axes().filter(|kind| kind.axes() == Axes::Sensor);
    let prefixed = in_own_axes.flat_map(|kind| {
        let prefix = kind.columns().first().and_then(|c| c.strip_suffix("_x"));
        // Angular acceleration has no sensor type and uses the gyro's mounting.
        let more = (kind == SensorKind::Gyro).then_some("domega");
        prefix.into_iter().chain(more).map(move |p| (kind, p))
    });
    prefixed.flat_map(of_columns).collect()
}
