//! A nonlinear set as a problem for Levenberg-Marquardt.

use crate::nist::data::Data;
use crate::nist::dual::Dual;
use crate::nist::models::{Model, response};
use poinsot_solve::{
    BlockQr, LeastSquares, Linearised, Minimum, Spectrum, Step, levenberg_marquardt,
};

/// Converged if the full step changes every parameter by less, relative.
const SETTLED: f64 = 1.0e-14;
const ITERATIONS: usize = 3000;
/// Largest growth of a unit per iteration. More 1978 allows none, Marquardt 1963 any: the first never forgets a bad
/// start, the second follows an ineffective parameter to infinity. From 1.1 to 3 all 54 fits succeed.
const UNIT_GROWTH: f64 = 2.0;
/// Fraction of a step over which its curvature is measured (Transtrum and Sethna 2012, section 3).
const PROBE: f64 = 0.1;
/// Round-off of a residual, in units in the last place of the response.
const ULPS: f64 = 16.0;

/// A model and its data.
pub struct Regression {
    model: Model,
    /// Response and predictors.
    rows: Vec<(f64, Vec<f64>)>,
}

/// Parameters, and their units in the last step.
pub struct Iterate {
    pub b: Vec<f64>,
    unit: Vec<f64>,
}

/// Residuals with gradients, their triangle decomposed in units, and its right-hand side.
pub struct Linearisation {
    residuals: Vec<Dual>,
    spectrum: Spectrum,
    rhs: Vec<f64>,
}

impl Regression {
    pub fn new(name: &str, model: Model, data: &Data) -> Self {
        let row = |r: Vec<f64>| (response(name, r[0]), r[1..].to_vec());
        Self {
            model,
            rows: data.numbers().into_iter().map(row).collect(),
        }
    }

    pub fn fit(&self, start: &[f64]) -> Minimum<Iterate, Linearisation> {
        let start = Iterate {
            b: start.to_vec(),
            unit: vec![f64::INFINITY; start.len()],
        };
        let here = self.linearise(&start).unwrap();
        levenberg_marquardt(self, start, here, ITERATIONS)
    }

    /// Standard deviations of the parameters.
    pub fn sigma(&self, minimum: &Minimum<Iterate, Linearisation>) -> Vec<f64> {
        let covariance = minimum.here.rows.spectrum.covariance();
        let n = minimum.at.b.len();
        let variance = minimum.here.cost / (self.rows.len() - n) as f64;
        (0..n)
            .map(|k| (variance * covariance[(k, k)]).sqrt())
            .collect()
    }

    pub fn residuals(&self, b: &[f64]) -> Vec<Dual> {
        let b = Dual::parameters(b);
        let rows = self.rows.iter();
        rows.map(|(y, x)| *y - (self.model)(&b, x)).collect()
    }

    /// Second derivative of the residuals along a step, from one more evaluation (ibid., equation 8).
    fn curvature(&self, b: &[f64], residuals: &[Dual], step: &[f64]) -> Vec<f64> {
        let probe = moved(b, step.iter().map(|d| PROBE * d));
        let second = |(near, here): (Dual, &Dual)| {
            let slope: f64 = here.gradient.iter().zip(step).map(|(g, d)| g * d).sum();
            2.0 / PROBE * ((near.value - here.value) / PROBE - slope)
        };
        let near = self.residuals(&probe).into_iter();
        near.zip(residuals).map(second).collect()
    }
}

impl LeastSquares for Regression {
    type Iterate = Iterate;
    type Rows = Linearisation;

    fn cost(&self, at: &Iterate) -> Option<f64> {
        let cost = square(&self.residuals(&at.b));
        cost.is_finite().then_some(cost)
    }

