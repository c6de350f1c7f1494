//! Two vehicles under equal torques, and vehicles against telemetry.

use crate::shared::shipped;
use poinsot::case::{Case, parse_case, read_case};
use poinsot::simulate::simulate_trial;
use poinsot::validate::*;
use poinsot::{Identified, IdentifyRequest, identify, write_estimate};
use poinsot_model::{Model, read_model};
use std::path::Path;

fn xu(runs: std::ops::RangeInclusive<usize>) -> Identified {
    let run = |k| shipped().join(format!("xu2017/C{k}/telemetry.parquet"));
    let model = shipped().join("xu2017/model.toml");
    let mut request = IdentifyRequest::new(model, runs.map(run)).by("linear");
    // One combination of 52 is known to +-170 % by the declared noise, although the records are free of it.
    request.question.relative_accuracy = 2.0;
    identify(&request).unwrap()
}

fn table13(estimate: &Path) -> ValidateRequest {
    ValidateRequest {
        model: Some(shipped().join("xu2017/model.toml")),
        estimate: Some(estimate.to_owned()),
        against: shipped().join("cases/xu2017_truth.toml").into(),
        case: Some(shipped().join("cases/xu2017_table13.toml")),
        within_m: Some(1e-9),
        within_rad: Some(1e-9),
        ..ValidateRequest::default()
    }
}

fn load(name: &str) -> (Case, Model) {
    let case = read_case(&shipped().join("cases").join(name)).unwrap();
    let model = read_model(&case.model).unwrap();
    (case, model)
}

/// Xu et al. 2017, section 5.5: 3.31e-5 m, 5.56e-4 rad and 7.96e-4 rad after 2 s under the torques of Table 13.
/// Combinations determined by C1 to C7, with 18 of 70 numbers undetermined.
#[test]
fn paper_xu2017_base_parameters_move_like_the_truth() {
    let folder = tempfile::tempdir().unwrap();
    write_estimate(folder.path(), &xu(1..=7)).unwrap();
    let found = validate(&table13(folder.path())).unwrap();
    assert_eq!(found.file.verdict, "agrees");
    assert_eq!(found.histories.len(), 8);
    for one in &found.histories {
        println!(
            "{}: {:.1e} {}",
            one.file.quantity, one.file.largest, one.file.unit
        );
        // Measured: 2e-13.
        assert!(
            one.file.largest < 1e-11,
            "{}: {:e}",
            one.file.quantity,
            one.file.largest
        );
    }
    let completed = found.file.completed.as_ref().unwrap();
    assert_eq!((completed.determined, completed.open), (52, 18));
    assert!(completed.distance_natural > 0.05);
    assert!(completed.depends_on.is_empty());
    // The joints really move, and the nominal vehicle deviates about as much as the paper's.
    let joint = |v: &Validation, name: &str| {
        v.histories
            .iter()
            .find(|c| c.file.quantity == name)
            .unwrap()
            .clone()
    };
    let reach = joint(&found, "joint joint1").model[0]
        .iter()
        .fold(0.0_f64, |a, x| a.max(x.abs()));
    assert!(reach > 0.03, "{reach}");
    let nominal = ValidateRequest {
        estimate: None,
        ..table13(folder.path())
    };
    let nominal = validate(&nominal).unwrap();
    assert_eq!(
        (nominal.file.verdict.as_str(), nominal.file.passes()),
        ("differs", false)
    );
    assert!(joint(&nominal, "joint joint1").file.largest > 1e-4);
}

