//! The linear method: measured velocities in the momentum regressor, one least-squares problem.
//!
//! Unknown are the requested mass properties and the initial momentum of every segment. Exact on noise-free data; on
//! noisy data the noise that sits in the regressor biases it, which is estimated and added to the sigmas. Rows are
//! whitened with the declared noise at the nominal parameters (one step of generalised least squares), so the
//! triangular factor is the square root of the information.

use crate::answer;
use crate::certify::continuation::linear_set;
use crate::fit::experiment::Experiment;
use crate::fit::fit_near;
use crate::fit::triangle::{SharedTriangle, conditional_estimate, longest_column};
use crate::likelihood::impulse;
use crate::likelihood::rows::{RowSetting, Rows, start_columns};
use crate::methods::twist_residual;
use crate::problem::parameters::{Equations, Parameters};
use crate::problem::quantity::TenParameters;
use crate::problem::refusal::not_finite;
use crate::problem::segment::Segment;
use crate::problem::settings::Settings;
use crate::problem::{Problem, ProblemError};
use crate::solution::estimate::{Estimate, SegmentFit};
use crate::solution::evidence::Remark;
use crate::solution::solved::{Solution, StartOfSegment, VectorQuantity};
use crate::solution::unobservable_set::UnobservableSet;
use poinsot_dynamics::composite;
use poinsot_files::Pace;
use poinsot_model::{Momentum, MomentumKnowledge};
use poinsot_solve::{BlockQr, Spectrum, Triangle};
use poinsot_spatial::{Vector3, skew};
use rayon::prelude::*;

/// Samples that one task turns into a triangle; fixed, so that the sum does not depend on the threads.
const CHUNK: usize = 1024;
/// Steps towards the best fit before the certificate is taken.
const CERTIFICATE_STEPS: usize = 8;
/// Chunks in flight: bounds the memory.
const WAVE: usize = 32;
/// Samples per segment at which the noise of the regressor is evaluated.
const NOISE_SAMPLES: usize = 150;

/// Identifies by linear least squares.
///
/// # Errors
/// The model or the data are not valid for the method. Undetermined numbers are an answer, not an error.
///
/// ```
#[doc = include_str!("../../doc/spun_box.txt")]
/// // A box whose wheel runs up about z; the gyro shows how the box answers.
/// let estimate = poinsot_identify::linear(&problem)?;
/// // The wheel moves the box about z alone: three of six elements of the tensor are determined.
/// assert_eq!(estimate.identifiability.rank, 3);
/// let [.., I_zz] = estimate.bodies[0].inertia;
/// assert!((I_zz.value.unwrap() - 2.5).abs() < 1.0e-9);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn linear(problem: &Problem) -> Result<Estimate, ProblemError> {
    let mut found = Reduced::of(problem)?;
    let parameters = found.solution.parameters.clone();
    let experiment = Experiment::new(problem, &parameters);
    if experiment.has_design_prior() {
        found.solution.remarks.push(Remark::warning(
            "linear method: the declared priors are not used; maximum likelihood uses them",
        ));
    }
    // Identifiability is evaluated at a fitted motion: a few steps of maximum likelihood. Without samples at their own
    // times the rows' spectrum is used.
    let observed = problem.segments.iter().all(|s| problem.is_observed(s));
    let start = found.solution.point(&experiment);
    if observed && let Some(fitted) = fit_near(&experiment, start, CERTIFICATE_STEPS) {
        found.restrict(problem, &fitted.spectrum.judged(problem.largest_sigma()))?;
    }
    let mut solution = found.solution;
    solution.unobservable_set = linear_set(problem, &solution);
    Ok(answer::write(problem, &solution))
}

/// The numerical linear solution.
pub(crate) fn solve_linear(problem: &Problem) -> Result<Solution, ProblemError> {
    Ok(Reduced::of(problem)?.solution)
}

/// One segment reduced: its momentum rows and the rows of the shared unknowns.
struct ReducedSegment {
    /// Triangle of `[momentum | unknowns | rhs]`.
    triangle: Triangle,
    /// What was assumed of its momentum.
    start: Momentum,
}

/// A solution with what it was solved from.
struct Reduced {
    solution: Solution,
    segments: Vec<ReducedSegment>,
    /// Whitened rows, momentum taken off.
    rows: usize,
    /// `E[dA^T dA]` of the mass properties, row by row.
    regressor_noise: Vec<f64>,
}

impl Reduced {
    fn of(problem: &Problem) -> Result<Self, ProblemError> {
        problem.check_samples()?;
        let first = solve(problem, None)?;
        if needs_mass_centre(problem) {
            refine_known_momentum(problem, first)
        } else {
            Ok(first)
        }
    }

