//! Mass properties read from URDF: tensor elements about the mass centre, in the axes of `<inertial>`.

use poinsot_model::{JointKind, parse_urdf};
use poinsot_spatial::{MassProperties, Matrix3, Vector3};

fn link(rpy: &str) -> Option<MassProperties> {
    let text = format!(
        r#"<robot name="r"><link name="base"><inertial>
             <origin xyz="0.1 -0.2 0.3" rpy="{rpy}"/><mass value="30"/>
             <inertia ixx="2" ixy="0.1" ixz="0.3" iyy="2.5" iyz="0.2" izz="1.5"/>
           </inertial></link></robot>"#
    );
    Some(parse_urdf(&text, "r.urdf").model.ok()?.bodies[0].nominal)
}

#[test]
fn exact_products_of_inertia_are_tensor_elements() {
    let read = link("0 0 0").unwrap();
    assert_eq!(read.mass, 30.0);
    assert_eq!(read.p_BoBcm_B, Vector3::new(0.1, -0.2, 0.3));
    let I = Matrix3::new(2.0, 0.1, 0.3, 0.1, 2.5, 0.2, 0.3, 0.2, 1.5);
    assert!((read.I_BBcm_B - I).norm() < 1e-15, "{}", read.I_BBcm_B);
}

#[test]
fn exact_a_quarter_turn_about_z_swaps_the_axes() {
    let read = link("0 0 1.5707963267948966").unwrap();
    // The tensor's x axis is the link's y, its y the link's -x: xx and yy are exchanged, xy changes sign, (xz, yz)
    // rotates as a vector.
    let I = Matrix3::new(2.5, -0.1, -0.2, -0.1, 2.0, 0.3, -0.2, 0.3, 1.5);
    assert!((read.I_BBcm_B - I).norm() < 1e-15, "{}", read.I_BBcm_B);
    assert_eq!(read.p_BoBcm_B, Vector3::new(0.1, -0.2, 0.3));
}

/// Found by fuzzing: a rotated tensor was asymmetric in its last bit and did not read back from a model file.
#[test]
fn regress_a_turned_tensor_is_symmetric_to_the_last_bit() {
    for k in 0..100 {
        let I = link(&format!(
            "0.3 {} {}",
            0.01 * f64::from(k),
            0.1 * f64::from(k)
        ))
        .unwrap()
        .I_BBcm_B;
        assert_eq!(I, I.transpose());
    }
}

/// Found by libFuzzer: a name with a leading blank was read from a URDF and rejected in the model file written from
/// it.
#[test]
fn regress_names_that_no_model_file_takes_are_refused() {
    let robot = |title: &str, link: &str, joint: &str| {
        let text = format!(
            r#"<robot name="{title}"><link name="base"><inertial><mass value="30"/>
                 <inertia ixx="2" ixy="0" ixz="0" iyy="2.5" iyz="0" izz="1.5"/></inertial></link>
               <link name="{link}"/><joint name="{joint}" type="fixed"><parent link="base"/><child link="{link}"/></joint></robot>"#
        );
        parse_urdf(&text, "r.urdf").model
    };
    let says = |link: &str, joint: &str| robot("r", link, joint).unwrap_err().to_string();
    assert_eq!(
        says("tool", " 1bo,"),
        "E0109 r.urdf:3:35: joint \" 1bo,\": the name begins or ends with a blank; give it a plain name"
    );
    let long = "a".repeat(201);
    assert!(says(&long, "j").contains("the name is longer than 200 bytes; give it a plain name"));
    let mark = says("to&#x202e;ol", "j");
    assert!(
        mark.contains("the name has an unprintable character"),
        "{mark}"
    );
    assert!(!mark.contains('\u{202e}'));
    // The title alone does not make a robot invalid.
    let model = robot(" arm", "tool", "j").unwrap();
    assert_eq!(model.name, "robot");
    poinsot_model::parse_model(&poinsot_model::write_model(&model), "m.toml").unwrap();
}

