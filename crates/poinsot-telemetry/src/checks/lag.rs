//! Time shift between attitude and gyro.

use super::{Check, Found};
use crate::conventions::pairs::Pairs;
use crate::{Axes, Channel, Table, full_name, median_step};
use poinsot_files::rounded;
use std::sync::Arc;

/// Longest lag tested, s.
const LONGEST_S: f64 = 1.0;
/// Trials on each side of zero.
const TRIALS: i32 = 20;
/// Samples of each channel that are used.
const MOST: usize = 20_000;
/// The residual at the lag must be below this fraction of the residual without lag.
const DECISIVE: f64 = 0.7;

/// The shift of the gyro's times that fits its integral best to the attitude.
pub(super) fn find(table: &Table) -> Option<Found> {
    let of = |name: &str| table.channels.iter().find(|c| c.name == name).map(short);
    let q = [of("q_x")?, of("q_y")?, of("q_z")?, of("q_w")?];
    let w = [of("omega_x")?, of("omega_y")?, of("omega_z")?];
    let step = median_step(&w[0].time_s)?.max(median_step(&q[0].time_s)?);
    let fast = median_step(&w[0].time_s)?;
    let longest = LONGEST_S.max(2.0 * step);
    let residual = |lag: f64| {
        let shifted = w.each_ref().map(|c| Channel {
            time_s: c.time_s.iter().map(|t| t - lag).collect::<Vec<_>>().into(),
            ..c.clone()
        });
        let pairs = Pairs::collect(&q.each_ref(), &shifted.each_ref())?;
        let sums = pairs.as_declared();
        Some((sums.residual(1.0, Axes::IDENTITY), sums.rate()))
    };
    let (without, rate) = residual(0.0)?;
    let unit = longest / f64::from(TRIALS);
    let mut trials: Vec<(f64, f64)> = Vec::new();
    for k in -TRIALS..=TRIALS {
        let lag = f64::from(k) * unit;
        trials.push((lag, residual(lag)?.0));
    }
    let best = (trials.iter().enumerate())
        .min_by(|a, b| a.1.1.total_cmp(&b.1.1))?
        .0;
    let (mut lag, mut least) = *trials.get(best)?;
    // Near its minimum the squared residual is a parabola.
    if let (Some(a), Some(c)) = (
        best.checked_sub(1).and_then(|k| trials.get(k)),
        trials.get(best + 1),
    ) {
        let (ya, yb, yc) = (a.1 * a.1, least * least, c.1 * c.1);
        let bend = ya - 2.0 * yb + yc;
        if bend > 0.0 {
            let refined = lag + 0.5 * unit * (ya - yc) / bend;
            if let Some((r, _)) = residual(refined) {
                (lag, least) = (refined, r);
            }
        }
    }
    if lag.abs() <= 0.5 * fast || least >= DECISIVE * without || without < 1e-3 * rate {
        return None;
    }
    let late = if lag > 0.0 { "later" } else { "earlier" };
    let [x, ..] = &w;
    let text = format!(
        "the gyro is {:.4} s {late} than the attitude ({:.1} samples); that shift reduces their difference from {} to {} rad/s; correct the times, or write lag = \"estimate\" for the sensor",
        lag.abs(),
        lag.abs() / fast,
        rounded(without, 4),
        rounded(least, 4)
    );
    let name = format!("{}..z", full_name(&x.sensor, &x.name));
    let mut found = Found::new(Check::Lag, name, x.values.len(), Vec::new(), text);
    found.finding.count = x.values.len();
    Some(found)
}

fn short(channel: &Channel) -> Channel {
    let n = channel.values.len().min(MOST);
    Channel {
        time_s: Arc::from(channel.time_s.get(..n).unwrap_or_default()),
        values: channel.values.get(..n).unwrap_or_default().to_vec(),
        ..channel.clone()
    }
}
