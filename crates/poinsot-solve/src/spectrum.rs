//! Identifiability: the spectrum of the whitened sensitivity in natural units.

use faer::Mat;
use std::ops::Range;

/// Largest fraction of a gradient along undetermined directions for a determined number.
const TOUCH: f64 = 1.0e-4;
/// Share of a gradient below which its component along undetermined directions is round-off.
const ROUND_OFF: f64 = 1.0e-9;
/// Sigma of a direction, natural units, up to which its share in a number is taken for what the data say of it.
const WEAK: f64 = 100.0;
/// Largest fraction of measurement noise in a direction's squared length for an identified direction.
const NOISE_SHARE: f64 = 0.5;

/// The spectrum of the problem with nuisance parameters projected out.
///
/// ```
/// use faer::mat;
/// use poinsot_solve::Spectrum;
///
/// // Only the sum of two unknowns is measured, with sigma 0.1.
/// let r = mat![[10.0, 10.0], [0.0, 0.0]];
/// let spectrum = Spectrum::new(&r, &[1.0, 1.0], None, 10.0, 1.0)?;
/// assert_eq!(spectrum.rank, 1);
/// assert!((spectrum.sigma(&[1.0, 1.0]).unwrap() - 0.1).abs() < 1.0e-12);
/// assert_eq!(spectrum.sigma(&[1.0, 0.0]), None);
/// # Ok::<(), poinsot_solve::NotFinite>(())
/// ```
#[derive(Debug, Clone)]
pub struct Spectrum {
    /// Natural unit of each unknown.
    pub natural: Vec<f64>,
    /// Singular values, descending: reciprocal sigmas of the directions in natural units.
    pub singular: Vec<f64>,
    /// Directions, one column each, in natural units.
    pub directions: Mat<f64>,
    /// Left singular vectors: each direction in the rows, one column each.
    pub left: Mat<f64>,
    /// Expected squared length of each direction from noise in the regressor.
    pub noise: Vec<f64>,
    /// Number of identified leading directions.
    pub rank: usize,
    /// Number of those among them, the first ones, that are as accurate as asked.
    pub accurate: usize,
    /// Number of leading directions with a sigma. Those beyond `rank` keep their nominal values, but a number with little of them is
    /// as accurate as they let it be.
    pub told: usize,
    /// Number of directions above round-off.
    pub structural_rank: usize,
    /// Bias of linear least squares from noise in the regressor, per unknown in natural units.
    pub bias: Vec<f64>,
    /// Sigma, natural units for a gradient of length one, from which on a number counts as undetermined.
    accuracy: f64,
    /// What the experiment allows, where this is an estimator within it: it decides what is determined.
    experiment: Option<Box<Spectrum>>,
}

/// Sigma along a direction of a [`Spectrum`] where its curvature does not give it, natural units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DirectionSigma {
    /// Index among the identified directions.
    pub direction: usize,
    /// Sigma that is stated.
    pub stated: f64,
    /// Sigma by which it is decided whether a number is determined.
    pub judged: f64,
}

/// The matrix holds NaN or infinity and cannot be decomposed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error(
    "E0410 the equations hold a number that is not finite; check units and magnitudes of the telemetry"
)]
pub struct NotFinite;

impl Spectrum {
    /// Decomposes the triangle `R` (n x n, whitened) in the given natural units.
    ///
    /// `size` is the length of the longest column, natural units, before any projection; it sets the round-off level.
    /// `regressor_noise` is `E[dA^T dA]` of the unknowns, row by row, in their own units; `None` where it is zero.
    ///
    /// # Errors
    /// The triangle holds NaN or infinity.
    pub fn new(
        R: &Mat<f64>,
        natural: &[f64],
        regressor_noise: Option<&[f64]>,
        size: f64,
        relative_accuracy: f64,
    ) -> Result<Self, NotFinite> {
        let n = natural.len();
        let svd = scaled(R, natural)?.svd().map_err(|_| NotFinite)?;
        let singular: Vec<f64> = (0..n).map(|k| svd.S()[k]).collect();
        let (directions, left) = (svd.V().to_owned(), svd.U().to_owned());
        let noise = noise_along(regressor_noise, natural, &directions, n);
        let round_off = round_off(&singular, size);
        let structural_rank = singular.iter().filter(|s| **s > round_off).count();
        let identified = |k: &usize| {
            let square = singular[*k] * singular[*k];
            *k < structural_rank
                && noise[*k] <= NOISE_SHARE * square
                && 1.0 / (square - noise[*k]).sqrt() < relative_accuracy
        };
        let (mut order, open): (Vec<usize>, Vec<usize>) = (0..n).partition(identified);
        let rank = order.len();
        let is_weak =
            |k: &&usize| **k < structural_rank && noise[**k] == 0.0 && WEAK * singular[**k] > 1.0;
        let told = rank + open.iter().take_while(is_weak).count();
        order.extend(open);
        Ok(Self {
            natural: natural.to_vec(),
            singular: order.iter().map(|&k| singular[k]).collect(),
            noise: order.iter().map(|&k| noise[k]).collect(),
            directions: Mat::from_fn(n, n, |i, j| directions[(i, order[j])]),
            left: Mat::from_fn(n, n, |i, j| left[(i, order[j])]),
            rank,
            accurate: rank,
            told,
            structural_rank,
            bias: vec![0.0; n],
            accuracy: f64::INFINITY,
            experiment: None,
        })
    }

