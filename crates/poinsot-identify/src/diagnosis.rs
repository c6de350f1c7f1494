//! When the fit is worse than the declared noise: what would explain it?
//!
//! Each candidate fault is a group of columns that the fit did not have. Its score is how much of the
//! residual those columns reach beyond the fitted unknowns: the decrease of chi-square that adding it would
//! bring, to first order. A spectral line in the gyro residual speaks of flexing or slosh.

use crate::block_qr::{BlockQr, Triangle};
use crate::fit::Fitted;
use crate::information::{Experiment, Point};
use crate::likelihood::ChannelResidual;
use crate::parameters::{Parameters, Unknown, UnknownKind, axis_name};
use poinsot_model::SensorKind;
use poinsot_spatial::Vector3;

/// Decrease of chi-square, over its mean per number, from which a candidate is named: one in 10^8 by chance.
const SIGNIFICANT: f64 = 40.0;
/// Excess of chi-square, in its own standard deviations, below which nothing is to be explained.
const EXCESS: f64 = 6.0;
/// Squared length of a whitened reading, three numbers, beyond which it is an outlier: one in 10^6.
const OUTLIER: f64 = 30.7;
/// Share of outliers worth a word.
const OUTLIER_SHARE: f64 = 1.0e-3;
/// Share of the power of a residual in one line that is a line.
const LINE: f64 = 0.25;
/// Most samples that the periodogram takes.
const PERIODOGRAM: usize = 4096;

/// What the residuals say.
#[derive(Debug, Clone, Default)]
pub(crate) struct Diagnosis {
    /// Sentences for the warnings.
    pub findings: Vec<String>,
    /// Whether a line in the residual speaks against a rigid vehicle.
    pub not_rigid: bool,
}

/// Candidate faults of one kind.
struct Candidate {
    /// What it would be called.
    name: String,
    unknowns: Vec<Unknown>,
}

/// Looks for what explains the misfit of a fit.
pub(crate) fn diagnose(experiment: &Experiment, fitted: &Fitted) -> Diagnosis {
    let mut out = Diagnosis::default();
    let rows: usize = fitted.evaluated.iter().map(|e| e.rows).sum();
    let chi2: f64 = fitted.evaluated.iter().map(|e| e.chi2).sum();
    let excess = chi2 - rows as f64;
    outliers(fitted, &mut out);
    let per_number = (chi2 / rows.max(1) as f64).max(1.0);
    let misfit = excess > EXCESS * (2.0 * rows as f64).sqrt();
    let mut scores = scores(experiment, fitted);
    scores.sort_by(|a, b| b.decrease.total_cmp(&a.decrease));
    let named = scores
        .first()
        .filter(|s| s.decrease > SIGNIFICANT * per_number);
    if let Some(best) = named {
        let gain = if misfit {
            let share = 100.0 * (best.decrease / excess).min(1.0);
            format!("would explain {share:.0} % of the misfit")
        } else {
            format!("would lower chi-square by {:.0}", best.decrease)
        };
        out.findings
            .push(format!("{} {gain}: {}", best.name, best.values.join(", ")));
    }
    if !misfit {
        return out;
    }
    for one in &fitted.evaluated {
        for channel in &one.channels {
            describe(channel, &mut out);
        }
    }
    let lines = spectral_lines(experiment, fitted);
    if named.is_none_or(|s| s.decrease < 0.7 * excess) {
        for line in lines {
            out.not_rigid = true;
            out.findings.push(line);
        }
    }
    out.findings.dedup();
    out
}

/// A sensor whose residual is larger than declared.
fn describe(channel: &ChannelResidual, out: &mut Diagnosis) {
    let count = 3.0 * channel.white.len().max(1) as f64;
    let ratio = channel.white.iter().map(|w| w.norm_squared()).sum::<f64>() / count;
    if ratio > 1.0 + EXCESS * (2.0 / count).sqrt() {
        out.findings.push(format!(
            "residual of the {} is {:.2} times its declared noise",
            channel.name,
            ratio.sqrt()
        ));
    }
}

fn outliers(fitted: &Fitted, out: &mut Diagnosis) {
    for one in &fitted.evaluated {
        for channel in &one.channels {
            let far = channel
                .white
                .iter()
                .filter(|w| w.norm_squared() > OUTLIER)
                .count();
            let share = far as f64 / channel.white.len().max(1) as f64;
            if share > OUTLIER_SHARE && far > 1 {
                out.findings.push(format!(
                    "{far} of {} readings of the {} ({:.1} %) are outliers, beyond one in a million",
                    channel.white.len(),
                    channel.name,
                    100.0 * share
                ));
            }
        }
    }
}

/// How much a candidate would lower chi-square, and its values then.
struct Score {
    name: String,
    decrease: f64,
    values: Vec<String>,
}

