//! The engine of the tables of cases in `cases.toml`: flight, draws of noise, both steps, statistic.

use super::experiment::{Errors, Experiment, Run, Sigma, scale_arm, unsymmetric};
use crate::ma2008::Raw;
use crate::ma2008::printed::{PrintedAxes, two_step_printed};
use crate::study::statistics::{largest, quantile, rms};
use crate::study::{CaseText, Context, Digits, Findings, StudyError, Table, curves};
use poinsot_figures::{Mark, Plot, Series};
use poinsot_identify::{Number, tensor_index};
use poinsot_spatial::Vector3;
use serde::Deserialize;
use std::collections::BTreeMap;

/// Trials of one cell.
const SEEDS: u64 = 200;
/// Condition number of step 2 above which the tensor is not determined.
const DETERMINED: f64 = 1.0e12;

/// The file of tables.
#[derive(Deserialize)]
struct File {
    /// What a case is that says nothing.
    usual: toml::Table,
    study: BTreeMap<String, Study>,
}

#[derive(Default, Deserialize)]
#[serde(default)]
struct Study {
    statements: Vec<String>,
    table: Vec<Cases>,
    figure: Vec<Drawn>,
}

/// A figure of one column of several tables: medians, and the band of the trials where the momentum is known.
#[derive(Deserialize)]
struct Drawn {
    name: String,
    title: String,
    x: String,
    y: String,
    column: usize,
    tables: Vec<String>,
    /// Whether rows are named instead of placed by their number.
    #[serde(default)]
    named: bool,
}

impl Study {
    fn table(&self, name: &str) -> Result<&Cases, StudyError> {
        let found = self.table.iter().find(|t| t.name == name);
        Ok(found.ok_or_else(|| format!("no table {name}"))?)
    }

    fn rows(&self, cases: &Cases) -> Result<&[toml::Table], StudyError> {
        let own = cases.like.as_ref().unwrap_or(&cases.name);
        Ok(&self.table(own)?.rows)
    }
}

/// A table: its columns and rows are cases.
#[derive(Default, Deserialize)]
#[serde(default)]
struct Cases {
    name: String,
    title: String,
    head: String,
    case: toml::Table,
    columns: Vec<toml::Table>,
    rows: Vec<toml::Table>,
    /// Table of the same study with the same rows.
    like: Option<String>,
    /// Name of its curve in figures.
    curve: String,
}

/// What is flown and measured.
#[derive(Debug, Clone, PartialEq, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
struct Case {
    /// Words of the row.
    words: String,
    /// Trajectory 1 or 2, and what is flown along it.
    trajectory: usize,
    spin: [f64; 3],
    velocity: [f64; 3],
    unsymmetric: bool,
    samples: usize,
    /// Number of stops of which the samples are taken: equally spaced, or those with the largest velocities relative to
    /// each component's maximum.
    of: Option<usize>,
    largest: bool,
    moving: bool,
    /// Samples at 2 Hz over the whole trajectory.
    whole: bool,
    /// Mass of the arm over that of the base.
    ratio: Option<f64>,
    /// Fraction of the joint angles.
    span: f64,
    /// Joints that move; all six: the wrist turns beside trajectory 1.
    joints: Option<Vec<usize>>,
    /// Whether the arm is mounted in the plane of symmetry.
    plane: bool,
    /// Errors added to every sample, m/s in N and rad/s in B.
    velocity_error: [f64; 3],
    rate_error: [f64; 3],
    /// Noise: a fraction of the maxima.
    noise: Noise,
    share: f64,
    /// Whether the momentum is known.
    known: bool,
    estimator: Estimator,
    quantity: Quantity,
    /// Factor to the unit of the column.
    scale: f64,
    /// RMS over the trials instead of the median.
    rms: bool,
    /// Whether a number without a finite bound is left out.
    bounded: bool,
    /// Digits, where not those of the column.
    digits: Option<String>,
}