    /// Solves again within the directions that the experiment identifies: noise in the regressor can make
    /// others look determined.
    fn restrict(&mut self, problem: &Problem, experiment: &Spectrum) -> Result<(), ProblemError> {
        let block = self.solution.shared.block();
        self.solution.spectrum = Spectrum::within(&block, Some(&self.regressor_noise), experiment)
            .map_err(not_finite)?;
        self.settle(problem);
        Ok(())
    }

    /// Takes the numbers from the spectrum, and the segments from the numbers.
    fn settle(&mut self, problem: &Problem) {
        self.solution.settle(self.rows, &self.regressor_noise);
        let Solution { parameters, x, .. } = &self.solution;
        let (starts, fit) = segments(problem, parameters, &self.segments, x);
        (self.solution.starts, self.solution.fit) = (starts, fit);
    }
}

/// Whether the angular momentum about the mass centre is known while the vehicle drifts: its moment
/// about the inertial origin then holds the unknown mass centre.
fn needs_mass_centre(problem: &Problem) -> bool {
    matches!(
        (problem.model.momentum.linear, problem.model.momentum.angular),
        (MomentumKnowledge::Known(P), MomentumKnowledge::Known(_)) if P != Vector3::zeros()
    ) && problem.linear_equations() == Equations::Momentum
}

/// Fixed point on the mass centre: `H0 = h_cm + p_cm x P0`.
fn refine_known_momentum(problem: &Problem, mut found: Reduced) -> Result<Reduced, ProblemError> {
    for _ in 0..4 {
        let bodies = found.solution.parameters.bodies(&found.solution.x);
        let centres: Vec<Vector3> = problem
            .segments
            .iter()
            .map(|segment| {
                let s = &segment.samples;
                let kinematics = s.first_placement(problem.tree);
                let c = composite(&bodies, &kinematics).p_BoScm_B();
                s.R_NB.first().map_or(c, |R| R * c)
            })
            .collect();
        found = solve(problem, Some(&centres))?;
    }
    Ok(found)
}

fn solve(problem: &Problem, centres: Option<&[Vector3]>) -> Result<Reduced, ProblemError> {
    let equations = problem.linear_equations();
    let parameters = problem.parameters(equations)?;
    let wheels = &problem.model.wheels;
    let nominal_spin = problem.model.spin_inertias();
    let spin_inertia: Vec<f64> = wheels
        .iter()
        .map(|w| if w.estimate { 0.0 } else { w.spin_inertia })
        .collect();
    let setting = RowSetting {
        tree: problem.tree,
        parameters: &parameters,
        spin_inertia: &spin_inertia,
        nominal_spin: &nominal_spin,
        noise: problem.noise,
    };
    let n = parameters.len();
    let mut stacked = BlockQr::new(n + 1);
    let mut noise = vec![0.0; n * n];
    let mut reduced = Vec::with_capacity(problem.segments.len());
    let mut rows = 0;
    for (at, segment) in problem.segments.iter().enumerate() {
        let start = start_momentum(problem, equations, centres.map(|c| c[at]));
        let samples = segment.samples.time_s.len();
        let triangle = reduce(&setting, problem, segment, start, &mut noise);
        problem.pace.map_or(Ok(()), Pace::over)?;
        let m = start_columns(&start);
        let tail = triangle.r.nrows() - m;
        stacked.push(tail, |i, j| triangle.r[(m + i, m + j)]);
        rows += equations.rows() * samples - m;
        reduced.push(ReducedSegment { triangle, start });
    }
    conclude(
        problem,
        parameters,
        reduced,
        &stacked.finish(),
        &noise,
        rows,
    )
}

fn start_momentum(problem: &Problem, equations: Equations, centre: Option<Vector3>) -> Momentum {
    let given = problem.model.momentum;
    let linear = match equations {
        Equations::Momentum => given.linear,
        Equations::Rotation => MomentumKnowledge::Known(Vector3::zeros()),
    };
    let angular = match (given.angular, linear, centre) {
        (known @ MomentumKnowledge::Known(_), _, _) if equations == Equations::Rotation => known,
        (MomentumKnowledge::Known(h), MomentumKnowledge::Known(P), _) if P == Vector3::zeros() => {
            MomentumKnowledge::Known(h)
        }
        (MomentumKnowledge::Known(h), MomentumKnowledge::Known(P), Some(c)) => {
            MomentumKnowledge::Known(h + c.cross(&P))
        }
        _ => MomentumKnowledge::Estimate,
    };
    Momentum { linear, angular }
}

