//! Sec. 5.5: the torques of Table 13 into the true and the identified robot; Figures 12 and 13.

use crate::printed::IDENTIFIED;
use crate::setup::{all_unknown, data, examples, fraction, runs, thinned, truth};
use crate::svg::{COLOURS, Panel, Shape, figure};
use crate::tables::swarms;
use poinsot::case::read_case;
use poinsot::validate::{Compared, Mover, compare_motion};
use poinsot_model::read_model;
use poinsot_papers::xu2017::{Order, Solver, properties, sequence};
use poinsot_spatial::InertialParameters;
use std::path::Path;

/// Largest difference of base position, attitude and joint angles.
fn largest(list: &[Compared]) -> [f64; 3] {
    let of = |prefix: &str| {
        let those = list.iter().filter(|c| c.name.starts_with(prefix));
        those.map(|c| c.largest).fold(0.0, f64::max)
    };
    [of("base position"), of("base attitude"), of("joint")]
}

/// What the paper's tables, the swarm and the linear solution do under Table 13.
pub fn run(out: &Path, seeds: u64) {
    let case = read_case(&examples().join("cases/xu2017_table13.toml")).expect("case");
    let model = read_model(&case.model).expect("model");
    let right = Mover::of_model(model);
    let moved = |bodies: &[InertialParameters]| {
        let mut other = right.clone();
        other.bodies = bodies.to_vec();
        compare_motion(&case, &other, &right).expect("both move")
    };
    println!("Table 13 torques for 2 s: largest difference to the true robot");
    println!(
        "  {:38} {:>12} {:>12} {:>12}",
        "", "position m", "attitude rad", "joints rad"
    );
    let row = |name: &str, d: [f64; 3]| {
        println!("  {name:38} {:12.1e} {:12.1e} {:12.1e}", d[0], d[1], d[2]);
    };
    println!(
        "  {:38} {:>12} {:>12} {:>12}",
        "paper, as printed (Sec. 5.5)", "3.3e-5", "5.6e-4", "8.0e-4"
    );
    let paper: Vec<InertialParameters> = IDENTIFIED
        .iter()
        .map(|x| properties(x).parameters())
        .collect();
    let of_paper = moved(&paper);
    row("paper, from its Tables 6 to 12", largest(&of_paper));
    let full = data(&crate::setup::ALL);
    let mut linear = Vec::new();
    for (name, order) in [
        ("linear, 1..n", Order::Outward),
        ("linear, n..1", Order::Inward),
    ] {
        let found = sequence(&full.problem(), order, &Solver::default()).expect("runs");
        let base = found.bodies[0].mass;
        linear = moved(&found.bodies);
        row(&format!("{name} (base {base:.2} kg)"), largest(&linear));
    }
    let example = all_unknown(&full.model);
    let tables = thinned(runs(&example, &crate::setup::ALL), crate::setup::EVERY);
    let centred = crate::setup::Data::new(example, &tables);
    let flown = swarms(&centred, 0.5, seeds, Order::Outward);
    let all: Vec<[f64; 3]> = flown.iter().map(|f| largest(&moved(&f.bodies))).collect();
    for (name, share) in [("median", 0.5), ("worst", 1.0)] {
        let pick = |k: usize| fraction(&all.iter().map(|d| d[k]).collect::<Vec<_>>(), share);
        row(
            &format!("swarm, range 50 %, {name} of {seeds} seeds"),
            [pick(0), pick(1), pick(2)],
        );
    }
    let worst = all
        .iter()
        .enumerate()
        .max_by(|a, b| a.1[2].total_cmp(&b.1[2]));
    let worst = worst.map_or(0, |w| w.0);
    let masses: Vec<String> = flown[worst]
        .bodies
        .iter()
        .map(|b| format!("{:.1}", b.mass))
        .collect();
    println!("  (masses of the worst: {} kg)", masses.join(", "));
    println!(
        "  (true masses: {} kg)",
        truth()
            .iter()
            .map(|b| format!("{:.1}", b.mass))
            .collect::<Vec<_>>()
            .join(", ")
    );
    draw(
        out,
        &[
            ("paper's tables", &of_paper),
            ("swarm, worst seed", &moved(&flown[worst].bodies)),
            ("linear, n..1", &linear),
        ],
    );
}

/// Length of the difference over time, logarithmic.
fn draw(out: &Path, sources: &[(&str, &Vec<Compared>)]) {
    let panel = |title: &str, unit: &str, takes: &dyn Fn(&Compared) -> bool| {
        let mut panel = Panel::new(title, "time, s", unit);
        panel.log_y = true;
        for ((name, list), colour) in sources.iter().zip(COLOURS) {
            let those: Vec<&Compared> = list.iter().filter(|c| takes(c)).collect();
            let Some(first) = those.first() else { continue };
            let points = first.time_s.iter().enumerate().map(|(k, t)| {
                let square: f64 = those
                    .iter()
                    .flat_map(|c| &c.difference)
                    .map(|row| row[k] * row[k])
                    .sum();
                (*t, square.sqrt())
            });
            let points: Vec<(f64, f64)> = points.filter(|p| p.1 > 1.0e-17).collect();
            panel.add(name, colour, Shape::Line(points));
        }
        panel
    };
    let panels = [
        panel("Fig. 12: base position", "difference, m", &|c| {
            c.name == "base position"
        }),
        panel("Fig. 12: base attitude", "difference, rad", &|c| {
            c.name == "base attitude"
        }),
        panel(
            "Fig. 13: joint angles, root of the sum of squares",
            "difference, rad",
            &|c| c.name.starts_with("joint"),
        ),
    ];
    let path = out.join("fig12_fig13_validation.svg");
    match std::fs::write(&path, figure(&panels)) {
        Ok(()) => println!("written: {}", path.display()),
        Err(e) => eprintln!("{}: {e}", path.display()),
    }
}
