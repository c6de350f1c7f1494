//! Bytes as an XML file into which mass properties are written.

use poinsot_model::{
    BodyProperties, Measured, PartNumber, Patch, patch_mjcf, patch_sdf, patch_urdf,
};
use poinsot_spatial::{MassProperties, Matrix3, Vector3};

/// Bytes as a URDF, SDF or MJCF file. Written twice is as written once.
pub fn xml(bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else {
        return;
    };
    let bus = BodyProperties {
        body: "bus".to_owned(),
        properties: MassProperties {
            mass: 10.0,
            p_BoBcm_B: Vector3::new(0.1, 0.2, 0.3),
            I_BBcm_B: Matrix3::from_diagonal(&Vector3::new(1.0, 2.0, 2.5)),
        },
    };
    let stiffness = PartNumber {
        part: "bus".to_owned(),
        key: "stiffness_N_m_per_rad".to_owned(),
        component: None,
        value: 2.0,
    };
    let measured = Measured {
        bodies: vec![bus],
        numbers: vec![stiffness],
    };
    let patches: [Patch; 3] = [patch_urdf, patch_sdf, patch_mjcf];
    for patch in patches {
        if let Ok(once) = patch(text, &measured) {
            assert_eq!(patch(&once.text, &measured), Ok(once), "{text}");
        }
    }
}
