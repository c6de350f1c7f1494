//! Files of version 1 are read as the current version.
#![allow(clippy::unwrap_used)]

use poinsot_formats::{parse_estimate, read_truth};
use std::path::Path;

/// An answer in version 1: two wheels on one body, known mass, one undetermined bias.
const ESTIMATE_1: &str = r#"{
  "schema": "poinsot.estimate/1", "poinsot": "0.1.0", "method": "maximum_likelihood", "variant": null,
  "status": "partial", "iterations": 4, "model": "sat",
  "inputs": [{ "path": "t.csv", "sha256": "ab", "segment": 0, "time_s": [0.0, 9.0], "rows": 10 }],
  "bodies": { "bus": {
    "mass_kg": { "value": 150.0, "sigma": 0.0, "nominal": 150.0, "source": "known" },
    "com_m": { "value": [0.1, 0.2, null], "sigma": [0.0, 0.0, null], "nominal": [1.0, 2.0, 3.0], "source": ["known", "data", null] },
    "inertia_kg_m2": {
      "value": { "xx": 13.0, "yy": 16.0, "zz": 19.0, "xy": 0.1, "xz": 0.2, "yz": 0.3 },
      "sigma": { "xx": 1.0, "yy": 2.0, "zz": 3.0, "xy": 4.0, "xz": 5.0, "yz": 6.0 },
      "nominal": { "xx": 15.0, "yy": 15.0, "zz": 20.0, "xy": 0.0, "xz": 0.0, "yz": 0.0 },
      "source": { "xx": "data", "yy": "data", "zz": "data", "xy": "data", "xz": "data", "yz": "data" } },
    "principal": null,
    "barycentric": {
      "m_kg": { "value": 150.0, "sigma": 0.0, "nominal": 150.0, "source": "known" },
      "mc_kg_m": { "value": [15.0, 30.0, null], "sigma": [0.0, 0.0, null], "nominal": [1.0, 2.0, 3.0], "source": ["known", "data", null] },
      "I_BBo_kg_m2": {
        "value": { "xx": null, "yy": null, "zz": null, "xy": null, "xz": null, "yz": null },
        "sigma": { "xx": null, "yy": null, "zz": null, "xy": null, "xz": null, "yz": null },
        "nominal": { "xx": 1.0, "yy": 2.0, "zz": 3.0, "xy": 4.0, "xz": 5.0, "yz": 6.0 },
        "source": { "xx": null, "yy": null, "zz": null, "xy": null, "xz": null, "yz": null } } },
    "physically_consistent": null } },
  "covariance": { "names": ["bus.inertia_xx", "gyro.bias_x"], "units": ["kg m2", "rad/s"], "matrix": [[1.0, 0.0], [0.0, 2.0]] },
  "system": [],
  "momentum": [{
    "linear_N_s": { "value": [null, null, null], "sigma": [null, null, null], "nominal": [0.0, 0.0, 0.0], "source": [null, null, null] },
    "angular_N_m_s": { "value": [1.0, 2.0, 3.0], "sigma": [0.1, 0.2, 0.3], "nominal": [0.0, 0.0, 0.0], "source": ["data", "data", "data"] } }],
  "nuisance": {
    "gyro.bias_x_rad_s": { "value": 1e-5, "sigma": 1e-6, "nominal": 0.0, "source": "data" },
    "gyro.scale_y": { "value": null, "sigma": null, "nominal": 0.0, "source": null },
    "tracker.lag_s": { "value": 0.1, "sigma": 0.01, "nominal": 0.0, "source": "data" },
    "wheel1.spin_inertia_kg_m2": { "value": 0.1, "sigma": 0.01, "nominal": 0.1, "source": "data" } },
  "identifiability": { "parameters": 6, "rank": 6, "structural_rank": 6, "sigmas_natural": [0.1, null],
    "identifiable": [{ "combination": "bus.I_xx", "coefficients": { "bus.I_BBcm_xx": 1.0 }, "unit": "kg m2", "value": 13.0, "sigma": 1.0 }],
    "not_identifiable": [{ "combination": "bus.mc_z", "coefficients": { "bus.mc_z": 1.0 }, "reason": "r", "remedy": "s" }] },
  "fit": [{ "segment": "t.csv", "samples": 10, "chi2_per_dof": 1.0, "channels": { "gyro": { "rms": 1e-4, "unit": "rad/s", "chi2_per_number": null, "whiteness_p": null } } }],
  "diagnostics": null,
  "known_numbers": { "exact": false, "source_assumed": true, "sigma_data": { "gyro.bias_x": 1e-6 },
    "sensitivities": [{ "number": "wheel1.axis_1", "unit": "rad", "value": 0.0, "sigma": 1e-3, "estimate": null, "estimate_sigma": null,
      "step": "1 mrad", "change": { "bus.inertia_xx": 0.1 }, "variance_share": { "gyro.bias_x": 0.5 } }] },
  "covariance_trustworthy": true, "doubts": [], "method_report": null, "repairs": [], "warnings": []
}"#;

