//! Noisy trials of both options.

use super::experiment::{Experiment, Run, readings};
use crate::ma2008::{Known, Raw, Reading, two_step};
use crate::study::statistics::{Normals, largest, median};
use crate::study::{Context, StudyError};
use poinsot_spatial::{MassProperties, Vector3};

/// Trials of one cell.
pub const SEEDS: u64 = 200;
/// Seed of all trials; each uses its own stream.
const SEED: u64 = 2008;
/// Whether the momentum is known: option 1, then option 2.
pub const OPTIONS: [bool; 2] = [true, false];

/// One sigma of each velocity component: linear in N, m/s; angular in B, rad/s.
#[derive(Debug, Clone, Copy)]
pub struct Sigma {
    /// Linear.
    pub v: Vector3,
    /// Angular.
    pub w: Vector3,
}

/// Interpretation of "a percentage of the maximum velocity value".
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scaling {
    /// Of the maximum of each component.
    Component,
    /// Of the largest linear and the largest angular component.
    Largest,
}

impl Scaling {
    /// Name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Component => "each component's own maximum",
            Self::Largest => "largest component's maximum",
        }
    }
}

impl Sigma {
    /// A fraction of the maxima of a run.
    pub fn of(run: &Run, share: f64, scaling: Scaling) -> Self {
        let most = |of: &dyn Fn(&Raw) -> Vector3| {
            let all = run.raws.iter();
            all.fold(Vector3::zeros(), |m, r| {
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

    /// A fixed noise: 1 % of the largest components of trajectory 1 at 5 deg/s.
    ///
    /// # Errors
    /// The model cannot be read.
    pub fn fixed(context: &Context) -> Result<Self, StudyError> {
        let run = Experiment::of(context, 1, [0.0, 0.0, 5.0])?.run()?;
        Ok(Self::of(&run, 0.01, Scaling::Largest))
    }
}

/// The samples of a run with one draw of noise.
pub fn draw(raws: &[Raw], sigma: Sigma, seed: u64) -> Vec<Raw> {
    let mut normals = Normals::new(SEED, seed);
    let moved = |r: &Raw| {
        let mut r = r.clone();
        r.v_NBo_N += sigma.v.component_mul(&normals.vector());
        r.w_NB_B += sigma.w.component_mul(&normals.vector());
        r
    };
    raws.iter().map(moved).collect()
}

/// Errors of one answer: mass (relative), mass centre (m), tensor (relative to its norm). Infinite without an answer.
pub type Errors = [f64; 3];

/// Errors of an answer.
pub fn errors(found: Option<MassProperties>, truth: &MassProperties) -> Errors {
    let Some(found) = found else {
        return [f64::INFINITY; 3];
    };
    let I = &truth.I_BBcm_B;
    let errors = [
        (found.mass / truth.mass - 1.0).abs(),
        (found.p_BoBcm_B - truth.p_BoBcm_B).norm(),
        (found.I_BBcm_B - I).norm() / I.norm(),
    ];
    errors.map(|e| if e.is_nan() { f64::INFINITY } else { e })
}

/// Solution of the two steps as mass properties.
pub fn solved(samples: &[Reading], known: Option<Known>) -> Option<MassProperties> {
    let answer = two_step(&[samples.to_vec()], known);
    Some(MassProperties {
        mass: answer.mass(),
        p_BoBcm_B: answer.rho_S(),
        I_BBcm_B: answer.I_S()?,
    })
}

/// Largest of the three errors for exact data.
pub fn worst(e: &Experiment, run: &Run, known: bool) -> f64 {
    let samples = readings(&e.model, &run.raws);
    largest(errors(
        solved(&samples, known.then_some(run.known)),
        &e.truth(),
    ))
}

/// Errors of many trials of one option.
pub fn trials(e: &Experiment, run: &Run, sigma: Sigma, known: bool, seeds: u64) -> Vec<Errors> {
    let one = |seed| {
        let samples = readings(&e.model, &draw(&run.raws, sigma, seed));
        errors(solved(&samples, known.then_some(run.known)), &e.truth())
    };
    (0..seeds).map(one).collect()
}

/// Median of each error over [`SEEDS`] trials.
pub fn medians(e: &Experiment, run: &Run, sigma: Sigma, known: bool) -> Errors {
    let found = trials(e, run, sigma, known, SEEDS);
    std::array::from_fn(|k| median(found.iter().map(|x| x[k])))
}
