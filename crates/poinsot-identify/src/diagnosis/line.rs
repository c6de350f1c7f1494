//! A spectral line in the gyro residual: flexing, slosh, or an unmodelled rotor.

use super::oscillation::Series;
use super::types::SpectralLine;
use crate::fit::Fitted;
use crate::fit::experiment::Experiment;
use poinsot_spatial::Vector3;

/// Most samples that the periodogram takes.
const PERIODOGRAM: usize = 4096;

/// A line that stands out of the periodogram of a segment's gyro residual.
pub(super) fn spectral_lines(experiment: &Experiment, fitted: &Fitted) -> Vec<SpectralLine> {
    let mut found = Vec::new();
    let limits = experiment.settings.diagnosis;
    for (segment, one) in experiment.problem.segments.iter().zip(&fitted.evaluated) {
        let Some(gyro) = Series::of(segment, one, usize::MAX) else {
            continue;
        };
        let Some(line) = strongest_line(&gyro.time_s, &gyro.white, limits.line_share) else {
            continue;
        };
        if !line.is_driven(&gyro.rate, limits.driven_share) {
            found.push(SpectralLine {
                segment: segment.label.clone(),
                frequency_hz: line.frequency_hz,
                share: line.share,
            });
        }
    }
    found
}

/// The strongest line of a spectrum.
struct Line {
    frequency_hz: f64,
    share: f64,
    bins: std::ops::Range<usize>,
}

impl Line {
    /// Whether the manoeuvre drives the vehicle at the line: then a wrong rigid model causes a line there too.
    fn is_driven(&self, predicted: &[Vector3], most: f64) -> bool {
        let changes: Vec<Vector3> = predicted.windows(2).map(|w| w[1] - w[0]).collect();
        let share = |motion: &[Vector3]| {
            let n = motion.len().min(PERIODOGRAM);
            // A record that does not end as it began leaks into all frequencies: Hann's window.
            let window = |k: usize| (std::f64::consts::PI * k as f64 / n as f64).sin().powi(2);
            let faded: Vec<Vector3> = motion[..n]
                .iter()
                .enumerate()
                .map(|(k, w)| w * window(k))
                .collect();
            let power = spectrum(&faded);
            let at = power.get(self.bins.clone()).map_or(0.0, |p| p.iter().sum());
            let all: f64 = power.iter().skip(1).sum();
            if all > 0.0 { at / all } else { 0.0 }
        };
        share(predicted) > most || share(&changes) > most
    }
}

/// The strongest line with its two neighbours on each side; `None` where none stands out. Slow drifts (the first few
/// frequencies) are not lines.
fn strongest_line(times: &[f64], white: &[Vector3], least: f64) -> Option<Line> {
    let n = times.len().min(white.len()).min(PERIODOGRAM);
    if n < 64 {
        return None;
    }
    let step = (times[n - 1] - times[0]) / (n - 1) as f64;
    let power = spectrum(&white[..n]);
    let total: f64 = power.iter().sum();
    let (peak, _) = power
        .iter()
        .enumerate()
        .skip(4)
        .max_by(|a, b| a.1.total_cmp(b.1))?;
    let bins = peak.saturating_sub(2)..(peak + 3).min(power.len());
    let share = power[bins.clone()].iter().sum::<f64>() / total;
    (share > least).then(|| Line {
        frequency_hz: peak as f64 / (n as f64 * step),
        share,
        bins,
    })
}

/// Power at each multiple of the lowest frequency, of all axes together.
fn spectrum(series: &[Vector3]) -> Vec<f64> {
    let n = series.len();
    let mut power = vec![0.0; n / 2];
    for axis in 0..3 {
        let mean = series.iter().map(|w| w[axis]).sum::<f64>() / n as f64;
        for (k, p) in power.iter_mut().enumerate() {
            let turn = std::f64::consts::TAU * k as f64 / n as f64;
            let (sin, cos) = turn.sin_cos();
            // One rotating phasor instead of n sines.
            let (mut re, mut im, mut c, mut s) = (0.0, 0.0, 1.0, 0.0);
            for w in series {
                re += (w[axis] - mean) * c;
                im -= (w[axis] - mean) * s;
                (c, s) = (c * cos - s * sin, s * cos + c * sin);
            }
            *p += re * re + im * im;
        }
    }
    power
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
        let line = strongest_line(&times, &sine, 0.25).unwrap();
        assert!((line.frequency_hz - 0.4).abs() < 0.01 && line.share > 0.9);
        // A manoeuvre at the line itself, and one elsewhere.
        assert!(line.is_driven(&sine, 0.02));
        let slow: Vec<Vector3> = times
            .iter()
            .map(|t| Vector3::x() * (0.06 * t).sin())
            .collect();
        assert!(!line.is_driven(&slow, 0.02));
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
        assert!(strongest_line(&times, &noise, 0.25).is_none());
    }
}