    /// The rank that [`Self::new`] finds without noise in the regressor, by singular values alone, which take a fraction of the time.
    ///
    /// ```
    /// use faer::mat;
    /// use poinsot_solve::Spectrum;
    ///
    /// let r = mat![[10.0, 10.0], [0.0, 0.0]];
    /// assert_eq!(Spectrum::rank_of(&r, &[1.0, 1.0], 10.0, 1.0)?, 1);
    /// # Ok::<(), poinsot_solve::NotFinite>(())
    /// ```
    ///
    /// # Errors
    /// As of [`Self::new`].
    pub fn rank_of(
        R: &Mat<f64>,
        natural: &[f64],
        size: f64,
        relative_accuracy: f64,
    ) -> Result<usize, NotFinite> {
        let singular = scaled(R, natural)?.singular_values();
        let singular = singular.map_err(|_| NotFinite)?;
        let round_off = round_off(&singular, size);
        let is_identified = |s: &&f64| **s > round_off && 1.0 / **s < relative_accuracy;
        Ok(singular.iter().filter(is_identified).count())
    }

    /// Asks for this accuracy, in natural units, of every number and direction. What is less accurate stays identified: a
    /// number across such a direction may itself be accurate.
    pub fn judged(mut self, relative_accuracy: f64) -> Self {
        if let Some(experiment) = self.experiment.take() {
            let judged = experiment.judged(relative_accuracy);
            self.experiment = Some(Box::new(judged));
            return self;
        }
        let accurate = |k: &usize| {
            let square = self.singular[*k] * self.singular[*k];
            1.0 / (square - self.noise[*k]).sqrt() < relative_accuracy
        };
        let n = self.natural.len();
        let (mut order, rest): (Vec<usize>, Vec<usize>) = (0..self.rank).partition(accurate);
        let accurate = order.len();
        order.extend(rest);
        order.extend(self.rank..n);
        let picked = |all: &[f64]| order.iter().map(|&k| all[k]).collect();
        let columns = |all: &Mat<f64>| Mat::from_fn(n, n, |i, j| all[(i, order[j])]);
        Self {
            singular: picked(&self.singular),
            noise: picked(&self.noise),
            directions: columns(&self.directions),
            left: columns(&self.left),
            accurate,
            accuracy: relative_accuracy,
            ..self
        }
    }

    /// With other sigmas along some directions. What the experiment allows is weakened along each of its own directions as much
    /// as the variance along it grows.
    pub fn with_sigmas(mut self, sigmas: &[DirectionSigma]) -> Self {
        if sigmas.is_empty() {
            return self;
        }
        let mut judged: Vec<f64> = self.sigmas();
        let mut allowed = self.experiment().clone();
        for of in sigmas {
            judged[of.direction] = of.judged;
        }
        for j in 0..allowed.rank {
            let own: Vec<f64> = (0..self.natural.len())
                .map(|i| allowed.directions[(i, j)])
                .collect();
            let variance = |sigmas: &[f64]| {
                let along = |k: usize| (self.along(&own, k) * sigmas[k]).powi(2);
                (0..self.rank).map(along).sum::<f64>()
            };
            allowed.singular[j] *= (variance(&self.sigmas()) / variance(&judged)).sqrt();
        }
        for of in sigmas {
            self.singular[of.direction] = of.stated.recip();
        }
        self.experiment = Some(Box::new(allowed));
        self
    }

