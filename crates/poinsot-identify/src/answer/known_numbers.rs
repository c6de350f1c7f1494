//! Sensitivity of the answer to the known numbers.

use crate::answer::covariance::Row;
use crate::diagnosis::{Assumed, Deflection};
use crate::problem::parameters::Equations;
use crate::solution::estimate::{KnownEffect, KnownNumbers};
use crate::solution::evidence::Remark;
use crate::solution::solved::Solution;
use nalgebra::DVector;
use poinsot_model::{FlexibleMode, KnownNumber, Model, Sensor, SensorKind};
use std::collections::HashSet;

/// Sigmas without the known numbers, and the effect of each; `rows` are those of the covariance.
pub(crate) fn known_numbers(model: &Model, solution: &Solution, rows: &[Row]) -> KnownNumbers {
    let uncertain = model.uncertain().next().is_some();
    let mut out = KnownNumbers {
        exact: !uncertain,
        assumed: model.knowledge.assumed,
        ..KnownNumbers::default()
    };
    let own = solution.likelihood.as_ref();
    let Some(known) = own.and_then(|own| own.known.as_ref()) else {
        return out;
    };
    let asked = |row: &Row| row.nuisance.is_none();
    let sigma = |row: &Row| known.exact.sigma(&row.gradient).filter(|_| asked(row));
    out.sigma_data = rows.iter().map(sigma).collect();
    let totals: Vec<f64> = rows.iter().map(|row| sigma_of_row(solution, row)).collect();
    let mut effects: Vec<(usize, KnownEffect)> = Vec::new();
    for (k, place) in known.places.iter().enumerate() {
        let unknown = &solution.parameters.unknowns[*place];
        let Some(number) = unknown.kind.known() else {
            continue;
        };
        let step = number.number.round_step(model, number.component);
        let slope = |of: usize, row: &Row| along(row, &known.shift[of]);
        let change = |row: &Row| asked(row).then(|| step.size * slope(k, row));
        // The square of the correlation: what the variance would lose if this number were known exactly. Numbers that the data
        // tie together, as spin inertias of wheels are, have it in common.
        let share = |(row, total): (&Row, &f64)| {
            let together: f64 = (0..known.places.len())
                .map(|j| known.covariance[(k, j)] * slope(j, row))
                .sum();
            let whole = total * total * known.covariance[(k, k)];
            (asked(row) && whole > 0.0).then(|| together * together / whole)
        };
        let effect = KnownEffect {
            name: unknown.name.clone(),
            unit: unknown.unit,
            value: unknown.nominal,
            sigma: number.sigma,
            estimated: known
                .shrunk(*place)
                .then(|| (solution.x[*place], known.sigma(k))),
            step: step.size,
            step_words: step.words,
            changes: rows.iter().map(change).collect(),
            shares: rows.iter().zip(&totals).map(share).collect(),
        };
        effects.push((k, effect));
    }
    let size = |e: &(usize, KnownEffect)| e.1.largest().map_or(0.0, |l| l.1);
    effects.sort_by(|a, b| size(b).total_cmp(&size(a)));
    let row = |i: usize| effects.iter().map(|e| known.covariance[(i, e.0)]).collect();
    out.covariance = effects.iter().map(|e| row(e.0)).collect();
    out.effects = effects.into_iter().map(|(_, effect)| effect).collect();
    out
}

/// Sigma of a row with what the choice of the wheel motion adds.
fn sigma_of_row(solution: &Solution, row: &Row) -> f64 {
    let sigma = solution.spectrum.sigma(&row.gradient).unwrap_or(0.0);
    let other = solution.other_wheel_motion();
    let chosen = other.map_or(0.0, |o| o.variance(&row.gradient));
    (sigma * sigma + chosen).sqrt()
}

/// The row that changes most in its sigmas.
fn largest<'a>(
    solution: &Solution,
    rows: impl Iterator<Item = &'a Row>,
    change: impl Fn(&Row) -> f64,
) -> Option<(f64, &'a String)> {
    let sizes = rows.filter_map(|row| {
        let sigma = sigma_of_row(solution, row);
        (sigma > 0.0).then(|| (change(row) / sigma, &row.name))
    });
    sizes.max_by(|a, b| a.0.total_cmp(&b.0))
}

/// Change of a row with a move of the mass properties.
fn along(row: &Row, shift: &[f64]) -> f64 {
    row.gradient.iter().zip(shift).map(|(g, s)| g * s).sum()
}

