//! T16 to T21: uninformative motion, or motion not in the model.

use super::QUATERNION;
use crate::bad_input::bench::Bench;
use crate::bad_input::row::{Row, row};

const SIMULATED: &[&str] = &[
    "identify",
    "--model",
    "m.toml",
    "--telemetry",
    "sim/telemetry.csv",
    "--out",
    "out",
];

fn still(b: &Bench) {
    b.spoil(|s| {
        s.map("omega", |_, _| 0.0);
        s.map("wheel", |_, _| 0.0);
        let first: Vec<f64> = QUATERNION.iter().map(|c| s.get(0, c)).collect();
        for (c, q) in QUATERNION.iter().zip(first) {
            s.map(c, |_, _| q);
        }
    });
}

fn collinear(b: &Bench) {
    b.write(
        "case.toml",
        crate::bad_input::bench::CASE
            .replace(
                "angular_N_m_s = [0.2, -0.3, 0.25]",
                "angular_N_m_s = [0.0, 0.0, 0.0]",
            )
            .replace("momentum_zero = false", "")
            .replace(
                "q_xyzw = [0.1, -0.2, 0.05, 0.9733961166965892]",
                "q_xyzw = [0.0, 0.0, 0.0, 1.0]",
            )
            .replace(
                "[0.0, 150.0, 60.0, -120.0, 0.0]",
                "[0.0, 0.0, 0.0, 0.0, 0.0]",
            )
            .replace("[20.0, -100.0, 130.0, -50.0]", "[0.0, 0.0, 0.0, 0.0]")
            .replace("[-30.0, 90.0, -110.0, 40.0]", "[0.0, 90.0, -110.0, 40.0]"),
    );
    b.write(
        "truth.toml",
        crate::bad_input::bench::truth().replace(
            "xy = 0.085, xz = 0.133, yz = 0.5896",
            "xy = 0.0, xz = 0.0, yz = 0.0",
        ),
    );
    let done = b.run(&["simulate", "case.toml", "--out", "sim"]);
    assert_eq!(done.exit, 0, "{}", done.stderr);
}

/// A link with ten unknown numbers on a joint at rest without a column.
fn locked_link(b: &Bench) {
    let model = |estimate: &str| {
        crate::bad_input::bench::truth().replace("estimate = [\"inertia\"]\n", "")
            + "\n[[body]]\nname = \"link\"\nmass_kg = 10.0\ncom_m = [0.2, 0.1, 0.0]\ninertia_kg_m2 = { xx = 0.2, yy = 0.2, zz = 0.2 }\n"
            + estimate
            + "\n[[joint]]\nname = \"j\"\ntype = \"revolute\"\nparent = \"bus\"\nchild = \"link\"\norigin_m = [0.5, 0.0, 0.0]\naxis = [0.0, 0.0, 1.0]\n"
    };
    b.write("m.toml", model("estimate = true\n"));
    b.write("truth.toml", model(""));
    let rest = "[[joint_motion]]\njoint = \"j\"\ntime_s = [0.0, 100.0]\nposition_rad = [0.0, 0.0]\ninterpolation = \"quintic_rest\"\n\n[output]";
    b.write(
        "case.toml",
        crate::bad_input::bench::CASE.replace("[output]", rest),
    );
    let done = b.run(&["simulate", "case.toml", "--out", "sim"]);
    assert_eq!(done.exit, 0, "{}", done.stderr);
    let text = std::fs::read_to_string(b.path("sim/telemetry.csv")).unwrap();
    // The joint's columns under unused names.
    b.write(
        "sim/telemetry.csv",
        text.replacen(",j_rad", ",old_j_rad", 3),
    );
}

pub fn rows() -> Vec<Row> {
    vec![
        row("T16", "nothing moves", still, 1, &["not"]).never(&["every number"]),
        row(
            "T17",
            "it turns about one axis only",
            collinear,
            1,
            &["not identifiable from these data"],
        )
        .run(SIMULATED),
        row(
            "T18",
            "mass asked for, and no force acts",
            |b| b.model("estimate = [\"inertia\"]", "estimate = true"),
            1,
            &["mass not identifiable", ": Partly determined. "],
        ),
        row(
            "T18",
            "an unknown link whose joint stands still",
            locked_link,
            1,
            &[": Partly determined. ", "assumed: j locked at 0"],
        )
        .run(SIMULATED),
        row(
            "T19",
            "one sample",
            |b| b.spoil(|s| s.rows.truncate(1)),
            2,
            &[
                "E0303 t.csv: 1 samples have all required channels at one time, but 2 are required; give a longer record",
            ],
        ),
        row(
            "T19",
            "two samples",
            |b| b.spoil(|s| s.rows.truncate(2)),
            1,
            &["not"],
        )
        .never(&["every number"]),
        row(
            "T19",
            "header only",
            |b| b.spoil(|s| s.rows.clear()),
            2,
            &["E0217 t.csv: no data rows after the header; give a file with samples"],
        ),
        row(
            "T19",
            "empty file",
            |b| b.write("t.csv", ""),
            2,
            &["E0205 t.csv: the file is empty; begin it with a header row"],
        ),
        row(
            "T19",
            "comments only",
            |b| b.write("t.csv", "# nothing\n# here\n"),
            2,
            &["E0205 t.csv:1: the first row begins with '#'"],
        ),
        row(
            "T20",
            "a constant external torque",
            |b| {
                b.spoil(|s| s.map("wheel3", |n, w| w + 8.0 * n as f64 / 5.0));
            },
            1,
            &["torque"],
        ),
        row(
            "T21",
            "the inertia changes in the run",
            |b| {
                b.spoil(|s| {
                    let old = s.clone();
                    for k in 250..s.rows.len() {
                        for w in ["wheel1_rad_s", "wheel2_rad_s", "wheel3_rad_s"] {
                            let x = old.get(250, w) + 0.7 * (old.get(k, w) - old.get(250, w));
                            s.set(k, w, x);
                        }
                    }
                })
            },
            1,
            &["rejected"],
        ),
    ]
}
