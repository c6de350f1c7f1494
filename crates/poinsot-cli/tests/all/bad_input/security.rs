//! 2e: hostile input.

use crate::bad_input::models::{ROBOT, urdf};
use crate::bad_input::row::{Row, row};

/// A value longer than any line.
const LONG: &str = match std::str::from_utf8(&[b'x'; 2000]) {
    Ok(text) => text,
    Err(_) => "",
};

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
                    crate::bad_input::bench::CASE.replace("truth.toml", "../../no/truth.toml"),
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
            "S4",
            "direction marks in a column name",
            |b| b.spoil(|s| s.header[1] = "omega\u{202e}_x".into()),
            2,
            &["E0301 t.csv: no channel"],
        ),
        row(
            "S4",
            "direction marks in the name of a column that is not read",
            |b| {
                b.spoil(|s| {
                    s.header.push("temp\u{202e}\u{9b}2J".into());
                    s.rows.iter_mut().for_each(|r| r.push("1".into()));
                })
            },
            0,
            &["temp\\u{202e}\\u{9b}2J"],
        )
        .run(&["inspect", "t.csv"]),
        row(
            "S4",
            "the same as JSON",
            |b| {
                b.spoil(|s| {
                    s.header.push("temp\u{202e}\u{9b}2J".into());
                    s.rows.iter_mut().for_each(|r| r.push("1".into()));
                })
            },
            0,
            &["temp\\u202e\\u009b2J"],
        )
        .run(&["inspect", "t.csv", "--json"]),
        row(
            "S4",
            "terminal escapes in the name of the answer's folder",
            |_| {},
            0,
            &["written: o\\u{1b}[31mut/estimate.json"],
        )
        .run(&[
            "identify",
            "--model",
            "m.toml",
            "--telemetry",
            "t.csv",
            "--out",
            "o\u{1b}[31mut",
        ]),
        row(
            "S4",
            "terminal escapes in an option",
            |_| {},
            2,
            &["error: unexpected argument"],
        )
        .run(&["check", "m.toml", "--\u{1b}[2J"]),
        row(
            "S4",
            "a method of 2,000 characters",
            |_| {},
            2,
            &[
                "E0001 --method 'xxx",
                "xxx': there is no such method; use one of auto",
            ],
        )
        .more(&["--method", LONG]),
        row(
            "S4",
            "a folder of 2,000 characters",
            |_| {},
            2,
            &["E0601 xxx", "write it by `poinsot identify --out DIR`"],
        )
        .run(&["report", LONG]),
        row(
            "S4",
            "an option of 2,000 characters",
            |_| {},
            2,
            &["error: unexpected argument 'xxx"],
        )
        .run(&["check", "m.toml", LONG]),
        row(
            "S4",
            "a column name of 5,000 characters, twice",
            |b| {
                b.spoil(|s| {
                    s.header[1] = "y".repeat(5000);
                    s.header[2] = "y".repeat(5000);
                })
            },
            2,
            &[
                "E0205 t.csv: column 'yyy",
                "yyy' is twice in the header; rename one",
            ],
        ),
        row(
            "S7",
            "an answer onto its own model",
            |b| b.write("r.urdf", ROBOT),
            2,
            &["E0001 -o 'r.urdf': this is an input of the command; name another place"],
        )
        .run(&["import", "r.urdf", "-o", "r.urdf"]),
        row(
            "S7",
            "the same by another name",
            |b| {
                b.write("r.urdf", ROBOT);
                std::fs::hard_link(b.path("r.urdf"), b.path("m2.toml")).unwrap();
            },
            2,
            &["E0001 -o 'm2.toml': this is an input of the command; name another place"],
        )
        .run(&["import", "r.urdf", "-o", "m2.toml"]),
        row(
            "S7",
            "an export onto the file that it is put into",
            |b| {
                b.write("r.urdf", ROBOT);
                std::fs::create_dir(b.path("out")).unwrap();
                b.write("out/estimate.json", "{}");
            },
            2,
            &["E0001 -o './r.urdf': this is an input of the command; name another place"],
        )
        .run(&[
            "export", "out", "--to", "urdf", "--onto", "r.urdf", "-o", "./r.urdf",
        ]),
        row(
            "S7",
            "a link from the place of the answer to the telemetry",
            |b| {
                std::fs::create_dir(b.path("out")).unwrap();
                std::os::unix::fs::symlink("../t.csv", b.path("out/estimate.json")).unwrap();
            },
            2,
            &[
                "E0001 --out 'out/estimate.json': this is an input of the command; name another place",
            ],
        ),
        row(
            "S7",
            "histories onto the telemetry",
            |b| std::fs::rename(b.path("t.csv"), b.path("histories.csv")).unwrap(),
            2,
            &["E0001 --out './histories.csv': this is an input of the command; name another place"],
        )
        .run(&[
            "validate",
            "--model",
            "m.toml",
            "--against",
            "histories.csv",
            "--out",
            ".",
        ]),
        row(
            "S7",
            "a device where the answer goes",
            |b| b.write("r.urdf", ROBOT),
            3,
            &[
                "E0002 /dev/null: cannot be written to its path: ",
                "; move the file at this path, or name another folder",
            ],
        )
        .run(&["import", "r.urdf", "-o", "/dev/null"]),
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
