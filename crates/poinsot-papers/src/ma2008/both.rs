//! Both steps on data of a model: checks, noise sources, solution, residuals.

use super::answer::Variant;
use super::bounds::{Bound, bound};
use super::error::Ma2008Error;
use super::increments::relative;
use super::influence::{Directions, Influence, Setting, Solution, Source, influence};
use super::{
    AngularRows, Given, LinearRows, Raw, Reading, Step, Vehicle, angular_known, angular_rows,
    differences, linear_known, linear_rows, solve,
};
use crate::method::Named;
use nalgebra::{SMatrix, SVector, SymmetricEigen};
use poinsot_identify::{Noise, Problem, Segment};
use poinsot_model::{EstimateSet, MomentumKnowledge};
use poinsot_spatial::{MassProperties, Matrix3, Vector3};

/// Size of an error that its root mean square exceeds times this with a probability below 0.1 %: a sum of squares of
/// normal numbers with mean m stays below `m (1 + sqrt(2 t))^2` but for `exp(-t)` (Laurent and Massart 2000).
const LIMIT: f64 = 4.717;
/// Share of a direction's squared length that may be noise before it is not believed.
const NOISE_SHARE: f64 = 0.5;

pub(super) fn check(problem: &Problem, variant: Variant) -> Result<Given, Ma2008Error> {
    let model = problem.model;
    if let Some(body) = model.bodies.iter().skip(1).find(|b| b.estimate.any()) {
        let body = body.name.clone();
        return Err(Ma2008Error::UnknownArm { body });
    }
    let base = model.bodies.first().map(|b| (b.name.clone(), b.estimate));
    let (base, asked) = base.unwrap_or_default();
    if asked != EstimateSet::ALL {
        return Err(Ma2008Error::BasePartlyKnown { body: base });
    }
    let arm: f64 = model.bodies.iter().skip(1).map(|b| b.nominal.mass).sum();
    if arm.is_nan() || arm <= 0.0 {
        return Err(Ma2008Error::NoArm { base });
    }
    if let Some(wheel) = model.wheels.iter().find(|w| w.estimate) {
        let wheel = wheel.name.clone();
        return Err(Ma2008Error::UnknownWheel { wheel });
    }
    let needed = match variant {
        Variant::KnownMomentum => 2,
        Variant::UnknownMomentum => 3,
    };
    for segment in problem.segments {
        let label = segment.label.clone();
        let samples = segment.samples.time_s.len();
        if !segment.firings.is_empty() {
            return Err(Ma2008Error::Thrust { label });
        }
        if samples < needed {
            return Err(Ma2008Error::TooFewSamples {
                label,
                samples,
                needed,
                variant: variant.name(),
            });
        }
    }
    if variant == Variant::UnknownMomentum {
        return Ok(Given::default());
    }
    let pick = |k: MomentumKnowledge| match k {
        MomentumKnowledge::Known(value) => Some(value),
        MomentumKnowledge::Estimate => None,
    };
    let given = Given {
        p_C_N: pick(model.momentum.linear),
        h_C_N: pick(model.momentum.angular),
    };
    match given == Given::default() {
        true => Err(Ma2008Error::MomentumUnknown),
        false => Ok(given),
    }
}

/// Samples of a segment, and the covariance that one interval adds where the velocity is summed from increments.
pub(super) fn raws(
    problem: &Problem,
    segment: &Segment,
    given: &Given,
) -> Result<(Vec<Raw>, Option<Matrix3>), Ma2008Error> {
    let s = &segment.samples;
    let summed = match (&s.translation, given.p_C_N) {
        (None, None) => relative(segment),
        _ => None,
    };
    let velocity = |k: usize| match (&s.translation, &summed) {
        (Some(t), _) => Some(t.v_NBo_N[k]),
        (None, Some(relative)) => relative.velocity[k],
        (None, None) => None,
    };
    let (dof, wheels) = (problem.tree.dof(), problem.tree.rotors.len());
    let row = |list: &[f64], k: usize, n: usize| list[k * n..(k + 1) * n].to_vec();
    let raws: Vec<Raw> = (0..s.time_s.len())
        .filter_map(|k| {
            Some(Raw {
                R_NB: s.R_NB[k],
                v_NBo_N: velocity(k)?,
                w_NB_B: s.w_NB_B[k],
                q: row(&s.joint_position, k, dof),
                rates: row(&s.joint_rate, k, dof),
                wheel_speed: row(&s.wheel_speed, k, wheels),
            })
        })
        .collect();
    if raws.len() < 2 {
        let label = segment.label.clone();
        return Err(Ma2008Error::NoVelocity { label });
    }
    Ok((raws, summed.map(|r| r.step)))
}

