//! The table of conventions: one row for each kind of channel and change.

use super::FaultKind;
use crate::diagnosis::candidates::moves;
use crate::fit::experiment::Experiment;
use crate::problem::Problem;
use crate::problem::parameters::UnknownKind;
use crate::problem::segment::{InputRate, SensorRecord, SensorSample};
use poinsot_dynamics::{SensorError, printed_unit};
use poinsot_model::{JointKind, SensorKind, rounded};
use poinsot_spatial::{UnitQuaternion, Vector3};
use poinsot_telemetry::{Axes, Change, Repair, Turned, UNIT_FACTORS, full_name, unit_mistake};
use std::f64::consts::PI;

/// Ratios that are tried of a joint, of either sign.
const RATIOS: [f64; 9] = [0.2, 0.333, 0.5, 0.667, 0.8, 1.25, 1.5, 2.0, 3.0];
/// Share of a ratio to which it is sought about those, and within which it may be one of whole numbers.
const ABOUT: f64 = 0.2;
const SAME: f64 = 0.03;
/// Largest whole number in a ratio that is printed as one.
const TEETH: u32 = 6;
/// Most joints of a vehicle of which each is tried: every trial takes longer with their number, and there are more.
const MOST_JOINTS: usize = 16;
/// Zeros of a joint that are tried, rad, to either side.
const ZERO_STEP: f64 = PI / 12.0;
/// Shares of a typical pulse by which all may be longer or shorter.
const PULSES: [f64; 6] = [-0.3, -0.1, -0.03, 0.03, 0.1, 0.3];

/// Factors that put units right that are a thousand apart.
const THOUSANDS: [f64; 2] = [1.0e3, 1.0e-3];
/// Steps between samples by which their times may be late.
const STEPS: [f64; 6] = [1.0, 2.0, 3.0, 4.0, 6.0, 8.0];

/// Rates of a low and of a geostationary orbit, and the share to which they are sought about those.
const ORBITS_RAD_S: [f64; 2] = [1.08e-3, 7.29e-5];
const ORBITS: f64 = 0.15;

/// What is read by another convention than declared.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Place {
    /// Speeds of these wheels.
    Wheels(Vec<usize>),
    /// Positions and rates of these joints.
    Joints(Vec<usize>),
    /// Forces of these thrusters.
    Thrusters(Vec<usize>),
    /// The length of every pulse.
    Pulses,
    /// A sensor by its place among those of the first segment.
    Sensor(usize),
    /// The axes to which attitudes and rates of the base refer.
    Frame,
}

impl Place {
    /// The wheels, joints or thrusters.
    fn members(&self) -> &[usize] {
        match self {
            Self::Wheels(which) | Self::Joints(which) | Self::Thrusters(which) => which,
            _ => &[],
        }
    }
}

/// A row of the table.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Convention {
    pub place: Place,
    /// What puts it right.
    pub change: Change,
    /// The channel in words.
    pub owner: String,
    /// How far the value may lie from the true one, where it is free.
    pub free: Option<f64>,
}

/// One owner for each name, as declared.
fn each<'a>(
    names: impl IntoIterator<Item = &'a str>,
    place: fn(usize) -> Place,
) -> Vec<Convention> {
    let names = names.into_iter().enumerate();
    names
        .map(|(k, name)| Convention::as_declared(place(k), name.to_owned()))
        .collect()
}

/// Each change of each owner; `free` says how far its value may lie from the true one.
fn rows<'a>(
    owners: impl IntoIterator<Item = &'a Convention>,
    changes: &[Change],
    free: fn(f64) -> Option<f64>,
) -> Vec<Convention> {
    let one = |(own, change): (&Convention, &Change)| {
        let mut row = own.clone();
        row.change = *change;
        row.free = free(row.value());
        row
    };
    let of = |own: &'a Convention| changes.iter().map(move |change| (own, change));
    owners.into_iter().flat_map(of).map(one).collect()
}

/// A value that is known.
fn fixed(_: f64) -> Option<f64> {
    None
}