/// From the estimate in memory, and from an estimate without C1, whose scale is undetermined: the motion is not
/// determined.
#[test]
fn exact_without_thrust_the_motion_under_torques_is_not_determined() {
    let folder = tempfile::tempdir().unwrap();
    let identified = xu(2..=7);
    write_estimate(folder.path(), &identified).unwrap();
    let found = validate(&table13(folder.path())).unwrap();
    assert_eq!(
        (found.file.verdict.as_str(), found.file.passes()),
        ("undetermined", false)
    );
    let completed = found.file.completed.as_ref().unwrap();
    assert_eq!((completed.determined, completed.open), (51, 19));
    assert!(!completed.depends_on.is_empty() && completed.prediction_changes[2].largest > 1e-4);
    let words = poinsot_report::validation_document(&found.file).to_string();
    assert!(
        words.contains("the motion depends on undetermined numbers"),
        "{words}"
    );
    // A given total mass sets the scale.
    let file = poinsot::estimate_file(&identified);
    let memory = of_estimate(&file, &identified.model, folder.path()).unwrap();
    assert_eq!(memory.completion.unwrap().open.len(), 19);
}

/// A held-back record: the estimate from the six slews predicts the paper's slew, the nominal numbers do not.
#[test]
fn stat_held_back_telemetry_agrees_with_a_good_estimate_only() {
    let folder = tempfile::tempdir().unwrap();
    let request = IdentifyRequest::new(
        shipped().join("stsat3/model.toml"),
        [shipped().join("stsat3/multiaxis/telemetry_noisy.csv")],
    );
    write_estimate(folder.path(), &identify(&request).unwrap()).unwrap();
    let held_back = ValidateRequest {
        model: Some(shipped().join("stsat3/model.toml")),
        estimate: Some(folder.path().to_owned()),
        against: shipped().join("stsat3/paper/telemetry_noisy.csv").into(),
        ..ValidateRequest::default()
    };
    let good = validate(&held_back).unwrap();
    assert_eq!(
        (good.file.verdict.as_str(), good.file.passes()),
        ("agrees", true)
    );
    assert!(
        (good.file.chi2_per_dof.unwrap() - 1.0).abs() < 0.05,
        "{:?}",
        good.file.chi2_per_dof
    );
    assert!(good.file.completed.is_none());
    let names: Vec<&str> = good
        .histories
        .iter()
        .map(|c| c.file.quantity.as_str())
        .collect();
    assert_eq!(names, ["gyro", "attitude"]);
    for one in &good.histories {
        let sigmas = one.file.sigmas.unwrap();
        assert!(
            (sigmas.rms - 1.0).abs() < 0.05,
            "{}: {}",
            one.file.quantity,
            sigmas.rms
        );
        assert!(
            (3.0..5.5).contains(&sigmas.largest),
            "{}: {}",
            one.file.quantity,
            sigmas.largest
        );
        assert!(sigmas.whiteness_p.unwrap() > 1e-3, "{}", one.file.quantity);
    }
    let nominal = validate(&ValidateRequest {
        estimate: None,
        ..held_back
    })
    .unwrap();
    assert_eq!(
        (nominal.file.verdict.as_str(), nominal.file.passes()),
        ("differs", false)
    );
    assert!(nominal.file.chi2_per_dof.unwrap() > 100.0);
}

/// The true vehicle under the torques of the case agrees with its noisy measurements; a rigid one does not.
#[test]
fn stat_a_case_against_its_telemetry() {
    let (mut case, model) = load("slosh.toml");
    // Twice the sample rate of the example, for an accurate mean square.
    case.rate_hz = 10.0;
    for trial in 0..3 {
        let table = simulate_trial(&case, &model, trial).unwrap().table;
        let found = compare_with_telemetry(&case, &Mover::of_model(model.clone()), &table).unwrap();
        assert_eq!(found.len(), 2);
        for one in found {
            let sigmas = one.file.sigmas.unwrap();
            // 6000 numbers: one sigma of the mean square is 0.018.
            assert!(
                (sigmas.rms * sigmas.rms - 1.0).abs() < 0.08,
                "{}: {}",
                one.file.quantity,
                sigmas.rms
            );
            assert!(sigmas.largest < 5.5);
        }
        let rigid = read_model(shipped().join("cases/rigid_bus.toml")).unwrap();
        let found = compare_with_telemetry(&case, &Mover::of_model(rigid), &table).unwrap();
        assert!(found.iter().all(|c| c.file.sigmas.unwrap().rms > 10.0));
    }
}

