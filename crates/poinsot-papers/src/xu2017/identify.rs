//! The paper's sequence as an answer to a [`Problem`]: certificate, then the numbers of the paper.
//!
//! The linear method, which uses all segments together, weighted by noise, certifies the numbers (see
//! [`crate::certified`]).

use super::sequence::{Searched, Solver, StepReport, sequence};
use super::words::{notes, warnings};
use super::{Variant, roles::roles};
use crate::certified::put;
use crate::method::Named;
use crate::numbers::printed;
use poinsot_files::Faults;
use poinsot_identify::refusal::NO_VELOCITY;
use poinsot_identify::{
    Effect, Estimate, MethodReport, NamedNumber, Problem, Remark, Settings, linear,
    maximum_likelihood_with,
};

/// Identifies the bodies of a robot by the paper's sequence.
///
/// # Errors
/// The method cannot be applied. Undetermined numbers are part of the answer, not an error.
///
/// ```
#[doc = include_str!("../../doc/record.txt")]
/// use poinsot_papers::xu2017::{Kind, Order, Variant, identify};
///
/// // The first record of the paper: the locked robot under thrust.
/// let input = record("xu2017", "xu2017/model.toml", "xu2017/C1/telemetry.parquet")?;
/// let variant = Variant { solver: Kind::Linear, order: Order::Outward };
/// let estimate = identify(&problem(&input), variant)?;
/// assert_eq!(estimate.method, "xu2017");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn identify(problem: &Problem, variant: Variant) -> Result<Estimate, Faults> {
    let solver = Solver {
        kind: variant.solver,
        ..Solver::default()
    };
    identify_with(problem, variant, &solver)
}

/// Identifies with a given swarm.
///
/// # Errors
/// As [`identify`].
///
/// ```
#[doc = include_str!("../../doc/record.txt")]
/// use poinsot_papers::xu2017::{Kind, Order, Solver, Variant, identify_with};
///
/// let input = record("xu2017", "xu2017/model.toml", "xu2017/C1/telemetry.parquet")?;
/// let variant = Variant { solver: Kind::Linear, order: Order::Outward };
/// let estimate = identify_with(&problem(&input), variant, &Solver::default())?;
/// assert_eq!(estimate.variant.as_deref(), Some("linear"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn identify_with(
    problem: &Problem,
    variant: Variant,
    solver: &Solver,
) -> Result<Estimate, Faults> {
    // The paper's checks come first, because their messages name its requirements.
    let found = sequence(problem, variant.order, solver)?;
    let mut estimate = certificate(problem)?;
    estimate.method = "xu2017".to_owned();
    estimate.variant = Some(variant.name().to_owned());
    estimate.add_all(found.notes.iter().cloned().map(Remark::assumption));
    let withheld = !found.steps.iter().all(StepReport::arrived);
    put(problem, &mut estimate, &found.bodies, withheld);
    let warnings = warnings(problem, &roles(problem)?, &found, solver.share);
    estimate.add_all(warnings.into_iter().map(Remark::warning));
    let flights = found.steps.iter().filter_map(|s| s.flight.as_ref());
    let flown: usize = flights.map(|f| f.0.history.len() - 1).sum();
    estimate.iterations = flown.max(1);
    estimate.method_report = Some(MethodReport {
        note: notes(variant, &found, &estimate),
        numbers: found.steps.iter().flat_map(numbers).collect(),
    });
    if withheld {
        let words = "a step of the method did not converge";
        estimate.add(Remark::test("convergence", Effect::WithholdsNumbers, words));
    }
    Ok(estimate)
}

/// The certificate: the linear method, or maximum likelihood if thrust segments have attitude only, for which the
/// linear method has no equations.
fn certificate(problem: &Problem) -> Result<Estimate, Faults> {
    match linear(problem) {
        Err(faults) if faults.code() == NO_VELOCITY => {
            let options = Settings {
                undiagnosed: true,
                ..Settings::default()
            };
            maximum_likelihood_with(problem, options)
        }
        other => other,
    }
}

/// Result of one step, with the method's names.
fn numbers(step: &StepReport) -> Vec<NamedNumber> {
    let plain =
        |name: &str, unit, value| printed(format!("{}: {name}", step.name), unit, value, 0.0);
    let cost = match step.part {
        Searched::Single => "cost (37)",
        _ => "cost (52)",
    };
    let linear = format!("{cost} of the linear solution");
    let directions = "directions of ten that this step determines";
    let mut list = vec![
        plain(&linear, "mixed", step.cost_linear),
        plain(directions, "1", step.rank as f64),
        plain("condition of these", "1", step.condition),
    ];
    if let Some((flight, _)) = &step.flight {
        let iterations = (flight.history.len() - 1) as f64;
        list.push(plain(&format!("{cost} of the swarm"), "mixed", flight.cost));
        list.push(plain("iterations of the swarm", "1", iterations));
    }
    list
}