/// Found by libFuzzer: a number beyond the limit of the model file was read from a URDF and rejected in the model file
/// written from it.
#[test]
fn regress_numbers_that_no_model_file_takes_are_refused() {
    let text = r#"<robot name="r"><link name="base"><inertial><origin xyz="2.2e103 0 0"/><mass value="30"/>
        <inertia ixx="2" ixy="0" ixz="0" iyy="2.5" iyz="0" izz="1.5"/></inertial></link></robot>"#;
    assert_eq!(
        parse_urdf(text, "r.urdf").model.unwrap_err().to_string(),
        "E0107 r.urdf:1:45: link \"base\" <origin xyz> = \"2.2e103 0 0\": '2.2e103' is larger than 1e30; check its unit: all quantities are SI"
    );
}

/// Found by libFuzzer: of two masses the first was read and the second dropped.
#[test]
fn regress_an_element_that_is_stated_twice_is_refused() {
    let inertial = [
        r#"<origin xyz="0 0 0"/>"#,
        r#"<mass value="20"/>"#,
        r#"<inertia ixx="0.4" ixy="0" ixz="0" iyy="0.5" iyz="0" izz="0.6"/>"#,
    ];
    let joint = [
        r#"<parent link="base"/>"#,
        r#"<child link="head"/>"#,
        r#"<origin xyz="0 0 1"/>"#,
        r#"<axis xyz="0 0 1"/>"#,
        r#"<mimic joint="neck"/>"#,
    ];
    let read = |twice: &str| {
        let all = |parts: &[&str]| parts.concat().replace(twice, &twice.repeat(2));
        let text = format!(
            r#"<robot name="r"><link name="base"/><link name="head"><inertial>{}</inertial></link>
            <joint name="neck" type="revolute">{}</joint></robot>"#,
            all(&inertial),
            all(&joint)
        );
        parse_urdf(&text, "r.urdf").model
    };
    for (parent, parts) in [("inertial", &inertial[..]), ("joint", &joint)] {
        for part in parts {
            let name = part.split([' ', '<']).nth(1).unwrap();
            let error = read(part).unwrap_err().to_string();
            let expected = format!("<{parent}> has two <{name}>; keep one of them");
            assert!(error.contains(&expected), "{error}");
        }
    }
}

/// A base and a link, on a joint with this origin.
fn with_link(inertial: &str, origin: &str) -> Result<poinsot_model::Model, poinsot_files::Faults> {
    let text = format!(
        r#"<robot name="r"><link name="base"><inertial><mass value="20"/><inertia ixx="0.4" ixy="0" ixz="0" iyy="0.5" iyz="0" izz="0.6"/></inertial></link>
        <link name="head"><inertial>{inertial}</inertial></link>
        <joint name="neck" type="fixed"><parent link="base"/><child link="head"/><origin {origin}/></joint></robot>"#
    );
    parse_urdf(&text, "r.urdf").model
}