/// QR of the rows of one segment: chunks side by side, folded in their order. Where no time is left, they stay empty.
fn reduce(
    setting: &RowSetting,
    problem: &Problem,
    segment: &Segment,
    start: Momentum,
    noise: &mut [f64],
) -> Triangle {
    let impulses = impulse::thrust_impulses(setting.tree, &problem.model.thrusters, segment);
    let samples = segment.samples.time_s.len();
    let width = start_columns(&start) + setting.parameters.len() + 1;
    let chunks: Vec<(usize, usize)> = (0..samples)
        .step_by(CHUNK)
        .map(|from| (from, (from + CHUNK).min(samples)))
        .collect();
    let mut total = BlockQr::new(width);
    for wave in chunks.chunks(WAVE) {
        let triangles: Vec<Triangle> = wave
            .par_iter()
            .map(|&(from, to)| {
                let mut rows = Rows::new(setting, segment, &impulses, start);
                let mut qr = BlockQr::new(width);
                let has_time = problem.pace.is_none_or(|p| p.check(0, 0).is_ok());
                for k in (from..to).filter(|_| has_time) {
                    qr.push_six(rows.at(k));
                }
                qr.finish()
            })
            .collect();
        for triangle in &triangles {
            total.merge(triangle);
        }
    }
    let stride = samples.div_ceil(NOISE_SAMPLES).max(1);
    let picked: Vec<usize> = (0..samples).step_by(stride).collect();
    let weight = samples as f64 / picked.len() as f64;
    let mut rows = Rows::new(setting, segment, &impulses, start);
    for k in picked {
        rows.add_regressor_noise(k, weight, noise);
    }
    total.finish()
}

/// Spectrum and solution from the stacked triangle.
fn conclude(
    problem: &Problem,
    parameters: Parameters,
    segments: Vec<ReducedSegment>,
    stacked: &Triangle,
    noise: &[f64],
    rows: usize,
) -> Result<Reduced, ProblemError> {
    let n = parameters.len();
    let shared = SharedTriangle::new(&parameters, stacked);
    let m = shared.mass;
    let block = shared.block();
    let natural = parameters.natural_vector(m);
    let regressor_noise: Vec<f64> = (0..m)
        .flat_map(|i| (0..m).map(move |j| noise[i * n + j]))
        .collect();
    let heads = segments
        .iter()
        .map(|s| (&s.triangle, start_columns(&s.start)));
    let size = longest_column(&parameters, &heads.collect::<Vec<_>>());
    let accuracy = problem.relative_accuracy;
    let spectrum = Spectrum::new(&block, &natural, Some(&regressor_noise), size, accuracy)
        .map_err(not_finite)?
        .judged(problem.largest_sigma());
    let solution = Solution {
        method: "linear",
        x: parameters.nominal_vector(),
        parameters,
        shared,
        spectrum,
        explained: None,
        residual: (0.0, rows),
        starts: Vec::new(),
        fit: Vec::new(),
        unobservable_set: UnobservableSet::default(),
        remarks: Vec::new(),
        noise_accumulates: impulse::noise_accumulates(problem),
        settings: Settings::default(),
        likelihood: None,
    };
    let mut found = Reduced {
        solution,
        segments,
        rows,
        regressor_noise,
    };
    found.settle(problem);
    Ok(found)
}

impl Solution {
    /// Linear least squares on the shared triangle of so many rows: only identified directions leave the nominal values.
    fn settle(&mut self, rows: usize, regressor_noise: &[f64]) {
        let m = self.shared.mass;
        let block = self.shared.block();
        let rhs = self.shared.rhs();
        let along = |i: usize, x: &[f64]| (0..m).map(|j| block[(i, j)] * x[j]).sum::<f64>();
        let left_over = |x: &[f64]| -> Vec<f64> {
            let rows = rhs.iter().enumerate();
            rows.map(|(i, d)| d - along(i, x)).collect()
        };
        let mut x = self.parameters.nominal_vector();
        // The second pass takes off the round-off of the first.
        for _ in 0..2 {
            let step = self.spectrum.solve(&left_over(&x));
            for ((value, dz), unit) in x.iter_mut().zip(&step).zip(&self.spectrum.natural) {
                *value += dz * unit;
            }
        }
        let z = self.spectrum.in_natural_units(&x);
        self.spectrum.set_bias(regressor_noise, &z);
        let biases = self.shared.nuisances_for(&x[..m]);
        x[m..].copy_from_slice(&biases);
        let square = |v: &[f64]| v.iter().map(|e| e * e).sum::<f64>() + self.shared.unreachable();
        let (left, whole) = (square(&left_over(&x)), square(&rhs));
        self.explained = (whole > 1.0e-20).then(|| 1.0 - left / whole);
        let found = self.spectrum.rank + self.shared.nuisances;
        self.residual = (left, rows.saturating_sub(found));
        self.x = x;
    }
}

