//! How many directions a change identifies in addition, without another decomposition.
//!
//! In the basis of a decomposition the information is `S^2`, its square roots the singular values, those of the identified
//! directions above a limit `t`. Rows `[X | Y]` over nuisances with identified directions, and over the others, are added. By
//! Haynsworth 1968 (additivity of inertia) the number of values above the limit grows by that of the singular values above one of
//! `K^-1/2 Y (t^2 - S^2)^-1/2`, where `K = I + X X^T` with nuisances in units of their triangle and directions in units of
//! `(S^2 - t^2)^1/2`. Each row takes the square of the unknowns, where a decomposition takes the cube.

use super::Row;
use crate::fit::triangle::SharedTriangle;
use crate::problem::parameters::Parameters;
use faer::Mat;
use nalgebra::DMatrix;
use poinsot_solve::{BlockQr, Spectrum};

/// Share of the length of a nuisance's column below which its own part is not told from round-off.
const OWN_GAIN: f64 = 1.0e-10;
/// Round-off of a singular value, for each unknown and in units of the largest one ([`Spectrum::new`]).
const ROUND_OFF_OF_GAIN: f64 = 32.0 * f64::EPSILON;

/// What an experiment identifies, ready for further rows.
pub(super) struct Gains {
    /// Places of the nuisances and of the mass properties among all unknowns.
    front: Vec<usize>,
    back: Vec<usize>,
    shared: SharedTriangle,
    spectrum: Spectrum,
    /// Singular value from which on a direction is identified.
    limit: f64,
    /// Length of the longest column, natural units.
    size: f64,
}

impl Gains {
    /// `None` where a nuisance is not determined, or round-off decides what is identified.
    pub fn new(
        parameters: &Parameters,
        shared: SharedTriangle,
        spectrum: Spectrum,
        (accuracy, size): (f64, f64),
    ) -> Option<Self> {
        let is_nuisance = |k: &usize| parameters.unknowns[*k].kind.is_nuisance();
        let (front, back): (Vec<usize>, Vec<usize>) = (0..parameters.len()).partition(is_nuisance);
        let lengths = shared.nuisance_lengths();
        let own = |(k, length): (usize, &f64)| shared.r[(k, k)].abs() > OWN_GAIN * length;
        let told = lengths.iter().enumerate().all(own);
        told.then_some(Self {
            front,
            back,
            shared,
            spectrum,
            limit: 1.0 / accuracy,
            size,
        })
    }

    /// Number of directions identified without further rows.
    pub fn rank(&self) -> usize {
        self.spectrum.rank
    }

    /// Number of directions identified in addition; `None` where round-off would decide.
    pub fn of(&self, rows: &[Row]) -> Option<usize> {
        let (n, m) = (self.back.len(), rows.len());
        let told = self.front.len() + self.spectrum.rank;
        let turned: Vec<Vec<f64>> = rows.iter().map(|row| self.turned(row)).collect();
        let added: f64 = turned.iter().flatten().map(|x| x * x).sum();
        let largest = (n as f64).sqrt() * self.size + added.sqrt();
        if ROUND_OFF_OF_GAIN * n as f64 * largest >= self.limit {
            return None;
        }
        // The triangle of K: of the unit matrix with X^T below it.
        let mut qr = BlockQr::new(m);
        qr.push(m + told, |i, j| match i.checked_sub(m) {
            None => f64::from(u8::from(i == j)),
            Some(i) => turned[j][i],
        });
        let root = qr.finish().r;
        let root = DMatrix::from_fn(m, m, |i, j| root[(i, j)]);
        let open = n - self.spectrum.rank;
        let Y = DMatrix::from_fn(m, open, |i, j| turned[i][told + j]);
        // `K^-T/2 Y` in units of what the other directions lack.
        let scaled = root.tr_solve_upper_triangular(&Y);
        let scaled = scaled.filter(|all| all.iter().all(|x| x.is_finite()))?;
        let scaled = Mat::from_fn(m, open, |i, j| scaled[(i, j)]);
        let values = scaled.singular_values().ok()?;
        Some(values.iter().filter(|value| **value > 1.0).count())
    }

