//! Tables 4 and 6 to 12: paper, swarm, linear, side by side, under what the data can show.

use crate::null::Null;
use crate::printed::{IDENTIFIED, NAMES, TABLE4_ERRORS};
use crate::setup::{Data, all_unknown, data, fraction, properties, thinned, truth, whole};
use poinsot_identify::linear;
use poinsot_papers::xu2017::swarm::Swarm;
use poinsot_papers::xu2017::{
    self, Found, Kind, Order, Solver, particle, properties as of_particle, sequence,
};
use poinsot_spatial::InertialParameters;
use rayon::prelude::*;

pub const SEEDS: u64 = 20;

/// The swarm's answers for a number of seeds, range around the true values: as kind as a range can be.
pub fn swarms(data: &Data, share: f64, seeds: u64, order: Order) -> Vec<Found> {
    let fly = |seed: u64| {
        let solver = Solver {
            kind: Kind::Swarm,
            swarm: Swarm {
                seed,
                ..Swarm::default()
            },
            share,
        };
        sequence(&data.problem(), order, &solver).expect("the runs suit the method")
    };
    (0..seeds).into_par_iter().map(fly).collect()
}

fn paper() -> Vec<InertialParameters> {
    let body = |x: &[f64; 10]| of_particle(x).parameters();
    IDENTIFIED.iter().map(body).collect()
}

/// What the data can show, printed above every table.
pub fn header(data: &Data) -> Null {
    let answer = linear(&data.problem()).expect("the runs are a problem");
    let found = &answer.identifiability;
    let true_bodies = truth();
    let null = Null::new(&answer, &properties(&true_bodies));
    let sigma = |k: usize| found.sigmas_natural.get(k).copied().unwrap_or(f64::NAN);
    println!("Identifiability, runs C1 to C7, every body unknown");
    println!(
        "  {} of {} combinations are seen; sigma in natural units: direction {} {:.1e}, direction {} {:.1e}",
        found.rank,
        found.parameters,
        found.rank,
        sigma(found.rank - 1),
        found.rank + 1,
        sigma(found.rank)
    );
    let alone = answer.bodies.iter().map(|b| {
        let single = std::iter::once(&b.mass).chain(&b.com).chain(&b.inertia);
        (
            single.filter(|n| n.value.is_some()).count(),
            b.barycentric.iter().filter(|n| n.value.is_some()).count(),
        )
    });
    let (central, barycentric) = alone.fold((0, 0), |a, b| (a.0 + b.0, a.1 + b.1));
    println!(
        "  single numbers seen alone: {barycentric} of 70 about the joints, {central} of 70 as mass, mass centre, central inertia (zeros by symmetry of this geometry)"
    );
    let (_, share) = null.share(&paper(), &true_bodies);
    let mass: f64 = IDENTIFIED.iter().map(|b| b[0]).sum();
    println!(
        "  of the squared scaled error of Tables 6 to 12 {:.0} % lies in the {} open directions (a random error: {:.0} %); the printed masses sum to {mass:.2} kg, (46) demands 476",
        100.0 * share,
        null.count(),
        100.0 * null.count() as f64 / 70.0
    );
    println!();
    null
}

/// Table 4: the equivalent single body.
pub fn table4(data: &Data, flights: &[Found]) {
    let total = whole(&data.tree, &truth());
    let x = particle(&total);
    let linear = sequence(&data.problem(), Order::Outward, &Solver::default()).expect("runs");
    let error = |found: &Found, k: usize| {
        let found = particle(&found.steps[0].found);
        100.0 * ((found[k] - x[k]) / x[k]).abs()
    };
    println!(
        "Table 4: equivalent single body, error in per cent (truth: our closest geometry, see examples/xu2017)"
    );
    println!(
        "  {:12} {:>12} {:>12} {:>18} {:>12}",
        "", "truth", "paper", "swarm, worst of 20", "linear"
    );
    for k in 0..10 {
        let worst = flights.iter().map(|f| error(f, k)).fold(0.0, f64::max);
        let printed = match TABLE4_ERRORS[k] {
            e if e.is_nan() => "(lost)".to_owned(),
            e => format!("{e:.2e}"),
        };
        println!(
            "  {:12} {:12.6} {printed:>12} {worst:18.1e} {:12.1e}",
            NAMES[k],
            x[k],
            error(&linear, k)
        );
    }
    println!(
        "  (from C1, which logs no angular acceleration: (35) integrated; the error is MuJoCo's own step)"
    );
    println!();
}

