//! Both steps for the data of a model: solution, identifiability, residuals.

use super::arm::{Raw, Reading, Vehicle};
use super::bounds::{Bound, stated_angular, stated_linear};
use super::equations::{
    AngularRows, Given, LinearRows, angular_known, angular_rows, differences, linear_known,
    linear_rows,
};
use super::error::Ma2008Error;
use super::influence::{Influence, Setting, influence};
use super::solution::{Directions, Solution};
use super::solve::{Step, solve};
use super::sources::Source;
use nalgebra::{SMatrix, SVector};
use poinsot_identify::Problem;
use poinsot_spatial::{MassProperties, elements};

/// Fraction of a direction's squared regressor that may be noise; above it the direction is not used.
const NOISE_SHARE: f64 = 0.5;

/// Both steps with the effect of the declared noise.
pub(super) struct NoisySolution {
    pub(super) x: SVector<f64, 4>,
    pub(super) linear: Directions<4>,
    pub(super) angular: Option<(SVector<f64, 6>, Directions<6>)>,
    pub(super) influence: Influence,
    /// Larger of the two steps' residuals per degree of freedom, relative to the declared variance.
    pub(super) chi2: f64,
    /// Mean of both steps for each segment.
    pub(super) chi2_segment: Vec<f64>,
    /// Explained fraction of the right-hand sides.
    pub(super) explained: f64,
    pub(super) bounds: Vec<Bound>,
    pub(super) arm_mass: f64,
}

/// Common data of both steps.
struct Work<'a> {
    problem: &'a Problem<'a>,
    setting: Setting<'a>,
    readings: Vec<Vec<Reading>>,
    base: MassProperties,
    arm_mass: f64,
    /// Natural units of mass and length of the base.
    m: f64,
    L: f64,
}

pub(super) fn solve_both(
    problem: &Problem,
    vehicle: &mut Vehicle,
    data: &[Vec<Raw>],
    sources: &[(Source, f64)],
    given: Given,
) -> Result<NoisySolution, Ma2008Error> {
    let arm_mass = vehicle.arm_mass();
    let bodies = &problem.model.bodies;
    let base = bodies.first().map_or(MassProperties::ZERO, |b| b.nominal);
    let gyration = base.radius_of_gyration();
    let work = Work {
        problem,
        setting: Setting {
            segments: data,
            known: given,
            sources,
        },
        readings: data
            .iter()
            .map(|s| s.iter().map(|raw| vehicle.reading(raw)).collect())
            .collect(),
        arm_mass,
        m: if base.mass > 0.0 { base.mass } else { arm_mass },
        L: if gyration > 0.0 { gyration } else { 1.0 },
        base,
    };
    let mut solved = work.step1(vehicle)?;
    // Step 2 needs a complete step 1.
    if solved.linear.usable == [true; 4] && solved.x[0] > 0.0 {
        work.step2(vehicle, &mut solved)?;
    }
    Ok(solved)
}

