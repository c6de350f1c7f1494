//! The filter of `poinsot-onboard` for a model: its configuration, and the samples of a table.

mod prior;
mod rigid;

use crate::bind::{file_label, silent, to_map};
use crate::channel_names;
use crate::error::{Error, missing, no_noise, unsupported};
use crate::mass_numbers::{names, with_answer};
use nalgebra::SMatrix;
use poinsot_dynamics::{Kinematics, Nozzle, SAME_TIME, SensorKind, Tree, thrust_wrench};
use poinsot_formats::EstimateFile;
use poinsot_model::{Joint, Model, Nuisance, Sensor, SlowError};
use poinsot_onboard::{Answer, COLUMNS, Configuration, JOINTS, Noise, Sample, WHEELS};
use poinsot_spatial::{InertialParameters, MassProperties, TENSOR};
use poinsot_telemetry::{Channel, Table, resample};
use prior::Prior;
use rigid::{Rigid, quaternion};
use serde::Serialize;

/// Prior sigma of a gyro bias that is unknown without one, rad/s: a degree per second.
const BIAS: f64 = 0.017;
/// Half-width of a 95 % interval, sigmas.
const INTERVAL: f64 = 1.96;

type TenByTen = SMatrix<f64, 10, 10>;

/// The configuration of a model's filter, and what it assumes.
#[derive(Debug, Clone)]
pub struct OnBoard {
    /// The configuration.
    pub configuration: Configuration,
    /// Assumptions, one a line.
    pub assumed: Vec<String>,
    nozzles: Vec<Nozzle>,
    /// The unknown body, and the addresses of its ten numbers.
    body: usize,
    addresses: [String; 10],
    /// The joints that move, in the order of the configuration.
    moving: Vec<usize>,
}

/// A number of the unknown body while it is followed.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FollowedNumber {
    /// Its address, `bus.inertia_kg_m2.xx`.
    #[serde(skip)]
    pub address: String,
    /// Its value in SI, if it is determined.
    pub value: Option<f64>,
    /// One sigma.
    pub sigma: f64,
    /// The sigma that is wanted.
    pub wanted_sigma: f64,
    /// When it was reached, or will be at this rate, s of the record; `None` beyond a thousand times the record so far.
    pub reached_at_s: Option<f64>,
}

