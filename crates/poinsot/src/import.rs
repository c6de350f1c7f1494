//! The command `import`: a URDF as a model file.

use crate::error::Error;
use poinsot_model::{Model, UrdfOptions, read_robot, write_model};
use std::path::Path;

/// The model of a URDF, and its model file.
///
/// # Errors
/// The URDF cannot be read, or its names or numbers violate the rules of a model file.
///
/// ```
/// let folder = tempfile::tempdir()?;
/// let urdf = folder.path().join("box.urdf");
/// let text = r#"<robot name="box"><link name="bus"><inertial><mass value="10"/>
/// <inertia ixx="1" ixy="0" ixz="0" iyy="2" iyz="0" izz="2.5"/></inertial></link></robot>"#;
/// std::fs::write(&urdf, text)?;
/// let (model, file) = poinsot::import(&urdf, &Default::default())?;
/// assert_eq!(model.bodies[0].nominal.mass, 10.0);
/// assert!(file.contains("mass_kg = 10"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn import(urdf: &Path, options: &UrdfOptions) -> Result<(Model, String), Error> {
    let model = read_robot(urdf, options)?;
    let text = write_model(&model);
    Ok((model, text))
}
