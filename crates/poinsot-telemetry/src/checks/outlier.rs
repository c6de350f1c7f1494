//! Samples far from their neighbours.

use crate::Channel;
use crate::median::{median, spread};
use poinsot_files::rounded;

/// Distance from the median of five, in robust sigmas, above which a sample is an outlier.
const FAR: f64 = 12.0;
/// Fraction of the channel's spread below which a difference is ignored.
const FLOOR: f64 = 0.02;

/// Samples far from the median of five (Hampel identifier) and from the cubic through the other four. A turning point
/// of smooth motion is far only from the median, a neighbour of a spike only from the cubic.
pub(super) fn find(channel: &Channel) -> Option<(Vec<usize>, String)> {
    let values = &channel.values;
    // The pulse of a thruster in an accelerometer is real.
    if values.len() < 16 || channel.name.starts_with("acc_") {
        return None;
    }
    let five: Vec<[f64; 5]> = values
        .windows(5)
        .filter_map(|w| <[f64; 5]>::try_from(w).ok())
        .collect();
    let from_median: Vec<f64> = five
        .iter()
        .map(|w| w[2] - median(&mut w.to_vec()).unwrap_or_default())
        .collect();
    let from_cubic: Vec<f64> = five
        .iter()
        .map(|w| w[2] - (4.0 * (w[1] + w[3]) - w[0] - w[4]) / 6.0)
        .collect();
    let sigma = |of: &[f64]| Some(spread(of)?.1);
    let limit = |residual: &[f64]| Some((FAR * sigma(residual)?).max(FLOOR * sigma(values)?));
    let noise = sigma(&from_cubic)?;
    let (limit_median, limit_cubic) = (limit(&from_median)?, limit(&from_cubic)?);
    let far: Vec<usize> = (from_median.iter().zip(&from_cubic))
        .enumerate()
        .filter(|(k, (m, c))| {
            let far = m.abs() > limit_median && c.abs() > limit_cubic && limit_cubic > 0.0;
            far && five.get(*k).is_some_and(stands_alone)
        })
        .map(|(k, _)| k + 2)
        .collect();
    let worst = from_median.iter().fold(0.0_f64, |m, r| m.max(r.abs()));
    (!far.is_empty()).then(|| {
        let differ = match far.len() {
            1 => "1 sample differs from its neighbours".to_owned(),
            n => format!("{n} samples differ from their neighbours"),
        };
        let (unit, worst, noise) = (&channel.unit, rounded(worst, 4), rounded(noise, 4));
        let text =
            format!("{differ} by up to {worst} {unit}, more than {FAR} robust sigmas ({noise})");
        (far, text)
    })
}

/// Whether the middle of five samples differs from both neighbours alike. A kink by a wheel or thruster differs from
/// one side only. A reversal differs no more than its flanks rise.
fn stands_alone(w: &[f64; 5]) -> bool {
    let height = (w[2] - 0.5 * (w[1] + w[3])).abs();
    let step = (w[3] - w[1]).abs();
    let flank = (w[1] - w[0]).abs().min((w[4] - w[3]).abs());
    height > 4.0 * step.max(flank)
}

#[cfg(test)]
mod tests {
    use super::stands_alone;

    #[test]
    fn exact_kinks_steps_and_reversals_are_no_spikes() {
        assert!(stands_alone(&[0.0, 0.1, 9.0, -0.1, 0.0]));
        assert!(stands_alone(&[7.0, 0.1, 9.0, -0.1, 0.0]));
        assert!(!stands_alone(&[0.0, 0.0, 0.0, 1.0, 2.0]));
        assert!(!stands_alone(&[0.0, 0.0, 0.5, 1.0, 1.0]));
        assert!(!stands_alone(&[0.0, 1.0, 2.0, 1.0, 0.0]));
        assert!(!stands_alone(&[0.0, 9.0, 0.0, 0.1, 0.0]));
    }
}
