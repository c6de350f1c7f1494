//! Every row that is compared: ours, the peer, how many times as fast, and what is wanted.

use super::figures::{Figures, significant};
use super::machine;

/// What is compared.
struct Row {
    work: &'static str,
    ours: &'static str,
    /// Unit of both figures; the largest speed counts, of times and instructions the least.
    unit: &'static str,
    peers: &'static [(&'static str, &'static str)],
    wanted: &'static str,
}

const fn row(
    work: &'static str,
    (ours, unit): (&'static str, &'static str),
    peers: &'static [(&'static str, &'static str)],
    wanted: &'static str,
) -> Row {
    Row {
        work,
        ours,
        unit,
        peers,
        wanted,
    }
}

/// Where a large figure is a fast one.
const SPEED: &str = "simulated_s_per_s";

const ROWS: [Row; 12] = [
    row(
        "momentum regressor 6 x 70, one call",
        ("poinsot_momentum_regressor_6x70", "ns_min"),
        &[("Pinocchio", "pinocchio_momentum_regressor_6x70")],
        "4",
    ),
    row(
        "the same, instructions",
        ("poinsot_momentum_regressor_6x70", "instructions"),
        &[("Pinocchio", "pinocchio_momentum_regressor_6x70")],
        "",
    ),
    row(
        "forward dynamics, 6R on a free base",
        ("poinsot_forward_dynamics", "ns_min"),
        &[
            ("MuJoCo", "mujoco_forward_dynamics"),
            ("Pinocchio", "pinocchio_forward_dynamics"),
        ],
        "3",
    ),
    row(
        "the same, instructions",
        ("poinsot_forward_dynamics", "instructions"),
        &[
            ("MuJoCo", "mujoco_forward_dynamics"),
            ("Pinocchio", "pinocchio_forward_dynamics"),
        ],
        "",
    ),
    row(
        "Runge-Kutta at 10 ms",
        ("poinsot_sim_rk4_10ms", SPEED),
        &[
            ("MuJoCo", "mujoco_sim_rk4_10ms"),
            ("Pinocchio", "pinocchio_sim_rk4_10ms"),
        ],
        "2.7",
    ),
    row(
        "the same, instructions of a step",
        ("poinsot_sim_rk4_10ms", "instructions"),
        &[
            ("MuJoCo", "mujoco_sim_rk4_10ms"),
            ("Pinocchio", "pinocchio_sim_rk4_10ms"),
        ],
        "",
    ),
    row(
        "swarm, cost of 50 particles on 600 samples",
        ("poinsot_swarm_objective_50x600", "us"),
        &[("NumPy", "numpy_swarm_objective_50x600")],
        "",
    ),
    row(
        "swarm, one iteration",
        ("poinsot_swarm_iteration_50x600", "us"),
        &[("NumPy", "numpy_swarm_iteration_50x600")],
        "30",
    ),
    row(
        "4,096 states: momentum regressor",
        ("poinsot_batch_momentum_regressor_6x70", "ns_min"),
        &[
            ("NumPy", "numpy_momentum_regressor_6x70"),
            ("Pinocchio", "pinocchio_momentum_regressor_6x70"),
        ],
        "100, 8",
    ),
    row(
        "4,096 vehicles: forward dynamics",
        ("poinsot_batch_forward_dynamics", "ns_min"),
        &[
            ("MuJoCo", "mujoco_forward_dynamics"),
            ("Pinocchio", "pinocchio_forward_dynamics"),
        ],
        "15",
    ),
    row(
        "4,096 vehicles: Runge-Kutta step of 10 ms",
        ("poinsot_batch_rk4_10ms_step", "ns_min"),
        &[
            ("MuJoCo", "mujoco_rk4_10ms_step"),
            ("Pinocchio", "pinocchio_rk4_10ms_step"),
        ],
        "12",
    ),
    row(
        "joint error of at most 3e-12 rad",
        ("poinsot_sim_dp8_40ms", SPEED),
        &[],
        "20 (Drake: 187, recorded earlier)",
    ),
];

/// Work with a command of its own, and what is wanted there.
const ELSEWHERE: [(&str, &str, &str); 4] = [
    (
        "fit of a payload, beside MuJoCo's toolbox",
        "scripts/bench-fit",
        "300",
    ),
    (
        "a trial of a campaign of it, without diagnosis",
        "scripts/bench-fit",
        "1,000",
    ),
    (
        "eight of thirty columns of a CSV file, beside pyarrow and polars",
        "scripts/bench-read",
        "3",
    ),
    (
        "the Python package, beside NumPy and Pinocchio",
        "scripts/bench-python",
        "20, 5",
    ),
];

/// Prints machine and load, and the table; a cell without its program is empty.
pub fn print(figures: &Figures, samples: u64) {
    println!("{}\n", machine::in_words());
    println!("| work | ours | peer | times as fast | wanted |\n|---|---|---|---|---|");
    for row in &ROWS {
        print_row(figures, row);
    }
    let ours = format!("poinsot_least_squares_{samples}_samples_1_threads_processor");
    let peer = format!("numpy_least_squares_{samples}_samples_processor");
    let wanted = if samples < 1_000_000 { "20" } else { "25" };
    let work = format!("least squares, {samples} samples, processor time");
    let pair = (figures.least(&ours, "s"), figures.least(&peer, "s"));
    line(&work, pair.0, "s", &[("NumPy", pair.1, false)], wanted);
    for (work, command, wanted) in ELSEWHERE {
        println!("| {work} | `{command}` | | | {wanted} |");
    }
}

fn print_row(figures: &Figures, row: &Row) {
    let speed = row.unit == SPEED;
    let best = |name: &str| match speed {
        true => figures.most(name, row.unit),
        false => figures.least(name, row.unit),
    };
    let peers = row
        .peers
        .iter()
        .map(|(peer, name)| (*peer, best(name), speed));
    let peers: Vec<(&str, Option<f64>, bool)> = peers.collect();
    line(row.work, best(row.ours), row.unit, &peers, row.wanted);
}

/// A peer's name and figure, and whether a large one is fast.
type Peer<'a> = (&'a str, Option<f64>, bool);

fn line(work: &str, ours: Option<f64>, unit: &str, peers: &[Peer], wanted: &str) {
    let unit = unit.trim_end_matches("_min").replace('_', " ");
    let with_unit = |x: f64| format!("{} {unit}", significant(x));
    let told = |(name, figure, _): &Peer| Some(format!("{name} {}", with_unit((*figure)?)));
    let times = |(_, figure, speed): &Peer| {
        let (peer, ours) = ((*figure)?, ours?);
        let times = if *speed { ours / peer } else { peer / ours };
        Some(format!("{times:.1}"))
    };
    let peer: Vec<String> = peers.iter().filter_map(told).collect();
    let ratio: Vec<String> = peers.iter().filter_map(times).collect();
    println!(
        "| {work} | {} | {} | {} | {wanted} |",
        ours.map_or_else(String::new, with_unit),
        peer.join(", "),
        ratio.join(", ")
    );
}
