//! Sigmas of problems with two unknowns, inverted by hand, and ranks.

use faer::Mat;
use poinsot_solve::{BlockQr, DirectionSigma, Spectrum};

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

/// Sigmas 0.1 and 20: the second is not moved, but a number with a share of 0.001 in it has the sigma of that share. With a sigma of
/// 1,000 the same share withholds it.
#[test]
fn exact_a_weak_direction_counts_in_the_sigma_of_a_number() {
    let of = |weak: f64| {
        let R = Mat::from_fn(2, 2, |i, j| [[10.0, 0.0], [0.0, 1.0 / weak]][i][j]);
        Spectrum::new(&R, &[1.0, 1.0], None, 1.0, 1.0).unwrap()
    };
    let s = of(20.0);
    assert_eq!((s.rank, s.told, s.structural_rank), (1, 2, 2));
    let sigma = s.sigma(&[1.0, 1.0e-3]).unwrap();
    assert!((sigma - 0.1_f64.hypot(0.02)).abs() < 1e-14);
    assert!((s.covariance()[(1, 1)] - 400.0).abs() < 1e-10);
    assert_eq!(s.unobservable_directions().ncols(), 1);
    assert!((s.weak_change(&[1.0, 1.0e-3], &[5.0, 2.0]) - 2.0e-3).abs() < 1e-14);
    let judged = s.judged(0.5);
    assert!(judged.is_accurate(&[1.0, 1.0e-3], 1.0) && !judged.is_accurate(&[1.0, 0.1], 1.0));
    assert_eq!(of(1000.0).sigma(&[1.0, 1.0e-3]), None);
}

/// Data that would move a weak direction by six of its sigmas: the 95 % interval reaches there. A pull within it changes nothing.
#[test]
fn exact_an_interval_reaches_to_where_the_data_pull() {
    let R = Mat::from_fn(2, 2, |i, j| [[10.0, 0.0], [0.0, 0.05]][i][j]);
    let s = Spectrum::new(&R, &[1.0, 1.0], None, 1.0, 1.0).unwrap();
    let far = s.clone().reaching(&R, &[0.0, 6.0], 2.0);
    let sigma = far.sigma(&[1.0, 1.0e-3]).unwrap();
    assert!((sigma - 0.1_f64.hypot(3.0 * 0.02)).abs() < 1e-14);
    let near = s.reaching(&R, &[0.0, 1.9], 2.0);
    assert!((near.sigma(&[1.0, 1.0e-3]).unwrap() - 0.1_f64.hypot(0.02)).abs() < 1e-14);
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

/// Sigmas 0.1 along (0.6, 0.8) and 0.001 across it; the first is 0.2 by another law, and 0.4 somewhere in its interval.
#[test]
fn exact_other_sigmas_are_stated_and_decide() {
    let R = [[10.0 * 0.6, 10.0 * 0.8], [-1000.0 * 0.8, 1000.0 * 0.6]];
    let own = spectrum(R, [1.0, 1.0]);
    let along = usize::from(own.singular[0] > own.singular[1]);
    let other = DirectionSigma {
        direction: along,
        stated: 0.2,
        judged: 0.4,
    };
    let found = own.with_sigmas(&[other]);
    let stated =
        |g: [f64; 2]| (0.2 * (g[0] * 0.6 + g[1] * 0.8)).hypot(1e-3 * (g[1] * 0.6 - g[0] * 0.8));
    for g in [[1.0, 0.0], [0.0, 1.0], [0.6, 0.8]] {
        assert!((found.sigma(&g).unwrap() - stated(g)).abs() < 1e-13);
        let c = found.covariance();
        let variance =
            g[0] * g[0] * c[(0, 0)] + 2.0 * g[0] * g[1] * c[(0, 1)] + g[1] * g[1] * c[(1, 1)];
        assert!((variance.sqrt() - stated(g)).abs() < 1e-13);
    }
    // The larger sigma decides: 0.24 of x and 0.32 of y. A factor on all sigmas counts.
    let judged = found.judged(0.3);
    assert!((judged.sigma(&[1.0, 0.0]).unwrap() - stated([1.0, 0.0])).abs() < 1e-13);
    assert_eq!(judged.sigma(&[0.0, 1.0]), None);
    assert_eq!(judged.sigma_within(&[1.0, 0.0], 1.3), None);
    assert_eq!(judged.experiment().accurate, 1);
}

/// The rank by singular values alone, for every number of rows and of directions that are not identified.
#[test]
fn xval_a_rank_is_that_of_the_directions() {
    let n = 8;
    let natural: Vec<f64> = (0..n).map(|k| 0.5 + k as f64).collect();
    let mut seed = 0.0;
    let mut random = || {
        seed += 1.0;
        (12.9898_f64 * seed).sin() * 43_758.5 % 1.0
    };
    let mut found = std::collections::BTreeSet::new();
    for rows in [0, 1, 3, 5, 8, 20] {
        for size in [0.03, 0.3, 3.0, 3.0e3] {
            let mut qr = BlockQr::new(n);
            qr.push(rows, |_, _| size * 0.5 * random());
            let r = qr.finish().r;
            let length = |j: usize| {
                let square: f64 = (0..n).map(|i| r[(i, j)].powi(2)).sum();
                square.sqrt() * natural[j]
            };
            let longest = (0..n).map(length).fold(0.0, f64::max);
            let rank = Spectrum::rank_of(&r, &natural, longest, 1.0).unwrap();
            let directions = Spectrum::new(&r, &natural, None, longest, 1.0).unwrap();
            assert_eq!(rank, directions.rank, "{rows} {size}");
            found.insert(rank);
        }
    }
    assert!(found.len() > 3, "{found:?}");
}