/// A heavier hand: every quantity deviates from the common start, and the file has both sides.
#[test]
fn exact_histories_and_their_file() {
    let (case, model) = load("xu2017_table13.toml");
    let truth = Mover::of_model(model.clone());
    let mut other = truth.clone();
    other.bodies[6].mass *= 1.1;
    let compared = compare_motion(&case, &other, &truth).unwrap();
    let same = compare_motion(&case, &truth, &truth).unwrap();
    assert!(same.iter().all(|c| c.file.largest < 1e-15));
    for c in &compared {
        assert_eq!(c.time_s.len(), 201);
        assert!(
            c.difference.iter().all(|row| row[0].abs() < 1e-15),
            "{}",
            c.file.quantity
        );
        assert!(
            c.file.largest > 1e-9 && c.file.rms < c.file.largest,
            "{}: {:e}",
            c.file.quantity,
            c.file.largest
        );
    }
    // A rotation vector computed independently from the two quaternions, to first order.
    let attitude = &compared[1];
    let (a, b) = (&attitude.model, &attitude.against);
    for k in 0..201 {
        let x =
            2.0 * (b[3][k] * a[0][k] - b[0][k] * a[3][k] - b[1][k] * a[2][k] + b[2][k] * a[1][k]);
        assert!((x - attitude.difference[0][k]).abs() < 1e-12);
    }
    let request = ValidateRequest {
        case: Some(case.path().to_owned()),
        against: case.model.clone().into(),
        ..ValidateRequest::default()
    };
    let validation = Validation {
        histories: compared,
        ..validate(&request).unwrap()
    };
    assert_eq!(validation.file.compared[7].largest, 0.0);
    let csv = validation_csv(&validation);
    let lines: Vec<&str> = csv.lines().collect();
    assert_eq!(
        lines[0],
        "quantity,component,unit,time_s,model,against,difference"
    );
    // Three of position, four of quaternions and three of rotation, six of joints.
    assert_eq!(lines.len(), 1 + 16 * 201);
    let last = lines
        .iter()
        .rfind(|l| l.starts_with("joint joint6,joint6_rad,rad,2,"))
        .unwrap();
    let numbers: Vec<f64> = last
        .split(',')
        .skip(4)
        .map(|x| x.parse().unwrap())
        .collect();
    assert_eq!(numbers[0] - numbers[1], numbers[2]);
}

