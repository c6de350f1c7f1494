//! Remedies by a single change: a stated effect must occur when the change is made.

use crate::vehicle;

use poinsot_dynamics::{Start, StartVelocity, WheelMotion};
use poinsot_identify::Estimate;
use poinsot_model::{EstimateSet, Model, Prior, SensorKind};
use poinsot_spatial::{Matrix3, Vector3};
use vehicle::*;

fn say(answer: &Estimate) {
    for open in &answer.identifiability.open {
        println!("{}\n    {}", open.text, open.remedy);
    }
}

/// A body with one wheel along z and unknown inertia.
pub fn one_axis() -> Model {
    let mut model = tree(31, "");
    model.bodies[0].nominal.I_BBcm_B = Matrix3::from_diagonal(&Vector3::new(5.0, 6.0, 7.0));
    model.bodies[0].estimate = EstimateSet {
        inertia: true,
        ..EstimateSet::default()
    };
    model.wheels = with_wheels(model.clone()).wheels;
    model.wheels.truncate(1);
    model.wheels[0].axis_B = Vector3::z();
    model.sensors = [SensorKind::Gyro, SensorKind::Attitude]
        .map(|kind| sensor(kind, 1.0e-4))
        .to_vec();
    model
}

pub fn spinning(model: &Model, w_NB_B: Vector3) -> Flight {
    let mut flight = moving(model, 5);
    for wheel in &mut flight.plan.wheels {
        *wheel = WheelMotion::constant(100.0);
    }
    flight.start = Start {
        velocity: StartVelocity::Twist {
            v_NBo_N: Vector3::zeros(),
            w_NB_B,
        },
        ..flight.start
    };
    flight
}

/// A spin along the wheel determines some numbers; the stated rotation about another axis determines the stated ones.
#[test]
fn exact_the_axis_named_closes_what_it_was_said_to_close() {
    let model = one_axis();
    let alone = rotation_only(fly(&model, &spinning(&model, Vector3::new(0.0, 0.0, 0.05))));
    let before = ask(&model, vec![alone.clone()], "auto").estimate;
    say(&before);
    let found = &before.identifiability;
    assert!(found.rank < 6);
    let axis = |text: &str| {
        let at = text.find("about its ")? + "about its ".len();
        ["x", "y", "z"]
            .iter()
            .position(|a| text[at..].starts_with(a))
    };
    for open in &found.open {
        let Some(axis) = axis(&open.remedy) else {
            unreachable!("{}: {}", open.text, open.remedy);
        };
        let mut w = Vector3::new(0.0, 0.0, 0.05);
        w[axis] += 0.05;
        let more = rotation_only(fly(&model, &spinning(&model, w)));
        let after = ask(&model, vec![alone.clone(), more], "auto").estimate;
        let closes: usize = open
            .remedy
            .split("resolves ")
            .nth(1)
            .and_then(|t| t.split(' ').next())
            .and_then(|n| n.parse().ok())
            .unwrap();
        let gained = after.identifiability.rank - found.rank;
        println!("axis {axis}: said to resolve {closes}, gained {gained}");
        assert!(gained >= closes && closes >= 1, "{}", open.remedy);
    }
}

/// Rotation does not determine mass and mass centre, for any request. Giving them resolves them; a rotation resolves
/// the inertia about the mass centre without them.
#[test]
fn regress_mass_and_mass_centre_that_do_not_show_need_no_pair() {
    let mut model = one_axis();
    model.bodies[0].estimate = EstimateSet::ALL;
    let alone = rotation_only(fly(&model, &spinning(&model, Vector3::new(0.0, 0.0, 0.05))));
    let answer = ask(&model, vec![alone], "auto").estimate;
    say(&answer);
    for open in &answer.identifiability.open {
        let (name, _) = &open.coefficients[0];
        let wanted: &[&str] = match name.rsplit_once('.').unwrap().1 {
            "m" => &["fix the mass of"],
            // It rotates about a point off the mass centre, which an accelerometer measures.
            "com_x" | "com_y" | "com_z" => &["fix the mass centre of", "add an accelerometer"],
            _ => &["record "],
        };
        let named = wanted.iter().any(|w| open.remedy.starts_with(w));
        assert!(named, "{name}: {}", open.remedy);
    }
}