    /// With intervals along the directions that keep their nominal values that reach to where the data would move them: sigma times
    /// `interval` is at least that far. `R` and `rhs` are those of the least squares at the answer.
    pub fn reaching(mut self, R: &Mat<f64>, rhs: &[f64], interval: f64) -> Self {
        let pull = |k: usize| {
            let image = self.image(R, k);
            (dot(&image, rhs) / norm(&image)).abs()
        };
        let wider: Vec<f64> = (self.rank..self.told)
            .map(|k| (pull(k) / interval).max(1.0))
            .collect();
        let rank = self.rank;
        let own = self.experiment.as_deref_mut().map(|e| &mut e.singular);
        for singular in std::iter::once(&mut self.singular).chain(own) {
            singular[rank..]
                .iter_mut()
                .zip(&wider)
                .for_each(|(s, w)| *s /= w);
        }
        self
    }

    /// What a step along direction k, natural units, does to the rows of a triangle.
    fn image(&self, R: &Mat<f64>, k: usize) -> Vec<f64> {
        let n = self.natural.len();
        let along = |i: usize, j: usize| R[(i, j)] * self.natural[j] * self.directions[(j, k)];
        (0..n).map(|i| (0..n).map(|j| along(i, j)).sum()).collect()
    }

    /// One sigma of every direction, in the unknowns' units, and how far the data would move it, in sigmas, were those that keep their
    /// nominal values known to a natural unit. `R` and `rhs` are those of the least squares at the answer.
    pub fn loosened(&self, R: &Mat<f64>, rhs: &[f64]) -> Vec<(Vec<f64>, f64)> {
        let of = |k: usize| {
            let image = self.image(R, k);
            let held = if k < self.rank { 0.0 } else { 1.0 };
            let sigma = 1.0 / (held + norm(&image).powi(2)).sqrt();
            let along = |(j, unit): (usize, &f64)| self.directions[(j, k)] * unit * sigma;
            let natural = self.natural.iter().enumerate();
            (
                natural.map(along).collect(),
                dot(&image, rhs) * sigma * held,
            )
        };
        (0..self.natural.len()).map(of).collect()
    }

    /// What the experiment allows: itself, save for an estimator within it.
    pub fn experiment(&self) -> &Spectrum {
        self.experiment.as_deref().unwrap_or(self)
    }

    /// Sigma of every direction, natural units, in the order of `directions`.
    pub fn sigmas(&self) -> Vec<f64> {
        let sigma = |s: &f64| if *s > 0.0 { 1.0 / s } else { f64::INFINITY };
        self.singular.iter().map(sigma).collect()
    }

    /// The spectrum of an estimator's own triangle within the directions that `experiment` identifies.
    ///
    /// # Errors
    /// The triangle holds NaN or infinity.
    pub fn within(
        R: &Mat<f64>,
        regressor_noise: Option<&[f64]>,
        experiment: &Spectrum,
    ) -> Result<Self, NotFinite> {
        let n = experiment.natural.len();
        let r = experiment.rank;
        let natural = &experiment.natural;
        let inside = Mat::from_fn(n, r, |i, k| experiment.directions[(i, k)]);
        let scaled = Mat::from_fn(n, n, |i, j| R[(i, j)] * natural[j]);
        let seen = &scaled * &inside;
        if (0..r).any(|j| (0..n).any(|i| !seen[(i, j)].is_finite())) {
            return Err(NotFinite);
        }
        let svd = seen.thin_svd().map_err(|_| NotFinite)?;
        let turned = &inside * svd.V();
        let mut out = experiment.clone();
        out.experiment = Some(Box::new(experiment.experiment().clone()));
        out.accuracy = f64::INFINITY;
        out.accurate = r;
        out.left = Mat::from_fn(n, n, |i, j| if j < r { svd.U()[(i, j)] } else { 0.0 });
        out.directions = Mat::from_fn(n, n, |i, j| {
            if j < r {
                turned[(i, j)]
            } else {
                experiment.directions[(i, j)]
            }
        });
        let noise = noise_along(regressor_noise, natural, &out.directions, r);
        for (k, noise) in noise.into_iter().enumerate() {
            out.singular[k] = svd.S()[k];
            out.noise[k] = noise;
        }
        Ok(out)
    }

    /// Least-squares step in natural units for the right-hand side `d - R x_nominal`; only identified directions
    /// change.
    pub fn solve(&self, rhs: &[f64]) -> Vec<f64> {
        self.damped(rhs, 0.0)
    }

    /// Like [`Self::solve`] with `damping` added to the squared singular values.
    pub fn damped(&self, rhs: &[f64], damping: f64) -> Vec<f64> {
        self.combined(0..self.rank, |k| {
            let s = self.singular[k];
            self.left_along(rhs, k) * s / (s * s + damping)
        })
    }