/// All kinds of conventions that the record can have, those whose trial is quick first.
pub(super) fn all(experiment: &Experiment) -> Vec<Vec<Convention>> {
    let segments = experiment.problem.segments.iter();
    let fires: Vec<usize> = segments
        .flat_map(|s| &s.firings)
        .map(|f| f.thruster)
        .collect();
    let thrusters = experiment.thrusters.iter().map(|t| t.name.as_str());
    let mut thrusters = each(thrusters, |k| Place::Thrusters(vec![k]));
    let exchanged_forces = pairs(&thrusters, Place::Thrusters);
    thrusters.retain(|t| t.place.members().iter().all(|k| fires.contains(k)));
    let wheels = experiment.problem.model.wheels.iter();
    let mut wheels = each(wheels.map(|w| w.name.as_str()), |k| Place::Wheels(vec![k]));
    let exchanged = pairs(&wheels, Place::Wheels);
    if wheels.len() > 1 {
        let all = Place::Wheels((0..wheels.len()).collect());
        wheels.push(Convention::as_declared(all, "all wheels".to_owned()));
    }
    let factor = |of: &[Convention], x: f64| rows(of, &[Change::Factor(x)], fixed);
    let mut all = vec![factor(&thrusters, 0.0), factor(&thrusters, -1.0), exchanged];
    if !thrusters.is_empty() {
        let every = Place::Thrusters((0..experiment.thrusters.len()).collect());
        let every = [Convention::as_declared(every, "all thrusters".to_owned())];
        all.push(rows(&every, &THOUSANDS.map(Change::Factor), fixed));
    }
    let factors = [-1.0].into_iter().chain(UNIT_FACTORS);
    all.extend(factors.map(|x| factor(&wheels, x)));
    all.extend(pulses(experiment));
    all.push(exchanged_forces);
    all.extend(joints(experiment.problem));
    all.extend(frames(experiment.problem));
    all.extend(sensors(experiment.problem));
    all
}

/// Each two of a kind in each other's column.
fn pairs(owners: &[Convention], place: fn(Vec<usize>) -> Place) -> Vec<Convention> {
    let of = |j: usize| (0..j).map(move |i| [i, j]);
    let all = (1..owners.len()).flat_map(of).map(|two| {
        let names = two.map(|k| owners[k].owner.as_str()).join(" and ");
        Convention::as_declared(place(two.into()), names)
    });
    rows(&all.collect::<Vec<_>>(), &[Change::Exchanged], fixed)
}

/// All pulses longer or shorter by one time, and all that began earlier or later.
fn pulses(experiment: &Experiment) -> [Vec<Convention>; 2] {
    let segments = experiment.problem.segments.iter();
    let firings = segments.clone().flat_map(|s| &s.firings);
    let lengths: Vec<f64> = firings.map(|f| f.end_s - f.start_s).collect();
    let times = segments.flat_map(|s| s.observations.time_s.windows(2));
    let steps: Vec<f64> = times.map(|t| t[1] - t[0]).collect();
    let every = each(["every pulse"], |_| Place::Pulses);
    let every = if lengths.len() < 2 { &[] } else { &every[..] };
    let [length, step] = [median(lengths), median(steps)];
    let longer = PULSES.map(|share| Change::ClosesLate(share * length));
    let late: Vec<Change> = STEPS
        .iter()
        .flat_map(|k| [*k, -*k].map(|k| Change::Late(k * step)))
        .collect();
    [
        rows(every, &longer, |late| Some(0.8 * late.abs())),
        rows(every, &late, fixed),
    ]
}

/// The middle one, or 0 of none.
fn median(mut all: Vec<f64>) -> f64 {
    all.sort_by(f64::total_cmp);
    all.get(all.len() / 2).copied().unwrap_or_default()
}

/// Signs, exchanged columns, zeros, ratios and units of joints.
fn joints(problem: &Problem) -> Vec<Vec<Convention>> {
    if problem.tree.dof() > MOST_JOINTS {
        return Vec::new();
    }
    let joints = problem.tree.coordinates.iter();
    let joints = joints.filter_map(|at| problem.model.joints.get(*at));
    let kinds: Vec<JointKind> = joints.clone().map(|j| j.kind).collect();
    let mut owners = each(joints.map(|j| j.name.as_str()), |k| Place::Joints(vec![k]));
    let mut exchanged = pairs(&owners, Place::Joints);
    exchanged.retain(|c| {
        let mut two = c.place.members().windows(2);
        two.all(|w| kinds[w[0]] == kinds[w[1]])
    });
    owners.retain(|owner| owner.place.members().iter().all(|k| moves(problem, *k)));
    let turns = |owner: &&Convention| {
        let mut own = owner.place.members().iter();
        own.all(|k| kinds[*k] != JointKind::Prismatic)
    };
    let steps = (-11..=12).filter(|s| *s != 0).map(f64::from);
    let zeros: Vec<Change> = steps.map(|s| Change::Offset(s * ZERO_STEP)).collect();
    let ratios: Vec<Change> = RATIOS
        .iter()
        .flat_map(|r| [*r, -r].map(Change::Factor))
        .collect();
    vec![
        rows(&owners, &[Change::Factor(-1.0)], fixed),
        exchanged,
        rows(owners.iter().filter(turns), &zeros, |_| {
            Some(0.6 * ZERO_STEP)
        }),
        rows(&owners, &ratios, |ratio| Some(ABOUT * ratio.abs())),
        rows(
            owners.iter().filter(turns),
            &UNIT_FACTORS.map(Change::Factor),
            fixed,
        ),
    ]
}