#[test]
fn exact_an_estimate_of_version_1_keeps_every_number_under_its_address() {
    let file = parse_estimate(Path::new("estimate.json"), ESTIMATE_1.as_bytes()).unwrap();
    let bus = &file.bodies["bus"];
    let (y, z) = (&bus.com_m.y, &bus.com_m.z);
    assert_eq!((y.value, y.source.as_deref()), (Some(0.2), Some("data")));
    assert_eq!((z.value, z.nominal, &z.source), (None, 3.0, &None));
    let sigmas = bus.inertia_kg_m2.named().map(|(_, n)| n.sigma.unwrap());
    assert_eq!(sigmas, [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
    let nominal = bus.barycentric.I_BBo_kg_m2.named().map(|(_, n)| n.nominal);
    assert_eq!(nominal, [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
    assert_eq!(file.momentum[0].angular_N_m_s.z.sigma, Some(0.3));
    let names = [
        "gyro.bias_rad_s.x",
        "gyro.scale.y",
        "tracker.lag_s",
        "wheel1.spin_inertia_kg_m2",
    ];
    assert!(file.nuisance.keys().eq(names));
    let rows = ["bus.inertia_kg_m2.xx", "gyro.bias_rad_s.x"];
    assert_eq!(file.covariance.names, rows);
    let found = &file.identifiability;
    assert_eq!(found.identifiable[0].coefficients[rows[0]], 1.0);
    assert_eq!(found.not_identifiable[0].coefficients["bus.mc_kg_m.z"], 1.0);
    let known = &file.known_numbers;
    assert_eq!(known.sigma_data[rows[1]], 1e-6);
    assert_eq!(known.sensitivities[0].number, "wheel1.axis_rad.1");
    assert_eq!(known.sensitivities[0].change[rows[0]], 0.1);
    assert_eq!(file.reference.base, "bus");
    // Written again it is version 3 with a checksum, and reads as equal.
    assert_eq!(
        file.warnings.last().unwrap(),
        "unchecked: poinsot.estimate/1 has no checksum"
    );
    let text = poinsot_formats::result_text(&file, true).unwrap();
    assert!(text.contains("poinsot.estimate/3") && !text.contains("\"variant\""));
    let again = parse_estimate(Path::new("estimate.json"), text.as_bytes()).unwrap();
    assert_eq!(again, file);
}

#[test]
fn unit_another_format_is_refused_by_name() {
    let other = ESTIMATE_1.replace("estimate/1", "estimate/9");
    let error = parse_estimate(Path::new("e.json"), other.as_bytes()).unwrap_err();
    assert!(
        error
            .to_string()
            .contains("its schema is \"poinsot.estimate/9\"")
    );
}

#[test]
fn exact_the_truth_of_a_shipped_record_reads() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let truth = read_truth(&root.join("data/stsat3/multiaxis/truth.json")).unwrap();
    let mass = &truth.bodies["spacecraft"].mass;
    assert_eq!(
        (mass.mass_kg.value, mass.inertia_kg_m2.yz.value),
        (150.0, 0.5896)
    );
    assert!(truth.run.is_none() && truth.nuisance.is_empty());
}