impl OnBoard {
    /// The filter of a model of which one body is unknown. With an answer its numbers and covariance are the prior. Joints without a
    /// declared position move, and their encoders are inputs.
    ///
    /// # Errors
    /// The model has what the filter does not follow, or lacks noise that it needs.
    ///
    /// ```
    /// use poinsot::onboard::OnBoard;
    /// use poinsot_testkit::vehicles::ModelText;
    ///
    /// let text = ModelText::new("box")
    ///     .body("bus", 10.0, [0.0; 3], [1.0, 2.0, 2.5, 0.0, 0.0, 0.0], "estimate = [\"inertia\"]")
    ///     .wheel("wx", "bus", [1.0, 0.0, 0.0], 0.01)
    ///     .sensor("gyro", "gyro", "noise_rad_s = 1.0e-4")
    ///     .sensor("tracker", "attitude", "noise_rad = 1.0e-4")
    ///     .text();
    /// let model = poinsot_model::parse_model(&text, "model.toml")?;
    /// let configuration = OnBoard::new(&model, None)?.configuration;
    /// assert_eq!((configuration.wheel_count, configuration.nominal[6]), (1, 2.0));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn new(model: &Model, answer: Option<&EstimateFile>) -> Result<Self, Error> {
        let mut assumed = Vec::new();
        let at = unknown_body(model)?;
        let body = &model.bodies[at];
        let tree = Tree::new(model);
        let rigid = Rigid::new(model, &tree);
        let nominal = with_answer(body, answer);
        let mut configuration = Configuration::new(nominal.parameters().to_array(), noise(model)?);
        let mut known = model.nominal_parameters();
        known[at] = InertialParameters::ZERO;
        rigid.add_links(&mut configuration, model, &known);
        let (R, p) = rigid.pose(at);
        configuration.unknown_link = rigid.of[at];
        configuration.unknown_rotation = quaternion(&R);
        configuration.unknown_position = p.into();
        rigid.add_wheels(&mut configuration, model)?;
        rigid.add_modes(&mut configuration, model)?;
        let prior = Prior {
            model,
            rigid: &rigid,
            body,
            nominal: &nominal,
            answer,
        };
        prior.set(&mut configuration, &mut assumed)?;
        if configuration.wheel_count > 0 {
            configuration = configuration.with_curve();
        }
        configuration.forget_s = body.prior.and_then(|p| p.forget_s).unwrap_or(0.0);
        assumed.extend(unused(model));
        let open = model
            .modes
            .iter()
            .filter(|m| !m.estimate.words().is_empty());
        assumed.extend(open.map(|m| {
            let (name, words) = (&m.name, m.estimate.words().join(", "));
            format!("assumed: {words} of mode '{name}' as declared; identify finds such numbers")
        }));
        let none = Table::default();
        let joints: Vec<usize> = (0..model.joints.len()).collect();
        let still = silent(model, &none, &joints, false);
        assumed.extend(still.filter_map(|part| {
            let (said, subject, channel) = (part.said?, part.subject, part.channel);
            Some(format!(
                "assumed: {subject} {said}, unless a record has {channel}"
            ))
        }));
        for thruster in &model.thrusters {
            rigid.on_base(thruster.body, &format!("thruster \"{}\"", thruster.name))?;
        }
        let kinematics = &rigid.kinematics;
        check(&configuration)?;
        let nozzles = model.thrusters.iter().map(|t| Nozzle {
            body: 0,
            p_BoT_B: kinematics.p[t.body] + kinematics.R[t.body] * t.p_BoT_B,
            direction_B: kinematics.R[t.body] * t.direction_B,
            propellant: None,
        });
        Ok(Self {
            nozzles: nozzles.collect(),
            moving: rigid.moving.iter().map(|link| link.joint).collect(),
            addresses: names(&body.name),
            body: at,
            configuration,
            assumed,
        })
    }

    /// Each unknown number of an answer: mass, mass centre, central inertia. Their wanted intervals are `accuracy` of the
    /// natural units `m`, `L` and `m L^2` of the body with the radius of gyration `L`.
    pub fn numbers(&self, model: &Model, answer: &Answer, accuracy: f64) -> Vec<FollowedNumber> {
        let values = answer.numbers.map(|n| n.value);
        let of = InertialParameters::from_array(&values).mass_properties();
        let Some((body, of)) = model.bodies.get(self.body).zip(of) else {
            return Vec::new();
        };
        let (at, units, slopes) = (of.to_array(), of.natural_units(), slopes(&of));
        let is_unknown = |k: &usize| answer.numbers[*k].sigma > 0.0;
        let places: Vec<usize> = (0..10).filter(is_unknown).collect();
        let variance = |k: usize| {
            let slope = |place: &usize| slopes[(k, *place)];
            let rows = places.iter().zip(&answer.covariance);
            let times = |row: &[f64; 10]| -> f64 {
                places.iter().zip(row).map(|(b, x)| slope(b) * x).sum()
            };
            rows.map(|(a, row)| slope(a) * times(row)).sum::<f64>()
        };
        // Each number of the body depends on some of those of the filter.
        let own = |k: usize| {
            let mut of = places.iter().filter(|place| slopes[(k, **place)] != 0.0);
            of.all(|place| answer.numbers[*place].determined)
        };
        let all = (0..10).filter(|k| body.estimate.has(*k));
        let number = |k: usize| FollowedNumber {
            address: self.addresses[k].clone(),
            value: Some(at[k]).filter(|_| own(k)),
            sigma: variance(k).max(0.0).sqrt(),
            wanted_sigma: accuracy * units[k] / INTERVAL,
            reached_at_s: None,
        };
        all.map(number).collect()
    }

    /// Checks that a table has gyro, attitude, wheels, thrusters, joints, and a position where the model has one.
    ///
    /// # Errors
    /// E0301: a channel is missing.
    pub fn check_channels(&self, model: &Model, table: &Table) -> Result<(), Error> {
        use SensorKind::{Attitude, Gyro, JointRate, Position};
        let position = [Position]
            .into_iter()
            .filter(|_| self.configuration.noise.position > 0.0);
        let sensors = [Gyro, Attitude].into_iter().chain(position);
        let sensors = sensors.filter(|kind| channels(model, table, *kind).is_none());
        let sensors = sensors.map(|kind| kind.columns().join(" "));
        let lacks = |name: &String| table.sensor_channel("", name).is_none();
        let rates = self.joint_names(model, JointRate).into_iter().filter(lacks);
        let file = file_label(table);
        let needed = sensors.chain(rates).flat_map(|names| {
            let advice = to_map(&names, &table.ignored);
            missing(&file, &names, "the on-board filter needs it", &advice).list
        });
        let parts = silent(model, table, &self.moving, false).filter(|part| part.said.is_none());
        let faults = needed.chain(parts.map(|part| part.fault(table)));
        Error::none_or(faults.collect(), ())
    }

    /// Names of the channels of the joints that move.
    fn joint_names(&self, model: &Model, kind: SensorKind) -> Vec<String> {
        channel_names::names(model, kind, &self.moving)
    }

    /// Samples at the times of the gyro. Attitude and position count where they have the same time; wheel speeds are interpolated,
    /// thrust holds until the next sample.
    pub fn samples(&self, model: &Model, table: &Table) -> Vec<Sample> {
        let of = |kind| channels(model, table, kind);
        let gyro = of(SensorKind::Gyro);
        let Some(times) = gyro.as_ref().and_then(|c| c.first()).map(|c| &c.time_s) else {
            return Vec::new();
        };
        let (attitude, position) = (of(SensorKind::Attitude), of(SensorKind::Position));
        let find = |names: Vec<String>| -> Vec<Option<&Channel>> {
            let names = names.iter();
            names.map(|name| table.sensor_channel("", name)).collect()
        };
        // Without a channel is what the model says to be at rest.
        let still = || vec![Some(0.0); times.len()];
        let at_times = |names: Vec<String>| -> Vec<Vec<Option<f64>>> {
            let channels = find(names).into_iter();
            channels
                .map(|c| c.map_or_else(still, |c| resample(c, times, None)))
                .collect()
        };
        let speeds = at_times(channel_names::of_all(model, SensorKind::WheelSpeed));
        let positions = at_times(self.joint_names(model, SensorKind::JointPosition));
        let rates = at_times(self.joint_names(model, SensorKind::JointRate));
        let thrust = find(channel_names::of_all(model, SensorKind::Thrust));
        let kinematics = Kinematics::new(&Tree::new(model));
        let at = |(k, time): (usize, &f64)| {
            let mut sample = Sample::at(*time);
            sample.gyro = gyro.as_ref().and_then(|axes| vector(axes, *time));
            sample.attitude = attitude.as_ref().and_then(|parts| vector(parts, *time));
            sample.position = position.as_ref().and_then(|axes| vector(axes, *time));
            // The filter refuses a sample without one of them.
            let set = |places: &mut [f64], of: &[Vec<Option<f64>>]| {
                for (place, values) in places.iter_mut().zip(of) {
                    *place = values.get(k).copied().flatten().unwrap_or(f64::NAN);
                }
            };
            set(&mut sample.wheel_speed, &speeds);
            set(&mut sample.joint_position, &positions);
            set(&mut sample.joint_rate, &rates);
            let levels = thrust.iter().map(|c| c.map_or(0.0, |c| held(c, *time)));
            let levels: Vec<f64> = levels.collect();
            let (force, torque) = thrust_wrench(&self.nozzles, &kinematics, &levels);
            (sample.force_B, sample.torque_B) = (force.into(), torque.into());
            sample
        };
        times.iter().enumerate().map(at).collect()
    }
}

