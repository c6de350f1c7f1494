//! Noisy trials of the two steps and of the linear rung on the same draws.

use crate::setup::{Experiment, Run, readings};
use nalgebra::DMatrix;
use poinsot_dynamics::Tree;
use poinsot_identify::{
    Estimate, Noise, Observations, Problem, Samples, Segment, Translation, linear,
    maximum_likelihood,
};
use poinsot_model::{Model, MomentumKnowledge};
use poinsot_papers::ma2008::{Known, Raw, Reading, angular_rows, linear_rows, two_step};
use poinsot_spatial::{MassProperties, Matrix3, Matrix6, Vector3, Vector6};
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
            time_s: run.times.clone(),
            R_NB: raws.iter().map(|r| r.R_NB).collect(),
            w_NB_B: raws.iter().map(|r| r.w_NB_B).collect(),
            translation: Some(Translation {
                v_NBo_N: raws.iter().map(|r| r.v_NBo_N).collect(),
                p_NoBo_N: run.positions.iter().map(|p| p - run.positions[0]).collect(),
            }),
            joint_position: raws.iter().flat_map(|r| r.q.clone()).collect(),
            joint_rate: raws.iter().flat_map(|r| r.rates.clone()).collect(),
            wheel_speed: Vec::new(),
        },
        firings: Vec::new(),
        accelerations: None,
        tachometers: Vec::new(),
        observations: Observations {
            time_s: run.times.clone(),
            rate: raws.iter().map(|r| Some(r.w_NB_B)).collect(),
            attitude: raws.iter().map(|r| Some(r.R_NB)).collect(),
            velocity: raws.iter().map(|r| Some(r.v_NBo_N)).collect(),
            position: vec![None; raws.len()],
            velocity_arm_B: Vector3::zeros(),
            position_arm_B: Vector3::zeros(),
            orbit: Vec::new(),
            points: Vec::new(),
            joint_position: raws.iter().flat_map(|r| r.q.clone()).collect(),
            joint_rate: raws.iter().flat_map(|r| r.rates.clone()).collect(),
            wheel_speed: Vec::new(),
            joint_errors: Vec::new(),
            wheel_errors: Vec::new(),
            derived_rates: Vec::new(),
            between_readings: false,
        },
    }
}

/// Noise of the two velocities, all else exact.
pub fn noise(sigma: Sigma, seen: f64) -> Noise {
    let square = |s: Vector3| Matrix3::from_diagonal(&s.component_mul(&s));
    Noise {
        gyro: square(sigma.w),
        attitude: Matrix3::identity() * 1.0e-14,
        velocity: square(sigma.v),
        position: Matrix3::zeros(),
        joint_position: vec![0.0; 6],
        joint_rate: vec![0.0; 6],
        wheel_speed: Vec::new(),
        correlation_s: [0.0; 4],
        seen_gyro: seen,
        seen_velocity: seen,
        seen_joint_rate: 0.0,
    }
}

