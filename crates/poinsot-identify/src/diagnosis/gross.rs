//! Gross errors: a sign, a unit, exchanged columns, a dead thruster. First-order scores are meaningless so far from the
//! answer, so each is tested by a separate fit from the nominal numbers, on the shortest beginning of the record that
//! contradicts the model, where the predicted motion is still close. The whole record confirms it.

use super::types::{FaultKind, Suspect, SuspectValue};
use crate::fit::experiment::Experiment;
use crate::fit::part_of_record::beginning;
use crate::fit::{Fitted, fit_from};
use crate::problem::segment::Segment;
use poinsot_solve::LeastSquares;
use std::f64::consts::PI;

/// Shares of the record that are tried as its beginning: each twice the one before, so that all fits together take no longer
/// than one of the whole record.
const BEGINNINGS: [f64; 4] = [0.0625, 0.125, 0.25, 0.5];
/// Iterations of such a fit: enough for a decision.
const MISTAKE_ITERATIONS: usize = 8;
/// Share of the misfit that a gross mistake must explain.
const EXPLAINS: f64 = 0.99;

/// Largest excess of chi-square per number of a corrected fit.
const RIGHT: f64 = 10.0;

/// A kind of mistake: the factor that corrects the value, and words before and after its location.
#[derive(Clone, Copy, PartialEq)]
struct Kind {
    factor: f64,
    fault: FaultKind,
    words: [&'static str; 2],
}

const fn unit(factor: f64, after: &'static str) -> Kind {
    Kind {
        factor,
        fault: FaultKind::Units,
        words: ["a wrong unit of", after],
    }
}

/// Mistakes with the speed of a wheel.
const WHEELS: [Kind; 5] = [
    Kind {
        factor: -1.0,
        fault: FaultKind::WheelSign,
        words: ["a wrong sign of", ""],
    },
    unit(PI / 180.0, " (degrees used as radians)"),
    unit(PI / 30.0, " (revolutions per minute used as rad/s)"),
    unit(2.0 * PI, " (revolutions used as radians)"),
    unit(180.0 / PI, " (radians used as degrees)"),
];

/// Mistakes with the force of a thruster.
const THRUSTERS: [Kind; 2] = [
    Kind {
        factor: 0.0,
        fault: FaultKind::Thrust,
        words: ["no force of", ""],
    },
    Kind {
        factor: -1.0,
        fault: FaultKind::Thrust,
        words: ["a wrong direction of", ""],
    },
];

/// Speeds of two wheels in each other's column.
const EXCHANGED: Kind = Kind {
    factor: 1.0,
    fault: FaultKind::WheelExchange,
    words: ["exchanged speeds of", ""],
};

/// A possible gross error.
struct GrossError {
    kind: Kind,
    owner: String,
    place: GrossErrorLocation,
}

/// Location of the error.
enum GrossErrorLocation {
    /// Speeds of these wheels.
    Wheels(Vec<usize>),
    /// Speeds of two wheels in each other's place.
    Exchanged(usize, usize),
    /// Force of a thruster.
    Thruster(usize),
}

/// The gross error that explains nearly all of a very bad fit.
pub(super) fn gross(
    experiment: &Experiment,
    fitted: &Fitted,
    (excess, dof): (f64, f64),
) -> Option<Suspect> {
    let mistakes = mistakes(experiment);
    if excess < experiment.settings.diagnosis.gross_misfit * dof || mistakes.is_empty() {
        return None;
    }
    let before = experiment.chi2(&fitted.at, &fitted.evaluated)?;
    let record = contradicting(experiment);
    let whole = experiment.problem;
    let problem = whole.with_segments(record.as_deref().unwrap_or(whole.segments));
    let short = experiment.with_problem(&problem);
    let nominal = short.cost(&short.nominal_point());
    let nominal = nominal.unwrap_or(f64::INFINITY);
    let mut best: Option<Suspect> = None;
    // Errors outside, locations inside: large factors cause fast motions, which are slow to compute.
    for alike in mistakes.chunk_by(|a, b| a.kind == b.kind) {
        for mistake in promising(&short, alike, nominal) {
            let least = best.as_ref().map_or(EXPLAINS * excess, |b| b.decrease);
            let confirmed = confirmed(experiment, &short, mistake, before);
            let Some(decrease) = confirmed.filter(|d| *d > least) else {
                continue;
            };
            best = Some(named(mistake, decrease, excess));
            // Correct, not only better: the others need no test.
            if excess - decrease < RIGHT * dof {
                return best;
            }
        }
    }
    best
}

/// The shortest beginning of the record that contradicts the model; `None` where it takes all of it.
fn contradicting(experiment: &Experiment) -> Option<Vec<Segment>> {
    let gross = experiment.settings.diagnosis.gross_misfit;
    BEGINNINGS.into_iter().find_map(|share| {
        let segments = experiment.problem.segments.iter();
        let segments: Vec<Segment> = segments.map(|s| beginning(s, share)).collect();
        let problem = experiment.problem.with_segments(&segments);
        let short = experiment.with_problem(&problem);
        let contradicts = fit_from(&short, short.nominal_point(), MISTAKE_ITERATIONS)
            .is_none_or(|found| short.cost_of(&found) > gross * found.rows() as f64);
        contradicts.then_some(segments)
    })
}

/// Every mistake with a wheel, with all of them, with two of them, and with a thruster that fires.
fn mistakes(experiment: &Experiment) -> Vec<GrossError> {
    let segments = experiment.problem.segments;
    let fires = |k: usize| {
        let mut firings = segments.iter().flat_map(|s| &s.firings);
        firings.any(|f| f.thruster == k)
    };
    let mut list = Vec::new();
    for kind in THRUSTERS {
        let all = experiment.thrusters.iter().enumerate();
        list.extend(all.filter(|(k, _)| fires(*k)).map(|(k, t)| GrossError {
            kind,
            owner: t.name.clone(),
            place: GrossErrorLocation::Thruster(k),
        }));
    }
    let wheels = &experiment.problem.model.wheels;
    let exchanged = |i: usize, j: usize| GrossError {
        kind: EXCHANGED,
        owner: format!("{} and {}", wheels[i].name, wheels[j].name),
        place: GrossErrorLocation::Exchanged(i, j),
    };
    for j in 1..wheels.len() {
        list.extend((0..j).map(|i| exchanged(i, j)));
    }
    for kind in WHEELS {
        let own = |owner: &str, which| GrossError {
            kind,
            owner: owner.to_owned(),
            place: GrossErrorLocation::Wheels(which),
        };
        let each = wheels.iter().enumerate();
        list.extend(each.map(|(k, w)| own(&w.name, vec![k])));
        if wheels.len() > 1 {
            list.push(own("all wheels", (0..wheels.len()).collect()));
        }
    }
    list
}

/// The experiment with a corrected error.
fn put_right<T>(
    experiment: &Experiment,
    mistake: &GrossError,
    ask: impl FnOnce(&Experiment) -> T,
) -> T {
    let mut other = experiment.with_parameters(experiment.parameters);
    match &mistake.place {
        GrossErrorLocation::Wheels(which) => {
            for k in which {
                if let Some(spin) = other.nominal_spin.get_mut(*k) {
                    *spin *= mistake.kind.factor;
                }
            }
        }
        GrossErrorLocation::Thruster(k) => {
            if let Some(thruster) = other.thrusters.get_mut(*k) {
                thruster.direction_B *= mistake.kind.factor;
            }
        }
        GrossErrorLocation::Exchanged(i, j) => {
            let mut segments = experiment.problem.segments.to_vec();
            let wheels = experiment.problem.model.wheels.len();
            for segment in &mut segments {
                let o = &mut segment.observations;
                let speeds = [
                    &mut o.wheel_speed,
                    &mut o.smooth_wheel_speed,
                    &mut segment.samples.wheel_speed,
                ];
                for rows in speeds {
                    rows.chunks_exact_mut(wheels)
                        .for_each(|row| row.swap(*i, *j));
                }
                if o.wheels.len() > *i.max(j) {
                    o.wheels.swap(*i, *j);
                }
            }
            let problem = experiment.problem.with_segments(&segments);
            return ask(&experiment.with_problem(&problem));
        }
    }
    ask(&other)
}

/// Errors whose correction improves the fit of the nominal numbers over `nominal`; the best first.
fn promising<'m>(
    experiment: &Experiment,
    mistakes: &'m [GrossError],
    nominal: f64,
) -> Vec<&'m GrossError> {
    let cost = |mistake: &'m GrossError| {
        let cost = put_right(experiment, mistake, |other| {
            other.cost(&other.nominal_point())
        });
        Some((cost.filter(|cost| *cost < nominal)?, mistake))
    };
    let mut list: Vec<(f64, &GrossError)> = mistakes.iter().filter_map(cost).collect();
    list.sort_by(|a, b| a.0.total_cmp(&b.0));
    list.into_iter().map(|(_, mistake)| mistake).collect()
}

