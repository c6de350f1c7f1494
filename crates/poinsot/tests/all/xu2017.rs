//! Xu, Hu, Zhang and Liang 2017: both steps against closed forms, MuJoCo, the printed tables; refusals.

use poinsot::case::read_case;
use poinsot::identify::identify_tables;
use poinsot::simulate::simulate_case;
use poinsot::study::Verbs;
use poinsot::validate::{Mover, compare_motion};
use poinsot::{Identified, Question};
use poinsot_identify::{Estimate, Status, linear};
use poinsot_model::{EstimateSet, Model, read_model};
use poinsot_papers::study::Context;
use poinsot_papers::xu2017::studies::null::Null;
use poinsot_papers::xu2017::studies::printed::{IDENTIFIED, printed_bodies};
use poinsot_papers::xu2017::studies::robot::{
    ALL, ARM, Data, Robot, errors, properties, thinned, without_translation,
};
use poinsot_papers::xu2017::studies::{RATE, largest_coefficients, together};
use poinsot_papers::xu2017::swarm::Swarm;
use poinsot_papers::xu2017::{Form, Kind, Order, Solver, particle, sequence};
use poinsot_spatial::{InertialParameters, MassProperties, Vector3};
use poinsot_telemetry::Table;
use std::path::{Path, PathBuf};
use std::sync::LazyLock;

fn examples() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples")
}

/// What the studies are given.
fn context() -> Context<'static> {
    static EXAMPLES: LazyLock<PathBuf> = LazyLock::new(examples);
    Context {
        examples: &EXAMPLES,
        tools: &Verbs,
    }
}

fn robot() -> Robot<'static> {
    Robot::new(&context()).unwrap()
}

fn truth() -> Vec<InertialParameters> {
    robot().truth
}

fn model(path: &str) -> Model {
    read_model(examples().join(path)).unwrap()
}

fn runs(model: &Model, names: &[&str]) -> Vec<Table> {
    robot().runs(model, names).unwrap()
}

fn bound(model: Model, tables: &[Table]) -> Data {
    Data::new(&context(), model, tables).unwrap()
}

fn request(method: &str, variant: Option<&str>) -> Question {
    Question {
        variant: variant.map(str::to_owned),
        ..Question::by(method)
    }
}

fn ask(model: &Model, tables: Vec<Table>, variant: &str) -> Identified {
    identify_tables(model.clone(), tables, &request("xu2017", Some(variant))).unwrap()
}

/// Our own run of C1, which logs angular acceleration and specific force as the paper's simulation did.
fn own_single_body() -> (Model, Table) {
    let case = read_case(&examples().join("cases/xu2017_c1.toml")).unwrap();
    let mut exact = read_model(&case.model).unwrap();
    exact.sensors.clear();
    let table = simulate_case(&case, &exact).unwrap().table;
    (model("xu2017/model.toml"), table)
}

/// Relative errors of the ten numbers of the locked robot.
fn worst_of_whole(estimate: &Estimate, total: &MassProperties) -> f64 {
    let (worst, n) = errors(&estimate.system.as_ref().unwrap().0, total);
    assert_eq!(n, 10);
    worst
}

fn total() -> MassProperties {
    robot().whole()
}

/// The paper prints 1e-11 to 1e-14 per cent.
#[test]
fn exact_single_body_from_accelerations_to_1e_10() {
    let (nominal, table) = own_single_body();
    let data = bound(nominal.clone(), std::slice::from_ref(&table));
    let found = sequence(&data.problem(), Order::Outward, &Solver::default()).unwrap();
    assert_eq!(found.form, Some(Form::Acceleration));
    let e = ask(&nominal, vec![table], "linear").estimate;
    let worst = worst_of_whole(&e, &total());
    println!("linear, accelerations: {worst:.1e}");
    assert!(worst < 1.0e-10, "{worst:e}");
    assert!(
        e.method_report
            .unwrap()
            .note
            .contains("measured accelerations")
    );
}

#[test]
fn exact_swarm_reaches_the_linear_solution_of_the_single_body() {
    let (nominal, table) = own_single_body();
    let data = bound(nominal, &thinned(vec![table], 2));
    let x = particle(&total());
    let mut before = f64::INFINITY;
    for iterations in [100, 400, 1600] {
        let swarm = Swarm {
            iterations,
            seed: 3,
            ..Swarm::default()
        };
        let solver = Solver {
            kind: Kind::Swarm,
            swarm,
            ..Solver::default()
        };
        let found = sequence(&data.problem(), Order::Outward, &solver).unwrap();
        let y = particle(&found.steps[0].found);
        let worst = (0..10)
            .map(|k| ((y[k] - x[k]) / x[k]).abs())
            .fold(0.0, f64::max);
        println!("{iterations} iterations: {worst:.1e}");
        assert!(worst < before);
        before = worst;
    }
    assert!(before < 1.0e-9, "{before:e}");
}

