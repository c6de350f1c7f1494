//! Both steps for the data of a model: solution, identifiability, residuals.

use super::arm::{Raw, Reading, Vehicle};
use super::bounds::{Bound, stated_angular, stated_linear};
use super::equations::{
    Given, angular_known, angular_rows, differences, linear_known, linear_rows,
};
use super::influence::{Influence, Setting, influence};
use super::solution::{Directions, Solution};
use super::solve::{Step, solve};
use super::sources::Source;
use crate::ma2008::error;
use nalgebra::{SMatrix, SVector};
use poinsot_files::Faults;
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
) -> Result<NoisySolution, Faults> {
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

/// One step within the directions that its data support.
struct Supported<const N: usize> {
    step: Step<N>,
    x: SVector<f64, N>,
    directions: Directions<N>,
    effect: Influence,
}

/// How a solution fits the rows of a step.
struct Fit {
    /// Residual per degree of freedom, relative to the declared variance.
    chi2: f64,
    of_segments: Vec<f64>,
    explained: f64,
}

impl Work<'_> {
    fn step1(&self, vehicle: &mut Vehicle) -> Result<NoisySolution, Faults> {
        let known = self.setting.known.p_C_N;
        let reference = known.map(|p| linear_known(&p, self.arm_mass));
        let rows = differences(&self.readings, linear_rows, reference);
        let natural = [self.arm_mass / self.m, self.L, self.L, self.L];
        let floor = round_off(self.readings.iter().flatten().map(linear_rows), &natural);
        let c = self.base.p_BoBcm_B;
        let nominal = SVector::<f64, 4>::new(natural[0], c.x, c.y, c.z);
        let alone = |x, linear: &Directions<4>| {
            let solution = Solution {
                x,
                linear,
                angular: None,
            };
            let effect = influence(vehicle, &self.setting, &solution);
            (effect.linear.regressor, effect)
        };
        let found = self.supported(solve::<4, 5>(&rows), (natural, floor, nominal), 0, alone)?;
        let expected = found.expected(found.effect.linear.residual, 0);
        let fit = self.fit(&rows, &found.x.push(1.0), known.is_some(), expected);
        Ok(NoisySolution {
            chi2: fit.chi2,
            chi2_segment: fit.of_segments,
            explained: fit.explained,
            bounds: vec![stated_linear(&found.step, &found.effect)],
            x: found.x,
            linear: found.directions,
            angular: None,
            influence: found.effect,
            arm_mass: self.arm_mass,
        })
    }

    fn step2(&self, vehicle: &mut Vehicle, solved: &mut NoisySolution) -> Result<(), Faults> {
        let (known, x) = (self.setting.known.h_C_N, solved.x);
        let (m_S, rho_S) = (self.arm_mass / x[0], x.fixed_rows::<3>(1).into_owned());
        let of = |s: &Reading| angular_rows(s, m_S, &rho_S);
        let rows = differences(&self.readings, of, known.map(|h| angular_known(&h)));
        let natural = [self.m * self.L * self.L; 6];
        let floor = round_off(self.readings.iter().flatten().map(of), &natural);
        let nominal = SVector::<f64, 6>::from(elements(&self.base.I_BBcm_B));
        let both = |y, directions: &Directions<6>| {
            let solution = Solution {
                x,
                linear: &solved.linear,
                angular: Some((y, directions)),
            };
            let effect = influence(vehicle, &self.setting, &solution);
            (effect.angular.regressor, effect)
        };
        let found = self.supported(solve::<6, 7>(&rows), (natural, floor, nominal), 4, both)?;
        let all = found.effect.angular.residual + found.effect.inherited;
        let expected = found.expected(all, 4);
        let fit = self.fit(&rows, &found.x.push(1.0), known.is_some(), expected);
        solved.chi2 = solved.chi2.max(fit.chi2);
        for (a, b) in solved.chi2_segment.iter_mut().zip(fit.of_segments) {
            *a = 0.5 * (*a + b);
        }
        solved.explained = solved.explained.min(fit.explained);
        solved
            .bounds
            .push(stated_angular(&found.step, &found.effect));
        solved.angular = Some((found.x, found.directions));
        solved.influence = found.effect;
        Ok(())
    }

    /// Solves a step, and again without the directions that the noise hides. `influence` gives the noise in the
    /// regressor and all effects; `at` is the index of the step's directions in the covariance.
    fn supported<const N: usize>(
        &self,
        step: Step<N>,
        (natural, floor, nominal): ([f64; N], f64, SVector<f64, N>),
        at: usize,
        mut influence: impl FnMut(SVector<f64, N>, &Directions<N>) -> (SMatrix<f64, N, N>, Influence),
    ) -> Result<Supported<N>, Faults> {
        let mut directions =
            Directions::new(&step, natural, floor).ok_or_else(error::not_finite)?;
        let mut x = directions.solve(&step, &nominal);
        let (regressor, mut effect) = influence(x, &directions);
        let variance: [f64; N] = std::array::from_fn(|j| effect.covariance[(at + j, at + j)]);
        let accuracy = self.problem.relative_accuracy;
        if believe(&mut directions, &variance, &regressor, accuracy) {
            x = directions.solve(&step, &nominal);
            effect = influence(x, &directions).1;
        }
        Ok(Supported {
            step,
            x,
            directions,
            effect,
        })
    }

    /// Residuals of `T x1`, relative to the expected ones.
    fn fit<const W: usize>(
        &self,
        rows: &[SMatrix<f64, 3, W>],
        x1: &SVector<f64, W>,
        known: bool,
        expected: f64,
    ) -> Fit {
        let square = |rows: &[SMatrix<f64, 3, W>]| -> f64 {
            rows.iter().map(|r| (r * x1).norm_squared()).sum()
        };
        let right = |r: &SMatrix<f64, 3, W>| r.column(W - 1).norm_squared();
        let (left, whole): (f64, f64) = (square(rows), rows.iter().map(right).sum());
        let total = rows.len().max(1) as f64;
        let mut at = 0;
        let of_segment = |segment: &Vec<Reading>| {
            let count = segment.len() - usize::from(!known && !segment.is_empty());
            let own = rows.get(at..at + count).unwrap_or(&[]);
            at += count;
            square(own) / (expected * count as f64 / total).max(f64::MIN_POSITIVE)
        };
        Fit {
            chi2: left / expected,
            of_segments: self.readings.iter().map(of_segment).collect(),
            explained: 1.0 - left / whole.max(f64::MIN_POSITIVE),
        }
    }
}

impl<const N: usize> Supported<N> {
    /// Expected residual under the declared noise: `E ||e||^2` minus the fitted part `E ||A dx||^2`.
    fn expected(&self, all: f64, at: usize) -> f64 {
        let d = &self.directions;
        let fitted: f64 = (0..N)
            .filter(|&j| d.usable[j])
            .map(|j| d.singular[j] * d.singular[j] * self.effect.covariance[(at + j, at + j)])
            .sum();
        (all - fitted).max(f64::MIN_POSITIVE)
    }
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