#[derive(Debug, Clone, Copy, PartialEq, Default, Deserialize)]
#[serde(rename_all = "snake_case")]
enum Noise {
    /// Of each component.
    #[default]
    Own,
    /// Of the largest components.
    Largest,
    /// Of each component of the run that starts at rest.
    AtRest,
    /// 1 % of the largest components of trajectory 1 at 5 deg/s.
    Fixed,
}

#[derive(Debug, Clone, Copy, PartialEq, Default, Deserialize)]
#[serde(rename_all = "snake_case")]
enum Estimator {
    #[default]
    Steps,
    Bound,
    /// The bounds of mass and `I_yy` by `predict` for the shipped case at 2 Hz: all sensors, momentum unknown, joints
    /// moving.
    Predicted,
}

#[derive(Debug, Clone, Copy, PartialEq, Default, Deserialize)]
#[serde(rename_all = "snake_case")]
enum Quantity {
    /// Relative error.
    Mass,
    /// Error, m.
    MassCentre,
    /// Error relative to the norm.
    Tensor,
    /// The largest of the three.
    #[default]
    Worst,
    /// Condition number of step 2.
    Condition,
    /// Mass of the base.
    Kilograms,
    /// Mass of the base by option 2 as printed.
    PrintedInBody,
    #[serde(rename = "printed_in_N")]
    PrintedInN,
}

impl Case {
    fn of(parts: &[&toml::Table]) -> Result<Self, StudyError> {
        let mut keys = toml::Table::new();
        parts.iter().for_each(|part| keys.extend((*part).clone()));
        Ok(keys.try_into()?)
    }

    fn experiment(&self, context: &Context) -> Result<Experiment, StudyError> {
        let mut e = Experiment::of(context, self.trajectory, self.spin)?;
        e = e.sampled(self.of.unwrap_or(self.samples), !self.moving);
        e.velocity = self.velocity;
        if self.unsymmetric {
            e = e.with_base(unsymmetric());
        }
        if let Some(ratio) = self.ratio {
            scale_arm(&mut e.model, ratio);
        }
        if self.plane {
            e.model.joints[0].p_PoCo_P.y = 0.0;
        }
        if self.whole {
            e.times = e.whole();
        }
        let first = e.knots[0].1;
        for (k, (_, place)) in e.knots.iter_mut().enumerate() {
            for (j, q) in place.iter_mut().enumerate() {
                *q *= self.span;
                match &self.joints {
                    Some(moves) if !moves.contains(&(j + 1)) => *q = first[j],
                    Some(_) if j > 2 => *q = 30.0 * k as f64 * (1.0 - 0.5 * (j - 3) as f64),
                    _ => {}
                }
            }
        }
        Ok(e)
    }

    fn run(&self, context: &Context) -> Result<Run, StudyError> {
        let mut run = self.experiment(context)?.run()?;
        if let Some(stops) = self.of {
            let most = run.sigma(1.0);
            let size = |r: &Raw| {
                let v = r.v_NBo_N.component_div(&most.v);
                v.norm_squared() + r.w_NB_B.component_div(&most.w).norm_squared()
            };
            if self.largest {
                run.raws.sort_by(|a, b| size(b).total_cmp(&size(a)));
            }
            let every = if self.largest {
                1
            } else {
                stops / self.samples
            };
            let kept = run.raws.into_iter().step_by(every);
            run.raws = kept.take(self.samples).collect();
        }
        for raw in &mut run.raws {
            raw.v_NBo_N += Vector3::from(self.velocity_error);
            raw.w_NB_B += Vector3::from(self.rate_error);
        }
        Ok(run)
    }

    /// The case without what is asked of its answer: equal ones share their trials.
    fn trials(&self) -> Self {
        Self {
            words: String::new(),
            quantity: Quantity::Worst,
            scale: 1.0,
            digits: None,
            ..self.clone()
        }
    }
}

/// Runs cases, each trial once.
struct Engine<'a> {
    context: &'a Context<'a>,
    usual: &'a toml::Table,
    fixed: Sigma,
    done: Vec<(Case, Run, Vec<Errors>)>,
}

