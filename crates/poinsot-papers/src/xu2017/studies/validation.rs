//! Sec. 5.5: the torques of Table 13 applied to the true and the identified robot; Fig. 12 and 13.

use super::robot::{ALL, Robot, SEEDS, VALIDATION, printed_bodies};
use crate::study::statistics::{largest, median};
use crate::study::{Context, Difference, Findings, StudyError, Table, curves};
use crate::xu2017::Order;
use crate::xu2017::swarm::Swarm;
use poinsot_figures::{Mark, Plot, Series};

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
    table.row("paper, as printed", VALIDATION);
    let of_paper = moved(&printed_bodies())?;
    let own = "paper, from its Tables 6 to 12, in our posture";
    table.row(own, three(&of_paper));
    let full = robot.data(&ALL)?;
    let mut inward = Vec::new();
    for (name, order) in [("1..n", Order::Outward), ("n..1", Order::Inward)] {
        let found = full.linear(order)?;
        inward = moved(&found.bodies)?;
        let title = format!("linear, {name} (base {:.2} kg)", found.bodies[0].mass);
        table.row(title, three(&inward));
    }
    let centred = robot.centred_data(&ALL)?;
    let flown = centred.swarms(RANGE, Order::Outward, Swarm::default())?;
    let all = flown.iter().map(|f| Ok(three(&moved(&f.bodies)?)));
    let all: Vec<[f64; 3]> = all.collect::<Result<_, StudyError>>()?;
    let column = |k: usize| all.iter().map(move |d| d[k]);
    let swarm = |what| format!("swarm, range 50 %, {what} of {SEEDS} seeds");
    table.row(swarm("median"), [0, 1, 2].map(|k| median(column(k))));
    table.row(swarm("worst"), [0, 1, 2].map(|k| largest(column(k))));
    let by_joints = (0..all.len()).max_by(|a, b| all[*a][2].total_cmp(&all[*b][2]));
    let worst = &flown[by_joints.unwrap_or(0)].bodies;
    let mut masses = Table::new(
        "worst_masses",
        "Masses of the seed with the largest difference of joint angles, kg",
        " | B0 :3 | B1 :3 | B2 :3 | B3 :3 | B4 :3 | B5 :3 | B6 :3",
    );
    masses.row("true", robot.truth.iter().map(|b| b.mass));
    masses.row("worst seed", worst.iter().map(|b| b.mass));
    let times = three(&of_paper);
    let [a, b, c] = [0, 1, 2].map(|k| VALIDATION[k] / times[k]);
    let mut findings = Findings::of([table, masses]);
    let text = format!("{a:.0}, {b:.0}, {c:.0} times");
    findings.state("Fig. 11-13 validation", text);
    let sources = [
        ("paper's tables", of_paper),
        ("swarm, worst seed", moved(worst)?),
        ("linear, n..1", inward),
    ];
    for (name, unit) in [("position", "m"), ("attitude", "rad")] {
        let of = format!("base {name}");
        let drawn = plot(&format!("Fig. 12: {of}"), unit, &of, &sources);
        findings.plot(&format!("fig12_{name}"), drawn);
    }
    let joints = "Fig. 13: joint angles, root of the sum of squares";
    findings.plot("fig13_joints", plot(joints, "rad", "joint", &sources));
    Ok(findings)
}

/// Norm of the difference over time, logarithmic.
fn plot(title: &str, unit: &str, prefix: &str, sources: &[(&str, Vec<Difference>)]) -> Plot {
    let mut series = Vec::new();
    for (colour, (name, list)) in sources.iter().enumerate() {
        let those: Vec<&Difference> = list.iter().filter(|d| d.name.starts_with(prefix)).collect();
        let Some(first) = those.first() else { continue };
        let rows = || those.iter().flat_map(|d| &d.rows);
        let length = |k: usize| rows().map(|r| r[k] * r[k]).sum::<f64>().sqrt();
        let times = first.time_s.iter().enumerate();
        let points = times.map(|(k, t)| (*t, length(k)));
        let (x, y): (Vec<f64>, Vec<f64>) = points.filter(|p| p.1 > ROUND_OFF).unzip();
        series.push(Series::new(name, Mark::Line, colour, &x, &y));
    }
    Plot {
        log: true,
        ..curves(title, "time, s", &format!("difference, {unit}"), series)
    }
}
