//! 2e: what an attacker would write.

use crate::models::{ROBOT, urdf};
use crate::row::{Row, row};

pub fn rows() -> Vec<Row> {
    vec![
        row(
            "S1",
            "names of bodies that are paths",
            |b| {
                let m = std::fs::read_to_string(b.path("m.toml"))
                    .unwrap()
                    .replace("\"bus\"", "\"../../x\"");
                b.write("m.toml", m);
            },
            0,
            &["../../x", "written: out/estimate.json"],
        ),
        row(
            "S1",
            "a case whose model lies outside its folder, and is not there",
            |b| {
                b.write(
                    "case.toml",
                    crate::bench::CASE.replace("truth.toml", "../../no/truth.toml"),
                )
            },
            2,
            &["E0101 ../../no/truth.toml"],
        )
        .run(&["simulate", "case.toml", "--out", "sim"]),
        row(
            "S1",
            "a wheel named like a path of another system",
            |b| {
                b.model("name = \"wheel2\"", "name = 'C:\\NUL'");
                b.spoil(|s| s.header[9] = "C:\\NUL_rad_s".into());
            },
            0,
            &["written: out/estimate.json"],
        ),
        row(
            "S1",
            "NUL in a name",
            |b| b.model("name = \"wheel2\"", "name = \"wheel\\u00002\""),
            2,
            &["E0109 m.toml:18:8: wheel[1].name"],
        ),
        urdf(
            "S1",
            "a link named like a device",
            |b| b.write("r.urdf", ROBOT.replace("\"hand\"", "\"/dev/null\"")),
            0,
            &["written: out.toml"],
        ),
        row(
            "S2",
            "script in a body's name",
            |b| {
                let m = std::fs::read_to_string(b.path("m.toml"))
                    .unwrap()
                    .replace("\"bus\"", "\"</script><img src=x onerror=alert(1)>\"");
                b.write("m.toml", m);
            },
            0,
            &["written: out/report.html"],
        )
        .more(&["--report"]),
        row(
            "S4",
            "terminal escapes in a column name",
            |b| b.spoil(|s| s.header[1] = "\u{1b}[31momega_x".into()),
            2,
            &["E0301 t.csv: no channel"],
        )
        .never(&["\u{1b}"]),
        row(
            "S4",
            "terminal escapes in a cell",
            |b| b.spoil(|s| s.set(3, "omega_x", "\u{1b}[2J")),
            2,
            &["E0203 t.csv:5 column 'omega_x': '\\u{1b}[2J' is not a number"],
        )
        .never(&["\u{1b}"]),
        row("S4", "terminal escapes in a path", |_| {}, 2, &["E0202"])
            .run(&["inspect", "a\u{1b}[31m"])
            .never(&["\u{1b}"]),
        row(
            "S4",
            "direction marks in a name",
            |b| b.model("name = \"wheel2\"", "name = \"wh\u{202e}eel2\""),
            2,
            &["E0109 m.toml:"],
        )
        .never(&["\u{202e}"]),
        row(
            "S5",
            "a pickle as telemetry",
            |b| b.write("t.pkl", b"\x80\x04\x95."),
            2,
            &["E0202 t.pkl: the kind of file is not known from its name"],
        )
        .run(&["inspect", "t.pkl"]),
    ]
}
