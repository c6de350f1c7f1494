//! 2d: URDF, and trees in TOML.

use crate::bench::Bench;
use crate::row::{Row, row};

/// Two links on a turning joint.
pub const ROBOT: &str = r#"<?xml version="1.0"?>
<robot name="arm">
  <link name="base">
    <inertial><origin xyz="0 0 0.1" rpy="0 0 0"/><mass value="10"/>
      <inertia ixx="1" ixy="0" ixz="0" iyy="1.2" iyz="0" izz="1.5"/></inertial>
  </link>
  <link name="hand">
    <inertial><origin xyz="0.1 0 0"/><mass value="2"/>
      <inertia ixx="0.1" ixy="0" ixz="0" iyy="0.12" iyz="0" izz="0.15"/></inertial>
  </link>
  <joint name="elbow" type="revolute">
    <parent link="base"/><child link="hand"/>
    <origin xyz="0 0 0.5" rpy="0 0 1.5707963267948966"/><axis xyz="0 0 1"/>
  </joint>
</robot>
"#;

pub const IMPORT: &[&str] = &["import", "r.urdf", "-o", "out.toml"];

fn robot(b: &Bench, from: &str, to: &str) {
    assert!(ROBOT.contains(from), "{from}");
    b.write("r.urdf", ROBOT.replacen(from, to, 1));
}

pub fn urdf(
    id: &'static str,
    fault: &'static str,
    spoil: fn(&Bench),
    exit: i32,
    says: &'static [&'static str],
) -> Row {
    row(id, fault, spoil, exit, says).run(IMPORT)
}

/// The links of a chain, each but the first followed by the joint on which it hangs, from the one before.
fn linked(
    n: usize,
    link: impl Fn(usize) -> String,
    joint: impl Fn(usize, usize) -> String,
) -> String {
    (0..n)
        .map(|k| link(k) + &k.checked_sub(1).map_or(String::new(), |p| joint(k, p)))
        .collect()
}

/// A chain as URDF.
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

/// The same chain as a model: a base with sensors and 999 links, whose joints stand still.
fn long_arm(b: &Bench, base: &str, link: &str) {
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
    let mut text = format!("schema = \"poinsot.model/1\"\nname = \"chain\"\n{links}");
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
    b.write("t.csv", crate::codes::moving(&crate::codes::DRIFT));
}