/// Independent one-sigma errors of one sample, with the share of their variance that the data show.
///
/// `velocity` tells whether a segment measures it; `step` is the covariance of velocity increments, whose noise is taken
/// as really there.
pub(super) fn sources(noise: &Noise, velocity: bool, step: Option<Matrix3>) -> Vec<(Source, f64)> {
    let axes = |covariance: &Matrix3| -> Vec<Vector3> {
        let e = SymmetricEigen::new(*covariance);
        (0..3)
            .filter(|&k| e.eigenvalues[k] > 0.0)
            .map(|k| e.eigenvectors.column(k) * e.eigenvalues[k].sqrt())
            .collect()
    };
    let scalars = |list: &[f64]| -> Vec<(usize, f64)> {
        list.iter()
            .enumerate()
            .filter(|(_, v)| **v > 0.0)
            .map(|(k, v)| (k, v.sqrt()))
            .collect()
    };
    let mut out = Vec::new();
    let rate = noise.seen_gyro;
    out.extend(
        axes(&noise.gyro)
            .into_iter()
            .map(|s| (Source::Rate(s), rate)),
    );
    let v = noise.seen_velocity;
    out.extend(
        axes(&noise.velocity)
            .into_iter()
            .filter(|_| velocity)
            .map(|s| (Source::Velocity(s), v)),
    );
    out.extend(
        axes(&noise.attitude)
            .into_iter()
            .map(|s| (Source::Attitude(s), v)),
    );
    out.extend(
        axes(&step.unwrap_or_default())
            .into_iter()
            .map(|s| (Source::VelocityStep(s), 1.0)),
    );
    let joint = noise.seen_joint_rate;
    for (k, s) in scalars(&noise.joint_position) {
        out.push((Source::JointPosition(k, s), joint));
    }
    for (k, s) in scalars(&noise.joint_rate) {
        out.push((Source::JointRate(k, s), joint));
    }
    for (k, s) in scalars(&noise.wheel_speed) {
        out.push((Source::WheelSpeed(k, s), joint));
    }
    out
}

/// Both steps with what the declared noise does to them.
pub(super) struct Solved {
    pub(super) x: SVector<f64, 4>,
    pub(super) linear: Directions<4>,
    pub(super) angular: Option<(SVector<f64, 6>, Directions<6>)>,
    pub(super) influence: Influence,
    /// Worse of the two steps' residuals per degree of freedom, in declared variances.
    pub(super) chi2: f64,
    /// Per segment, mean of both steps.
    pub(super) chi2_segment: Vec<f64>,
    /// Share of the right-hand sides explained.
    pub(super) explained: f64,
    pub(super) bounds: Vec<Bound>,
    pub(super) arm_mass: f64,
}

