//! Sigmas of a few numbers of one experiment, without a full answer: a search over manoeuvres evaluates them thousands
//! of times.

use crate::fit::alternatives::{OtherWheelMotion, with_smooth_wheels};
use crate::fit::experiment::Experiment;
use crate::fit::step::linearised;
use crate::problem::parameters::Parameters;
use crate::problem::quantity::mass_property;
use crate::problem::refusal::no_motion;
use crate::problem::{Problem, ProblemError};
use faer::Mat;
use nalgebra::{DMatrix, DVector};
use poinsot_solve::BlockQr;
use poinsot_solve::LeastSquares;

/// Sigma in natural units that stands for "not identifiable": large enough to leave identifiable numbers unchanged, and
/// finite, so that a search can rank manoeuvres.
const VAGUE: f64 = 1.0e4;

/// Integration steps of a fit that one step of a rough evaluation replaces.
pub const ROUGH: u32 = 4;

/// Slope of a number that no equation of the experiment holds: its sigma is then huge, and finite.
const UNSEEN: f64 = 1.0e100;

/// A number with its factor in a sum.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WantedTerm {
    /// Index of the body in the model.
    pub body: usize,
    /// Which number, by its place in [`poinsot_spatial::MASS_PROPERTY_NAMES`].
    pub number: usize,
    /// Factor.
    pub factor: f64,
}

/// Fisher information of one experiment at the model's numbers; pose, momentum and biases are unknown too.
pub struct Information {
    parameters: Parameters,
    x: Vec<f64>,
    /// Triangle of all shared unknowns, with the vague rows.
    r: DMatrix<f64>,
    /// The other motion of the wheels between samples, where it counts.
    other: Option<OtherWheelMotion>,
    /// How many samples each sample stands for.
    weight: f64,
}

impl Information {
    /// Evaluates the experiment, with what it adds that such measurements can hardly tell what the wheels do between samples.
    /// `with_priors`: declared priors of mass properties count. One integration step stands for `steps`, and each sample for
    /// `weight` samples. With [`ROUGH`] steps sigmas are the same to the third digit in a quarter of the time, for a search that
    /// evaluates thousands and ends with the whole; one sample where wheels turn, since what they do between samples depends
    /// on how far these are apart.
    ///
    /// # Errors
    /// The model or the data are not valid for the method.
    pub fn of(
        problem: &Problem,
        with_priors: bool,
        (steps, weight): (u32, f64),
    ) -> Result<Self, ProblemError> {
        problem.check_observations()?;
        let parameters = problem.likelihood_parameters()?;
        let mut experiment = Experiment::new(problem, &parameters).coarse(steps);
        experiment.weight = weight;
        let point = experiment.nominal_point();
        let evaluated = experiment.evaluate(&point, true).ok_or_else(no_motion)?;
        let stacked = experiment.stack(&point, &evaluated, with_priors);
        let r = with_vague_rows(&stacked.r, &parameters);
        let smooth = with_smooth_wheels(&experiment).and_then(|e| e.linearise(&point));
        let expected = |smooth| -> Result<OtherWheelMotion, ProblemError> {
            let held = linearised(&experiment, &point, evaluated)?;
            let there = (&experiment, &point);
            Ok(OtherWheelMotion::expected(there, &held, &smooth))
        };
        let other = smooth.map(expected).transpose()?;
        Ok(Self {
            r,
            x: point.x,
            parameters,
            other,
            weight,
        })
    }

    /// Covariance of sums of numbers, one row and column per sum. Numbers that are known contribute nothing; a sum
    /// that the experiment does not show has a huge variance.
    pub fn covariance(&self, sums: &[Vec<WantedTerm>]) -> DMatrix<f64> {
        let n = self.parameters.len();
        let mut white = DMatrix::zeros(n, sums.len());
        let mut changes = Vec::with_capacity(sums.len());
        for (k, sum) in sums.iter().enumerate() {
            let gradient = DVector::from_vec(self.gradient(sum));
            let other = self.other.as_ref();
            changes.push(other.map_or(0.0, |o| o.change(gradient.as_slice())));
            // sigma^2 = |R^-T g|^2.
            let column = self.r.tr_solve_upper_triangular(&gradient);
            white.set_column(
                k,
                &column.unwrap_or_else(|| DVector::repeat(n, f64::INFINITY)),
            );
        }
        let mut covariance = white.transpose() * white / self.weight;
        if let Some(other) = &self.other {
            let added = |i, j| other.covariance(changes[i], changes[j]);
            covariance += DMatrix::from_fn(sums.len(), sums.len(), added);
        }
        covariance
    }

    fn gradient(&self, sum: &[WantedTerm]) -> Vec<f64> {
        let mut gradient = vec![0.0; self.parameters.len()];
        for term in sum {
            let own = self.of_number(term);
            for (g, o) in gradient.iter_mut().zip(own) {
                *g += term.factor * o;
            }
        }
        gradient
    }

    fn of_number(&self, term: &WantedTerm) -> Vec<f64> {
        let p = &self.parameters;
        if !p.estimate[term.body].has(term.number) {
            return vec![0.0; p.len()];
        }
        // Rotation alone never shows the mass.
        let shown = mass_property(p, term.body, term.number, &self.x);
        shown.map_or_else(|| vec![UNSEEN; p.len()], |quantity| quantity.gradient)
    }
}

/// The triangle of the unknowns with one vague row each.
fn with_vague_rows(r: &Mat<f64>, parameters: &Parameters) -> DMatrix<f64> {
    let n = parameters.len();
    let mut stacked = BlockQr::new(n);
    stacked.push(r.nrows().min(n), |i, j| r[(i, j)]);
    let natural = |i: usize| match parameters.unknowns[i].natural {
        unit if unit.is_finite() && unit > 0.0 => unit,
        _ => 1.0,
    };
    stacked.push_diagonal(n, |i| 1.0 / (VAGUE * natural(i)));
    let r = stacked.finish().r;
    DMatrix::from_fn(n, n, |i, j| if j < i { 0.0 } else { r[(i, j)] })
}
