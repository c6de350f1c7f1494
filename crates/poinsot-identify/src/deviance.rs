//! How likely the readings are under the declared noise: to compare declarations, not estimates.
//!
//! Restricted likelihood (Patterson and Thompson 1971): everything that was fitted is integrated out, so a
//! declaration is not favoured for what it lets the fit absorb.

use crate::fit::Fitted;
use crate::information::{Experiment, Point};
use crate::likelihood::Evaluated;
use crate::prior;
use crate::solved::Shared;
use poinsot_solve::Spectrum;
use poinsot_spatial::Matrix3;

/// `-2 ln L` of the readings up to a constant that no declaration of noise changes: chi-square of readings and
/// calibrations, determinants of the sensors' noise, of the random torque's and of the calibrations', and that of the information.
/// The noise of joints and wheels counts in chi-square alone.
pub(crate) fn deviance(experiment: &Experiment, fitted: &Fitted) -> f64 {
    let shared = (&fitted.shared, &fitted.spectrum);
    deviance_at(experiment, &fitted.at, &fitted.evaluated, shared)
}

/// The same at any point.
pub(crate) fn deviance_at(
    experiment: &Experiment,
    at: &Point,
    evaluated: &[Evaluated],
    (shared, spectrum): (&Shared, &Spectrum),
) -> f64 {
    let noise = experiment.problem.noise;
    let mut sum: f64 = evaluated.iter().map(|e| e.cost).sum();
    for channel in evaluated.iter().flat_map(|e| &e.channels) {
        let covariance = match channel.name {
            "gyro" => noise.gyro,
            "attitude" => noise.attitude,
            "velocity" => noise.velocity,
            "position" => noise.position,
            _ => Matrix3::identity(),
        };
        sum += channel.white.len() as f64 * covariance.determinant().ln() + channel.log_det;
    }
    let calibration = prior::calibration(experiment.problem, experiment.parameters, &at.x);
    sum += calibration.chi2;
    for row in &calibration.rows {
        let last = row.gradient.iter().rev().find(|g| **g != 0.0);
        sum -= 2.0 * last.map_or(0.0, |g| g.abs().ln());
    }
    for (one, unknown) in evaluated.iter().zip(&experiment.unknown) {
        if let Some(t) = &one.triangle {
            sum += (0..unknown.count())
                .map(|i| log_square(t.r[(i, i)]))
                .sum::<f64>();
        }
    }
    sum += (0..shared.nuisances)
        .map(|i| log_square(shared.r[(i, i)]))
        .sum::<f64>();
    sum += spectrum.singular[..spectrum.rank]
        .iter()
        .map(|s| log_square(*s))
        .sum::<f64>();
    sum
}

/// `2 ln |x|`; nothing of a column that nothing sees.
fn log_square(x: f64) -> f64 {
    if x == 0.0 { 0.0 } else { 2.0 * x.abs().ln() }
}
