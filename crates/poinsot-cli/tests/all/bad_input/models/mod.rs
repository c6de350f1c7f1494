//! 2d: URDF, and trees in TOML; one file for each kind of fault.

mod chains;
mod inertia;
mod joints;
mod trees;
mod xml;

use crate::bad_input::bench::Bench;
use crate::bad_input::row::{Row, row};

/// Two links with a revolute joint.
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

pub fn rows() -> Vec<Row> {
    let parts = [
        inertia::rows(),
        joints::rows(),
        xml::rows(),
        chains::rows(),
        trees::rows(),
    ];
    parts.into_iter().flatten().collect()
}
