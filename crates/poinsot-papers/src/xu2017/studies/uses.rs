//! The five uses of the Conclusion, without noise.

use super::robot::{ALL, ARM, Robot, errors};
use crate::study::{Context, Findings, StudyError, Table, without_translation};
use poinsot_identify::Estimate;

/// The study.
pub fn run(context: &Context) -> Result<Findings, StudyError> {
    let robot = Robot::new(context)?;
    let head = "use | linear :1 | linear-inward :1 | swarm :1";
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
    for (k, used) in columns[0].iter().enumerate() {
        let of_variant = columns.iter().map(|c| c[k].found.as_str());
        let found: Vec<&str> = of_variant.collect();
        counts.row(format!("{} | {}", used.title, found.join(" | ")), []);
        worst.row(used.title, columns.iter().map(|c| c[k].error));
    }
    Ok(Findings::of([counts, worst]).say(&[
        "use 1, all bodies = {counts.0.1} combinations, whole {errors.0.1}",
        "use 4, grasped target = {counts.5.1}, {errors.5.1}",
    ]))
}

fn combinations(e: &Estimate) -> String {
    let found = &e.identifiability;
    format!("{} of {}", found.determined.len(), found.parameters)
}

/// Numbers determined by one use, and their largest error.
struct Used {
    title: &'static str,
    found: String,
    error: f64,
}

fn uses(robot: &Robot, variant: &str) -> Result<Vec<Used>, StudyError> {
    let (total, right) = (robot.whole(), robot.properties());
    let mut list = Vec::new();
    let mut add = |title, found, error| {
        list.push(Used {
            title,
            found,
            error,
        });
    };
    let e = robot.ask(&robot.model, robot.runs(&robot.model, &ALL)?, variant)?;
    let whole = e.system.as_ref().map(|s| errors(&s.0, &total).0);
    add(
        "1 all bodies, C1 to C7",
        combinations(&e),
        whole.unwrap_or(f64::NAN),
    );
    let single = robot.one_body(true);
    let mut turning = robot.runs(&single, &["C1"])?;
    without_translation(&mut turning);
    let e = robot.ask(&single, turning, variant)?;
    let (worst, n) = errors(&e.bodies[0], &total);
    add(
        "2 mass and mass centre of the whole known, C1",
        format!("{n} of 10"),
        worst,
    );
    let m = robot.mass_known(0);
    let mut tables = robot.runs(&m, &ALL)?;
    without_translation(&mut tables[..1]);
    let e = robot.ask(&m, tables, variant)?;
    let mass = e.system.as_ref().and_then(|s| s.0.mass.value);
    add(
        "2 as printed: of the base known; mass of the whole",
        combinations(&e),
        mass.map_or(f64::NAN, |m| (m / total.mass - 1.0).abs()),
    );
    let m = robot.known_but(&[1, 2, 3, 4, 5, 6]);
    let e = robot.ask(&m, robot.runs(&m, &ARM)?, variant)?;
    add("3 base known, C2 to C7", combinations(&e), f64::NAN);
    for (title, body, names) in [
        ("3 arm known, C2 to C7", 0, &ARM[..]),
        ("4 grasped target, C7", 6, &ARM[5..]),
    ] {
        let m = robot.known_but(&[body]);
        let e = robot.ask(&m, robot.runs(&m, names)?, variant)?;
        let (worst, n) = errors(&e.bodies[body], &right[body]);
        add(title, format!("{n} of 10"), worst);
    }
    Ok(list)
}