/// Other axes in place of inertial ones: of the orbit, and of the body.
pub(super) fn frames(problem: &Problem) -> Vec<Vec<Convention>> {
    let sensors = problem.segments.iter().take(1);
    let sensors = sensors.flat_map(|s| &s.observations.sensors).enumerate();
    let body = |(k, sensor): (usize, &SensorRecord)| {
        let mut row = of_sensor(k, sensor);
        row.change = match sensor.kind {
            SensorKind::Velocity => Change::Turned(Turned::Velocities),
            SensorKind::Position => Change::Turned(Turned::Positions),
            _ => return None,
        };
        Some(row)
    };
    vec![orbital(problem), sensors.filter_map(body).collect()]
}

fn of_sensor(k: usize, sensor: &SensorRecord) -> Convention {
    Convention::as_declared(Place::Sensor(k), format!("the {}", sensor.name))
}

/// Orbital axes in place of inertial ones.
fn orbital(problem: &Problem) -> Vec<Convention> {
    let mut all = problem.segments.iter().map(|s| &s.observations);
    if !all.all(|o| o.reads(SensorKind::Attitude) && o.reads(SensorKind::Gyro)) {
        return Vec::new();
    }
    let own = [Convention::as_declared(Place::Frame, "attitude".to_owned())];
    let each = ORBITS_RAD_S.iter().flat_map(|x| [*x, -x]);
    let axes = each.flat_map(|x| [true, false].map(|rates| Change::OrbitalAxes(x, rates)));
    rows(&own, &axes.collect::<Vec<_>>(), |rate| {
        Some(ORBITS * rate.abs())
    })
}

/// Sensors whose axes and units only the motion tells where no other sensor of the record, which is compared with them as they are read,
/// measures the same; and factors that put their units right.
const ALONE: [(SensorKind, SensorKind, [f64; 2]); 3] = [
    (
        SensorKind::Gyro,
        SensorKind::Attitude,
        [UNIT_FACTORS[0], UNIT_FACTORS[1]],
    ),
    (SensorKind::Velocity, SensorKind::Position, THOUSANDS),
    (SensorKind::Position, SensorKind::Velocity, THOUSANDS),
];

/// Axes and units of sensors that are alone.
fn sensors(problem: &Problem) -> Vec<Vec<Convention>> {
    let observed = problem.segments.iter().map(|s| &s.observations);
    let Some(first) = observed.clone().next() else {
        return Vec::new();
    };
    let time_s = &first.time_s;
    let mut alone = ALONE.to_vec();
    alone.retain(|(_, other, _)| !observed.clone().any(|o| o.reads(*other)));
    let axes = Axes::all().filter(|axes| *axes != Axes::IDENTITY);
    let axes: Vec<Change> = axes.map(Change::Axes).collect();
    let of = |(k, sensor): (usize, &SensorRecord)| {
        let (_, _, units) = alone.iter().find(|row| row.0 == sensor.kind)?;
        let own = [of_sensor(k, sensor)];
        let units = units.map(Change::Factor);
        let times = sensor.samples.windows(2);
        let step = |two: &[SensorSample]| time_s[two[1].to] - time_s[two[0].to];
        let step = median(times.map(step).collect());
        let late = STEPS.map(|k| Change::Late(k * step));
        Some([&axes[..], &units, &late].map(|changes| rows(&own, changes, fixed)))
    };
    let sensors = first.sensors.iter().enumerate();
    sensors.filter_map(of).flatten().collect()
}

impl Convention {
    fn as_declared(place: Place, owner: String) -> Self {
        Self {
            place,
            change: Change::Factor(1.0),
            owner,
            free: None,
        }
    }

    pub fn value(&self) -> f64 {
        match self.change {
            Change::Factor(x)
            | Change::Offset(x)
            | Change::ClosesLate(x)
            | Change::Late(x)
            | Change::OrbitalAxes(x, _) => x,
            _ => f64::NAN,
        }
    }

