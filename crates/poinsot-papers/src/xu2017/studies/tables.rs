//! Tables 4 and 6 to 12: paper, swarm and linear solution compared, with identifiability.

use super::null::Null;
use super::printed::{IDENTIFIED, NAMES, TABLE4_ERRORS, printed_bodies};
use super::robot::{ALL, Data, Robot, SEEDS, properties};
use crate::study::statistics::{largest, mean_and_scatter, median, quantile};
use crate::study::{Cell, Context, Digits, Findings, StudyError, Table, decimals, figures, word};
use crate::xu2017::swarm::Swarm;
use crate::xu2017::{Found, Kind, Order, StepReport, Variant, identify, particle};
use poinsot_identify::{Estimate, linear, tensor_index};
use poinsot_spatial::InertialParameters;

/// Half-widths of the swarm's search ranges, relative to the true values. The ranges are centred on the true values:
/// the most favourable choice.
const SHARES: [f64; 3] = [0.05, 0.2, 0.5];
const BODY_TABLES: [&str; 7] = [
    "table6", "table7", "table8", "table9", "table10", "table11", "table12",
];
/// The paper's order of a tensor.
const ELEMENTS: [&str; 6] = ["xx", "yy", "zz", "xy", "xz", "yz"];

/// The study.
pub fn run(context: &Context) -> Result<Findings, StudyError> {
    let robot = Robot::new(context)?;
    let full = robot.data(&ALL)?;
    let answer = linear(&full.problem())?;
    let null = Null::new(&answer, &robot.properties());
    let centred = robot.centred_data(&ALL)?;
    let mut flown = Vec::new();
    for share in SHARES {
        flown.push(centred.swarms(share, Order::Outward, Swarm::default())?);
    }
    let mut lines = Vec::new();
    for order in [Order::Outward, Order::Inward] {
        lines.push(full.linear(order)?.bodies);
    }
    let mut findings = Findings::of(identifiable(&robot, &answer, &null));
    findings.tables.push(table4(&robot, &full, &flown[2])?);
    findings
        .tables
        .extend(bodies(&robot, &full, &flown, &lines)?);
    findings.tables.push(visible(&robot, &null, &flown, &lines));
    findings.tables.push(masses(&robot, &flown));
    Ok(findings)
}

/// Combinations determined by the runs.
fn identifiable(robot: &Robot, answer: &Estimate, null: &Null) -> Table {
    let found = &answer.identifiability;
    let sigma = |k: usize| found.sigmas_natural.get(k).copied().unwrap_or(f64::NAN);
    let mut table = Table::new(
        "identifiable",
        "Runs C1 to C7, every body unknown",
        " | number",
    );
    let rank = found.rank;
    table.row(
        "combinations determined",
        [word(format!("{rank} of {}", found.parameters))],
    );
    table.row(
        "sigma of the last determined, natural units",
        [figures(sigma(rank - 1), 2)],
    );
    table.row("sigma of the first undetermined", [figures(sigma(rank), 2)]);
    let (share, printed) = (null.share(&printed_bodies(), &robot.truth).1, null.count());
    table.row(
        "squared scaled error of Tables 6 to 12 in undetermined directions, %",
        [decimals(100.0 * share, 0)],
    );
    table.row(
        "the same of a random error, %",
        [decimals(100.0 * printed as f64 / 70.0, 0)],
    );
    let mass: f64 = IDENTIFIED.iter().map(|b| b[0]).sum();
    table.row(
        "sum of the printed masses, kg; (46) demands 476",
        [decimals(mass, 2)],
    );
    table
}

/// Table 4: the equivalent single body.
fn table4(robot: &Robot, full: &Data, flown: &[Found]) -> Result<Table, StudyError> {
    let (x, linear) = (particle(&robot.whole()), full.linear(Order::Outward)?);
    let error = |found: &Found, k: usize| {
        let found = particle(&found.steps[0].found);
        100.0 * ((found[k] - x[k]) / x[k]).abs()
    };
    let title =
        format!("Table 4: equivalent single body, error in %; swarm: worst of {SEEDS} seeds");
    let mut table = Table::new("table4", &title, " | true | paper | swarm | linear");
    for k in 0..10 {
        let worst = largest(flown.iter().map(|f| error(f, k)));
        let errors = [TABLE4_ERRORS[k], worst, error(&linear, k)];
        let cells = std::iter::once(decimals(x[k], 4)).chain(errors.map(|e| figures(e, 2)));
        table.row(NAMES[k], cells);
    }
    Ok(table)
}

