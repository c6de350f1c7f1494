//! Texts of refusals and warnings.

use super::*;

fn refusal(model: Model, tables: Vec<Table>, variant: &str) -> String {
    identify_tables(model, tables, &request("xu2017", Some(variant)))
        .map(|i| i.estimate.status)
        .unwrap_err()
        .to_string()
}

fn warned(found: &Identified, words: &str) -> String {
    let list = &found.estimate.warnings();
    let found = list.iter().find(|w| w.contains(words));
    let found = found.unwrap_or_else(|| panic!("no '{words}' in {list:?}"));
    (*found).to_owned()
}

/// Complete messages.
#[test]
fn unit_refusals_say_what_to_do() {
    let m = model("xu2017/model.toml");
    let arm = || runs(&m, &["C2", "C3"]);
    assert_eq!(
        refusal(m.clone(), arm(), "linear"),
        "E0533 no thruster fires with the joints locked, and no body fixes the scale of the momentum equations (35); add a segment with thrust, take estimate out of the base or the arm, or use --method auto"
    );
    let mut partly = m.clone();
    partly.bodies[3].estimate.com = false;
    assert_eq!(
        refusal(partly, runs(&m, &["C1"]), "linear"),
        "E0532 body 'B3': estimate: xu2017 takes a body as known, as unknown (estimate = true), or with known mass and mass centre (estimate = [\"inertia\"]); change it, or use --method auto"
    );
    let mut moved = runs(&m, &["C1", "C2", "C3"]);
    let label = moved[2].sources[0].path.clone();
    let joint = moved[2]
        .channels
        .iter_mut()
        .find(|c| c.name == "joint5_rad")
        .unwrap();
    joint.values.iter_mut().for_each(|q| *q = 0.1);
    assert_eq!(
        refusal(m.clone(), moved, "linear"),
        format!(
            "E0537 segment '{label}': joint 'joint5' is locked at 0.1, elsewhere at 0 (rad or m): (43)-(46) need one normal configuration in all segments; bring the joint back, or use --method auto"
        )
    );
    let mut both = runs(&m, &["C1", "C2"]);
    let label = both[1].sources[0].path.clone();
    let turned = both[1]
        .channels
        .iter()
        .find(|c| c.name == "joint1_rad")
        .unwrap()
        .values
        .clone();
    let other = both[1]
        .channels
        .iter_mut()
        .find(|c| c.name == "joint4_rad")
        .unwrap();
    other.values = turned;
    assert_eq!(
        refusal(m.clone(), both, "linear"),
        format!(
            "E0535 segment '{label}': joints joint1, joint4 move together: xu2017 unlocks one joint at a time unless a single body is unknown; split the motion, or use --method auto"
        )
    );
}

#[test]
fn unit_refusals_of_motion_and_thrust_say_what_to_do() {
    let m = model("xu2017/model.toml");
    let mut still = runs(&m, &["C1"]);
    still[0].channels.retain(|c| !c.name.starts_with("thr"));
    assert_eq!(
        refusal(m.clone(), still, "swarm"),
        "E0539 no segment has thrust with the joints locked, and in none does a joint move: xu2017 has nothing to work on; fire thrusters or drive a joint, or use --method auto"
    );
    let mut drifting = runs(&m, &["C1", "C2"]);
    let label = drifting[1].sources[0].path.clone();
    let v = drifting[1]
        .channels
        .iter_mut()
        .find(|c| c.name == "v_x")
        .unwrap();
    v.values.iter_mut().for_each(|x| *x += 0.05);
    assert_eq!(
        refusal(m, drifting, "swarm"),
        format!(
            "E0538 segment '{label}': the vehicle moves at 0 rad/s and 0.05 m/s at the first sample: the objective (52) assumes zero momentum, so variant swarm must start at rest; use --variant linear, which takes the momentum as unknown"
        )
    );
    let mut firing = runs(&model("xu2017/model.toml"), &["C1", "C2"]);
    let label = firing[1].sources[0].path.clone();
    let mut thrust = firing[1]
        .channels
        .iter()
        .find(|c| c.name == "joint1_rad")
        .unwrap()
        .clone();
    thrust.name = "thr3_N".to_owned();
    thrust.values.iter_mut().for_each(|f| *f = 2.0);
    firing[1].channels.push(thrust);
    assert_eq!(
        refusal(model("xu2017/model.toml"), firing, "linear"),
        format!(
            "E0536 segment '{label}': a thruster fires while joint 'joint1' moves: xu2017 takes momentum as conserved then; cut the firing out, or use --method auto"
        )
    );
}

#[test]
fn unit_the_report_says_what_is_claimed_and_what_is_determined() {
    let m = model("xu2017/model.toml");
    let found = ask(&m, runs(&m, &["C1", "C2"]), "linear");
    assert!(!found.passes());
    let note = found.estimate.method_report.unwrap().note;
    assert!(note.contains("The method claims every number of every body; the data determine 17 of 70 combinations, and only those are given."), "{note}");
}

