//! The five uses of the Conclusion, and all joints together.

use super::*;

/// The five uses of the Conclusion, without noise.
#[test]
fn paper_uses_2_to_5() {
    let all = properties(&truth());
    let known = |unknown: &[usize]| robot().known_but(unknown);
    // 2: known mass and mass centre, attitude only.
    let single = robot().one_body(true);
    let mut turning = runs(&single, &["C1"]);
    without_translation(&mut turning);
    let e = ask(&single, turning, "linear").estimate;
    let (worst, n) = errors(&e.bodies[0], &total());
    println!("use 2: {worst:.1e}");
    assert!(n == 10 && worst < 1.0e-7 && e.status == Status::Converged);
    // 3: known base.
    let m = known(&[1, 2, 3, 4, 5, 6]);
    for variant in ["linear", "linear-inward"] {
        let e = ask(&m, runs(&m, &ARM), variant).estimate;
        let worst = worst_combination(&e, &truth());
        println!(
            "use 3, base known, {variant}: {worst:.1e}, {}",
            e.identifiability.rank
        );
        assert_eq!(e.identifiability.determined.len(), 45);
        assert!(worst < 1.0e-6, "{worst:e}");
    }
    // 3: known arm; 4: target; both 5: no thrust, no acceleration.
    for (body, files) in [(0, &ARM[..]), (6, &ARM[5..])] {
        let m = known(&[body]);
        let e = ask(&m, runs(&m, files), "linear").estimate;
        let (worst, n) = errors(&e.bodies[body], &all[body]);
        println!("body {body}: {worst:.1e}");
        assert!(n == 10 && worst < 1.0e-7, "{body} {n} {worst:e}");
        assert_eq!(e.status, Status::Converged);
    }
}

/// The second use as printed, "mass and centroid position of any system body". With those of one body known, attitude
/// only in the thrust segment, and one joint after the other, all combinations are determined in both orders.
#[test]
fn paper_use_2_as_printed() {
    let mut found = Vec::new();
    for (body, variant, attitude_alone) in [
        (0, "linear", true),
        (0, "linear-inward", false),
        (6, "linear", false),
        (3, "linear", false),
    ] {
        let m = robot().mass_known(body);
        let mut tables = thinned(runs(&m, &ALL), 5);
        if attitude_alone {
            without_translation(&mut tables[..1]);
        }
        let e = ask(&m, tables, variant).estimate;
        let worst = worst_combination(&e, &truth());
        let n = e.identifiability.determined.len();
        let whole = e.system.as_ref().and_then(|s| s.0.mass.value);
        let mass = whole.map_or(f64::NAN, |m| (m / 476.0 - 1.0).abs());
        println!(
            "B{body} {variant}: {n} of {}, worst {worst:.1e}, mass of the whole off by {mass:.1e}",
            e.identifiability.parameters
        );
        assert_eq!(e.identifiability.parameters, 66);
        found.push((n, worst, mass));
    }
    // With every fifth sample, two of the 50 exceed the requested accuracy.
    for (n, worst, mass) in found {
        assert!(n >= 46 && worst < 1.0e-5, "{n} {worst:e}");
        assert!(mass < 1.0e-6, "{mass:e}");
    }
}

/// All joints together: the target's numbers have a better condition number than with one joint.
#[test]
fn paper_all_joints_at_once_beside_one() {
    let cases = together::cases(&context()).unwrap();
    let [one, all] = [0, 1].map(|k| {
        let (e, truth) = together::answer(&context(), &cases[k], "xu2017", None).unwrap();
        let (worst, n) = errors(&e.bodies[6], &truth);
        assert_eq!(n, 10);
        (worst, together::condition(&e))
    });
    println!("worst and condition: joint 6 alone {one:?}, all joints {all:?}");
    assert!(one.0 < 1.0e-5 && all.0 < 1.0e-5);
    assert!(all.1 < one.1);
}

/// Noise as in the simulated data: all ten numbers are within four sigmas, and sigma is useful.
#[test]
fn stat_grasped_target_with_all_joints_moving() {
    let case = read_case(&shipped().join("cases/xu2017_target_all_joints.toml")).unwrap();
    let vehicle = read_model(&case.model).unwrap();
    let t = vehicle.bodies[6].nominal;
    let table = simulate_case(&case, &vehicle).unwrap().table;
    let mut off = vehicle.clone();
    off.bodies[6].nominal.mass *= 1.2;
    off.bodies[6].nominal.I_BBcm_B *= 1.3;
    for (method, variant) in [("xu2017", Some("linear")), ("auto", None)] {
        let found =
            identify_tables(off.clone(), vec![table.clone()], &request(method, variant)).unwrap();
        let e = found.estimate;
        assert_eq!(e.status, Status::Converged, "{method}");
        let b = &e.bodies[6];
        let (worst, n) = errors(b, &t);
        println!("{method}: {n} of ten, worst {worst:.1e}");
        assert_eq!(n, 10);
        let sigmas = |n: &poinsot_identify::Number, x: f64| {
            ((n.value.unwrap() - x) / n.sigma.unwrap()).abs()
        };
        assert!(sigmas(&b.mass, t.mass) < 4.0);
        for k in 0..3 {
            assert!(sigmas(&b.com[k], t.p_BoBcm_B[k]) < 4.0);
        }
        for (n, at) in b.inertia.iter().zip(poinsot_identify::TENSOR) {
            assert!(sigmas(n, t.I_BBcm_B[at]) < 4.0, "{method} {at:?}");
        }
        assert!(worst < 0.05, "{method} {worst}");
    }
}
