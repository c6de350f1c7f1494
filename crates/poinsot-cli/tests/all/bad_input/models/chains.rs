//! Chains of thousands of links.

use super::urdf;
use crate::bad_input::bench::Bench;
use crate::bad_input::row::{Row, row};

/// Joins the links of a chain; each link is followed by the joint to the previous one.
fn linked(
    n: usize,
    link: impl Fn(usize) -> String,
    joint: impl Fn(usize, usize) -> String,
) -> String {
    (0..n)
        .map(|k| link(k) + &k.checked_sub(1).map_or(String::new(), |p| joint(k, p)))
        .collect()
}

pub fn chain(n: usize) -> String {
    let links = linked(
        n,
        |k| {
            format!(
                "<link name=\"l{k}\"><inertial><mass value=\"1\"/><inertia ixx=\"1\" iyy=\"1.1\" izz=\"1.2\" ixy=\"0\" ixz=\"0\" iyz=\"0\"/></inertial></link>"
            )
        },
        |k, p| {
            format!(
                "<joint name=\"j{k}\" type=\"continuous\"><parent link=\"l{p}\"/><child link=\"l{k}\"/><axis xyz=\"0 0 1\"/><origin xyz=\"0.1 0 0\"/></joint>"
            )
        },
    );
    format!("<robot name=\"chain\">{links}</robot>")
}

/// The same chain as a model: a base with sensors and 999 links with joints at rest.
fn long_arm(b: &Bench, known: &str, base: &str, link: &str) {
    let links = linked(
        1000,
        |k| {
            let estimate = if k == 0 { base } else { link };
            format!(
                "[[body]]\nname = \"l{k}\"\nmass_kg = 1.0\ncom_m = [0.05, 0.0, 0.0]\ninertia_kg_m2 = {{ xx = 1.0, yy = 1.1, zz = 1.2 }}\n{estimate}\n"
            )
        },
        |k, p| {
            format!(
                "[[joint]]\nname = \"j{k}\"\ntype = \"revolute\"\nparent = \"l{p}\"\nchild = \"l{k}\"\norigin_m = [0.1, 0.0, 0.0]\naxis = [0.0, 0.0, 1.0]\n"
            )
        },
    );
    let mut text = format!("schema = \"poinsot.model/1\"\nname = \"chain\"\n{known}\n{links}");
    for (kind, noise) in [
        ("gyro", "noise_rad_s = 1e-4"),
        ("attitude", "noise_rad = 5e-5"),
        ("velocity", "noise_m_s = 1e-5"),
    ] {
        text.push_str(&format!(
            "[[sensor]]\nname = \"{kind}\"\ntype = \"{kind}\"\n{noise}\n"
        ));
    }
    b.write("m.toml", text);
    b.write(
        "t.csv",
        crate::bad_input::codes::moving(&crate::bad_input::codes::DRIFT),
    );
}
pub fn rows() -> Vec<Row> {
    vec![
        urdf(
            "M9",
            "a chain of 1,000 links",
            |b| b.write("r.urdf", chain(1000)),
            0,
            &["1000 bodies, 999 joints"],
        ),
        row(
            "M9",
            "the same, checked",
            |b| b.write("r.urdf", chain(1000)),
            0,
            &["1000 kg"],
        )
        .run(&["check", "r.urdf"]),
        urdf(
            "M9",
            "a chain of 10,000 links",
            |b| b.write("r.urdf", chain(10_000)),
            0,
            &["10000 bodies, 9999 joints"],
        ),
        urdf(
            "M9",
            "a chain of 10,001 links",
            |b| b.write("r.urdf", chain(10_001)),
            2,
            &["E0119 r.urdf:1:1: robot: the file has 10001 links; keep to 10000 links"],
        ),
        row(
            "M9",
            "a chain of 1,000 links, its base to find",
            |b| long_arm(b, "exact = true", "estimate = true", ""),
            1,
            &[": Contradicted. "],
        ),
        row(
            "M9",
            "the same, its links known as from a drawing",
            |b| long_arm(b, "", "estimate = true", ""),
            2,
            &[
                "E0406 the model has 14988 uncertain known numbers, more than the limit of 1000; write exact = true into tables that are known well enough",
            ],
        ),
        row(
            "M9",
            "a chain of 1,000 links, all of them to find",
            |b| long_arm(b, "", "estimate = true", "estimate = true"),
            2,
            &[
                "E0406 the model has 10000 mass properties to estimate, more than the limit of 1000; take estimate out of bodies that are known well enough",
            ],
        ),
    ]
}
