//! Links with impossible or doubtful mass properties.

use super::{ROBOT, robot, urdf};
use crate::bad_input::row::Row;

pub fn rows() -> Vec<Row> {
    vec![
        urdf(
            "M0",
            "a good robot",
            |b| b.write("r.urdf", ROBOT),
            0,
            &["written: out.toml", "2 bodies, 1 joints"],
        ),
        urdf(
            "M1",
            "a fixed link without <inertial>",
            |b| {
                robot(
                    b,
                    "</robot>",
                    "<link name=\"tool\"/><joint name=\"t\" type=\"fixed\"><parent link=\"hand\"/><child link=\"tool\"/></joint></robot>",
                )
            },
            0,
            &["link \"tool\": no <inertial>: assumed massless"],
        ),
        urdf(
            "M1",
            "a moving link without <inertial>",
            |b| {
                robot(
                    b,
                    "</robot>",
                    "<link name=\"tool\"/><joint name=\"t\" type=\"revolute\"><parent link=\"hand\"/><child link=\"tool\"/><axis xyz=\"0 0 1\"/></joint></robot>",
                )
            },
            2,
            &[
                "E0116 r.urdf:15:1: link \"tool\": the link moves on joint \"t\", but neither it nor its outboard bodies have mass; give it an <inertial>, or make its joint fixed",
            ],
        ),
        urdf(
            "M1",
            "zero mass with inertia",
            |b| robot(b, "mass value=\"2\"", "mass value=\"0\""),
            2,
            &["E0116 r.urdf:8:5: link \"hand\": the mass is zero; give it a mass, or zero inertia"],
        ),
        urdf(
            "M1",
            "identity as inertia",
            |b| {
                robot(
                    b,
                    "ixx=\"1\" ixy=\"0\" ixz=\"0\" iyy=\"1.2\" iyz=\"0\" izz=\"1.5\"",
                    "ixx=\"1\" ixy=\"0\" ixz=\"0\" iyy=\"1\" iyz=\"0\" izz=\"1\"",
                )
            },
            0,
            &["link \"base\": the inertia is 1 kg m2 about every axis; is it a placeholder?"],
        ),
        urdf(
            "M1",
            "no link has mass",
            |b| b.write("r.urdf", "<robot name=\"x\"><link name=\"a\"/></robot>"),
            2,
            &["E0116 r.urdf:1:1: robot: no link has mass; give the base a mass"],
        ),
        urdf(
            "M2",
            "triangle inequality broken",
            |b| robot(b, "izz=\"1.5\"", "izz=\"9\""),
            2,
            &[
                "E0115 r.urdf:4:5: link \"base\": no body has these principal moments: 1, 1.2, 9 kg m2, the largest exceeds the sum of the other two",
            ],
        ),
        urdf(
            "M2",
            "indefinite inertia",
            |b| robot(b, "ixx=\"1\"", "ixx=\"-1\""),
            2,
            &["E0115 r.urdf:4:5: link \"base\": the smallest principal moment is negative"],
        ),
        urdf(
            "M2",
            "inertia in kg mm2",
            |b| {
                robot(
                    b,
                    "ixx=\"1\" ixy=\"0\" ixz=\"0\" iyy=\"1.2\" iyz=\"0\" izz=\"1.5\"",
                    "ixx=\"1e6\" ixy=\"0\" ixz=\"0\" iyy=\"1.2e6\" iyz=\"0\" izz=\"1.5e6\"",
                )
            },
            0,
            &[
                "the radius of gyration is",
                "are mass in kg and inertia in kg m2?",
            ],
        ),
        urdf(
            "M2",
            "inertia a million times too small",
            |b| {
                robot(
                    b,
                    "ixx=\"1\" ixy=\"0\" ixz=\"0\" iyy=\"1.2\" iyz=\"0\" izz=\"1.5\"",
                    "ixx=\"1e-6\" ixy=\"0\" ixz=\"0\" iyy=\"1.2e-6\" iyz=\"0\" izz=\"1.5e-6\"",
                )
            },
            0,
            &["the radius of gyration is"],
        ),
        urdf(
            "M2",
            "negative mass",
            |b| robot(b, "mass value=\"2\"", "mass value=\"-2\""),
            2,
            &["E0115 r.urdf:8:5: link \"hand\": the mass is negative: -2 kg; give a positive mass"],
        ),
    ]
}
