//! The linear rung: measured velocities in the momentum regressor, one least-squares problem.
//!
//! Unknown are the mass properties asked for and the initial momentum of every segment. Exact on
//! noise-free data; on noisy data the noise that sits in the regressor biases it, which is estimated and
//! added to the sigmas. Rows are whitened with the declared noise at the nominal parameters (one step of
//! generalised least squares), so the triangular factor is the square root of the information.

use crate::answer;
use crate::block_qr::{BlockQr, Triangle};
use crate::estimate::Estimate;
use crate::impulse;
use crate::parameters::{Equations, Parameters, ParametersError, UnknownKind};
use crate::rows::{RowSetting, Rows, StartMomentum};
use crate::segment::{Noise, Segment};
use crate::spectrum::{NotFinite, Spectrum};
use faer::Mat;
use poinsot_dynamics::{Kinematics, Tree, composite};
use poinsot_model::{Model, MomentumKnowledge};
use poinsot_spatial::Vector3;
use rayon::prelude::*;

/// Samples that one task turns into a triangle; fixed, so that the sum does not depend on the threads.
const CHUNK: usize = 1024;
/// Chunks in flight: bounds the memory.
const WAVE: usize = 32;
/// Samples per segment at which the noise of the regressor is evaluated.
const NOISE_SAMPLES: usize = 150;

/// The question.
pub struct LinearProblem<'a> {
    /// Vehicle with nominal numbers.
    pub model: &'a Model,
    /// Its kinematics.
    pub tree: &'a Tree,
    /// Data.
    pub segments: &'a [Segment],
    /// Declared noise.
    pub noise: &'a Noise,
    /// One-sigma accuracy in natural units that counts as identified (CONTRACT: 1.0).
    pub relative_accuracy: f64,
}

/// Why the linear problem has no answer.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum LinearError {
    /// The question cannot be put.
    #[error(transparent)]
    Parameters(#[from] ParametersError),
    /// The numbers overflow.
    #[error(transparent)]
    NotFinite(#[from] NotFinite),
    /// Fewer equations than unknowns.
    #[error(
        "E0404 segment '{label}': {samples} samples are not enough; {needed} are needed for {unknowns} unknowns"
    )]
    TooFewSamples {
        /// Segment.
        label: String,
        /// Samples found.
        samples: usize,
        /// Samples needed.
        needed: usize,
        /// Unknowns.
        unknowns: usize,
    },
}

/// One segment reduced: its momentum rows and what is left for the shared unknowns.
pub(crate) struct Reduced {
    /// Triangle of `[momentum | unknowns | rhs]`.
    pub triangle: Triangle,
    /// What was assumed of its momentum.
    pub start: StartMomentum,
}

/// The solved system, before it is put into words.
pub(crate) struct Solved {
    pub parameters: Parameters,
    pub reduced: Vec<Reduced>,
    /// Triangle of the shared unknowns: nuisances first, then mass properties, right-hand side last.
    pub shared: Mat<f64>,
    /// Number of nuisance columns in front.
    pub nuisances: usize,
    pub spectrum: Spectrum,
    /// Values of all unknowns in the order of `parameters`.
    pub x: Vec<f64>,
    /// Residual sum of squares of the whitened rows and degrees of freedom.
    pub residual: (f64, usize),
    /// Share of the right-hand side that the model explains; `None` where there is none.
    pub explained: Option<f64>,
}

/// Identifies by linear least squares.
///
/// # Errors
/// The question cannot be asked. What the data leave open is an answer, not an error.
pub fn linear(problem: &LinearProblem) -> Result<Estimate, LinearError> {
    let first = solve(problem, None)?;
    let known_spin_needed = needs_mass_centre(problem);
    let solved = if known_spin_needed {
        refine_known_momentum(problem, first)?
    } else {
        first
    };
    Ok(answer::write(problem, &solved))
}

/// Whether the angular momentum about the mass centre is known while the vehicle drifts: its moment
/// about the inertial origin then holds the unknown mass centre.
fn needs_mass_centre(problem: &LinearProblem) -> bool {
    matches!(
        (problem.model.momentum.linear, problem.model.momentum.angular),
        (MomentumKnowledge::Known(P), MomentumKnowledge::Known(_)) if P != Vector3::zeros()
    ) && equations(problem) == Equations::Momentum
}

/// Fixed point on the mass centre: `H0 = h_cm + p_cm x P0`.
fn refine_known_momentum(
    problem: &LinearProblem,
    mut solved: Solved,
) -> Result<Solved, LinearError> {
    for _ in 0..4 {
        let bodies = solved.parameters.bodies(&solved.x);
        let centres: Vec<Vector3> = problem
            .segments
            .iter()
            .map(|segment| {
                let mut kinematics = Kinematics::new(problem.tree);
                let dof = problem.tree.dof();
                let s = &segment.samples;
                kinematics.place(problem.tree, s.joint_position.get(..dof).unwrap_or(&[]));
                let c = composite(&bodies, &kinematics).p_BoScm_B();
                s.R_NB.first().map_or(c, |R| R * c)
            })
            .collect();
        solved = solve(problem, Some(&centres))?;
    }
    Ok(solved)
}

pub(crate) fn equations(problem: &LinearProblem) -> Equations {
    let seen = problem
        .segments
        .iter()
        .all(|s| s.samples.translation.is_some());
    if seen {
        Equations::Momentum
    } else {
        Equations::Rotation
    }
}