/// Tables 6 to 12: every body.
pub fn bodies(data: &Data, null: &Null, wide: &[Found], narrow: &[Found]) {
    let true_bodies = truth();
    let solver = Solver::default();
    let linear = [Order::Outward, Order::Inward].map(|order| {
        sequence(&data.problem(), order, &solver)
            .expect("runs")
            .bodies
    });
    let answer = xu2017::identify(
        &data.problem(),
        xu2017::Variant {
            solver: Kind::Linear,
            order: Order::Outward,
        },
    )
    .expect("runs");
    for (b, printed) in IDENTIFIED.iter().enumerate() {
        let x = particle(&properties(&true_bodies)[b]);
        println!("Table {}: body B{b}", 6 + b);
        println!(
            "  {:12} {:>10} {:>11} {:>28} {:>28} {:>10} {:>10}  alone",
            "",
            "truth",
            "paper",
            "swarm, range 50 %: 5..95 %",
            "swarm, range 5 %: 5..95 %",
            "1..n",
            "n..1"
        );
        for k in 0..10 {
            let spread = |list: &[Found]| {
                // A body of negative mass has no mass centre; its mass stands in the first row.
                let number = |f: &Found| match k {
                    0 => Some(f.bodies[b].mass),
                    _ => Some(particle(&f.bodies[b].mass_properties()?)[k]),
                };
                let all: Vec<f64> = list.iter().filter_map(number).collect();
                format!("{:.4} .. {:.4}", fraction(&all, 0.05), fraction(&all, 0.95))
            };
            let of = |list: &[InertialParameters]| particle(&properties(list)[b])[k];
            let estimate = &answer.bodies[b];
            let order = [0, 2, 5, 1, 3, 4];
            let number = match k {
                0 => &estimate.mass,
                1..=6 => &estimate.inertia[order[k - 1]],
                _ => &estimate.com[k - 7],
            };
            println!(
                "  {:12} {:10.4} {:11.4} {:>28} {:>28} {:10.4} {:10.4}  {}",
                NAMES[k],
                x[k],
                printed[k],
                spread(wide),
                spread(narrow),
                of(&linear[0]),
                of(&linear[1]),
                if number.value.is_some() {
                    "seen"
                } else {
                    "open"
                }
            );
        }
        println!();
    }
    let visible = |list: &[InertialParameters]| null.visible(list, &true_bodies);
    println!(
        "Error in what the data can show, natural units (root of the sum over 52 combinations)"
    );
    println!("  paper, as printed          {:.1e}", visible(&paper()));
    for (name, list) in [("swarm, range 50 %", wide), ("swarm, range 5 %", narrow)] {
        let all: Vec<f64> = list.iter().map(|f| visible(&f.bodies)).collect();
        println!(
            "  {name:26} {:.1e} .. {:.1e} (5..95 % of {} seeds)",
            fraction(&all, 0.05),
            fraction(&all, 0.95),
            all.len()
        );
    }
    println!("  linear, 1..n               {:.1e}", visible(&linear[0]));
    println!("  linear, n..1               {:.1e}", visible(&linear[1]));
    println!();
}

/// How the masses that a swarm "identifies" follow its search range.
pub fn ranges(data: &Data, null: &Null, seeds: u64, known: &[(f64, &[Found])]) {
    let true_bodies = truth();
    println!(
        "Masses that the swarm returns (mean and standard deviation over {seeds} seeds, kg) against its search range"
    );
    println!(
        "  {:>6} {:>15} {:>14} {:>14} {:>14} {:>14} {:>14} {:>14} {:>9} {:>12} {:>8}",
        "range", "B0", "B1", "B2", "B3", "B4", "B5", "B6", "sum", "seen error", "arrived"
    );
    for share in [0.05, 0.2, 0.5] {
        let own;
        let list = match known.iter().find(|k| k.0 == share) {
            Some((_, list)) => *list,
            None => {
                own = swarms(data, share, seeds, Order::Outward);
                &own
            }
        };
        let mut line = format!("  {:5.0} %", 100.0 * share);
        for b in 0..7 {
            let all: Vec<f64> = list.iter().map(|f| f.bodies[b].mass).collect();
            let n = all.len() as f64;
            let mean = all.iter().sum::<f64>() / n;
            let square: f64 = all.iter().map(|m| (m - mean).powi(2)).sum();
            line += &format!(
                " {:>14}",
                format!("{mean:.2} +- {:.2}", (square / n).sqrt())
            );
        }
        let sum: f64 = list[0].bodies.iter().map(|b| b.mass).sum();
        let seen: Vec<f64> = list
            .iter()
            .map(|f| null.visible(&f.bodies, &true_bodies))
            .collect();
        let arrived = list
            .iter()
            .filter(|f| f.steps.iter().all(xu2017::StepReport::arrived))
            .count();
        println!(
            "{line} {sum:9.3} {:12.1e} {arrived:>5}/{}",
            fraction(&seen, 0.5),
            list.len()
        );
    }
    println!(
        "  truth    400, 12, 10, 10, 8, 6, 30; sum 476. Range: share of the true values, centred on them"
    );
    println!();
}

/// All tables.
pub fn run(seeds: u64) {
    let full = data(&crate::setup::ALL);
    let null = header(&full);
    let truth_centred = all_unknown(&full.model);
    let tables = thinned(
        crate::setup::runs(&truth_centred, &crate::setup::ALL),
        crate::setup::EVERY,
    );
    let centred = Data::new(truth_centred, &tables);
    let wide = swarms(&centred, 0.5, seeds, Order::Outward);
    let narrow = swarms(&centred, 0.05, seeds, Order::Outward);
    table4(&full, &wide);
    bodies(&full, &null, &wide, &narrow);
    ranges(
        &centred,
        &null,
        seeds,
        &[(0.5, wide.as_slice()), (0.05, narrow.as_slice())],
    );
}