const TWIN: &str = "<link name=\"hand\"/>";
const LAUGHS: &str = "<?xml version=\"1.0\"?>\n<!DOCTYPE r [<!ENTITY a \"ha\"><!ENTITY b \"&a;&a;&a;&a;\">]>\n<robot name=\"&b;\"><link name=\"a\"/></robot>";

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
            &["link \"tool\": no <inertial>: taken as without mass"],
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
                "E0116 r.urdf:15:1: link \"tool\": the link moves on joint \"t\", but neither it nor what it carries has mass; give it an <inertial>, or make its joint fixed",
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
        urdf(
            "M3",
            "an axis of length zero",
            |b| robot(b, "axis xyz=\"0 0 1\"", "axis xyz=\"0 0 0\""),
            2,
            &[
                "E0113 r.urdf:13:57: joint \"elbow\" <axis xyz> = \"0 0 0\": the axis has no direction; give its direction in the joint's frame",
            ],
        ),
        urdf(
            "M3",
            "an axis of length 2",
            |b| robot(b, "axis xyz=\"0 0 1\"", "axis xyz=\"0 0 2\""),
            0,
            &["the axis has length 2; it was made a unit vector"],
        ),
        urdf(
            "M3",
            "NaN in an axis",
            |b| robot(b, "axis xyz=\"0 0 1\"", "axis xyz=\"0 nan 1\""),
            2,
            &["E0107", "'nan' is not finite; write a finite number"],
        ),
        urdf(
            "M3",
            "no axis",
            |b| robot(b, "<axis xyz=\"0 0 1\"/>", ""),
            0,
            &["no axis is given: x, as URDF says"],
        ),
        urdf(
            "M4",
            "a link with two parents",
            |b| {
                robot(
                    b,
                    "</robot>",
                    "<joint name=\"e2\" type=\"fixed\"><parent link=\"base\"/><child link=\"hand\"/></joint></robot>",
                )
            },
            2,
            &[
                "E0112 r.urdf:15:1: joint \"e2\": link \"hand\" has two parents: joint \"elbow\" carries it too; remove one of the joints; closed loops are not supported",
            ],
        ),
        urdf(
            "M4",
            "a circle",
            |b| {
                robot(
                    b,
                    "</robot>",
                    "<joint name=\"e2\" type=\"fixed\"><parent link=\"hand\"/><child link=\"base\"/></joint></robot>",
                )
            },
            2,
            &[
                "E0112 r.urdf:1:1: robot: no link is the base: the joints run in a circle; remove one of the joints",
            ],
        ),
        urdf(
            "M4",
            "a joint from a link to itself",
            |b| robot(b, "parent link=\"base\"", "parent link=\"hand\""),
            2,
            &[
                "E0112 r.urdf:1:1: robot: the joints of \"hand\" run in a circle; remove one of the joints",
            ],
        ),
        urdf(
            "M4",
            "two roots",
            |b| robot(b, "</robot>", "<link name=\"lost\"/></robot>"),
            2,
            &[
                "E0112 r.urdf:1:1: robot: 2 links hang on nothing: \"base\", \"lost\"; connect them by joints of type fixed; one link is the base",
            ],
        ),
        urdf(
            "M4",
            "a joint to a missing link",
            |b| robot(b, "child link=\"hand\"", "child link=\"hnad\""),
            2,
            &[
                "E0111 r.urdf:11:3: joint \"elbow\" <child>: there is no link \"hnad\"; name a link of the file",
            ],
        ),
        urdf(
            "M4",
            "two links of one name",
            |b| robot(b, "</robot>", &format!("{TWIN}</robot>")),
            2,
            &["E0110 r.urdf:15:1: link \"hand\": two links have this name; rename one"],
        ),
        urdf(
            "M4",
            "a link without name",
            |b| robot(b, "</robot>", "<link/></robot>"),
            2,
            &["E0109 r.urdf:15:1: link \"\": a link without name; give it a name"],
        ),
        urdf(
            "M4",
            "link and joint of one name",
            |b| robot(b, "joint name=\"elbow\"", "joint name=\"hand\""),
            0,
            &["2 bodies, 1 joints"],
        ),
        urdf(
            "M4",
            "no links",
            |b| b.write("r.urdf", "<robot name=\"x\"/>"),
            2,
            &["E0112 r.urdf:1:1: robot: the robot has no link; add <link>"],
        ),
        urdf(
            "M5",
            "mimic",
            |b| {
                robot(
                    b,
                    "<axis xyz=\"0 0 1\"/>",
                    "<axis xyz=\"0 0 1\"/><mimic joint=\"other\" multiplier=\"-1\"/>",
                )
            },
            0,
            &["joint \"elbow\": mimics \"other\" (multiplier -1, offset 0)"],
        ),
        urdf(
            "M5",
            "a floating joint",
            |b| robot(b, "type=\"revolute\"", "type=\"floating\""),
            2,
            &[
                "E0122 r.urdf:11:3: joint \"elbow\" type = \"floating\": this type of joint is not read",
            ],
        ),
        urdf(
            "M5",
            "a planar joint",
            |b| robot(b, "type=\"revolute\"", "type=\"planar\""),
            2,
            &[
                "E0122 r.urdf:11:3: joint \"elbow\" type = \"planar\": this type of joint is not read",
            ],
        ),
        urdf(
            "M5",
            "unknown tags",
            |b| robot(b, "</robot>", "<gazebo/><transmission/><gazebo/></robot>"),
            0,
            &["not read: 2 <gazebo>, 1 <transmission>"],
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
                "the file holds xacro tags and does not declare them",
            ],
        ),
        urdf(
            "M7",
            "billion laughs",
            |b| b.write("r.urdf", LAUGHS),
            2,
            &[
                "E0120 r.urdf:",
                "the file has a document type definition, which is not read; take <!DOCTYPE ...> out",
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
            0,
            &["1 bodies, 0 joints"],
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
            &["E0101 r.urdf: the file is larger than 16 MiB; name a model file"],
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
            |b| long_arm(b, "estimate = true", ""),
            1,
            &["the rigid model contradicts the data; no number is given"],
        ),
        row(
            "M9",
            "a chain of 1,000 links, all of them to find",
            |b| long_arm(b, "estimate = true", "estimate = true"),
            2,
            &[
                "E0406 the model asks for 10000 mass properties at once; at most 1000 are solved for; take estimate out of bodies that are known well enough",
            ],
        ),
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
        crate::bench::MODEL.to_owned() + &more.replacen(from, to, 1),
    );
}
