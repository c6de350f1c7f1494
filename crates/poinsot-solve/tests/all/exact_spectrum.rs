//! Sigmas of problems with two unknowns, inverted by hand.

use faer::Mat;
use poinsot_solve::Spectrum;

fn spectrum(R: [[f64; 2]; 2], natural: [f64; 2]) -> Spectrum {
    let R = Mat::from_fn(2, 2, |i, j| R[i][j]);
    Spectrum::new(&R, &natural, None, 1.0, 10.0).unwrap()
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

/// Sigmas 0.1 along (0.6, 0.8) and 0.001 across it: a number counts by its own sigma, whatever part it has in either.
#[test]
fn exact_an_accuracy_judges_each_number_by_its_own_sigma() {
    let R = [[10.0 * 0.6, 10.0 * 0.8], [-1000.0 * 0.8, 1000.0 * 0.6]];
    let s = spectrum(R, [1.0, 1.0]).judged(0.07);
    assert_eq!((s.rank, s.accurate), (2, 1));
    let sigma =
        |g: [f64; 2]| (g[0] * 0.6 + g[1] * 0.8).hypot(1e-2 * (g[1] * 0.6 - g[0] * 0.8)) / 10.0;
    assert!((s.sigma(&[1.0, 0.0]).unwrap() - sigma([1.0, 0.0])).abs() < 1e-14);
    assert_eq!(s.sigma(&[0.0, 1.0]), None);
    assert_eq!(s.inaccurate_directions().ncols(), 1);
    assert_eq!(s.unobservable_directions().ncols(), 0);
    // The same for an estimator that loses information: the experiment decides, the sigma is its own.
    let R = Mat::from_fn(2, 2, |i, j| 0.1 * R[i][j]);
    let own = Spectrum::within(&R, None, &s).unwrap();
    assert!((own.sigma(&[1.0, 0.0]).unwrap() - 10.0 * sigma([1.0, 0.0])).abs() < 1e-13);
    assert_eq!(own.sigma(&[0.0, 1.0]), None);
}
