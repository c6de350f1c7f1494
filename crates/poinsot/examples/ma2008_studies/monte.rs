//! Noisy trials of the two steps and of the linear rung on the same draws.

use crate::setup::{Experiment, Run, readings};
use poinsot_dynamics::Tree;
use poinsot_identify::methods::ma2008::{Known, Raw, Reading, two_step};
use poinsot_identify::{Estimate, LinearProblem, Noise, Samples, Segment, Translation, linear};
use poinsot_model::{Model, MomentumKnowledge};
use poinsot_spatial::{MassProperties, Matrix3, Vector3};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

/// One sigma of each velocity component: linear in N, m/s; angular in B, rad/s.
#[derive(Debug, Clone, Copy)]
pub struct Sigma {
    pub v: Vector3,
    pub w: Vector3,
}

/// How "a percentage of the maximum velocity value" is read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scaling {
    /// Of each component's own maximum.
    Component,
    /// Of the largest linear, and the largest angular, component.
    Largest,
}

impl Sigma {
    /// A share of the maxima of a run.
    pub fn of(run: &Run, share: f64, scaling: Scaling) -> Self {
        let most = |of: &dyn Fn(&Raw) -> Vector3| {
            run.raws.iter().fold(Vector3::zeros(), |m, r| {
                m.zip_map(&of(r), |a, b| a.max(b.abs()))
            })
        };
        let (mut v, mut w) = (most(&|r| r.v_NBo_N), most(&|r| r.w_NB_B));
        if scaling == Scaling::Largest {
            v = Vector3::repeat(v.amax());
            w = Vector3::repeat(w.amax());
        }
        Self {
            v: v * share,
            w: w * share,
        }
    }
}

/// The samples of a run with one draw of noise.
pub fn draw(raws: &[Raw], sigma: Sigma, seed: u64) -> Vec<Raw> {
    let mut rng = ChaCha8Rng::seed_from_u64(2008);
    rng.set_stream(seed);
    let mut one = || Vector3::from_fn(|_, _| StandardNormal.sample(&mut rng));
    raws.iter()
        .map(|r| {
            let mut r = r.clone();
            r.v_NBo_N += sigma.v.component_mul(&one());
            r.w_NB_B += sigma.w.component_mul(&one());
            r
        })
        .collect()
}

/// Errors of one answer: mass (share), mass centre (m), tensor (share of its norm), worst moment (share).
pub type Errors = [f64; 4];

/// Errors of an answer.
pub fn errors(found: Option<MassProperties>, truth: &MassProperties) -> Errors {
    let Some(found) = found else {
        return [f64::INFINITY; 4];
    };
    let I = &truth.I_BBcm_B;
    let d = found.I_BBcm_B - I;
    let worst = (0..3)
        .map(|k| (d[(k, k)] / I[(k, k)]).abs())
        .fold(0.0, f64::max);
    [
        (found.mass / truth.mass - 1.0).abs(),
        (found.p_BoBcm_B - truth.p_BoBcm_B).norm(),
        d.norm() / I.norm(),
        worst,
    ]
    .map(|e| if e.is_nan() { f64::INFINITY } else { e })
}

/// The two steps as mass properties.
pub fn ma2008(samples: &[Reading], known: Option<Known>) -> Option<MassProperties> {
    let answer = two_step(&[samples.to_vec()], known);
    Some(MassProperties {
        mass: answer.mass(),
        p_BoBcm_B: answer.rho_S(),
        I_BBcm_B: answer.I_S()?,
    })
}

/// Errors of many trials of one option.
pub fn trials(
    experiment: &Experiment,
    run: &Run,
    sigma: Sigma,
    known: bool,
    seeds: u64,
) -> Vec<Errors> {
    let truth = experiment.truth();
    (0..seeds)
        .map(|seed| {
            let samples = readings(&experiment.model, &draw(&run.raws, sigma, seed));
            errors(ma2008(&samples, known.then_some(run.known)), &truth)
        })
        .collect()
}

