//! Faults of the noise: larger than declared, outliers, jitter of times, rounding.
//!
//! Each is a model of the variance of one sensor's whitened residual. The fall of `-2 ln L` is that of its best value,
//! on the same scale as the decrease of chi-square by a fault of the mean.

use super::EXCESS;
use super::candidates::sensors_read;
use super::channels::predictable;
use super::suspects::{Misfit, Scored};
use super::table::Table;
use super::types::{ChannelDiagnosis, FaultKind, Suspect, SuspectValue};
use crate::fit::Fitted;
use crate::fit::experiment::Experiment;
use crate::problem::segment::SensorRecord;
use poinsot_dynamics::SensorError;
use poinsot_spatial::{Matrix3, Vector3};
use poinsot_telemetry::common_step;

/// Standard deviation of a median over that of a mean.
const MEDIAN_SCATTER: f64 = 1.5;
/// Part of a step by which a rounded value may lie off its multiple.
const OFF_STEP: f64 = 1.0e-3;
/// Values of the variance that are tried, per decade, and decades about the one that doubles the noise.
const TRIED_VARIANCES: (i32, i32) = (8, 4);
/// Samples that share a logarithm: with the largest variance tried each factor is below 10^4 times the number of samples, so
/// that no product of so many overflows.
const SAMPLES_AT_ONCE: usize = 16;

/// Every noise model of every sensor.
pub(super) fn noise_models(
    experiment: &Experiment,
    fitted: &Fitted,
    channels: &[ChannelDiagnosis],
    table: Option<&Table>,
    of: Misfit,
) -> Vec<Scored> {
    let mut list = Vec::new();
    for channel in channels {
        list.extend(outliers(experiment, fitted, channel));
        if of.misfit {
            list.extend(noise(experiment, fitted, channel));
        }
    }
    if let Some(table) = table {
        list.extend(jitters(table, of.mean_square()));
    }
    list
}

