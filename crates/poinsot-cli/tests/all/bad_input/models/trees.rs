//! Trees written in TOML.

use crate::bad_input::bench::Bench;
use crate::bad_input::row::{Row, row};

pub fn rows() -> Vec<Row> {
    vec![
        row(
            "M4",
            "TOML: bodies in a circle",
            |b| {
                tree(
                    b,
                    "parent = \"b\"\nchild = \"c\"",
                    "parent = \"c\"\nchild = \"b\"",
                )
            },
            2,
            &["E0112 m.toml:"],
        ),
        row(
            "M4",
            "TOML: a joint to a missing body",
            |b| {
                tree(
                    b,
                    "parent = \"bus\"\nchild = \"b\"",
                    "parent = \"bos\"\nchild = \"b\"",
                )
            },
            2,
            &["E0111 m.toml:", "there is no body of this name"],
        ),
        row(
            "M1",
            "TOML: a moving body without mass",
            |b| {
                tree(
                    b,
                    "parent = \"bus\"\nchild = \"b\"",
                    "parent = \"bus\"\nchild = \"b\"",
                )
            },
            2,
            &["E0116 m.toml:"],
        ),
        row(
            "M3",
            "TOML: an axis of length zero",
            |b| b.model("axis = [1.0, 0.0, 0.0]", "axis = [0.0, 0.0, 0.0]"),
            2,
            &["E0113 m.toml:"],
        ),
        row(
            "M4",
            "TOML: two wheels of one name",
            |b| b.model("name = \"wheel2\"", "name = \"wheel1\""),
            2,
            &["E0110 m.toml:"],
        ),
        row(
            "M4",
            "TOML: an empty name",
            |b| b.model("name = \"wheel2\"", "name = \"\""),
            2,
            &["E0109 m.toml:"],
        ),
        row(
            "M1",
            "TOML: an estimate of a body without inertia",
            |b| {
                b.model("inertia_kg_m2 = { xx = 15.0, yy = 16.0, zz = 21.0, xy = 0.0, xz = 0.0, yz = 0.0 }", "inertia_kg_m2 = { xx = 0.0, yy = 0.0, zz = 0.0, xy = 0.0, xz = 0.0, yz = 0.0 }")
            },
            2,
            &["E0117 m.toml:"],
        ),
        row(
            "M1",
            "TOML: a noise that is negative",
            |b| b.model("noise_rad_s = 0.0001", "noise_rad_s = -0.0001"),
            2,
            &["E0118 m.toml:"],
        ),
    ]
}

fn tree(b: &Bench, from: &str, to: &str) {
    let more = "\n[[body]]\nname = \"b\"\nmass_kg = 0.0\n\n[[body]]\nname = \"c\"\nmass_kg = 0.0\n\n[[joint]]\nname = \"jb\"\ntype = \"revolute\"\nparent = \"bus\"\nchild = \"b\"\norigin_m = [0.0, 0.0, 0.0]\naxis = [0.0, 0.0, 1.0]\n\n[[joint]]\nname = \"jc\"\ntype = \"fixed\"\nparent = \"b\"\nchild = \"c\"\norigin_m = [0.0, 0.0, 0.0]\n";
    assert!(more.contains(from), "{from}");
    b.write(
        "m.toml",
        crate::bad_input::bench::MODEL.to_owned() + &more.replacen(from, to, 1),
    );
}
