//! Flexible modes that the data show although the model declares none.
//!
//! Where the rigid model does not explain the data and no mistake does, the fit goes on with a mode started where the residual has
//! one (`diagnosis/oscillation.rs`), and with further ones as long as each lowers chi-square by more than its numbers can by
//! chance; then with the slopes of their inertia. What comes out is an answer where it passes every test of one.

use super::maximum_likelihood::{FinishedFit, LinearStart, solve};
use super::other_minima::{EVIDENCE, SUSPICIOUS};
use crate::answer;
use crate::diagnosis::octaves::consistent;
use crate::diagnosis::oscillation::{Oscillation, oscillation};
use crate::diagnosis::{Suspect, chi_square};
use crate::fit::experiment::Experiment;
use crate::fit::momentum_state::fit_near;
use crate::fit::{Fitted, step::ITERATIONS};
use crate::problem::alternative::BetweenSamples;
use crate::problem::loss::Loss;
use crate::problem::parameters::Parameters;
use crate::problem::settings::{Modes, Settings};
use crate::problem::{Problem, ProblemError};
use crate::solution::estimate::{Estimate, Number, SegmentFit};
use crate::solution::evidence::{Effect, Remark};
use nalgebra::SymmetricEigen;
use poinsot_dynamics::propagation::{MOST_MODES, ModeNumber};
use poinsot_dynamics::{Kinematics, composite};
use poinsot_files::counted;
use poinsot_model::{FlexibleMode, Mode, ModeEstimate, Model};
use poinsot_spatial::{Matrix3, TENSOR, Vector3};

/// Numbers by which the answer of a mode to the motion differs from a wave of constant amplitude.
const ANSWERS: usize = 5;
/// Share of the inertia about its axis that a mode carries at the start of its fit, at least, at most, and where its answer to
/// the motion does not tell.
const LEAST_SHARE: f64 = 0.01;
const MOST_SHARE: f64 = 0.8;
const USUAL_SHARE: f64 = 0.1;
/// Least share of the excess of chi-square that a mode explains, and the largest one that all leave: a search that leads nowhere
/// ends soon.
const NOTABLE: f64 = 0.1;
/// Iterations with one more mode: a good start needs five to ten.
const REFITS: usize = 15;
/// Damping, in its sigmas, below which a mode is not told from a disturbance of constant amplitude.
const DAMPED: f64 = 3.0;

/// A vehicle with modes, and its fit.
struct Found {
    model: Model,
    fitted: Fitted,
    parameters: Parameters,
}

/// Identifies by maximum likelihood, started from the linear solution where there is one.
///
/// # Errors
/// The model or the data are not valid for the method. Undetermined numbers are an answer, not an error.
///
/// ```
#[doc = include_str!("../../doc/spun_box.txt")]
/// // A box whose wheel runs up about z; the gyro shows how the box answers.
/// let estimate = maximum_likelihood(&problem)?;
/// assert_eq!(estimate.status, Status::Partial);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn maximum_likelihood(problem: &Problem) -> Result<Estimate, ProblemError> {
    maximum_likelihood_with(problem, Loss::Gaussian)
}

/// The same with other settings; a [`Loss`] alone bounds what a few bad samples can do.
///
/// # Errors
/// As [`maximum_likelihood`], or a setting is out of its range.
///
/// ```
#[doc = include_str!("../../doc/spun_box.txt")]
/// // A box whose wheel runs up about z; the gyro shows how the box answers.
/// // A robust loss, with the default of every other setting.
/// let estimate = maximum_likelihood_with(&problem, Loss::from_name("huber").unwrap())?;
/// assert_eq!(estimate.status, Status::Partial);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn maximum_likelihood_with(
    problem: &Problem,
    settings: impl Into<Settings>,
) -> Result<Estimate, ProblemError> {
    let explained = explained(problem, settings.into())?;
    let own = explained.problem(problem);
    Ok(answer::write(&own, &explained.ended.solution))
}

/// A solved problem, of the vehicle that explains the data.
pub(crate) struct Explained {
    pub ended: FinishedFit,
    /// The model with the modes that the data show, where they show any.
    model: Option<Model>,
}

impl Explained {
    /// The problem that is solved.
    pub fn problem<'a>(&'a self, asked: &Problem<'a>) -> Problem<'a> {
        asked.with_model(self.model.as_ref().unwrap_or(asked.model))
    }
}

