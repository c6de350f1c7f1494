//! Further tests of the residuals, which have no effect on the answer by themselves: the size of each residual over every time
//! scale has, and so have the suspects of the diagnosis, which explain drift, lags and held-out samples.

use crate::diagnosis::{COLOURED, Diagnostics};
use crate::solution::evidence::{Effect, Remark};

/// One row per test of the diagnosis: whiteness, held-out samples, drift and lags.
pub(super) fn residual_tests(found: &Diagnostics) -> Vec<Remark> {
    let mut rows = whiteness(found);
    rows.extend(found.held_out.iter().map(|held| {
        let words = match held.p < COLOURED {
            true => "the end of each record differs from its prediction, relative to the other residuals",
            false => "the end of each record agrees with its prediction, relative to the other residuals",
        };
        Remark {
            degrees_of_freedom: Some(held.numbers),
            ..of("held-out samples", held.p, words).statistic("chi-square", held.chi2)
        }
    }));
    let drifts = found.drift.iter().filter(|d| d.segment.is_none());
    rows.extend(drifts.filter_map(|drift| {
        let words = match drift.p? < COLOURED {
            true => "the total momentum drifts",
            false => "the total momentum does not drift",
        };
        Some(of("momentum drift", drift.p?, words))
    }));
    rows.extend(found.lags.iter().filter_map(|lag| {
        let [late, other] = &lag.between;
        let words = match lag.p? < COLOURED {
            true => format!("{late} lags behind {other} by {:.2e} s", lag.lag_s),
            false => format!("{late} does not lag behind {other}"),
        };
        let row = of(format!("lag of {late} behind {other}"), lag.p?, words);
        Some(row.statistic("lag, sigma", lag.lag_s / lag.sigma_s))
    }));
    rows
}

fn whiteness(found: &Diagnostics) -> Vec<Remark> {
    let tested = found.channels.iter();
    tested
        .filter_map(|c| {
            let words = match c.is_white() {
                true => format!("the residual of the {} is white", c.name),
                false => format!(
                    "the residual of the {} is correlated in time; the tests of its mean over several samples decide whether that matters",
                    c.name
                ),
            };
            Some(of(
                format!("whiteness of the {}", c.name),
                c.whiteness_p?,
                words,
            ))
        })
        .collect()
}

fn of(test: impl Into<String>, p: f64, words: impl Into<String>) -> Remark {
    Remark {
        p: Some(p),
        ..Remark::test(test, Effect::None, words)
    }
}
