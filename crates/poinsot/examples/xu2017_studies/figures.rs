//! Figures 9 and 10: best cost against iterations; beside it the accuracy, and the linear solution.

use crate::setup::{Data, EVERY, all_unknown, data, runs, thinned, truth, whole};
use crate::svg::{COLOURS, Panel, Shape, figure};
use poinsot_papers::xu2017::swarm::Swarm;
use poinsot_papers::xu2017::{Found, Kind, Order, Searched, Solver, particle, sequence};
use rayon::prelude::*;
use std::path::Path;

const SEEDS: u64 = 20;

fn save(out: &Path, name: &str, text: &str) {
    let path = out.join(name);
    match std::fs::write(&path, text) {
        Ok(()) => println!("written: {}", path.display()),
        Err(e) => eprintln!("{}: {e}", path.display()),
    }
}

/// Flights of a data set, all seeds, without a stop on patience.
fn flights(data: &Data, order: Order) -> Vec<Found> {
    let fly = |seed| {
        let solver = Solver {
            kind: Kind::Swarm,
            swarm: Swarm {
                seed,
                iterations: 2500,
                patience: 2500,
                ..Swarm::default()
            },
            ..Solver::default()
        };
        sequence(&data.problem(), order, &solver).expect("runs")
    };
    (0..SEEDS).into_par_iter().map(fly).collect()
}

/// Median and the band of all seeds, every tenth iteration.
fn panel(title: &str, y: &str, histories: &[&[f64]], level: f64, level_name: &str) -> Panel {
    let n = histories.iter().map(|h| h.len()).min().unwrap_or(0);
    let mut panel = Panel::new(title, "iteration", y);
    panel.log_y = true;
    let at = |share: f64| -> Vec<(f64, f64)> {
        (0..n)
            .step_by(10)
            .map(|k| {
                let all: Vec<f64> = histories.iter().map(|h| h[k]).collect();
                (k as f64, crate::setup::fraction(&all, share))
            })
            .collect()
    };
    let band = at(0.0)
        .iter()
        .zip(at(1.0))
        .map(|(a, b)| (a.0, a.1, b.1))
        .collect();
    panel.add("all 20 seeds", COLOURS[0], Shape::Band(band));
    panel.add("swarm, median", COLOURS[0], Shape::Line(at(0.5)));
    let line = vec![(0.0, level), (n as f64, level)];
    panel.add(level_name, COLOURS[1], Shape::Dashed(line));
    panel
}

/// Fig. 9 and 10.
pub fn run(out: &Path) {
    let example = data(&["C1"]).model;
    let model = all_unknown(&example);
    let single = Data::new(model.clone(), &runs(&model, &["C1"]));
    let tip = Data::new(model.clone(), &thinned(runs(&model, &["C1", "C7"]), EVERY));
    let nine = flights(&single, Order::Outward);
    let histories = |list: &'_ [Found], part: Searched| -> Vec<(Vec<f64>, f64)> {
        list.iter()
            .filter_map(|f| f.steps.iter().find(|s| s.part == part))
            .filter_map(|s| Some((s.flight.as_ref()?.0.history.clone(), s.cost_linear)))
            .collect()
    };
    let draw = |list: &[(Vec<f64>, f64)], title: &str| {
        let lines: Vec<&[f64]> = list.iter().map(|h| h.0.as_slice()).collect();
        panel(
            title,
            "best cost, N s + N m s",
            &lines,
            list[0].1,
            "linear solution",
        )
    };
    let nine_h = histories(&nine, Searched::Single);
    let ten = flights(&tip, Order::Inward);
    let ten_h = histories(&ten, Searched::Outer(5));
    let first = draw(
        &nine_h,
        "Fig. 9: equivalent single body, cost (37), run C1 integrated",
    );
    let second = draw(
        &ten_h,
        "Fig. 10: body 6 by joint 6, cost (52), runs C1 and C7",
    );
    save(out, "fig09_fig10_cost.svg", &figure(&[first, second]));
    accuracy(&single);
}

/// The swarm's accuracy against iterations, beside the linear solution.
pub fn accuracy(data: &Data) {
    let x = particle(&whole(&data.tree, &truth()));
    println!(
        "Equivalent single body, run C1: largest relative error of the ten numbers, worst of 5 seeds"
    );
    for iterations in [100, 200, 400, 800, 1600, 3200] {
        let worst = (0..5_u64)
            .map(|seed| {
                let solver = Solver {
                    kind: Kind::Swarm,
                    swarm: Swarm {
                        seed,
                        iterations,
                        ..Swarm::default()
                    },
                    ..Solver::default()
                };
                let found = sequence(&data.problem(), Order::Outward, &solver).expect("runs");
                error(&particle(&found.steps[0].found), &x)
            })
            .fold(0.0, f64::max);
        println!("  swarm, {iterations:4} iterations  {worst:.1e}");
    }
    let linear = sequence(&data.problem(), Order::Outward, &Solver::default()).expect("runs");
    println!(
        "  linear                  {:.1e}",
        error(&particle(&linear.steps[0].found), &x)
    );
}

pub fn error(found: &[f64; 10], x: &[f64; 10]) -> f64 {
    (0..10)
        .map(|k| ((found[k] - x[k]) / x[k]).abs())
        .fold(0.0, f64::max)
}