pub(super) fn solve_both(
    problem: &Problem,
    vehicle: &mut Vehicle,
    data: &[Vec<Raw>],
    sources: &[(Source, f64)],
    given: Given,
) -> Result<Solved, Ma2008Error> {
    let arm_mass = vehicle.arm_mass();
    let base = problem
        .model
        .bodies
        .first()
        .map_or(MassProperties::ZERO, |b| b.nominal);
    let gyration = base.radius_of_gyration();
    let L = if gyration > 0.0 { gyration } else { 1.0 };
    let m = if base.mass > 0.0 { base.mass } else { arm_mass };
    let readings: Vec<Vec<Reading>> = data
        .iter()
        .map(|s| s.iter().map(|raw| vehicle.reading(raw)).collect())
        .collect();
    let all = || readings.iter().flatten();

    // Step 1.
    let rows = differences(
        &readings,
        linear_rows,
        given.p_C_N.map(|p| linear_known(&p, arm_mass)),
    );
    let linear_step: Step<4> = solve::<4, 5>(&rows);
    let natural = [arm_mass / m, L, L, L];
    let floor = round_off(all().map(linear_rows), &natural);
    let mut linear = Directions::new(&linear_step, natural, floor).ok_or(Ma2008Error::NotFinite)?;
    let c = base.p_BoBcm_B;
    let nominal = SVector::<f64, 4>::new(natural[0], c.x, c.y, c.z);
    let mut x = linear.solve(&linear_step, &nominal);
    let setting = Setting {
        segments: data,
        known: given,
        sources,
    };
    let alone = |x, linear: &Directions<4>, vehicle: &mut Vehicle| {
        influence(
            vehicle,
            &setting,
            &Solution {
                x,
                linear,
                angular: None,
            },
        )
    };
    let mut effect = alone(x, &linear, vehicle);
    let accuracy = problem.relative_accuracy;
    let variance: [f64; 4] = std::array::from_fn(|j| effect.covariance[(j, j)]);
    if believe(&mut linear, &variance, &effect.linear.regressor, accuracy) {
        x = linear.solve(&linear_step, &nominal);
        effect = alone(x, &linear, vehicle);
    }
    let left = expected(effect.linear.residual, &effect, &linear, 0);
    let mut chi2 = linear_step_residual(&rows, &x) / left;
    let mut chi2_segment = shares(
        &readings,
        given.p_C_N.is_some(),
        &rows,
        |r| (r * up(&x)).norm_squared(),
        left,
    );
    let whole: f64 = rows.iter().map(|r| r.column(4).norm_squared()).sum();
    let mut explained = 1.0 - linear_step_residual(&rows, &x) / whole.max(f64::MIN_POSITIVE);
    let mut bounds = vec![bound(
        &linear_step,
        LIMIT * effect.linear.epsilon_A.sqrt(),
        LIMIT * effect.linear.epsilon_b.sqrt(),
    )];

    // Step 2, where step 1 is complete.
    let mut angular = None;
    if linear.usable == [true; 4] && x[0] > 0.0 {
        let (m_S, rho_S) = (arm_mass / x[0], x.fixed_rows::<3>(1).into_owned());
        let of = |s: &Reading| angular_rows(s, m_S, &rho_S);
        let rows: Vec<AngularRows> =
            differences(&readings, of, given.h_C_N.map(|h| angular_known(&h)));
        let step: Step<6> = solve::<6, 7>(&rows);
        let natural = [m * L * L; 6];
        let floor = round_off(all().map(of), &natural);
        let mut directions =
            Directions::new(&step, natural, floor).ok_or(Ma2008Error::NotFinite)?;
        let y_nominal = SVector::<f64, 6>::from(paper_tensor(&base.I_BBcm_B));
        let mut y = directions.solve(&step, &y_nominal);
        let both = |y, directions: &Directions<6>, vehicle: &mut Vehicle| {
            let angular = Some((y, directions));
            influence(
                vehicle,
                &setting,
                &Solution {
                    x,
                    linear: &linear,
                    angular,
                },
            )
        };
        effect = both(y, &directions, vehicle);
        let variance: [f64; 6] = std::array::from_fn(|j| effect.covariance[(4 + j, 4 + j)]);
        if believe(
            &mut directions,
            &variance,
            &effect.angular.regressor,
            accuracy,
        ) {
            y = directions.solve(&step, &y_nominal);
            effect = both(y, &directions, vehicle);
        }
        let left: f64 = rows.iter().map(|r| (r * up6(&y)).norm_squared()).sum();
        let all = effect.angular.residual + effect.inherited;
        let expected = expected(all, &effect, &directions, 4);
        chi2 = chi2.max(left / expected);
        let second = shares(
            &readings,
            given.h_C_N.is_some(),
            &rows,
            |r| (r * up6(&y)).norm_squared(),
            expected,
        );
        for (a, b) in chi2_segment.iter_mut().zip(second) {
            *a = 0.5 * (*a + b);
        }
        let whole: f64 = rows.iter().map(|r| r.column(6).norm_squared()).sum();
        explained = explained.min(1.0 - left / whole.max(f64::MIN_POSITIVE));
        bounds.push(bound(
            &step,
            LIMIT * effect.angular.epsilon_A.sqrt(),
            LIMIT * (effect.angular.epsilon_b.sqrt() + effect.passed_on.sqrt()),
        ));
        angular = Some((y, directions));
    }
    Ok(Solved {
        x,
        linear,
        angular,
        influence: effect,
        chi2,
        chi2_segment,
        explained,
        bounds,
        arm_mass,
    })
}