/// Fall of chi-square of the whole record with a mistake put right; `None` where the beginning of it does not fit better by
/// half of the iterations.
fn confirmed(
    experiment: &Experiment,
    short: &Experiment,
    mistake: &GrossError,
    before: f64,
) -> Option<f64> {
    let x = put_right(short, mistake, |other| {
        let half = fit_from(other, other.nominal_point(), MISTAKE_ITERATIONS / 2)?;
        let gross = other.settings.diagnosis.gross_misfit;
        let fits = other.cost_of(&half) < gross * half.rows() as f64;
        fits.then_some(half.at)
    })?;
    put_right(experiment, mistake, |other| {
        let found = fit_from(other, x, MISTAKE_ITERATIONS)?;
        Some(before - other.chi2(&found.at, &found.evaluated)?)
    })
}

fn named(mistake: &GrossError, decrease: f64, excess: f64) -> Suspect {
    let (owner, [before, after]) = (&mistake.owner, mistake.kind.words);
    let values = match mistake.place {
        GrossErrorLocation::Exchanged(..) => Vec::new(),
        _ => {
            let name = format!("{owner}.factor");
            vec![SuspectValue::other(name, mistake.kind.factor, "1")]
        }
    };
    let name = format!("{before} {owner}{after}");
    Suspect {
        explains: (decrease / excess).clamp(0.0, 1.0),
        ..Suspect::new(name, mistake.kind.fault, decrease, values)
    }
}
