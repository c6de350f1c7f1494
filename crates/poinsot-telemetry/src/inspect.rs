//! Summary of a table for an engineer who sees it for the first time.

use crate::conventions::{ConventionTest, convention_tests};
use crate::median::{ends, median_step};
use crate::noise::noise_level;
use crate::{Channel, Source, Table, suggestions};
use schemars::JsonSchema;
use serde::Serialize;

/// Everything that can be said about a table without a vehicle.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Inspection {
    /// The files.
    pub sources: Vec<Source>,
    /// First and last time of any channel, s.
    pub time_s: Option<[f64; 2]>,
    /// One line per channel.
    pub channels: Vec<ChannelSummary>,
    /// What measures one motion, compared: attitude and gyro, direction and gyro, position and rate.
    pub conventions: Vec<ConventionTest>,
    /// Columns that were not taken.
    pub ignored: Vec<String>,
    /// What some of them may be, as lines of a map.
    pub suggestions: Vec<String>,
    /// What was repaired while reading.
    pub repairs: Vec<String>,
    /// What looks wrong and cannot be decided here.
    pub notes: Vec<String>,
    /// What the checks found.
    pub findings: Vec<crate::checks::Finding>,
}

/// One channel in numbers, SI.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct ChannelSummary {
    /// `<sensor>.<name>`, or the name.
    pub name: String,
    /// SI unit.
    pub unit: String,
    /// `body`, `inertial` or empty.
    pub frame: String,
    /// Samples.
    pub samples: usize,
    /// First and last time, s.
    pub time_s: [f64; 2],
    /// One over the median step, Hz.
    pub rate_hz: Option<f64>,
    /// Steps longer than three median steps.
    pub gaps: usize,
    /// Samples that are missing between others, scattered ones and those of gaps, at the median step.
    pub lost: usize,
    /// The longest gap, s; zero if none.
    pub longest_gap_s: f64,
    /// Smallest value.
    pub min: f64,
    /// Largest value.
    pub max: f64,
    /// All samples are equal.
    pub constant: bool,
    /// All values are multiples of this step: quantisation, or the last digit written.
    pub quantum: Option<f64>,
    /// White noise seen, one sigma per sample; `None` where none can be seen.
    pub noise: Option<f64>,
    /// One sigma of it by chance, as a share of it.
    pub noise_relative_error: Option<f64>,
    /// Whether motion between the samples may be part of it.
    pub noise_is_upper_bound: bool,
}

/// Summarises every channel and compares those that measure one motion. The table is not changed.
///
/// ```
#[doc = include_str!("../doc/channel.txt")]
/// let rate = channel("joint1_rad_s", "rad/s", &[0.0, 0.1, 0.2, 0.3], &[1.0, 3.0, 2.0, 0.0]);
/// let found = inspect(&Table { channels: vec![rate], ..Table::default() });
/// let of_rate = &found.channels[0];
/// assert_eq!((of_rate.min, of_rate.max, of_rate.gaps), (0.0, 3.0, 0));
/// assert!((of_rate.rate_hz.unwrap() - 10.0).abs() < 1.0e-9);
/// ```
pub fn inspect(table: &Table) -> Inspection {
    let channels: Vec<ChannelSummary> = table.channels.iter().filter_map(summarise).collect();
    let span = channels.iter().map(|c| c.time_s).reduce(hull);
    Inspection {
        sources: table.sources.clone(),
        time_s: span,
        conventions: convention_tests(table),
        ignored: table.ignored.clone(),
        suggestions: suggestions(&table.ignored),
        repairs: table.repairs.clone(),
        notes: channels.iter().flat_map(notes).collect(),
        findings: crate::checks::findings(table),
        channels,
    }
}

/// The shortest range that holds both.
pub(crate) fn hull([a0, a1]: [f64; 2], [b0, b1]: [f64; 2]) -> [f64; 2] {
    [a0.min(b0), a1.max(b1)]
}

fn summarise(channel: &Channel) -> Option<ChannelSummary> {
    let step = median_step(&channel.time_s);
    let steps = channel.time_s.windows(2).map(|t| t[1] - t[0]);
    let lost = steps.clone().filter_map(|d| Some(missing(d, step?)));
    let gaps: Vec<f64> = steps
        .filter(|d| step.is_some_and(|s| *d > 3.0 * s))
        .collect();
    let noise = noise_level(channel);
    let [min, max] = ends(&channel.values);
    Some(ChannelSummary {
        name: channel.full(),
        unit: channel.unit.clone(),
        frame: channel.frame.clone(),
        samples: channel.values.len(),
        time_s: [*channel.time_s.first()?, *channel.time_s.last()?],
        rate_hz: step.map(|s| 1.0 / s),
        gaps: gaps.len(),
        lost: lost.fold(0, usize::saturating_add),
        longest_gap_s: gaps.iter().copied().fold(0.0, f64::max),
        min,
        max,
        constant: crate::noise::is_constant(&channel.values),
        // Computed with the noise, because sorting the values twice would double the cost.
        quantum: match &noise {
            Some(seen) => seen.quantum,
            None => crate::noise::quantum(&channel.values),
        },
        noise: noise.filter(|n| n.sigma > 0.0).map(|n| n.sigma),
        noise_relative_error: noise.filter(|n| n.sigma > 0.0).map(|n| n.relative_error),
        noise_is_upper_bound: noise.is_some_and(|n| n.upper_bound),
    })
}

/// Number of samples missing in a step, given the usual step, s.
pub(crate) fn missing(step: f64, usual: f64) -> usize {
    let whole = (step / usual).round() - 1.0;
    // Thrust and other events have no regular step.
    if whole.is_finite() && whole > 0.0 {
        whole as usize
    } else {
        0
    }
}

/// Wheel speed above which the unit is questioned, rad/s (9550 rpm).
const FAST_WHEEL: f64 = 1000.0;

pub(crate) fn notes(channel: &ChannelSummary) -> Vec<String> {
    let name = &channel.name;
    let mut notes = Vec::new();
    let largest = channel.max.abs().max(channel.min.abs());
    if name.ends_with("_rad_s") && largest > FAST_WHEEL {
        notes.push(format!(
            "{name} reaches {largest:.0} rad/s ({:.0} rpm): check its unit, which attitude and gyro do not determine",
            largest * 30.0 / std::f64::consts::PI
        ));
    }
    if name.starts_with("r_") && largest > 1e5 {
        notes.push(format!(
            "{name} reaches {} m: with [environment] gravity in the model, they are used relative to free fall",
            poinsot_files::rounded(largest, 4)
        ));
    }
    notes
}
