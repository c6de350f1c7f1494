//! Mass properties in XML files of other programs: whole texts, written by hand.

use poinsot_model::{BodyProperties, Patch, patch_mjcf, patch_sdf, patch_urdf};
use poinsot_spatial::{MassProperties, Matrix3, Vector3};

fn bus() -> [BodyProperties; 1] {
    [BodyProperties {
        body: "bus".to_owned(),
        properties: MassProperties {
            mass: 10.0,
            p_BoBcm_B: Vector3::new(0.1, 0.2, 0.3),
            I_BBcm_B: Matrix3::new(1.0, 0.125, 0.0, 0.125, 2.0, 0.25, 0.0, 0.25, 2.5),
        },
    }]
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