/// Solves a problem, with the modes that the data show where the declared vehicle does not explain them.
pub(crate) fn explained(problem: &Problem, settings: Settings) -> Result<Explained, ProblemError> {
    let rigid = solve(problem, settings, None)?;
    let flexible = with_modes(problem, settings, &rigid)?;
    Ok(flexible.unwrap_or(Explained {
        ended: rigid,
        model: None,
    }))
}

/// `None` where the rigid solution stays.
fn with_modes(
    problem: &Problem,
    settings: Settings,
    rigid: &FinishedFit,
) -> Result<Option<Explained>, ProblemError> {
    if !is_asked(problem, settings, rigid) {
        return Ok(None);
    }
    let search = Search::new(problem, settings, rigid);
    let Some(mut found) = search.run(rigid)? else {
        return Ok(None);
    };
    // What stands as nominal is about where the search ended.
    let modes = found.modes();
    for (own, mode) in found.model.modes.iter_mut().zip(&modes) {
        for number in ModeNumber::groups().into_iter().flatten() {
            own.mode.set(*number, about(mode.get(*number)));
        }
    }
    let own = problem.with_model(&found.model);
    let mut ended = solve(&own, settings, Some(found.fitted.at))?;
    let before = rigid.solution.residual.0;
    ended.solution.remarks.push(evidence(&own, before, &ended));
    let estimate = answer::write(&own, &ended.solution);
    // Torque at random explains a mode too, with wrong numbers: the more probable of the two is the answer.
    if estimate.is_doubted() || ended.cost >= rigid.cost {
        return Ok(None);
    }
    ended.solution.remarks.extend(undamped(&own, &estimate));
    Ok(Some(Explained {
        ended,
        model: Some(found.model),
    }))
}

/// Whether modes may explain the data: the rigid fit leaves a residual that is hardly by chance, or torque at random alone explains it,
/// and no other cause does.
fn is_asked(problem: &Problem, settings: Settings, rigid: &FinishedFit) -> bool {
    let Some(own) = rigid.solution.likelihood.as_ref() else {
        return false;
    };
    let found = &own.diagnostics;
    let excess = (found.chi2 - found.dof as f64).max(EVIDENCE);
    let explained = |s: &Suspect| excess - s.decrease < NOTABLE * excess;
    // A mode adds power at its frequency: what is less than declared shows none.
    let powerful = |fit: &SegmentFit| {
        let mut p = fit.channels.iter().filter_map(|c| c.power_p);
        p.any(|p| p < SUSPICIOUS)
    };
    let is_open = rigid.plain.chance < SUSPICIOUS || rigid.solution.fit.iter().any(powerful);
    settings.modes == Modes::Found
        && !settings.undiagnosed
        && problem.internal_states() == 0
        && !problem.sees_points()
        && own.found
        && is_open
        && !found.suspects.first().is_some_and(explained)
}

/// A mode that a residual shows.
struct Seen {
    mode: FlexibleMode,
    of: Oscillation,
}

/// The search for modes of a vehicle.
struct Search<'a> {
    /// With the records as the rigid fit with the plain motion of the wheels took them.
    problem: Problem<'a>,
    settings: Settings,
    wheels: BetweenSamples,
}

impl<'a> Search<'a> {
    fn new(problem: &Problem<'a>, settings: Settings, rigid: &'a FinishedFit) -> Self {
        let taken = rigid.segments.as_deref();
        let taken = taken.filter(|_| !rigid.plain.replaced);
        Self {
            problem: problem.with_segments(taken.unwrap_or(problem.segments)),
            settings,
            wheels: rigid.plain.wheels,
        }
    }

