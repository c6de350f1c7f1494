//! A satellite whose gyro is noisier than declared, and one at rest, from the model to what is printed.

use assert_cmd::Command;
use serde_json::Value;
use tempfile::TempDir;

const TRUE_INERTIA: &str = "xx = 9.0, yy = 12.5, zz = 7.5, xy = 0.5, xz = -0.3, yz = 0.2";
/// 25 to 40 % off.
const FAR_INERTIA: &str = "xx = 12.0, yy = 9.0, zz = 10.0, xy = 0, xz = 0, yz = 0";
const AXES: [&str; 3] = ["x", "y", "z"];

/// Three wheels, a star tracker, tachometers and a gyro with this noise in rad/s.
fn model(inertia: &str, gyro: &str) -> String {
    let wheels = AXES.map(|name| {
        let axis = AXES.map(|other| f64::from(u8::from(other == name)));
        format!(
            "[[wheel]]\nname = \"{name}\"\nbody = \"bus\"\naxis = {axis:?}\nspin_inertia_kg_m2 = 0.004\n"
        )
    });
    format!(
        "schema = \"poinsot.model/1\"\nname = \"probe\"\nexact = true\n[[body]]\nname = \"bus\"\nmass_kg = 85\n\
         com_m = [0.03, -0.02, 0.01]\ninertia_kg_m2 = {{ {inertia} }}\nestimate = [\"inertia\"]\n{}\
         [[sensor]]\nname = \"gyro\"\ntype = \"gyro\"\nbias = \"estimate\"\nnoise_rad_s = {gyro}\n\
         [[sensor]]\nname = \"tracker\"\ntype = \"attitude\"\nnoise_rad = 1e-4\n\
         [[sensor]]\nname = \"tachometers\"\ntype = \"wheel_speed\"\nnoise_rad_s = 0.1\n",
        wheels.concat()
    )
}

/// A record of 60 s at 20 Hz, with slewing wheels or at rest, in a folder of its own beside a model.
struct Record(TempDir);

impl Record {
    fn new(actual: &str, slews: bool, seed: u64) -> Self {
        let record = Self(tempfile::tempdir().unwrap());
        let motion = [
            ("x", "[0, 30, 80, 173]", "[0, 150, -120, 40]"),
            ("y", "[0, 50, 100, 173]", "[0, -140, 90, 10]"),
            ("z", "[0, 40, 120, 173]", "[0, 100, -150, -20]"),
        ];
        let motion = motion.map(|(wheel, time, speed)| {
            let speed = if slews { speed } else { "[0, 0, 0, 0]" };
            format!(
                "[[wheel_motion]]\nwheel = \"{wheel}\"\ntime_s = {time}\nspeed_rad_s = {speed}\ninterpolation = \"cubic_clamped\"\n"
            )
        });
        let case = format!(
            "schema = \"poinsot.case/1\"\nmodel = \"truth.toml\"\nduration_s = 60\n[initial]\nmomentum_zero = true\n{}\
             [output]\nrate_hz = 20\nseed = {seed}\n",
            motion.concat()
        );
        record.write("truth.toml", &model(TRUE_INERTIA, actual));
        record.write("case.toml", &case);
        let (status, _) = record.run(&["simulate", "case.toml", "--out", "record"]);
        assert_eq!(status, Some(0));
        record
    }

    fn write(&self, name: &str, text: &str) {
        std::fs::write(self.0.path().join(name), text).unwrap();
    }

    fn run(&self, words: &[&str]) -> (Option<i32>, String) {
        let mut command = Command::cargo_bin("poinsot").unwrap();
        let done = command.current_dir(&self.0).args(words).output().unwrap();
        let said = String::from_utf8(done.stdout).unwrap();
        (done.status.code(), said)
    }

    /// Exit code and result with a model whose inertia is far and whose gyro is declared so.
    fn identified(&self, gyro: &str) -> (Option<i32>, Value) {
        self.write("model.toml", &model(FAR_INERTIA, gyro));
        let words = ["identify", "model.toml", "record/telemetry.csv", "--json"];
        let (status, said) = self.run(&words);
        (status, serde_json::from_str(&said).unwrap())
    }
}

/// None of these records was followed to its end, and the advice was about their length. The factor takes the noise of the
/// tachometers out of the residual; the declaration that it gives leads to an answer.
#[test]
fn regress_a_gyro_noisier_than_declared_is_named_with_its_factor() {
    for (declared, seed) in [("1e-4", 5), ("1e-4", 7), ("1e-4", 8), ("1e-5", 3)] {
        let record = Record::new("1e-3", true, seed);
        let (status, found) = record.identified(declared);
        assert_eq!(status, Some(1));
        let first = &found["diagnostics"]["suspects"][0]["values"][0];
        assert_eq!(first["name"], "gyro.noise_factor", "{seed}: {first}");
        let named = first["value"].as_f64().unwrap() * declared.parse::<f64>().unwrap();
        assert!((named / 1.0e-3 - 1.0).abs() < 0.05, "{seed}: {named}");
        let (status, found) = record.identified(&format!("{named:e}"));
        assert_eq!((status, &found["status"]), (Some(0), &"converged".into()));
    }
}

/// At rest no number of the inertia is known, but the bias is what the gyro reads.
#[test]
fn regress_the_bias_of_a_gyro_at_rest_is_known_without_the_inertia() {
    let record = Record::new("1e-4", false, 1);
    let (status, found) = record.identified("1e-4");
    assert_eq!(
        (status, &found["status"]),
        (Some(1), &"not_identifiable".into())
    );
    let biases = found["nuisance"].as_object().unwrap();
    assert_eq!(biases.len(), 3);
    for bias in biases.values() {
        let [value, sigma] = ["value", "sigma"].map(|key| bias[key].as_f64().unwrap());
        assert!(sigma < 1.0e-5 && value.abs() < 4.5 * sigma, "{bias}");
    }
}
