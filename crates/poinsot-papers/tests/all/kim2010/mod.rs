//! The spacecraft of Kim, Choi and Oh with one and with three slews, from their case files.

mod estimators;
mod wheels;

use poinsot::case::{parse_case, read_case};
use poinsot::simulate::simulate_case;
use poinsot::{Question, identify_tables};
use poinsot_identify::{Estimate, Status};
use poinsot_model::read_model;
use poinsot_papers::kim2010::studies::inversion::{self, invert};
use poinsot_papers::kim2010::studies::records as printed;
use poinsot_papers::kim2010::symmetric;
use poinsot_spatial::UnitQuaternion;
use poinsot_telemetry::Table;
use std::path::{Path, PathBuf};

/// xx, xy, yy, xz, yz, zz, as in an answer.
const TRUE: [f64; 6] = [13.916, 0.085, 16.954, 0.133, 0.5896, 19.894];

fn shipped() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data")
}

/// Gyro, attitude and wheel speeds, with the model's sensors or exact.
pub(crate) fn fly(name: &str, noisy: bool) -> Table {
    let path = shipped().join("cases").join(name);
    let mut text = std::fs::read_to_string(&path).unwrap();
    let mut model = read_model(read_case(&path).unwrap().model).unwrap();
    if !noisy {
        model.sensors.clear();
        text = text.replace("sensors_only = true", "sensors_only = false");
    }
    let case = parse_case(&path, text).unwrap();
    let mut table = simulate_case(&case, &model).unwrap().table;
    table.channels.retain(|c| {
        let kept = ["q_", "omega_", "wheel"];
        kept.iter().any(|k| c.name.starts_with(k))
    });
    table
}

pub(crate) fn identify(table: Table, method: &str, variant: Option<&str>) -> Estimate {
    let model = read_model(shipped().join("stsat3/model.toml")).unwrap();
    let request = Question {
        variant: variant.map(str::to_owned),
        ..Question::by(method)
    };
    identify_tables(model, vec![table], &request)
        .unwrap()
        .estimate
}

#[test]
fn paper_one_slew_shows_three_of_six() {
    let estimate = identify(fly("stsat3_kim2010.toml", false), "linear", None);
    assert_eq!(estimate.identifiability.rank, 3);
    assert_eq!(estimate.status, Status::Partial);
    let estimate = identify(fly("stsat3_kim2010.toml", true), "kim2010", None);
    assert_eq!(estimate.identifiability.rank, 3);
    assert!(estimate.bodies[0].inertia.iter().all(|n| n.value.is_none()));
    assert_eq!(estimate.method_report.unwrap().numbers.len(), 6);
}

#[test]
fn exact_three_slews_show_every_entry() {
    let estimate = identify(fly("stsat3_three_slews.toml", false), "linear", None);
    assert_eq!(estimate.status, Status::Converged);
    for (found, wanted) in estimate.bodies[0].inertia.iter().zip(TRUE) {
        let error = (found.value.unwrap() - wanted).abs() / wanted;
        assert!(error < 1e-10, "{wanted}: {error:e}");
    }
}

/// From the noisy sensors: moments to 0.002 %, products to 0.002 % of a moment, each within its sigma.
#[test]
fn stat_three_slews_from_noisy_sensors() {
    let estimate = identify(
        fly("stsat3_three_slews.toml", true),
        "maximum_likelihood",
        None,
    );
    assert_eq!(estimate.status, Status::Converged);
    for (found, wanted) in estimate.bodies[0].inertia.iter().zip(TRUE) {
        let (value, sigma) = (found.value.unwrap(), found.sigma.unwrap());
        assert!(
            (value - wanted).abs() < 4.0 * sigma,
            "{wanted}: {value} {sigma}"
        );
        // Rounded tachometers drive the prediction, so they contribute to sigma.
        assert!(sigma < 1.3e-4, "{wanted}: {sigma}");
    }
}

/// On one axis 15 printed numbers fix the sums, which give "considering pre-estimate" to the last printed digit. Every
/// product uses the other product of its row from (15), all at once.
#[test]
fn paper_pre_estimate_follows_from_the_other_columns() {
    let ten = 10.0_f64.to_radians();
    let n = UnitQuaternion::from_euler_angles(ten, ten, ten)
        .axis()
        .unwrap();
    let I = symmetric(&[13.916, 16.954, 19.894, 0.085, 0.5896, 0.133]);
    let fixed = invert(&n, &(I * n.into_inner()), &printed::PRINTED).unwrap();
    assert!(fixed.worst < 1.0, "{} of half a digit", fixed.worst);
    let found = fixed.sums.pre_estimate().unwrap().printed;
    println!("{found:.5?}");
    for k in 3..6 {
        let gap = (found[k] - printed::PRINTED[2][k]).abs();
        assert!(gap < inversion::HALF_DIGIT, "{k}: {found:?}");
    }
}
