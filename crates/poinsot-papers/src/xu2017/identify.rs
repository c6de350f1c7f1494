//! The paper's sequence as an answer to a [`Problem`]: certificate, then the numbers of the paper.
//!
//! The linear method, which uses all segments together, weighted by noise, certifies the numbers (see
//! [`crate::certified`]).

use super::roles::{Roles, joint_name, roles};
use super::sequence::{Found, Searched, Solver, StepReport, sequence};
use super::single_body::Form;
use super::{Kind, ORDER, Order, Variant};
use crate::certified::{certificate, put};
use crate::method::Named;
use crate::numbers::printed;
use crate::study::statistics::largest;
use poinsot_dynamics::Kinematics;
use poinsot_files::Faults;
use poinsot_identify::{Effect, Estimate, MethodReport, Problem, Remark, ReportedNumber};
use poinsot_model::{Nuisance, SensorKind};
use poinsot_spatial::{MASS_PROPERTY_NAMES, MASS_PROPERTY_UNITS};

/// Identifies the bodies of a robot by the paper's sequence, with the solver of the variant.
///
/// # Errors
/// The method cannot be applied. Undetermined numbers are part of the answer, not an error.
///
/// ```
#[doc = include_str!("../../doc/record.txt")]
/// use poinsot_papers::xu2017::{Kind, Order, Solver, Variant, identify};
///
/// // The first record of the paper: the locked robot under thrust.
/// let input = record("xu2017", "xu2017/model.toml", "xu2017/C1/telemetry.parquet")?;
/// let variant = Variant { solver: Kind::Linear, order: Order::Outward };
/// let estimate = identify(&problem(&input), variant, &Solver::default())?;
/// assert_eq!(estimate.method, "xu2017");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn identify(problem: &Problem, variant: Variant, solver: &Solver) -> Result<Estimate, Faults> {
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

