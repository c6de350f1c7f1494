//! Sigmas of problems with two unknowns, inverted by hand.

use faer::Mat;
use poinsot_solve::Spectrum;

fn spectrum(R: [[f64; 2]; 2], natural: [f64; 2]) -> Spectrum {
    let R = Mat::from_fn(2, 2, |i, j| R[i][j]);
    Spectrum::new(&R, &natural, &[0.0; 4], 1.0, 10.0).unwrap()
}

/// `R^T R` is [4 2; 2 17], its inverse [17 -2; -2 4] / 64; the result must not depend on natural units.
#[test]
fn exact_sigma_and_covariance_of_two_unknowns() {
    for natural in [[1.0, 1.0], [3.0, 0.5]] {
        let s = spectrum([[2.0, 1.0], [0.0, 4.0]], natural);
        let sigma = |g: [f64; 2]| s.sigma(&g).unwrap();
        assert!((sigma([1.0, 0.0]) - (17.0_f64 / 64.0).sqrt()).abs() < 1e-14);
        assert!((sigma([0.0, 1.0]) - 0.25).abs() < 1e-14);
        assert!((sigma([1.0, 1.0]) - (17.0_f64 / 64.0).sqrt()).abs() < 1e-14);
        let c = s.covariance();
        assert!((c[(0, 0)] - 17.0 / 64.0).abs() < 1e-14);
        assert!((c[(0, 1)] + 2.0 / 64.0).abs() < 1e-14);
        assert!((c[(1, 1)] - 4.0 / 64.0).abs() < 1e-14);
    }
}

/// One equation, x + y = d with unit noise: the sum has sigma 1, the unknowns have none.
#[test]
fn exact_no_sigma_for_what_touches_an_open_direction() {
    let s = spectrum([[1.0, 1.0], [0.0, 0.0]], [1.0, 1.0]);
    assert_eq!(s.rank, 1);
    assert_eq!(s.sigma(&[1.0, 0.0]), None);
    assert_eq!(s.sigma(&[0.0, 1.0]), None);
    assert!((s.sigma(&[1.0, 1.0]).unwrap() - 1.0).abs() < 1e-14);
}
