//! Which candidates explain what is left over, and what their numbers mean.

use super::candidates::Candidate;
use super::projected::Projected;
use super::types::{FaultKind, Suspect};
use crate::fit::{Fitted, fit_from};
use crate::information::{Experiment, Point};
use crate::parameters::UnknownKind;

/// Decrease of chi-square, over its mean per number, from which a candidate is named: one in 10^8 by chance.
const SIGNIFICANT: f64 = 40.0;
/// Candidates that are fitted in earnest before one is named.
const FITTED: usize = 3;
/// Iterations of such a fit.
const ITERATIONS: usize = 12;

/// Significant candidates, the best first. Scores are of first order; where the misfit is large the best few
/// are fitted, because a fault like a wrong sign is far away.
pub(super) fn suspects(
    experiment: &Experiment,
    fitted: &Fitted,
    candidates: &[Candidate],
    projected: &Projected,
    (excess, per_number, misfit): (f64, f64, bool),
) -> Vec<Suspect> {
    let mut from = 0;
    let mut list: Vec<(usize, Suspect)> = Vec::new();
    for (at, candidate) in candidates.iter().enumerate() {
        let group: Vec<usize> = (from..from + candidate.unknowns.len()).collect();
        from += group.len();
        let score = projected.score(&group, None);
        if score.decrease > SIGNIFICANT * per_number {
            let values = candidate.unknowns.iter().zip(&score.values);
            let values: Vec<f64> = values.map(|(u, v)| u.nominal + v).collect();
            list.push((at, suspect(candidate, score.decrease, &values)));
        }
    }
    let falling =
        |a: &(usize, Suspect), b: &(usize, Suspect)| b.1.decrease.total_cmp(&a.1.decrease);
    list.sort_by(falling);
    if misfit {
        for (at, suspect_) in list.iter_mut().take(FITTED) {
            let candidate = &candidates[*at];
            if let Some((decrease, values)) = in_earnest(experiment, fitted, candidate) {
                *suspect_ = suspect(candidate, decrease, &values);
            }
        }
        list = significant(list, SIGNIFICANT * per_number);
        let fitted = FITTED.min(list.len());
        list[..fitted].sort_by(falling);
    }
    late_before_early(&mut list, SIGNIFICANT * per_number);
    list.into_iter()
        .map(|(_, mut s)| {
            s.explains = if misfit {
                (s.decrease / excess).clamp(0.0, 1.0)
            } else {
                0.0
            };
            name(experiment, &mut s);
            s
        })
        .collect()
}

/// Without those that turned out to explain nothing when they were fitted.
fn significant(mut list: Vec<(usize, Suspect)>, least: f64) -> Vec<(usize, Suspect)> {
    list.retain(|(_, s)| s.decrease > least);
    list
}

/// Where one sensor reading early explains no more than another reading late, the late one is named first: nothing
/// reads what has not happened yet.
fn late_before_early(list: &mut [(usize, Suspect)], margin: f64) {
    let lag = |s: &Suspect| match s.fault {
        FaultKind::Lag => s.values.first().map_or(0.0, |v| v.1),
        _ => 0.0,
    };
    let Some((_, first)) = list.first().filter(|(_, s)| lag(s) < 0.0) else {
        return;
    };
    let enough = first.decrease - margin;
    let late = |(_, s): &(usize, Suspect)| lag(s) > 0.0 && s.decrease >= enough;
    if let Some(at) = list.iter().position(late) {
        list[..=at].rotate_right(1);
    }
}

fn suspect(candidate: &Candidate, decrease: f64, values: &[f64]) -> Suspect {
    Suspect {
        name: candidate.name.clone(),
        decrease,
        explains: 0.0,
        values: candidate
            .unknowns
            .iter()
            .zip(values)
            .map(|(u, v)| (u.name.clone(), *v, u.unit))
            .collect(),
        fault: candidate.fault,
    }
}

