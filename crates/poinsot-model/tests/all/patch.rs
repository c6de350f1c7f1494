//! Mass properties in XML files of other programs: whole texts, written by hand.

use poinsot_model::{
    BodyProperties, Measured, PartNumber, Patch, patch_mjcf, patch_model, patch_sdf, patch_urdf,
};
use poinsot_spatial::{MassProperties, Matrix3, Vector3};

fn bus() -> Measured {
    let bus = BodyProperties {
        body: "bus".to_owned(),
        properties: MassProperties {
            mass: 10.0,
            p_BoBcm_B: Vector3::new(0.1, 0.2, 0.3),
            I_BBcm_B: Matrix3::new(1.0, 0.125, 0.0, 0.125, 2.0, 0.25, 0.0, 0.25, 2.5),
        },
    };
    Measured {
        bodies: vec![bus],
        ..Measured::default()
    }
}

fn written(patch: Patch, text: &str) -> String {
    let patched = patch(text, &bus()).unwrap();
    assert_eq!(patched.missing, [""; 0]);
    patched.text
}

#[test]
fn exact_sdf_with_empty_elements_is_filled() {
    let text = "<?xml version='1.0'?>\r\n<!-- a < b --><sdf version=\"1.9\"><model name='m' ><link name = 'bus' >\r\n\t<inertial auto=\"true\"><pose degrees='true'>0 0 0 90 0 0</pose><mass/><inertia/></inertial></link ><link name=\"arm\"/></model></sdf>\n";
    let expected = "<?xml version='1.0'?>\r\n<!-- a < b --><sdf version=\"1.9\"><model name='m' ><link name = 'bus' >\r\n\t<inertial><pose>0.1 0.2 0.3 0 0 0</pose><mass>10.0</mass><inertia><ixx>1.0</ixx><ixy>0.125</ixy><ixz>0.0</ixz><iyy>2.0</iyy><iyz>0.25</iyz><izz>2.5</izz></inertia></inertial></link ><link name=\"arm\"/></model></sdf>\n";
    assert_eq!(written(patch_sdf, text), expected);
}

#[test]
fn exact_mjcf_keeps_the_prefix_of_its_elements() {
    let text = "<m:mujoco xmlns:m='urn:m'><m:worldbody><m:body name='bus'><m:geom size='1 1 1'/><m:body name='arm'/></m:body></m:worldbody></m:mujoco>";
    assert_eq!(
        written(patch_mjcf, text),
        "<m:mujoco xmlns:m='urn:m'><m:worldbody><m:body name='bus'><m:inertial pos=\"0.1 0.2 0.3\" mass=\"10.0\" fullinertia=\"1.0 2.0 2.5 0.125 0.0 0.25\"/><m:geom size='1 1 1'/><m:body name='arm'/></m:body></m:worldbody></m:mujoco>"
    );
}

#[test]
fn exact_urdf_attributes_have_any_order_and_quotes() {
    let text = "\u{feff}<robot name='a\"b' note=\"&lt;\"><link name='bus'><inertial>\n<inertia izz='9' iyz='0' ixx='9' iyy='9'\n ixz='0' ixy='0' unit='\"'/><origin rpy='0 0 0' xyz='9 9 9'/><mass note='old' value='9' /></inertial></link></robot>";
    assert_eq!(
        written(patch_urdf, text),
        "\u{feff}<robot name='a\"b' note=\"&lt;\"><link name='bus'><inertial>\n<inertia izz='2.5' iyz='0.25' ixx='1.0' iyy='2.0'\n ixz='0.0' ixy='0.125' unit='\"'/><origin rpy='0 0 0' xyz='0.1 0.2 0.3'/><mass note='old' value='10.0' /></inertial></link></robot>"
    );
}

#[test]
fn exact_urdf_is_written_in_the_axes_of_its_inertial() {
    let quarter = std::f64::consts::FRAC_PI_2;
    let text = format!(
        "<robot><link name='bus'><inertial><origin rpy='0 0 {quarter:?}'/></inertial></link></robot>"
    );
    // About z by 90 degrees: x of the inertial is y of the link, and y is -x.
    let found = written(patch_urdf, &text);
    let number = |name: &str| {
        let value = found.split(&format!("{name}=\"")).nth(1).unwrap();
        value.split('"').next().unwrap().parse::<f64>().unwrap()
    };
    for (name, expected) in [
        ("ixx", 2.0),
        ("ixy", -0.125),
        ("ixz", 0.25),
        ("iyy", 1.0),
        ("iyz", 0.0),
        ("izz", 2.5),
    ] {
        assert!((number(name) - expected).abs() < 1e-15, "{name}: {found}");
    }
}

