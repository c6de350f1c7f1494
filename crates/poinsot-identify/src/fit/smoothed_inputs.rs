//! Noisy inputs, smoothed by all sensors.
//!
//! Along measured inputs the columns hold the inputs' noise, and so does the residual `r = n - G e`: their product has a mean.
//! With S the covariance of the readings, it is half the slope of `ln det S`, and the fit ends `C b` from the truth with
//!
//! ```text
//! b = 1/2 d ln det S / dx
//! ```
//!
//! which grows with the root of the number of samples in units of sigma. About inputs `u` that all sensors smooth, with the
//! expected errors `u_measured - u` in the filter, a step is the one of Gauss and Newton for unknowns and inputs together, the
//! inputs eliminated: columns and residual have no noise in common. What is minimised is the sum of squares of readings and
//! inputs; a determinant would bring the bias back. Where the torque of a wheel or the acceleration of a joint is a process, its
//! motion has a proper law, the mean of its samples' posterior drives, and nothing has to be smoothed: the error is independent of that mean.

use crate::fit::experiment::{Experiment, Iterate};
use crate::fit::part_of_record::beginning;
use crate::fit::step::ITERATIONS;
use crate::fit::{Fitted, fit_on};
use crate::likelihood::{Evaluated, InitialState};
use crate::motion::{Motion, tilted};
use crate::problem::segment::{InputErrors, Segment};
use poinsot_solve::{LeastSquares, Spectrum};
use poinsot_spatial::Vector6;

/// Bias, and distance that is left, that do not matter in any number, sigmas.
const SMALL: f64 = 0.05;
/// Sigma, in natural units, up to which the predictions are linear in a direction: the bias of a weaker one is no number, and
/// a fit about inputs that follow it leads anywhere along it.
const LINEAR: f64 = 0.25;
/// Most times that the inputs are smoothed: each time what is left falls to a tenth and less.
const ROUNDS: usize = 8;
/// Grid times at which the effect of the inputs is looked at.
const PLACES: usize = 12;
/// Change of an unknown for a slope, natural units.
const DIFFERENCE: f64 = 1.0e-4;

/// A fit about smoothed inputs.
pub(crate) struct SmoothedInputs {
    pub segments: Vec<Segment>,
    pub fitted: Fitted,
}

impl SmoothedInputs {
    /// From a fit along measured inputs; `None` where its bias is small in what the data determine well.
    pub fn new(experiment: &Experiment, fitted: &Fitted) -> Option<Self> {
        if !is_biased(experiment, fitted)? {
            return None;
        }
        let segments = experiment.problem.segments;
        let segments = smoothed(experiment, segments, &fitted.at, 1.0)?;
        let mut found = Self::about(experiment, fitted.at.clone(), segments)?;
        found.fitted.iterations += fitted.iterations;
        Some(found)
    }

    /// From a point, about inputs that are smoothed there.
    pub fn about(
        experiment: &Experiment,
        mut at: Iterate,
        mut segments: Vec<Segment>,
    ) -> Option<Self> {
        let mut iterations = 0;
        for round in 1..=ROUNDS {
            let problem = experiment.problem.with_segments(&segments);
            let about = experiment.of_vehicle(&problem, experiment.parameters);
            let here = about.linearise(&at)?;
            let told = judged(experiment, &here.rows.spectrum);
            let mut fitted = fit_on(&about, at.clone(), here, ITERATIONS)?;
            let near = moved(&told, (&at.x, &fitted.at.x)) < SMALL;
            iterations += fitted.iterations;
            fitted.iterations = iterations;
            if near || round == ROUNDS {
                fitted.converged &= near;
                return Some(Self { segments, fitted });
            }
            at = fitted.at;
            segments = smoothed(experiment, &segments, &at, 1.0)?;
        }
        None
    }
}

/// Whether noise of inputs biases what the data determine well; `None` without noise.
pub(super) fn is_biased(experiment: &Experiment, fitted: &Fitted) -> Option<bool> {
    let told = judged(experiment, &fitted.spectrum);
    Some(bias(experiment, &fitted.at, (&fitted.evaluated, &told))? >= SMALL)
}

/// What the data determine well, where predictions are linear.
fn judged(experiment: &Experiment, spectrum: &Spectrum) -> Spectrum {
    let accuracy = experiment.problem.relative_accuracy.min(LINEAR);
    spectrum.clone().judged(accuracy)
}

