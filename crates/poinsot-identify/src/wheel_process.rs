//! A wheel as a process: its torque jumps at certain times and is constant in between, and its speed is known at the
//! samples of a tachometer.
//!
//! ```text
//! Omega' = u,    u+ = u + l b + j,    b+ = b + c,    y = Omega + r + n,    r+ = a r + w
//! ```
//!
//! with `u` the acceleration (torque over spin inertia), which lasted `l` before it jumps, `b` its trend, `j` and `c` of
//! variances of their own at every jump, `n` white and `r` the error of a rounded sample. The trend is what a controller's
//! command has and white jumps have not: it goes on. The smoothed speed
//! drives the prediction; how far the true one is off it stands in the state of the filter ([`crate::input_noise`]).

use nalgebra::{Matrix4, Vector4};

/// Wheels of one segment.
#[derive(Debug, Clone, Default)]
pub(crate) struct WheelProcess {
    pub paths: Vec<WheelPath>,
}

/// One wheel along the grid of its segment, as deviations from the speed that drives the prediction.
#[derive(Debug, Clone)]
pub(crate) struct WheelPath {
    /// Mean and variance at the first grid time: of speed, acceleration, its trend and rounding error.
    pub start: [(f64, f64); 4],
    /// At every grid time.
    pub jumps: Vec<Jump>,
    /// Sample at every grid time.
    pub samples: Vec<Option<Sample>>,
    /// Variance of white noise and of rounding, rad2/s2.
    pub noise: f64,
    pub rounding: f64,
}

/// Jump of the acceleration and of its trend at one time.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Jump {
    /// Time that the acceleration lasted before, s; zero where it cannot jump.
    pub lasted: f64,
    /// Mean and variance of what is new: of the acceleration, and of its trend.
    pub fresh: [(f64, f64); 2],
}

/// One sample of a tachometer.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Sample {
    /// Measured speed less the one that drives the prediction, rad/s.
    pub residual: f64,
    /// Correlation of its rounding error with that of the sample before.
    pub memory: f64,
}

/// What is measured of one wheel at some times, and what is assumed of its jumps.
#[derive(Debug, Clone)]
pub(crate) struct Track {
    pub time_s: Vec<f64>,
    /// Measured speed and correlation of its rounding error with that of the sample before.
    pub samples: Vec<Option<(f64, f64)>>,
    /// Time that the torque before each jump lasted, s; zero where none jumps.
    pub lasted: Vec<f64>,
    /// Variance of what each jump brings: of the acceleration, and of its trend.
    pub jumps: Vec<[f64; 2]>,
    pub noise: f64,
    pub rounding: f64,
    /// First speed.
    pub first: f64,
    /// Standard deviation of the first speed, acceleration and trend.
    pub start: [f64; 3],
}

/// Smoothed speed and acceleration of a track.
#[derive(Debug, Clone, Default)]
pub(crate) struct Smoothed {
    pub speed: Vec<f64>,
    /// Speed, acceleration and trend at the first time.
    start: [f64; 3],
    /// Mean and mean square of what every jump brings.
    jumps: Vec<[(f64, f64); 2]>,
}

/// Neighbours on each side with which a jump shares its variance.
const NEIGHBOURS: usize = 4;
/// Least variance of a jump over the mean of all.
const LEAST: f64 = 1.0e-6;

#[derive(Clone, Copy)]
struct Moment {
    mean: Vector4<f64>,
    covariance: Matrix4<f64>,
    /// Innovation and its variance, where there is a sample.
    seen: Option<(f64, f64)>,
}

impl Track {
    /// From the time before to time k.
    fn transition(&self, k: usize) -> Matrix4<f64> {
        let h = k
            .checked_sub(1)
            .map_or(0.0, |b| self.time_s[k] - self.time_s[b]);
        let mut T = Matrix4::identity();
        T[(0, 1)] = h;
        T[(1, 2)] = self.lasted[k];
        T[(3, 3)] = self.memory(k).unwrap_or(1.0);
        T
    }

    /// Correlation of the rounding error at time k with that before, where there is a sample.
    fn memory(&self, k: usize) -> Option<f64> {
        let sample = self.samples[k].filter(|_| self.rounding > 0.0);
        sample.map(|(_, a)| a)
    }