fn scores(experiment: &Experiment, fitted: &Fitted) -> Vec<Score> {
    let candidates = candidates(experiment);
    let mut extended = experiment.parameters.clone();
    let base = extended.len();
    for candidate in &candidates {
        extended.unknowns.extend(candidate.unknowns.clone());
    }
    let wide = experiment.with_parameters(&extended);
    let mut x = fitted.at.x.clone();
    x.extend(extended.unknowns[base..].iter().map(|u| u.nominal));
    let at = Point {
        x,
        heads: fitted.at.heads.clone(),
    };
    let Some(evaluated) = wide.evaluate(&at, true) else {
        return Vec::new();
    };
    let stacked = wide.stack(&at, &evaluated, true);
    let mut from = base;
    candidates
        .iter()
        .map(|candidate| {
            let columns = from..from + candidate.unknowns.len();
            from = columns.end;
            score(&stacked, experiment.parameters, fitted, candidate, columns)
        })
        .collect()
}

/// QR of `[fitted directions | candidate | residual]` within the stacked triangle.
fn score(
    stacked: &Triangle,
    parameters: &Parameters,
    fitted: &Fitted,
    candidate: &Candidate,
    columns: std::ops::Range<usize>,
) -> Score {
    let r = &stacked.r;
    let last = r.ncols() - 1;
    let spectrum = &fitted.spectrum;
    let mass = fitted.shared.mass;
    let nuisances = parameters.len() - mass;
    let own = columns.len();
    // A candidate that nothing sees must not divide by zero.
    let scale: Vec<f64> = columns
        .clone()
        .map(|j| {
            let size = (0..r.nrows())
                .map(|i| r[(i, j)].powi(2))
                .sum::<f64>()
                .sqrt();
            if size > 0.0 { 1.0 / size } else { 0.0 }
        })
        .collect();
    let mut qr = BlockQr::new(spectrum.rank + nuisances + own + 1);
    qr.push(r.nrows(), |i, j| {
        if j < spectrum.rank {
            (0..mass)
                .map(|k| r[(i, k)] * spectrum.natural[k] * spectrum.directions[(k, j)])
                .sum()
        } else if j < spectrum.rank + nuisances {
            r[(i, mass + j - spectrum.rank)]
        } else if let Some(k) = j
            .checked_sub(spectrum.rank + nuisances)
            .filter(|k| *k < own)
        {
            r[(i, columns.start + k)] * scale[k]
        } else {
            r[(i, last)]
        }
    });
    let t = qr.finish().r;
    let first = spectrum.rank + nuisances;
    let mut values = vec![0.0; own];
    let mut decrease = 0.0;
    for k in (0..own).rev() {
        let pivot = t[(first + k, first + k)];
        // A column that lies within the fitted ones reaches nothing new.
        if pivot.abs() < 1.0e-6 {
            continue;
        }
        let right = t[(first + k, first + own)];
        decrease += right * right;
        let known: f64 = (k + 1..own)
            .map(|m| t[(first + k, first + m)] * values[m])
            .sum();
        values[k] = (right - known) / pivot;
    }
    Score {
        name: candidate.name.clone(),
        decrease,
        values: candidate
            .unknowns
            .iter()
            .zip(values.iter().zip(&scale))
            .map(|(u, (v, s))| {
                let unit = if u.unit == "1" { "" } else { u.unit };
                format!("{} = {:.3e} {unit}", u.name, v * s)
                    .trim()
                    .to_owned()
            })
            .collect(),
    }
}

/// Everything that may be wrong and was not already unknown.
fn candidates(experiment: &Experiment) -> Vec<Candidate> {
    let model = experiment.problem.model;
    let has = |kind: &UnknownKind| {
        experiment
            .parameters
            .unknowns
            .iter()
            .any(|u| u.kind == *kind)
    };
    let gyro = model
        .sensors_of(SensorKind::Gyro)
        .next()
        .map_or("gyro", |s| s.name.as_str());
    let tracker = model
        .sensors_of(SensorKind::Attitude)
        .next()
        .map_or("attitude", |s| s.name.as_str());
    let unknown = |kind: UnknownKind, name: String, unit: &'static str| Unknown {
        kind,
        name,
        unit,
        nominal: 0.0,
        natural: 1.0,
    };
    let triple =
        |name: &str, make: fn(usize) -> UnknownKind, prefix: &str, unit: &'static str| Candidate {
            name: name.to_owned(),
            unknowns: (0..3)
                .map(|k| unknown(make(k), format!("{prefix}_{}", axis_name(k)), unit))
                .collect(),
        };
    let mut list = vec![
        triple(
            "a bias of the gyro",
            UnknownKind::GyroBias,
            &format!("{gyro}.bias"),
            "rad/s",
        ),
        triple(
            "a scale error of the gyro",
            UnknownKind::GyroScale,
            &format!("{gyro}.scale"),
            "1",
        ),
        triple(
            "a misalignment of the gyro",
            UnknownKind::GyroMisalignment,
            &format!("{gyro}.misalignment"),
            "rad",
        ),
        triple(
            "a constant torque of the surroundings",
            UnknownKind::DisturbanceTorque,
            "environment.torque",
            "N m",
        ),
        triple("drag", UnknownKind::DragTorque, "environment.drag", "kg m2"),
        Candidate {
            name: "a lag of the gyro".to_owned(),
            unknowns: vec![unknown(UnknownKind::GyroLag, format!("{gyro}.lag"), "s")],
        },
        Candidate {
            name: "a lag of the attitude".to_owned(),
            unknowns: vec![unknown(
                UnknownKind::AttitudeLag,
                format!("{tracker}.lag"),
                "s",
            )],
        },
    ];
    for (k, wheel) in model.wheels.iter().enumerate() {
        let mut one = unknown(
            UnknownKind::SpinInertia(k),
            format!("{}.spin_inertia", wheel.name),
            "kg m2",
        );
        one.nominal = wheel.spin_inertia;
        list.push(Candidate {
            name: format!("another spin inertia or a wrong sign of {}", wheel.name),
            unknowns: vec![one],
        });
    }
    for (k, thruster) in model.thrusters.iter().enumerate() {
        list.push(Candidate {
            name: format!("another thrust of {}", thruster.name),
            unknowns: vec![unknown(
                UnknownKind::ThrusterScale(k),
                format!("{}.scale", thruster.name),
                "1",
            )],
        });
    }
    list.retain(|c| !c.unknowns.iter().any(|u| has(&u.kind)));
    list
}