    fn linearise(&self, at: &Iterate) -> Option<Linearised<Linearisation>> {
        let n = at.b.len();
        let residuals = self.residuals(&at.b);
        let r = triangle(n, &residuals, |i| residuals[i].value);
        let unit = |j: usize| {
            let column = (0..=j).map(|i| r[(i, j)].powi(2)).sum::<f64>().sqrt();
            let limit = UNIT_GROWTH * at.unit[j];
            // A column of zeros has no own unit.
            f64::min(
                1.0 / column,
                if limit.is_finite() {
                    limit
                } else {
                    f64::MAX.sqrt()
                },
            )
        };
        let natural: Vec<f64> = (0..n).map(unit).collect();
        let spectrum = Spectrum::new(&r, &natural, None, 0.0, f64::INFINITY).ok()?;
        let rhs: Vec<f64> = (0..n).map(|i| r[(i, n)]).collect();
        let cost = square(&residuals);
        let response: f64 = self.rows.iter().map(|(y, _)| y * y).sum();
        Some(Linearised {
            cost,
            round_off: 2.0 * ULPS * f64::EPSILON * (cost * response).sqrt(),
            slack: 2.0 * ULPS * f64::EPSILON * (cost * response).sqrt(),
            predicted_reduction: spectrum.decrease(&rhs, 0.0),
            smallest_singular_value: spectrum.smallest_singular_value(),
            rows: Linearisation {
                residuals,
                spectrum,
                rhs,
            },
        })
    }

    fn converged(&self, at: &Iterate, here: &Linearised<Linearisation>) -> bool {
        let Linearisation { spectrum, rhs, .. } = &here.rows;
        let step = in_units(&spectrum.solve(rhs), spectrum);
        let small = |(b, d): (&f64, &f64)| d.abs() <= SETTLED * b.abs();
        at.b.iter().zip(&step).all(small)
    }

    /// Levenberg-Marquardt with geodesic acceleration (Transtrum and Sethna 2012, equation 7).
    fn step(&self, at: &Iterate, here: &Linearised<Linearisation>, damping: f64) -> Step<Iterate> {
        let Linearisation {
            residuals,
            spectrum,
            rhs,
        } = &here.rows;
        let n = at.b.len();
        let first = spectrum.damped(rhs, damping);
        let mut second = vec![0.0; n];
        // If the step is round-off, its curvature is too.
        if here.predicted_reduction > here.round_off {
            let curvature = self.curvature(&at.b, residuals, &in_units(&first, spectrum));
            let r = triangle(n, residuals, |i| 0.5 * curvature[i]);
            let rhs: Vec<f64> = (0..n).map(|i| r[(i, n)]).collect();
            second = spectrum.damped(&rhs, damping);
        }
        let whole: Vec<f64> = first.iter().zip(&second).map(|(a, b)| a + b).collect();
        Step {
            to: Iterate {
                b: moved(&at.b, in_units(&whole, spectrum).into_iter()),
                unit: spectrum.natural.clone(),
            },
            predicted_reduction: spectrum.decrease(rhs, damping),
            acceleration_ratio: 2.0 * length(&second) / length(&first).max(f64::MIN_POSITIVE),
        }
    }
}

/// Triangle of the sensitivities of the prediction, with a right-hand side.
fn triangle(n: usize, residuals: &[Dual], rhs: impl Fn(usize) -> f64) -> faer::Mat<f64> {
    let mut qr = BlockQr::new(n + 1);
    qr.push(residuals.len(), |i, j| {
        let slope = residuals[i].gradient.get(j).filter(|_| j < n);
        slope.map_or_else(|| rhs(i), |g| -g)
    });
    qr.finish().r
}

fn in_units(scaled: &[f64], spectrum: &Spectrum) -> Vec<f64> {
    let pairs = scaled.iter().zip(&spectrum.natural);
    pairs.map(|(z, unit)| z * unit).collect()
}

fn moved(b: &[f64], step: impl Iterator<Item = f64>) -> Vec<f64> {
    b.iter().zip(step).map(|(b, d)| b + d).collect()
}

fn square(residuals: &[Dual]) -> f64 {
    residuals.iter().map(|r| r.value * r.value).sum()
}

fn length(v: &[f64]) -> f64 {
    v.iter().map(|x| x * x).sum::<f64>().sqrt()
}