/// No known force acts on a coasting body: a known force would set its scale.
#[test]
fn exact_a_known_force_closes_the_scale() {
    let mut model = tree(32, "");
    model.sensors = sensors(1.0e-4);
    let answer = ask(&model, vec![fly(&model, &moving(&model, 4))], "auto").estimate;
    say(&answer);
    let scale = answer
        .identifiability
        .open
        .iter()
        .find(|o| o.text.contains("common scale"));
    let remedy = &scale.unwrap().remedy;
    assert!(
        remedy.contains("apply a force to the base") || remedy.contains("known force"),
        "{remedy}"
    );
}

/// Mass on a joint's axis can be attributed to either body in any motion: only giving a number helps.
#[test]
fn exact_only_a_number_given_parts_the_bodies_of_a_joint() {
    let mut model = with_thrusters(tree(33, "r"));
    model.sensors = sensors(1.0e-5);
    let answer = ask(&model, vec![fly(&model, &moving(&model, 4))], "auto").estimate;
    say(&answer);
    let open = &answer.identifiability.open;
    assert_eq!(open.len(), 3);
    for one in open {
        assert!(
            one.remedy.starts_with("fix "),
            "{}: {}",
            one.text,
            one.remedy
        );
    }
}

/// An arm that stands: one record with both joints moving resolves as many directions as its remedy says, and with the
/// numbers that the common remedy names nothing is left. An arm that nobody tuned for, and a prismatic joint.
#[test]
fn exact_an_arm_that_stands_is_told_the_motion_and_the_numbers_that_resolve_all() {
    for (seed, joints) in [(34, "rr"), (38, "rp")] {
        let mut model = with_thrusters(tree(seed, joints));
        model.sensors = sensors(1.0e-5);
        let still = flight(&model, 4, &[Drive::Stands(0.1), Drive::Stands(-0.2)]);
        let still = fly(&model, &still);
        let before = ask(&model, vec![still.clone()], "auto").estimate;
        say(&before);
        let open = &before.identifiability.open;
        let together = open.iter().find(|o| o.remedy.starts_with("only together"));
        let remedy = &together.unwrap().remedy;
        let (motion, numbers) = remedy.split_once(" (resolves ").unwrap();
        assert!(motion.contains("all joints oscillating"), "{remedy}");
        let resolves: usize = numbers.split(' ').next().unwrap().parse().unwrap();

        let more = fly(&model, &moving(&model, 5));
        let both = vec![still.clone(), more.clone()];
        let after = ask(&model, both.clone(), "auto").estimate;
        let gained = after.identifiability.rank - before.identifiability.rank;
        println!("{joints}: said to resolve {resolves}, gained {gained}");
        assert_eq!(gained, resolves);

        // What stands behind "the" up to the next one are the bodies of one kind of number: given as priors.
        for part in numbers.split("the ").skip(1) {
            let of = |what: &str, name: &str| {
                let bodies = part
                    .strip_prefix(what)
                    .map(|t| t.split(" to a sigma").next());
                bodies.flatten().is_some_and(|text| text.contains(name))
            };
            for body in &mut model.bodies {
                let mut prior = body.prior.unwrap_or(Prior {
                    mass: None,
                    com: None,
                    inertia: None,
                    entropic: None,
                    forget_s: None,
                });
                let size = 1.0e-3 * body.nominal.mass;
                if of("mass of ", &body.name) {
                    prior.mass = Some(size);
                }
                if of("mass centre of ", &body.name) {
                    prior.com = Some(1.0e-3);
                }
                if of("inertia of ", &body.name) {
                    prior.inertia = Some(0.1 * size);
                }
                body.prior = Some(prior);
            }
        }
        let known = ask(&model, both, "auto").estimate;
        for body in &known.bodies {
            let numbers = body.inertia.iter().chain([&body.mass]);
            for n in numbers {
                assert!(n.sigma.is_some(), "{joints}: {}", body.name);
            }
        }
    }
}
