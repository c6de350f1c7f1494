//! Estimated noise against simulated noise.

use poinsot_telemetry::{Channel, noise_level};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, Normal};

fn channel(n: usize, f: impl FnMut(usize) -> f64) -> Channel {
    Channel {
        name: "omega_x".into(),
        sensor: String::new(),
        unit: "rad/s".into(),
        frame: "body".into(),
        time_s: (0..n).map(|k| k as f64 * 0.1).collect(),
        values: (0..n).map(f).collect(),
    }
}

#[test]
fn stat_white_noise_on_slow_motion_is_seen() {
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    let normal = Normal::new(0.0, 1e-4).unwrap();
    // The median of 20000 correlated differences scatters by about 1.5 %.
    let c = channel(20_000, |k| {
        (k as f64 * 1e-3).sin() + normal.sample(&mut rng)
    });
    let level = noise_level(&c).unwrap();
    assert!((level.sigma / 1e-4 - 1.0).abs() < 0.05, "{level:?}");
    assert!(!level.constant && level.quantum.is_none());
}

#[test]
fn stat_a_tenth_of_outliers_hardly_matters() {
    let mut rng = ChaCha8Rng::seed_from_u64(2);
    let normal = Normal::new(0.0, 1e-4).unwrap();
    let c = channel(20_000, |k| {
        normal.sample(&mut rng) + if k % 100 < 5 { 1.0 } else { 0.0 }
    });
    let level = noise_level(&c).unwrap();
    assert!((level.sigma / 1e-4 - 1.0).abs() < 0.15, "{level:?}");
}

/// A star tracker of 50 microrad with a rotation of 0.1 rad/s sampled twice a second, and a wave of nine samples.
/// Third differences include the motion, differences of the chosen order only noise, within three stated errors.
#[test]
fn stat_noise_is_seen_below_fast_motion() {
    let sigma = 5.0e-5;
    let normal = Normal::new(0.0, sigma).unwrap();
    for (seed, radians_a_sample, amplitude) in [(4, 0.05, 1.0), (5, 0.7, 0.1), (6, 0.3, 0.01)] {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let mut noisy =
            |k: usize| amplitude * (radians_a_sample * k as f64).sin() + normal.sample(&mut rng);
        let level = noise_level(&channel(600, &mut noisy)).unwrap();
        let off = (level.sigma / sigma - 1.0).abs();
        assert!(
            off < 3.0 * level.relative_error && !level.upper_bound,
            "{level:?}"
        );
        assert!(level.relative_error < 0.12, "{level:?}");
    }
    // Two and a half samples per wave: no difference separates it from noise, and the result is marked or larger.
    let mut rng = ChaCha8Rng::seed_from_u64(7);
    let level = noise_level(&channel(600, |k| {
        (2.5 * k as f64).sin() + normal.sample(&mut rng)
    }));
    assert!(level.unwrap().sigma > 1.0e3 * sigma);
    // The stated error agrees with the scatter over many records.
    let scatter: f64 = (0..200)
        .map(|seed| {
            let mut rng = ChaCha8Rng::seed_from_u64(1000 + seed);
            let level = noise_level(&channel(400, |_| normal.sample(&mut rng))).unwrap();
            ((level.sigma / sigma - 1.0) / level.relative_error).powi(2)
        })
        .sum();
    let scatter = (scatter / 200.0).sqrt();
    assert!((0.8..1.25).contains(&scatter), "{scatter}");
}

#[test]
fn exact_constant_and_quantised_channels() {
    let level = noise_level(&channel(100, |_| 3.0)).unwrap();
    assert!(level.constant && level.sigma == 0.0);
    let mut rng = ChaCha8Rng::seed_from_u64(3);
    let normal = Normal::new(0.0, 1e-4).unwrap();
    let lsb = 2.4e-5;
    let quantised = |x: f64| (x / lsb).round() * lsb;
    let level = noise_level(&channel(5000, |_| quantised(normal.sample(&mut rng)))).unwrap();
    assert!((level.quantum.unwrap() / lsb - 1.0).abs() < 1e-9);
    assert!((level.sigma / 1e-4 - 1.0).abs() < 0.15, "{level:?}");
    // Noise below the last bit: the quantisation remains.
    let slow = noise_level(&channel(5000, |k| quantised(k as f64 * 1e-7))).unwrap();
    assert!((slow.sigma * 12.0_f64.sqrt() / lsb - 1.0).abs() < 1e-6);
    // Switched levels have no observable noise.
    let thruster = noise_level(&channel(5000, |k| if k % 50 < 7 { 2.0 } else { 0.0 })).unwrap();
    assert_eq!(thruster.sigma, 0.0);
    assert!(noise_level(&channel(3, |k| k as f64)).is_none());
}