    /// Sum of some directions, each with its share, in natural units.
    pub fn combined(&self, directions: Range<usize>, share: impl Fn(usize) -> f64) -> Vec<f64> {
        let mut z = vec![0.0; self.natural.len()];
        for k in directions {
            let share = share(k);
            for (i, z) in z.iter_mut().enumerate() {
                *z += share * self.directions[(i, k)];
            }
        }
        z
    }

    /// A step of the unknowns in their natural units.
    pub fn in_natural_units(&self, step: &[f64]) -> Vec<f64> {
        let units = step.iter().zip(&self.natural);
        units.map(|(s, unit)| s / unit).collect()
    }

    /// Reduction of the squared right-hand side by the step of [`Self::damped`].
    pub fn decrease(&self, rhs: &[f64], damping: f64) -> f64 {
        (0..self.rank)
            .map(|k| {
                let left = damping / (self.singular[k].powi(2) + damping);
                self.left_along(rhs, k).powi(2) * (1.0 - left * left)
            })
            .sum()
    }

    /// Smallest singular value of the identified directions; infinite if there is none.
    pub fn smallest_singular_value(&self) -> f64 {
        let identified = self.singular.iter().take(self.rank);
        identified.fold(f64::INFINITY, |a, b| a.min(*b))
    }

    /// Component of a right-hand side along direction k.
    pub fn left_along(&self, rhs: &[f64], k: usize) -> f64 {
        rhs.iter()
            .enumerate()
            .map(|(i, d)| self.left[(i, k)] * d)
            .sum()
    }

    /// Stores the first-order bias `-(A^T A)^-1 E[dA^T dA] z` of least squares at the answer `z`.
    pub fn set_bias(&mut self, regressor_noise: &[f64], z: &[f64]) {
        let n = z.len();
        let pushed: Vec<f64> = (0..n)
            .map(|i| {
                (0..n)
                    .map(|j| regressor_noise[i * n + j] * self.natural[i] * self.natural[j] * z[j])
                    .sum()
            })
            .collect();
        let share = |k: usize| -self.along(&pushed, k) / (self.singular[k] * self.singular[k]);
        self.bias = self.combined(0..self.rank, share);
    }

    /// Sigma of a number with this gradient over the unknowns; `None` if it is undetermined.
    ///
    /// The sigma includes the declared noise and the bias from noise in the regressor.
    pub fn sigma(&self, gradient: &[f64]) -> Option<f64> {
        self.sigma_within(gradient, 1.0)
    }

    /// The same where all sigmas are to be widened by a factor: a number that is then less accurate than asked is undetermined. The
    /// factor is not in the sigma.
    pub fn sigma_within(&self, gradient: &[f64], factor: f64) -> Option<f64> {
        let g = self.natural_gradient(gradient);
        let length = norm(&g);
        if length == 0.0 {
            return Some(0.0);
        }
        if self.touch(&g) > TOUCH * length {
            return None;
        }
        let allowed = self.experiment();
        if factor * allowed.variance(&g).sqrt() >= allowed.accuracy * length {
            return None;
        }
        let noise = self.variance(&g);
        let bias: f64 = g.iter().zip(&self.bias).map(|(a, b)| a * b).sum();
        let open: f64 = self.nominal_part(gradient).iter().map(|x| x * x).sum();
        Some((noise + bias * bias + open).sqrt())
    }

    /// What a number with this gradient owes to nominal values along each undetermined direction: its small component there has their
    /// uncertainty. Empty where there is none.
    pub fn nominal_part(&self, gradient: &[f64]) -> Vec<f64> {
        let g = self.natural_gradient(gradient);
        let open = self.told..self.natural.len();
        let parts: Vec<f64> = open.map(|k| self.along(&g, k)).collect();
        match norm(&parts) > ROUND_OFF * norm(&g) {
            true => parts,
            false => Vec::new(),
        }
    }

    /// Change of a number with this gradient by one natural unit along it: what it owes to nominal values.
    pub fn change(&self, gradient: &[f64]) -> f64 {
        norm(&self.natural_gradient(gradient))
    }

    /// Whether a number with this gradient is as accurate as asked, all sigmas widened by a factor, relative to its natural size: the
    /// largest change that one natural unit of any unknown makes.
    pub fn is_accurate(&self, gradient: &[f64], factor: f64) -> bool {
        let g = self.natural_gradient(gradient);
        let size = g.iter().fold(0.0_f64, |most, g| most.max(g.abs()));
        let allowed = self.experiment();
        size == 0.0 || factor * allowed.variance(&g).sqrt() < allowed.accuracy * size
    }