impl Engine<'_> {
    fn sigma(&self, case: &Case, run: &Run) -> Result<Sigma, StudyError> {
        Ok(match case.noise {
            Noise::Fixed => self.fixed,
            Noise::Own => run.sigma(case.share),
            Noise::Largest => run.equal_sigma(case.share),
            Noise::AtRest => {
                let quiet = Case {
                    velocity: [0.0; 3],
                    ..case.clone()
                };
                quiet.run(self.context)?.sigma(case.share)
            }
        })
    }

    fn errors(&self, case: &Case, run: &Run) -> Result<Vec<Errors>, StudyError> {
        let sigma = self.sigma(case, run)?;
        let exact = case.share == 0.0 && case.noise == Noise::Own;
        let bound = || run.bound(sigma, case.known);
        let draw = |seed| run.noisy(sigma, seed);
        let mut found = match case.estimator {
            Estimator::Bound => vec![bound()],
            Estimator::Predicted => vec![self.predicted(case)?],
            Estimator::Steps => {
                let seeds = if exact { 1 } else { SEEDS };
                let answer = |seed| run.solved(&draw(seed), case.known).base();
                (0..seeds).map(|seed| run.errors(answer(seed))).collect()
            }
        };
        if case.bounded {
            let bound = bound();
            for k in (0..3).filter(|k| !bound[*k].is_finite()) {
                found.iter_mut().for_each(|errors| errors[k] = f64::NAN);
            }
        }
        Ok(found)
    }

    fn predicted(&self, case: &Case) -> Result<Errors, StudyError> {
        let shipped = self.context.case("ma2008_traj1.toml")?;
        let shipped = shipped.with(&[("rate_hz = 20", "rate_hz = 2")]);
        let flown = swung(&shipped, case.span);
        let mut vehicle = self.context.tools.vehicle(&flown)?;
        if let Some(ratio) = case.ratio {
            scale_arm(&mut vehicle, ratio);
        }
        let bound = self.context.tools.bound(&flown, &vehicle)?;
        let share = |n: &Number| n.sigma.map_or(f64::INFINITY, |s| s / n.nominal);
        let base = &bound.bodies[0];
        let I_yy = &base.inertia[tensor_index("yy")];
        Ok([share(&base.mass), f64::NAN, share(I_yy)])
    }

    /// The run of a case, and the errors of its trials.
    fn done(&mut self, case: &Case) -> Result<(&Run, &[Errors]), StudyError> {
        let key = case.trials();
        let at = self.done.iter().position(|d| d.0 == key);
        if at.is_none() {
            let run = case.run(self.context)?;
            let errors = self.errors(case, &run)?;
            self.done.push((key, run, errors));
        }
        let (_, run, errors) = &self.done[at.unwrap_or(self.done.len() - 1)];
        Ok((run, errors))
    }

    fn number(&mut self, case: &Case, share: f64) -> Result<f64, StudyError> {
        let (run, errors) = self.done(case)?;
        let of = |number: &dyn Fn(&Errors) -> f64| match (case.estimator, case.rms) {
            (Estimator::Bound, _) | (_, false) => quantile(errors.iter().map(number), share),
            (_, true) => rms(errors.iter().map(number)),
        };
        let printed = |axes| {
            let found = two_step_printed(&run.readings(), axes);
            found.map_or(f64::NAN, |p| p.mass())
        };
        let steps = || run.solved(&run.raws, case.known);
        let number = match case.quantity {
            Quantity::Mass => of(&|e| e[0]),
            Quantity::MassCentre => of(&|e| e[1]),
            Quantity::Tensor => of(&|e| e[2]),
            Quantity::Worst => of(&|e| largest(*e)),
            Quantity::Kilograms => steps().mass(),
            Quantity::PrintedInBody => printed(PrintedAxes::Body),
            Quantity::PrintedInN => printed(PrintedAxes::Inertial),
            Quantity::Condition => {
                let step = steps().angular.map(|s| s.singular[0] / s.singular[5]);
                step.filter(|c| *c < DETERMINED).unwrap_or(f64::INFINITY)
            }
        };
        Ok(case.scale * number)
    }

    fn table(&mut self, cases: &Cases, rows: &[toml::Table]) -> Result<Table, StudyError> {
        let mut table = Table::new(&cases.name, &cases.title, &cases.head);
        for row in rows {
            let words = Case::of(&[row])?.words;
            table.row(&words, []);
            let numbers = table.head.len().saturating_sub(words.split(" | ").count());
            for column in cases.columns.iter().take(numbers) {
                let case = Case::of(&[self.usual, &cases.case, column, row])?;
                let x = self.number(&case, 0.5)?;
                match &case.digits {
                    Some(digits) => table.with(x, Digits::named(digits)),
                    None => table.push(x),
                }
            }
        }
        Ok(table)
    }

    fn plot(&mut self, figure: &Drawn, study: &Study) -> Result<Plot, StudyError> {
        let (mut series, mut names) = (Vec::new(), Vec::new());
        for (colour, name) in figure.tables.iter().enumerate() {
            let cases = study.table(name)?;
            let column = &cases.columns[figure.column];
            let parts = |row| [self.usual, &cases.case, column, row];
            let rows = study.rows(cases)?.iter().map(|row| Case::of(&parts(row)));
            let rows: Vec<Case> = rows.collect::<Result<_, _>>()?;
            names = rows.iter().map(|c| c.words.clone()).collect();
            let place = |(k, case): (usize, &Case)| match figure.named {
                true => (k + 1) as f64,
                false => case.words.parse().unwrap_or(f64::NAN),
            };
            let x: Vec<f64> = rows.iter().enumerate().map(place).collect();
            let mut at = |share: f64| -> Result<Vec<f64>, StudyError> {
                rows.iter().map(|case| self.number(case, share)).collect()
            };
            let [low, middle, high] = [at(0.05)?, at(0.5)?, at(0.95)?];
            if rows.iter().all(|case| case.known) && low != high {
                series.push(Series::band("", colour, &x, &low, &high));
            }
            let curve = Series::new(&cases.curve, Mark::Line, colour, &x, &middle);
            series.push(curve);
        }
        Ok(Plot {
            log: true,
            names: if figure.named { names } else { Vec::new() },
            ..curves(&figure.title, &figure.x, &figure.y, series)
        })
    }
}