/// Momentum and fit of every segment at the answer.
fn segments(
    problem: &Problem,
    parameters: &Parameters,
    reduced: &[ReducedSegment],
    x: &[f64],
) -> (Vec<StartOfSegment>, Vec<SegmentFit>) {
    let spin = problem.model.spin_inertias();
    problem
        .segments
        .iter()
        .zip(reduced)
        .map(|(segment, reduced)| {
            let (start, values) = start_of(problem, parameters, segment, reduced, x);
            let of = (segment, problem.noise.gyro_sensor);
            let channels = twist_residual::twist(parameters, x, problem.tree, &spin, of, values);
            let fit = SegmentFit {
                label: segment.label.clone(),
                samples: segment.samples.time_s.len(),
                chi2_per_dof: segment_chi2(parameters, segment, reduced, x),
                channels,
            };
            (start, fit)
        })
        .unzip()
}

fn segment_chi2(
    parameters: &Parameters,
    segment: &Segment,
    reduced: &ReducedSegment,
    x: &[f64],
) -> f64 {
    let h = start_columns(&reduced.start);
    let n = parameters.len();
    let r = &reduced.triangle.r;
    let left: f64 = (h..r.nrows())
        .map(|i| {
            let predicted: f64 = (0..n).map(|j| r[(i, h + j)] * x[j]).sum();
            (r[(i, h + n)] - predicted).powi(2)
        })
        .sum();
    let rows = parameters.equations.rows() * segment.samples.time_s.len();
    left / rows.saturating_sub(h).max(1) as f64
}

/// Momentum of a segment, and its values about the inertial origin.
fn start_of(
    problem: &Problem,
    parameters: &Parameters,
    segment: &Segment,
    reduced: &ReducedSegment,
    x: &[f64],
) -> (StartOfSegment, (Vector3, Vector3)) {
    let start = &reduced.start;
    let conditional = conditional_estimate(&reduced.triangle.r, start_columns(start), x);
    let pick = |from: usize, known: MomentumKnowledge| match known {
        MomentumKnowledge::Known(value) => VectorQuantity::known(value, x.len()),
        MomentumKnowledge::Estimate => {
            let mean = &conditional.mean[from..from + 3];
            VectorQuantity::of_initial_state(&conditional, from, Vector3::from_row_slice(mean))
        }
    };
    let linear = pick(0, start.linear);
    let before = 3 * usize::from(start.linear == MomentumKnowledge::Estimate);
    let mut angular = pick(before, start.angular);
    let values = (linear.value, angular.value);
    let translation = parameters.equations == Equations::Momentum;
    if translation {
        about_mass_centre(problem, parameters, segment, x, &linear, &mut angular);
    }
    let mut given = problem.model.momentum;
    // What is known about the mass centre was carried to the inertial origin for the rows.
    if start.angular == MomentumKnowledge::Estimate {
        given.angular = MomentumKnowledge::Estimate;
    }
    let start = StartOfSegment {
        linear,
        angular,
        given,
        translation,
    };
    (start, values)
}

/// `h_cm = H - p_cm x P` with the mass centre a function of the unknowns.
fn about_mass_centre(
    problem: &Problem,
    parameters: &Parameters,
    segment: &Segment,
    x: &[f64],
    linear: &VectorQuantity,
    angular: &mut VectorQuantity,
) {
    let s = &segment.samples;
    let kinematics = s.first_placement(problem.tree);
    let ten = TenParameters::of_system(parameters, &kinematics, x);
    let centre = [0, 1, 2].map(|k| ten.mass_centre(k));
    let R = s.R_NB.first().copied().unwrap_or_default();
    let c = R * Vector3::from_fn(|k, _| centre[k].value);
    let P = linear.value;
    angular.value -= c.cross(&P);
    let cross = skew(&c);
    angular.own += cross * linear.own * cross.transpose();
    for u in 0..x.len() {
        let dP = Vector3::from_fn(|k, _| linear.gradient[k][u]);
        let dc = R * Vector3::from_fn(|k, _| centre[k].gradient[u]);
        let step = dc.cross(&P) + c.cross(&dP);
        for k in 0..3 {
            angular.gradient[k][u] -= step[k];
        }
    }
}