/// The assumption that the errors of the thrusters' forces are as correlated as the model says: what all of them at once would
/// change.
fn common_thrust(model: &Model, solution: &Solution) -> Option<Assumed> {
    let known = solution.likelihood.as_ref()?.known.as_ref()?;
    let sigma = |place: &usize| match solution.parameters.unknowns[*place].kind.known() {
        Some(known) if matches!(known.number, KnownNumber::Force(_)) => known.sigma,
        _ => 0.0,
    };
    let errors = DVector::from_iterator(known.places.len(), known.places.iter().map(sigma));
    if errors.iter().filter(|sigma| **sigma > 0.0).count() < 2 {
        return None;
    }
    // What is left of these errors after the data, which may tell of them.
    let weights = solution.parameters.known_covariance().cholesky()?;
    let left = &known.covariance * weights.solve(&errors);
    let width = known.shift.first()?.len();
    let sum = |k: usize| {
        left.iter()
            .zip(&known.shift)
            .map(|(e, shift)| e * shift[k])
            .sum()
    };
    let correlation = model.knowledge.thrust_correlation;
    Some(Assumed {
        what: format!(
            "a correlation of {correlation} between the errors of the thrusters' forces (thrust_correlation)"
        ),
        change: "one sigma of all forces at once".to_owned(),
        shift: (0..width).map(sum).collect(),
    })
}

/// What is tried of the point whose velocity and position are read, m.
const POINT_OFF_M: f64 = 0.01;

/// The mass centre that moves most, in its sigmas, where velocity and position are of another point of the base by so much.
fn reference_point<'a>(
    model: &Model,
    solution: &Solution,
    rows: &'a [Row],
) -> Option<(f64, &'a String)> {
    let base = model.bodies.first().filter(|base| base.estimate.com)?;
    let is_read =
        |s: &Sensor| s.body == 0 && matches!(s.kind, SensorKind::Velocity | SensorKind::Position);
    let moves = solution.parameters.equations != Equations::Rotation;
    model.sensors.iter().find(|s| moves && is_read(s))?;
    let com = |row: &&Row| {
        let own = row.name.strip_prefix(&base.name).unwrap_or(&row.name);
        own.trim_start_matches('.').starts_with("com_")
    };
    largest(solution, rows.iter().filter(com), |_| POINT_OFF_M)
}

/// Each mode to first order, with the moment of inertia of its body that what is left out changes most.
fn first_order<'a>(
    model: &Model,
    solution: &Solution,
    rows: &'a [Row],
) -> Vec<(Assumed, Option<(f64, &'a String)>)> {
    let own = solution.likelihood.as_ref();
    let deflections = own.map_or(&[][..], |own| &own.diagnostics.deflections);
    let of = |(mode, moves): (&FlexibleMode, &Deflection)| {
        let body = &model.bodies[mode.mode.body].name;
        let is_moment = |row: &&Row| {
            let own = row.name.strip_prefix(body.as_str());
            own.is_some_and(|own| ["_xx", "_yy", "_zz"].iter().any(|end| own.ends_with(end)))
        };
        let moments = rows.iter().filter(is_moment);
        let assumed = Assumed {
            what: format!(
                "{} to first order in its amplitude, at most {:.2e} kg05 m",
                mode.name, moves.largest
            ),
            change: format!(
                "the inertia of second order, {:.1e} kg m2 at most,",
                moves.mean_square
            ),
            shift: Vec::new(),
        };
        (assumed, largest(solution, moments, |_| moves.mean_square))
    };
    model.modes.iter().zip(deflections).map(of).collect()
}

/// One remark for each assumption that no sample tells of: what the answer owes to it. Of those of one kind the largest is told.
pub(crate) fn assumptions(model: &Model, solution: &Solution, rows: &[Row]) -> Vec<Remark> {
    let own = solution.likelihood.as_ref();
    let all = own.map_or(&[][..], |own| &own.diagnostics.assumed);
    let common = common_thrust(model, solution);
    let asked = rows.iter().filter(|row| row.nuisance.is_none());
    let mut effects: Vec<(&Assumed, Option<(f64, &String)>)> = Vec::new();
    for of in all.iter().chain(&common) {
        let change = |row: &Row| along(row, &of.shift).abs();
        effects.push((of, largest(solution, asked.clone(), change)));
    }
    let point = Assumed {
        what: "velocity and position refer to the position of their sensor, not to the mass centre"
            .to_owned(),
        change: format!("{POINT_OFF_M} m off"),
        shift: Vec::new(),
    };
    effects.extend(reference_point(model, solution, rows).map(|largest| (&point, Some(largest))));
    let modes = first_order(model, solution, rows);
    effects.extend(modes.iter().map(|(of, largest)| (of, *largest)));
    let size = |effect: &Option<(f64, &String)>| effect.as_ref().map_or(0.0, |e| e.0);
    effects.sort_by(|a, b| size(&b.1).total_cmp(&size(&a.1)));
    let mut told: HashSet<&str> = HashSet::new();
    effects.retain(|(of, _)| told.insert(&of.what));
    let words = |(of, largest): (&Assumed, Option<(f64, &String)>)| match largest {
        Some((size, name)) => format!(
            "assumed: {}; {} would change {name} by {size:.1} sigma",
            of.what, of.change
        ),
        None => format!("assumed: {}", of.what),
    };
    let effects = effects.into_iter();
    effects.map(|e| Remark::assumption(words(e))).collect()
}