    /// Kalman's filter (1960), one predicted moment a time, and `-2 ln L`.
    fn filter(&self, mut keep: impl FnMut(Moment)) -> f64 {
        let mut x = Vector4::new(self.first, 0.0, 0.0, 0.0);
        let [speed, torque, trend] = self.start.map(|s| s * s);
        let mut P = Matrix4::from_diagonal(&Vector4::new(speed, torque, trend, self.rounding));
        let mut cost = 0.0;
        for k in 0..self.time_s.len() {
            if k > 0 {
                let T = self.transition(k);
                x = T * x;
                P = T * P * T.transpose();
                P[(1, 1)] += self.jumps[k][0];
                P[(2, 2)] += self.jumps[k][1];
                P[(3, 3)] += self
                    .memory(k)
                    .map_or(0.0, |a| self.rounding * (1.0 - a * a));
            }
            let mut moment = Moment {
                mean: x,
                covariance: P,
                seen: None,
            };
            if let Some((y, _)) = self.samples[k] {
                let c = P.column(0) + P.column(3);
                let F = c[0] + c[3] + self.noise;
                let v = y - x[0] - x[3];
                moment.seen = Some((v, F));
                cost += F.ln() + v * v / F;
                x += c * (v / F);
                P -= c * c.transpose() / F;
            }
            keep(moment);
        }
        cost
    }

    /// `-2 ln L` of the samples.
    pub fn cost(&self) -> f64 {
        self.filter(|_| ())
    }

    /// Fixed-interval smoother of the disturbances (Koopman 1993).
    pub fn smoothed(&self) -> Smoothed {
        let n = self.time_s.len();
        let mut moments = Vec::with_capacity(n);
        self.filter(|m| moments.push(m));
        let mut found = Smoothed {
            speed: vec![0.0; n],
            start: [0.0; 3],
            jumps: vec![[(0.0, 0.0); 2]; n],
        };
        let Z = Vector4::new(1.0, 0.0, 0.0, 1.0);
        let (mut r, mut N) = (Vector4::zeros(), Matrix4::zeros());
        for k in (0..n).rev() {
            let m = &moments[k];
            if let Some((v, F)) = m.seen {
                let gain = m.covariance * Z / F;
                let L = Matrix4::identity() - gain * Z.transpose();
                r = Z * (v / F) + L.transpose() * r;
                N = Z * Z.transpose() / F + L.transpose() * N * L;
            }
            let x = m.mean + m.covariance * r;
            found.speed[k] = x[0];
            found.start = [x[0], x[1], x[2]];
            for i in 0..2 {
                let q = self.jumps[k][i];
                let mean = q * r[1 + i];
                let left = (q - q * q * N[(1 + i, 1 + i)]).max(0.0);
                found.jumps[k][i] = (mean, mean * mean + left);
            }
            let T = self.transition(k);
            r = T.transpose() * r;
            N = T.transpose() * N * T;
        }
        found
    }

    /// Fits the variance of the jumps by likelihood, in `rounds` steps of expectation and maximisation (Shumway and
    /// Stoffer 1982). Neighbours share an intensity: a rest and a slew have different ones.
    pub fn fit_jumps(&mut self, rounds: usize) {
        let at: Vec<usize> = (0..self.lasted.len())
            .filter(|k| self.lasted[*k] > 0.0)
            .collect();
        if at.is_empty() {
            return;
        }
        let sums = |of: &dyn Fn(usize) -> f64| -> Vec<f64> {
            let mut total = vec![0.0];
            for k in &at {
                total.push(total[total.len() - 1] + of(*k));
            }
            total
        };
        let lasted = sums(&|k| self.lasted[k]);
        let all = lasted[at.len()];
        let reach = self.reach(all / at.len() as f64);
        for _ in 0..rounds {
            let squares = self.smoothed().jumps;
            for part in 0..2 {
                let square = sums(&|k| squares[k][part].1);
                let least = LEAST * square[at.len()] / all;
                for (i, k) in at.iter().enumerate() {
                    let from = i.saturating_sub(reach);
                    let to = (i + reach + 1).min(at.len());
                    let own = (square[to] - square[from]) / (lasted[to] - lasted[from]);
                    self.jumps[*k][part] = own.max(least) * self.lasted[*k];
                }
            }
        }
    }

    /// Jumps on each side that share an intensity: some that are seen apart.
    fn reach(&self, typical: f64) -> usize {
        let samples = self.samples.iter().flatten().count().max(1) as f64;
        let span = self.time_s.last().unwrap_or(&0.0) - self.time_s.first().unwrap_or(&0.0);
        let apart = (span / samples / typical.max(f64::MIN_POSITIVE)).ceil();
        NEIGHBOURS * (apart.clamp(1.0, 1.0e4) as usize)
    }