    /// Covariance of the unknowns from the directions with a sigma, in their units. It includes the bias from noise in the regressor, as
    /// [`Self::sigma`] does.
    pub fn covariance(&self) -> Mat<f64> {
        let n = self.natural.len();
        let bias = |i: usize| self.bias.get(i).copied().unwrap_or(0.0);
        Mat::from_fn(n, n, |i, j| {
            let sum: f64 = (0..self.told)
                .map(|k| {
                    self.directions[(i, k)] * self.directions[(j, k)] / self.singular[k].powi(2)
                })
                .sum();
            (sum + bias(i) * bias(j)) * self.natural[i] * self.natural[j]
        })
    }

    /// Directions that are not identified, one column each, in natural units.
    pub fn unobservable_directions(&self) -> Mat<f64> {
        self.columns(self.rank..self.natural.len())
    }

    /// Directions that are identified, but less accurately than asked, one column each, in natural units.
    pub fn inaccurate_directions(&self) -> Mat<f64> {
        self.columns(self.accurate..self.rank)
    }

    fn columns(&self, range: Range<usize>) -> Mat<f64> {
        let at = |i, j| self.directions[(i, range.start + j)];
        Mat::from_fn(self.natural.len(), range.len(), at)
    }

    /// Variance along the directions with a sigma of a number with this gradient in natural units.
    pub fn variance(&self, g: &[f64]) -> f64 {
        let along = |k: usize| (self.along(g, k) / self.singular[k]).powi(2);
        (0..self.told).map(along).sum()
    }

    /// Change of a number with this gradient by the part of a step along the directions that have a sigma and keep their nominal
    /// values; both in the units of the unknowns.
    pub fn weak_change(&self, gradient: &[f64], step: &[f64]) -> f64 {
        let g = self.natural_gradient(gradient);
        let z = self.in_natural_units(step);
        let part = |k: usize| self.along(&g, k) * self.along(&z, k);
        (self.rank..self.told).map(part).sum()
    }

    fn natural_gradient(&self, gradient: &[f64]) -> Vec<f64> {
        gradient
            .iter()
            .zip(&self.natural)
            .map(|(g, s)| g * s)
            .collect()
    }

    /// Share of the square of a vector in natural units that the identified directions hold, for a vector of length one.
    pub fn identified_share(&self, z: &[f64]) -> f64 {
        (0..self.rank).map(|k| self.along(z, k).powi(2)).sum()
    }

    /// Component of a vector in natural units along direction k.
    pub fn along(&self, g: &[f64], k: usize) -> f64 {
        g.iter()
            .enumerate()
            .map(|(i, x)| x * self.directions[(i, k)])
            .sum()
    }

    fn touch(&self, g: &[f64]) -> f64 {
        (self.told..self.natural.len())
            .map(|k| self.along(g, k).powi(2))
            .sum::<f64>()
            .sqrt()
    }
}

/// A triangle in natural units.
fn scaled(R: &Mat<f64>, natural: &[f64]) -> Result<Mat<f64>, NotFinite> {
    let n = natural.len();
    let scaled = Mat::from_fn(n, n, |i, j| R[(i, j)] * natural[j]);
    let is_finite = (0..n).all(|j| (0..n).all(|i| scaled[(i, j)].is_finite()));
    is_finite.then_some(scaled).ok_or(NotFinite)
}

/// Largest singular value that is round-off, of columns of at most this size.
fn round_off(singular: &[f64], size: f64) -> f64 {
    let largest = singular.first().copied().unwrap_or(0.0);
    32.0 * singular.len() as f64 * f64::EPSILON * size.max(largest)
}

/// Noise of a regressor along the first directions, in natural units.
fn noise_along(
    regressor_noise: Option<&[f64]>,
    natural: &[f64],
    directions: &Mat<f64>,
    count: usize,
) -> Vec<f64> {
    let Some(own) = regressor_noise else {
        return vec![0.0; count];
    };
    let n = natural.len();
    let scaled = Mat::from_fn(n, n, |i, j| own[i * n + j] * natural[i] * natural[j]);
    (0..count)
        .map(|k| quadratic(&scaled, directions, k))
        .collect()
}

fn quadratic(m: &Mat<f64>, v: &Mat<f64>, k: usize) -> f64 {
    let n = m.nrows();
    (0..n)
        .map(|i| v[(i, k)] * (0..n).map(|j| m[(i, j)] * v[(j, k)]).sum::<f64>())
        .sum()
}

/// Sum of the products of the elements.
///
/// ```
/// assert_eq!(poinsot_solve::dot(&[1.0, 2.0], &[3.0, 4.0]), 11.0);
/// ```
pub fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn norm(v: &[f64]) -> f64 {
    dot(v, v).sqrt()
}
