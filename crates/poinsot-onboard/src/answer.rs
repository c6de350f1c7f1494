//! Numbers that leave the filter.

use crate::configuration::ITERATIONS;
use crate::filter::Filter;
use crate::health::Health;
use crate::numbers::{AXES, NUMBERS, PARAMETERS};
use nalgebra::SymmetricEigen;
use poinsot_spatial::{InertialParameters, pseudo_inertia};

/// Share of the prior's sigma below which a number counts as determined: the data say three times as much as the prior.
const DETERMINED: f64 = 0.5;

/// One parameter.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Number {
    /// Its value in SI: that of a physical body.
    pub value: f64,
    /// One sigma; zero where it is known.
    pub sigma: f64,
    /// Whether the data determine it and the filter is consistent.
    pub determined: bool,
}

/// What a filter knows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Answer {
    /// What the numbers are worth.
    pub health: Health,
    /// The ten parameters of the unknown body about `Bo`, in the order of `poinsot_spatial::PARAMETER_NAMES`.
    pub numbers: [Number; PARAMETERS],
    /// Covariance of the unknown ones, in the same order.
    pub covariance: [[f64; PARAMETERS]; PARAMETERS],
    /// Number of unknown ones.
    pub unknowns: usize,
}

impl<const N: usize, const WINDOW: usize> Filter<N, WINDOW> {
    /// What is known at a time, s, on the clock of the samples.
    pub fn answer(&self, time_s: f64) -> Answer {
        let (layout, count) = (self.layout, self.layout.numbers);
        let info = self.of_parameters();
        let change = info.solution(count).unwrap_or([0.0; NUMBERS]);
        let mut body = core::array::from_fn(|k| self.numbers[k]);
        for (&k, change) in layout.unknown().iter().zip(&change) {
            body[k] += change;
        }
        let body = physical(&body);
        let sigma = info.sigma(count);
        let mut numbers = body.map(|value| Number {
            value,
            ..Number::default()
        });
        let (mut all, consistent) = (self.window.replayed, self.tests.consistent);
        for (j, &k) in layout.unknown().iter().enumerate() {
            let determined = sigma[j] < DETERMINED * self.prior_sigma[k];
            all &= determined;
            numbers[k].sigma = sigma[j];
            numbers[k].determined = determined && consistent && self.window.replayed;
        }
        let newest = self.stream.newest();
        let stale = newest.is_some_and(|newest| time_s - newest > self.configuration.stale_s);
        Answer {
            health: match (consistent, stale, all) {
                (false, _, _) => Health::Inconsistent,
                (true, true, _) => Health::Stale,
                (true, false, true) => Health::Determined,
                (true, false, false) => Health::Converging,
            },
            numbers,
            covariance: info.covariance(layout.unknown, count),
            unknowns: layout.unknown,
        }
    }
}

/// The nearest body that some distribution of mass has: negative eigenvalues of the pseudo-inertia become zero.
fn physical(body: &[f64; PARAMETERS]) -> [f64; PARAMETERS] {
    let parameters = InertialParameters::from_array(body);
    let eigen = SymmetricEigen::try_new(pseudo_inertia(&parameters), f64::EPSILON, ITERATIONS);
    let Some(eigen) = eigen.filter(|e| e.eigenvalues.iter().any(|x| *x < 0.0)) else {
        return *body;
    };
    let cut = eigen.eigenvalues.map(|x| x.max(0.0));
    let J = eigen.eigenvectors
        * nalgebra::Matrix4::from_diagonal(&cut)
        * eigen.eigenvectors.transpose();
    let sigma = J.fixed_view::<AXES, AXES>(0, 0).into_owned();
    let I_BBo_B = nalgebra::Matrix3::identity() * sigma.trace() - sigma;
    InertialParameters {
        mass: J[(3, 3)],
        mc_B: J.fixed_view::<AXES, 1>(0, 3).into_owned(),
        I_BBo_B,
    }
    .to_array()
}