/// The fit with this candidate unknown: decrease of chi-square, and values.
fn in_earnest(
    experiment: &Experiment,
    fitted: &Fitted,
    candidate: &Candidate,
) -> Option<(f64, Vec<f64>)> {
    let known = |u: &crate::parameters::Unknown| {
        matches!(
            u.kind,
            UnknownKind::InertialTorque(_) | UnknownKind::InertialForce(_)
        )
    };
    // A drift has columns only: its score is exact enough.
    if candidate.unknowns.iter().any(known) {
        return None;
    }
    let mut parameters = experiment.parameters.clone();
    let mut x = fitted.at.x.clone();
    let at = match candidate.unknowns.first()?.kind.is_nuisance() {
        true => parameters.len(),
        false => fitted.shared.mass,
    };
    for (k, unknown) in candidate.unknowns.iter().enumerate() {
        parameters.unknowns.insert(at + k, unknown.clone());
        x.insert(at + k, unknown.nominal);
    }
    let wide = experiment.with_parameters(&parameters);
    let start = Point {
        x,
        heads: fitted.at.heads.clone(),
    };
    let before = experiment.chi2(&fitted.at, &fitted.evaluated)?;
    let found = fit_from(&wide, start, ITERATIONS)?;
    let after = wide.chi2(&found.at, &found.evaluated)?;
    let values = found.at.x.get(at..at + candidate.unknowns.len())?.to_vec();
    Some((before - after, values))
}

/// Factors by which a unit is mistaken, and the mistake.
const MISTAKEN: [(f64, &str); 4] = [
    (57.295_779_5, "radians read as degrees"),
    (0.017_453_293, "degrees read as radians"),
    (0.104_719_755, "revolutions a minute read as rad/s"),
    (std::f64::consts::TAU, "revolutions read as radians"),
];

/// Says what values mean where they speak for themselves: a wrong sign, a wrong unit.
fn name(experiment: &Experiment, suspect: &mut Suspect) {
    let model = experiment.problem.model;
    let near = |value: f64, wanted: f64| (value / wanted - 1.0).abs() < 0.2;
    match suspect.fault {
        FaultKind::WheelScale => {
            let Some((owner, value, _)) = suspect.values.first() else {
                return;
            };
            let wheel = model
                .wheels
                .iter()
                .find(|w| *owner == format!("{}.spin_inertia", w.name));
            let Some(wheel) = wheel else { return };
            let ratio = value / wheel.spin_inertia;
            if near(ratio, -1.0) {
                suspect.fault = FaultKind::WheelSign;
                suspect.name = format!("a wrong sign of {}", wheel.name);
            } else if let Some((_, what)) = MISTAKEN.iter().find(|(f, _)| near(ratio, *f)) {
                suspect.fault = FaultKind::Units;
                suspect.name = format!("a wrong unit of {} ({what})", wheel.name);
            }
        }
        FaultKind::GyroScale => {
            for (factor, what) in MISTAKEN {
                // The gyro reads (1 + scale) w: the reading is 1/factor of what it should be.
                if suspect
                    .values
                    .iter()
                    .all(|(_, s, _)| near(1.0 + s, 1.0 / factor))
                {
                    suspect.fault = FaultKind::Units;
                    suspect.name = format!("a wrong unit of the gyro ({what})");
                }
            }
        }
        _ => {}
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn regress_a_suspect_whose_fit_lowers_nothing_is_none() {
        let with = |decrease: f64| {
            let suspect = Suspect {
                name: "drag".to_owned(),
                decrease,
                explains: 0.0,
                values: Vec::new(),
                fault: FaultKind::Drag,
            };
            (0, suspect)
        };
        let left = significant(vec![with(-0.3), with(500.0), with(f64::NAN)], 40.0);
        assert_eq!(left.len(), 1);
        assert_eq!(left[0].1.decrease, 500.0);
    }
}
