//! The telemetry map in a separate file, and the description of a model.

use super::keys::full;
use super::{HEAD, accepted, body, joint};
use poinsot_model::{describe, parse_model, parse_telemetry_map, read_telemetry_map, write_model};
use proptest::prelude::*;

#[test]
fn exact_a_telemetry_map_stands_in_its_own_file() {
    let path = std::env::temp_dir().join(format!("poinsot-map-{}.toml", std::process::id()));
    let text = "[telemetry]\nwhere = { log = \"L\" }\n[telemetry.columns]\nwheel_rad_s = { column = \"a\", unit = \"rpm\" }\n";
    std::fs::write(&path, text).unwrap();
    let map = read_telemetry_map(&path).unwrap();
    std::fs::remove_file(&path).unwrap();
    assert_eq!(map.all.columns[0].unit.as_deref(), Some("rpm"));
    assert_eq!(map.all.row_filter[0].1, "L");
    assert_eq!(
        parse_telemetry_map("[telemetri]\n", "map.toml")
            .unwrap_err()
            .to_string(),
        "E0104 map.toml:1:2: telemetri: unknown key; did you mean telemetry?"
    );
}

#[test]
fn exact_a_description_names_what_is_there_and_what_is_unknown() {
    let description = describe(&accepted(&full()));
    assert_eq!(
        description.tree,
        [
            "bus",
            "+- frame  (hold, fixed)",
            "   +- arm  (turn, revolute)",
            "      +- slider  (slide, prismatic)"
        ]
    );
    assert_eq!(description.mass_kg, 112.0);
    let text = description.to_string();
    assert!(text.contains("bus: 100 kg, mass centre (0, 0, 0.1) m, principal moments 0.3, 0.4, 0.5 kg m2; unknown: mass, inertia"));
    assert!(text.contains("w1: spin inertia"));
    assert!(text.contains("panel: body arm, frequency 0.31 Hz, damping ratio 0.005, translation (0.5, 0, -0.25) kg^1/2, rotation (0.1, 0.2, 0.3) kg^1/2 m, inertia slope"), "{text}");
    assert!(text.contains("panel: frequency, inertia slope\n"), "{text}");
    assert!(text.contains("imu: bias (prior sigma 0.001)"));
    let json = serde_json::to_value(&description).unwrap();
    assert_eq!(json["sensors"][2]["of"][0], "turn");
    // Two bodies of 1 kg at z = 0.1 and z = 1.1: the mass centre is in the middle.
    let pair = accepted(&format!(
        "{HEAD}{}{}{}",
        body("a", 1.0),
        body("b", 1.0),
        joint("j", "revolute", "a", "b")
    ));
    let system = describe(&pair).system;
    assert!((system.com_m[2] - 0.6).abs() < 1e-15);
    // 2 x 0.3 + 2 x 1 x 0.5^2 about x.
    assert!((system.principal_kg_m2[1] - 1.1).abs() < 1e-14);
}

proptest! {
    #[test]
    fn prop_arbitrary_text_never_panics(text in "\\PC{0,200}") {
        let _ = parse_model(&text, "m.toml");
        let _ = parse_telemetry_map(&text, "m.toml");
    }

    #[test]
    fn prop_damaged_files_never_panic(at in 0_usize..4000, length in 0_usize..60, by in "[\\[\\]{}=\",.a-z0-9\n -]{0,12}") {
        let mut text = full();
        let (from, to) = (at.min(text.len()), (at + length).min(text.len()));
        text.replace_range(from..to, &by);
        match parse_model(&text, "m.toml") {
            Ok(model) => { let _ = describe(&model).to_string(); }
            Err(error) => {
                prop_assert!(!error.list.is_empty());
                for finding in &error.list {
                    let whole = finding.to_string();
                    prop_assert!(!whole.contains('\n'), "{}", whole);
                    prop_assert!(!finding.problem.is_empty() && !finding.advice.is_empty());
                }
            }
        }
    }

    #[test]
    fn prop_numbers_and_axes_read_back_to_the_last_bit(
        mass in 1e-3_f64..1e4, com in prop::array::uniform3(-5.0_f64..5.0),
        axis in prop::array::uniform3(-1.0_f64..1.0), q in prop::array::uniform4(-1.0_f64..1.0),
        sigma in 1e-9_f64..1.0,
    ) {
        prop_assume!(axis.iter().any(|x| x.abs() > 1e-3) && q.iter().any(|x| x.abs() > 1e-3));
        let text = format!(
            "{HEAD}{}[[body]]\nname = \"l\"\nmass_kg = {mass:?}\ncom_m = {com:?}\ninertia_kg_m2 = {{ xx = 1.0, yy = 1.1, zz = 1.2 }}\n\
             [[joint]]\nname = \"j\"\ntype = \"revolute\"\nparent = \"base\"\nchild = \"l\"\norigin_m = {com:?}\naxis = {axis:?}\nrotation_xyzw = {q:?}\n\
             [[sensor]]\nname = \"g\"\ntype = \"gyro\"\nnoise_rad_s = {sigma:?}\n",
            body("base", 1.0));
        let model = accepted(&text);
        let mut back = accepted(&write_model(&model));
        back.notes.clone_from(&model.notes);
        prop_assert_eq!(back, model);
    }
}
