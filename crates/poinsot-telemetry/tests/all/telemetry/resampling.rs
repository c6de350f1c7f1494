//! Interpolation and differentiation against known functions: the error must have the stated order.

use poinsot_telemetry::{Channel, differentiate, resample, resample_attitude, resample_hermite};

fn channel(name: &str, time_s: &[f64], f: impl Fn(f64) -> f64) -> Channel {
    Channel {
        name: name.into(),
        unit: "rad".into(),
        time_s: time_s.into(),
        values: time_s.iter().map(|t| f(*t)).collect(),
        ..Channel::default()
    }
}

fn grid(h: f64) -> Vec<f64> {
    (0..=(4.0 / h).round() as usize)
        .map(|k| k as f64 * h)
        .collect()
}

/// Ratio of the errors at steps h and h/2, as a power of two.
fn order(error: impl Fn(f64) -> f64) -> f64 {
    (error(0.05) / error(0.025)).log2()
}

fn midpoints(t: &[f64]) -> Vec<f64> {
    t.windows(2).map(|w| w[0] + 0.37 * (w[1] - w[0])).collect()
}

fn worst(found: &[Option<f64>], times: &[f64], f: impl Fn(f64) -> f64) -> f64 {
    let errors = found
        .iter()
        .zip(times)
        .map(|(x, t)| (x.unwrap() - f(*t)).abs());
    errors.fold(0.0, f64::max)
}

#[test]
fn exact_orders_of_interpolation_and_slope() {
    let linear = order(|h| {
        let t = grid(h);
        let m = midpoints(&t);
        worst(
            &resample(&channel("j_rad", &t, f64::sin), &m, None),
            &m,
            f64::sin,
        )
    });
    let hermite = order(|h| {
        let t = grid(h);
        let m = midpoints(&t);
        let (x, d) = (
            channel("j_rad", &t, f64::sin),
            channel("j_rad_s", &t, f64::cos),
        );
        worst(&resample_hermite(&x, &d, &m), &m, f64::sin)
    });
    let slope = |half| {
        order(move |h| {
            let d = differentiate(&channel("j_rad", &grid(h), f64::sin), half);
            let found: Vec<_> = d.values.iter().map(|x| Some(*x)).collect();
            worst(&found, &d.time_s, f64::cos)
        })
    };
    assert!((linear - 2.0).abs() < 0.1, "{linear}");
    assert!((hermite - 4.0).abs() < 0.1, "{hermite}");
    for half in [2, 5] {
        assert!((slope(half) - 4.0).abs() < 0.3, "{half}: {}", slope(half));
    }
}

#[test]
fn exact_the_slope_of_a_quartic_on_uneven_times() {
    let t: Vec<f64> = (0..30)
        .map(|k| f64::from(k) * 0.1 + 0.03 * f64::from(k).sin())
        .collect();
    let d = differentiate(
        &channel("omega_x", &t, |t| 1.0 - t + 2.0 * t.powi(3) - t.powi(4)),
        2,
    );
    assert_eq!((d.name.as_str(), d.unit.as_str()), ("domega_x", "rad/s2"));
    for (t, x) in d.time_s.iter().zip(&d.values) {
        assert!((x - (-1.0 + 6.0 * t * t - 4.0 * t.powi(3))).abs() < 1e-11);
    }
}

#[test]
fn unit_no_value_in_gaps_or_beyond_the_ends() {
    let mut t = grid(0.1);
    t.retain(|t| !(1.05..1.95).contains(t));
    let x = channel("j_rad", &t, |t| t);
    let at = [-0.01, 0.0, 0.55, 1.0, 1.5, 2.0 + 1e-8, 4.0, 4.01];
    let found = resample(&x, &at, None);
    let there: Vec<bool> = found.iter().map(Option::is_some).collect();
    assert_eq!(there, [false, true, true, true, false, true, true, false]);
    assert_eq!(
        found[5],
        Some(t[11]),
        "a time within the tolerance is the sample's"
    );
    assert_eq!(resample(&x, &at[4..5], Some(1.0)).len(), 1);
    assert!(resample(&x, &at[4..5], Some(1.0))[0].is_some());
    assert_eq!(resample_hermite(&x, &x, &at[4..5]), [None]);
    // Derivatives do not use samples across the gap: a jump there has no effect.
    let step = channel("j_rad", &t, |t| if t > 1.5 { t + 100.0 } else { t });
    assert!(
        differentiate(&step, 2)
            .values
            .iter()
            .all(|d| (d - 1.0).abs() < 1e-10)
    );
}

/// Attitude exp(a(t) ez / 2) exp(b(t) ex / 2) and its body rates (b', a' sin b, a' cos b).
fn coning(t: f64) -> ([f64; 4], [f64; 3]) {
    let (a, b) = (
        1.3 * t + 0.4 * (2.0 * t).sin(),
        0.9 * t + 0.5 * (1.7 * t).cos(),
    );
    let (da, db) = (1.3 + 0.8 * (2.0 * t).cos(), 0.9 - 0.85 * (1.7 * t).sin());
    let ((sa, ca), (sb, cb)) = ((a / 2.0).sin_cos(), (b / 2.0).sin_cos());
    let q = [ca * sb, sa * sb, sa * cb, ca * cb];
    (q, [db, da * b.sin(), da * b.cos()])
}

#[test]
fn exact_attitude_between_samples() {
    let error = |h: f64, with_rates: bool| {
        let t = grid(h);
        let m = midpoints(&t);
        let q = [0, 1, 2, 3].map(|k| channel("q", &t, |t| coning(t).0[k]));
        let w = [0, 1, 2].map(|k| channel("omega", &t, |t| coning(t).1[k]));
        let rates = with_rates.then(|| [&w[0], &w[1], &w[2]]);
        let found = resample_attitude([&q[0], &q[1], &q[2], &q[3]], rates, &m);
        // Vector part of the rotation from the true to the computed attitude: half the angle.
        let errors = found.iter().zip(&m).map(|(q, t)| {
            let ([a, b, c, d], [x, y, z, w]) = (coning(*t).0, q.unwrap());
            let v = [
                d * x - a * w - b * z + c * y,
                d * y - b * w - c * x + a * z,
                d * z - c * w - a * y + b * x,
            ];
            2.0 * v.iter().map(|x| x * x).sum::<f64>().sqrt()
        });
        errors.fold(0.0, f64::max)
    };
    let slerp = order(|h| error(h, false));
    let cubic = order(|h| error(h, true));
    assert!((slerp - 2.0).abs() < 0.2, "{slerp}");
    assert!((cubic - 4.0).abs() < 0.2, "{cubic}");
}
