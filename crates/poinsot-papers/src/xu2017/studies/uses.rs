//! The five uses of the Conclusion, without noise.

use super::robot::{ALL, ARM, Robot, errors};
use crate::study::{Context, Findings, StudyError, Table, without_translation};
use poinsot_model::Model;
use poinsot_spatial::MassProperties;

/// One use: what is known, from which runs, and whether the first run shows no translation.
struct Use {
    title: &'static str,
    model: Model,
    runs: &'static [&'static str],
    turning: bool,
    asked: Asked,
}

/// What is counted, and compared with the truth.
enum Asked {
    /// Combinations; the numbers of the whole.
    Whole,
    /// Combinations; the mass of the whole.
    MassOfWhole,
    /// Combinations.
    Combinations,
    /// The numbers of a body.
    Body(usize, MassProperties),
}

/// The study.
pub fn run(context: &Context) -> Result<Findings, StudyError> {
    let robot = Robot::new(context)?;
    let head = "use | linear :1 | linear-inward :1 | swarm :1";
    let title = "Numbers or combinations found, of those requested";
    let mut counts = Table::new("counts", title, head);
    let title = "Largest error of the numbers given, relative to mass, size and inertia";
    let mut worst = Table::new("errors", title, head);
    for case in uses(&robot) {
        counts.row(case.title, []);
        worst.row(case.title, []);
        for variant in ["linear", "linear-inward", "swarm"] {
            let (found, error) = answer(&robot, &case, variant)?;
            counts.word(found);
            worst.push(error);
        }
    }
    Ok(Findings::of([counts, worst]).say(&[
        "use 1, all bodies = {counts.0.1} combinations, whole {errors.0.1}",
        "use 4, grasped target = {counts.5.1}, {errors.5.1}",
    ]))
}

fn uses(robot: &Robot) -> [Use; 6] {
    let body = |b: usize| Asked::Body(b, robot.properties()[b]);
    let case = |title, model, runs, turning, asked| Use {
        title,
        model,
        runs,
        turning,
        asked,
    };
    let (all, arm) = (robot.model.clone(), robot.known_but(&[1, 2, 3, 4, 5, 6]));
    let (base, target) = (robot.known_but(&[0]), robot.known_but(&[6]));
    let (single, whole) = (robot.one_body(true), Asked::Body(0, robot.whole()));
    let known = "2 mass and mass centre of the whole known, C1";
    let printed = "2 as printed: of the base known; mass of the whole";
    [
        case("1 all bodies, C1 to C7", all, &ALL, false, Asked::Whole),
        case(known, single, &ALL[..1], true, whole),
        case(printed, robot.mass_known(0), &ALL, true, Asked::MassOfWhole),
        case(
            "3 base known, C2 to C7",
            arm,
            &ARM,
            false,
            Asked::Combinations,
        ),
        case("3 arm known, C2 to C7", base, &ARM, false, body(0)),
        case("4 grasped target, C7", target, &ARM[5..], false, body(6)),
    ]
}

/// Numbers or combinations determined by one use, and the largest error.
fn answer(robot: &Robot, case: &Use, variant: &str) -> Result<(String, f64), StudyError> {
    let mut tables = robot.runs(&case.model, case.runs)?;
    if case.turning {
        without_translation(&mut tables[..1]);
    }
    let tools = robot.context.tools;
    let e = tools.identify(&case.model, tables, "xu2017", Some(variant))?;
    let found = &e.identifiability;
    let combinations = format!("{} of {}", found.determined.len(), found.parameters);
    let whole = e.system.as_ref().map(|s| &s.0);
    let error = match &case.asked {
        Asked::Body(b, truth) => {
            let (worst, n) = errors(&e.bodies[*b], truth);
            return Ok((format!("{n} of 10"), worst));
        }
        Asked::Whole => whole.map(|w| errors(w, &robot.whole()).0),
        Asked::MassOfWhole => {
            whole.and_then(|w| Some((w.mass.value? / robot.whole().mass - 1.0).abs()))
        }
        Asked::Combinations => None,
    };
    Ok((combinations, error.unwrap_or(f64::NAN)))
}