#[test]
fn xval_mujoco_single_body_by_momentum_to_1e_7() {
    let nominal = model("xu2017/model.toml");
    let e = ask(&nominal, runs(&nominal, &["C1"]), "linear").estimate;
    let worst = worst_of_whole(&e, &total());
    println!("linear, momentum: {worst:.1e}");
    assert!(worst < 1.0e-7, "{worst:e}");
    assert_eq!(e.identifiability.determined.len(), 10);
    assert!(e.bodies.iter().all(|b| b.mass.value.is_none()));
}

/// Largest error of the 52 combinations in natural units of the leading terms.
fn worst_combination(e: &Estimate, found_truth: &[InertialParameters]) -> f64 {
    let value = |name: &str| {
        let (body, what) = name.split_once('.').unwrap();
        let b = e.bodies.iter().position(|x| x.name == body).unwrap();
        let names = [
            "m", "mc_x", "mc_y", "mc_z", "I_BBo_xx", "I_BBo_xy", "I_BBo_yy", "I_BBo_xz",
            "I_BBo_yz", "I_BBo_zz",
        ];
        let p = found_truth[b].mass_properties().unwrap();
        if let Some(element) = what.strip_prefix("I_BBcm_") {
            // The tensor of a body of known mass and mass centre.
            let at = (0..6).find(|&k| poinsot_identify::tensor_name(k) == element);
            let inertia = p.I_BBcm_B[poinsot_identify::TENSOR[at.unwrap()]];
            return (inertia, p.mass * p.radius_of_gyration().powi(2));
        }
        let k = names.iter().position(|n| *n == what).unwrap();
        let unit = [
            p.mass,
            p.mass * p.radius_of_gyration(),
            p.mass * p.radius_of_gyration().powi(2),
        ];
        (
            found_truth[b].to_array()[k],
            unit[usize::from(k > 0) + usize::from(k > 3)],
        )
    };
    let mut worst: f64 = 0.0;
    for c in &e.identifiability.determined {
        let sum: f64 = c.coefficients.iter().map(|(n, a)| a * value(n).0).sum();
        let unit = c
            .coefficients
            .iter()
            .map(|(n, a)| (a * value(n).1).abs())
            .fold(0.0, f64::max);
        worst = worst.max((c.value - sum).abs() / unit);
    }
    worst
}

#[test]
fn xval_mujoco_two_body_runs_in_both_orders_to_1e_7() {
    let nominal = model("xu2017/model.toml");
    for variant in ["linear", "linear-inward"] {
        let e = ask(&nominal, runs(&nominal, &ALL), variant).estimate;
        assert_eq!(e.status, Status::Partial);
        assert_eq!(
            (e.identifiability.rank, e.identifiability.parameters),
            (52, 70)
        );
        assert_eq!(e.identifiability.determined.len(), 52);
        let worst = worst_combination(&e, &truth());
        println!("{variant}: {worst:.1e}");
        assert!(worst < 1.0e-7, "{worst:e}");
        assert!(e.bodies.iter().all(|b| b.mass.value.is_none()));
        // Both orders and the ladder agree, so sigma is not widened.
        assert!(e.identifiability.determined.iter().all(|c| c.sigma > 0.0));
    }
}

/// The five uses of the Conclusion, noise-free.
#[test]
fn paper_uses_2_to_5() {
    let all = properties(&truth());
    let known = |unknown: &[usize]| robot().known_but(unknown);
    // 2: mass and mass centre known, attitude alone.
    let single = robot().one_body(true);
    let mut turning = runs(&single, &["C1"]);
    without_translation(&mut turning);
    let e = ask(&single, turning, "linear").estimate;
    let (worst, n) = errors(&e.bodies[0], &total());
    println!("use 2: {worst:.1e}");
    assert!(n == 10 && worst < 1.0e-7 && e.status == Status::Converged);
    // 3: base known.
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
    // 3: arm known; 4: target; both 5: no thrust, no acceleration.
    for (body, files) in [(0, &ARM[..]), (6, &ARM[5..])] {
        let m = known(&[body]);
        let e = ask(&m, runs(&m, files), "linear").estimate;
        let (worst, n) = errors(&e.bodies[body], &all[body]);
        println!("body {body}: {worst:.1e}");
        assert!(n == 10 && worst < 1.0e-7, "{body} {n} {worst:e}");
        assert_eq!(e.status, Status::Converged);
    }
}

/// The second use as printed, "mass and centroid position of any system body": with those of one body known, attitude
/// alone in the thrust segment and one joint after the other give all combinations, in both orders.
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
    // Every fifth sample: two of the 50 are then above the accuracy asked for.
    for (n, worst, mass) in found {
        assert!(n >= 46 && worst < 1.0e-5, "{n} {worst:e}");
        assert!(mass < 1.0e-6, "{mass:e}");
    }
}