/// How far a fit has moved what the data determine, sigmas; at the limit of physical bodies less than its full step would.
fn moved(told: &Spectrum, (from, to): (&[f64], &[f64])) -> f64 {
    let changes = told.natural.iter().zip(from.iter().zip(to));
    let changes: Vec<f64> = changes.map(|(unit, (a, b))| (b - a) / unit).collect();
    let along = |k: usize| (told.along(&changes, k) * told.singular[k]).powi(2);
    (0..told.accurate).map(along).sum::<f64>().sqrt()
}

/// Records about inputs that the samples of their beginning, this share, smooth at a point.
pub(super) fn smoothed(
    experiment: &Experiment,
    segments: &[Segment],
    at: &Iterate,
    share: f64,
) -> Option<Vec<Segment>> {
    let part: Vec<Segment> = segments.iter().map(|s| beginning(s, share)).collect();
    let problem = experiment.problem.with_segments(&part);
    let mut recorded = match share < 1.0 {
        true => experiment.with_problem(&problem),
        false => experiment.of_vehicle(&problem, experiment.parameters),
    };
    recorded.smooth_inputs = true;
    let evaluated = recorded.evaluate(at, false)?;
    let whole = segments.iter().zip(evaluated);
    let about = whole.map(|(s, begun)| Some(s.about_inputs_of(&begun.smoothed?)));
    about.collect()
}

/// Largest bias of a number of the answer, sigmas: `|C^(1/2) b|`.
///
/// If all inputs' noise grows by a factor, `ln det S` grows by at most the sum of the inputs' shares of the innovations'
/// covariance. It does so where the effect of the inputs' noise on the base's velocity grows by that factor, as by a smaller inertia.
fn bias(
    experiment: &Experiment,
    at: &Iterate,
    (evaluated, spectrum): (&[Evaluated], &Spectrum),
) -> Option<f64> {
    let share: f64 = evaluated.iter().map(|e| e.input_share).sum();
    let size = |x: &[f64]| effect(experiment, x, &at.initial_states);
    let x = &at.x;
    if share == 0.0 || size(x)? == 0.0 {
        return None;
    }
    let slope = |(j, unit): (usize, &f64)| {
        let ends = [DIFFERENCE, -DIFFERENCE].map(|d| {
            let mut moved = x.clone();
            moved[j] += d * unit;
            size(&moved)
        });
        let [a, b] = ends;
        // The effect is a mean square.
        Some(0.5 * share * (a?.ln() - b?.ln()) / (2.0 * DIFFERENCE))
    };
    let slopes = spectrum.natural.iter().enumerate().map(slope);
    let b: Vec<f64> = slopes.collect::<Option<_>>()?;
    let squares =
        (0..spectrum.accurate).map(|k| (spectrum.along(&b, k) / spectrum.singular[k]).powi(2));
    Some(squares.sum::<f64>().sqrt())
}

/// Mean square of the change of the base's velocity by the noise of free inputs, at some times; `None` where the vehicle
/// cannot move.
fn effect(experiment: &Experiment, x: &[f64], starts: &[InitialState]) -> Option<f64> {
    let (setting, mut sum) = (experiment.setting(), 0.0);
    let tree = tilted(setting.problem.tree, experiment.parameters, x);
    let square = |v: Vector6, length: f64| {
        v.fixed_rows::<3>(3).norm_squared() + v.fixed_rows::<3>(0).norm_squared() / length.powi(2)
    };
    for (index, segment) in setting.problem.segments.iter().enumerate() {
        let o = &segment.observations;
        let vehicle = setting.vehicle(&tree, (index, segment), x);
        let mut motion = Motion::new(&vehicle, segment, Vec::new(), 0);
        let length = motion.gyration;
        for k in (0..o.time_s.len()).step_by(o.time_s.len().div_ceil(PLACES).max(1)) {
            let (instant, _) = motion.velocity(&starts[index], k)?;
            for (w, variance) in setting.problem.noise.wheel_speed.iter().enumerate() {
                if !matches!(o.wheel(w).errors, InputErrors::Process(_)) {
                    sum += variance * square(motion.wheel_gain(&instant, w), length);
                }
            }
        }
    }
    Some(sum)
}