/// A case with scaled joint positions.
fn swung(case: &CaseText, factor: f64) -> CaseText {
    let line = |line: &str| {
        let list = line.strip_prefix("position_rad = [");
        let Some(list) = list.and_then(|l| l.strip_suffix("]")) else {
            return line.to_owned();
        };
        let angles = list.split(',').filter_map(|x| x.trim().parse::<f64>().ok());
        let angles: Vec<f64> = angles.map(|x| factor * x).collect();
        format!("position_rad = {angles:?}")
    };
    let lines: Vec<String> = case.text.lines().map(line).collect();
    CaseText {
        text: lines.join("\n"),
        ..case.clone()
    }
}

/// Tables, figures and statements of a study.
///
/// # Errors
/// A motion cannot be computed.
pub fn study(context: &Context, name: &str) -> Result<Findings, StudyError> {
    let file: File = toml::from_str(include_str!("cases.toml"))?;
    let study = file.study.get(name).ok_or("no cases of this name")?;
    let run = Experiment::of(context, 1, [0.0, 0.0, 5.0])?.run()?;
    let mut engine = Engine {
        context,
        usual: &file.usual,
        fixed: run.equal_sigma(0.01),
        done: Vec::new(),
    };
    let mut findings = Findings::default();
    for cases in &study.table {
        let table = engine.table(cases, study.rows(cases)?)?;
        findings.tables.push(table);
    }
    for figure in &study.figure {
        let plot = engine.plot(figure, study)?;
        findings.plot(&figure.name, plot);
    }
    let statements: Vec<&str> = study.statements.iter().map(String::as_str).collect();
    Ok(findings.say(&statements))
}
