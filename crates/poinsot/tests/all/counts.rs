//! Number of identifiable combinations for trees of generic geometry (the counts of FINDINGS). Where rotation alone is seen, with as
//! many joints as `POINSOT_JOINTS` says.

use crate::vehicle;

use poinsot::Identified;
use poinsot_dynamics::Start;
use poinsot_identify::Status;
use poinsot_model::{Model, Momentum, MomentumKnowledge};
use poinsot_spatial::Vector3;
use vehicle::*;

/// The rank above round-off, and the rank for a declared noise of 1e-9, must both equal the count.
fn check(what: &str, answer: &Identified, count: usize) {
    let found = &answer.estimate.identifiability;
    let s = &found.sigmas_natural;
    let edge = |k: usize| s.get(k).copied().unwrap_or(f64::NAN);
    println!(
        "{what}: structural {} rank {} of {}, expected {count}; sigma {:.1e} | {:.1e}",
        found.structural_rank,
        found.rank,
        found.parameters,
        edge(count - 1),
        edge(count),
    );
    assert_eq!(found.structural_rank, count, "{what}: structural rank");
    assert_eq!(found.rank, count, "{what}: rank");
    assert_eq!(found.open.len(), found.parameters - count, "{what}");
    // The next direction is round-off: sigma of at least 3e3, far above the rank decision.
    let hidden = s.get(count).is_none_or(|sigma| *sigma > 500.0);
    assert!(hidden, "{what}: {:.1e}", edge(count));
    // Joints and wheels are interpolated between samples, which with noise of 1e-9 may reject the model. A curved set
    // of equal prediction has fewer invariant combinations than the rank.
    if answer.estimate.status != Status::Rejected {
        let linear = found
            .determined
            .iter()
            .filter(|c| !c.coefficients.is_empty());
        match found.ranks.is_empty() {
            true => assert_eq!(linear.count(), count, "{what}"),
            false => {
                assert!(linear.count() <= count, "{what}");
                assert_eq!(found.ranks, [count; 3], "{what}");
            }
        }
    }
}

fn moving_count(joints: &str) -> usize {
    let turning = joints.matches('r').count();
    10 + 7 * turning + 4 * (joints.len() - turning)
}

fn identified(model: &Model, flights: &[Flight], method: &str) -> Identified {
    let tables = flights.iter().map(|f| fly(model, f)).collect();
    ask(&off_nominal(model, 0.05), tables, method)
}

#[test]
fn paper_moving_joints_with_a_scale_show_10_and_7_and_4() {
    for (k, joints) in ["r", "p", "rr", "rp", "pp", "rrr", "prr", "rrrr", "rprp"]
        .into_iter()
        .enumerate()
    {
        let seed = 100 + k as u64;
        let wheeled = with_wheels(tree(seed, joints));
        let flights = [moving(&wheeled, seed), moving(&wheeled, seed + 50)];
        let answer = identified(&wheeled, &flights, "linear");
        check(&format!("{joints} wheels"), &answer, moving_count(joints));
        let pushed = with_thrusters(tree(seed, joints));
        let flights = [moving(&pushed, seed), moving(&pushed, seed + 50)];
        let answer = identified(&pushed, &flights, "linear");
        check(
            &format!("{joints} thrusters"),
            &answer,
            moving_count(joints),
        );
    }
}

#[test]
fn paper_without_a_scale_one_fewer() {
    for (k, joints) in ["r", "p", "rr", "rp", "rrr", "prr"].into_iter().enumerate() {
        let seed = 200 + k as u64;
        let model = tree(seed, joints);
        let flights = [moving(&model, seed), moving(&model, seed + 50)];
        let answer = identified(&model, &flights, "linear");
        check(
            &format!("{joints} drifting"),
            &answer,
            moving_count(joints) - 1,
        );
    }
}

#[test]
fn paper_joints_stopped_at_many_positions_show_10_and_6_and_4() {
    for (k, joints) in ["r", "p", "rr", "rp"].into_iter().enumerate() {
        let seed = 300 + k as u64;
        let model = with_thrusters(tree(seed, joints));
        let mut dice = Dice::new(seed);
        let flights: Vec<Flight> = (0..12 * joints.len() as u64)
            .map(|i| {
                let stands: Vec<Drive> = (0..joints.len())
                    .map(|_| Drive::Stands(dice.between(-1.5, 1.5)))
                    .collect();
                flight(&model, seed + i, &stands)
            })
            .collect();
        let answer = identified(&model, &flights, "linear");
        let turning = joints.matches('r').count();
        let count = 10 + 6 * turning + 4 * (joints.len() - turning);
        check(&format!("{joints} stopped"), &answer, count);
    }
}

