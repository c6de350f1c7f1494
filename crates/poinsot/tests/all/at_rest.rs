//! A vehicle at rest whose tachometers are noisy: what moves in its telemetry is noise alone.

use poinsot::case::{Case, parse_case};
use poinsot::simulate::simulate_trial;
use poinsot::{Identified, identify_tables};
use poinsot_identify::Status;
use poinsot_model::{Model, parse_model};
use std::path::Path;

use crate::vehicle::request;

/// Three wheels, two gyros and a star tracker; `tacho` goes to the tachometers.
fn model(tacho: &str) -> Model {
    parse_model(&text(tacho), "scout.toml").unwrap()
}

fn text(tacho: &str) -> String {
    let mut text = r#"
schema = "poinsot.model/1"
name = "scout"
exact = true
[[body]]
name = "bus"
mass_kg = 83.0
com_m = [0.01, -0.02, 0.03]
inertia_kg_m2 = { xx = 7.4, yy = 7.0, zz = 10.2, xy = 0.0, xz = 0.0, yz = 0.0 }
estimate = ["inertia"]
"#
    .to_owned();
    for (name, axis) in [
        ("ra", "[0.8, 0.0, 0.6]"),
        ("rb", "[-0.4, 0.69282032, 0.6]"),
        ("rc", "[-0.4, -0.69282032, 0.6]"),
    ] {
        text += &format!(
            "[[wheel]]\nname = \"{name}\"\nbody = \"bus\"\naxis = {axis}\nspin_inertia_kg_m2 = 0.004\n"
        );
    }
    for (name, kind, noise) in [
        ("coarse", "gyro", "noise_rad_s = 2.0e-4"),
        ("fine", "gyro", "noise_rad_s = 1.0e-5"),
        ("tracker", "attitude", "noise_rad = 5.0e-5"),
        ("tacho", "wheel_speed", "noise_rad_s = 0.05"),
    ] {
        text += &format!("[[sensor]]\nname = \"{name}\"\ntype = \"{kind}\"\n{noise}\n");
    }
    format!("{text}{tacho}")
}

fn case() -> Case {
    let mut text = "schema = \"poinsot.case/1\"\nmodel = \"scout.toml\"\nduration_s = 120.0\n\
        [initial]\nomega_rad_s = [0.0, 0.0, 0.0]\n"
        .to_owned();
    for (wheel, speed) in [("ra", 310.0), ("rb", 60.0), ("rc", -40.0)] {
        text += &format!(
            "[[wheel_motion]]\nwheel = \"{wheel}\"\ntime_s = [0.0]\nspeed_rad_s = [{speed:.1}]\n"
        );
    }
    text += "[output]\nrate_hz = 6.0\nsensors_only = true\nseed = 5\n\
        [[output.sensor]]\nname = \"tracker\"\nrate_hz = 1.0\n\
        [[output.sensor]]\nname = \"tacho\"\nrate_hz = 1.5\n";
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/cases");
    parse_case(&folder.join("scout.toml"), text).unwrap()
}

fn answer(model: &Model, trial: u64) -> Identified {
    let table = simulate_trial(&case(), model, trial).unwrap().table;
    identify_tables(model.clone(), vec![table], &request("auto")).unwrap()
}

/// The predicted rates are noise of the tachometers, which the residual shares: no scale error is named for it.
#[test]
fn stat_noise_of_tachometers_is_no_scale_error() {
    let model = model("");
    for trial in 0..8 {
        let found = answer(&model, trial).estimate.diagnostics.unwrap();
        let names: Vec<&str> = found.suspects.iter().map(|s| s.name.as_str()).collect();
        for s in &found.suspects {
            println!("{trial}: {} lowers {}: {:?}", s.name, s.decrease, s.values);
        }
        assert!(names.is_empty(), "{trial}: {names:?}");
    }
}

/// Bias and momentum are one unknown too many: the fit ends, and says what is not determined.
#[test]
fn regress_unknown_biases_of_tachometers_at_rest_converge() {
    let model = model("bias = \"estimate\"\n");
    for trial in 0..4 {
        let estimate = answer(&model, trial).estimate;
        println!(
            "{trial}: {:?} after {}",
            estimate.status, estimate.iterations
        );
        assert_ne!(estimate.status, Status::IterationLimit, "{trial}");
        assert!(estimate.iterations < 20, "{trial}: {}", estimate.iterations);
    }
}

/// A gyro with a bias, which is found, reads a turn about one axis: the vehicle is at rest all the same.
#[test]
fn regress_a_bias_of_the_gyro_is_no_turn_of_the_base() {
    let fine = "noise_rad_s = 1.0e-5\n";
    let biased = text("").replace(fine, &format!("{fine}bias = \"estimate\"\n"));
    let biased = parse_model(&biased, "scout.toml").unwrap();
    let mut table = simulate_trial(&case(), &model(""), 3).unwrap().table;
    let fine = table
        .channels
        .iter_mut()
        .filter(|c| c.name.starts_with("fine."));
    fine.flat_map(|c| &mut c.values).for_each(|w| *w += 3.0e-4);
    let found = identify_tables(biased, vec![table], &request("auto")).unwrap();
    let open = found.estimate.identifiability.open;
    assert!(!open.is_empty());
    for direction in &open {
        let at_rest = direction.reason.contains("hardly rotated");
        assert!(at_rest, "{}", direction.reason);
    }
}

/// Noise of the wheels looks like the response of a small inertia; nothing is determined.
#[test]
fn stat_noise_at_rest_determines_nothing() {
    let model = model("");
    let trials = 8;
    let open = (0..trials).filter(|trial| {
        let estimate = answer(&model, 100 + trial).estimate;
        for c in &estimate.identifiability.determined {
            println!("{trial}: {} = {} +- {}", c.text, c.value, c.sigma);
        }
        println!("{trial}: {:?} {:?}", estimate.status, estimate.doubts());
        estimate.status == Status::NotIdentifiable
    });
    let open = open.count();
    assert!(open >= 7, "{open} of {trials}");
}
