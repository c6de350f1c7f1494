//! Motor torque in telemetry against wheel speed.

use crate::shared::stsat3;
use poinsot::case::parse_case;
use poinsot::simulate::simulate_trial;
use poinsot::{Identified, Question, identify_tables};
use poinsot_model::{Model, read_model};
use poinsot_telemetry::checks::Check;
use poinsot_telemetry::{ReadOptions, Table, read};

fn model() -> Model {
    read_model(stsat3().join("model.toml")).unwrap()
}

fn record(name: &str) -> Table {
    let file = stsat3().join(name);
    read(&[file], &ReadOptions::default()).unwrap()
}

fn answer(table: Table) -> Identified {
    identify_tables(model(), vec![table], &Question::default()).unwrap()
}

fn said(found: &Identified) -> Vec<&str> {
    let own = found.findings.iter();
    own.filter(|f| f.check == Check::MotorTorque)
        .map(|f| f.text.as_str())
        .collect()
}

fn scaled(mut table: Table, wanted: &str, factor: f64) -> Table {
    for channel in table
        .channels
        .iter_mut()
        .filter(|c| c.name.ends_with(wanted))
    {
        channel.values.iter_mut().for_each(|x| *x *= factor);
    }
    table
}

/// Halved speeds halve the inertia; only the torque reveals it.
#[test]
fn regress_speeds_that_the_torque_contradicts_are_doubted() {
    let found = answer(scaled(
        record("multiaxis/telemetry_noisy.csv"),
        "_rad_s",
        0.5,
    ));
    let texts = said(&found);
    assert_eq!(texts.len(), 3, "{texts:?}");
    assert!(
        texts[0].contains("wheel1 changes 0.50 +- 0.05 times"),
        "{texts:?}"
    );
    assert!(!found.estimate.passes());
    let turned = answer(scaled(
        record("multiaxis/telemetry_noisy.csv"),
        "wheel2_Nm",
        -1.0,
    ));
    let texts = said(&turned);
    assert!(
        texts.len() == 1 && texts[0].contains("wheel2 changes -1.0"),
        "{texts:?}"
    );
}

#[test]
fn regress_torque_that_agrees_says_nothing() {
    for name in [
        "multiaxis/telemetry_noisy.csv",
        "multiaxis/telemetry.parquet",
        "paper/telemetry_noisy.csv",
        "bias/telemetry_noisy.parquet",
    ] {
        let found = answer(record(name));
        assert!(said(&found).is_empty(), "{name}: {:?}", said(&found));
    }
    // Torques are known to 5 %, and a constant one may be friction.
    let mut table = scaled(record("multiaxis/telemetry_noisy.csv"), "_Nm", 1.1);
    for channel in table
        .channels
        .iter_mut()
        .filter(|c| c.name.ends_with("_Nm"))
    {
        channel.values.iter_mut().for_each(|x| *x += 2.0e-3);
    }
    assert!(said(&answer(table)).is_empty());
}

/// Wheels with friction under attitude control: the motor compensates it.
#[test]
fn exact_friction_is_no_contradiction() {
    let folder = stsat3().join("../cases");
    let text = std::fs::read_to_string(folder.join("stsat3_kim2010.toml")).unwrap();
    let wheel = |k: usize| {
        format!(
            "[[control.wheel]]\nwheel = \"wheel{k}\"\nviscous_N_m_s = 2.0e-6\ncoulomb_N_m = 5.0e-4\n"
        )
    };
    let wheels: String = (1..=3).map(wheel).collect();
    let by_torque = text.replace("drive = \"acceleration\"", "drive = \"torque\"");
    let with_friction = by_torque.replace("[output]", &format!("{wheels}\n[output]"));
    let case = parse_case(&folder.join("stsat3_kim2010.toml"), with_friction).unwrap();
    let truth = read_model(&case.model).unwrap();
    let table = simulate_trial(&case, &truth, 0).unwrap().table;
    let found = identify_tables(model(), vec![table], &Question::default()).unwrap();
    assert!(said(&found).is_empty(), "{:?}", said(&found));
}
