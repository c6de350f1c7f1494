//! Least squares, independent of spacecraft: this crate imports no other crate of the workspace.
//!
//! | subject | item |
//! |---|---|
//! | triangle of a tall matrix that is never stored | [`BlockQr`], [`Triangle`] |
//! | identifiable directions, sigma, covariance | [`Spectrum`] |
//! | nonlinear least squares | [`levenberg_marquardt()`], [`LeastSquares`] |
//! | shortest vector over positive semidefinite blocks | [`semidefinite`] |
//! | minimax of several functions within linear limits | [`MinimaxSearch`], [`Polytope`] |
//! | smoothing spline through noisy samples | [`smooth_curve`] |
//! | eight numbers in parallel | [`lanes`] |
//!
//! # Example
//! A line `y = a + b t` through 1,000 samples of sigma 0.1. Rows are divided by sigma, folded into a triangle, and the
//! triangle gives the estimate with its sigma:
//!
//! ```
//! use faer::Mat;
//! use poinsot_solve::{BlockQr, Spectrum};
//!
//! let (a, b, sigma) = (2.0, -0.5, 0.1);
//! let mut qr = BlockQr::new(3);
//! qr.push(1000, |k, column| {
//!     let t = k as f64 / 1000.0;
//!     [1.0, t, a + b * t][column] / sigma
//! });
//! let triangle = qr.finish();
//! let r = Mat::from_fn(2, 2, |i, j| triangle.r[(i, j)]);
//! let rhs: Vec<f64> = (0..2).map(|i| triangle.r[(i, 2)]).collect();
//! // Natural units of one, no noise in the regressor, round-off judged against a column of length 1e4.
//! let spectrum = Spectrum::new(&r, &[1.0, 1.0], None, 1.0e4, 1.0)?;
//! let x = spectrum.solve(&rhs);
//! assert!((x[0] - a).abs() < 1e-12 && (x[1] - b).abs() < 1e-12);
//! // Known in closed form: for t uniform on [0, 1], sigma of the slope is sigma * sqrt(12 / samples).
//! let slope = spectrum.sigma(&[0.0, 1.0]).unwrap();
//! assert!((slope / (sigma * (12.0_f64 / 1000.0).sqrt()) - 1.0).abs() < 1e-3);
//! # Ok::<(), poinsot_solve::NotFinite>(())
//! ```
//!
//! # Files
//! - `block_qr.rs`: triangular factor of a matrix that is never stored.
//! - `spectrum.rs`: identifiable directions, sigma, covariance.
//! - `levenberg_marquardt.rs`: the loop of every nonlinear fit.
//! - `semidefinite.rs`: the convex problem of a physical answer.
//! - `minimax.rs`, `polytope.rs`: minimax of several functions within limits.
//! - `smooth_curve.rs`: smoothing spline.
//! - `lanes.rs`: eight numbers in parallel.
#![allow(non_snake_case)]

mod block_qr;
pub mod lanes;
mod levenberg_marquardt;
mod minimax;
mod polytope;
pub mod semidefinite;
pub mod smooth_curve;
mod spectrum;

pub use block_qr::{BlockQr, Triangle};
pub use levenberg_marquardt::{
    End, LeastSquares, Linearised, Minimum, Pace, Step, levenberg_marquardt,
};
pub use minimax::{Minimax, MinimaxOptions, MinimaxSearch, Reached, Values};
pub use polytope::{Polytope, Side};
pub use spectrum::{DirectionSigma, NotFinite, Spectrum, dot};