pub(super) fn up(x: &SVector<f64, 4>) -> SVector<f64, 5> {
    SVector::from_iterator(x.iter().copied().chain([1.0]))
}

pub(super) fn up6(y: &SVector<f64, 6>) -> SVector<f64, 7> {
    SVector::from_iterator(y.iter().copied().chain([1.0]))
}

pub(super) fn linear_step_residual(rows: &[LinearRows], x: &SVector<f64, 4>) -> f64 {
    rows.iter().map(|r| (r * up(x)).norm_squared()).sum()
}

/// Singular values below this are differences of rounded numbers.
pub(super) fn round_off<const N: usize, const W: usize>(
    rows: impl Iterator<Item = SMatrix<f64, 3, W>>,
    natural: &[f64; N],
) -> f64 {
    let square: f64 = rows
        .map(|r| {
            (0..N)
                .map(|j| (r.column(j) * natural[j]).norm_squared())
                .sum::<f64>()
        })
        .sum();
    64.0 * f64::EPSILON * square.sqrt()
}

/// Keeps the directions whose sigma is below the wanted accuracy and whose signal exceeds the noise in
/// the regressor; tells whether any was dropped.
pub(super) fn believe<const N: usize>(
    directions: &mut Directions<N>,
    variance: &[f64; N],
    regressor: &SMatrix<f64, N, N>,
    accuracy: f64,
) -> bool {
    let before = directions.usable;
    for (j, variance) in variance.iter().enumerate() {
        let v = SVector::<f64, N>::from_fn(|i, _| directions.V[(i, j)] * directions.natural[i]);
        let noise = (regressor * v).dot(&v);
        directions.usable[j] &= variance.sqrt() < accuracy
            && noise <= NOISE_SHARE * directions.singular[j] * directions.singular[j];
    }
    before != directions.usable
}

/// What the declared noise leaves as residual: `E ||e||^2` less the part that the fit takes up,
/// `E ||A dx||^2`; `at` is where the step's directions stand in the covariance.
pub(super) fn expected<const N: usize>(
    all: f64,
    effect: &Influence,
    d: &Directions<N>,
    at: usize,
) -> f64 {
    let fitted: f64 = (0..N)
        .filter(|&j| d.usable[j])
        .map(|j| d.singular[j] * d.singular[j] * effect.covariance[(at + j, at + j)])
        .sum();
    (all - fitted).max(f64::MIN_POSITIVE)
}

/// Residual of every segment in expected residuals.
pub(super) fn shares<const W: usize>(
    readings: &[Vec<Reading>],
    known: bool,
    rows: &[SMatrix<f64, 3, W>],
    square: impl Fn(&SMatrix<f64, 3, W>) -> f64,
    expected: f64,
) -> Vec<f64> {
    let total = rows.len().max(1) as f64;
    let mut at = 0;
    readings
        .iter()
        .map(|segment| {
            let count = segment.len() - usize::from(!known && !segment.is_empty());
            let own = rows.get(at..at + count).unwrap_or(&[]);
            at += count;
            let left: f64 = own.iter().map(&square).sum();
            left / (expected * count as f64 / total).max(f64::MIN_POSITIVE)
        })
        .collect()
}

pub(super) fn paper_tensor(I: &Matrix3) -> [f64; 6] {
    [
        I[(0, 0)],
        I[(1, 1)],
        I[(2, 2)],
        I[(0, 1)],
        I[(0, 2)],
        I[(1, 2)],
    ]
}
