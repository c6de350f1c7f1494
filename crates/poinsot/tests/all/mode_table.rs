//! Tables of modes as finite-element programs print them.

use poinsot::{ModeTable, import_modes};
use std::fs;

fn imported(text: &str) -> Result<ModeTable, String> {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("modes.csv");
    fs::write(&file, text).unwrap();
    import_modes(&file, "bus").map_err(|e| e.to_string())
}

#[test]
fn exact_headers_of_programs_are_one_table() {
    let expected = "[[mode]]\nname = \"mode7\"\nbody = \"bus\"\nfrequency_Hz = 0.5\ndamping_ratio = 0.005\ntranslation_kg05 = [0.0, 0.0, 1.25]\nrotation_kg05_m = [0.5, 0.0, 0.0]\n\n";
    let turn = std::f64::consts::PI;
    for text in [
        "name,frequency_Hz,damping_ratio,Tx,Ty,Tz,Rx,Ry,Rz\nmode7,0.5,0.005,0,0,1.25,0.5,0,0\n"
            .to_owned(),
        "MODE NO.,CYCLES,DAMPING [%],T1,T2,T3,R1,R2,R3\n7,0.5,0.5,0,0,1.25,0.5,0,0\n".to_owned(),
        format!(
            "Mode No,Freq (rad/s),zeta,X-Component,Y-Component,Z-Component,X-Rotation,Y-Rotation,Z-Rotation\n 7, {turn:?}, 0.005, 0, 0, 1.25, 0.5, 0, 0\n"
        ),
        format!("id,omega_rad_s,xi,t3_kg05,r1_kg05_m\n7,{turn:?},5e-3,1.25,0.5\n"),
    ] {
        let modes = imported(&text).unwrap();
        assert_eq!(modes.text, expected, "{text}");
        assert_eq!(modes.notes, [""; 0]);
    }
}

#[test]
fn exact_the_modes_that_turn_the_body_most_stay() {
    let rows = (1..=8).map(|k| format!("{k},{k},{},0,0\n", f64::from(k) - 4.5));
    let text = format!("no,f,r1,r2,weight\n{}", rows.collect::<String>());
    let modes = imported(&text).unwrap();
    let names: Vec<&str> = modes
        .text
        .lines()
        .filter(|l| l.starts_with("name"))
        .collect();
    let stay = [1, 2, 3, 6, 7, 8].map(|k| format!("name = \"mode{k}\""));
    assert_eq!(names, stay);
    assert!(modes.notes[0].ends_with("weight") && modes.notes[1].starts_with("2 modes"));
}

#[test]
fn regress_a_table_that_is_none_is_refused_with_its_place() {
    for (text, code, word) in [
        ("no,f\n1,2\n", "E0106", "participation"),
        ("no,t1\n1,2\n", "E0106", "frequencies"),
        ("no,f,t1\n1,fast,2\n", "E0107", ":2"),
        ("no,f,t1\n1,2\n", "E0204", ":2"),
        ("", "E0106", "frequencies"),
    ] {
        let error = imported(text).unwrap_err();
        assert!(
            error.contains(code) && error.contains(word),
            "{text}: {error}"
        );
    }
}