/// The only body with unknown numbers.
fn unknown_body(model: &Model) -> Result<usize, Error> {
    let is_unknown = |k: &usize| model.bodies[*k].estimate.any();
    let mut unknown = (0..model.bodies.len()).filter(is_unknown);
    let refuse = |problem: &str| unsupported(problem, "use identify for this model");
    match (unknown.next(), unknown.next()) {
        _ if model.joints.iter().any(Joint::is_passive) => Err(refuse(
            "the on-board filter has no joints that springs move",
        )),
        _ if model.environment.gravity_gradient => {
            Err(refuse("the on-board filter has no gravity gradient"))
        }
        (Some(body), None) => Ok(body),
        (None, _) => Err(unsupported(
            "no number of the model is unknown",
            "mark a body with estimate = true",
        )),
        (Some(_), Some(_)) => Err(refuse(
            "the on-board filter estimates one body, and several are unknown",
        )),
    }
}

/// The sensor of a kind that the filter takes.
fn on_base(model: &Model, kind: SensorKind) -> Option<&Sensor> {
    model.sensors_of(kind).find(|s| s.body == 0)
}

/// A line for each sensor that the filter does not take.
fn unused(model: &Model) -> impl Iterator<Item = String> {
    let used = |s: &Sensor| match s.kind {
        SensorKind::Gyro | SensorKind::Attitude | SensorKind::Position => {
            on_base(model, s.kind).is_some_and(|first| first.name == s.name)
        }
        kind => kind.is_scalar(),
    };
    let unused = model.sensors.iter().filter(move |s| !used(s));
    unused.map(|s| format!("not used: sensor \"{}\"", s.name))
}

