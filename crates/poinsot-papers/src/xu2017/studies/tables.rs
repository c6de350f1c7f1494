//! Tables 4 and 6 to 12: paper, swarm and linear solution compared, with identifiability.

use super::robot::{
    ALL, Data, IDENTIFIED, Null, Robot, SEEDS, TABLE4_ERRORS, printed_bodies, properties,
};
use crate::study::statistics::{largest, mean_and_scatter, median, quantile};
use crate::study::{Context, Digits, Findings, StudyError, Table};
use crate::xu2017::swarm::Swarm;
use crate::xu2017::{Found, Kind, ORDER, Order, Solver, StepReport, Variant, identify, particle};
use poinsot_identify::{Estimate, linear};
use poinsot_spatial::{InertialParameters, MASS_PROPERTY_NAMES, MASS_PROPERTY_UNITS};

/// Half-widths of the swarm's search ranges, relative to the true values. The ranges are centred on the true values:
/// the most favourable choice.
const SHARES: [f64; 3] = [0.05, 0.2, 0.5];
/// Name of a row of Tables 4 and 6 to 12, with its unit.
fn name(k: usize) -> String {
    let name = MASS_PROPERTY_NAMES[ORDER[k]].replace("inertia", "I");
    format!("{name}, {}", MASS_PROPERTY_UNITS[ORDER[k]])
}

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
    let mut tables = vec![
        identifiable(&robot, &answer, &null),
        table4(&robot, &full, &flown[2])?,
    ];
    tables.extend(bodies(&robot, &full, &flown, &lines)?);
    tables.push(visible(&robot, &null, &flown, &lines));
    tables.push(masses(&robot, &flown));
    Ok(Findings::of(tables))
}

/// Combinations determined by the runs.
fn identifiable(robot: &Robot, answer: &Estimate, null: &Null) -> Table {
    let found = &answer.identifiability;
    let (rank, all) = (found.rank, found.parameters);
    let sigma = |k: usize| found.sigmas_natural.get(k).copied().unwrap_or(f64::NAN);
    let share = null.share(&printed_bodies(), &robot.truth);
    let random = null.count() as f64 / 70.0;
    let title = "Runs C1 to C7, every body unknown";
    let mut table = Table::new("identifiable", title, " | number");
    table.row(format!("combinations determined | {rank} of {all}"), []);
    let last = "sigma of the last determined, natural units";
    table.row(last, [sigma(rank - 1)]);
    table.row("sigma of the first undetermined", [sigma(rank)]);
    let undetermined = "squared scaled error of Tables 6 to 12 in undetermined directions, %";
    table.row(undetermined, []);
    table.with(100.0 * share, Digits::Decimals(0));
    table.row("the same of a random error, %", []);
    table.with(100.0 * random, Digits::Decimals(0));
    table.row("sum of the printed masses, kg; (46) demands 476", []);
    let sum = IDENTIFIED.iter().map(|b| b[0]).sum();
    table.with(sum, Digits::Decimals(2));
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
    let head = " | true :.4 | paper | swarm | linear";
    let mut table = Table::new("table4", title, head);
    for (k, right) in x.into_iter().enumerate() {
        let printed = usize::checked_sub(k, 1).map_or(f64::NAN, |k| TABLE4_ERRORS[k]);
        let worst = largest(flown.iter().map(|f| error(f, k)));
        table.row(name(k), [right, printed, worst, error(&linear, k)]);
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
    let answer = identify(&full.problem(), variant, &Solver::default())?;
    let head = " | true :.4 | paper :.4 | swarm 50 % :.3 | swarm 5 % :.3 | 1..n :.4 | n..1 :.4 | determined";
    let mut tables = Vec::new();
    for (b, estimate) in answer.bodies.iter().enumerate() {
        let n = 6 + b;
        let title = format!("Table {n}: body B{b}; swarms: 5 to 95 % of {SEEDS} seeds");
        let mut table = Table::new(format!("table{n}"), title, head);
        let (x, determined) = (particle(&robot.properties()[b]), estimate.numbers());
        for k in 0..10 {
            table.row(name(k), [x[k], IDENTIFIED[b][k]]);
            for list in [&flown[2], &flown[0]] {
                // A body of negative mass has no mass centre; its mass is in the first row.
                let number = |f: &Found| match k {
                    0 => Some(f.bodies[b].mass),
                    _ => Some(particle(&f.bodies[b].mass_properties()?)[k]),
                };
                let all: Vec<f64> = list.iter().filter_map(number).collect();
                table.pair([0.05, 0.95].map(|q| quantile(all.iter().copied(), q)), "..");
            }
            for list in lines {
                let found = particle(&properties(list)[b])[k];
                table.with(found, Digits::Decimals(4));
            }
            let given = determined[ORDER[k]].value.is_some();
            table.word(if given { "yes" } else { "no" });
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
    let size = |list: &[InertialParameters]| null.visible(list, &robot.truth);
    let title =
        "Error in the 52 determined combinations, natural units, root of the sum of squares";
    let mut table = Table::new("determined_error", title, " | error");
    table.row("paper, as printed", [size(&printed_bodies())]);
    for (share, list) in SHARES.into_iter().zip(flown) {
        let title = format!("swarm, range {} %, median", 100.0 * share);
        table.row(title, [median(list.iter().map(|f| size(&f.bodies)))]);
    }
    table.row("linear, 1..n", [size(&lines[0])]);
    table.row("linear, n..1", [size(&lines[1])]);
    table
}

/// Dependence of the swarm's masses on its search range.
fn masses(robot: &Robot, flown: &[Vec<Found>]) -> Table {
    let title = format!("Masses that the swarm returns, kg: mean and scatter over {SEEDS} seeds");
    let head = "range | B0 :.1 | B1 :.1 | B2 :.1 | B3 :.1 | B4 :.1 | B5 :.1 | B6 :.1 | arrived";
    let mut table = Table::new("masses", title, head);
    table.row("truth", []);
    for body in &robot.truth {
        table.with(body.mass, Digits::Decimals(0));
    }
    table.word("");
    for (share, list) in SHARES.into_iter().zip(flown) {
        table.row(format!("{} %", 100.0 * share), []);
        for b in 0..7 {
            let all: Vec<f64> = list.iter().map(|f| f.bodies[b].mass).collect();
            table.pair(mean_and_scatter(&all), "+-");
        }
        let whole = |f: &&Found| f.steps.iter().all(StepReport::arrived);
        table.word(format!("{} of {SEEDS}", list.iter().filter(whole).count()));
    }
    table
}