    fn experiment<'b>(
        &self,
        problem: &'b Problem<'b>,
        parameters: &'b Parameters,
    ) -> Experiment<'b> {
        let mut experiment = Experiment::new(problem, parameters);
        (experiment.settings, experiment.wheels) = (self.settings, self.wheels);
        experiment
    }

    fn explains(&self, found: &Found) -> bool {
        consistent(&found.fitted.evaluated, &self.settings)
    }

    /// Adds modes one by one, and their slopes.
    fn run(&self, rigid: &FinishedFit) -> Result<Option<Found>, ProblemError> {
        let parameters = rigid.solution.parameters.clone();
        let experiment = self.experiment(&self.problem, &parameters);
        let Some(start) = fit_near(&experiment, rigid.at.clone(), ITERATIONS) else {
            return Ok(None);
        };
        let rigid_excess = excess(&start);
        let mut now = Found {
            model: self.problem.model.clone(),
            fitted: start,
            parameters,
        };
        while now.model.modes.is_empty() || !self.explains(&now) {
            match self.better(&now)? {
                Some(next) => now = next,
                None => break,
            }
        }
        if now.model.modes.is_empty() {
            return Ok(None);
        }
        if let Some(next) = self.with_slopes(&now)? {
            now = next;
        }
        let left = excess(&now.fitted) < NOTABLE * rigid_excess;
        Ok((left || self.explains(&now)).then_some(now))
    }

    /// One more mode, or the slopes of those that are there, whichever explains more.
    fn better(&self, now: &Found) -> Result<Option<Found>, ProblemError> {
        let seen = self.seen_mode(now);
        if let Some(next) = self.with_slopes(now)?
            && next.lowers(now) > seen.as_ref().map_or(0.0, |s| s.of.decrease)
        {
            return Ok(Some(next));
        }
        let Some(seen) = seen else {
            return Ok(None);
        };
        let mut model = now.model.clone();
        model.modes.push(seen.mode);
        let next = self.refitted(now, model)?;
        let is_mode =
            |next: &Found| next.fitted.is_found() && self.is_mode(next.lowers(now), seen.of.steady);
        Ok(next.filter(is_mode))
    }

    /// With the slopes of the modes, where they are not there and explain more than chance does.
    fn with_slopes(&self, now: &Found) -> Result<Option<Found>, ProblemError> {
        let mut model = now.model.clone();
        let open = model.modes.iter_mut().filter(|m| !m.estimate.inertia_slope);
        let new = open.map(|mode| mode.estimate.inertia_slope = true).count();
        if new == 0 {
            return Ok(None);
        }
        let next = self.refitted(now, model)?;
        let by_chance = self.by_chance(TENSOR.len() * new);
        Ok(next.filter(|next| next.lowers(now) > by_chance))
    }

    /// How much so many numbers more lower chi-square by chance.
    fn by_chance(&self, numbers: usize) -> f64 {
        chi_square(numbers, 1.0 - self.settings.false_alarm)
    }

    /// Fits a vehicle with other modes from where the last fit ended.
    fn refitted(&self, last: &Found, mut model: Model) -> Result<Option<Found>, ProblemError> {
        for (own, mode) in model.modes.iter_mut().zip(last.modes()) {
            own.mode = mode;
        }
        let own = self.problem.with_model(&model);
        let parameters = LinearStart::new(&own)?.parameters;
        let experiment = self.experiment(&own, &parameters);
        let mut at = experiment.nominal_point();
        for (x, unknown) in at.x.iter_mut().zip(&parameters.unknowns) {
            if let Some(place) = last.parameters.place(&unknown.kind) {
                *x = last.fitted.at.x[place];
            }
        }
        let known = 2 * last.model.modes.len();
        let starts = at
            .initial_states
            .iter_mut()
            .zip(&last.fitted.at.initial_states);
        for ((to, from), segment) in starts.zip(own.segments) {
            let fresh = experiment.measured_initial_state(segment, &at.x).internal;
            (*to, to.internal) = (*from, fresh);
            let old = to.internal.iter_mut().zip(&from.internal).take(known);
            old.for_each(|(to, from)| *to = *from);
        }
        let fitted = fit_near(&experiment, at, REFITS);
        Ok(fitted.map(|fitted| Found {
            fitted,
            parameters,
            model,
        }))
    }

    /// Whether a mode explains this decrease of chi-square, and a wave of constant amplitude so much less.
    fn is_mode(&self, decrease: f64, steady: f64) -> bool {
        decrease > EVIDENCE && decrease - steady > self.by_chance(ANSWERS).max(NOTABLE * steady)
    }

    /// The mode that the residual shows, as far as it does.
    fn seen_mode(&self, now: &Found) -> Option<Seen> {
        if now.model.modes.len() == MOST_MODES {
            return None;
        }
        let own = self.problem.with_model(&now.model);
        let experiment = self.experiment(&own, &now.parameters);
        let seen = oscillation(&experiment, &now.fitted.evaluated)?;
        let excess = excess(&now.fitted).max(0.0);
        if seen.decrease < EVIDENCE.max(seen.steady).max(NOTABLE * excess) {
            return None;
        }
        let bodies = now.parameters.bodies(&now.fitted.at.x);
        let J = composite(&bodies, &Kinematics::new(own.tree)).I_SScm_B();
        let (d, share) = participation(&seen, &J)?;
        let every = ModeEstimate {
            frequency: true,
            damping: true,
            rotation: true,
            ..ModeEstimate::default()
        };
        let mode = FlexibleMode {
            name: format!("mode{}", now.model.modes.len() + 1),
            mode: Mode {
                body: 0,
                frequency_Hz: seen.frequency_Hz * (1.0 - share).sqrt(),
                damping_ratio: seen.damping_ratio,
                translation: Vector3::zeros(),
                rotation: d,
                inertia_slope: Matrix3::zeros(),
            },
            estimate: every,
        };
        Some(Seen { mode, of: seen })
    }
}

