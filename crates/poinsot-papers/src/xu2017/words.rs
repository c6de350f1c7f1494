//! Warnings: uninformative thrust, joints that do not move, ranges that exclude the solution.

use super::roles::{Roles, joint_name};
use super::sequence::{Found, StepReport};
use super::single_body::Form;
use super::{Kind, Order, Searched, Variant};
use crate::study::statistics::largest;
use poinsot_dynamics::Kinematics;
use poinsot_identify::{Estimate, Problem};
use poinsot_model::{Nuisance, SensorKind};

/// Lever arms below this fraction of the radius of gyration are zero.
const NO_LEVER: f64 = 1.0e-6;

/// Names of the ten coordinates of a particle, with units.
const COORDINATES: [(&str, &str); 10] = [
    ("mass", "kg"),
    ("inertia xx", "kg m2"),
    ("inertia yy", "kg m2"),
    ("inertia zz", "kg m2"),
    ("inertia xy", "kg m2"),
    ("inertia xz", "kg m2"),
    ("inertia yz", "kg m2"),
    ("mass centre x", "m"),
    ("mass centre y", "m"),
    ("mass centre z", "m"),
];

/// First notes of the report.
pub(super) fn notes(variant: Variant, found: &Found, estimate: &Estimate) -> String {
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

pub(super) fn warnings(problem: &Problem, roles: &Roles, found: &Found, share: f64) -> Vec<String> {
    let single = found.steps.iter().find(|s| s.part == Searched::Single);
    let mut list = Vec::new();
    list.extend(
        single
            .iter()
            .flat_map(|step| thrust(problem, roles, found, step)),
    );
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
fn thrust(problem: &Problem, roles: &Roles, found: &Found, step: &StepReport) -> Vec<String> {
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
    let mut kinematics = Kinematics::new(problem.tree);
    kinematics.place(problem.tree, &found.normal);
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
        let (name, unit) = COORDINATES[d];
        format!(
            "{name} = {:.6} {unit} of [{:.6}, {:.6}]",
            flight.best[d], range.low[d], range.high[d]
        )
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
