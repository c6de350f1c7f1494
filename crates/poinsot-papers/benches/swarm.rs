//! Particle swarm of Xu 2017 on the cost (37): 50 particles, 600 samples of the locked robot under thrust.
//!
//! Prints `name,value,unit`: least time of an evaluation of all particles and of a whole iteration, and the accuracy
//! over iterations.
#![allow(non_snake_case)]

use poinsot_papers::xu2017::swarm::{Objective, Range, Swarm, fly};
use poinsot_papers::xu2017::{
    Form, Part, Push, SingleObjective, SingleRow, accelerations, particle, solve_single,
};
use poinsot_spatial::{MassProperties, Matrix3, Vector3};
use std::time::Instant;

/// Table 4 of the paper.
fn truth() -> MassProperties {
    MassProperties {
        mass: 476.0,
        p_BoBcm_B: Vector3::new(0.103, 0.007, 0.078),
        I_BBcm_B: Matrix3::new(
            65.46, -2.111, -25.195, -2.111, 93.997, -3.741, -25.195, -3.741, 66.931,
        ),
    }
}

/// Twelve thrusters of 2 N, 5 s each, sampled at 10 Hz; rates by fourth-order Runge-Kutta at 1 ms.
fn samples(body: &MassProperties) -> Vec<Push> {
    #[rustfmt::skip]
    let thrusters: [[f64; 6]; 12] = [
        [-0.7, -0.2, 0.0, 2.0, 0.0, 0.0], [0.0, 0.2, 0.0, 0.0, -2.0, 0.0],
        [-0.7, 0.2, 0.0, 2.0, 0.0, 0.0], [0.0, -0.2, 0.0, 0.0, -2.0, 0.0],
        [-0.35, 0.35, -0.2, 0.0, 2.0, 0.0], [0.15, -0.35, 0.0, 0.0, 0.0, -2.0],
        [-0.55, 0.35, 0.0, 0.0, 0.0, 2.0], [-0.55, -0.35, 0.0, 0.0, 0.0, 2.0],
        [0.35, 0.35, 0.2, 0.0, 2.0, 0.0], [0.35, -0.35, 0.2, 2.0, 0.0, 0.0],
        [0.15, 0.35, 0.0, 0.0, 0.0, 2.0], [0.35, -0.35, 0.2, 0.0, -2.0, 0.0],
    ];
    let c = body.p_BoBcm_B;
    let inverse = body.I_BBcm_B.try_inverse().unwrap_or_else(Matrix3::zeros);
    let sensor = Vector3::new(0.2, 0.1, -0.15);
    let mut w = Vector3::new(0.01, -0.02, 0.015);
    let mut out = Vec::new();
    for k in 0..60_000_usize {
        let t = thrusters[k / 5000];
        let (r, f) = (
            Vector3::new(t[0], t[1], t[2]),
            Vector3::new(t[3], t[4], t[5]),
        );
        let rate = |w: Vector3| inverse * ((r - c).cross(&f) - w.cross(&(body.I_BBcm_B * w)));
        if k % 100 == 0 {
            let dw = rate(w);
            let arm = sensor - c;
            out.push(Push {
                w_NB_B: w,
                dw_NB_B: dw,
                a_NS_B: Some(f / body.mass + dw.cross(&arm) + w.cross(&w.cross(&arm))),
                p_BoS_B: sensor,
                F_B: f,
                T_B: r.cross(&f),
            });
        }
        let h = 1.0e-3;
        let k1 = rate(w);
        let k2 = rate(w + k1 * (0.5 * h));
        let k3 = rate(w + k2 * (0.5 * h));
        let k4 = rate(w + k3 * h);
        w += (k1 + (k2 + k3) * 2.0 + k4) * (h / 6.0);
    }
    out
}

fn main() {
    let body = truth();
    let rows = accelerations(&samples(&body));
    let objective = SingleObjective::new(&rows);
    let range = Range {
        low: [0.0, 0.0, 0.0, 0.0, -50.0, -50.0, -50.0, -1.0, -1.0, -1.0],
        high: [1000.0, 200.0, 200.0, 200.0, 50.0, 50.0, 50.0, 1.0, 1.0, 1.0],
    };
    let particles = vec![particle(&body); 50];
    let mut cost = vec![0.0; 50];
    let mut least = f64::INFINITY;
    for _ in 0..400 {
        let start = Instant::now();
        for _ in 0..10 {
            objective.costs(&particles, &mut cost);
        }
        least = least.min(start.elapsed().as_secs_f64() / 10.0);
    }
    println!("poinsot_swarm_objective_50x600,{:.2},us", 1.0e6 * least);
    println!("poinsot_swarm_cost_at_truth,{:.3e},mixed", cost[0]);
    let mut fastest = f64::INFINITY;
    for round in 0..40 {
        let swarm = Swarm {
            iterations: 100,
            patience: 1000,
            seed: round,
            ..Swarm::default()
        };
        // Time of one iteration: the least of all has no interruption.
        let mut before = Instant::now();
        fly(&swarm, &range, &objective, |_, _, _| {
            let now = Instant::now();
            fastest = fastest.min((now - before).as_secs_f64());
            before = now;
            true
        });
    }
    println!("poinsot_swarm_iteration_50x600,{:.2},us", 1.0e6 * fastest);
    accuracy(&body, &rows, &range, &objective);
}

/// Iterations to reach several errors, and the linear solution.
fn accuracy(body: &MassProperties, rows: &[SingleRow], range: &Range, objective: &SingleObjective) {
    let x = particle(body);
    let error = |y: &[f64; 10]| {
        (0..10)
            .map(|d| (y[d] - x[d]).abs() / x[d].abs().max(1.0e-2))
            .fold(0.0, f64::max)
    };
    for seed in 0..3 {
        let swarm = Swarm {
            seed,
            patience: 4000,
            ..Swarm::default()
        };
        let mut reached = [None; 4];
        let goals = [1.0e-2, 1.0e-4, 1.0e-8, 1.0e-11];
        let start = Instant::now();
        let end = fly(&swarm, range, objective, |k, best, _| {
            for (slot, goal) in reached.iter_mut().zip(goals) {
                if slot.is_none() && error(best) < goal {
                    *slot = Some(k);
                }
            }
            true
        });
        let time = start.elapsed().as_secs_f64();
        for (k, goal) in reached.iter().zip(goals) {
            if let Some(k) = k {
                println!("poinsot_swarm_iterations_to_{goal:e}_seed{seed},{k},iterations");
            }
        }
        println!(
            "poinsot_swarm_final_error_seed{seed},{:.2e},relative",
            error(&end.best)
        );
        println!(
            "poinsot_swarm_time_{}_iterations_seed{seed},{time:.3},s",
            end.history.len() - 1
        );
    }
    let mut nominal = *body;
    nominal.mass *= 1.1;
    let mut least = f64::INFINITY;
    let mut found = 0.0;
    let rows = [rows.to_vec()];
    for _ in 0..50 {
        let start = Instant::now();
        let answer = solve_single(&rows, Form::Acceleration, &nominal, Part::All);
        least = least.min(start.elapsed().as_secs_f64());
        found = error(&particle(&answer.value));
    }
    println!("poinsot_swarm_linear_solution,{:.3},ms", 1.0e3 * least);
    println!("poinsot_swarm_linear_error,{found:.2e},relative");
}
