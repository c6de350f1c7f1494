//! Joint motions against an independent implementation.

use poinsot_dynamics::{Fourier, Jet, JointMotion};
use poinsot_testkit::joint_plans::{ClampedSpline, PlanSample, fourier, quintic_rest};

const TIMES: [f64; 5] = [0.5, 1.5, 2.0, 4.0, 7.0];
const POSITIONS: [f64; 5] = [0.3, -0.4, 1.1, 0.2, 0.9];

/// Times within the pieces, at the nodes and outside; at a node the limit from the right.
fn instants() -> impl Iterator<Item = (f64, f64)> {
    (0..=400).map(|k| {
        let t = 0.02 * f64::from(k);
        (t, t + 1e-6)
    })
}

fn close(found: Jet, expected: PlanSample, t: f64) {
    let pairs = [
        (found.value, expected.position),
        (found.rate, expected.rate),
        (found.acceleration, expected.acceleration),
    ];
    for (a, b) in pairs {
        assert!((a - b).abs() < 1e-12, "{t}: {found:?} {expected:?}");
    }
}

#[test]
fn exact_quintic_rest() {
    let ours = JointMotion::quintic_rest(&TIMES, &POSITIONS).unwrap();
    for (t, within) in instants() {
        close(ours.at(t, within), quintic_rest(&TIMES, &POSITIONS, t), t);
    }
}

#[test]
fn exact_cubic_clamped() {
    let ours = JointMotion::cubic_clamped(&TIMES, &POSITIONS).unwrap();
    let theirs = ClampedSpline::new(&TIMES, &POSITIONS, [0.0, 0.0]);
    // The last node has an acceleration, but its limit from the right has none.
    for (t, within) in instants().filter(|(t, _)| (t - 7.0).abs() > 1e-3) {
        close(ours.at(t, within), theirs.at(t), t);
    }
    close(ours.at(7.0, 6.9), theirs.at(7.0), 7.0);
}

#[test]
fn exact_fourier() {
    let ours = JointMotion::Fourier(Fourier {
        offset: 0.4,
        base_frequency_hz: 0.15,
        sine: vec![0.3, -0.2, 0.1],
        cosine: vec![0.05, 0.0, -0.4],
    });
    let terms = [[0.3, 0.05], [-0.2, 0.0], [0.1, -0.4]];
    for (t, within) in instants() {
        let theirs = fourier(0.4, 0.15 * std::f64::consts::TAU, &terms, t);
        close(ours.at(t, within), theirs, t);
    }
}
