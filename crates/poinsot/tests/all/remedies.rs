//! Remedies by a single change: a stated effect must occur when the change is made.

use crate::vehicle;

use poinsot_dynamics::{PiecewisePolynomial, Start, StartVelocity, WheelMotion};
use poinsot_identify::Estimate;
use poinsot_model::{EstimateSet, Model, Prior, Sensor, SensorKind};
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
            // Its own wheel determines what its axis turns.
            let run = Run::read(&model, &open.remedy).map(|run| run.wheels);
            assert_eq!(run.as_deref(), Some(&[0][..]), "{}", open.remedy);
            continue;
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

/// A wheel run that a remedy names.
struct Run<'a> {
    wheels: Vec<usize>,
    size: f64,
    half_s: f64,
    span_s: f64,
    sigma: f64,
    resolves: usize,
    text: &'a str,
}

impl<'a> Run<'a> {
    fn read(model: &Model, text: &'a str) -> Option<Self> {
        let after = |mark: &str| text.split_once(mark).map(|(_, rest)| rest);
        let number = |mark: &str| {
            let word = after(mark)?.split(' ').next()?;
            word.parse::<f64>().ok()
        };
        let whose = after("the speed")?.split(" rising").next()?;
        let named = |k: &usize| {
            let name = &model.wheels[*k].name;
            whose.split([' ', ',']).any(|word| word == name.as_str())
        };
        Some(Self {
            wheels: (0..model.wheels.len()).filter(named).collect(),
            size: number("rising evenly by ")?,
            half_s: number("rad/s in ")?,
            span_s: number("record ")?,
            sigma: 0.01 * number("then sigma at most ")?,
            resolves: number("resolves ")? as usize,
            text,
        })
    }

    /// The flight with the wheels run as it says.
    fn of(&self, flight: &Flight, speed: f64) -> Flight {
        let mut flight = flight.clone();
        for (k, wheel) in self.wheels.iter().enumerate() {
            let from = 2.0 * self.half_s * k as f64;
            let nodes = [0.0, 1.0, 2.0].map(|n| from + n * self.half_s);
            let profile =
                PiecewisePolynomial::linear(&nodes, &[speed, speed + self.size, speed]).unwrap();
            flight.plan.wheels[*wheel] = WheelMotion::Speed(profile);
        }
        flight.duration_s = self.span_s;
        flight
    }
}

/// A bus that coasts, or spins about one of its axes, while its wheels keep their speed: the stated run of the wheels resolves
/// what it says, with the sigma that it says. Inertia, axes and number of the wheels, their speed, the noise of the tachometers
/// and the pace of the star tracker vary.
#[test]
fn prop_a_wheel_that_is_run_as_advised_gives_the_sigma_that_was_stated() {
    let (mut told, mut compared, mut wrong) = (0, 0, Vec::new());
    for seed in 0..24_u64 {
        let mut dice = Dice::new(seed + 900);
        let mut model = tree(700 + seed, "");
        model.bodies[0].nominal.I_BBcm_B *= dice.between(0.3, 3.0);
        model.bodies[0].estimate = EstimateSet {
            inertia: true,
            ..EstimateSet::default()
        };
        model.wheels = with_wheels(model.clone()).wheels;
        for (k, wheel) in model.wheels.iter_mut().enumerate() {
            wheel.spin_inertia = dice.between(0.005, 0.05);
            wheel.axis_B = match seed % 3 {
                0 => Vector3::ith((k + seed as usize) % 3, 1.0),
                _ => dice.direction(),
            };
        }
        model.wheels.truncate(1 + (seed % 4).min(2) as usize);
        model.sensors = [SensorKind::Gyro, SensorKind::Attitude]
            .map(|kind| sensor(kind, 1.0e-4))
            .to_vec();
        let tachometer = if seed % 2 == 0 { 0.002 } else { 0.01 };
        model.sensors.push(Sensor {
            of: (0..model.wheels.len()).collect(),
            ..sensor(SensorKind::WheelSpeed, tachometer)
        });
        let (speed, rate) = match seed % 3 {
            1 => (80.0, Vector3::zeros()),
            2 => (0.0, Vector3::zeros()),
            _ => (80.0, model.wheels[0].axis_B * 0.02),
        };
        let mut flight = spinning(&model, rate);
        flight.duration_s = dice.between(30.0, 90.0).round();
        for wheel in &mut flight.plan.wheels {
            *wheel = WheelMotion::constant(speed);
        }
        let slow =
            |table| vehicle::thinned(rotation_only(table), "q_", 1 + 4 * (seed % 2) as usize);
        let alone = slow(fly(&model, &flight));
        let before = ask(&model, vec![alone.clone()], "auto").estimate;
        say(&before);
        let found = &before.identifiability;
        let natural =
            model.bodies[0].nominal.mass * model.bodies[0].nominal.radius_of_gyration().powi(2);
        let mut runs: Vec<&str> = found.open.iter().map(|o| o.remedy.as_str()).collect();
        runs.dedup();
        let runs = runs.into_iter().filter_map(|text| Run::read(&model, text));
        for run in runs {
            told += 1;
            let more = slow(fly(&model, &run.of(&flight, speed)));
            let after = ask(&model, vec![alone.clone(), more], "auto").estimate;
            let gained = after.identifiability.rank - found.rank;
            assert!(
                gained >= run.resolves && run.resolves >= 1,
                "seed {seed}: {gained}: {}",
                run.text
            );
            // A number that stays undetermined has no row of the covariance.
            if run.resolves < found.open.len() {
                continue;
            }
            compared += 1;
            let own = found.open.iter().filter(|o| o.remedy == run.text);
            let sigma = own.map(|open| {
                let at = |name: &str| {
                    let name = name.replace("I_BBcm_", "inertia_");
                    after.covariance_names.iter().position(|n| *n == name)
                };
                let length = open
                    .coefficients
                    .iter()
                    .map(|c| c.1 * c.1)
                    .sum::<f64>()
                    .sqrt();
                let all = || open.coefficients.iter();
                let pairs = all().flat_map(|a| all().map(move |b| (a, b)));
                let square: f64 = pairs
                    .map(|((a, x), (b, y))| {
                        x * y * after.covariance[at(a).unwrap()][at(b).unwrap()]
                    })
                    .sum();
                square.sqrt() / (length * natural)
            });
            let sigma = sigma.fold(0.0, f64::max);
            println!(
                "seed {seed}: sigma stated {:.3e}, found {sigma:.3e}, {}",
                run.sigma, run.text
            );
            let known = after.bodies[0].inertia.iter().all(|n| n.sigma.is_some());
            let agrees = (run.sigma / 1.5..1.5 * run.sigma).contains(&sigma);
            if !(known && agrees) {
                wrong.push(format!("seed {seed}: {sigma}, {}", run.text));
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
    assert!(told >= 8 && compared >= 6, "{told} {compared}");
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
