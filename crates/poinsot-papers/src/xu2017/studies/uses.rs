//! The five uses of the Conclusion, without noise.

use super::robot::{ALL, ARM, Robot, errors, without_translation};
use crate::study::{Cell, Context, Findings, StudyError, Table, figures, word};
use poinsot_identify::Estimate;

/// The study.
pub fn run(context: &Context) -> Result<Findings, StudyError> {
    let robot = Robot::new(context)?;
    let head = "use | linear | linear-inward | swarm";
    let mut counts = Table::new(
        "counts",
        "Numbers or combinations found, of those requested",
        head,
    );
    let mut worst = Table::new(
        "errors",
        "Largest error of the numbers given, relative to mass, size and inertia",
        head,
    );
    let mut columns = Vec::new();
    for variant in ["linear", "linear-inward", "swarm"] {
        columns.push(uses(&robot, variant)?);
    }
    for k in 0..columns[0].len() {
        let title = columns[0][k].0;
        counts.row(title, columns.iter().map(|c| word(c[k].1.clone())));
        worst.row(title, columns.iter().map(|c| figures(c[k].2, 1)));
    }
    let error = |k: usize| Cell::text(&figures(columns[0][k].2, 1));
    let mut findings = Findings::default();
    findings.state(
        "use 1, all bodies",
        format!("{} combinations, whole {}", columns[0][0].1, error(0)),
    );
    findings.state(
        "use 4, grasped target",
        format!("{}, {}", columns[0][5].1, error(5)),
    );
    findings.tables.extend([counts, worst]);
    Ok(findings)
}

fn combinations(e: &Estimate) -> String {
    let found = &e.identifiability;
    format!("{} of {}", found.determined.len(), found.parameters)
}

/// Title, numbers determined, largest error.
type Used = (&'static str, String, f64);

fn uses(robot: &Robot, variant: &str) -> Result<Vec<Used>, StudyError> {
    let (total, right) = (robot.whole(), robot.properties());
    let of_whole = |e: &Estimate| {
        e.system
            .as_ref()
            .map_or((f64::NAN, 0), |s| errors(&s.0, &total))
    };
    let mut list = Vec::new();
    let e = robot.ask(&robot.model, robot.runs(&robot.model, &ALL)?, variant)?;
    list.push(("1 all bodies, C1 to C7", combinations(&e), of_whole(&e).0));
    let single = robot.one_body(true);
    let mut turning = robot.runs(&single, &["C1"])?;
    without_translation(&mut turning);
    let e = robot.ask(&single, turning, variant)?;
    let (worst, n) = errors(&e.bodies[0], &total);
    list.push((
        "2 mass and mass centre of the whole known, C1",
        format!("{n} of 10"),
        worst,
    ));
    let m = robot.mass_known(0);
    let mut tables = robot.runs(&m, &ALL)?;
    without_translation(&mut tables[..1]);
    let e = robot.ask(&m, tables, variant)?;
    let mass = e.system.as_ref().and_then(|s| s.0.mass.value);
    let off = mass.map_or(f64::NAN, |m| (m / total.mass - 1.0).abs());
    list.push((
        "2 as printed: of the base known; mass of the whole",
        combinations(&e),
        off,
    ));
    let m = robot.known_but(&[1, 2, 3, 4, 5, 6]);
    let e = robot.ask(&m, robot.runs(&m, &ARM)?, variant)?;
    list.push(("3 base known, C2 to C7", combinations(&e), f64::NAN));
    for (title, body, names) in [
        ("3 arm known, C2 to C7", 0, &ARM[..]),
        ("4 grasped target, C7", 6, &ARM[5..]),
    ] {
        let m = robot.known_but(&[body]);
        let e = robot.ask(&m, robot.runs(&m, names)?, variant)?;
        let (worst, n) = errors(&e.bodies[body], &right[body]);
        list.push((title, format!("{n} of 10"), worst));
    }
    Ok(list)
}