/// Files of programs that compute a product of inertia: 2.4e-35 on a link of 1.3 kg, and a mass of 4e-15 kg.
#[test]
fn regress_what_is_zero_but_for_rounding_is_zero() {
    let inertia =
        |x: f64| format!(r#"<inertia ixx="0" ixy="0" ixz="{x:e}" iyy="0" iyz="0" izz="0"/>"#);
    let head = |mass: &str, x: f64| {
        let inertial = format!(
            r#"<origin xyz="0.02 -0.1 0"/><mass value="{mass}"/>{}"#,
            inertia(x)
        );
        with_link(&inertial, "")
    };
    let model = head("1.3", 2.4e-35).unwrap();
    assert_eq!(model.bodies[1].nominal.I_BBcm_B, Matrix3::zeros());
    assert!(
        model.notes.iter().any(|n| n.contains("a point mass")),
        "{:?}",
        model.notes
    );
    let model = head("4e-15", 1.0e-17).unwrap();
    assert_eq!(model.bodies[1].nominal, MassProperties::ZERO);
    // What is read can be written.
    poinsot_model::parse_model(&poinsot_model::write_model(&model), "m.toml").unwrap();
    // A product of inertia that is no rounding is refused.
    assert!(
        head("1.3", 1.0e-9)
            .unwrap_err()
            .to_string()
            .starts_with("E0115 ")
    );
}

#[test]
fn unit_millimetres_degrees_and_grams_are_noticed() {
    let good = r#"<mass value="1.3"/><inertia ixx="0.002" ixy="0" ixz="0" iyy="0.002" iyz="0" izz="0.002"/>"#;
    let told = |inertial: &str, origin: &str| with_link(inertial, origin).unwrap().notes.join("\n");
    assert_eq!(told(good, r#"xyz="0.3 0 0" rpy="3.14 0 0""#), "");
    assert!(told(good, r#"xyz="300 0 0""#).contains("is it in mm?"));
    assert!(told(good, r#"rpy="0 0 90""#).contains("is it in degrees?"));
    assert!(told(&good.replace("1.3", "1300"), "").contains("is the mass in grams?"));
}

/// A base, an arm of a turning and a sliding joint, a fixed gyro and a second branch, in frames that are turned.
const ARM: &str = r#"<robot name="r"><link name="base"><inertial><origin xyz="0.1 0 -0.2" rpy="0 0.3 0"/><mass value="20"/><inertia ixx="0.4" ixy="0.02" ixz="0" iyy="0.5" iyz="0.01" izz="0.6"/></inertial></link>
    <link name="upper"><inertial><origin xyz="0 0.3 0"/><mass value="3"/><inertia ixx="0.04" ixy="0" ixz="0.001" iyy="0.05" iyz="0" izz="0.03"/></inertial></link>
    <link name="slide"><inertial><origin xyz="0.2 0 0.1" rpy="1 0 0"/><mass value="2"/><inertia ixx="0.02" ixy="0" ixz="0" iyy="0.03" iyz="0" izz="0.02"/></inertial></link>
    <link name="gyro"/>
    <link name="panel"><inertial><origin xyz="0 0 0.5"/><mass value="4"/><inertia ixx="0.2" ixy="0" ixz="0" iyy="0.2" iyz="0" izz="0.01"/></inertial></link>
    <joint name="shoulder" type="revolute"><parent link="base"/><child link="upper"/><origin xyz="0.4 0.1 -0.3" rpy="0.5 -0.7 1.1"/><axis xyz="0.6 0 0.8"/></joint>
    <joint name="rail" type="prismatic"><parent link="upper"/><child link="slide"/><origin xyz="0 0.6 0.1" rpy="-0.2 0.4 0.9"/><axis xyz="0 1 0"/></joint>
    <joint name="mount" type="fixed"><parent link="slide"/><child link="gyro"/><origin xyz="0.05 0.02 0.1" rpy="1.2 -1.5707963267948966 0.3"/></joint>
    <joint name="hinge" type="revolute"><parent link="upper"/><child link="panel"/><origin xyz="-0.3 0 0.2" rpy="0 0 2"/><axis xyz="0 1 0"/></joint></robot>"#;

/// `poinsot import` with this base.
fn with_base(base: Option<&str>) -> Result<poinsot_model::Model, poinsot_files::Faults> {
    based(ARM, base)
}

fn based(robot: &str, base: Option<&str>) -> Result<poinsot_model::Model, poinsot_files::Faults> {
    let folder = std::env::temp_dir().join(format!(
        "poinsot-base-{}-{}",
        std::process::id(),
        robot.len()
    ));
    std::fs::create_dir_all(&folder).unwrap();
    let path = folder.join(format!("{}.urdf", base.unwrap_or("root")));
    std::fs::write(&path, robot).unwrap();
    let options = poinsot_model::UrdfOptions {
        base: base.map(str::to_owned),
        ..Default::default()
    };
    let model = poinsot_model::read_robot(&path, &options);
    std::fs::remove_file(&path).unwrap();
    model
}

/// Orientation and origin of every body in the axes of the base, by the definition of a joint.
fn poses(model: &poinsot_model::Model, angles: &[(&str, f64)]) -> Vec<(Matrix3, Vector3)> {
    let mut all: Vec<(Matrix3, Vector3)> = Vec::new();
    for body in &model.bodies {
        let Some(joint) = body.joint.map(|k| &model.joints[k]) else {
            all.push((Matrix3::identity(), Vector3::zeros()));
            continue;
        };
        let (R_BP, p_BoPo) = all[joint.parent];
        let q = angles
            .iter()
            .find(|a| a.0 == joint.name)
            .map_or(0.0, |a| a.1);
        // Rodrigues' formula.
        let K = joint.axis_C.cross_matrix();
        let (turn, slide) = match joint.kind {
            JointKind::Revolute => (
                Matrix3::identity() + K * q.sin() + K * K * (1.0 - q.cos()),
                0.0,
            ),
            JointKind::Prismatic => (Matrix3::identity(), q),
            JointKind::Fixed => (Matrix3::identity(), 0.0),
        };
        let R_BC = R_BP * joint.R_PC_zero;
        all.push((
            R_BC * turn,
            p_BoPo + R_BP * joint.p_PoCo_P + R_BC * joint.axis_C * slide,
        ));
    }
    all
}

/// Mass, first moment and inertia of all bodies about the origin of one of them, in its axes.
fn whole(
    model: &poinsot_model::Model,
    poses: &[(Matrix3, Vector3)],
    about: usize,
) -> (f64, Vector3, Matrix3) {
    let (R, p) = poses[about];
    let mut sum = (0.0, Vector3::zeros(), Matrix3::zeros());
    for (body, (R_BC, p_BoCo)) in model.bodies.iter().zip(poses) {
        let own = &body.nominal;
        let turn = R.transpose() * R_BC;
        let c = R.transpose() * (p_BoCo + R_BC * own.p_BoBcm_B - p);
        sum.0 += own.mass;
        sum.1 += c * own.mass;
        let steiner = Matrix3::identity() * c.norm_squared() - c * c.transpose();
        sum.2 += turn * own.I_BBcm_B * turn.transpose() + steiner * own.mass;
    }
    sum
}

/// Every link as the base: poses of all links relative to it, and the mass properties of the whole about it, at several angles.
#[test]
fn exact_another_base_is_the_same_robot() {
    let first = with_base(None).unwrap();
    for base in ["base", "upper", "slide", "gyro", "panel"] {
        let model = with_base(Some(base)).unwrap();
        assert_eq!(model.bodies[0].name, base);
        for turn in [0.0, 0.7, -2.1] {
            let angles = [
                ("shoulder", turn),
                ("rail", 0.3 * turn),
                ("hinge", 1.0 - turn),
            ];
            let (before, after) = (poses(&first, &angles), poses(&model, &angles));
            let (R, p) = before[first.body(base).unwrap()];
            for (k, body) in first.bodies.iter().enumerate() {
                let own = model.body(&body.name).unwrap();
                assert_eq!(model.bodies[own].nominal, body.nominal);
                let turned = R.transpose() * before[k].0 - after[own].0;
                let moved = R.transpose() * (before[k].1 - p) - after[own].1;
                let off = turned.norm().max(moved.norm());
                assert!(off < 1e-14, "{base} {}: {off:.1e}", body.name);
            }
            let (old, new) = (
                whole(&first, &before, first.body(base).unwrap()),
                whole(&model, &after, 0),
            );
            let off = [
                (old.0 - new.0).abs(),
                (old.1 - new.1).norm(),
                (old.2 - new.2).norm(),
            ];
            assert!(off.iter().all(|x| *x < 1e-13), "{base}: {off:?}");
        }
    }
}

#[test]
fn unit_a_base_that_is_no_link_is_named_with_the_nearest() {
    let error = with_base(Some("gyr0")).unwrap_err().to_string();
    assert!(
        error.contains("E0111")
            && error.ends_with("--base: there is no link \"gyr0\"; did you mean \"gyro\"?"),
        "{error}"
    );
    let notes = with_base(Some("gyro")).unwrap().notes.join("\n");
    assert!(
        notes.contains("link \"rail_frame\": no <inertial>: assumed massless"),
        "{notes}"
    );
    let bent = ARM.replacen(r#"<parent link="base"/>"#, r#"<parent link="slide"/>"#, 1);
    let error = based(&bent, Some("gyro")).unwrap_err().to_string();
    assert!(error.contains("E0112"), "{error}");
}