fn solve(problem: &LinearProblem, centres: Option<&[Vector3]>) -> Result<Solved, LinearError> {
    let equations = equations(problem);
    let fires = problem.segments.iter().any(|s| !s.firings.is_empty());
    let parameters = Parameters::new(problem.model, problem.tree, equations, fires)?;
    let wheels = &problem.model.wheels;
    let nominal_spin: Vec<f64> = wheels.iter().map(|w| w.spin_inertia).collect();
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
        if samples < 2 {
            return Err(LinearError::TooFewSamples {
                label: segment.label.clone(),
                samples,
                needed: 2,
                unknowns: n + start.columns(),
            });
        }
        let triangle = reduce(&setting, problem, segment, start, &mut noise);
        let m = start.columns();
        let tail = triangle.r.nrows() - m;
        stacked.push(tail, |i, j| triangle.r[(m + i, m + j)]);
        rows += match equations {
            Equations::Momentum => 6 * samples,
            Equations::Rotation => 3 * samples,
        } - m;
        reduced.push(Reduced { triangle, start });
    }
    conclude(problem, parameters, reduced, stacked.finish(), noise, rows)
}

fn start_momentum(
    problem: &LinearProblem,
    equations: Equations,
    centre: Option<Vector3>,
) -> StartMomentum {
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
    StartMomentum { linear, angular }
}

/// QR of the rows of one segment: chunks side by side, folded in their order.
fn reduce(
    setting: &RowSetting,
    problem: &LinearProblem,
    segment: &Segment,
    start: StartMomentum,
    noise: &mut [f64],
) -> Triangle {
    let impulses = impulse::integrate(setting.tree, &problem.model.thrusters, segment);
    let samples = segment.samples.time_s.len();
    let width = start.columns() + setting.parameters.len() + 1;
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
                for k in from..to {
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
    problem: &LinearProblem,
    parameters: Parameters,
    reduced: Vec<Reduced>,
    stacked: Triangle,
    noise: Vec<f64>,
    rows: usize,
) -> Result<Solved, LinearError> {
    let n = parameters.len();
    // Biases are projected out: their columns go first.
    let is_bias = |k: &usize| matches!(parameters.unknowns[*k].kind, UnknownKind::GyroBias(_));
    let (front, back): (Vec<usize>, Vec<usize>) = (0..n).partition(is_bias);
    let nuisances = front.len();
    let order: Vec<usize> = front.iter().chain(&back).copied().collect();
    let mut permuted = BlockQr::new(n + 1);
    permuted.push(n + 1, |i, j| {
        let column = order.get(j).copied().unwrap_or(n);
        stacked.r[(i, column)]
    });
    let shared = permuted.finish().r;
    let m = back.len();
    let block = Mat::from_fn(m, m, |i, j| shared[(nuisances + i, nuisances + j)]);
    let natural: Vec<f64> = back
        .iter()
        .map(|&k| parameters.unknowns[k].natural)
        .collect();
    let block_noise: Vec<f64> = back
        .iter()
        .flat_map(|&i| back.iter().map(move |&j| (i, j)))
        .map(|(i, j)| noise[i * n + j])
        .collect();
    let mut spectrum = Spectrum::new(&block, &natural, &block_noise, problem.relative_accuracy)?;
    let nominal: Vec<f64> = back
        .iter()
        .map(|&k| parameters.unknowns[k].nominal)
        .collect();
    let rhs: Vec<f64> = (0..m)
        .map(|i| {
            let predicted: f64 = (0..m).map(|j| block[(i, j)] * nominal[j]).sum();
            shared[(nuisances + i, n)] - predicted
        })
        .collect();
    let step = spectrum.solve(&rhs);
    let mut x = parameters.nominal_vector();
    for ((&k, dz), unit) in back.iter().zip(&step).zip(&natural) {
        x[k] += dz * unit;
    }
    let z: Vec<f64> = back
        .iter()
        .zip(&natural)
        .map(|(&k, unit)| x[k] / unit)
        .collect();
    spectrum.set_bias(&block_noise, &z);
    back_substitute(&shared, &front, &back, &mut x);
    let left: f64 = (0..m)
        .map(|i| {
            let predicted: f64 = back
                .iter()
                .enumerate()
                .map(|(j, &k)| block[(i, j)] * x[k])
                .sum();
            (shared[(nuisances + i, n)] - predicted).powi(2)
        })
        .sum::<f64>()
        + shared[(n, n)].powi(2);
    let whole: f64 = (nuisances..=n).map(|i| shared[(i, n)].powi(2)).sum();
    let dof = rows.saturating_sub(spectrum.rank + nuisances);
    Ok(Solved {
        explained: (whole > 1.0e-20).then(|| 1.0 - left / whole),
        parameters,
        reduced,
        shared,
        nuisances,
        spectrum,
        x,
        residual: (left, dof),
    })
}

/// Nuisances from the head of the triangle; one without any signal stays at its nominal value.
fn back_substitute(shared: &Mat<f64>, front: &[usize], back: &[usize], x: &mut [f64]) {
    let p = front.len();
    let n = p + back.len();
    for i in (0..p).rev() {
        let mut left = shared[(i, n)];
        for (j, &k) in front.iter().enumerate().skip(i + 1) {
            left -= shared[(i, j)] * x[k];
        }
        for (j, &k) in back.iter().enumerate() {
            left -= shared[(i, p + j)] * x[k];
        }
        let pivot = shared[(i, i)];
        if pivot.abs() > f64::MIN_POSITIVE {
            x[front[i]] = left / pivot;
        }
    }
}