#[test]
fn unit_refusals() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let write = |name: &str, text: &str| std::fs::write(at(name), text).unwrap();
    let case = shipped().join("cases/xu2017_table13.toml");
    let own = shipped()
        .join("cases/xu2017_truth.toml")
        .display()
        .to_string();
    let base = ValidateRequest {
        against: own.clone().into(),
        case: Some(case.clone()),
        ..ValidateRequest::default()
    };
    let refused = |request: &ValidateRequest| {
        let error = validate(request).err().unwrap();
        assert_eq!(error.kind(), poinsot::ErrorKind::Input, "{error}");
        let text = error
            .to_string()
            .replace(&format!("{}/", folder.path().display()), "");
        text.replace(&format!("{}/", shipped().display()), "")
    };
    let with = |estimate: &str| ValidateRequest {
        estimate: Some(at(estimate)),
        ..base.clone()
    };
    assert_eq!(
        refused(&with("none.json")),
        "E0701 none.json: this estimate cannot be simulated: there is no such file; give the folder of identify --out"
    );
    write("no.json", "{}");
    let text = refused(&with("no.json"));
    assert!(
        text.starts_with(
            "E0701 no.json: this estimate cannot be simulated: it has no key \"schema\""
        ),
        "{text}"
    );
    // An estimate of another model.
    let identified = xu(2..=2);
    write_estimate(folder.path(), &identified).unwrap();
    let slosh = ValidateRequest {
        estimate: Some(folder.path().to_owned()),
        case: Some(shipped().join("cases/slosh.toml")),
        ..base.clone()
    };
    assert_eq!(
        refused(&slosh),
        "E0701 estimate.json: this estimate cannot be simulated: it has 7 bodies, the model 2; give the model that the estimate was made with (--model)"
    );
    assert_eq!(
        refused(&with("estimate.json")),
        "E0701 estimate.json: this estimate cannot be simulated: its nominal numbers of body \"base\" are not those of the model; give the model that the estimate was made with (--model)"
    );
    let mut rejected = poinsot::estimate_file(&identified);
    rejected.status = "rejected".to_owned();
    rejected.evidence.clear();
    let text = poinsot_formats::result_text(&rejected, true).unwrap();
    write("rejected.json", &text);
    assert_eq!(
        refused(&with("rejected.json")),
        "E0701 rejected.json: this estimate cannot be simulated: its status is rejected: it has no numbers to predict with; give an estimate with status converged or partial"
    );
    // Usage errors.
    assert_eq!(
        refused(&ValidateRequest {
            case: None,
            model: Some(own.clone().into()),
            ..base.clone()
        }),
        "E0001 CASE: no case is given; give one with the torques of both vehicles"
    );
    assert_eq!(
        refused(&ValidateRequest {
            case: None,
            ..base.clone()
        }),
        "E0001 --model: no model is named; give --model, or a case that names one"
    );
    assert_eq!(
        refused(&ValidateRequest {
            within_m: Some(f64::NAN),
            ..base.clone()
        }),
        "E0001 --within-m 'NaN': it is negative or not a number; give a number of at least zero"
    );
    let control = shipped().join("cases/stsat3_three_slews.toml");
    let truth = shipped()
        .join("cases/stsat3_truth.toml")
        .display()
        .to_string();
    assert_eq!(
        refused(&ValidateRequest {
            case: Some(control),
            against: truth.into(),
            ..base.clone()
        }),
        "E0702 cases/stsat3_three_slews.toml: [control] would command different torques on the two vehicles; prescribe wheel torques with [[wheel_motion]]"
    );
    write(
        "late.csv",
        "time_s,q_x,q_y,q_z,q_w\n100,0,0,0,1\n101,0,0,0,1\n102,0,0,0,1\n",
    );
    assert_eq!(
        refused(&ValidateRequest {
            against: at("late.csv").into(),
            ..base.clone()
        }),
        "E0703 cases/xu2017_table13.toml: the telemetry has no attitude, rate, position, velocity, acceleration or joint sample during the case; give telemetry with times from the start of the case"
    );
}

/// Prescribed joints with other mass properties: the base moves differently, the joints agree exactly.
#[test]
fn exact_led_joints_agree_whatever_the_vehicle() {
    let (_, model) = load("xu2017_table13.toml");
    let text = "schema = \"poinsot.case/1\"\nmodel = \"xu2017_truth.toml\"\nduration_s = 2.0\n\
        [[joint_motion]]\njoint = \"joint2\"\ninterpolation = \"quintic_rest\"\ntime_s = [0.0, 2.0]\n\
        position_rad = [0.0, 1.0]\n[output]\nrate_hz = 20\n";
    let case = parse_case(&shipped().join("cases/x.toml"), text.to_owned()).unwrap();
    let truth = Mover::of_model(model);
    let mut other = truth.clone();
    other.bodies[3].mass *= 1.2;
    let compared = compare_motion(&case, &other, &truth).unwrap();
    assert!(compared[0].file.largest > 1e-4 && compared[1].file.largest > 1e-4);
    assert!(compared[2..].iter().all(|c| c.file.largest == 0.0));
}