/// Quantile q of component k.
pub fn quantile(trials: &[Errors], k: usize, q: f64) -> f64 {
    let mut sorted: Vec<f64> = trials.iter().map(|e| e[k]).collect();
    sorted.sort_by(f64::total_cmp);
    let at = (q * (sorted.len() - 1) as f64).round() as usize;
    sorted.get(at).copied().unwrap_or(f64::NAN)
}

/// A run as the linear rung takes it.
pub fn segment(run: &Run, raws: &[Raw]) -> Segment {
    Segment {
        label: "study".to_owned(),
        samples: Samples {
            time_s: (0..raws.len()).map(|k| k as f64).collect(),
            R_NB: raws.iter().map(|r| r.R_NB).collect(),
            w_NB_B: raws.iter().map(|r| r.w_NB_B).collect(),
            translation: Some(Translation {
                v_NBo_N: raws.iter().map(|r| r.v_NBo_N).collect(),
                p_NoBo_N: run.positions.clone(),
            }),
            joint_position: raws.iter().flat_map(|r| r.q.clone()).collect(),
            joint_rate: raws.iter().flat_map(|r| r.rates.clone()).collect(),
            wheel_speed: Vec::new(),
        },
        firings: Vec::new(),
    }
}

/// Noise of the two velocities, all else exact.
pub fn noise(sigma: Sigma, seen: f64) -> Noise {
    let square = |s: Vector3| Matrix3::from_diagonal(&s.component_mul(&s));
    Noise {
        gyro: square(sigma.w),
        attitude: Matrix3::zeros(),
        velocity: square(sigma.v),
        position: Matrix3::zeros(),
        joint_position: vec![0.0; 6],
        joint_rate: vec![0.0; 6],
        wheel_speed: Vec::new(),
        seen_gyro: seen,
        seen_velocity: seen,
        seen_joint_rate: 0.0,
    }
}

/// The linear rung on one draw; on the exact samples with the truth as nominal its sigmas are the
/// Cramer-Rao bound of the linear information.
pub fn linear_answer(
    experiment: &Experiment,
    run: &Run,
    raws: &[Raw],
    sigma: Sigma,
    known: bool,
    seen: f64,
) -> Option<Estimate> {
    let mut model: Model = experiment.model.clone();
    if known {
        model.momentum.linear = MomentumKnowledge::Known(run.known.p_C_N);
        model.momentum.angular = MomentumKnowledge::Known(run.known.h_C_N);
    }
    let tree = Tree::new(&model);
    linear(&LinearProblem {
        model: &model,
        tree: &tree,
        segments: &[segment(run, raws)],
        noise: &noise(sigma, seen),
        relative_accuracy: 1.0e6,
    })
    .ok()
}

/// Mass properties of an answer, where complete.
pub fn properties(e: &Estimate) -> Option<MassProperties> {
    let b = e.bodies.first()?;
    let mut I = Matrix3::zeros();
    for (n, (i, j)) in b.inertia.iter().zip(poinsot_identify::TENSOR) {
        I[(i, j)] = n.value?;
        I[(j, i)] = n.value?;
    }
    Some(MassProperties {
        mass: b.mass.value?,
        p_BoBcm_B: Vector3::new(b.com[0].value?, b.com[1].value?, b.com[2].value?),
        I_BBcm_B: I,
    })
}

/// Cramer-Rao bound as the root-mean-square errors it allows: mass (share), mass centre (m), tensor
/// (share of its norm).
pub fn cramer_rao(experiment: &Experiment, run: &Run, sigma: Sigma, known: bool) -> [f64; 3] {
    let Some(e) = linear_answer(experiment, run, &run.raws, sigma, known, 0.0) else {
        return [f64::INFINITY; 3];
    };
    let truth = experiment.truth();
    let s = |n: &poinsot_identify::Number| n.sigma.unwrap_or(f64::INFINITY);
    let b = &e.bodies[0];
    let tensor: f64 = b
        .inertia
        .iter()
        .zip(poinsot_identify::TENSOR)
        .map(|(n, (i, j))| s(n).powi(2) * if i == j { 1.0 } else { 2.0 })
        .sum();
    [
        s(&b.mass) / truth.mass,
        b.com.iter().map(|n| s(n).powi(2)).sum::<f64>().sqrt(),
        tensor.sqrt() / truth.I_BBcm_B.norm(),
    ]
}
