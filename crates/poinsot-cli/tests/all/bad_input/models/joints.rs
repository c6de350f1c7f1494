//! Axes, names, connections and types of joints.

use super::{robot, urdf};
use crate::bad_input::row::Row;

const TWIN: &str = "<link name=\"hand\"/>";

pub fn rows() -> Vec<Row> {
    vec![
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
            &["no axis is given: x, the default of URDF"],
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
                "E0112 r.urdf:1:1: robot: no link is the base: the joints form a loop; remove one of the joints",
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
                "E0122 r.urdf:11:3: joint \"elbow\" type = \"floating\": this type of joint is not supported",
            ],
        ),
        urdf(
            "M5",
            "a planar joint",
            |b| robot(b, "type=\"revolute\"", "type=\"planar\""),
            2,
            &[
                "E0122 r.urdf:11:3: joint \"elbow\" type = \"planar\": this type of joint is not supported",
            ],
        ),
        urdf(
            "M5",
            "unknown tags",
            |b| robot(b, "</robot>", "<gazebo/><transmission/><gazebo/></robot>"),
            0,
            &["not read: 2 <gazebo>, 1 <transmission>"],
        ),
    ]
}
