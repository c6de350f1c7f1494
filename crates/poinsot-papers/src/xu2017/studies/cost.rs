//! Fig. 9 and 10: best cost against iterations, with the accuracy and the linear solution.

use super::robot::{Data, Robot, SEEDS};
use crate::study::statistics::{largest, quantile};
use crate::study::{Context, Findings, StudyError, Table, curves};
use crate::xu2017::swarm::Swarm;
use crate::xu2017::{Found, Order, Searched, StepReport, particle};
use poinsot_figures::{Mark, Plot, Series};

/// Iterations of the figures; no run stops earlier.
const ITERATIONS: usize = 2500;
/// Points of a curve: every tenth iteration.
const STEP: usize = 10;
/// Half-width of the range relative to the nominal values.
const RANGE: f64 = 0.5;

/// The study.
pub fn run(context: &Context) -> Result<Findings, StudyError> {
    let robot = Robot::new(context)?;
    let model = robot.centred();
    let single = Data::new(context, model.clone(), &robot.runs(&model, &["C1"])?)?;
    let tip = robot.centred_data(&["C1", "C7"])?;
    let swarm = Swarm {
        iterations: ITERATIONS,
        patience: ITERATIONS,
        ..Swarm::default()
    };
    let mut findings = Findings::of([accuracy(&robot, &single)?]);
    let mut arrived = Vec::new();
    let whole = "Fig. 9: equivalent single body, cost (37), run C1 integrated";
    let body = "Fig. 10: body 6 by joint 6, cost (52), runs C1 and C7";
    for (name, title, data, order, part) in [
        ("fig09", whole, &single, Order::Outward, Searched::Single),
        ("fig10", body, &tip, Order::Inward, Searched::Outer(5)),
    ] {
        let flown = data.swarms(RANGE, order, swarm.clone())?;
        let steps = flown
            .iter()
            .flat_map(|f| f.steps.iter().find(|s| s.part == part));
        let steps: Vec<_> = steps.collect();
        arrived.push(steps.iter().filter(|s| s.arrived()).count());
        findings.plot(name, plot(title, &steps));
    }
    let [a, b] = [arrived[0], arrived[1]];
    let text = format!("{a} and {b} of {SEEDS} flights arrive");
    findings.state("Fig. 9, 10 cost of the swarm", text);
    Ok(findings)
}

/// Median and the band of all seeds, and the linear solution.
fn plot(title: &str, steps: &[&StepReport]) -> Plot {
    let flights = || steps.iter().filter_map(|s| s.flight.as_ref());
    let linear = steps.first().map_or(f64::NAN, |s| s.cost_linear);
    let n = flights().map(|f| f.0.history.len()).min().unwrap_or(0);
    let x: Vec<f64> = (0..n).step_by(STEP).map(|k| k as f64).collect();
    let at = |share: f64| -> Vec<f64> {
        let one = |k: usize| quantile(flights().map(|f| f.0.history[k]), share);
        (0..n).step_by(STEP).map(one).collect()
    };
    let seeds = format!("all {SEEDS} seeds");
    let (ends, level) = ([0.0, n as f64], [linear; 2]);
    let series = vec![
        Series::band(&seeds, 0, &x, &at(0.0), &at(1.0)),
        Series::new("swarm, median", Mark::Line, 0, &x, &at(0.5)),
        Series::new("linear solution", Mark::Dashed, 1, &ends, &level),
    ];
    Plot {
        log: true,
        ..curves(title, "iteration", "best cost, N s + N m s", series)
    }
}

/// Accuracy of the swarm against iterations, and the linear solution.
fn accuracy(robot: &Robot, data: &Data) -> Result<Table, StudyError> {
    let x = particle(&robot.whole());
    let error = |found: &Found| {
        let found = particle(&found.steps[0].found);
        largest((0..10).map(|k| ((found[k] - x[k]) / x[k]).abs()))
    };
    let title =
        format!("Equivalent single body, run C1: largest relative error, worst of {SEEDS} seeds");
    let mut table = Table::new("accuracy", title, "iterations | error");
    for iterations in [100, 200, 400, 800, 1600, 3200] {
        let swarm = Swarm {
            iterations,
            ..Swarm::default()
        };
        let flown = data.swarms(RANGE, Order::Outward, swarm)?;
        table.row(format!("{iterations}"), [largest(flown.iter().map(error))]);
    }
    table.row("linear", [error(&data.linear(Order::Outward)?)]);
    Ok(table)
}
