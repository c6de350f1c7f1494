//! Time shift between attitude and gyro.

use super::{Check, Finding};
use crate::conventions::pairs::Pairs;
use crate::{Axes, Change, Channel, Repair, Table, full_name, median_step};
use poinsot_files::rounded;
use std::sync::Arc;

/// Longest lag tested, s, and in steps of the slower sensor.
const LONGEST_S: f64 = 1.0;
const LONGEST_STEPS: f64 = 4.0;
/// Trials on each side of zero.
const TRIALS: i32 = 20;
/// Samples of each channel that are used.
const MOST: usize = 20_000;
/// The residual at the lag must be below this fraction of the residual without lag.
const DECISIVE: f64 = 0.7;

/// The shift of the gyro's times that fits its integral best to the attitude.
pub(super) fn find(table: &Table) -> Option<Finding> {
    let short = |prefix| -> Option<Vec<Channel>> {
        let own = table.vector(None, prefix)?.into_iter();
        Some(own.map(short).collect())
    };
    let (q, w) = (short("q")?, short("omega")?);
    let (x, of) = (w.first()?, q.iter().collect::<Vec<_>>());
    let (slow, fast) = (median_step(&q.first()?.time_s)?, median_step(&x.time_s)?);
    let unit = LONGEST_S.max(LONGEST_STEPS * slow.max(fast)) / f64::from(TRIALS);
    let residual = |lag: f64| {
        let shifted = w.iter().map(|c| Channel {
            time_s: c.time_s.iter().map(|t| t - lag).collect(),
            ..c.clone()
        });
        let shifted: Vec<Channel> = shifted.collect();
        let sums = Pairs::collect(&of, &shifted.iter().collect::<Vec<_>>())?.as_declared();
        Some((sums.residual(1.0, Axes::IDENTITY), sums.rate()))
    };
    let (without, rate) = residual(0.0)?;
    let lags = (-TRIALS..=TRIALS).map(|k| f64::from(k) * unit);
    let trials = lags.map(|lag| Some((lag, residual(lag)?.0)));
    let trials: Vec<(f64, f64)> = trials.collect::<Option<_>>()?;
    let best = trials.into_iter().min_by(|a, b| a.1.total_cmp(&b.1));
    let (mut lag, mut least) = best?;
    // Near its minimum the squared residual is a parabola.
    if let (Some((a, _)), Some((c, _))) = (residual(lag - unit), residual(lag + unit)) {
        let bend = a * a - 2.0 * least * least + c * c;
        let refined = lag + 0.5 * unit * (a * a - c * c) / bend;
        if let Some((r, _)) = residual(refined).filter(|_| bend > 0.0) {
            (lag, least) = (refined, r);
        }
    }
    if lag.abs() <= 0.5 * fast || least >= DECISIVE * without || without < 1e-3 * rate {
        return None;
    }
    let (gyro, attitude) = (full_name(&x.sensor, "gyro"), "attitude".to_owned());
    // No sensor reads the future: the later one is late.
    let (late, early, own) = match lag > 0.0 {
        true => (gyro, attitude, w.as_slice()),
        false => (attitude, gyro, q.as_slice()),
    };
    let text = format!(
        "the {late} is {:.4} s later than the {early} ({:.1} samples); that shift reduces their difference from {} to {} rad/s; write late_s in its columns, or lag = \"estimate\" for the sensor",
        lag.abs(),
        lag.abs() / fast,
        rounded(without, 4),
        rounded(least, 4)
    );
    let name = format!("{}..z", x.full());
    let all = x.values.len();
    let channels = own.iter().map(|c| c.full()).collect();
    let change = Change::Late(lag.abs());
    Some(Finding {
        count: all,
        repair: Some(Repair { channels, change }),
        ..Finding::new(Check::Lag, name, all, Vec::new(), text)
    })
}

fn short(channel: &Channel) -> Channel {
    let n = channel.values.len().min(MOST);
    Channel {
        time_s: Arc::from(channel.time_s.get(..n).unwrap_or_default()),
        values: channel.values.get(..n).unwrap_or_default().to_vec(),
        ..channel.clone()
    }
}
