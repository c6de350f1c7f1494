//! tuning
#![allow(non_snake_case, missing_docs, clippy::expect_used)]
mod setup;
use poinsot_identify::methods::xu2017::*;
fn main() {
    let a: Vec<f64> = std::env::args()
        .skip(1)
        .filter_map(|s| s.parse().ok())
        .collect();
    let d = setup::data(&setup::ALL);
    let mut solver = Solver {
        kind: Kind::Swarm,
        ..Solver::default()
    };
    solver.swarm.weight = [a[0], a[1]];
    solver.swarm.attraction = [a[2], a[3]];
    solver.swarm.iterations = a[4] as usize;
    solver.share = a[5];
    let t = std::time::Instant::now();
    for order in [Order::Outward, Order::Inward] {
        for seed in 0..a[6] as u64 {
            solver.swarm.seed = seed;
            let f = sequence(&d.problem(), order, &solver).expect("ok");
            let line: Vec<String> = f
                .steps
                .iter()
                .map(|s| {
                    let (fl, _) = s.flight.as_ref().unwrap();
                    format!("{:.0e}/{}/{}", fl.cost, fl.on_bound.len(), fl.history.len())
                })
                .collect();
            println!("{}", line.join("  "));
        }
    }
    println!("{:?}", t.elapsed());
}
