//! Readings far from their neighbours.

use crate::Channel;
use crate::time_base::median;

/// Distance from the median of five, in robust sigmas, from which a reading is an outlier.
const FAR: f64 = 12.0;
/// Share of the channel's own spread below which no difference counts.
const FLOOR: f64 = 0.02;

/// Samples far from the median of the five around them (Hampel's identifier).
pub(super) fn find(channel: &Channel) -> Option<(Vec<usize>, String)> {
    let values = &channel.values;
    if values.len() < 16 {
        return None;
    }
    let residual: Vec<f64> = (0..values.len())
        .map(|k| {
            let from = k.saturating_sub(2).min(values.len() - 5);
            let mut five: Vec<f64> = values.get(from..from + 5).unwrap_or_default().to_vec();
            values.get(k).copied().unwrap_or_default() - median(&mut five).unwrap_or_default()
        })
        .collect();
    let sigma = spread(&residual)?;
    let whole = spread(values)?;
    let limit = (FAR * sigma).max(FLOOR * whole);
    let far: Vec<usize> = (residual.iter().enumerate())
        .filter(|(_, r)| r.abs() > limit && limit > 0.0)
        .map(|(k, _)| k)
        .collect();
    let worst = residual.iter().fold(0.0_f64, |m, r| m.max(r.abs()));
    (!far.is_empty()).then(|| {
        let text = format!(
            "{} readings lie up to {worst:.3e} {} from their neighbours, more than {FAR} robust sigmas ({sigma:.3e}); --variant huber bounds what they do",
            far.len(),
            channel.unit
        );
        (far, text)
    })
}

/// Robust sigma: median of the distances from the median over 0.6745.
fn spread(values: &[f64]) -> Option<f64> {
    let centre = median(&mut values.to_vec())?;
    let mut distances: Vec<f64> = values.iter().map(|x| (x - centre).abs()).collect();
    Some(median(&mut distances)? / 0.6745)
}
