//! Noisy trials of both options.

use super::experiment::{Run, readings};
use crate::ma2008::{Raw, Reading, TwoStep, two_step};
use crate::study::statistics::Normals;
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

/// Errors of one answer: mass (relative), mass centre (m), tensor (relative to its norm). Infinite without an answer.
pub type Errors = [f64; 3];

impl Run {
    /// The true base.
    pub fn truth(&self) -> MassProperties {
        self.model.bodies[0].nominal
    }

    /// A fraction of the maxima of the velocities.
    pub fn sigma(&self, share: f64, scaling: Scaling) -> Sigma {
        let most = |of: &dyn Fn(&Raw) -> Vector3| {
            let larger = |m: Vector3, r: &Raw| m.zip_map(&of(r), |a, b| a.max(b.abs()));
            self.raws.iter().fold(Vector3::zeros(), larger)
        };
        let (mut v, mut w) = (most(&|r| r.v_NBo_N), most(&|r| r.w_NB_B));
        if scaling == Scaling::Largest {
            v = Vector3::repeat(v.amax());
            w = Vector3::repeat(w.amax());
        }
        Sigma {
            v: v * share,
            w: w * share,
        }
    }

    /// The samples in the form used by both steps.
    pub fn readings(&self) -> Vec<Reading> {
        readings(&self.model, &self.raws)
    }

    /// The samples with one draw of noise.
    pub fn noisy(&self, sigma: Sigma, seed: u64) -> Vec<Raw> {
        let mut normals = Normals::new(SEED, seed);
        let moved = |r: &Raw| {
            let mut r = r.clone();
            r.v_NBo_N += sigma.v.component_mul(&normals.vector());
            r.w_NB_B += sigma.w.component_mul(&normals.vector());
            r
        };
        self.raws.iter().map(moved).collect()
    }

    /// Both steps for samples of this run.
    pub fn solved(&self, raws: &[Raw], known: bool) -> TwoStep {
        let samples = readings(&self.model, raws);
        two_step(&[samples], known.then_some(self.known))
    }

    /// Errors of an answer.
    pub fn errors(&self, found: Option<MassProperties>) -> Errors {
        let Some(found) = found else {
            return [f64::INFINITY; 3];
        };
        let truth = self.truth();
        let I = &truth.I_BBcm_B;
        let errors = [
            (found.mass / truth.mass - 1.0).abs(),
            (found.p_BoBcm_B - truth.p_BoBcm_B).norm(),
            (found.I_BBcm_B - I).norm() / I.norm(),
        ];
        errors.map(|e| if e.is_nan() { f64::INFINITY } else { e })
    }

    fn errors_of(&self, raws: &[Raw], known: bool) -> Errors {
        let answer = self.solved(raws, known);
        self.errors(answer.I_S().map(|I_BBcm_B| MassProperties {
            mass: answer.mass(),
            p_BoBcm_B: answer.rho_S(),
            I_BBcm_B,
        }))
    }

    /// Errors of many trials of one option.
    pub fn trials(&self, sigma: Sigma, known: bool, seeds: u64) -> Vec<Errors> {
        let one = |seed| self.errors_of(&self.noisy(sigma, seed), known);
        (0..seeds).map(one).collect()
    }
}