/// The linear rung, or maximum likelihood, on one draw; the linear rung is also given the exact position of the base, which the two steps do
/// not use.
pub fn linear_answer(
    experiment: &Experiment,
    run: &Run,
    raws: &[Raw],
    sigma: Sigma,
    known: bool,
    seen: f64,
    likelihood: bool,
) -> Option<Estimate> {
    let mut model: Model = experiment.model.clone();
    if known {
        model.momentum.linear = MomentumKnowledge::Known(run.known.p_C_N);
        model.momentum.angular = MomentumKnowledge::Known(run.known.h_C_N);
    }
    let tree = Tree::new(&model);
    let problem = Problem {
        model: &model,
        tree: &tree,
        segments: &[segment(run, raws)],
        noise: &noise(sigma, seen),
        relative_accuracy: 1.0e6,
    };
    if likelihood {
        maximum_likelihood(&problem).ok()
    } else {
        linear(&problem).ok()
    }
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

/// Cramer-Rao bound of what the two steps see (velocities with noise, attitude and joints exact, no
/// position), as root-mean-square errors: mass (share), mass centre (m), tensor (share of its norm).
///
/// Six equations `g = 0` and six noisy velocities per sample: with `g` differentiated over the unknowns
/// (`D`) and over the velocities (`S = sum e e^T`), the information is `sum D^T S^-1 D`. Unknown momentum
/// adds six unknowns.
pub fn cramer_rao(experiment: &Experiment, run: &Run, sigma: Sigma, known: bool) -> [f64; 3] {
    let truth = experiment.truth();
    let I = &truth.I_BBcm_B;
    let arm_mass: f64 = experiment.model.bodies[1..]
        .iter()
        .map(|b| b.nominal.mass)
        .sum();
    let c = truth.p_BoBcm_B;
    let mut theta = vec![
        arm_mass / truth.mass,
        c.x,
        c.y,
        c.z,
        I[(0, 0)],
        I[(1, 1)],
        I[(2, 2)],
        I[(0, 1)],
        I[(0, 2)],
        I[(1, 2)],
    ];
    let mut unit = vec![theta[0], 1.0, 1.0, 1.0];
    unit.extend([I.norm(); 6]);
    let momentum = run.known;
    if !known {
        theta.extend(
            (momentum.p_C_N / truth.mass)
                .iter()
                .chain(momentum.h_C_N.iter()),
        );
        unit.extend([1.0, 1.0, 1.0, I.norm(), I.norm(), I.norm()]);
    }
    let n = theta.len();
    let g = |s: &Reading, t: &[f64]| -> Vector6 {
        let x1 = Vector5::new(t[0], t[1], t[2], t[3], 1.0);
        let y1 = Vector7::from_iterator(t[4..10].iter().copied().chain([1.0]));
        let (P, H) = if known {
            (momentum.p_C_N * (t[0] / arm_mass), momentum.h_C_N)
        } else {
            (
                Vector3::new(t[10], t[11], t[12]),
                Vector3::new(t[13], t[14], t[15]),
            )
        };
        let l = linear_rows(s) * x1 - P;
        let h = angular_rows(s, arm_mass / t[0], &Vector3::new(t[1], t[2], t[3])) * y1 - H;
        Vector6::new(l.x, l.y, l.z, h.x, h.y, h.z)
    };
    let mut information = DMatrix::<f64>::zeros(n, n);
    for s in readings(&experiment.model, &run.raws) {
        let mut S = Matrix6::zeros();
        for k in 0..3 {
            let mut moved = [s; 4];
            let dv = s.R_NB.transpose().column(k) * sigma.v[k];
            moved[0].v_NBo_B += dv;
            moved[1].v_NBo_B -= dv;
            moved[2].w_NB_B[k] += sigma.w[k];
            moved[3].w_NB_B[k] -= sigma.w[k];
            for pair in moved.chunks_exact(2) {
                let e = (g(&pair[0], &theta) - g(&pair[1], &theta)) * 0.5;
                S += e * e.transpose();
            }
        }
        let mut D = DMatrix::<f64>::zeros(6, n);
        for j in 0..n {
            let (mut a, mut b) = (theta.clone(), theta.clone());
            a[j] += 1.0e-5 * unit[j];
            b[j] -= 1.0e-5 * unit[j];
            let slope = (g(&s, &a) - g(&s, &b)) / 2.0e-5;
            D.column_mut(j).copy_from(&slope);
        }
        let Some(inverse) = S.try_inverse() else {
            return [f64::INFINITY; 3];
        };
        information += D.transpose() * inverse * &D;
    }
    // Equal diagonals first: with orbital velocity the columns differ by many powers of ten.
    let size: Vec<f64> = (0..n)
        .map(|i| information[(i, i)].sqrt().max(f64::MIN_POSITIVE))
        .collect();
    let information = DMatrix::from_fn(n, n, |i, j| information[(i, j)] / (size[i] * size[j]));
    let eigen = information.symmetric_eigen();
    let most = eigen.eigenvalues.max();
    let variance = |i: usize| -> f64 {
        (0..n)
            .map(|j| {
                let (v, l) = (eigen.eigenvectors[(i, j)].powi(2), eigen.eigenvalues[j]);
                if l > 1.0e-13 * most {
                    v / l
                } else if v > 1.0e-9 {
                    f64::INFINITY
                } else {
                    0.0
                }
            })
            .sum::<f64>()
            / (size[i] * size[i])
    };
    let tensor: f64 = (4..10)
        .map(|i| variance(i) * if i < 7 { 1.0 } else { 2.0 })
        .sum();
    [
        variance(0).sqrt(),
        (1..4).map(variance).sum::<f64>().sqrt(),
        tensor.sqrt(),
    ]
}

type Vector5 = nalgebra::SVector<f64, 5>;
type Vector7 = nalgebra::SVector<f64, 7>;