/// Result of one step, with the method's names.
fn numbers(step: &StepReport) -> Vec<ReportedNumber> {
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

/// Lever arms below this fraction of the radius of gyration are zero.
const NO_LEVER: f64 = 1.0e-6;

/// First notes of the report.
fn notes(variant: Variant, found: &Found, estimate: &Estimate) -> String {
    let order = match variant.order {
        Order::Outward => "joints 1..n, base side searched",
        Order::Inward => "joints n..1, tip side searched",
    };
    let solver = match variant.solver {
        Kind::Linear => "linear solution",
        Kind::Swarm => "particle swarm",
    };
    let form = match found.form {
        Some(Form::Acceleration) => " (35) from measured accelerations.",
        Some(Form::Momentum) => " (35) integrated over time: no accelerations needed.",
        None => "",
    };
    format!(
        "Xu, Hu, Zhang and Liang 2017, {} ({order}).{form} The method claims every number of every body; the data determine {} of {} combinations, and only those are given. Sigma is that of the linear method on all segments (maximum likelihood where thrust shows attitude alone), widened by the difference.",
        solver, estimate.identifiability.rank, estimate.identifiability.parameters,
    )
}

fn warnings(problem: &Problem, roles: &Roles, found: &Found, share: f64) -> Vec<String> {
    let single = found.steps.iter().find(|s| s.part == Searched::Single);
    let mut list = Vec::new();
    list.extend(single.iter().flat_map(|step| thrust(problem, roles, step)));
    list.extend(standing(problem, roles));
    list.extend(declared(problem, found));
    for step in &found.steps {
        list.extend(search(step, share));
        if step.found.mass <= 0.0 {
            list.push(format!(
                "{}: the step gives a mass of {:.3} kg: noise or a wrong model dominates it",
                step.name, step.found.mass
            ));
        }
    }
    list
}

/// Thrusters that never fire, thrust without torque, torque without force.
fn thrust(problem: &Problem, roles: &Roles, step: &StepReport) -> Vec<String> {
    let thrusters = &problem.model.thrusters;
    let mut list = Vec::new();
    let segments = || roles.single.iter().map(|&k| &problem.segments[k]);
    let firings = || segments().flat_map(|s| &s.firings);
    let never = |t: &usize| firings().all(|f| f.thruster != *t || f.force == 0.0);
    let idle = (0..thrusters.len()).filter(never);
    let idle: Vec<&str> = idle.map(|t| thrusters[t].name.as_str()).collect();
    if !idle.is_empty() {
        list.push(format!(
            "{} never fires while the joints are locked: what only {} thrust would show is undetermined",
            idle.join(", "),
            if idle.len() == 1 { "its" } else { "their" }
        ));
    }
    let kinematics = Kinematics::at(problem.tree, &roles.normal);
    let lever = largest(firings().map(|f| {
        let thruster = &thrusters[f.thruster];
        let R = &kinematics.R[thruster.body];
        let arm = kinematics.p[thruster.body] + R * thruster.p_BoT_B - step.found.p_BoBcm_B;
        arm.cross(&(R * thruster.direction_B)).norm()
    }));
    let noise = problem.noise.gyro.trace().sqrt();
    let turns = segments().any(|s| {
        let rates = &s.samples.w_NB_B;
        let first = rates.first().copied().unwrap_or_default();
        rates.iter().any(|w| (w - first).norm() > 10.0 * noise)
    });
    if lever <= NO_LEVER * step.found.radius_of_gyration() || !turns {
        list.push(format!(
            "the thrust makes no torque about the mass centre (largest lever {lever:.1e} m), so the inertia tensor does not enter (30) and is undetermined; fire thrusters beside the mass centre"
        ));
    }
    list
}

/// Declared unknowns that the paper assumes exact.
fn declared(problem: &Problem, found: &Found) -> Vec<String> {
    let model = problem.model;
    let mut gyros = model.sensors_of(SensorKind::Gyro);
    let scaled = model.thrusters.iter().any(|t| t.scale != Nuisance::Known);
    let words = [
        (
            gyros.any(|s| s.bias != Nuisance::Known),
            "the gyro's bias is declared unknown: xu2017 takes it as zero; --method auto estimates it",
        ),
        (
            scaled && found.form.is_some(),
            "thruster scales are declared unknown: xu2017 takes the thrust as exact; --method auto estimates them",
        ),
        (
            model.bodies.iter().any(|b| b.prior.is_some()),
            "the declared priors are not used by xu2017",
        ),
    ];
    let holding = words.into_iter().filter(|(holds, _)| *holds);
    holding.map(|(_, words)| words.to_owned()).collect()
}

/// Joints that never move although both sides have unknown bodies.
fn standing(problem: &Problem, roles: &Roles) -> Vec<String> {
    let unknown = roles.unknown.iter().filter(|u| **u).count();
    if unknown < 2 || roles.moving_segments() == 0 {
        return Vec::new();
    }
    let still = (0..problem.tree.dof()).filter(|&j| roles.of_joint[j].is_empty());
    let words = |j: usize| {
        let joint = &problem.model.joints[problem.tree.coordinates[j]];
        let name = |b: usize| &problem.model.bodies[b].name;
        format!(
            "{} does not move in any segment: {} and {} are one body to these data; drive it in a separate segment",
            joint_name(problem, j),
            name(joint.parent),
            name(joint.child)
        )
    };
    still.map(words).collect()
}

/// A swarm on the bounds of its range, or not converged.
fn search(step: &StepReport, share: f64) -> Option<String> {
    let (flight, range) = step.flight.as_ref()?;
    let place = |&d: &usize| {
        let (name, unit) = (MASS_PROPERTY_NAMES[ORDER[d]], MASS_PROPERTY_UNITS[ORDER[d]]);
        let name = name.replace("com_", "mass centre ").replace('_', " ");
        let (best, low, high) = (flight.best[d], range.low[d], range.high[d]);
        format!("{name} = {best:.6} {unit} of [{low:.6}, {high:.6}]")
    };
    let touched: Vec<String> = flight.on_bound.iter().map(place).collect();
    let touched = touched.join("; ");
    if step.excluded() {
        return Some(format!(
            "{}: the swarm's solution is on the bound of its search range ({}), with a cost of {:.1e} where the linear solution leaves {:.1e}: the range excludes the answer and its numbers are withheld; correct the nominal values, which the range of {:.0} % surrounds, widen it (--set range={}), or use --variant linear",
            step.name,
            touched,
            flight.cost,
            step.cost_linear,
            100.0 * share,
            4.0 * share
        ));
    }
    if !step.arrived() {
        return Some(format!(
            "{}: the swarm stopped at a cost of {:.1e} after {} iterations{}; the linear solution of the same equations leaves {:.1e}: its numbers are withheld; use --variant linear",
            step.name,
            flight.cost,
            flight.history.len() - 1,
            match touched.is_empty() {
                true => "",
                false => ", caught on a bound of its range",
            },
            step.cost_linear
        ));
    }
    (!touched.is_empty()).then(|| {
        format!(
            "{}: the swarm's solution lies on the bound of its search range ({}) and fits as well as the linear one: the data do not determine these numbers",
            step.name,
            touched
        )
    })
}