#[test]
fn regress_what_would_not_be_read_back_is_refused() {
    let cases: [(Patch, &str); 4] = [
        (
            patch_urdf,
            "<robot><link name='bus'><inertial><mass value='1'/><mass value='2'/></inertial></link></robot>",
        ),
        (
            patch_urdf,
            "<robot><link name='bus'><inertial/><inertial/></link></robot>",
        ),
        (
            patch_urdf,
            "<robot><link name='bus'><inertial><origin rpy='0 zero 0'/></inertial></link></robot>",
        ),
        (
            patch_sdf,
            "<sdf><link name='bus'><inertial><inertia><ixx>1</ixx><ixx>2</ixx></inertia></inertial></link></sdf>",
        ),
    ];
    for (patch, text) in cases {
        let error = patch(text, &bus()).unwrap_err();
        assert!(error.contains("\"bus\": the new mass"), "{text}: {error}");
    }
}

#[test]
fn exact_several_elements_of_a_name_are_missing() {
    let twice = "<robot><link name='bus'/><link name='bus'/></robot>";
    let inside = "<robot><gazebo><link name='bus'/></gazebo></robot>";
    for text in [twice, inside] {
        let patched = patch_urdf(text, &bus()).unwrap();
        assert_eq!((patched.text.as_str(), patched.missing.len()), (text, 1));
    }
}

fn spring() -> Measured {
    let number = |(key, value): (&str, f64)| PartNumber {
        part: "hinge".to_owned(),
        key: key.to_owned(),
        component: None,
        value,
    };
    let numbers = [
        ("stiffness_N_m_per_rad", 8.5),
        ("damping_N_m_s_per_rad", 0.25),
        ("rest_rad", 0.5),
    ];
    Measured {
        numbers: numbers.map(number).into(),
        ..Measured::default()
    }
}

#[test]
fn exact_springs_of_joints_stand_where_a_format_has_them() {
    let mjcf = |compiler: &str, kind: &str, rest: &str| {
        let text = format!(
            "<mujoco>{compiler}<body name='p'><joint name='hinge' stiffness='1'{kind}/><joint name='other'/></body></mujoco>"
        );
        let expected = text.replace(
            &format!("stiffness='1'{kind}"),
            &format!("stiffness='8.5'{kind} damping=\"0.25\" springref=\"{rest}\""),
        );
        let patched = patch_mjcf(&text, &spring()).unwrap();
        assert_eq!(patched.text, expected);
        assert!(patched.parts.contains("hinge"));
    };
    mjcf("", "", &format!("{:?}", 0.5_f64.to_degrees()));
    mjcf("<compiler angle=\"radian\"/>", "", "0.5");
    mjcf("", " type='slide'", "0.5");
    let sdf = "<sdf><joint name='hinge'><axis><xyz>1 0 0</xyz><dynamics><friction>0</friction><damping>9</damping></dynamics></axis></joint></sdf>";
    let patched = patch_sdf(sdf, &spring()).unwrap();
    assert_eq!(
        patched.text,
        "<sdf><joint name='hinge'><axis><xyz>1 0 0</xyz><dynamics><spring_reference>0.5</spring_reference><spring_stiffness>8.5</spring_stiffness><friction>0</friction><damping>0.25</damping></dynamics></axis></joint></sdf>"
    );
    // Two springs in one joint: which one counts is not for us to say.
    let twice = sdf.replace("</axis>", "<dynamics/></axis>");
    assert!(patch_sdf(&twice, &spring()).unwrap_err().contains("hinge"));
    let urdf = patch_urdf("<robot><joint name='hinge'/></robot>", &spring()).unwrap();
    assert!(urdf.parts.is_empty());
}

#[test]
fn exact_springs_and_modes_of_a_model_file_are_replaced() {
    let text = r#"[[body]]
name = "bus"

[[joint]]
name = "hinge"
spring_damper = { stiffness_N_m_per_rad = 1.0, estimate = true } # guessed

[[mode]]
name = "boom"
frequency_Hz = 0.5   # of the drawing
rotation_kg05_m = [0.0, 1.0, 0.0]
"#;
    let mut measured = spring();
    let mode = |(key, component, value): (&str, Option<&str>, f64)| PartNumber {
        part: "boom".to_owned(),
        key: key.to_owned(),
        component: component.map(str::to_owned),
        value,
    };
    let numbers = [
        ("frequency_Hz", None, 0.75),
        ("rotation_kg05_m", Some("y"), 2.0),
        ("translation_kg05", Some("x"), 0.5),
        ("inertia_slope_kg05_m", Some("xy"), 0.125),
    ];
    measured.numbers.extend(numbers.map(mode));
    let patched = patch_model(text, &measured).unwrap();
    let expected = text
        .replace("stiffness_N_m_per_rad = 1.0", "stiffness_N_m_per_rad = 8.5")
        .replace(
            "= true }",
            "= true , damping_N_m_s_per_rad = 0.25, rest_rad = 0.5 }",
        )
        .replace("0.5   #", "0.75   #")
        .replace("1.0, 0.0]", "2.0, 0.0]")
        + "translation_kg05 = [0.5, 0.0, 0.0]\ninertia_slope_kg05_m = { xy = 0.125 }\n";
    assert_eq!(patched.text, expected);
    assert_eq!(Vec::from_iter(patched.parts), ["boom", "hinge"]);
}
