//! Tests and means of numbers determined by several results.

use nalgebra::{DMatrix, DVector};
use poinsot_formats::{CovarianceFile, EstimateFile, JointTestFile};
use statrs::distribution::{ChiSquared, ContinuousCDF};
use std::collections::HashMap;

/// Eigenvalues of a correlation matrix below this fraction of the largest are round-off.
const ROUND_OFF: f64 = 1.0e-12;

/// Numbers determined by all results, with the covariance of each.
pub(super) struct Answers {
    pub names: Vec<String>,
    pub units: Vec<String>,
    pub values: Vec<DVector<f64>>,
    pub covariances: Vec<DMatrix<f64>>,
}

impl Answers {
    /// Mass properties in the covariance of every result, in the order of the first.
    pub fn common(files: &[&EstimateFile]) -> Self {
        let values: Vec<HashMap<String, f64>> = files.iter().map(|f| values(f)).collect();
        let all = || files.iter().map(|f| &f.covariance).zip(&values);
        let in_all = |name: &&String| {
            let variance = |c: &CovarianceFile| c.between(name, name).filter(|v| *v > 0.0);
            all().all(|(c, v)| v.contains_key(name.as_str()) && variance(c).is_some())
        };
        let first = files.first().map(|f| &f.covariance);
        let names = first.into_iter().flat_map(|c| &c.names).filter(in_all);
        let names: Vec<String> = names.cloned().collect();
        let n = names.len();
        let unit = |name: &String| first.and_then(|c| c.unit_of(name)).unwrap_or_default();
        let covariance = |c: &CovarianceFile| {
            DMatrix::from_fn(n, n, |i, j| c.between(&names[i], &names[j]).unwrap_or(0.0))
        };
        Self {
            units: names.iter().map(|name| unit(name).to_owned()).collect(),
            values: values
                .iter()
                .map(|v| DVector::from_fn(n, |k, _| v[&names[k]]))
                .collect(),
            covariances: all().map(|(c, _)| covariance(c)).collect(),
            names,
        }
    }
}

/// Determined mass properties, by their names in the covariance.
fn values(file: &EstimateFile) -> HashMap<String, f64> {
    let bodies = file.bodies.iter();
    bodies
        .flat_map(|(body, b)| b.addressed(body))
        .filter_map(|(address, _, n)| Some((address, n.value?)))
        .collect()
}

/// The test of the differences of some numbers, without a name.
pub(super) fn test(answers: &Answers, of: &[usize]) -> JointTestFile {
    let (k, others) = (of.len(), answers.values.len().saturating_sub(1));
    let n = k * others;
    let x = |i: usize, j: usize| answers.values[i][of[j]];
    let d = DVector::from_fn(n, |r, _| x(1 + r / k, r % k) - x(0, r % k));
    let c = |i: usize, a: usize, b: usize| answers.covariances[i][(of[a], of[b])];
    let s = DMatrix::from_fn(n, n, |r, q| {
        let own = if r / k == q / k {
            c(1 + r / k, r % k, q % k)
        } else {
            0.0
        };
        c(0, r % k, q % k) + own
    });
    // Scale by sigma, because the numbers differ by orders of magnitude.
    let sigma = DVector::from_fn(n, |r, _| s[(r, r)].sqrt());
    let correlation = DMatrix::from_fn(n, n, |r, q| s[(r, q)] / (sigma[r] * sigma[q]));
    let z = d.component_div(&sigma);
    let spectrum = correlation.symmetric_eigen();
    let largest = spectrum.eigenvalues.max();
    let (mut chi2, mut dof) = (0.0, 0);
    for (value, vector) in spectrum
        .eigenvalues
        .iter()
        .zip(spectrum.eigenvectors.column_iter())
    {
        if *value > ROUND_OFF * largest {
            chi2 += vector.dot(&z).powi(2) / value;
            dof += 1;
        }
    }
    let p = ChiSquared::new(dof as f64).map_or(1.0, |law| law.sf(chi2));
    let what = String::new();
    JointTestFile { what, chi2, dof, p }
}

/// A mean with its sigma.
#[derive(Debug, Clone, Copy)]
pub(super) struct Mean {
    pub value: f64,
    pub sigma: f64,
}

/// Information-weighted means; `None` if a covariance is singular.
pub(super) fn pooled(answers: &Answers) -> Option<Vec<Mean>> {
    let n = answers.names.len();
    let first = answers.covariances.first()?;
    let scale = DVector::from_fn(n, |k, _| first[(k, k)].sqrt());
    let scaled =
        |c: &DMatrix<f64>| DMatrix::from_fn(n, n, |r, q| c[(r, q)] / (scale[r] * scale[q]));
    let mut information = DMatrix::zeros(n, n);
    let mut weighted = DVector::zeros(n);
    for (x, c) in answers.values.iter().zip(&answers.covariances) {
        let inverse = scaled(c).cholesky()?.inverse();
        weighted += &inverse * x.component_div(&scale);
        information += inverse;
    }
    let covariance = information.cholesky()?.inverse();
    let mean = &covariance * weighted;
    let one = |k: usize| Mean {
        value: mean[k] * scale[k],
        sigma: covariance[(k, k)].sqrt() * scale[k],
    };
    Some((0..n).map(one).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, StandardNormal};

    fn normal(rng: &mut ChaCha8Rng, n: usize) -> DVector<f64> {
        DVector::from_fn(n, |_, _| StandardNormal.sample(rng))
    }

    /// Three answers with correlated errors of very different size.
    fn draw(rng: &mut ChaCha8Rng, truth: &DVector<f64>) -> Answers {
        let n = truth.len();
        let roots: Vec<DMatrix<f64>> = (0..3)
            .map(|i| {
                let size = 10.0_f64.powi(i - 1);
                DMatrix::from_fn(n, n, |r, c| {
                    let own = if r == c {
                        1.0
                    } else {
                        0.3 * f64::from((r + c) as u8) / n as f64
                    };
                    own * size * 1.0e-3_f64.powi(r as i32 % 2)
                })
            })
            .collect();
        Answers {
            names: (0..n).map(|k| format!("bus.{k}")).collect(),
            units: vec![String::new(); n],
            values: roots.iter().map(|l| truth + l * normal(rng, n)).collect(),
            covariances: roots.iter().map(|l| l * l.transpose()).collect(),
        }
    }

    #[test]
    fn stat_probabilities_are_uniform_and_the_mean_is_calibrated() {
        let mut rng = ChaCha8Rng::seed_from_u64(7);
        let truth = DVector::from_vec(vec![3.0, -0.2, 12.0, 0.01]);
        let (trials, mut small, mut squares) = (2000, 0, 0.0);
        for _ in 0..trials {
            let answers = draw(&mut rng, &truth);
            let JointTestFile { dof, p, .. } = test(&answers, &[0, 1, 2, 3]);
            assert_eq!(dof, 8);
            small += usize::from(p < 0.05);
            let mean = pooled(&answers).unwrap();
            squares += (0..4)
                .map(|k| ((mean[k].value - truth[k]) / mean[k].sigma).powi(2))
                .sum::<f64>();
        }
        // 99.9 % bands of 2,000 trials and 8,000 squares (their correlation widens the second).
        assert!((68..=134).contains(&small), "{small}");
        let mean_square = squares / (4.0 * trials as f64);
        assert!((mean_square - 1.0).abs() < 0.11, "{mean_square}");
    }
}
