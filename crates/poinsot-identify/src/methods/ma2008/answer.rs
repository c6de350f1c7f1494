//! From model and telemetry to the answer: both steps, what they determine, sigma and words.

use super::bounds::{Bound, bound};
use super::influence::{Directions, Influence, Setting, Solution, Source, influence};
use super::{
    AngularRows, Known, LinearRows, Raw, Reading, Step, Vehicle, angular_known, angular_rows,
    differences, linear_known, linear_rows, solve, tensor,
};
use crate::answer_body::{finish, known};
use crate::estimate::{
    DeterminedCombination, Estimate, Identifiability, MomentumEstimate, Number, OpenCombination,
    SegmentFit, Source as From, Status,
};
use crate::parameters::axis_name;
use crate::problem::Problem;
use crate::segment::{Noise, Segment};
use nalgebra::{DMatrix, SMatrix, SVector, SymmetricEigen};
use poinsot_dynamics::{Kinematics, composite};
use poinsot_model::{EstimateSet, MomentumKnowledge, Nuisance, SensorKind};
use poinsot_spatial::{InertialParameters, MassProperties, Matrix3, Vector3};

/// Which option of both steps.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Variant {
    /// Option 1: the momentum is given by the model.
    KnownMomentum,
    /// Option 2: it is eliminated by increments.
    UnknownMomentum,
}

impl Variant {
    /// Name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::KnownMomentum => "known-momentum",
            Self::UnknownMomentum => "unknown-momentum",
        }
    }
}

/// Why the question cannot be put to this method.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Ma2008Error {
    /// Unknown arm.
    #[error(
        "E0521 body '{body}': estimate: ma2008 needs every body but the base known; take estimate out of it, or use --method auto"
    )]
    UnknownArm {
        /// Body.
        body: String,
    },
    /// Base not wholly unknown.
    #[error(
        "E0522 body '{body}': estimate: ma2008 identifies mass, mass centre and inertia of the base together; write estimate = true, or use --method auto"
    )]
    BasePartlyKnown {
        /// Body.
        body: String,
    },
    /// No arm.
    #[error(
        "E0523 model: the bodies beyond the base '{base}' have no mass: ma2008 needs an arm of known mass; describe it, or use --method auto"
    )]
    NoArm {
        /// Base.
        base: String,
    },
    /// Momentum not known.
    #[error(
        "E0524 [momentum] {key} = \"estimate\": variant known-momentum needs it in N (N s; N m s about the system mass centre at the first sample); give it, or use --variant unknown-momentum"
    )]
    MomentumUnknown {
        /// Key.
        key: &'static str,
    },
    /// No velocity.
    #[error(
        "E0525 segment '{label}': no velocity channel (v_x v_y v_z): ma2008 needs it for step 1; add it, or use --method maximum_likelihood"
    )]
    NoVelocity {
        /// Segment.
        label: String,
    },
    /// Thrust.
    #[error(
        "E0526 segment '{label}': a thruster fires: ma2008 takes momentum as conserved; cut the firing out, or use --method auto"
    )]
    Thrust {
        /// Segment.
        label: String,
    },
    /// A wheel of unknown spin inertia.
    #[error(
        "E0527 wheel '{wheel}': estimate: ma2008 needs its spin inertia known; take estimate out of it, or use --method auto"
    )]
    UnknownWheel {
        /// Wheel.
        wheel: String,
    },
    /// Too few samples.
    #[error(
        "E0528 segment '{label}': {samples} samples: variant {variant} needs at least {needed} for four unknowns; add samples at other arm configurations"
    )]
    TooFewSamples {
        /// Segment.
        label: String,
        /// Samples found.
        samples: usize,
        /// Samples needed.
        needed: usize,
        /// Variant.
        variant: &'static str,
    },
    /// Numbers overflow.
    #[error(
        "E0529 the equations hold a number that is not finite; check units and magnitudes of the telemetry"
    )]
    NotFinite,
}

