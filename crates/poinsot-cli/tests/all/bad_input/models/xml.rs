//! Xacro, entities, sizes and the spelling of numbers.

use super::{robot, urdf};
use crate::bad_input::row::Row;

const LAUGHS: &str = "<?xml version=\"1.0\"?>\n<!DOCTYPE r [<!ENTITY a \"ha\"><!ENTITY b \"&a;&a;&a;&a;\">]>\n<robot name=\"&b;\"><link name=\"a\"/></robot>";

pub fn rows() -> Vec<Row> {
    vec![
        urdf(
            "S6",
            "4,000 namespaces inside each other",
            |b| {
                let nested: String = (0..4000).map(|k| format!("<a xmlns:n{k}=\"u\">")).collect();
                robot(
                    b,
                    "<robot name=\"arm\">",
                    &format!("<robot name=\"arm\">{nested}"),
                );
            },
            2,
            &[
                "E0120 r.urdf:2:",
                "more than 64 elements inside each other; name a URDF file",
            ],
        ),
        urdf(
            "S6",
            "100,000 attributes",
            |b| {
                let wide: String = (0..100_000).map(|k| format!(" a{k}=\"\"")).collect();
                robot(
                    b,
                    "<link name=\"hand\">",
                    &format!("<link name=\"hand\"{wide}>"),
                );
            },
            2,
            &["E0120 r.urdf:7:3: more than 64 attributes of one element; name a URDF file"],
        ),
        urdf(
            "S6",
            "100 namespaces beside each other",
            |b| {
                let many: String = (0..100).map(|k| format!("<a xmlns:n{k}=\"u\"/>")).collect();
                robot(
                    b,
                    "<robot name=\"arm\">",
                    &format!("<robot name=\"arm\">{many}"),
                );
            },
            2,
            &[
                "E0120 r.urdf:2:",
                "more than 64 declarations of namespaces; name a URDF file",
            ],
        ),
        urdf(
            "M6",
            "${...}",
            |b| robot(b, "mass value=\"2\"", "mass value=\"${m}\""),
            2,
            &[
                "E0121 r.urdf:8:38: <mass>: this is xacro, which has not been expanded; run xacro first: xacro FILE > robot.urdf",
            ],
        ),
        urdf(
            "M6",
            "$(find ...)",
            |b| robot(b, "mass value=\"2\"", "mass value=\"$(find pkg)\""),
            2,
            &["E0121 r.urdf:8:38: <mass>: this is xacro, which has not been expanded"],
        ),
        urdf(
            "M6",
            "a mesh of a package that is not there: meshes are not opened",
            |b| {
                robot(
                    b,
                    "<link name=\"hand\">",
                    "<link name=\"hand\"><visual><geometry><mesh filename=\"package://no/such.stl\"/></geometry></visual>",
                )
            },
            0,
            &["2 bodies, 1 joints"],
        ),
        urdf(
            "M6",
            "xacro tags",
            |b| {
                robot(
                    b,
                    "<robot name=\"arm\">",
                    "<robot name=\"arm\" xmlns:xacro=\"http://www.ros.org/wiki/xacro\"><xacro:include filename=\"x\"/>",
                )
            },
            2,
            &["E0121 r.urdf:2:63: <include>: this is xacro"],
        ),
        urdf(
            "M6",
            "an undeclared xacro prefix",
            |b| robot(b, "</robot>", "<xacro:a/></robot>"),
            2,
            &[
                "E0120 r.urdf:15:2",
                "the file has xacro tags and does not declare them",
            ],
        ),
        urdf(
            "M7",
            "billion laughs",
            |b| b.write("r.urdf", LAUGHS),
            2,
            &[
                "E0120 r.urdf:",
                "the file has a document type definition, which is not supported; take <!DOCTYPE ...> out",
            ],
        ),
        urdf(
            "M7",
            "an external entity",
            |b| {
                b.write(
                    "r.urdf",
                    "<!DOCTYPE r [<!ENTITY x SYSTEM \"file:///etc/passwd\">]><robot name=\"&x;\"/>",
                )
            },
            2,
            &["E0120 r.urdf:", "document type definition"],
        )
        .never(&["root:"]),
        urdf(
            "M7",
            "200,000 nested tags",
            |b| b.write("r.urdf", format!("<robot>{}", "<a>".repeat(200_000))),
            2,
            &["E0120 r.urdf:"],
        ),
        urdf(
            "M7",
            "200,000 nested tags, closed",
            |b| {
                b.write("r.urdf", format!("<robot name=\"x\">{}{}<link name=\"a\"><inertial><mass value=\"1\"/><inertia ixx=\"1\" iyy=\"1\" izz=\"1\" ixy=\"0\" ixz=\"0\" iyz=\"0\"/></inertial></link></robot>", "<a>".repeat(200_000), "</a>".repeat(200_000)))
            },
            2,
            &["E0120 r.urdf:1:206: more than 64 elements inside each other; name a URDF file"],
        ),
        urdf(
            "M7",
            "more than a million nodes",
            |b| {
                b.write(
                    "r.urdf",
                    format!("<robot name=\"x\">{}</robot>", "<a/>".repeat(1_000_001)),
                )
            },
            2,
            &[
                "E0120 r.urdf:",
                "the file has more than 1000000 XML nodes; name a URDF file",
            ],
        ),
        urdf(
            "M7",
            "an attribute of 40 MiB",
            |b| {
                robot(
                    b,
                    "robot name=\"arm\"",
                    &format!("robot name=\"{}\"", "a".repeat(40 << 20)),
                )
            },
            2,
            &["E0101 r.urdf: the file is larger than 16 MiB; name a file of the right kind"],
        ),
        urdf(
            "M7",
            "not XML",
            |b| b.write("r.urdf", "solid teapot"),
            2,
            &["E0120 r.urdf:1:1: not well-formed XML"],
        ),
        urdf(
            "M7",
            "another root element",
            |b| b.write("r.urdf", "<sdf/>"),
            2,
            &["E0103 r.urdf:1:1: the root element is <sdf>, not <robot>; give a URDF file"],
        ),
        urdf(
            "M8",
            "1e400",
            |b| robot(b, "mass value=\"2\"", "mass value=\"1e400\""),
            2,
            &[
                "E0107 r.urdf:8:38: link \"hand\" <mass value> = \"1e400\": '1e400' is not finite; write a finite number",
            ],
        ),
        urdf(
            "M8",
            "0x10",
            |b| robot(b, "mass value=\"2\"", "mass value=\"0x10\""),
            2,
            &["'0x10' is not a number; write a decimal number"],
        ),
        urdf(
            "M8",
            "1,0",
            |b| robot(b, "mass value=\"2\"", "mass value=\"1,0\""),
            2,
            &["'1,0' has a comma; write a decimal point, and blanks between numbers"],
        ),
        urdf(
            "M8",
            "two numbers where one stands",
            |b| robot(b, "mass value=\"2\"", "mass value=\"1 2\""),
            2,
            &["2 numbers where 1 should stand; write one number"],
        ),
        urdf(
            "M8",
            "two numbers where three stand",
            |b| robot(b, "xyz=\"0.1 0 0\"", "xyz=\"0.1 0\""),
            2,
            &["2 numbers where 3 should stand; write three numbers with blanks between them"],
        ),
        urdf(
            "M8",
            "four numbers where three stand",
            |b| robot(b, "xyz=\"0.1 0 0\"", "xyz=\"0.1 0 0 0\""),
            2,
            &[
                "E0107 r.urdf:8:15: link \"hand\" <origin xyz> = \"0.1 0 0 0\": 4 numbers where 3 should stand",
            ],
        ),
        urdf(
            "M8",
            "a missing element of the inertia",
            |b| robot(b, "izz=\"0.15\"", ""),
            2,
            &["E0107 r.urdf:9:7: link \"hand\" <inertia izz>: the number is missing; add it"],
        ),
        urdf(
            "M8",
            "no <mass>",
            |b| robot(b, "<mass value=\"2\"/>", ""),
            2,
            &["<inertial> has no <mass value=\"...\">; add it, kg"],
        ),
        urdf(
            "M8",
            "two <inertial>",
            |b| robot(b, "</inertial>", "</inertial><inertial/>"),
            2,
            &["the link has two <inertial>; keep one of them"],
        ),
    ]
}