/// (75): six of the nine elements of the tensor, the products, have bounds that are loose by two.
#[test]
fn paper_bounds_75_are_loose_by_two_in_the_products() {
    for row in largest_coefficients(RATE, 20_000) {
        for (k, most) in row.into_iter().enumerate() {
            // By Cauchy and Schwarz none exceeds the rate; all come near it.
            assert!((0.0290..=0.0300 + 1.0e-12).contains(&most), "{k}: {most}");
        }
    }
}

/// All joints at once: the target's numbers in better condition than with one joint.
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

/// Noise as in the simulated data: ten of ten, inside four of its own sigmas, and sigma is useful.
#[test]
fn stat_grasped_target_with_all_joints_moving() {
    let case = read_case(&examples().join("cases/xu2017_target_all_joints.toml")).unwrap();
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

/// 94 % of the squared scaled error of Tables 6 to 12 lies where no data can show it.
#[test]
fn paper_its_own_error_lies_in_the_open_directions() {
    let full = robot().data(&ALL).unwrap();
    let answer = linear(&full.problem()).unwrap();
    let true_bodies = truth();
    let null = Null::new(&answer, &properties(&true_bodies));
    assert_eq!(null.count(), 18);
    let (_, share) = null.share(&printed_bodies(), &true_bodies);
    println!("share {share:.3}");
    assert!((0.92..0.96).contains(&share), "{share}");
    let mass: f64 = IDENTIFIED.iter().map(|b| b[0]).sum();
    assert!((mass - 475.91).abs() < 0.01);
}

/// The mass that a swarm returns for the base follows its search range; what the data show does not.
#[test]
fn paper_masses_of_the_swarm_follow_its_range() {
    let example = robot().centred();
    let centred = bound(example.clone(), &thinned(runs(&example, &["C1", "C2"]), 8));
    let farthest = |share: f64| {
        let masses = (0..4).map(|seed| {
            let solver = Solver {
                kind: Kind::Swarm,
                swarm: Swarm {
                    seed,
                    iterations: 2000,
                    ..Swarm::default()
                },
                share,
            };
            let found = sequence(&centred.problem(), Order::Outward, &solver).unwrap();
            assert!(found.steps.iter().all(|s| s.arrived()), "{share} {seed}");
            found.bodies[0].mass
        });
        masses.map(|m: f64| (m - 400.0).abs()).fold(0.0, f64::max)
    };
    let (narrow, wide) = (farthest(0.02), farthest(0.2));
    println!("base mass up to {narrow:.2} kg and {wide:.2} kg off");
    assert!(wide > 3.0 * narrow && (1.0..=8.0).contains(&narrow));
}

/// Table 13: the linear answers have other masses and move as the true robot does (the paper: 3e-5 m, 6e-4 and
/// 8e-4 rad). Measured: 2.4e-15 m, 6e-13 rad.
#[test]
fn exact_the_52_are_enough_for_motion() {
    let case = read_case(&examples().join("cases/xu2017_table13.toml")).unwrap();
    let right = Mover::of_model(read_model(&case.model).unwrap());
    let full = robot().data(&ALL).unwrap();
    for order in [Order::Outward, Order::Inward] {
        let found = sequence(&full.problem(), order, &Solver::default()).unwrap();
        assert!((found.bodies[0].mass - 400.0).abs() > 0.5);
        let mut other = right.clone();
        other.bodies = found.bodies;
        for c in compare_motion(&case, &other, &right).unwrap() {
            assert!(c.largest < 1.0e-9, "{order:?} {}: {:e}", c.name, c.largest);
        }
        // The same with one seen number wrong by a per cent does not pass.
        other.bodies[6].mass *= 1.01;
        let off = compare_motion(&case, &other, &right).unwrap();
        assert!(off.iter().any(|c| c.largest > 1.0e-6));
    }
}

fn refusal(model: Model, tables: Vec<Table>, variant: &str) -> String {
    identify_tables(model, tables, &request("xu2017", Some(variant)))
        .map(|i| i.estimate.status)
        .unwrap_err()
        .to_string()
}

fn warned(found: &Identified, words: &str) -> String {
    let list = &found.estimate.warnings;
    list.iter()
        .find(|w| w.contains(words))
        .unwrap_or_else(|| panic!("no '{words}' in {list:?}"))
        .clone()
}

/// Whole messages.
#[test]
fn unit_refusals_say_what_to_do() {
    let m = model("xu2017/model.toml");
    let arm = || runs(&m, &["C2", "C3"]);
    assert_eq!(
        refusal(m.clone(), arm(), "linear"),
        "E0533 no thruster fires with the joints locked, and neither the base nor all that a moving joint carries is known: without the equivalent single body of (35) nothing sets the scale of the momentum equations; add a segment with thrust, take estimate out of the base or of the arm, or use --method auto for the combinations that remain"
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
            "E0538 segment '{label}': the vehicle moves at 0 rad/s and 0.05 m/s at the first sample: the objective (52) takes momentum as zero, so variant swarm must start at rest; use --variant linear, which takes the momentum as unknown"
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
fn unit_a_thruster_that_never_fires_is_named() {
    let m = model("xu2017/model.toml");
    let mut tables = runs(&m, &["C1"]);
    tables[0]
        .channels
        .retain(|c| c.name != "thr9_N" && c.name != "thr10_N");
    // Its firings are gone, so the samples after them contradict the rest: keep those before.
    for c in &mut tables[0].channels {
        let n = c.time_s.iter().filter(|t| **t < 45.0).count();
        c.time_s = c.time_s.iter().copied().take(n).collect();
        c.values.truncate(n);
    }
    let found = ask(&m, tables, "linear");
    assert_eq!(
        warned(&found, "never fires"),
        "thr6, thr9, thr10 never fires while the joints are locked: what only their thrust would show stays open"
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
    let case = read_case(&examples().join("cases/xu2017_c1.toml")).unwrap();
    let table = simulate_case(&case, &exact).unwrap().table;
    let found = ask(&single, vec![table], "linear");
    println!("{:?}", found.estimate.warnings);
    let message = warned(&found, "no torque");
    assert!(
        message.starts_with("the thrust makes no torque about the mass centre (largest lever "),
        "{message}"
    );
    assert!(message.ends_with("so nothing turns: the inertia tensor does not enter (30) and stays open; fire thrusters beside the mass centre"), "{message}");
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
        "joint3 does not move in any segment: B2 and B3 are one body to these data; drive it in a segment of its own"
    );
    let e = &found.estimate;
    assert_eq!(e.identifiability.determined.len(), 45);
    let worst = worst_combination(e, &truth());
    println!("{worst:.1e}");
    assert!(worst < 1.0e-6, "{worst:e}");
}

/// Nominal numbers so far off that the range around them excludes the answer.
#[test]
fn unit_a_search_range_that_excludes_the_answer_is_reported() {
    let mut single = robot().one_body(false);
    single.bodies[0].nominal = total();
    single.bodies[0].nominal.mass = 200.0;
    let tables = thinned(runs(&single, &["C1"]), 4);
    let found = ask(&single, tables.clone(), "swarm");
    let message = warned(&found, "bound of its search range");
    println!("{message}");
    assert!(message.starts_with("equivalent single body: the swarm's solution lies on the bound of its search range (mass = 300.000000 kg of [100.000000, 300.000000]"), "{message}");
    assert!(message.contains("the range excludes the answer and its numbers are withheld"));
    let e = &found.estimate;
    assert_eq!((e.status, found.exit_code()), (Status::IterationLimit, 1));
    assert!(e.bodies[0].mass.value.is_none() && e.identifiability.determined.is_empty());
    // The linear solution needs no range.
    let e = ask(&single, tables, "linear").estimate;
    assert!((e.bodies[0].mass.value.unwrap() / 476.0 - 1.0).abs() < 1.0e-6);
}

/// The swarm as a user calls it: its distance from the linear solution is inside its sigma, and the same call
/// gives the same bits.
#[test]
fn exact_swarm_answers_within_its_sigma() {
    let all = properties(&truth());
    let mut m = model("xu2017/model.toml");
    for (body, properties) in m.bodies.iter_mut().zip(&all).take(6) {
        body.nominal = *properties;
        body.estimate = EstimateSet::default();
    }
    let found = ask(&m, thinned(runs(&m, &["C7"]), 4), "swarm");
    let e = &found.estimate;
    println!("{:?} {:?}", e.status, e.warnings);
    let b = &e.bodies[6];
    let (worst, n) = errors(b, &all[6]);
    println!("{worst:.1e}");
    assert!(n == 10 && e.status == Status::Converged);
    let sigmas =
        |n: &poinsot_identify::Number, x: f64| ((n.value.unwrap() - x) / n.sigma.unwrap()).abs();
    assert!(sigmas(&b.mass, all[6].mass) < 1.0 + 1.0e-6);
    for k in 0..3 {
        assert!(sigmas(&b.com[k], all[6].p_BoBcm_B[k]) < 1.0 + 1.0e-6);
    }
    for (n, at) in b.inertia.iter().zip(poinsot_identify::TENSOR) {
        assert!(sigmas(n, all[6].I_BBcm_B[at]) < 1.0 + 1.0e-6);
    }
    assert_eq!(e.variant.as_deref(), Some("swarm"));
    let again = ask(&m, thinned(runs(&m, &["C7"]), 4), "swarm");
    assert_eq!(again.estimate, *e);
}