/// Chi-square per degree of freedom above which the declared noise cannot be right.
const MISFIT: f64 = 1.5;
/// Above which a model that explains little, or a given momentum that explains less than none, is refused.
const REJECT: f64 = 9.0;
/// A number that leans on open directions by more than this share is not answered.
const TOUCH: f64 = 1.0e-4;
/// Share of a direction's squared length that may be noise before it is not believed.
const NOISE_SHARE: f64 = 0.5;
/// Ratio of arm mass to base mass that the paper studied.
const STUDIED: [f64; 2] = [0.005, 0.5];
/// Elements of the paper's `y` in the order xx, xy, yy, xz, yz, zz of the result.
const RESULT_ORDER: [usize; 6] = [0, 3, 1, 4, 5, 2];
const PAPER_NAMES: [&str; 6] = ["xx", "yy", "zz", "xy", "xz", "yz"];

/// Identifies the base of a vehicle by its arm.
///
/// # Errors
/// The question cannot be put to this method. What the data leave open is an answer.
pub fn identify(problem: &Problem, variant: Variant) -> Result<Estimate, Ma2008Error> {
    let given = check(problem, variant)?;
    let mut vehicle = Vehicle::new(problem.model, problem.tree);
    let data: Vec<Vec<Raw>> = problem
        .segments
        .iter()
        .map(|s| raws(problem, s))
        .collect::<Result<_, _>>()?;
    let sources = sources(problem.noise);
    let solved = solve_both(problem, &mut vehicle, &data, &sources, given)?;
    let mut contradicted = None;
    if given.is_some() && solved.chi2 > REJECT {
        let free = solve_both(problem, &mut vehicle, &data, &sources, None)?;
        contradicted = (solved.chi2 > 4.0 * free.chi2).then_some(free.chi2);
    }
    Ok(write(problem, variant, given, &solved, contradicted))
}

fn check(problem: &Problem, variant: Variant) -> Result<Option<Known>, Ma2008Error> {
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
    let needed = if variant == Variant::KnownMomentum {
        2
    } else {
        3
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
        return Ok(None);
    }
    let pick = |k: MomentumKnowledge, key| match k {
        MomentumKnowledge::Known(value) => Ok(value),
        MomentumKnowledge::Estimate => Err(Ma2008Error::MomentumUnknown { key }),
    };
    Ok(Some(Known {
        p_C_N: pick(model.momentum.linear, "linear_N_s")?,
        h_C_N: pick(model.momentum.angular, "angular_N_m_s")?,
    }))
}

fn raws(problem: &Problem, segment: &Segment) -> Result<Vec<Raw>, Ma2008Error> {
    let s = &segment.samples;
    let translation = s.translation.as_ref().ok_or_else(|| {
        let label = segment.label.clone();
        Ma2008Error::NoVelocity { label }
    })?;
    let (dof, wheels) = (problem.tree.dof(), problem.tree.rotors.len());
    let row = |list: &[f64], k: usize, n: usize| list[k * n..(k + 1) * n].to_vec();
    Ok((0..s.time_s.len())
        .map(|k| Raw {
            R_NB: s.R_NB[k],
            v_NBo_N: translation.v_NBo_N[k],
            w_NB_B: s.w_NB_B[k],
            q: row(&s.joint_position, k, dof),
            rates: row(&s.joint_rate, k, dof),
            wheel_speed: row(&s.wheel_speed, k, wheels),
        })
        .collect())
}

