//! Both steps for the data of a model: solution, identifiability, residuals.

use super::arm::{Raw, Reading, Vehicle};
use super::bounds::{Bound, stated_angular, stated_linear};
use super::equations::{
    Given, angular_known, angular_rows, differences, linear_known, linear_rows,
};
use super::influence::{Influence, Setting, Source, StepNoise, influence};
use super::solve::{Directions, Solution, Step, solve};
use nalgebra::{SMatrix, SVector};
use poinsot_files::{Faults, Place};
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
    let mut readings = |s: &Vec<Raw>| s.iter().map(|raw| vehicle.reading(raw)).collect();
    let work = Work {
        problem,
        setting: Setting {
            segments: data,
            known: given,
            sources,
        },
        readings: data.iter().map(&mut readings).collect(),
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

/// A step as posed: unknowns in natural units, and the index of its first direction in the covariance.
struct Posed<const N: usize> {
    natural: [f64; N],
    nominal: SVector<f64, N>,
    at: usize,
}

/// One step within the directions that its data support.
struct Found<const N: usize> {
    step: Step<N>,
    x: SVector<f64, N>,
    directions: Directions<N>,
    effect: Influence,
    /// Residual per degree of freedom, relative to the declared variance.
    chi2: f64,
    of_segments: Vec<f64>,
    /// Explained fraction of the right-hand side.
    explained: f64,
}

impl Work<'_> {
    fn step1(&self, vehicle: &mut Vehicle) -> Result<NoisySolution, Faults> {
        let known = self.setting.known.p_C_N;
        let known = known.map(|p| linear_known(&p, self.arm_mass));
        let c = self.base.p_BoBcm_B;
        let ratio = self.arm_mass / self.m;
        let posed = Posed {
            natural: [ratio, self.L, self.L, self.L],
            nominal: SVector::<f64, 4>::new(ratio, c.x, c.y, c.z),
            at: 0,
        };
        let alone = |x, linear: &Directions<4>| {
            let solution = Solution {
                x,
                linear,
                angular: None,
            };
            influence(vehicle, &self.setting, &solution)
        };
        let of = |effect: &Influence| (effect.linear.clone(), 0.0);
        let found = self.step::<4, 5>(linear_rows, known, &posed, alone, of)?;
        Ok(NoisySolution {
            chi2: found.chi2,
            chi2_segment: found.of_segments,
            explained: found.explained,
            bounds: vec![stated_linear(&found.step, &found.effect)],
            x: found.x,
            linear: found.directions,
            angular: None,
            influence: found.effect,
            arm_mass: self.arm_mass,
        })
    }

    fn step2(&self, vehicle: &mut Vehicle, solved: &mut NoisySolution) -> Result<(), Faults> {
        let x = solved.x;
        let (m_S, rho_S) = (self.arm_mass / x[0], x.fixed_rows::<3>(1).into_owned());
        let rows = |s: &Reading| angular_rows(s, m_S, &rho_S);
        let known = self.setting.known.h_C_N.map(|h| angular_known(&h));
        let posed = Posed {
            natural: [self.m * self.L * self.L; 6],
            nominal: SVector::<f64, 6>::from(elements(&self.base.I_BBcm_B)),
            at: 4,
        };
        let both = |y, directions: &Directions<6>| {
            let solution = Solution {
                x,
                linear: &solved.linear,
                angular: Some((y, directions)),
            };
            influence(vehicle, &self.setting, &solution)
        };
        let of = |effect: &Influence| (effect.angular.clone(), effect.inherited);
        let found = self.step::<6, 7>(rows, known, &posed, both, of)?;
        solved.chi2 = solved.chi2.max(found.chi2);
        for (a, b) in solved.chi2_segment.iter_mut().zip(found.of_segments) {
            *a = 0.5 * (*a + b);
        }
        solved.explained = solved.explained.min(found.explained);
        let bound = stated_angular(&found.step, &found.effect);
        solved.bounds.push(bound);
        solved.angular = Some((found.x, found.directions));
        solved.influence = found.effect;
        Ok(())
    }

    /// Solves a step, and again without the directions that the noise hides. `influence` propagates the noise, and `of`
    /// gives its effect on this step with what the step inherits from the other one.
    fn step<const N: usize, const W: usize>(
        &self,
        row: impl Fn(&Reading) -> SMatrix<f64, 3, W>,
        known: Option<SMatrix<f64, 3, W>>,
        posed: &Posed<N>,
        mut influence: impl FnMut(SVector<f64, N>, &Directions<N>) -> Influence,
        of: impl Fn(&Influence) -> (StepNoise<N>, f64),
    ) -> Result<Found<N>, Faults> {
        let rows = differences(&self.readings, &row, known);
        let step = solve::<N, W>(&rows);
        // Round-off of the singular values, which come from differences of rounded numbers.
        let columns = |r: SMatrix<f64, 3, W>| {
            let square = |j: usize| (r.column(j) * posed.natural[j]).norm_squared();
            (0..N).map(square).sum::<f64>()
        };
        let readings = self.readings.iter().flatten();
        let square: f64 = readings.map(|s| columns(row(s))).sum();
        let floor = 64.0 * f64::EPSILON * square.sqrt();
        let directions = Directions::new(&step, posed.natural, floor);
        let mut directions = directions.ok_or_else(|| {
            Faults::one(
                "E0529",
                Place::default(),
                "the equations hold a number that is not finite",
                "check units and magnitudes of the telemetry",
            )
        })?;
        let mut x = directions.solve(&step, &posed.nominal);
        let mut effect = influence(x, &directions);
        let variance =
            |effect: &Influence, j: usize| effect.covariance[(posed.at + j, posed.at + j)];
        let believed: [bool; N] = std::array::from_fn(|j| {
            let v = SVector::<f64, N>::from_fn(|i, _| directions.V[(i, j)] * posed.natural[i]);
            let noise = (of(&effect).0.regressor * v).dot(&v);
            directions.usable[j]
                && variance(&effect, j).sqrt() < self.problem.relative_accuracy
                && noise <= NOISE_SHARE * directions.singular[j] * directions.singular[j]
        });
        if believed != directions.usable {
            directions.usable = believed;
            x = directions.solve(&step, &posed.nominal);
            effect = influence(x, &directions);
        }
        // Expected residual under the declared noise: `E ||e||^2` minus the fitted part `E ||A dx||^2`.
        let (noise, inherited) = of(&effect);
        let usable = (0..N).filter(|&j| directions.usable[j]);
        let fitted = usable.map(|j| directions.singular[j].powi(2) * variance(&effect, j));
        let expected = (noise.residual + inherited - fitted.sum::<f64>()).max(f64::MIN_POSITIVE);
        let x1 = SVector::<f64, W>::from_fn(|i, _| if i < N { x[i] } else { 1.0 });
        let square = |rows: &[SMatrix<f64, 3, W>]| -> f64 {
            rows.iter().map(|r| (r * x1).norm_squared()).sum()
        };
        let right = rows.iter().map(|r| r.column(N).norm_squared());
        let (left, whole): (f64, f64) = (square(&rows), right.sum());
        let total = rows.len().max(1) as f64;
        let mut rest = rows.as_slice();
        let of_segment = |segment: &Vec<Reading>| {
            let count = segment.len().saturating_sub(usize::from(known.is_none()));
            let (own, others) = rest.split_at(count.min(rest.len()));
            rest = others;
            square(own) / (expected * count as f64 / total).max(f64::MIN_POSITIVE)
        };
        Ok(Found {
            chi2: left / expected,
            of_segments: self.readings.iter().map(of_segment).collect(),
            explained: 1.0 - left / whole.max(f64::MIN_POSITIVE),
            step,
            x,
            directions,
            effect,
        })
    }
}
