//! The noise studies of the paper.

use super::*;

/// Sec. III.D with 3 % of each component's maximum: the error of inertia is a few percent on trajectory 1 with option
/// 1. It is much larger on trajectory 2 with option 2.
#[test]
fn paper_three_percent_noise() {
    let median = |trajectory: usize, spin: [f64; 3], known: bool| -> f64 {
        let e = flown(trajectory, spin);
        let run = e.run().unwrap();
        let most = |of: &dyn Fn(&ma2008::Raw) -> Vector3| {
            run.raws.iter().fold(Vector3::zeros(), |m: Vector3, r| {
                m.zip_map(&of(r), |a, b| a.max(b.abs()))
            })
        };
        let (v, w) = (most(&|r| r.v_NBo_N) * 0.03, most(&|r| r.w_NB_B) * 0.03);
        let mut errors: Vec<f64> = (0..200)
            .map(|seed| {
                let mut rng = ChaCha8Rng::seed_from_u64(seed);
                let moved: Vec<_> = run
                    .raws
                    .iter()
                    .map(|r| {
                        let mut r = r.clone();
                        r.v_NBo_N += v.component_mul(&vector(&mut rng));
                        r.w_NB_B += w.component_mul(&vector(&mut rng));
                        r
                    })
                    .collect();
                let answer = two_step(&[readings(&e.model, &moved)], known.then_some(run.known));
                let I = e.truth().I_BBcm_B;
                answer
                    .I_S()
                    .map_or(f64::INFINITY, |found| (found - I).norm() / I.norm())
            })
            .collect();
        errors.sort_by(f64::total_cmp);
        errors[100]
    };
    let first = median(1, [0.0, 0.0, 1.0], true);
    assert!((0.02..0.06).contains(&first), "{first}");
    let second = median(2, [0.0, 1.0, 5.0], false);
    assert!(second > 0.2, "{second}");
}

/// (35) with the error matrices of each trial holds in nearly every trial, and overestimates by a factor of a few.
#[test]
fn stat_first_order_bound_holds() {
    let e = flown(1, [0.0, 0.0, 1.0]).with_base(unsymmetric());
    let run = e.run().unwrap();
    let exact = readings(&e.model, &run.raws);
    let truth = two_step(std::slice::from_ref(&exact), Some(run.known));
    let step2 = truth.angular.clone().unwrap();
    let (m, c) = (truth.mass(), truth.rho_S());
    let (mut held, mut loose, trials) = ([0_u32; 2], Vec::new(), 1000);
    for seed in 0..trials {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let moved = noisy(&exact, 0.01, &mut rng);
        let found = two_step(std::slice::from_ref(&moved), Some(run.known));
        let pairs: Vec<_> = exact
            .iter()
            .zip(&moved)
            .map(|(a, b)| (a, b.v_NBo_B - a.v_NBo_B, b.w_NB_B - a.w_NB_B))
            .collect();
        let d1: Vec<_> = pairs
            .iter()
            .map(|(s, dv, dw)| linear_error(s, dv, dw))
            .collect();
        let d2: Vec<_> = pairs
            .iter()
            .map(|(s, _, dw)| angular_error(s, m, &c, dw))
            .collect();
        let (a1, b1) = sizes::<4, 5>(&d1);
        let (a2, b2) = sizes::<6, 7>(&d2);
        let p1 = bound(&truth.linear, a1, b1).absolute;
        let p2 = bound(&step2, a2, b2).absolute;
        let e1 = (found.linear.x - truth.linear.x).norm();
        let e2 = (found.angular.unwrap().x - step2.x).norm();
        held[0] += u32::from(e1 <= p1);
        held[1] += u32::from(e2 <= p2);
        loose.push(p1 / e1);
    }
    loose.sort_by(f64::total_cmp);
    println!("held {held:?} of {trials}, looseness {:.1}", loose[500]);
    assert!(held.iter().all(|h| *h >= 990), "{held:?}");
    assert!((2.0..30.0).contains(&loose[500]), "{}", loose[500]);
}
