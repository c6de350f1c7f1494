//! Restricted likelihood of the samples under the declared noise: to compare declarations, not estimates.
//!
//! Restricted likelihood (Patterson and Thompson 1971): all fitted parameters are integrated out, so a declaration
//! gains nothing from a better fit.

use crate::fit::Fitted;
use crate::fit::experiment::Experiment;
use crate::problem::prior;

/// `-2 ln L` of the readings up to a constant that no declaration of noise changes: chi-square of readings and
/// calibrations, determinants of the sensors' noise with the random torque, of the calibrations', and that of the information.
/// The noise of joints and wheels counts in chi-square alone.
pub(crate) fn deviance(experiment: &Experiment, fitted: &Fitted) -> f64 {
    let mut sum: f64 = (fitted.evaluated.iter().map(|e| e.cost + e.left_out)).sum();
    let segments = experiment.problem.segments.iter();
    for (segment, one) in segments.zip(&fitted.evaluated) {
        let records = &segment.observations.sensors;
        for channel in &one.channels {
            sum += channel.white.len() as f64 * records[channel.sensor].log_det();
        }
    }
    let calibration = prior::calibration(experiment.problem, experiment.parameters, &fitted.at.x);
    sum += calibration.chi2;
    for row in &calibration.rows {
        let last = row.gradient.iter().rev().find(|g| **g != 0.0);
        sum -= 2.0 * last.map_or(0.0, |g| g.abs().ln());
    }
    for (triangle, own) in experiment.triangles(&fitted.evaluated) {
        sum += log_squares((0..own).map(|i| triangle.r[(i, i)]));
    }
    let (shared, spectrum) = (&fitted.shared, &fitted.spectrum);
    sum += log_squares((0..shared.nuisances).map(|i| shared.r[(i, i)]));
    sum + log_squares((0..spectrum.rank).map(|k| spectrum.singular[k]))
}

/// Sum of `2 ln |x|`; zero for a column without effect.
fn log_squares(of: impl Iterator<Item = f64>) -> f64 {
    of.map(|x| if x == 0.0 { 0.0 } else { 2.0 * x.abs().ln() })
        .sum()
}