/// Tables 6 to 12: every body.
fn bodies(
    robot: &Robot,
    full: &Data,
    flown: &[Vec<Found>],
    lines: &[Vec<InertialParameters>],
) -> Result<Vec<Table>, StudyError> {
    let variant = Variant {
        solver: Kind::Linear,
        order: Order::Outward,
    };
    let answer = identify(&full.problem(), variant)?;
    let head = " | true | paper | swarm 50 % | swarm 5 % | 1..n | n..1 | determined";
    let mut tables = Vec::new();
    for (b, name) in BODY_TABLES.into_iter().enumerate() {
        let title = format!(
            "Table {}: body B{b}; swarms: 5 to 95 % of {SEEDS} seeds",
            6 + b
        );
        let mut table = Table::new(name, &title, head);
        let x = particle(&robot.properties()[b]);
        let estimate = &answer.bodies[b];
        for k in 0..10 {
            let spread = |list: &[Found]| {
                // A body of negative mass has no mass centre; its mass is in the first row.
                let number = |f: &Found| match k {
                    0 => Some(f.bodies[b].mass),
                    _ => Some(particle(&f.bodies[b].mass_properties()?)[k]),
                };
                let all: Vec<f64> = list.iter().filter_map(number).collect();
                let [low, high] = [0.05, 0.95].map(|q| quantile(all.iter().copied(), q));
                Cell::Pair(low, "..", high, Digits::Decimals(3))
            };
            let of = |list: &[InertialParameters]| decimals(particle(&properties(list)[b])[k], 4);
            let number = match k {
                0 => &estimate.mass,
                1..=6 => &estimate.inertia[tensor_index(ELEMENTS[k - 1])],
                _ => &estimate.com[k - 7],
            };
            let determined = word(if number.value.is_some() { "yes" } else { "no" });
            let (wide, narrow) = (spread(&flown[2]), spread(&flown[0]));
            let known = [decimals(x[k], 4), decimals(IDENTIFIED[b][k], 4)];
            let found = [wide, narrow, of(&lines[0]), of(&lines[1]), determined];
            table.row(NAMES[k], known.into_iter().chain(found));
        }
        tables.push(table);
    }
    Ok(tables)
}

/// Error in the identifiable directions.
fn visible(
    robot: &Robot,
    null: &Null,
    flown: &[Vec<Found>],
    lines: &[Vec<InertialParameters>],
) -> Table {
    let size = |list: &[InertialParameters]| figures(null.visible(list, &robot.truth), 2);
    let mut table = Table::new(
        "determined_error",
        "Error in the 52 determined combinations, natural units, root of the sum of squares",
        " | error",
    );
    table.row("paper, as printed", [size(&printed_bodies())]);
    for (share, list) in SHARES.into_iter().zip(flown) {
        let all = list.iter().map(|f| null.visible(&f.bodies, &robot.truth));
        let title = format!("swarm, range {} %, median", 100.0 * share);
        table.row(title, [figures(median(all), 2)]);
    }
    table.row("linear, 1..n", [size(&lines[0])]);
    table.row("linear, n..1", [size(&lines[1])]);
    table
}

/// Dependence of the swarm's masses on its search range.
fn masses(robot: &Robot, flown: &[Vec<Found>]) -> Table {
    let title = format!("Masses that the swarm returns, kg: mean and scatter over {SEEDS} seeds");
    let head = "range | B0 | B1 | B2 | B3 | B4 | B5 | B6 | arrived";
    let mut table = Table::new("masses", &title, head);
    let truth = robot.truth.iter().map(|b| decimals(b.mass, 0));
    table.row("truth", truth.chain([word("")]));
    for (share, list) in SHARES.into_iter().zip(flown) {
        let cells = (0..7).map(|b| {
            let all: Vec<f64> = list.iter().map(|f| f.bodies[b].mass).collect();
            let (mean, scatter) = mean_and_scatter(&all);
            Cell::Pair(mean, "+-", scatter, Digits::Decimals(1))
        });
        let whole = |f: &&Found| f.steps.iter().all(StepReport::arrived);
        let arrived = word(format!("{} of {SEEDS}", list.iter().filter(whole).count()));
        table.row(format!("{} %", 100.0 * share), cells.chain([arrived]));
    }
    table
}