    /// A row in the basis: nuisances, identified directions, the others.
    fn turned(&self, row: &Row) -> Vec<f64> {
        let b = self.front.len();
        let r = &self.shared.r;
        let value = |k: usize| row.get(k).copied().unwrap_or(0.0);
        let mut out = Vec::with_capacity(b + self.back.len());
        for (j, place) in self.front.iter().enumerate() {
            let before: f64 = (0..j).map(|i| out[i] * r[(i, j)]).sum();
            out.push((value(*place) - before) / r[(j, j)]);
        }
        // What the nuisances take with them is not the row's own.
        let natural = &self.spectrum.natural;
        let clear = |(j, place): (usize, &usize)| {
            let taken: f64 = (0..b).map(|i| out[i] * r[(i, b + j)]).sum();
            (value(*place) - taken) * natural[j]
        };
        let mass: Vec<f64> = self.back.iter().enumerate().map(clear).collect();
        let directions = &self.spectrum.directions;
        for (k, singular) in self.spectrum.singular.iter().enumerate() {
            let along: f64 = mass
                .iter()
                .enumerate()
                .map(|(i, x)| x * directions[(i, k)])
                .sum();
            let square = (singular * singular - self.limit * self.limit).abs();
            out.push(along / square.max(f64::MIN_POSITIVE).sqrt());
        }
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::problem::parameters::{Equations, Unknown, UnknownKind};
    use poinsot_dynamics::{SensorError, Tree};
    use poinsot_model::parse_model;
    use rand::{RngExt, SeedableRng};

    const MODEL: &str = r#"
schema = "poinsot.model/1"
name = "two"
exact = true
[[body]]
name = "base"
mass_kg = 10.0
com_m = [0.0, 0.0, 0.0]
inertia_kg_m2 = { xx = 1.0, yy = 2.0, zz = 2.0 }
estimate = true
"#;

    /// The gain is that of a decomposition of all rows, for every number of rows and of directions that are not identified.
    #[test]
    fn xval_a_gain_is_that_of_a_new_decomposition() {
        let model = parse_model(MODEL, "two.toml").unwrap();
        let tree = Tree::new(&model);
        let mut parameters = Parameters::new(&model, &tree, Equations::Momentum, false).unwrap();
        for axis in 0..2 {
            parameters.unknowns.push(Unknown {
                kind: UnknownKind::Sensor {
                    sensor: 0,
                    error: SensorError::Bias(axis),
                },
                name: String::new(),
                unit: "rad/s",
                nominal: 0.0,
                natural: 1.0,
            });
        }
        let n = parameters.len();
        let mass = n - 2;
        let natural = vec![1.0; mass];
        let mut random = rand_chacha::ChaCha8Rng::seed_from_u64(3);
        let decomposed = |rows: &[Row]| {
            let mut qr = BlockQr::new(n + 1);
            qr.push(rows.len(), |i, j| rows[i].get(j).copied().unwrap_or(0.0));
            let shared = SharedTriangle::new(&parameters, &qr.finish());
            let spectrum = Spectrum::new(&shared.block(), &natural, None, 1.0e3, 1.0).unwrap();
            (shared, spectrum)
        };
        let mut row = |size: f64| -> Row {
            let mut value = || size * (random.random::<f64>() - 0.5);
            (0..n).map(|_| value()).collect()
        };
        let mut gained = std::collections::BTreeSet::new();
        for before in [4, 8, 11] {
            for more in [1, 3, 6] {
                for size in [0.3, 3.0, 3.0e3] {
                    let base: Vec<Row> = (0..before).map(|_| row(30.0)).collect();
                    let further: Vec<Row> = (0..more).map(|_| row(size)).collect();
                    let all: Vec<Row> = base.iter().chain(&further).cloned().collect();
                    let (shared, spectrum) = decomposed(&base);
                    let rank = spectrum.rank;
                    let gains = Gains::new(&parameters, shared, spectrum, (1.0, 1.0e3)).unwrap();
                    let expected = decomposed(&all).1.rank - rank;
                    assert_eq!(gains.of(&further), Some(expected), "{before} {more} {size}");
                    gained.insert(expected);
                }
            }
        }
        assert!(gained.len() > 3, "{gained:?}");
    }
}
