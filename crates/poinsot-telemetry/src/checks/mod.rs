//! Checks of a valid table, one file per check, each with a named policy.
//!
//! A check changes nothing. The [`Policy`] decides about its finding; [`apply`] carries it out and reports it.

mod lag;
mod outlier;
mod placeholder;
mod runs;
mod saturation;
mod stuck;
mod wrap;

use crate::{Change, Channel, Dimension, Repair, Table, median_step};
use poinsot_files::{Faults, Place, counted};
use schemars::JsonSchema;
use serde::Serialize;

/// Number of times listed per finding.
pub const SHOWN: usize = 20;

/// A check of telemetry.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Check {
    /// Steps longer than three median steps.
    Gap,
    /// A value far off that repeats: a placeholder for no sample.
    Placeholder,
    /// A channel that begins anew at a value: an angle within one turn, an integer read as unsigned.
    Wrap,
    /// Single readings far from their neighbours.
    Outlier,
    /// Each reading stands several times in a row: the sensor is slower than its column.
    Held,
    /// A reading that repeats exactly while its sensor is noisy elsewhere.
    Stuck,
    /// Readings cut at the end of a sensor's range.
    Saturation,
    /// Attitude and gyro are shifted in time against each other.
    Lag,
    /// Numbers that ask for another unit; found against the model.
    Units,
    /// Motor torque and speed of a wheel that contradict each other; found against the model.
    MotorTorque,
}

/// What is done about a finding.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Policy {
    /// It is listed; the samples stay.
    Report,
    /// The samples of the sensor are left out at these times and counted.
    Exclude,
    /// It is an error.
    Refuse,
}

impl Policy {
    /// Name on the command line and in the result.
    pub fn name(self) -> &'static str {
        match self {
            Self::Report => "report",
            Self::Exclude => "exclude",
            Self::Refuse => "refuse",
        }
    }
}

/// Every check in order of execution, its name, and its valid policies, default first.
const CHECKS: [(Check, &str, &[Policy]); 10] = {
    use Policy::{Exclude, Refuse, Report};
    const LEFT_OUT: &[Policy] = &[Exclude, Report, Refuse];
    const LISTED: &[Policy] = &[Report, Refuse];
    [
        (Check::Gap, "gap", LISTED),
        (
            Check::Placeholder,
            "placeholder",
            &[Report, Exclude, Refuse],
        ),
        (Check::Wrap, "wrap", &[Refuse, Report]),
        (Check::Held, "held", LEFT_OUT),
        (Check::Saturation, "saturation", LEFT_OUT),
        (Check::Stuck, "stuck", LEFT_OUT),
        (Check::Outlier, "outlier", LEFT_OUT),
        (Check::Lag, "lag", LISTED),
        (Check::Units, "units", &[Refuse, Report]),
        (Check::MotorTorque, "motor_torque", LISTED),
    ]
};

impl Check {
    /// Every check, in order of execution.
    pub fn all() -> impl Iterator<Item = Self> {
        CHECKS.iter().map(|row| row.0)
    }

    fn row(self) -> (&'static str, &'static [Policy]) {
        let row = CHECKS.iter().find(|row| row.0 == self);
        row.map_or(("", &[]), |row| (row.1, row.2))
    }

    /// Name on the command line and in the result.
    pub fn name(self) -> &'static str {
        self.row().0
    }

    /// Valid policies of this check, default first.
    pub fn policies(self) -> &'static [Policy] {
        self.row().1
    }
}

/// The policy of every check.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Policies {
    chosen: Vec<(Check, Policy)>,
    strict: bool,
}

impl Policies {
    /// The default policies with changes `check=policy`; with `strict`, every finding is an error.
    ///
    /// # Errors
    /// The invalid change and the valid words.
    pub fn new<S: AsRef<str>>(changes: &[S], strict: bool) -> Result<Self, Faults> {
        let mut chosen = Vec::new();
        for change in changes {
            let change = change.as_ref();
            let refuse = |problem: String, advice: String| {
                Faults::usage("--policy", change, problem, advice)
            };
            let (check, policy) = change.split_once('=').ok_or_else(|| {
                let advice = "write CHECK=POLICY, for example outlier=exclude";
                refuse("it has no '='".to_owned(), advice.to_owned())
            })?;
            let check = Check::all().find(|c| c.name() == check).ok_or_else(|| {
                let names = CHECKS.map(|row| row.1).join(", ");
                refuse(
                    format!("there is no check '{check}'"),
                    format!("use one of {names}"),
                )
            })?;
            let known = check.policies().iter();
            let named = known.clone().find(|p| p.name() == policy);
            let policy = *named.ok_or_else(|| {
                let names: Vec<&str> = known.map(|p| p.name()).collect();
                let problem = format!("{} has no such policy", check.name());
                refuse(problem, format!("use one of {}", names.join(", ")))
            })?;
            chosen.push((check, policy));
        }
        Ok(Self { chosen, strict })
    }

