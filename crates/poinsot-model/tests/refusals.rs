//! Every refusal with its whole message: a user reads nothing else.

use poinsot_model::parse_model;

/// A base, a link on a revolute joint, a wheel, a thruster, a gyro and joint encoders.
const GOOD: &str = r#"schema = "poinsot.model/1"
name = "test"
[[body]]
name = "bus"
mass_kg = 400.0
com_m = [0.0, 0.0, 0.1]
inertia_kg_m2 = { xx = 30.0, yy = 28.0, zz = 32.0, xy = 0.26, xz = 0.37, yz = -0.29 }
estimate = true
[[body]]
name = "link1"
mass_kg = 12.0
com_m = [0.0, 0.0, 0.15]
inertia_kg_m2 = { xx = 0.51, yy = 0.5, zz = 0.2 }
[[joint]]
name = "joint1"
type = "revolute"
parent = "bus"
child = "link1"
origin_m = [0.357, -0.010, 0.419]
rotation_xyzw = [0.0, 0.0, 0.0, 1.0]
axis = [0.0, 0.0, 1.0]
[[wheel]]
name = "wheel1"
body = "bus"
axis = [1.0, 0.0, 0.0]
spin_inertia_kg_m2 = 4.113e-4
[[thruster]]
name = "thr1"
body = "bus"
position_m = [-0.7, -0.2, 0.0]
force_direction = [-1.0, 0.0, 0.0]
[[sensor]]
name = "gyro"
type = "gyro"
noise_rad_s = 1.0e-4
[[sensor]]
name = "encoders"
type = "joint_position"
quantisation_rad = 2.4e-5
"#;