/// A line that stands out of the periodogram of a segment's gyro residual.
fn spectral_lines(experiment: &Experiment, fitted: &Fitted) -> Vec<String> {
    let mut found = Vec::new();
    for (segment, one) in experiment.problem.segments.iter().zip(&fitted.evaluated) {
        let Some(gyro) = one.channels.iter().find(|c| c.name == "gyro") else {
            continue;
        };
        let times: Vec<f64> = segment
            .observations
            .time_s
            .iter()
            .zip(&segment.observations.rate)
            .filter_map(|(t, w)| w.map(|_| *t))
            .collect();
        if let Some((frequency, share)) = strongest_line(&times, &gyro.white) {
            found.push(format!(
                "{}: a line at {frequency:.3} Hz holds {:.0} % of the gyro residual: the vehicle is not rigid (flexing, slosh), or something unmodelled turns in it",
                segment.label,
                100.0 * share
            ));
        }
    }
    found
}

/// Frequency, Hz, and share of the power of the strongest line, with its two neighbours on each side;
/// `None` where none stands out. Slow drifts (the first few frequencies) are not lines.
fn strongest_line(times: &[f64], white: &[Vector3]) -> Option<(f64, f64)> {
    let n = times.len().min(white.len()).min(PERIODOGRAM);
    if n < 64 {
        return None;
    }
    let step = (times[n - 1] - times[0]) / (n - 1) as f64;
    let mut power = vec![0.0; n / 2];
    for axis in 0..3 {
        let mean = white[..n].iter().map(|w| w[axis]).sum::<f64>() / n as f64;
        for (k, p) in power.iter_mut().enumerate() {
            let turn = std::f64::consts::TAU * k as f64 / n as f64;
            let (sin, cos) = turn.sin_cos();
            // One rotating phasor instead of n sines.
            let (mut re, mut im, mut c, mut s) = (0.0, 0.0, 1.0, 0.0);
            for w in &white[..n] {
                re += (w[axis] - mean) * c;
                im -= (w[axis] - mean) * s;
                (c, s) = (c * cos - s * sin, s * cos + c * sin);
            }
            *p += re * re + im * im;
        }
    }
    let total: f64 = power.iter().sum();
    let (peak, _) = power
        .iter()
        .enumerate()
        .skip(4)
        .max_by(|a, b| a.1.total_cmp(b.1))?;
    let near = peak.saturating_sub(2)..(peak + 3).min(power.len());
    let share = power[near].iter().sum::<f64>() / total;
    (share > LINE).then(|| (peak as f64 / (n as f64 * step), share))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exact_line_of_a_sine_is_found_at_its_frequency() {
        let times: Vec<f64> = (0..1000).map(|k| 0.1 * k as f64).collect();
        let sine: Vec<Vector3> = times
            .iter()
            .map(|t| Vector3::new((std::f64::consts::TAU * 0.4 * t).sin(), 0.0, 0.1))
            .collect();
        let (frequency, share) = strongest_line(&times, &sine).unwrap();
        assert!((frequency - 0.4).abs() < 0.01 && share > 0.9);
    }

    #[test]
    fn stat_white_noise_has_no_line() {
        // A linear congruential sequence is white enough for a periodogram.
        let mut state = 1_u64;
        let mut next = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1);
            (state >> 33) as f64 / 2_f64.powi(31) - 0.5
        };
        let times: Vec<f64> = (0..1000).map(|k| 0.1 * k as f64).collect();
        let noise: Vec<Vector3> = times
            .iter()
            .map(|_| Vector3::new(next(), next(), next()))
            .collect();
        assert!(strongest_line(&times, &noise).is_none());
    }
}