#[test]
fn paper_a_joint_that_never_moves_makes_one_body_of_two() {
    let model = with_thrusters(tree(41, "rr"));
    let drives = [Drive::Moves, Drive::Stands(0.4)];
    let flights = [flight(&model, 41, &drives), flight(&model, 42, &drives)];
    let answer = identified(&model, &flights, "linear");
    check("rr, second stopped", &answer, 17);
}

/// A rigid body in two flights, by both methods.
fn rigid_body(model: &Model, count: usize) {
    for method in ["linear", "maximum_likelihood"] {
        let flights = [moving(model, 51), moving(model, 52)];
        let answer = identified(model, &flights, method);
        check(&format!("rigid body, {method}"), &answer, count);
    }
}

#[test]
fn paper_a_rigid_body_that_drifts_shows_8() {
    rigid_body(&tree(51, ""), 8);
}

#[test]
fn paper_a_rigid_body_with_wheels_shows_9_and_never_the_mass() {
    rigid_body(&with_wheels(tree(51, "")), 9);
}

#[test]
fn paper_a_rigid_body_with_thrusters_shows_all_10() {
    rigid_body(&with_thrusters(tree(51, "")), 10);
}

#[test]
fn paper_zero_momentum_hides_the_scale_too() {
    for (k, joints) in ["rr", "rp"].into_iter().enumerate() {
        let seed = 250 + k as u64;
        let mut model = tree(seed, joints);
        let zero = MomentumKnowledge::Known(Vector3::zeros());
        model.momentum = Momentum {
            linear: zero,
            angular: zero,
        };
        let still = [moving(&model, seed), moving(&model, seed + 50)].map(|f| Flight {
            start: Start::at_rest(),
            ..f
        });
        let answer = identified(&model, &still, "linear");
        check(
            &format!("{joints} at rest"),
            &answer,
            moving_count(joints) - 1,
        );
    }
}

/// Gyro and attitude only; nominal numbers are the true ones, because only the count is tested.
fn from_rotation(model: &Model, flights: &[Flight]) -> Identified {
    let tables = flights
        .iter()
        .map(|f| rotation_only(fly(model, f)))
        .collect();
    ask(model, tables, "maximum_likelihood")
}

/// Whether a tree with these joints is in the run: the larger ones take half a minute each.
fn is_in_run(joints: &str) -> bool {
    let most = std::env::var("POINSOT_JOINTS").map_or(2, |n| n.parse().unwrap());
    joints.len() <= most
}

#[test]
fn paper_rotation_of_a_tree_with_wheels() {
    for (k, (joints, count)) in [
        ("", 6),
        ("r", 14),
        ("rr", 23),
        ("rrr", 31),
        ("p", 10),
        ("pp", 15),
        ("rp", 19),
    ]
    .into_iter()
    .enumerate()
    .filter(|(_, (joints, _))| is_in_run(joints))
    {
        let seed = 600 + k as u64;
        let model = with_wheels(tree(seed, joints));
        let flights = [moving(&model, seed), moving(&model, seed + 50)];
        check(
            &format!("{joints} rotation, wheels"),
            &from_rotation(&model, &flights),
            count,
        );
    }
}

#[test]
fn paper_rotation_of_a_tree_without_a_scale_one_fewer() {
    for (k, (joints, count)) in [("", 5), ("r", 13), ("rr", 22)].into_iter().enumerate() {
        let seed = 700 + k as u64;
        let model = tree(seed, joints);
        let flights = [moving(&model, seed), moving(&model, seed + 50)];
        check(
            &format!("{joints} rotation, drifting"),
            &from_rotation(&model, &flights),
            count,
        );
    }
}

#[test]
fn paper_rotation_of_a_tree_with_thrusters_shows_all() {
    for (k, (joints, count)) in [("", 9), ("r", 17), ("rr", 24)].into_iter().enumerate() {
        let seed = 800 + k as u64;
        let model = with_thrusters(tree(seed, joints));
        let flights = [moving(&model, seed), moving(&model, seed + 50)];
        check(
            &format!("{joints} rotation, thrusters"),
            &from_rotation(&model, &flights),
            count,
        );
    }
}

#[test]
fn paper_rotation_with_one_joint_at_a_time() {
    for (k, (joints, count)) in [("r", 14), ("rr", 22), ("rrr", 30), ("rrrr", 38)]
        .into_iter()
        .enumerate()
        .filter(|(_, (joints, _))| is_in_run(joints))
    {
        let seed = 900 + k as u64;
        let model = with_wheels(tree(seed, joints));
        let flights: Vec<Flight> = (0..joints.len())
            .map(|mover| {
                let drives: Vec<Drive> = (0..joints.len())
                    .map(|j| match j == mover {
                        true => Drive::Moves,
                        false => Drive::Stands(0.2),
                    })
                    .collect();
                flight(&model, seed + mover as u64, &drives)
            })
            .collect();
        check(
            &format!("{joints} one at a time"),
            &from_rotation(&model, &flights),
            count,
        );
    }
}