    pub fn with_value(mut self, value: f64) -> Self {
        match &mut self.change {
            Change::Factor(x)
            | Change::Offset(x)
            | Change::ClosesLate(x)
            | Change::OrbitalAxes(x, _) => *x = value,
            _ => {}
        }
        self
    }

    /// The same with a ratio of whole numbers or a zero by an eighth of a turn, where the value is near one.
    pub fn rounded(&self) -> Option<Self> {
        let value = self.value();
        let known = match (&self.place, self.change) {
            (_, Change::Offset(_)) => (value / (PI / 4.0)).round() * (PI / 4.0),
            (_, Change::Factor(_)) => ratio(value)?,
            _ => return None,
        };
        let near = (known - value).abs() < SAME * value.abs();
        near.then(|| self.clone().with_value(known))
    }

    /// The mistake.
    pub fn named(&self, problem: &Problem) -> (FaultKind, String) {
        let owner = &self.owner;
        let words = match (&self.place, self.change) {
            (Place::Thrusters(_), Change::Factor(0.0)) => format!("no force of {owner}"),
            (Place::Thrusters(_), Change::Factor(-1.0)) => format!("a wrong direction of {owner}"),
            (_, Change::ClosesLate(x)) => {
                let off = if x < 0.0 { "shorter" } else { "longer" };
                let [by, late] = [x.abs(), x].map(|x| rounded(x, 3));
                let key = format!("closes_late_s = {late} in the columns of the thrusters");
                format!("{owner} {by} s {off} than commanded ({key})")
            }
            (Place::Pulses, Change::Late(x)) if x > 0.0 => "delayed thrust samples".to_owned(),
            (Place::Pulses, Change::Late(_)) => "a lag of the thrust".to_owned(),
            (_, Change::Late(_)) => format!("a lag of {owner}"),
            (Place::Wheels(_), Change::Exchanged) => format!("exchanged speeds of {owner}"),
            (_, Change::OrbitalAxes(x, rates)) => {
                let (rate, what) = (rounded(x, 6), if rates { " and rates" } else { "" });
                format!(
                    "{owner}{what} relative to axes that turn, as the orbital ones do (orbital_frame = {{ rate_rad_s = {rate}, rates = {rates} }})"
                )
            }
            (_, Change::Offset(x)) => {
                let degrees = rounded(x.to_degrees(), 4);
                format!("another zero of {owner} (offset = {degrees} deg in its column)")
            }
            (_, Change::Axes(axes)) => format!("other axes of {owner} {axes}"),
            (_, Change::Turned(turned)) => {
                let key = turned.key();
                format!("{owner} in body axes, not in inertial axes ({key} = true)")
            }
            (Place::Joints(_), Change::Factor(-1.0)) => {
                format!("a wrong sign of {owner} (sign = -1 in its columns)")
            }
            (_, Change::Factor(x)) => return mistake(owner, self.unit(problem), x),
            _ => format!("exchanged columns of {owner}"),
        };
        let fault = match (&self.place, self.change) {
            (_, Change::Late(_)) => FaultKind::Lag,
            (Place::Wheels(_), Change::Exchanged) => FaultKind::WheelExchange,
            (Place::Thrusters(_), _) => FaultKind::Thrust,
            _ => FaultKind::Convention,
        };
        (fault, words)
    }