/// Chi-square beyond its expectation.
fn excess(fitted: &Fitted) -> f64 {
    fitted.chi2() - fitted.rows() as f64
}

impl Found {
    /// The modes where the fit ended.
    fn modes(&self) -> Vec<Mode> {
        self.parameters.modes_at(&self.fitted.at.x)
    }

    /// How much lower chi-square is than that of another.
    fn lowers(&self, other: &Self) -> f64 {
        other.fitted.chi2() - self.fitted.chi2()
    }
}

/// `d` of a mode about the mass centre, by its answer to the motion or along the axis of its free oscillation, and the share of the
/// inertia that it carries.
fn participation(seen: &Oscillation, J: &Matrix3) -> Option<(Vector3, f64)> {
    let outer = J * seen.driven;
    let (moment, axis) = largest((outer + outer.transpose()) * 0.5);
    let inverse = J.try_inverse()?;
    let carries = |d: &Vector3, share: f64| (d * (share / d.dot(&(inverse * d))).sqrt(), share);
    // s / (1 - s).
    let carried = moment * axis.dot(&(inverse * axis));
    if carried > LEAST_SHARE {
        return Some(carries(&axis, (carried / (1.0 + carried)).min(MOST_SHARE)));
    }
    Some(carries(&(J * largest(seen.free).1), USUAL_SHARE))
}

/// Two significant figures.
fn about(x: f64) -> f64 {
    format!("{x:.1e}").parse().unwrap_or(x)
}

/// The largest eigenvalue of a symmetric matrix, and its axis.
fn largest(matrix: Matrix3) -> (f64, Vector3) {
    let eigen = SymmetricEigen::new(matrix);
    let at = eigen.eigenvalues.imax();
    (eigen.eigenvalues[at], eigen.eigenvectors.column(at).into())
}

/// What the modes explain.
fn evidence(problem: &Problem, before: f64, ended: &FinishedFit) -> Remark {
    let solution = &ended.solution;
    let modes = solution.parameters.modes_at(&solution.x);
    let each = |m: &Mode| {
        let damping = 100.0 * m.damping_ratio.max(0.0);
        format!("{:.3} Hz ({damping:.1} % damping)", m.frequency_Hz)
    };
    let list: Vec<String> = modes.iter().map(each).collect();
    let count = counted(problem.model.modes.len(), "flexible mode");
    let words = format!("with {count} found in the data: {}", list.join(", "));
    let decrease = before - solution.residual.0;
    Remark::test("flexible modes", Effect::None, words)
        .statistic("decrease of chi-square", decrease)
}

/// Modes whose damping the data do not tell from none.
fn undamped(problem: &Problem, estimate: &Estimate) -> Vec<Remark> {
    let number = |name: String| estimate.nuisance.iter().find(|n| n.name == name);
    let damped = |n: &Number| matches!((n.value, n.sigma), (Some(v), Some(s)) if v > DAMPED * s);
    let modes = problem.model.modes.iter();
    let open = modes.filter(|m| {
        let own = number(format!("{}.damping_ratio", m.name));
        !own.is_some_and(|n| damped(&n.number))
    });
    let words = |m: &FlexibleMode| {
        format!(
            "{} cannot be distinguished from a disturbance of constant amplitude: its damping is not determined",
            m.name
        )
    };
    open.map(|m| {
        Remark::test(
            format!("damping of {}", m.name),
            Effect::AgainstAnswer,
            words(m),
        )
    })
    .collect()
}
