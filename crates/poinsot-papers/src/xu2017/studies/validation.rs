//! Sec. 5.5: the torques of Table 13 applied to the true and the identified robot; Fig. 12 and 13.

use super::printed::{VALIDATION, printed_bodies};
use super::robot::{ALL, Robot, SEEDS};
use crate::study::statistics::{largest, median};
use crate::study::{Cell, Context, Difference, Findings, StudyError, Table, figures};
use crate::xu2017::Order;
use crate::xu2017::swarm::Swarm;
use poinsot_figures::{Axis, Mark, Plot, Series};
use poinsot_spatial::InertialParameters;

/// Half-width of the swarm's range, relative to the true values.
const RANGE: f64 = 0.5;
/// Smaller differences are round-off, and are not shown on a logarithmic axis.
const ROUND_OFF: f64 = 1.0e-17;

/// Largest differences of base position, attitude and joint angles.
fn three(list: &[Difference]) -> [f64; 3] {
    let of = |prefix: &str| {
        let those = list.iter().filter(|d| d.name.starts_with(prefix));
        largest(those.map(|d| d.largest))
    };
    [of("base position"), of("base attitude"), of("joint")]
}

/// The study.
pub fn run(context: &Context) -> Result<Findings, StudyError> {
    let robot = Robot::new(context)?;
    let case = context.case("xu2017_table13.toml")?;
    let moved = |bodies: &[_]| context.tools.differences(&case, bodies, &robot.truth);
    let mut table = Table::new(
        "table13",
        "Torques of Table 13 for 2 s: largest difference to the true robot",
        " | base position, m | base attitude, rad | joint angles, rad",
    );
    let cells = |x: [f64; 3]| -> [Cell; 3] { x.map(|x| figures(x, 2)) };
    table.row("paper, as printed", cells(VALIDATION));
    let of_paper = moved(&printed_bodies())?;
    table.row(
        "paper, from its Tables 6 to 12, in our posture",
        cells(three(&of_paper)),
    );
    let full = robot.data(&ALL)?;
    let mut inward = Vec::new();
    for (name, order) in [("1..n", Order::Outward), ("n..1", Order::Inward)] {
        let found = full.linear(order)?;
        inward = moved(&found.bodies)?;
        let title = format!("linear, {name} (base {:.2} kg)", found.bodies[0].mass);
        table.row(title, cells(three(&inward)));
    }
    let flown = robot
        .centred_data(&ALL)?
        .swarms(RANGE, Order::Outward, Swarm::default())?;
    let mut all = Vec::new();
    for found in &flown {
        all.push(three(&moved(&found.bodies)?));
    }
    let column = |k: usize| all.iter().map(move |d| d[k]);
    let medians = [0, 1, 2].map(|k| median(column(k)));
    let worsts = [0, 1, 2].map(|k| largest(column(k)));
    table.row(
        format!("swarm, range 50 %, median of {SEEDS} seeds"),
        cells(medians),
    );
    table.row(
        format!("swarm, range 50 %, worst of {SEEDS} seeds"),
        cells(worsts),
    );
    let by_joints = (0..all.len()).max_by(|a, b| all[*a][2].total_cmp(&all[*b][2]));
    let worst = &flown[by_joints.unwrap_or(0)].bodies;
    let mut findings = Findings::of(table);
    findings.tables.push(masses(&robot, worst));
    let times = three(&of_paper);
    let [a, b, c] = [0, 1, 2].map(|k| VALIDATION[k] / times[k]);
    findings.state(
        "Fig. 11-13 validation",
        format!("{a:.0}, {b:.0}, {c:.0} times"),
    );
    let sources = [
        ("paper's tables", &of_paper),
        ("swarm, worst seed", &moved(worst)?),
        ("linear, n..1", &inward),
    ];
    draw(&sources, &mut findings);
    Ok(findings)
}

/// Fig. 12 and 13.
fn draw(sources: &[(&str, &Vec<Difference>)], findings: &mut Findings) {
    for (name, title, unit, prefix) in [
        (
            "fig12_position",
            "Fig. 12: base position",
            "m",
            "base position",
        ),
        (
            "fig12_attitude",
            "Fig. 12: base attitude",
            "rad",
            "base attitude",
        ),
        (
            "fig13_joints",
            "Fig. 13: joint angles, root of the sum of squares",
            "rad",
            "joint",
        ),
    ] {
        findings.plot(name, plot(title, unit, prefix, sources));
    }
}

fn masses(robot: &Robot, worst: &[InertialParameters]) -> Table {
    let mut masses = Table::new(
        "worst_masses",
        "Masses of the seed with the largest difference of joint angles, kg",
        " | B0 | B1 | B2 | B3 | B4 | B5 | B6",
    );
    masses.row("true", robot.truth.iter().map(|b| figures(b.mass, 3)));
    masses.row("worst seed", worst.iter().map(|b| figures(b.mass, 3)));
    masses
}

/// Norm of the difference over time, logarithmic.
fn plot(title: &str, unit: &str, prefix: &str, sources: &[(&str, &Vec<Difference>)]) -> Plot {
    let mut series = Vec::new();
    for (colour, (name, list)) in sources.iter().enumerate() {
        let those: Vec<&Difference> = list.iter().filter(|d| d.name.starts_with(prefix)).collect();
        let Some(first) = those.first() else { continue };
        let rows = || those.iter().flat_map(|d| &d.rows);
        let length = |k: usize| rows().map(|r| r[k] * r[k]).sum::<f64>().sqrt();
        let points = first
            .time_s
            .iter()
            .enumerate()
            .map(|(k, t)| (*t, length(k)));
        let (x, y): (Vec<f64>, Vec<f64>) = points.filter(|p| p.1 > ROUND_OFF).unzip();
        series.push(Series::new(name, Mark::Line, colour, &x, &y));
    }
    Plot {
        title: title.to_owned(),
        x: Axis::new("time", "s"),
        y: Axis::new("difference", unit),
        log: true,
        series,
        ..Plot::default()
    }
}