/// Independent one-sigma errors of one sample, with the share of their variance that the data show.
fn sources(noise: &Noise) -> Vec<(Source, f64)> {
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
            .map(|s| (Source::Velocity(s), v)),
    );
    out.extend(
        axes(&noise.attitude)
            .into_iter()
            .map(|s| (Source::Attitude(s), v)),
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
struct Solved {
    x: SVector<f64, 4>,
    linear: Directions<4>,
    angular: Option<(SVector<f64, 6>, Directions<6>)>,
    influence: Influence,
    /// Worse of the two steps' residuals per degree of freedom, in declared variances.
    chi2: f64,
    /// Per segment, mean of both steps.
    chi2_segment: Vec<f64>,
    /// Share of the right-hand sides explained.
    explained: f64,
    bounds: Vec<Bound>,
    arm_mass: f64,
}

fn solve_both(
    problem: &Problem,
    vehicle: &mut Vehicle,
    data: &[Vec<Raw>],
    sources: &[(Source, f64)],
    given: Option<Known>,
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
        given.map(|k| linear_known(&k, arm_mass)),
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
        given.is_some(),
        &rows,
        |r| (r * up(&x)).norm_squared(),
        left,
    );
    let whole: f64 = rows.iter().map(|r| r.column(4).norm_squared()).sum();
    let mut explained = 1.0 - linear_step_residual(&rows, &x) / whole.max(f64::MIN_POSITIVE);
    let mut bounds = vec![bound(
        &linear_step,
        effect.linear.epsilon_A.sqrt(),
        effect.linear.epsilon_b.sqrt(),
    )];

    // Step 2, where step 1 is complete.
    let mut angular = None;
    if linear.usable == [true; 4] && x[0] > 0.0 {
        let (m_S, rho_S) = (arm_mass / x[0], x.fixed_rows::<3>(1).into_owned());
        let of = |s: &Reading| angular_rows(s, m_S, &rho_S);
        let rows: Vec<AngularRows> = differences(&readings, of, given.map(|k| angular_known(&k)));
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
            given.is_some(),
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
            effect.angular.epsilon_A.sqrt(),
            effect.angular.epsilon_b.sqrt(),
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

fn up(x: &SVector<f64, 4>) -> SVector<f64, 5> {
    SVector::from_iterator(x.iter().copied().chain([1.0]))
}

fn up6(y: &SVector<f64, 6>) -> SVector<f64, 7> {
    SVector::from_iterator(y.iter().copied().chain([1.0]))
}

fn linear_step_residual(rows: &[LinearRows], x: &SVector<f64, 4>) -> f64 {
    rows.iter().map(|r| (r * up(x)).norm_squared()).sum()
}

/// Singular values below this are differences of rounded numbers.
fn round_off<const N: usize, const W: usize>(
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
fn believe<const N: usize>(
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
fn expected<const N: usize>(all: f64, effect: &Influence, d: &Directions<N>, at: usize) -> f64 {
    let fitted: f64 = (0..N)
        .filter(|&j| d.usable[j])
        .map(|j| d.singular[j] * d.singular[j] * effect.covariance[(at + j, at + j)])
        .sum();
    (all - fitted).max(f64::MIN_POSITIVE)
}

/// Residual of every segment in expected residuals.
fn shares<const W: usize>(
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

fn paper_tensor(I: &Matrix3) -> [f64; 6] {
    [
        I[(0, 0)],
        I[(1, 1)],
        I[(2, 2)],
        I[(0, 1)],
        I[(0, 2)],
        I[(1, 2)],
    ]
}

/// The ten numbers `u = [m, com, I in the paper's order]` with covariance and what is open of them.
struct Ten {
    value: [f64; 10],
    covariance: SMatrix<f64, 10, 10>,
    bias: SVector<f64, 10>,
    open: [bool; 10],
    inflation: f64,
}

impl Ten {
    fn new(solved: &Solved, inflation: f64, rejected: bool) -> Self {
        let x = &solved.x;
        let m = solved.arm_mass / x[0];
        let mut value = [0.0; 10];
        value[..4].copy_from_slice(&[m, x[1], x[2], x[3]]);
        // From directions to u: columns of the map.
        let effect = &solved.influence;
        let mut map = SMatrix::<f64, 10, 10>::zeros();
        let d = SVector::<f64, 4>::new(-m / x[0], 1.0, 1.0, 1.0);
        let bias_x = solved
            .linear
            .in_units(&solved.linear.along(&effect.linear.bias));
        let mut bias = SVector::<f64, 10>::zeros();
        for i in 0..4 {
            bias[i] = d[i] * bias_x[i];
            for j in 0..4 {
                map[(i, j)] = d[i] * solved.linear.natural[i] * solved.linear.V[(i, j)];
            }
        }
        let mut open = [true; 10];
        mask(&solved.linear, &mut open[..4]);
        if let Some((y, directions)) = &solved.angular {
            mask(directions, &mut open[4..]);
            let rhs = effect.angular.bias + effect.coupling * bias_x;
            let bias_y = directions.in_units(&directions.along(&rhs));
            for i in 0..6 {
                value[4 + i] = y[i];
                bias[4 + i] = bias_y[i];
                for j in 0..6 {
                    map[(4 + i, 4 + j)] = directions.natural[i] * directions.V[(i, j)];
                }
            }
        }
        let covariance = map * effect.covariance.fixed_view::<10, 10>(0, 0) * map.transpose();
        let broken = rejected || x[0] <= 0.0;
        Self {
            value,
            covariance,
            bias,
            open: open.map(|o| o || broken),
            inflation,
        }
    }

    /// A function of the ten numbers; open where it changes with an open one.
    fn number(&self, nominal: f64, f: impl Fn(&[f64; 10]) -> f64) -> Number {
        let mut gradient = SVector::<f64, 10>::zeros();
        for k in 0..10 {
            let h = 1.0e-5 * (self.value[k].abs() + 1.0e-3 * self.value[0].abs().max(1.0));
            let (mut a, mut b) = (self.value, self.value);
            a[k] += h;
            b[k] -= h;
            gradient[k] = (f(&a) - f(&b)) / (2.0 * h);
        }
        let value = f(&self.value);
        let open = (0..10).any(|k| self.open[k] && gradient[k] != 0.0);
        if open || !value.is_finite() {
            return Number::open(nominal);
        }
        let variance = (self.covariance * gradient).dot(&gradient).max(0.0);
        let bias = self.bias.dot(&gradient);
        let sigma = self.inflation * (variance + bias * bias).sqrt();
        Number::data(value, sigma, nominal)
    }
}

fn mask<const N: usize>(d: &Directions<N>, open: &mut [bool]) {
    for (i, o) in open.iter_mut().enumerate() {
        let touch: f64 = (0..N)
            .filter(|&j| !d.usable[j])
            .map(|j| d.V[(i, j)] * d.V[(i, j)])
            .sum();
        *o = touch.sqrt() > TOUCH;
    }
}

fn properties(u: &[f64; 10]) -> MassProperties {
    let y = [u[4], u[5], u[6], u[7], u[8], u[9]];
    MassProperties {
        mass: u[0],
        p_BoBcm_B: Vector3::new(u[1], u[2], u[3]),
        I_BBcm_B: tensor(&y),
    }
}

fn write(
    problem: &Problem,
    variant: Variant,
    given: Option<Known>,
    solved: &Solved,
    contradicted: Option<f64>,
) -> Estimate {
    let model = problem.model;
    let rejected = contradicted.is_some() || (solved.chi2 > REJECT && solved.explained < 0.5);
    let ten = Ten::new(solved, solved.chi2.sqrt().max(1.0), rejected);
    let nominal = model
        .bodies
        .first()
        .map_or(MassProperties::ZERO, |b| b.nominal);
    let name = model
        .bodies
        .first()
        .map_or(String::new(), |b| b.name.clone());
    let base = body(&ten, name.clone(), &nominal, properties);
    let numbers = || {
        std::iter::once(&base.mass)
            .chain(&base.com)
            .chain(&base.inertia)
    };
    let open = numbers().filter(|n| n.source == From::Open).count();
    let status = match (rejected, open) {
        (true, _) => Status::Rejected,
        (_, 0) => Status::Converged,
        (_, 10) => Status::NotIdentifiable,
        _ => Status::Partial,
    };
    let (covariance_names, covariance_units, covariance) = covariance(&ten, &name);
    let system = (open == 0)
        .then(|| system(problem, &ten, &nominal))
        .flatten();
    let mut bodies = vec![base];
    bodies.extend(
        model
            .bodies
            .iter()
            .skip(1)
            .map(|b| known(b.name.clone(), &b.nominal)),
    );
    Estimate {
        method: "ma2008".to_owned(),
        variant: Some(variant.name().to_owned()),
        status,
        system,
        momentum: momentum(problem, given, solved, &ten),
        nuisance: Vec::new(),
        covariance_names,
        covariance_units,
        covariance,
        identifiability: identifiability(&name, solved, &ten, rejected),
        fit: problem
            .segments
            .iter()
            .zip(&solved.chi2_segment)
            .map(|(s, chi2)| SegmentFit {
                label: s.label.clone(),
                samples: s.samples.time_s.len(),
                chi2_per_dof: *chi2,
                channels: Vec::new(),
            })
            .collect(),
        covariance_trustworthy: solved.chi2 <= MISFIT && !rejected,
        warnings: warnings(problem, solved, &ten, contradicted, rejected, &bodies[0]),
        method_report: report(solved),
        iterations: 1,
        bodies,
    }
}

fn body(
    ten: &Ten,
    name: String,
    nominal: &MassProperties,
    of: impl Fn(&[f64; 10]) -> MassProperties,
) -> crate::estimate::BodyEstimate {
    let pi = nominal.parameters().to_array();
    let mass = ten.number(nominal.mass, |u| of(u).mass);
    let com = [0, 1, 2].map(|k| ten.number(nominal.p_BoBcm_B[k], |u| of(u).p_BoBcm_B[k]));
    let inertia =
        crate::parameters::TENSOR.map(|e| ten.number(nominal.I_BBcm_B[e], |u| of(u).I_BBcm_B[e]));
    let barycentric =
        std::array::from_fn(|k| ten.number(pi[k], |u| of(u).parameters().to_array()[k]));
    finish(name, mass, com, inertia, barycentric)
}

fn system(
    problem: &Problem,
    ten: &Ten,
    nominal: &MassProperties,
) -> Option<(crate::estimate::BodyEstimate, Vec<f64>)> {
    let q = problem
        .segments
        .first()?
        .samples
        .joint_position
        .get(..problem.tree.dof())?
        .to_vec();
    let mut kinematics = Kinematics::new(problem.tree);
    kinematics.place(problem.tree, &q);
    let arm: Vec<InertialParameters> = problem
        .model
        .bodies
        .iter()
        .map(|b| b.nominal.parameters())
        .collect();
    let whole = |base: &MassProperties| {
        let mut all = arm.clone();
        if let Some(first) = all.first_mut() {
            *first = base.parameters();
        }
        let c = composite(&all, &kinematics);
        MassProperties {
            mass: c.mass,
            p_BoBcm_B: c.p_BoScm_B(),
            I_BBcm_B: c.I_SScm_B(),
        }
    };
    let of = |u: &[f64; 10]| whole(&properties(u));
    Some((body(ten, "system".to_owned(), &whole(nominal), of), q))
}

type Covariance = (Vec<String>, Vec<&'static str>, Vec<Vec<f64>>);

fn covariance(ten: &Ten, name: &str) -> Covariance {
    let order = [0, 1, 2, 3].into_iter().chain(RESULT_ORDER.map(|k| 4 + k));
    let kept: Vec<usize> = order.filter(|&k| !ten.open[k]).collect();
    let label = |k: usize| match k {
        0 => format!("{name}.mass"),
        1..=3 => format!("{name}.com_{}", axis_name(k - 1)),
        _ => format!("{name}.inertia_{}", PAPER_NAMES[k - 4]),
    };
    let scale = ten.inflation * ten.inflation;
    (
        kept.iter().map(|&k| label(k)).collect(),
        kept.iter().map(|&k| unit(k)).collect(),
        kept.iter()
            .map(|&i| {
                kept.iter()
                    .map(|&j| scale * ten.covariance[(i, j)])
                    .collect()
            })
            .collect(),
    )
}

fn unit(k: usize) -> &'static str {
    match k {
        0 => "kg",
        1..=3 => "m",
        _ => "kg m2",
    }
}

fn momentum(
    problem: &Problem,
    given: Option<Known>,
    solved: &Solved,
    ten: &Ten,
) -> Vec<MomentumEstimate> {
    if let Some(k) = given {
        let one = MomentumEstimate {
            linear: [0, 1, 2].map(|i| Number::known(k.p_C_N[i])),
            angular: [0, 1, 2].map(|i| Number::known(k.h_C_N[i])),
        };
        return vec![one; problem.segments.len()];
    }
    let cov: &DMatrix<f64> = &solved.influence.covariance;
    let number = |value: f64, at: usize, open: bool| {
        if open {
            Number::open(0.0)
        } else {
            Number::data(value, ten.inflation * cov[(at, at)].sqrt(), 0.0)
        }
    };
    let (open_P, open_H) = (ten.open[..4].contains(&true), ten.open.contains(&true));
    solved
        .influence
        .momentum
        .iter()
        .enumerate()
        .map(|(s, (P, H))| MomentumEstimate {
            linear: [0, 1, 2].map(|k| number(P[k], 10 + 6 * s + k, open_P)),
            angular: [0, 1, 2].map(|k| number(H[k], 13 + 6 * s + k, open_H)),
        })
        .collect()
}

fn identifiability(name: &str, solved: &Solved, ten: &Ten, rejected: bool) -> Identifiability {
    let names: [String; 10] = std::array::from_fn(|k| match k {
        0 => format!("{name}.mass"),
        1..=3 => format!("{name}.com_{}", axis_name(k - 1)),
        _ => format!("{name}.I_BBcm_{}", PAPER_NAMES[k - 4]),
    });
    let mut found = Identifiability {
        parameters: 10,
        ..Identifiability::default()
    };
    let lone = solved.linear.usable == [true, false, false, false]
        || !ten.open[0] && ten.open[1..4].contains(&true);
    let (why, remedy) = if lone {
        (
            "the base hardly turns: the mass centre shows only in w x rho_S",
            "give the vehicle a spin, or move the arm about two axes",
        )
    } else {
        (
            "the velocities of the base change no more than their declared noise",
            "move the arm between configurations that differ as much as possible, or give the vehicle momentum (known-momentum)",
        )
    };
    describe(
        &mut found,
        &solved.linear,
        &names[..4],
        ten,
        0,
        (why, remedy),
        rejected,
    );
    match &solved.angular {
        Some((_, directions)) => {
            let why = "the angular velocity of the base does not reach all directions (with stopped joints it must come from an initial spin; a spin about one axis needs arm motion about two)";
            let remedy = "spin about two axes, move the arm about two axes, or keep moving samples";
            describe(
                &mut found,
                directions,
                &names[4..],
                ten,
                4,
                (why, remedy),
                rejected,
            );
        }
        None => {
            for name in &names[4..] {
                found.open.push(OpenCombination {
                    text: name.clone(),
                    coefficients: vec![(name.clone(), 1.0)],
                    reason: "step 2 needs mass and mass centre, which step 1 leaves open"
                        .to_owned(),
                    remedy: remedy.to_owned(),
                });
                found.sigmas_natural.push(f64::INFINITY);
            }
        }
    }
    found
}

/// Rank, sigmas, determined and open directions of one step.
fn describe<const N: usize>(
    found: &mut Identifiability,
    d: &Directions<N>,
    names: &[String],
    ten: &Ten,
    at: usize,
    (reason, remedy): (&str, &str),
    rejected: bool,
) {
    let complete = d.usable.iter().all(|u| *u);
    let floor = 32.0 * N as f64 * f64::EPSILON * d.singular[0].max(f64::MIN_POSITIVE);
    found.structural_rank += d.singular.iter().filter(|s| **s > floor).count();
    let natural: [f64; N] = std::array::from_fn(|i| {
        if at + i == 0 {
            ten.value[0]
        } else {
            d.natural[i]
        }
    });
    for j in 0..N {
        let sign = |i: usize| if at + i == 0 { -1.0 } else { 1.0 };
        // Sigma along the direction: its own diagonal of the covariance in natural units.
        let v: [f64; N] = std::array::from_fn(|i| sign(i) * d.V[(i, j)]);
        let variance: f64 = (0..N)
            .flat_map(|i| (0..N).map(move |k| (i, k)))
            .map(|(i, k)| {
                v[i] * v[k] * ten.covariance[(at + i, at + k)] / (natural[i] * natural[k])
            })
            .sum();
        let usable = d.usable[j] && !rejected;
        found.rank += usize::from(usable);
        found.sigmas_natural.push(if d.usable[j] {
            variance.sqrt()
        } else {
            f64::INFINITY
        });
        if complete && !rejected {
            continue;
        }
        let lead = (0..N).fold(0, |a, b| if v[b].abs() > v[a].abs() { b } else { a });
        let scale = natural[lead] / v[lead];
        let coefficients: Vec<(String, f64)> = (0..N)
            .filter(|&i| v[i].abs() > 1.0e-3)
            .map(|i| {
                // A determined combination weighs parameters, an open one moves them.
                let c = if usable {
                    v[i] / natural[i] * scale
                } else {
                    v[i] * natural[i]
                };
                (names[i].clone(), c)
            })
            .collect();
        let text = sentence(&coefficients);
        if usable {
            let value = (0..N)
                .filter(|&i| v[i].abs() > 1.0e-3)
                .map(|i| v[i] / natural[i] * scale * ten.value[at + i])
                .sum();
            found.determined.push(DeterminedCombination {
                text,
                coefficients,
                unit: unit(at + lead),
                value,
                sigma: ten.inflation * variance.sqrt() * scale.abs(),
            });
        } else {
            found.open.push(OpenCombination {
                text,
                coefficients,
                reason: if rejected {
                    "the answer is rejected".to_owned()
                } else {
                    reason.to_owned()
                },
                remedy: if rejected {
                    "see the warnings".to_owned()
                } else {
                    remedy.to_owned()
                },
            });
        }
    }
}

fn sentence(terms: &[(String, f64)]) -> String {
    let lead = terms
        .iter()
        .map(|t| t.1.abs())
        .fold(0.0, f64::max)
        .max(f64::MIN_POSITIVE);
    let mut text = String::new();
    for (name, c) in terms {
        let c = c / lead;
        let sign = match (text.is_empty(), c < 0.0) {
            (true, false) => "",
            (true, true) => "-",
            (false, false) => " + ",
            (false, true) => " - ",
        };
        text.push_str(&format!("{sign}{:.3} {name}", c.abs()));
    }
    text
}

fn warnings(
    problem: &Problem,
    solved: &Solved,
    ten: &Ten,
    contradicted: Option<f64>,
    rejected: bool,
    base: &crate::estimate::BodyEstimate,
) -> Vec<String> {
    let mut list = Vec::new();
    let chi2 = solved.chi2;
    if let Some(free) = contradicted {
        list.push(format!(
            "the momentum given contradicts the data: residuals are {:.1} times the declared noise with it and {:.1} times without; give linear_N_s and angular_N_m_s in N, angular about the system mass centre, at the first sample, or use --variant unknown-momentum",
            chi2.sqrt(), free.sqrt()
        ));
    } else if rejected {
        list.push(format!(
            "rigid model rejected: residuals are {:.1} times the declared noise and the model explains less than half of the data; check units, signs, joint axes, external forces",
            chi2.sqrt()
        ));
    } else if chi2 > MISFIT {
        list.push(format!(
            "residuals are {:.1} times the declared noise: sigmas are widened by that factor and the covariance is not trustworthy",
            chi2.sqrt()
        ));
    }
    let ratio = solved.x[0];
    if !ten.open[0] && !(STUDIED[0]..=STUDIED[1]).contains(&ratio) {
        list.push(format!(
            "the arm has {:.1} % of the base's mass; the paper studied 0.5 to 50 %",
            100.0 * ratio
        ));
    }
    if ratio <= 0.0 {
        list.push(
            "step 1 gives a negative mass: noise or a wrong model dominates it; no number is given"
                .to_owned(),
        );
    }
    let bias = problem
        .model
        .sensors_of(SensorKind::Gyro)
        .any(|s| s.bias != Nuisance::Known);
    if bias {
        list.push("the gyro's bias is declared unknown: ma2008 takes it as zero; --method auto estimates it".to_owned());
    }
    if problem
        .model
        .bodies
        .first()
        .is_some_and(|b| b.prior.is_some())
    {
        list.push("the base's prior is not used by ma2008".to_owned());
    }
    let relative = ten
        .bias
        .iter()
        .zip(&ten.value)
        .take(1)
        .map(|(b, v)| (b / v).abs());
    let worst = relative
        .chain(
            (4..10).map(|k| (ten.bias[k] / solved.linear.natural[1].powi(2) / ten.value[0]).abs()),
        )
        .fold(0.0, f64::max);
    if worst > 1.0e-6 && !rejected {
        list.push(format!(
            "noise in the regressor biases the two steps by up to {worst:.1e} of the nominal; the sigmas hold it, and maximum likelihood is free of it"
        ));
    }
    if base.physically_consistent == Some(false) {
        list.push(format!(
            "{}: no distribution of positive mass has this inertia tensor",
            base.name
        ));
    }
    list
}

/// Sec. IV with the declared noise: errors, bounds, condition numbers of both steps.
fn report(solved: &Solved) -> Vec<(String, f64, &'static str)> {
    let mut out = Vec::new();
    for (step, bound) in solved.bounds.iter().enumerate() {
        let n = step + 1;
        let unit = ["mixed (1, m)", "kg m2"][step.min(1)];
        out.push((
            format!("step {n}: condition number of the matrix"),
            bound.condition,
            "1",
        ));
        out.push((
            format!("step {n}: size of the matrix error, rms"),
            bound.epsilon_A,
            ["mixed", "rad/s"][step.min(1)],
        ));
        out.push((
            format!("step {n}: size of the right-hand side error, rms"),
            bound.epsilon_b,
            ["m/s", "N m s"][step.min(1)],
        ));
        out.push((
            format!("step {n}: first-order bound of the error, eq. (35)"),
            bound.absolute,
            unit,
        ));
        out.push((
            format!("step {n}: relative bound, eq. (36)"),
            bound.relative,
            "1",
        ));
    }
    out
}