    /// The policy of a check; the last change wins.
    pub fn of(&self, check: Check) -> Policy {
        if self.strict && check != Check::Gap {
            return Policy::Refuse;
        }
        let chosen = self.chosen.iter().rev().find(|(c, _)| *c == check);
        chosen.map_or_else(
            || check.policies().first().copied().unwrap_or(Policy::Report),
            |(_, policy)| *policy,
        )
    }
}

/// What a check found in one channel or sensor.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Finding {
    /// The check.
    pub check: Check,
    /// Channel, or the channels of a sensor as `omega_x..z`.
    pub channel: String,
    /// Samples (of a gap: gaps) concerned.
    pub count: usize,
    /// Samples of the channel.
    pub of: usize,
    /// Times of the first of them, s; at most [`SHOWN`].
    pub first_times_s: Vec<f64>,
    /// In words.
    pub text: String,
    /// What was done.
    pub policy: Policy,
    /// What puts the channel right, where a line of a map can.
    #[serde(skip)]
    pub repair: Option<Repair>,
    /// Channels of the table, and the times that are left out of them under [`Policy::Exclude`].
    #[serde(skip)]
    places: Vec<usize>,
    #[serde(skip)]
    times_s: Vec<f64>,
}

impl Finding {
    /// Samples at these times; none where it concerns no single ones.
    pub fn new(
        check: Check,
        channel: impl Into<String>,
        of: usize,
        times_s: Vec<f64>,
        text: String,
    ) -> Self {
        Self {
            check,
            channel: channel.into(),
            count: times_s.len(),
            of,
            first_times_s: times_s.iter().copied().take(SHOWN).collect(),
            text,
            policy: Policy::Report,
            repair: None,
            places: Vec::new(),
            times_s,
        }
    }

    /// Samples of a channel, given their indices.
    fn of_channel(check: Check, channel: &Channel, (samples, text): (Vec<usize>, String)) -> Self {
        let times = samples.iter().filter_map(|&k| channel.time_s.get(k));
        let (all, times) = (channel.values.len(), times.copied().collect());
        Self::new(check, channel.full(), all, times, text)
    }
}

/// Checks a table, applies the policies and returns the findings, those too whose policy is [`Policy::Refuse`]; `label` names the table in
/// its repairs.
///
/// ```
#[doc = include_str!("../../doc/channel.txt")]
/// use poinsot_telemetry::checks::{Check, Policies, apply};
///
/// // Ten samples, a gap of 10 s, ten more. A gap is reported; no sample is left out.
/// let time_s: Vec<f64> = (0..20).map(|k| f64::from(k) + if k < 10 { 0.0 } else { 10.0 }).collect();
/// let values: Vec<f64> = time_s.iter().map(|t| t.sin()).collect();
/// let angle = channel("joint1_rad", "rad", &time_s, &values);
/// let mut table = Table { channels: vec![angle], ..Table::default() };
/// let found = apply(&mut table, "arm.csv", &Policies::default());
/// assert_eq!((found.len(), found[0].check), (1, Check::Gap));
/// assert_eq!(table.channels[0].values.len(), 20);
/// ```
pub fn apply(table: &mut Table, label: &str, policies: &Policies) -> Vec<Finding> {
    let mut all = Vec::new();
    for check in Check::all() {
        let policy = policies.of(check);
        for mut found in look(table, check) {
            found.policy = policy;
            if policy == Policy::Exclude {
                exclude(table, &found);
                let (count, of, channel) = (found.count, found.of, &found.channel);
                let (check, text) = (check.name(), &found.text);
                table.repairs.push(format!(
                    "{label}: {check}: {count} of {of} samples of {channel} left out: {text}"
                ));
            }
            all.push(found);
        }
    }
    all
}

/// The error for a finding whose policy is to refuse.
///
/// ```
#[doc = include_str!("../../doc/channel.txt")]
/// use poinsot_telemetry::checks::{findings, refused};
///
/// let time_s: Vec<f64> = (0..20).map(|k| f64::from(k) + if k < 10 { 0.0 } else { 10.0 }).collect();
/// let values: Vec<f64> = time_s.iter().map(|t| t.sin()).collect();
/// let angle = channel("joint1_rad", "rad", &time_s, &values);
/// let found = findings(&Table { channels: vec![angle], ..Table::default() });
/// assert_eq!(refused("arm.csv", &found[0]).code(), "E0220");
/// ```
pub fn refused(label: &str, finding: &Finding) -> Faults {
    let policies = finding.check.policies();
    let lenient = policies.iter().find(|p| **p != Policy::Refuse);
    let lenient = lenient.map_or("report", |p| p.name());
    let check = finding.check.name();
    let place = Place::label(label).key(&format!("channel '{}'", finding.channel));
    let problem = format!("{check}: {}", finding.text);
    let advice =
        format!("correct it, or accept it by --policy {check}={lenient} (without --strict)");
    Faults::one("E0220", place, problem, advice)
}