/// What is replaced in [`GOOD`] by what, and the message.
const CASES: &[(&str, &str, &str)] = &[
    (
        r#"schema = "poinsot.model/1""#,
        r#"schema = "poinsot.model/2""#,
        r#"E0103 m.toml:1:10: schema = "poinsot.model/2": this program does not read this format; write schema = "poinsot.model/1""#,
    ),
    (
        r#"schema = "poinsot.model/1""#,
        r#"schema = 1"#,
        r#"E0103 m.toml:1:10: schema = 1: this program does not read this format; write schema = "poinsot.model/1""#,
    ),
    (
        r#"schema = "poinsot.model/1"
"#,
        r#""#,
        r#"E0103 m.toml:1:1: schema: the key is missing; write schema = "poinsot.model/1""#,
    ),
    (
        r#"name = "test""#,
        r#"name = "#,
        r#"E0102 m.toml:2:8: not valid TOML: string values must be quoted, expected literal string; correct it here"#,
    ),
    (
        r#"name = "test""#,
        r#"name = "test"
name = "test""#,
        r#"E0102 m.toml:3:1: not valid TOML: duplicate key; correct it here"#,
    ),
    (
        r#"com_m = [0.0, 0.0, 0.1]"#,
        r#"com_mm = [0.0, 0.0, 0.1]"#,
        r#"E0105 m.toml:6:1: body[0].com_mm (body "bus") = [0.0, 0.0, 0.1]: wrong unit; write com_m and convert the number"#,
    ),
    (
        r#"mass_kg = 12.0"#,
        r#"mass = 12.0"#,
        r#"E0105 m.toml:11:1: body[1].mass (body "link1") = 12.0: missing unit; write mass_kg"#,
    ),
    (
        r#"mass_kg = 12.0"#,
        r#"mass_g = 12000.0"#,
        r#"E0105 m.toml:11:1: body[1].mass_g (body "link1") = 12000.0: wrong unit; write mass_kg and convert the number"#,
    ),
    (
        r#"com_m = [0.0, 0.0, 0.15]"#,
        r#"com = [0.0, 0.0, 0.15]"#,
        r#"E0105 m.toml:12:1: body[1].com (body "link1") = [0.0, 0.0, 0.15]: missing unit; write com_m"#,
    ),
    (
        r#"inertia_kg_m2 = { xx = 0.51, yy = 0.5, zz = 0.2 }"#,
        r#"inertia = { xx = 0.51, yy = 0.5, zz = 0.2 }"#,
        r#"E0105 m.toml:13:1: body[1].inertia (body "link1") = { xx = 0.51, yy = 0.5, zz = 0.2 }: missing unit; write inertia_kg_m2"#,
    ),
    (
        r#"mass_kg = 12.0"#,
        r#"masss_kg = 12.0"#,
        r#"E0104 m.toml:11:1: body[1].masss_kg (body "link1") = 12.0: unknown key; did you mean mass_kg?"#,
    ),
    (
        r#"estimate = true"#,
        r#"estimat = true"#,
        r#"E0104 m.toml:8:1: body[0].estimat (body "bus") = true: unknown key; did you mean estimate?"#,
    ),
    (
        r#"rotation_xyzw = [0.0, 0.0, 0.0, 1.0]"#,
        r#"rotation_wxyz = [1.0, 0.0, 0.0, 0.0]"#,
        r#"E0105 m.toml:20:1: joint[0].rotation_wxyz (joint "joint1") = [1.0, 0.0, 0.0, 0.0]: wrong form; write rotation_xyzw or rotation_matrix and convert the numbers"#,
    ),
    (
        r#"[[thruster]]"#,
        r#"[[jet]]"#,
        r#"E0104 m.toml:27:3: jet: unknown key; remove it; known here: schema, name, body, joint, wheel, thruster, sensor, momentum, environment, telemetry"#,
    ),
    (
        r#"[[wheel]]"#,
        r#"[[wheels]]"#,
        r#"E0104 m.toml:22:3: wheels: unknown key; did you mean wheel?"#,
    ),
    (
        r#"[[wheel]]"#,
        r#"[wheel]"#,
        r#"E0107 m.toml:22:1: wheel: a table stands where another type is needed; write [[wheel]] with two brackets: there may be several"#,
    ),
    (
        r#"mass_kg = 12.0
"#,
        r#""#,
        r#"E0106 m.toml:9:1: body[1].mass_kg (body "link1"): the key is missing; add mass_kg: Mass, kg"#,
    ),
    (
        r#"com_m = [0.0, 0.0, 0.15]
"#,
        r#""#,
        r#"E0106 m.toml:9:1: body[1].com_m (body "link1"): the key is missing on a body that has mass; give it, if need be as a rough guess with estimate = true"#,
    ),
    (
        r#"inertia_kg_m2 = { xx = 0.51, yy = 0.5, zz = 0.2 }"#,
        r#"inertia_kg_m2 = { xx = 0.51, yy = 0.5 }"#,
        r#"E0106 m.toml:13:17: body[1].inertia_kg_m2.zz (body "link1"): the key is missing; add zz: Moment about z, kg m2"#,
    ),
    (
        r#"axis = [0.0, 0.0, 1.0]
"#,
        r#""#,
        r#"E0106 m.toml:14:1: joint[0].axis (joint "joint1"): the key is missing on a joint that moves; add axis = [x, y, z] in the child's frame"#,
    ),
    (
        r#"mass_kg = 12.0"#,
        r#"mass_kg = "12.0""#,
        r#"E0107 m.toml:11:11: body[1].mass_kg (body "link1") = "12.0": text stands where another type is needed; write a number"#,
    ),
    (
        r#"com_m = [0.0, 0.0, 0.15]"#,
        r#"com_m = [0.0, 0.15]"#,
        r#"E0107 m.toml:12:9: body[1].com_m (body "link1") = [0.0, 0.15]: the list has 2 entries; write a list of 3 numbers"#,
    ),
    (
        r#"com_m = [0.0, 0.0, 0.15]"#,
        r#"com_m = [0.0, true, 0.15]"#,
        r#"E0107 m.toml:12:15: body[1].com_m[1] (body "link1") = true: true or false stands where another type is needed; write a number"#,
    ),
    (
        r#"com_m = [0.0, 0.0, 0.15]"#,
        r#"com_m = 2026-01-01"#,
        r#"E0107 m.toml:12:9: body[1].com_m (body "link1") = 2026-01-01: a date stands where another type is needed; write a list of 3 numbers"#,
    ),
    (
        r#"type = "revolute""#,
        r#"type = "revolut""#,
        r#"E0107 m.toml:16:8: joint[0].type (joint "joint1") = "revolut": the word is not one of those allowed here; write "revolute", "prismatic", "fixed"; did you mean "revolute"?"#,
    ),
    (
        r#"type = "gyro""#,
        r#"type = "gyroscope""#,
        r#"E0107 m.toml:34:8: sensor[0].type (sensor "gyro") = "gyroscope": the word is not one of those allowed here; write "gyro", "attitude", "position", "velocity", "velocity_increment", "accelerometer", "joint_position", "joint_rate", "wheel_speed", "thrust"; did you mean "gyro"?"#,
    ),
    (
        r#"estimate = true"#,
        r#"estimate = ["mass", "mas"]"#,
        r#"E0107 m.toml:8:21: body[0].estimate[1] (body "bus") = "mas": the word is not one of those allowed here; write "mass", "com", "inertia"; did you mean "mass"?"#,
    ),
    (
        r#"estimate = true"#,
        r#"estimate = "mass""#,
        r#"E0107 m.toml:8:12: body[0].estimate (body "bus") = "mass": text stands where another type is needed; write true, false or a list of "mass", "com", "inertia""#,
    ),
    (
        r#"noise_rad_s = 1.0e-4"#,
        r#"noise_rad_s = 1.0e-4
bias = 1.0e-5"#,
        r#"E0107 m.toml:36:8: sensor[0].bias (sensor "gyro") = 1.0e-5: a number stands where another type is needed; write "none", "estimate" or a table { sigma_<unit> = x }"#,
    ),
    (
        r#"noise_rad_s = 1.0e-4"#,
        r#"noise_rad_s = 1.0e-4
bias = "estimated""#,
        r#"E0107 m.toml:36:8: sensor[0].bias (sensor "gyro") = "estimated": the word is not one of those allowed here; write "none", "estimate" or a table { sigma_<unit> = x }; did you mean "estimate"?"#,
    ),
    (
        r#"mass_kg = 12.0"#,
        r#"mass_kg = nan"#,
        r#"E0108 m.toml:11:11: body[1].mass_kg (body "link1") = nan: the number is not finite; write a finite number"#,
    ),
    (
        r#"mass_kg = 12.0"#,
        r#"mass_kg = 1e400"#,
        r#"E0108 m.toml:11:11: body[1].mass_kg (body "link1") = 1e400: the number is not finite; write a finite number"#,
    ),
    (
        r#"com_m = [0.0, 0.0, 0.15]"#,
        r#"com_m = [0.0, 1e31, 0.15]"#,
        r#"E0108 m.toml:12:15: body[1].com_m[1] (body "link1") = 1e31: the number is larger than 1e30; check its unit: all quantities are SI"#,
    ),
    (
        r#"spin_inertia_kg_m2 = 4.113e-4"#,
        r#"spin_inertia_kg_m2 = 0"#,
        r#"E0108 m.toml:26:22: wheel[0].spin_inertia_kg_m2 (wheel "wheel1") = 0: the spin inertia must be greater than zero; give a positive number"#,
    ),
    (
        r#"name = "link1""#,
        r#"name = """#,
        r#"E0109 m.toml:10:8: body[1].name = "": the name is empty; give it a plain name
E0111 m.toml:18:9: joint[0].child (joint "joint1") = "link1": there is no body of this name; name one that a [[body]] has"#,
    ),
    (
        r#"name = "link1""#,
        r#"name = "link1\u001b[2J""#,
        r#"E0109 m.toml:10:8: body[1].name = "link1\u001b[2J": the name holds a character that cannot be printed; give it a plain name
E0111 m.toml:18:9: joint[0].child (joint "joint1") = "link1": there is no body of this name; did you mean "link1\u{1b}[2J"?"#,
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
        r#"E0110 m.toml:23:8: wheel[0].name = "joint1": joint[0] has the same name, and both would read the column joint1_rad_s; rename one of them"#,
    ),
    (
        r#"[[wheel]]
name = "wheel1""#,
        r#"[[sensor]]
name = "gyro"
type = "gyro"
[[wheel]]
name = "wheel1""#,
        r#"E0110 m.toml:36:8: sensor[1].name = "gyro": sensor[0] of the same type has the same name; rename one of them"#,
    ),
    (
        r#"[[joint]]
"#,
        r#"[[body]]
name = "bus"
mass_kg = 1.0
com_m = [0.0, 0.0, 0.0]
inertia_kg_m2 = { xx = 1.0, yy = 1.5, zz = 1.0 }
[[joint]]
"#,
        r#"E0110 m.toml:15:8: body[2].name = "bus": body[0] has the same name; rename one of them"#,
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
        r#"quantisation_rad = 2.4e-5"#,
        r#"quantisation_rad = 2.4e-5
of = ["joint1", "joint2"]"#,
        r#"E0111 m.toml:40:17: sensor[1].of[1] (sensor "encoders") = "joint2": there is no joint of this name; did you mean "joint1"?"#,
    ),
    (
        r#"[[joint]]
"#,
        r#"[[body]]
name = "a"
mass_kg = 1.0
com_m = [0.0, 0.0, 0.0]
inertia_kg_m2 = { xx = 1.0, yy = 1.5, zz = 1.0 }
[[joint]]
"#,
        r#"E0112 m.toml:15:8: body[2].name = "a": no joint carries this body: it is not connected with the base; add a [[joint]] with this child, type = "fixed" where it does not move"#,
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
        r#"E0112 m.toml:32:10: joint[0].parent (joint "ja") = "c": the joints run in a circle: a -> b -> c -> a; connect one of these bodies with the base instead"#,
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
        r#"E0112 m.toml:26:9: joint[1].child (joint "j2") = "link1": the body has two parents: joint "joint1" carries it too; remove one of the joints; closed loops are not supported"#,
    ),
    (
        r#"parent = "bus""#,
        r#"parent = "link1""#,
        r#"E0112 m.toml:18:9: joint[0].child (joint "joint1") = "link1": the joint connects the body with itself; name another parent or child"#,
    ),
    (
        r#"parent = "bus"
child = "link1""#,
        r#"parent = "link1"
child = "bus""#,
        r#"E0112 m.toml:10:8: body[1].name = "link1": no joint carries this body: it is not connected with the base; add a [[joint]] with this child, type = "fixed" where it does not move
E0112 m.toml:18:9: joint[0].child (joint "joint1") = "bus": the base hangs on nothing; the first [[body]] is the base: name another child, or move the base to the top"#,
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
        r#"E0105 m.toml:22:15: joint[0].locked_at_m (joint "joint1") = 0.1: the key does not fit the type of the joint; write locked_at_rad for a revolute joint"#,
    ),
    (
        r#"axis = [0.0, 0.0, 1.0]"#,
        r#"axis = [0.0, 0.0, 1.0]
spring_damper = { stiffness_N_per_m = 2.0 }"#,
        r#"E0105 m.toml:22:39: joint[0].spring_damper.stiffness_N_per_m (joint "joint1") = 2.0: the key does not fit the type of the joint; write stiffness_N_m_per_rad for a revolute joint"#,
    ),
    (
        r#"axis = [0.0, 0.0, 1.0]"#,
        r#"axis = [0.0, 0.0, 1.0]
spring_damper = { damping_N_m_s_per_rad = 0.1 }"#,
        r#"E0106 m.toml:22:17: joint[0].spring_damper.stiffness_N_m_per_rad (joint "joint1"): the key is missing; add it; 0.0 for a hinge without a spring"#,
    ),
    (
        r#"axis = [0.0, 0.0, 1.0]"#,
        r#"axis = [0.0, 0.0, 1.0]
spring_damper = { stiffness_N_m_per_rad = -2.0 }"#,
        r#"E0108 m.toml:22:43: joint[0].spring_damper.stiffness_N_m_per_rad (joint "joint1") = -2.0: stiffness and damping must not be negative: they would drive the motion; give zero or a positive number"#,
    ),
    (
        r#"type = "revolute""#,
        r#"type = "fixed"
spring_damper = { stiffness_N_m_per_rad = 2.0 }"#,
        r#"E0105 m.toml:17:17: joint[0].spring_damper (joint "joint1") = { stiffness_N_m_per_rad = 2.0 }: the key does not fit the type of the joint; remove it: a fixed joint does not move"#,
    ),
    (
        r#"axis = [0.0, 0.0, 1.0]"#,
        r#"axis = [0.0, 0.0, 1.0]
spring_damper = { stiffness = 2.0 }"#,
        r#"E0105 m.toml:22:19: joint[0].spring_damper.stiffness (joint "joint1") = 2.0: missing unit; write stiffness_N_m_per_rad or stiffness_N_per_m"#,
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
        r#"E0108 m.toml:22:72: joint[0].spring_damper.damping_N_m_s_per_rad (joint "joint1") = -0.1: stiffness and damping must not be negative: they would drive the motion; give zero or a positive number"#,
    ),
    (
        r#"mass_kg = 12.0"#,
        r#"mass_kg = -12.0"#,
        r#"E0115 m.toml:11:11: body[1].mass_kg (body "link1") = -12.0: the mass is negative; give a positive mass"#,
    ),
    (
        r#"xx = 0.51, yy = 0.5, zz = 0.2"#,
        r#"xx = -0.51, yy = 0.5, zz = 0.2"#,
        r#"E0115 m.toml:13:17: body[1].inertia_kg_m2 (body "link1") = { xx = -0.51, yy = 0.5, zz = 0.2 }: the smallest principal moment is negative: -0.51, 0.2, 0.5 kg m2; correct the numbers; they are tensor elements (xy = -integral x y dm) about the mass centre"#,
    ),
    (
        r#"xx = 0.51, yy = 0.5, zz = 0.2"#,
        r#"xx = 0.51, yy = 0.5, zz = 1.2"#,
        r#"E0115 m.toml:13:17: body[1].inertia_kg_m2 (body "link1") = { xx = 0.51, yy = 0.5, zz = 1.2 }: no body has these principal moments: 0.5, 0.51, 1.2 kg m2, the largest exceeds the sum of the other two; correct the numbers; they are tensor elements (xy = -integral x y dm) about the mass centre"#,
    ),
    (
        r#"mass_kg = 12.0"#,
        r#"mass_kg = 0.0"#,
        r#"E0116 m.toml:13:17: body[1].inertia_kg_m2 (body "link1") = { xx = 0.51, yy = 0.5, zz = 0.2 }: the body has inertia but no mass; give it a mass, or zero inertia"#,
    ),
    (
        r#"mass_kg = 12.0
com_m = [0.0, 0.0, 0.15]
inertia_kg_m2 = { xx = 0.51, yy = 0.5, zz = 0.2 }"#,
        r#"mass_kg = 0.0"#,
        r#"E0116 m.toml:11:11: body[1].mass_kg (body "link1") = 0.0: the body moves on joint "joint1", but neither it nor what it carries has mass; give it a mass, make its joint fixed, or remove it"#,
    ),
    (
        r#"mass_kg = 12.0
com_m = [0.0, 0.0, 0.15]
inertia_kg_m2 = { xx = 0.51, yy = 0.5, zz = 0.2 }"#,
        r#"mass_kg = 0.0
estimate = true"#,
        r#"E0117 m.toml:12:12: body[1].estimate (body "link1") = true: the body is to be estimated but its nominal mass is zero; give a rough positive mass_kg, com_m and inertia_kg_m2, or remove estimate"#,
    ),
    (
        r#"xx = 30.0, yy = 28.0, zz = 32.0, xy = 0.26, xz = 0.37, yz = -0.29"#,
        r#"xx = 0, yy = 0, zz = 0"#,
        r#"E0117 m.toml:8:12: body[0].estimate (body "bus") = true: the body is to be estimated but its nominal inertia is zero; give a rough positive inertia_kg_m2: it sets the scale by which the answer is judged"#,
    ),
    (
        r#"estimate = true"#,
        r#"estimate = true
prior = { mass_kg = 0.0 }"#,
        r#"E0117 m.toml:9:21: body[0].prior.mass_kg (body "bus") = 0.0: one sigma must be greater than zero; give a positive number"#,
    ),
    (
        r#"noise_rad_s = 1.0e-4"#,
        r#"noise_rad = 1.0e-4"#,
        r#"E0105 m.toml:35:13: sensor[0].noise_rad (sensor "gyro") = 1.0e-4: wrong unit for a sensor of type "gyro"; write noise_rad_s"#,
    ),
    (
        r#"quantisation_rad = 2.4e-5"#,
        r#"quantisation_m = 2.4e-5"#,
        r#"accepted, notes ["line 38: sensor[1].type (sensor \"encoders\"): the sensor has no effect: there is nothing that it could read"]"#,
    ),
    (
        r#"quantisation_rad = 2.4e-5"#,
        r#"quantisation_rad = -1.0"#,
        r#"E0118 m.toml:39:20: sensor[1].quantisation_rad (sensor "encoders") = -1.0: the quantisation must be greater than zero; give a positive number"#,
    ),
    (
        r#"quantisation_rad = 2.4e-5"#,
        r#"quantisation_rad_s = 2.4e-5"#,
        r#"E0105 m.toml:39:22: sensor[1].quantisation_rad_s (sensor "encoders") = 2.4e-5: wrong unit for a sensor of type "joint_position"; write quantisation_rad or quantisation_m"#,
    ),
    (
        r#"quantisation_rad = 2.4e-5"#,
        r#"quantisation_rad = 2.4e-5
position_m = [0.0, 0.0, 0.0]"#,
        r#"E0118 m.toml:40:14: sensor[1].position_m (sensor "encoders") = [0.0, 0.0, 0.0]: a sensor of type "joint_position" has no axes and no place; remove it"#,
    ),
    (
        r#"quantisation_rad = 2.4e-5"#,
        r#"noise_rad = [1.0, 1.0, 1.0]"#,
        r#"E0118 m.toml:39:13: sensor[1].noise_rad (sensor "encoders") = [1.0, 1.0, 1.0]: a sensor of type "joint_position" has no axes; write one number"#,
    ),
    (
        r#"noise_rad_s = 1.0e-4"#,
        r#"noise_rad_s = 0.0"#,
        r#"E0118 m.toml:35:15: sensor[0].noise_rad_s (sensor "gyro") = 0.0: the noise must be greater than zero; give a positive number"#,
    ),
    (
        r#"noise_rad_s = 1.0e-4"#,
        r#"noise_rad_s = [1.0e-4, -1.0e-4, 1.0e-4]"#,
        r#"E0118 m.toml:35:24: sensor[0].noise_rad_s[1] (sensor "gyro") = -1.0e-4: the noise must be greater than zero; give a positive number"#,
    ),
    (
        r#"noise_rad_s = 1.0e-4"#,
        r#"noise_rad_s = [[1.0, 2.0, 0.0], [2.0, 1.0, 0.0], [0.0, 0.0, 1.0]]"#,
        r#"E0118 m.toml:35:15: sensor[0].noise_rad_s (sensor "gyro") = [[1.0, 2.0, 0.0], [2.0, 1.0, 0.0], [0.0, 0.0, 1.0]]: the matrix is not symmetric and positive definite: eigenvalues -1, 1, 3; write the symmetric square root S of the covariance S S"#,
    ),
    (
        r#"noise_rad_s = 1.0e-4"#,
        r#"noise_rad_s = [[1.0, 0.5, 0.0], [0.2, 1.0, 0.0], [0.0, 0.0, 1.0]]"#,
        r#"E0118 m.toml:35:15: sensor[0].noise_rad_s (sensor "gyro") = [[1.0, 0.5, 0.0], [0.2, 1.0, 0.0], [0.0, 0.0, 1.0]]: the matrix is not symmetric and positive definite: eigenvalues 0.65, 1, 1.35; write the symmetric square root S of the covariance S S"#,
    ),
    (
        r#"noise_rad_s = 1.0e-4"#,
        r#"noise_deg_s = 1.0e-4"#,
        r#"E0105 m.toml:35:1: sensor[0].noise_deg_s (sensor "gyro") = 1.0e-4: wrong unit; write noise_rad_s and convert the number"#,
    ),
    (
        r#"noise_rad_s = 1.0e-4"#,
        r#"noise = 1.0e-4"#,
        r#"E0105 m.toml:35:1: sensor[0].noise (sensor "gyro") = 1.0e-4: missing unit; write noise_rad_s"#,
    ),
    (
        r#"noise_rad_s = 1.0e-4"#,
        r#"noise_rad_s = 1.0e-4
of = "joint1""#,
        r#"E0118 m.toml:36:6: sensor[0].of (sensor "gyro") = "joint1": a sensor of type "gyro" reads no joint, wheel or thruster; remove it"#,
    ),
    (
        r#"noise_rad_s = 1.0e-4"#,
        r#"noise_rad_s = 1.0e-4
bias = { sigma_rad = 1.0e-5 }"#,
        r#"E0105 m.toml:36:22: sensor[0].bias.sigma_rad (sensor "gyro") = 1.0e-5: wrong unit; write sigma_rad_s here"#,
    ),
    (
        r#"noise_rad_s = 1.0e-4"#,
        r#"noise_rad_s = 1.0e-4
lag = { sigma_s = -0.1 }"#,
        r#"E0118 m.toml:36:19: sensor[0].lag.sigma_s (sensor "gyro") = -0.1: one sigma must be greater than zero; give a positive number"#,
    ),
    (
        r#"name = "test""#,
        r#"name = "test"
environment = { gravity = "point_mass" }"#,
        r#"E0106 m.toml:3:15: environment.gm_m3_s2: the key is missing with gravity = "point_mass"; add it: 3.986004418e14 for the Earth"#,
    ),
    (
        r#"name = "test""#,
        r#"name = "test"
environment = { gravity_gradient = true }"#,
        r#"E0106 m.toml:3:36: environment.gravity_gradient = true: a gravity gradient without gravity; add gravity = "point_mass" and gm_m3_s2, or remove it"#,
    ),
    (
        r#"name = "test""#,
        r#"name = "test"
momentum = { linear_N_s = "zeros" }"#,
        r#"E0107 m.toml:3:27: momentum.linear_N_s = "zeros": the word is not one of those allowed here; write "estimate", "zero" or a list of 3 numbers; did you mean "zero"?"#,
    ),
    (
        r#"name = "test""#,
        r#"name = "test"
momentum = { linear = "zero" }"#,
        r#"E0105 m.toml:3:14: momentum.linear = "zero": missing unit; write linear_N_s"#,
    ),
    (
        r#"name = "test""#,
        r#"name = "test"
telemetry.columns = { omgea_x = { column = "w", unit = "deg/s" } }"#,
        r#"E0111 m.toml:3:33: telemetry.columns.omgea_x = { column = "w", unit = "deg/s" }: this vehicle has no channel of this name; did you mean omega_x?"#,
    ),
    (
        r#"name = "test""#,
        r#"name = "test"
telemetry.columns = { omega_x = { column = "w" } }"#,
        r#"E0106 m.toml:3:33: telemetry.columns.omega_x.unit: the key is missing; add unit: Unit of the column, for example "deg/s""#,
    ),
    (
        r#"name = "test""#,
        r#"name = "test"
telemetry.where = { log = 3 }"#,
        r#"E0107 m.toml:3:27: telemetry.where.log = 3: a number stands where another type is needed; write text in quotes"#,
    ),
    (
        r#"mass_kg = 12.0
com_m = [0.0, 0.0, 0.15]"#,
        r#"mass = 12.0
com_m = "here"
colour = "red""#,
        r#"E0105 m.toml:11:1: body[1].mass (body "link1") = 12.0: missing unit; write mass_kg
E0107 m.toml:12:9: body[1].com_m (body "link1") = "here": text stands where another type is needed; write a list of 3 numbers
E0104 m.toml:13:1: body[1].colour (body "link1") = "red": unknown key; remove it; known here: name, mass_kg, com_m, inertia_kg_m2, estimate, prior"#,
    ),
];

#[test]
fn exact_every_refusal_says_where_what_and_what_to_do() {
    let mut wrong = String::new();
    for (from, to, expected) in CASES {
        assert_eq!(GOOD.matches(from).count(), 1, "{from} must occur once");
        let message = match parse_model(&GOOD.replacen(from, to, 1), "m.toml") {
            Ok(model) => format!("accepted, notes {:?}", model.notes),
            Err(error) => error.to_string(),
        };
        if message != *expected {
            wrong.push_str(&format!("<<<{from}|||{to}|||{message}>>>\n"));
        }
    }
    assert!(wrong.is_empty(), "{wrong}");
}

#[test]
fn unit_the_unchanged_file_is_accepted() {
    let model = parse_model(GOOD, "m.toml").unwrap();
    assert_eq!(model.bodies.len(), 2);
    assert_eq!(model.notes, Vec::<String>::new());
    assert_eq!(model.sensors[1].of, [0]);
}
