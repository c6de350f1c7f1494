//! Notes, findings, and files that cannot be read.

use super::{HEAD, accepted, body, joint};
use poinsot_model::{parse_model, read_model};
use std::fmt::Write;

#[test]
fn unit_remarkable_models_are_noted() {
    let mut text = format!("{HEAD}{}estimate = true\n", body("base", 1e-3));
    text += &body("panel", 2.0);
    text += "prior = { mass_kg = 1.0 }\n";
    text += &body("payload", 2.0);
    text += "estimate = true\n";
    text += &joint("jp", "fixed", "base", "panel");
    text += "axis = [0.0, 0.0, 1.0]\n";
    text += &joint("jq", "fixed", "base", "payload");
    text += "[[wheel]]\nname = \"w\"\nbody = \"panel\"\naxis = [0.0, 0.0, 1.0]\nspin_inertia_kg_m2 = 0.6\n";
    text += "[[sensor]]\nname = \"s\"\ntype = \"thrust\"\nnoise_N = 1.0\n";
    assert_eq!(
        accepted(&text).notes,
        [
            "line 6: body[0].inertia_kg_m2 (body \"base\"): the radius of gyration is 24.4949 m; are mass in kg and inertia in kg m2?",
            "line 13: body[1].prior.mass_kg (body \"panel\"): the prior has no effect: the number is not estimated; remove it, or estimate the number",
            "line 19: body[2].estimate (body \"payload\"): the body is fixed to \"base\", which is unknown too: only their sum is identifiable; fix one of them",
            "line 26: joint[0].axis (joint \"jp\"): the axis of a fixed joint has no effect",
            "line 37: wheel[0].spin_inertia_kg_m2 (wheel \"w\"): the rotor has more inertia than its body \"panel\" about this axis (0.5 kg m2), which should contain it; add it there",
            "line 40: sensor[0].type (sensor \"s\"): the sensor has no effect: the model has nothing that it could measure; remove it, or add what it measures",
        ]
    );
}

/// A guess may be so far off that it is not physical.
#[test]
fn unit_a_guess_that_is_not_physical_begins_at_the_nearest_one_that_is() {
    let of = |zz: f64, more: &str| {
        let tensor = format!("inertia_kg_m2 = {{ xx = 1.0, yy = 1.0, zz = {zz} }}\n");
        format!(
            "{HEAD}[[body]]\nname = \"base\"\nmass_kg = 3.0\ncom_m = [0.0, 0.0, 0.0]\n{tensor}{more}"
        )
    };
    let model = accepted(&of(2.1, "estimate = true\n"));
    let base = &model.bodies[0];
    assert!(base.nominal.check_physical(0.0).is_ok());
    assert!((base.nominal.I_BBcm_B[(2, 2)] - 2.1).abs() < 0.01);
    assert_eq!(base.given.unwrap().I_BBcm_B[(2, 2)], 2.1);
    assert!(model.notes[0].contains("these principal moments are not physical: 1, 1, 2.1 kg m2"));
    // Far off, it is a mistake; and what is known has to be right.
    for text in [of(2.9, "estimate = true\n"), of(2.1, "")] {
        let fault = parse_model(&text, "m.toml").unwrap_err();
        assert!(fault.to_string().starts_with("E0115"), "{fault}");
    }
}

#[test]
fn unit_printed_rotations_are_made_orthonormal_and_exact_ones_kept() {
    let with = |rotation: &str| {
        accepted(&format!(
            "{HEAD}{}{}{}rotation_matrix = {rotation}\n",
            body("base", 1.0),
            body("link", 1.0),
            joint("j", "revolute", "base", "link"),
        ))
    };
    let printed =
        with("[[0.7071068, -0.7071068, 0.0], [0.7071068, 0.7071068, 0.0], [0.0, 0.0, 1.0]]");
    let r = printed.joints[0].R_PC_zero;
    assert!((r.transpose() * r - poinsot_spatial::Matrix3::identity()).amax() < 1e-14);
    assert_eq!(printed.notes.len(), 1);
    let h = std::f64::consts::FRAC_1_SQRT_2;
    let exact = with(&format!(
        "[[{h:?}, -{h:?}, 0.0], [{h:?}, {h:?}, 0.0], [0.0, 0.0, 1.0]]"
    ));
    assert_eq!(exact.joints[0].R_PC_zero[(0, 0)], h);
    assert!(exact.notes.is_empty());
}

#[test]
fn exact_twenty_findings_are_shown_in_order_and_the_rest_counted() {
    let mut text = format!("{HEAD}{}", body("base", 1.0));
    for k in 0..30 {
        let _ = writeln!(
            text,
            "[[wheel]]\nname = \"w{k}\"\nbody = \"base\"\naxis = [0, 0, 0]\nspin_inertia_kg_m2 = 1"
        );
    }
    let error = parse_model(&text, "m.toml").unwrap_err();
    assert_eq!((error.list.len(), error.omitted), (20, 10));
    assert!(
        error
            .list
            .windows(2)
            .all(|pair| pair[0].place.line < pair[1].place.line)
    );
    assert!(error.to_string().ends_with("\nand 10 more"));
}

/// In one line, so that the place of each costs the length of the file.
#[test]
fn regress_a_file_of_faults_alone_is_refused_soon() {
    let began = std::time::Instant::now();
    let many: Vec<String> = (0..200_000).map(|k| format!("{k:x} = 0")).collect();
    let text = format!("{HEAD}a = {{ {} }}\n", many.join(", "));
    assert!(parse_model(&text, "m.toml").is_err());
    let text = format!("{HEAD}{}\n", many.join("\n"));
    let error = parse_model(&text, "m.toml").unwrap_err();
    assert_eq!((error.list.len(), error.omitted), (20, 180));
    assert!(error.to_string().ends_with("\nand at least 180 more"));
    let error = parse_model(&"=\n".repeat(200_000), "m.toml").unwrap_err();
    assert_eq!((error.list.len(), error.omitted), (20, 180));
    assert!(began.elapsed().as_secs() < 20);
}

#[test]
fn exact_files_that_cannot_be_read() {
    let folder = std::env::temp_dir();
    let file = |name: &str, bytes: &[u8]| {
        let path = folder.join(format!("poinsot-model-{}-{name}", std::process::id()));
        std::fs::write(&path, bytes).unwrap();
        let error = read_model(&path).unwrap_err();
        std::fs::remove_file(&path).unwrap();
        let text = error.to_string();
        text.replace(&path.display().to_string(), "F")
    };
    assert_eq!(
        read_model("no/such.toml").unwrap_err().to_string(),
        "E0101 no/such.toml: there is no such file; check the path"
    );
    assert_eq!(
        file("utf8", b"name = \"\xff\""),
        "E0101 F: byte 8 is not UTF-8; save the file as UTF-8 text"
    );
    assert_eq!(
        file("empty", b" \n"),
        "E0103 F:1:1: the file is empty; begin with schema = \"poinsot.model/1\"; `poinsot schema` prints all keys"
    );
    assert_eq!(
        file("large", &vec![b'#'; 16 * 1024 * 1024 + 1]),
        "E0101 F: the file is larger than 16 MiB; name a file of the right kind"
    );
    assert_eq!(
        file("none", HEAD.as_bytes()),
        "E0106 F:1:1: body: the key is missing; add body: Bodies"
    );
    let deep = format!("{HEAD}x = {}{}", "[".repeat(100_000), "]".repeat(100_000));
    assert!(file("deep", deep.as_bytes()).starts_with("E0102 F:2:"));
}
