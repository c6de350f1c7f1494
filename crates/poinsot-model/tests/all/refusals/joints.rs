//! Refusals of joints, wheels and thrusters.

use crate::refusals::Case;

pub const CASES: &[Case] = &[
    (
        r#"rotation_xyzw = [0.0, 0.0, 0.0, 1.0]"#,
        r#"rotation_wxyz = [1.0, 0.0, 0.0, 0.0]"#,
        r#"E0105 m.toml:20:1: joint[0].rotation_wxyz (joint "joint1") = [1.0, 0.0, 0.0, 0.0]: wrong form; write rotation_xyzw or rotation_matrix and convert the numbers"#,
    ),
    (
        r#"[[wheel]]"#,
        r#"[wheel]"#,
        r#"E0107 m.toml:22:1: wheel: a table is here, but another type is needed; write [[wheel]] with two brackets: there may be several"#,
    ),
    (
        r#"axis = [0.0, 0.0, 1.0]
"#,
        r#""#,
        r#"E0106 m.toml:14:1: joint[0].axis (joint "joint1"): the key is missing; add axis: Axis in the child's frame"#,
    ),
    (
        r#"type = "revolute""#,
        r#"type = "revolut""#,
        r#"E0107 m.toml:16:8: joint[0].type (joint "joint1") = "revolut": the word is not one of those allowed here; write "revolute", "prismatic", "fixed"; did you mean "revolute"?"#,
    ),
    (
        r#"spin_inertia_kg_m2 = 4.113e-4"#,
        r#"spin_inertia_kg_m2 = 0"#,
        r#"E0108 m.toml:26:22: wheel[0].spin_inertia_kg_m2 (wheel "wheel1") = 0: the spin inertia must be greater than zero; give a positive number"#,
    ),
    (
        r#"[[wheel]]
name = "wheel1""#,
        r#"[[wheel]]
name = "wheel1"
body = "bus"
axis = [0.0, 1.0, 0.0]
spin_inertia_kg_m2 = 1e-4
[[wheel]]
name = "wheel1""#,
        r#"E0110 m.toml:28:8: wheel[1].name = "wheel1": wheel[0] has the same name; rename one of them"#,
    ),
    (
        r#"name = "wheel1""#,
        r#"name = "joint1""#,
        r#"E0110 m.toml:23:8: wheel[0].name = "joint1": joint[0] has the same name, and both would have the column joint1_rad_s; rename one of them"#,
    ),
    (
        r#"parent = "bus""#,
        r#"parent = "buss""#,
        r#"E0111 m.toml:17:10: joint[0].parent (joint "joint1") = "buss": there is no body of this name; did you mean "bus"?"#,
    ),
    (
        r#"child = "link1""#,
        r#"child = "zzz""#,
        r#"E0111 m.toml:18:9: joint[0].child (joint "joint1") = "zzz": there is no body of this name; name one that a [[body]] has"#,
    ),
    (
        r#"name = "thr1"
body = "bus""#,
        r#"name = "thr1"
body = "link""#,
        r#"E0111 m.toml:29:8: thruster[0].body (thruster "thr1") = "link": there is no body of this name; did you mean "link1"?"#,
    ),
    (
        r#"[[joint]]
"#,
        r#"[[body]]
name = "a"
mass_kg = 1.0
com_m = [0.0, 0.0, 0.0]
inertia_kg_m2 = { xx = 1.0, yy = 1.5, zz = 1.0 }
[[body]]
name = "b"
mass_kg = 1.0
com_m = [0.0, 0.0, 0.0]
inertia_kg_m2 = { xx = 1.0, yy = 1.5, zz = 1.0 }
[[body]]
name = "c"
mass_kg = 1.0
com_m = [0.0, 0.0, 0.0]
inertia_kg_m2 = { xx = 1.0, yy = 1.5, zz = 1.0 }
[[joint]]
name = "ja"
type = "fixed"
parent = "c"
child = "a"
origin_m = [0.0, 0.0, 0.0]
[[joint]]
name = "jb"
type = "fixed"
parent = "a"
child = "b"
origin_m = [0.0, 0.0, 0.0]
[[joint]]
name = "jc"
type = "fixed"
parent = "b"
child = "c"
origin_m = [0.0, 0.0, 0.0]
[[joint]]
"#,
        r#"E0112 m.toml:32:10: joint[0].parent (joint "ja") = "c": the joints form a loop: a -> b -> c -> a; connect one of these bodies with the base instead"#,
    ),
    (
        r#"[[wheel]]
name = "wheel1""#,
        r#"[[joint]]
name = "j2"
type = "fixed"
parent = "bus"
child = "link1"
origin_m = [0.0, 0.0, 0.0]
[[wheel]]
name = "wheel1""#,
        r#"E0112 m.toml:26:9: joint[1].child (joint "j2") = "link1": the body has two parents: it is also the child of joint "joint1"; remove one of the joints; closed loops are not supported"#,
    ),
    (
        r#"parent = "bus""#,
        r#"parent = "link1""#,
        r#"E0112 m.toml:18:9: joint[0].child (joint "joint1") = "link1": the joint connects the body with itself; name another parent or child"#,
    ),
    (
        r#"axis = [0.0, 0.0, 1.0]"#,
        r#"axis = [0.0, 0.0, 0.0]"#,
        r#"E0113 m.toml:21:8: joint[0].axis (joint "joint1") = [0.0, 0.0, 0.0]: the axis has length zero; give a direction, for example [0.0, 0.0, 1.0]"#,
    ),
    (
        r#"force_direction = [-1.0, 0.0, 0.0]"#,
        r#"force_direction = [0.0, 0.0, 0.0]"#,
        r#"E0113 m.toml:31:19: thruster[0].force_direction (thruster "thr1") = [0.0, 0.0, 0.0]: the force direction has length zero; give a direction, for example [0.0, 0.0, 1.0]"#,
    ),
    (
        r#"rotation_xyzw = [0.0, 0.0, 0.0, 1.0]"#,
        r#"rotation_xyzw = [0.0, 0.0, 0.0, 0.0]"#,
        r#"E0114 m.toml:20:17: joint[0].rotation_xyzw (joint "joint1") = [0.0, 0.0, 0.0, 0.0]: the quaternion is zero; write [0.0, 0.0, 0.0, 1.0] for no rotation"#,
    ),
    (
        r#"rotation_xyzw = [0.0, 0.0, 0.0, 1.0]"#,
        r#"rotation_matrix = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.001]]"#,
        r#"E0114 m.toml:20:19: joint[0].rotation_matrix (joint "joint1") = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.001]]: the matrix R is not orthonormal: R'R differs from 1 by 0.002001, its columns have lengths 1, 1, 1.001; write at least seven digits, or rotation_xyzw"#,
    ),
    (
        r#"rotation_xyzw = [0.0, 0.0, 0.0, 1.0]"#,
        r#"rotation_matrix = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]]"#,
        r#"E0114 m.toml:20:19: joint[0].rotation_matrix (joint "joint1") = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]]: the matrix has determinant -1: it mirrors (left-handed axes); reverse one axis"#,
    ),
    (
        r#"rotation_xyzw = [0.0, 0.0, 0.0, 1.0]"#,
        r#"rotation_xyzw = [0.0, 0.0, 0.0, 1.0]
rotation_matrix = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]"#,
        r#"E0114 m.toml:21:19: joint[0].rotation_matrix (joint "joint1") = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]: rotation_xyzw is given too; keep one of the two"#,
    ),
    (
        r#"axis = [0.0, 0.0, 1.0]"#,
        r#"axis = [0.0, 0.0, 1.0]
locked_at_m = 0.1"#,
        r#"E0105 m.toml:22:15: joint[0].locked_at_m (joint "joint1") = 0.1: the key does not fit type = "revolute"; write locked_at_rad"#,
    ),
    (
        r#"axis = [0.0, 0.0, 1.0]"#,
        r#"axis = [0.0, 0.0, 1.0]
spring_damper = { stiffness_N_per_m = 2.0 }"#,
        r#"E0105 m.toml:22:39: joint[0].spring_damper.stiffness_N_per_m (joint "joint1") = 2.0: the key does not fit type = "revolute"; write stiffness_N_m_per_rad"#,
    ),
    (
        r#"axis = [0.0, 0.0, 1.0]"#,
        r#"axis = [0.0, 0.0, 1.0]
spring_damper = { damping_N_m_s_per_rad = 0.1 }"#,
        r#"E0106 m.toml:22:17: joint[0].spring_damper.stiffness_N_m_per_rad (joint "joint1"): the key is missing; add stiffness_N_m_per_rad: Stiffness of a revolute joint, N m/rad"#,
    ),
    (
        r#"axis = [0.0, 0.0, 1.0]"#,
        r#"axis = [0.0, 0.0, 1.0]
spring_damper = { stiffness_N_m_per_rad = -2.0 }"#,
        r#"E0108 m.toml:22:43: joint[0].spring_damper.stiffness_N_m_per_rad (joint "joint1") = -2.0: the stiffness is negative; give zero or a positive number"#,
    ),
    (
        r#"type = "revolute""#,
        r#"type = "fixed"
spring_damper = { stiffness_N_m_per_rad = 2.0 }"#,
        r#"E0105 m.toml:17:17: joint[0].spring_damper (joint "joint1") = { stiffness_N_m_per_rad = 2.0 }: the key does not fit type = "fixed"; remove it, or write type = "revolute" or "prismatic""#,
    ),
    (
        r#"axis = [0.0, 0.0, 1.0]"#,
        r#"axis = [0.0, 0.0, 1.0]
spring_damper = { stiffness = 2.0 }"#,
        r#"E0105 m.toml:22:19: joint[0].spring_damper.stiffness (joint "joint1") = 2.0: missing unit; write stiffness_N_m_per_rad"#,
    ),
    (
        r#"axis = [0.0, 0.0, 1.0]"#,
        r#"axis = [0.0, 0.0, 1.0]
spring_damper = { stiffness_N_m_per_rad = nan }"#,
        r#"E0108 m.toml:22:43: joint[0].spring_damper.stiffness_N_m_per_rad (joint "joint1") = nan: the number is not finite; write a finite number"#,
    ),
    (
        r#"axis = [0.0, 0.0, 1.0]"#,
        r#"axis = [0.0, 0.0, 1.0]
spring_damper = { stiffness_N_m_per_rad = 2.0, damping_N_m_s_per_rad = -0.1 }"#,
        r#"E0108 m.toml:22:72: joint[0].spring_damper.damping_N_m_s_per_rad (joint "joint1") = -0.1: the damping is negative; give zero or a positive number"#,
    ),
];
