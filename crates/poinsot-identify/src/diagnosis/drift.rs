//! Tests of a drift of the total momentum and of lags between sensors.

use super::candidates::{Candidate, sensors_read};
use super::projected::{Projected, Score};
use super::table::Table;
use super::types::{MomentumDrift, SensorLag};
use crate::problem::parameters::UnknownKind;
use poinsot_dynamics::SensorError;
use poinsot_formats::finite;
use poinsot_model::SensorKind;
use statrs::distribution::{ChiSquared, ContinuousCDF, Normal};

/// Prior sigma of a lag, s: it fixes unobservable lags, such as one common to all sensors.
const ANY_LAG: f64 = 1.0;

/// The best-fitting additional constant torque and force in N.
pub(super) fn drift(
    segment: Option<String>,
    candidates: &[Candidate],
    projected: &Projected,
    mean_square: f64,
) -> Option<MomentumDrift> {
    let torque = indices(candidates, |k| matches!(k, UnknownKind::InertialTorque(_)));
    let force = indices(candidates, |k| matches!(k, UnknownKind::InertialForce(_)));
    if torque.len() != 3 {
        return None;
    }
    let both: Vec<usize> = torque.iter().chain(&force).copied().collect();
    let score = projected.score(&both, None);
    let chance = ChiSquared::new(both.len() as f64).ok()?;
    let (torque_N_m, torque_sigma_N_m) = part(&score, 0);
    let moved = (force.len() == 3).then(|| part(&score, 3));
    Some(MomentumDrift {
        segment,
        torque_N_m,
        torque_sigma_N_m,
        force_N: moved.map(|m| m.0),
        force_sigma_N: moved.map(|m| m.1),
        p: finite(chance.sf(score.decrease / mean_square)),
    })
}

/// Three values and their sigmas; `None` of one that is not observable.
fn part(score: &Score, from: usize) -> ([Option<f64>; 3], [Option<f64>; 3]) {
    let sigma = |k: usize| finite(score.covariance[(from + k, from + k)].sqrt());
    let sigmas: [Option<f64>; 3] = std::array::from_fn(sigma);
    let value = |k: usize| sigmas[k].and_then(|_| finite(score.values[from + k]));
    (std::array::from_fn(value), sigmas)
}

/// Places of the unknowns of some kind among all candidates.
fn indices(candidates: &[Candidate], wanted: impl Fn(&UnknownKind) -> bool) -> Vec<usize> {
    let all = candidates.iter().flat_map(|c| &c.unknowns).enumerate();
    all.filter(|(_, u)| wanted(&u.kind))
        .map(|(k, _)| k)
        .collect()
}

/// Lags between every two sensors whose lags were not fitted, and between each and what drives the vehicle.
pub(super) fn lags(table: &Table, projected: &Projected, mean_square: f64) -> Vec<SensorLag> {
    let experiment = table.experiment;
    let model = experiment.problem.model;
    let mut names: Vec<String> = Vec::new();
    let mut group = Vec::new();
    for (sensor, name) in sensors_read(experiment.problem) {
        if ![SensorKind::Gyro, SensorKind::Attitude].contains(&model.sensors[sensor].kind) {
            continue;
        }
        let lag = table.place(sensor, SensorError::Lag);
        if let Some(at) = lag.and_then(|k| k.checked_sub(table.base)) {
            names.push(name);
            group.push(at);
        }
    }
    let score = projected.score(&group, Some(ANY_LAG));
    let driven = [
        (!model.wheels.is_empty(), "wheels"),
        (experiment.problem.tree.dof() > 0, "joints"),
        (experiment.problem.fires(), "thrust"),
    ];
    let driven: Vec<&str> = driven.iter().filter(|d| d.0).map(|d| d.1).collect();
    let mut list = Vec::new();
    for i in 0..group.len() {
        let c = &score.covariance;
        if !driven.is_empty() {
            let between = [names[i].clone(), driven.join(" and ")];
            list.extend(lag(between, score.values[i], c[(i, i)], mean_square));
        }
        for j in i + 1..group.len() {
            let between = [names[i].clone(), names[j].clone()];
            let variance = c[(i, i)] + c[(j, j)] - 2.0 * c[(i, j)];
            list.extend(lag(
                between,
                score.values[i] - score.values[j],
                variance,
                mean_square,
            ));
        }
    }
    list
}

fn lag(between: [String; 2], lag_s: f64, variance: f64, mean_square: f64) -> Option<SensorLag> {
    let sigma_s = variance.sqrt();
    if !(lag_s.is_finite() && sigma_s.is_finite() && sigma_s > 0.0 && sigma_s < 0.5 * ANY_LAG) {
        return None;
    }
    let normal = Normal::standard();
    let z = lag_s.abs() / (sigma_s * mean_square.sqrt());
    Some(SensorLag {
        between,
        lag_s,
        sigma_s,
        p: finite(2.0 * normal.sf(z)),
    })
}