/// A noise model with one number.
fn scored(
    name: String,
    fault: FaultKind,
    decrease: f64,
    (of, value, unit): (String, f64, &'static str),
) -> Scored {
    let values = vec![SuspectValue::other(of, value, unit)];
    Scored::alone(Suspect::new(name, fault, decrease, values))
}

/// A few samples with another, larger scatter.
fn outliers(
    experiment: &Experiment,
    fitted: &Fitted,
    channel: &ChannelDiagnosis,
) -> Option<Scored> {
    let limits = experiment.settings.diagnosis;
    let share = channel.outlier_share();
    // If most samples are outliers, the model is wrong.
    if share <= limits.least_outliers || share > limits.most_outliers || channel.outliers < 2 {
        return None;
    }
    let residuals = fitted.evaluated.iter().flat_map(|e| &e.channels);
    let own = residuals.filter(|c| c.name == channel.name);
    let each = channel.numbers / channel.readings.max(1);
    let limit = super::channels::outlier_threshold(each) * channel.typical_chi2_per_number.max(1.0);
    let squares = own.flat_map(|c| &c.white).map(|w| w.norm_squared());
    let bad: f64 = squares.filter(|s| *s > limit).sum();
    let (count, all) = (channel.outliers as f64, channel.readings as f64);
    let each = each as f64;
    let larger = (bad / (each * count)).max(1.0);
    let decrease = bad * (1.0 - 1.0 / larger) - count * (each * larger.ln() - 2.0 * share.ln())
        + 2.0 * (all - count) * (1.0 - share).ln();
    let name = format!(
        "outliers, {} of {} samples of the {} ({:.1} %) beyond one in a million,",
        channel.outliers,
        channel.readings,
        channel.name,
        100.0 * share
    );
    // Their share and their scatter.
    Some(Scored::alone(Suspect {
        numbers: 2,
        ..Suspect::new(name, FaultKind::Outliers, decrease, Vec::new())
    }))
}

/// Noise larger than declared, or the rounding that makes it so.
fn noise(experiment: &Experiment, fitted: &Fitted, channel: &ChannelDiagnosis) -> Option<Scored> {
    let numbers = channel.numbers as f64;
    let ratio = channel.typical_chi2_per_number;
    if ratio <= 1.0 + MEDIAN_SCATTER * EXCESS * (2.0 / numbers).sqrt() {
        return None;
    }
    let mean = channel.chi2_per_number.max(1.0);
    let decrease = numbers * (mean - 1.0 - mean.ln());
    let segments = experiment.problem.segments.iter();
    let mut records = segments.flat_map(|s| &s.observations.sensors);
    let record = records.find(|r| r.name == channel.name)?;
    let variance = record.covariance.trace() / 3.0;
    if let Some(step) = step(record)
        && step * step / 12.0
            > experiment.settings.diagnosis.rounding_share * (mean - 1.0) * variance
    {
        let name = format!("rounding of the {}", channel.name);
        let value = (format!("{}.step", channel.name), step, "");
        return Some(scored(name, FaultKind::Quantisation, decrease, value));
    }
    channel.is_white().then(|| {
        // What the declared noise of inputs adds is as declared.
        let residuals = fitted.evaluated.iter().flat_map(|e| &e.channels);
        let own = residuals.filter(|c| c.name == channel.name);
        let square = own.map(|c| c.square).sum::<f64>() / numbers;
        let share = (variance * channel.chi2_per_number / square).min(1.0);
        let factor = (1.0 + (ratio - 1.0) / share).sqrt();
        let of = &channel.name;
        let name = format!("noise of the {of} {factor:.2} times as large as declared");
        let value = (format!("{}.noise_factor", channel.name), factor, "1");
        scored(name, FaultKind::NoiseUnderstated, decrease, value)
    })
}

/// The step of which all values of a sensor are multiples, where it is not far below its noise.
fn step(record: &SensorRecord) -> Option<f64> {
    let of_axis = |axis: usize| {
        let values = record.vectors().map(|(_, v)| v[axis]);
        let floor = OFF_STEP * record.covariance[(axis, axis)].sqrt();
        let values: Vec<f64> = values.collect();
        common_step(&values, 1, floor, |n| OFF_STEP * (1.0 + n))
    };
    (0..3)
        .map(of_axis)
        .try_fold(0.0_f64, |most, step| Some(most.max(step?)))
}

/// Jitter of sample times, by sensor: the residual is larger where the signal changes fast.
fn jitters(table: &Table, mean_square: f64) -> Vec<Scored> {
    let experiment = table.experiment;
    let mut list = Vec::new();
    let model = experiment.problem.model;
    let limits = experiment.settings.diagnosis;
    for (sensor, name) in sensors_read(experiment.problem) {
        let Some(place) = table.place(sensor, SensorError::Lag) else {
            continue;
        };
        let pairs = table.residuals_beside(&name, place);
        let numbers = model.sensors[sensor].kind.numbers();
        let (decrease, variance) = scatter(&pairs);
        let white = |variance: f64| {
            let left = table.refitted(&name, |slope| less_along(slope, variance), place);
            predictable(&left, numbers).is_none_or(|share| share < limits.predictable_share)
        };
        let words = name.replace('_', " ");
        let what = format!("jitter of the sample times of the {words}");
        let value = (format!("{name}.jitter"), variance.sqrt(), "s");
        let jitter = scored(what, FaultKind::TimeJitter, decrease, value);
        if jitter.is_significant(mean_square, limits.false_alarm) && white(variance) {
            list.push(jitter);
        }
    }
    list
}

/// The fall of `-2 ln L` with the best variance of the times, and that variance. Pairs are whitened residuals beside their
/// changes with time.
fn scatter(pairs: &[(Vector3, Vector3)]) -> (f64, f64) {
    let squares = pairs.iter().map(|p| p.1.norm_squared());
    let mean = squares.sum::<f64>() / pairs.len().max(1) as f64;
    let along = |(residual, slope): &(Vector3, Vector3)| {
        let square = slope.norm_squared();
        let part = if square > 0.0 {
            residual.dot(slope).powi(2) / square
        } else {
            0.0
        };
        (part, square)
    };
    let along: Vec<(f64, f64)> = pairs.iter().map(along).collect();
    let (per_decade, decades) = TRIED_VARIANCES;
    let tried = -per_decade * decades..=per_decade * decades;
    // One logarithm for several samples: of the product of what each adds to the variance.
    let several = |variance: f64, some: &[(f64, f64)]| -> f64 {
        let (mut explained, mut product) = (0.0, 1.0);
        for (square, slope) in some {
            let more = variance * slope;
            explained += square * more / (1.0 + more);
            product *= 1.0 + more;
        }
        explained - product.ln()
    };
    let fall = |variance: f64| -> f64 {
        let all = along.chunks(SAMPLES_AT_ONCE);
        all.map(|some| several(variance, some)).sum()
    };
    let variances = tried.map(|k| 10.0_f64.powf(f64::from(k) / f64::from(per_decade)) / mean);
    let all = variances.map(|v| (fall(v), v));
    let best = all.max_by(|a, b| a.0.total_cmp(&b.0));
    best.unwrap_or((0.0, 0.0))
}

/// Whitens a residual whose time has a variance: shrinks its part along the change with time.
fn less_along(slope: &Vector3, variance: f64) -> Matrix3 {
    let square = slope.norm_squared().max(f64::MIN_POSITIVE);
    let shrunk = 1.0 - 1.0 / (1.0 + variance * square).sqrt();
    Matrix3::identity() - slope * slope.transpose() * (shrunk / square)
}