#[test]
fn unit_a_thruster_that_never_fires_is_named() {
    let m = model("xu2017/model.toml");
    let mut tables = runs(&m, &["C1"]);
    tables[0]
        .channels
        .retain(|c| c.name != "thr9_N" && c.name != "thr10_N");
    // Without its firings, later samples would contradict the rest: keep earlier ones only.
    for c in &mut tables[0].channels {
        let n = c.time_s.iter().filter(|t| **t < 45.0).count();
        c.time_s = c.time_s.iter().copied().take(n).collect();
        c.values.truncate(n);
    }
    let found = ask(&m, tables, "linear");
    assert_eq!(
        warned(&found, "never fires"),
        "thr6, thr9, thr10 never fires while the joints are locked: what only their thrust would show is undetermined"
    );
    assert!(worst_of_whole(&found.estimate, &total()) < 1.0e-6);
}

#[test]
fn unit_thrust_through_the_mass_centre_shows_no_inertia() {
    let mut single = robot().one_body(false);
    let right = total();
    let mut exact = single.clone();
    exact.bodies[0].nominal = right;
    exact.sensors.clear();
    for m in [&mut single, &mut exact] {
        for (k, thruster) in m.thrusters.iter_mut().enumerate() {
            thruster.p_BoT_B = right.p_BoBcm_B;
            thruster.direction_B = [Vector3::x(), Vector3::y(), Vector3::z()][k % 3];
        }
    }
    let case = read_case(&shipped().join("cases/xu2017_c1.toml")).unwrap();
    let table = simulate_case(&case, &exact).unwrap().table;
    let found = ask(&single, vec![table], "linear");
    println!("{:?}", found.estimate.warnings());
    let message = warned(&found, "no torque");
    assert!(
        message.starts_with("the thrust makes no torque about the mass centre (largest lever "),
        "{message}"
    );
    assert!(message.ends_with("so the inertia tensor does not enter (30) and is undetermined; fire thrusters beside the mass centre"), "{message}");
    let e = &found.estimate;
    assert_eq!(e.status, Status::Partial);
    assert!(e.bodies[0].inertia.iter().all(|n| n.value.is_none()));
    assert!((e.bodies[0].mass.value.unwrap() / 476.0 - 1.0).abs() < 1.0e-8);
}

#[test]
fn unit_a_joint_that_does_not_move_makes_one_body_of_two() {
    let m = model("xu2017/model.toml");
    let found = ask(
        &m,
        runs(&m, &["C1", "C2", "C3", "C5", "C6", "C7"]),
        "linear",
    );
    assert_eq!(
        warned(&found, "does not move"),
        "joint3 does not move in any segment: B2 and B3 are one body to these data; drive it in a separate segment"
    );
    let e = &found.estimate;
    assert_eq!(e.identifiability.determined.len(), 45);
    let worst = worst_combination(e, &truth());
    println!("{worst:.1e}");
    assert!(worst < 1.0e-6, "{worst:e}");
}

/// Nominal numbers so wrong that the range around them excludes the solution.
#[test]
fn unit_a_search_range_that_excludes_the_answer_is_reported() {
    let mut single = robot().one_body(false);
    single.bodies[0].nominal = total();
    single.bodies[0].nominal.mass = 200.0;
    let tables = thinned(runs(&single, &["C1"]), 4);
    let found = ask(&single, tables.clone(), "swarm");
    let message = warned(&found, "bound of its search range");
    println!("{message}");
    assert!(message.starts_with("equivalent single body: the swarm's solution is on the bound of its search range (mass = 300.000000 kg of [100.000000, 300.000000]"), "{message}");
    assert!(message.contains("the range excludes the answer and its numbers are withheld"));
    let e = &found.estimate;
    assert_eq!((e.status, found.passes()), (Status::IterationLimit, false));
    assert!(e.bodies[0].mass.value.is_none() && e.identifiability.determined.is_empty());
    // The linear solver needs no range.
    let e = ask(&single, tables.clone(), "linear").estimate;
    assert!((e.bodies[0].mass.value.unwrap() / 476.0 - 1.0).abs() < 1.0e-6);
    // With factors of three to either side, a wider range contains the solution.
    for nominal in [total().mass / 3.0, 3.0 * total().mass] {
        single.bodies[0].nominal.mass = nominal;
        let question = Question {
            settings: vec!["range=3".to_owned()],
            ..request("xu2017", Some("swarm"))
        };
        let found = identify_tables(single.clone(), tables.clone(), &question).unwrap();
        let mass = found.estimate.bodies[0].mass.value.unwrap();
        assert!(
            (mass / total().mass - 1.0).abs() < 1.0e-4,
            "{nominal}: {mass}"
        );
    }
}