    /// The speed that drives the prediction, and the deviations from it.
    pub fn path(&self) -> (Vec<f64>, WheelPath) {
        let found = self.smoothed();
        let samples = self.samples.iter().zip(&found.speed);
        let known = [self.first, 0.0, 0.0];
        let start = |i: usize| (known[i] - found.start[i], self.start[i] * self.start[i]);
        let jump = |k: usize| Jump {
            lasted: self.lasted[k],
            fresh: std::array::from_fn(|i| (-found.jumps[k][i].0, self.jumps[k][i])),
        };
        let path = WheelPath {
            start: [start(0), start(1), start(2), (0.0, self.rounding)],
            jumps: (0..self.time_s.len()).map(jump).collect(),
            samples: samples
                .map(|(sample, speed)| {
                    sample.map(|(y, memory)| Sample {
                        residual: y - speed,
                        memory,
                    })
                })
                .collect(),
            noise: self.noise,
            rounding: self.rounding,
        };
        (found.speed, path)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{DMatrix, DVector};

    fn track() -> Track {
        let time_s = vec![0.0, 0.4, 0.5, 1.1, 1.3, 2.0, 2.2];
        let samples = vec![
            Some((1.0, 0.0)),
            None,
            Some((1.4, 0.3)),
            None,
            Some((2.2, 0.8)),
            Some((2.1, 0.1)),
            None,
        ];
        Track {
            lasted: vec![0.0, 0.4, 0.0, 0.7, 0.0, 0.0, 1.1],
            jumps: [0.0, 0.5, 0.0, 0.8, 0.0, 0.0, 0.3]
                .map(|q| [q, 0.6 * q])
                .to_vec(),
            noise: 0.02,
            rounding: 0.05,
            first: 1.0,
            start: [3.0, 2.0, 1.5],
            time_s,
            samples,
        }
    }

    /// Likelihood, smoothed speed and jumps against the dense covariance of everything.
    #[test]
    fn exact_the_smoother_is_the_conditional_mean_of_the_dense_covariance() {
        let t = track();
        // Sources: first speed, acceleration and trend, what every jump brings, first rounding error and what is new at
        // each sample.
        let read: Vec<usize> = (0..7).filter(|k| t.samples[*k].is_some()).collect();
        let mut sources = t.start.map(|s| s * s).to_vec();
        sources.extend(t.jumps.iter().flatten());
        sources.push(t.rounding);
        sources.extend(read.iter().skip(1).map(|k| {
            let a = t.samples[*k].unwrap().1;
            t.rounding * (1.0 - a * a)
        }));
        // By definition, one source at a time.
        let run = |source: usize| -> Vec<f64> {
            let one = |i: usize| f64::from(u8::from(i == source));
            let (mut speed, mut u, mut b) = (one(0), one(1), one(2));
            let mut all = vec![speed];
            for k in 1..7 {
                speed += u * (t.time_s[k] - t.time_s[k - 1]);
                u += t.lasted[k] * b + one(3 + 2 * k);
                b += one(4 + 2 * k);
                all.push(speed);
            }
            all
        };
        let runs: Vec<Vec<f64>> = (0..sources.len()).map(run).collect();
        let speed = |k: usize| DVector::from_fn(sources.len(), |i, _| runs[i][k]);
        let D = DMatrix::from_diagonal(&DVector::from_vec(sources.clone()));
        let rows: Vec<DVector<f64>> = read
            .iter()
            .enumerate()
            .map(|(i, k)| {
                let mut row = speed(*k);
                for j in 0..=i {
                    let kept: f64 = read[j + 1..=i]
                        .iter()
                        .map(|k| t.samples[*k].unwrap().1)
                        .product();
                    row[17 + j] = kept;
                }
                row
            })
            .collect();
        let G = DMatrix::from_fn(rows.len(), sources.len(), |i, j| rows[i][j]);
        let C = &G * &D * G.transpose() + DMatrix::identity(rows.len(), rows.len()) * t.noise;
        let y = DVector::from_iterator(4, read.iter().map(|k| t.samples[*k].unwrap().0 - 1.0));
        let solved = C.clone().lu().solve(&y).unwrap();
        let found = t.smoothed();
        let cost = y.dot(&solved) + C.determinant().ln();
        assert!((t.cost() - cost).abs() < 1.0e-10, "{} {cost}", t.cost());
        let mean = &D * G.transpose() * &solved;
        for k in 0..7 {
            assert!(
                (found.speed[k] - 1.0 - speed(k).dot(&mean)).abs() < 1.0e-10,
                "speed {k}"
            );
            for part in 0..2 {
                let (at, q) = (3 + 2 * k + part, t.jumps[k][part]);
                let jump = found.jumps[k][part];
                assert!((jump.0 - mean[at]).abs() < 1.0e-10, "jump {k}");
                let own = G.column(at).into_owned();
                let left = q - q * q * own.dot(&C.clone().lu().solve(&own).unwrap());
                let square = mean[at].powi(2) + left;
                assert!((jump.1 - square).abs() < 1.0e-10, "square {k}");
            }
        }
    }
}