impl Work<'_> {
    fn step1(&self, vehicle: &mut Vehicle) -> Result<NoisySolution, Ma2008Error> {
        let known = self.setting.known.p_C_N;
        let rows = differences(
            &self.readings,
            linear_rows,
            known.map(|p| linear_known(&p, self.arm_mass)),
        );
        let step: Step<4> = solve::<4, 5>(&rows);
        let natural = [self.arm_mass / self.m, self.L, self.L, self.L];
        let floor = round_off(self.readings.iter().flatten().map(linear_rows), &natural);
        let mut linear = Directions::new(&step, natural, floor).ok_or(Ma2008Error::NotFinite)?;
        let c = self.base.p_BoBcm_B;
        let nominal = SVector::<f64, 4>::new(natural[0], c.x, c.y, c.z);
        let alone = |x, linear: &Directions<4>, vehicle: &mut Vehicle| {
            let solution = Solution {
                x,
                linear,
                angular: None,
            };
            influence(vehicle, &self.setting, &solution)
        };
        let mut x = linear.solve(&step, &nominal);
        let mut effect = alone(x, &linear, vehicle);
        let variance: [f64; 4] = std::array::from_fn(|j| effect.covariance[(j, j)]);
        let accuracy = self.problem.relative_accuracy;
        if believe(&mut linear, &variance, &effect.linear.regressor, accuracy) {
            x = linear.solve(&step, &nominal);
            effect = alone(x, &linear, vehicle);
        }
        let expected = expected(effect.linear.residual, &effect, &linear, 0);
        let square = |r: &LinearRows| (r * up(&x)).norm_squared();
        let left: f64 = rows.iter().map(square).sum();
        let whole: f64 = rows.iter().map(|r| r.column(4).norm_squared()).sum();
        Ok(NoisySolution {
            chi2: left / expected,
            chi2_segment: shares(&self.readings, known.is_some(), &rows, square, expected),
            explained: 1.0 - left / whole.max(f64::MIN_POSITIVE),
            bounds: vec![stated_linear(&step, &effect)],
            x,
            linear,
            angular: None,
            influence: effect,
            arm_mass: self.arm_mass,
        })
    }

    fn step2(&self, vehicle: &mut Vehicle, solved: &mut NoisySolution) -> Result<(), Ma2008Error> {
        let (known, x) = (self.setting.known.h_C_N, solved.x);
        let (m_S, rho_S) = (self.arm_mass / x[0], x.fixed_rows::<3>(1).into_owned());
        let of = |s: &Reading| angular_rows(s, m_S, &rho_S);
        let rows: Vec<AngularRows> =
            differences(&self.readings, of, known.map(|h| angular_known(&h)));
        let step: Step<6> = solve::<6, 7>(&rows);
        let natural = [self.m * self.L * self.L; 6];
        let floor = round_off(self.readings.iter().flatten().map(of), &natural);
        let mut directions =
            Directions::new(&step, natural, floor).ok_or(Ma2008Error::NotFinite)?;
        let nominal = SVector::<f64, 6>::from(elements(&self.base.I_BBcm_B));
        let linear = &solved.linear;
        let both = |y, directions: &Directions<6>, vehicle: &mut Vehicle| {
            let angular = Some((y, directions));
            let solution = Solution { x, linear, angular };
            influence(vehicle, &self.setting, &solution)
        };
        let mut y = directions.solve(&step, &nominal);
        let mut effect = both(y, &directions, vehicle);
        let variance: [f64; 6] = std::array::from_fn(|j| effect.covariance[(4 + j, 4 + j)]);
        let accuracy = self.problem.relative_accuracy;
        if believe(
            &mut directions,
            &variance,
            &effect.angular.regressor,
            accuracy,
        ) {
            y = directions.solve(&step, &nominal);
            effect = both(y, &directions, vehicle);
        }
        let all = effect.angular.residual + effect.inherited;
        let expected = expected(all, &effect, &directions, 4);
        let square = |r: &AngularRows| (r * up6(&y)).norm_squared();
        let left: f64 = rows.iter().map(square).sum();
        let whole: f64 = rows.iter().map(|r| r.column(6).norm_squared()).sum();
        solved.chi2 = solved.chi2.max(left / expected);
        let second = shares(&self.readings, known.is_some(), &rows, square, expected);
        for (a, b) in solved.chi2_segment.iter_mut().zip(second) {
            *a = 0.5 * (*a + b);
        }
        let explained = 1.0 - left / whole.max(f64::MIN_POSITIVE);
        solved.explained = solved.explained.min(explained);
        solved.bounds.push(stated_angular(&step, &effect));
        solved.angular = Some((y, directions));
        solved.influence = effect;
        Ok(())
    }
}

fn up(x: &SVector<f64, 4>) -> SVector<f64, 5> {
    SVector::from_iterator(x.iter().copied().chain([1.0]))
}

fn up6(y: &SVector<f64, 6>) -> SVector<f64, 7> {
    SVector::from_iterator(y.iter().copied().chain([1.0]))
}

/// Round-off level of the singular values, which come from differences of rounded numbers.
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

/// Keeps the directions with sigma below the wanted accuracy and signal above the noise in the regressor. Returns
/// whether any was dropped.
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

/// Expected residual under the declared noise: `E ||e||^2` minus the fitted part `E ||A dx||^2`. `at` is the index of
/// the step's directions in the covariance.
fn expected<const N: usize>(all: f64, effect: &Influence, d: &Directions<N>, at: usize) -> f64 {
    let fitted: f64 = (0..N)
        .filter(|&j| d.usable[j])
        .map(|j| d.singular[j] * d.singular[j] * effect.covariance[(at + j, at + j)])
        .sum();
    (all - fitted).max(f64::MIN_POSITIVE)
}

/// Residual of every segment relative to the expected residual.
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