/// Checks a table without changing it. Placeholders are also searched in single channels.
///
/// ```
#[doc = include_str!("../../doc/channel.txt")]
/// use poinsot_telemetry::checks::{Check, findings};
///
/// // Ten samples, a gap of 10 s, ten more.
/// let time_s: Vec<f64> = (0..20).map(|k| f64::from(k) + if k < 10 { 0.0 } else { 10.0 }).collect();
/// let values: Vec<f64> = time_s.iter().map(|t| t.sin()).collect();
/// let angle = channel("joint1_rad", "rad", &time_s, &values);
/// let found = findings(&Table { channels: vec![angle], ..Table::default() });
/// assert_eq!((found.len(), found[0].check), (1, Check::Gap));
/// assert_eq!(found[0].first_times_s, [9.0]);
/// ```
pub fn findings(table: &Table) -> Vec<Finding> {
    Check::all().flat_map(|check| look(table, check)).collect()
}

fn look(table: &Table, check: Check) -> Vec<Finding> {
    let sensors = || runs::sensors(table);
    match check {
        Check::Gap => table.channels.iter().filter_map(gaps).collect(),
        Check::Wrap => table.channels.iter().filter_map(wrap::find).collect(),
        Check::Placeholder => per_channel(table, check, placeholder::find),
        Check::Outlier => per_channel(table, check, outlier::find),
        Check::Saturation => per_channel(table, check, saturation::find),
        Check::Held | Check::Stuck => {
            let slow = (check == Check::Held).then(|| runs::inputs(table));
            let all = sensors().into_iter().chain(slow.into_iter().flatten());
            all.filter_map(|sensor| stuck::find(table, &sensor, check))
                .collect()
        }
        Check::Lag => lag::find(table).into_iter().collect(),
        Check::Units | Check::MotorTorque => Vec::new(),
    }
}

/// A check of one channel: indices of faulty samples, and text.
type Find = fn(&Channel) -> Option<(Vec<usize>, String)>;

/// Runs a check on each channel of each vector sensor; that of placeholders on other channels too.
fn per_channel(table: &Table, check: Check, find: Find) -> Vec<Finding> {
    let sensors = runs::sensors(table);
    let of_sensor = |k: &usize| sensors.iter().any(|s| s.channels.contains(k));
    let others = (0..table.channels.len()).filter(|k| !of_sensor(k));
    let others = others.filter(|_| check == Check::Placeholder);
    let vectors = sensors.iter().filter(|s| !s.is_attitude);
    let groups = vectors.map(|s| s.channels.clone());
    let of = |places: Vec<usize>| -> Vec<Finding> {
        let one = |channel: &Channel| {
            let found = find(channel)?;
            let value = found.0.first().and_then(|k| channel.values.get(*k));
            let value = value.filter(|_| check == Check::Placeholder);
            Some(Finding {
                places: places.clone(),
                repair: value.map(|x| Repair::of(&channel.full(), Change::Invalid(*x))),
                ..Finding::of_channel(check, channel, found)
            })
        };
        table.at(&places).into_iter().filter_map(one).collect()
    };
    groups.chain(others.map(|k| vec![k])).flat_map(of).collect()
}

/// Removes the samples of all channels of the sensor at the times found.
fn exclude(table: &mut Table, found: &Finding) {
    let out = |t: &f64| found.times_s.binary_search_by(|o| o.total_cmp(t)).is_ok();
    for &k in &found.places {
        let Some(channel) = table.channels.get_mut(k) else {
            continue;
        };
        let samples = channel
            .time_s
            .iter()
            .copied()
            .zip(channel.values.iter().copied());
        let (times, values): (Vec<f64>, _) = samples.filter(|(t, _)| !out(t)).unzip();
        channel.time_s = times.into();
        channel.values = values;
    }
}

fn gaps(channel: &Channel) -> Option<Finding> {
    // Thrust and torque hold until the next sample; they have no regular step.
    if [Dimension::Force.si(), Dimension::Torque.si()].contains(&channel.unit.as_str()) {
        return None;
    }
    let step = median_step(&channel.time_s)?;
    let pairs = channel.time_s.iter().zip(channel.time_s.iter().skip(1));
    let long: Vec<(f64, f64)> = pairs
        .map(|(a, b)| (*a, b - a))
        .filter(|(_, d)| *d > 3.0 * step)
        .collect();
    let longest = long.iter().map(|g| g.1).fold(0.0, f64::max);
    let lost: f64 = long.iter().map(|g| g.1 - step).sum();
    (!long.is_empty()).then(|| {
        let text = format!(
            "{}, the longest {longest:.6} s, {lost:.6} s lost in all; no value is interpolated across them",
            counted(long.len(), "gap")
        );
        let (all, begins) = (channel.values.len(), long.iter().map(|g| g.0).collect());
        Finding::new(Check::Gap, channel.full(), all, begins, text)
    })
}
