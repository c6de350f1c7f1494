//! Refusals of bodies.

use crate::refusals::Case;

pub const CASES: &[Case] = &[
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
        r#"mass_kg = 12.0"#,
        r#"mass_kg = "12.0""#,
        r#"E0107 m.toml:11:11: body[1].mass_kg (body "link1") = "12.0": text is here, but another type is needed; write a number"#,
    ),
    (
        r#"com_m = [0.0, 0.0, 0.15]"#,
        r#"com_m = [0.0, 0.15]"#,
        r#"E0107 m.toml:12:9: body[1].com_m (body "link1") = [0.0, 0.15]: the list has 2 entries; write a list of 3 numbers"#,
    ),
    (
        r#"com_m = [0.0, 0.0, 0.15]"#,
        r#"com_m = [0.0, true, 0.15]"#,
        r#"E0107 m.toml:12:15: body[1].com_m[1] (body "link1") = true: true or false is here, but another type is needed; write a number"#,
    ),
    (
        r#"com_m = [0.0, 0.0, 0.15]"#,
        r#"com_m = 2026-01-01"#,
        r#"E0107 m.toml:12:9: body[1].com_m (body "link1") = 2026-01-01: a date is here, but another type is needed; write a list of 3 numbers"#,
    ),
    (
        r#"estimate = true"#,
        r#"estimate = ["mass", "mas"]"#,
        r#"E0107 m.toml:8:21: body[0].estimate[1] (body "bus") = "mas": the word is not one of those allowed here; write "mass", "com", "inertia"; did you mean "mass"?"#,
    ),
    (
        r#"estimate = true"#,
        r#"estimate = "mass""#,
        r#"E0107 m.toml:8:12: body[0].estimate (body "bus") = "mass": text is here, but another type is needed; write true, false or a list of "mass", "com", "inertia""#,
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
        r#"name = "link1""#,
        r#"name = """#,
        r#"E0109 m.toml:10:8: body[1].name = "": the name is empty; give it a plain name
E0111 m.toml:18:9: joint[0].child (joint "joint1") = "link1": there is no body of this name; name one that a [[body]] has"#,
    ),
    (
        r#"name = "link1""#,
        r#"name = "link1\u001b[2J""#,
        r#"E0109 m.toml:10:8: body[1].name = "link1\u001b[2J": the name has an unprintable character; give it a plain name
E0111 m.toml:18:9: joint[0].child (joint "joint1") = "link1": there is no body of this name; did you mean "link1\u{1b}[2J"?"#,
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
        r#"[[joint]]
"#,
        r#"[[body]]
name = "a"
mass_kg = 1.0
com_m = [0.0, 0.0, 0.0]
inertia_kg_m2 = { xx = 1.0, yy = 1.5, zz = 1.0 }
[[joint]]
"#,
        r#"E0112 m.toml:15:8: body[2].name = "a": no joint has this body as its child: it is not connected to the base; add a [[joint]] with this child, type = "fixed" where it does not move"#,
    ),
    (
        r#"parent = "bus"
child = "link1""#,
        r#"parent = "link1"
child = "bus""#,
        r#"E0112 m.toml:10:8: body[1].name = "link1": no joint has this body as its child: it is not connected to the base; add a [[joint]] with this child, type = "fixed" where it does not move
E0112 m.toml:18:9: joint[0].child (joint "joint1") = "bus": the base has no parent; the first [[body]] is the base: name another child, or move the base to the top"#,
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
        r#"E0115 m.toml:13:17: body[1].inertia_kg_m2 (body "link1") = { xx = 0.51, yy = 0.5, zz = 1.2 }: these principal moments are not physical: 0.5, 0.51, 1.2 kg m2, the largest exceeds the sum of the other two; correct the numbers; they are tensor elements (xy = -integral x y dm) about the mass centre"#,
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
        r#"E0116 m.toml:11:11: body[1].mass_kg (body "link1") = 0.0: the body moves on joint "joint1", but neither it nor its outboard bodies have mass; give it a mass, make its joint fixed, or remove it"#,
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
        r#"E0117 m.toml:8:12: body[0].estimate (body "bus") = true: the body is to be estimated but its nominal inertia is zero; give a rough positive inertia_kg_m2: it sets the scale of the estimate"#,
    ),
    (
        r#"estimate = true"#,
        r#"estimate = true
prior = { mass_kg = 0.0 }"#,
        r#"E0117 m.toml:9:21: body[0].prior.mass_kg (body "bus") = 0.0: the mass must be greater than zero; give a positive number"#,
    ),
    (
        r#"mass_kg = 12.0
com_m = [0.0, 0.0, 0.15]"#,
        r#"mass = 12.0
com_m = "here"
colour = "red""#,
        r#"E0105 m.toml:11:1: body[1].mass (body "link1") = 12.0: missing unit; write mass_kg
E0107 m.toml:12:9: body[1].com_m (body "link1") = "here": text is here, but another type is needed; write a list of 3 numbers
E0104 m.toml:13:1: body[1].colour (body "link1") = "red": unknown key; remove it; known here: name, mass_kg, com_m, inertia_kg_m2, estimate, prior, source, exact, uncertainty"#,
    ),
];
