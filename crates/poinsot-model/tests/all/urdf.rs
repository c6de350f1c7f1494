//! Mass properties read from URDF: tensor elements about the mass centre, in the axes of `<inertial>`.

use poinsot_model::parse_urdf;
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