    /// The unit of the numbers that are read.
    fn unit(&self, problem: &Problem) -> &'static str {
        match self.place {
            Place::Thrusters(_) => "N",
            Place::Joints(_) => "rad",
            Place::Sensor(k) => {
                let record = problem.segments.first();
                let sensor = record.and_then(|s| s.observations.sensors.get(k));
                sensor.map_or("1", |s| printed_unit(s.kind.unit(false)))
            }
            _ => "rad/s",
        }
    }

    /// The change of the map that declares it; `None` where it is one of the model.
    pub fn repair(&self, problem: &Problem) -> Option<Repair> {
        let model = problem.model;
        let of_joint = |k: &usize| -> Vec<String> {
            let joint = problem.registry().joint(*k);
            let mut segments = problem.segments.iter();
            let measured = segments.any(|s| s.observations.joint(*k).rate == InputRate::Measured);
            let rate = measured && !matches!(self.change, Change::Offset(_));
            let position = joint.map(|joint| {
                let unit = SensorKind::JointPosition.unit(joint.kind == JointKind::Prismatic);
                format!("{}_{unit}", joint.name)
            });
            let rate = position.iter().filter(|_| rate).map(|p| format!("{p}_s"));
            position.iter().cloned().chain(rate).collect()
        };
        let force = |k: usize| Some(format!("{}_N", model.thrusters.get(k)?.name));
        let speed = |k: usize| Some(format!("{}_rad_s", model.wheels.get(k)?.name));
        let channels: Vec<String> = match &self.place {
            Place::Wheels(which) => which.iter().filter_map(|k| speed(*k)).collect(),
            Place::Joints(which) => which.iter().flat_map(of_joint).collect(),
            Place::Pulses => (0..model.thrusters.len()).filter_map(force).collect(),
            Place::Frame => Vec::new(),
            Place::Thrusters(_) if self.change == Change::Factor(0.0) => return None,
            Place::Thrusters(which) => which.iter().filter_map(|k| force(*k)).collect(),
            Place::Sensor(k) => {
                let record = problem.segments.first()?.observations.sensors.get(*k)?;
                let sensor = record.name.split_once('.').map_or("", |(_, own)| own);
                let columns = record.kind.columns().iter();
                columns.map(|c| full_name(sensor, c)).collect()
            }
        };
        let change = self.change;
        Some(Repair { channels, change })
    }

    /// Name, value and unit of what puts it right.
    pub fn values(&self) -> Option<(String, f64, &'static str)> {
        let owner = self.owner.trim_start_matches("the ");
        match (&self.place, self.change) {
            (_, Change::Factor(x)) => Some((format!("{owner}.factor"), x, "1")),
            (_, Change::ClosesLate(x)) => Some(("thrust.closes_late".to_owned(), x, "s")),
            // Thrust that acts late has samples that are early.
            (Place::Pulses, Change::Late(x)) => Some(("thrust.lag".to_owned(), -x, "s")),
            (_, Change::Late(x)) => Some((format!("{owner}.lag"), x, "s")),
            (_, Change::Offset(x)) => Some((format!("{owner}.offset"), x, "rad")),
            _ => None,
        }
    }
}

/// What puts a lag right: other times.
pub(in crate::diagnosis) fn late(
    problem: &Problem,
    kind: &UnknownKind,
    lag_s: f64,
) -> Option<Repair> {
    let (place, late_s) = match kind {
        UnknownKind::WheelLag(which) => (Place::Wheels(which.clone()), lag_s),
        UnknownKind::JointLag(which) => (Place::Joints(which.clone()), lag_s),
        // Thrust that acts late has samples that are early.
        UnknownKind::ThrusterLag(which) => (Place::Thrusters(which.clone()), -lag_s),
        UnknownKind::Sensor {
            sensor,
            error: SensorError::Lag,
        } => {
            let mut all = problem.segments.first()?.observations.sensors.iter();
            let own = all.position(|s| s.sensor == Some(*sensor))?;
            (Place::Sensor(own), lag_s)
        }
        _ => return None,
    };
    let mut row = Convention::as_declared(place, String::new());
    row.change = Change::Late(late_s);
    row.repair(problem)
}

/// The mistake that a factor of a number puts right whose unit is this.
pub(in crate::diagnosis) fn mistake(owner: &str, unit: &str, factor: f64) -> (FaultKind, String) {
    match unit_mistake(unit, factor) {
        Some(words) => (
            FaultKind::Units,
            format!("a wrong unit of {owner} ({words})"),
        ),
        None if factor == -1.0 => (FaultKind::WheelSign, format!("a wrong sign of {owner}")),
        None => {
            let scale = rounded(factor, 6);
            let words = format!("another ratio of {owner} (scale = {scale} in its columns)");
            (FaultKind::Convention, words)
        }
    }
}

/// The nearest ratio of small whole numbers.
fn ratio(value: f64) -> Option<f64> {
    let all = (1..=TEETH).flat_map(|a| (1..=TEETH).map(move |b| f64::from(a) / f64::from(b)));
    let distance = |r: &f64| (r - value.abs()).abs();
    let nearest = all.min_by(|a, b| distance(a).total_cmp(&distance(b)));
    nearest.map(|r| r.copysign(value))
}

/// A vector in other axes or units, while the base has this attitude.
pub(super) fn turned(change: Change, R_NB: Option<&UnitQuaternion>, v: &Vector3) -> Vector3 {
    match (change, R_NB) {
        (Change::Axes(axes), _) => axes.turned(v),
        (Change::Factor(x), _) => x * v,
        (Change::Turned(_), Some(R_NB)) => R_NB * v,
        _ => *v,
    }
}