/// Declared noise of the sensors that the filter takes, isotropic.
fn noise(model: &Model) -> Result<Noise, Error> {
    let sigma = |kind| {
        let sensor = on_base(model, kind)?;
        let covariance = sensor.noise_covariance?;
        Some((covariance.trace() / 3.0 + sensor.quantisation.powi(2) / 12.0).sqrt())
    };
    let needed = |kind| sigma(kind).ok_or_else(|| no_noise(kind));
    let gyro = model.sensors_of(SensorKind::Gyro).next();
    let random = model.environment.random_torque;
    let walks = |s: &Sensor| s.kind == SensorKind::Gyro && s.slow.iter().all(SlowError::is_walk);
    let mut slow = model.sensors.iter().filter(|s| !s.slow.is_empty());
    if let Some(Sensor { name, .. }) = slow.find(|s| !walks(s)) {
        let problem = format!("the on-board filter has no slow error of sensor \"{name}\"");
        let advice = "declare white noise that is wide enough, or a walk of the gyro's bias";
        return Err(unsupported(problem, advice));
    }
    let walk = gyro.and_then(|s| s.slow.first()).map(|s| s.covariance);
    Ok(Noise {
        gyro: needed(SensorKind::Gyro)?,
        attitude: needed(SensorKind::Attitude)?,
        position: sigma(SensorKind::Position).unwrap_or(0.0),
        bias: match gyro.map(|s| s.bias) {
            Some(Nuisance::Prior(sigma)) => sigma,
            Some(Nuisance::Estimate) => BIAS,
            Some(Nuisance::Known) | None => 0.0,
        },
        bias_walk: walk.map_or(0.0, |c| (c.trace() / 3.0).sqrt()),
        // The white torque of the same power at low frequencies.
        torque_walk: random.map_or(0.0, |r| r.sigma_N_m * (2.0 * r.correlation_s).sqrt()),
    })
}

/// Slopes of mass, mass centre and central inertia over the ten parameters about the origin.
fn slopes(of: &MassProperties) -> TenByTen {
    let (c, mass) = (&of.p_BoBcm_B, of.mass);
    let same = |i: usize, j: usize| f64::from(u8::from(i == j));
    let mut slopes = TenByTen::identity();
    for k in 0..3 {
        slopes[(1 + k, 0)] = -c[k] / mass;
        slopes[(1 + k, 1 + k)] = 1.0 / mass;
    }
    for (row, &(i, j)) in TENSOR.iter().enumerate() {
        slopes[(4 + row, 0)] = same(i, j) * c.norm_squared() - c[i] * c[j];
        for k in 0..3 {
            let across = same(i, k) * c[j] + same(j, k) * c[i];
            slopes[(4 + row, 1 + k)] = across - 2.0 * same(i, j) * c[k];
        }
    }
    slopes
}

fn check(configuration: &Configuration) -> Result<(), Error> {
    use poinsot_onboard::Invalid;
    let (problem, advice) = match configuration.check(COLUMNS) {
        Ok(()) => return Ok(()),
        Err(Invalid::Count) => (
            format!("more than {WHEELS} wheels, or more than {JOINTS} joints that move"),
            "leave some out, or declare where joints are locked",
        ),
        Err(Invalid::Capacity(_)) => (
            "so many wheels, joints and modes have more known numbers with a sigma than the filter has room for"
                .to_owned(),
            "declare exact = true for some of them",
        ),
        Err(Invalid::NeedsPosition) => (
            "mass or mass centre is unknown, but no position is measured and no joint moves"
                .to_owned(),
            "add a position sensor, or mark the inertia alone as unknown",
        ),
        Err(Invalid::Unphysical) => (
            "the nominal vehicle has no positive mass or inertia".to_owned(),
            "correct the numbers of the model",
        ),
        Err(other) => (
            format!("the on-board filter refuses the model: {other:?}"),
            "",
        ),
    };
    Err(unsupported(problem, advice))
}

fn channels<'t>(model: &Model, table: &'t Table, kind: SensorKind) -> Option<Vec<&'t Channel>> {
    let name = on_base(model, kind).map_or("", |s| s.name.as_str());
    let find = |column: &&'static str| {
        let named = table.sensor_channel(name, column);
        named.or_else(|| table.sensor_channel("", column))
    };
    kind.columns().iter().map(find).collect()
}

/// The values at a time, where all parts have a sample.
fn vector<const N: usize>(parts: &[&Channel], time_s: f64) -> Option<[f64; N]> {
    let mut out = [0.0; N];
    for (out, part) in out.iter_mut().zip(parts) {
        let at = part.time_s.partition_point(|t| *t < time_s - SAME_TIME);
        let own = part.time_s.get(at);
        own.filter(|t| (*t - time_s).abs() < 1.0e-6)?;
        *out = part.values.get(at).copied()?;
    }
    (parts.len() == N).then_some(out)
}

/// The value that holds at a time.
fn held(channel: &Channel, time_s: f64) -> f64 {
    let after = channel.time_s.partition_point(|t| *t <= time_s + SAME_TIME);
    let last = after.checked_sub(1).and_then(|k| channel.values.get(k));
    last.copied().unwrap_or(0.0)
}
