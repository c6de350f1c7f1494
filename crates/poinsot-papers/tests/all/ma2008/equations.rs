//! Rows and increments against the definition of momentum.

use super::*;

#[test]
fn exact_both_trajectories_all_options_both_bases() {
    let cases = [
        (1, [0.0, 0.0, 5.0]),
        (1, [0.0, 0.0, 1.0]),
        (2, [0.0, 1.0, 5.0]),
        (2, [0.0, 1.0, 0.0]),
    ];
    for (trajectory, spin) in cases {
        for base in [table1().bodies[0].nominal, unsymmetric()] {
            for (stops, orbital) in [(true, 0.0), (false, 0.0), (true, 7500.0)] {
                let mut e = flown(trajectory, spin).with_base(base);
                // Spin and arm motion about one axis each, with stops: nearly unobservable (the paper's own
                // condition).
                if !stops || spin == [0.0, 1.0, 0.0] {
                    e = e.sampled(40, false);
                }
                e.velocity = [0.02 + orbital, -0.01, 0.005];
                let Run { raws, known, .. } = e.run().unwrap();
                let samples = vec![readings(&e.model, &raws)];
                for option in [Some(known), None] {
                    let found = error(&two_step(&samples, option), &base);
                    // With orbital velocity, 7500 m/s contains the relevant 0.02 m/s.
                    let limit = if orbital > 0.0 { 1.0e-7 } else { 1.0e-9 };
                    assert!(
                        found < limit,
                        "trajectory {trajectory} spin {spin:?} stops {stops} orbital {orbital} option {}: {found:e}",
                        2 - i32::from(option.is_some())
                    );
                }
            }
        }
    }
}

/// The rows of both steps give the momentum by definition, for any revolute or prismatic arm.
#[test]
fn exact_rows_are_momentum_by_definition() {
    let mut rng = ChaCha8Rng::seed_from_u64(25);
    for round in 0..20 {
        let mut model = table1();
        model.bodies[0].nominal = unsymmetric();
        if round % 2 == 1 {
            model.joints[1].kind = JointKind::Prismatic;
            model.joints[4].kind = JointKind::Prismatic;
        }
        let q: Vec<f64> = (0..6).map(|_| normal(&mut rng)).collect();
        let rates: Vec<f64> = (0..6).map(|_| normal(&mut rng)).collect();
        let R = UnitQuaternion::from_scaled_axis(vector(&mut rng));
        let (v, w) = (vector(&mut rng), vector(&mut rng));
        let raw = ma2008::Raw {
            R_NB: R,
            v_NBo_N: R * v,
            w_NB_B: w,
            q: q.clone(),
            rates: rates.clone(),
            wheel_speed: Vec::new(),
        };
        let tree = Tree::new(&model);
        let reading = Vehicle::new(&model, &tree).reading(&raw);
        let (bodies, state) = kit(&model, &raw, v);
        let P = linear_momentum(&bodies, &state);
        let mass: f64 = bodies.iter().map(|b| b.mass).sum();
        let centre: Vector3 = (0..bodies.len())
            .map(|i| bodies[i].mass * body_motion(&bodies, &state, i).p_NCcm_N)
            .sum::<Vector3>()
            / mass;
        let H = angular_momentum_about(&bodies, &[], &state, &centre);
        let base = model.bodies[0].nominal;
        let c = base.p_BoBcm_B;
        let x1 = SVector::<f64, 5>::from([reading.arm.mass / base.mass, c.x, c.y, c.z, 1.0]);
        let y = elements(&base.I_BBcm_B);
        let y1 = SVector::<f64, 7>::from_iterator(y.into_iter().chain([1.0]));
        let ours = linear_rows(&reading) * x1 * base.mass;
        assert!((ours - P).norm() < 1.0e-12 * P.norm());
        let ours = angular_rows(&reading, base.mass, &c) * y1;
        assert!((ours - H).norm() < 1.0e-12 * (1.0 + H.norm()), "{ours} {H}");
    }
}

/// (14), (17), (21), (24) as printed, interpreted in N: correct for the symmetric base of Table 1, wrong for another.
/// Interpreted in body axes they are wrong for both.
#[test]
fn paper_printed_increments_hold_for_the_symmetric_base_only() {
    for base in [table1().bodies[0].nominal, unsymmetric()] {
        let mut e = flown(1, [0.0, 0.0, 5.0]).with_base(base);
        e.velocity = [0.02, -0.01, 0.005];
        let samples = readings(&e.model, &e.run().unwrap().raws);
        let corrected = two_step(std::slice::from_ref(&samples), None);
        assert!(error(&corrected, &base) < 1.0e-9);
        let body = two_step_printed(&samples, PrintedAxes::Body).unwrap();
        let inertial = two_step_printed(&samples, PrintedAxes::Inertial).unwrap();
        println!("body {:.2} kg, N {:.2} kg", body.mass(), inertial.mass());
        assert!((body.mass() - 1000.0).abs() > 300.0);
        if base == unsymmetric() {
            assert!((inertial.mass() - 1000.0).abs() > 300.0);
        } else {
            assert!(error(&inertial, &base) < 1.0e-9);
        }
    }
}

/// (39), (41) with corrected row 2, (43), (45): differences of rows for perturbed velocities.
#[test]
fn exact_error_matrices_are_differences_of_rows() {
    let mut rng = ChaCha8Rng::seed_from_u64(39);
    let e = flown(1, [0.0, 0.0, 1.0]).with_base(unsymmetric());
    for reading in readings(&e.model, &e.run().unwrap().raws) {
        let (dv, dw) = (vector(&mut rng), vector(&mut rng));
        let moved = Reading {
            v_NBo_B: reading.v_NBo_B + dv,
            w_NB_B: reading.w_NB_B + dw,
            ..reading
        };
        let d = linear_rows(&moved) - linear_rows(&reading);
        assert!((d - linear_error(&reading, &dv, &dw)).norm() < 1.0e-13);
        let (m, c) = (1000.0, Vector3::new(0.05, -0.08, 0.1));
        let d = angular_rows(&moved, m, &c) - angular_rows(&reading, m, &c);
        let ours = angular_error(&reading, m, &c, &dw);
        assert!((d - ours).norm() < 1.0e-12 * ours.norm());
    }
}

/// (36) is (35) divided by the norm of the solution.
#[test]
fn exact_relative_bound_is_absolute_bound_over_solution() {
    let e = flown(1, [0.0, 0.0, 1.0]).with_base(unsymmetric());
    let samples = noisy(
        &readings(&e.model, &e.run().unwrap().raws),
        0.01,
        &mut ChaCha8Rng::seed_from_u64(36),
    );
    let answer = two_step(&[samples], None);
    let b = bound(&answer.linear, 0.01, 0.02);
    let x = answer.linear.x.norm();
    assert!((b.relative * x / b.absolute - 1.0).abs() < 1.0e-12);
    assert!(answer.linear.residual > 0.0);
}
