//! Model files of test vehicles, one statement a table.
//!
//! ```
//! use poinsot_testkit::vehicles::ModelText;
//!
//! let model = ModelText::new("box")
//!     .body("box", 40.0, [0.0; 3], [2.0, 2.6, 3.1, 0.1, 0.0, 0.2], "estimate = true")
//!     .sensor("gyro", "gyro", "noise_rad_s = 1.0e-4")
//!     .text();
//! assert!(model.contains("[[body]]\nname = \"box\"\nmass_kg = 40.0\n"));
//! ```

use std::fmt::Write;

/// The text of a model file (`poinsot.model/1`) with `exact = true`; lengths in m, masses in kg.
#[derive(Debug, Clone)]
pub struct ModelText(String);

impl ModelText {
    /// A model of this name without bodies.
    pub fn new(name: &str) -> Self {
        Self(format!(
            "schema = \"poinsot.model/1\"\nexact = true\nname = \"{name}\"\n"
        ))
    }

    /// A body; its inertia about the mass centre is xx, yy, zz, xy, xz, yz. `rest` are further lines.
    #[must_use]
    pub fn body(self, name: &str, mass: f64, com: [f64; 3], inertia: [f64; 6], rest: &str) -> Self {
        let [xx, yy, zz, xy, xz, yz] = inertia;
        let keys = format!(
            "mass_kg = {mass:?}\ncom_m = {com:?}\ninertia_kg_m2 = {{ xx = {xx:?}, yy = {yy:?}, zz = {zz:?}, xy = {xy:?}, xz = {xz:?}, yz = {yz:?} }}\n{rest}"
        );
        self.table("body", name, &keys)
    }

    /// A joint of this type at a place of its parent. `rest` has its axis and further lines.
    #[must_use]
    pub fn joint(
        self,
        (name, kind): (&str, &str),
        [parent, child]: [&str; 2],
        origin: [f64; 3],
        rest: &str,
    ) -> Self {
        let keys = format!(
            "type = \"{kind}\"\nparent = \"{parent}\"\nchild = \"{child}\"\norigin_m = {origin:?}\n{rest}"
        );
        self.table("joint", name, &keys)
    }

    /// A wheel.
    #[must_use]
    pub fn wheel(self, name: &str, body: &str, axis: [f64; 3], spin_inertia: f64) -> Self {
        let keys =
            format!("body = \"{body}\"\naxis = {axis:?}\nspin_inertia_kg_m2 = {spin_inertia:?}");
        self.table("wheel", name, &keys)
    }

    /// A thruster.
    #[must_use]
    pub fn thruster(self, name: &str, body: &str, at: [f64; 3], direction: [f64; 3]) -> Self {
        let keys =
            format!("body = \"{body}\"\nposition_m = {at:?}\nforce_direction = {direction:?}");
        self.table("thruster", name, &keys)
    }

    /// A sensor of this type. `rest` has its noise and further lines.
    #[must_use]
    pub fn sensor(self, name: &str, kind: &str, rest: &str) -> Self {
        self.table("sensor", name, &format!("type = \"{kind}\"\n{rest}"))
    }

    /// The text.
    pub fn text(self) -> String {
        self.0
    }

    fn table(mut self, kind: &str, name: &str, keys: &str) -> Self {
        // A text grows without an error.
        let _ = writeln!(self.0, "[[{kind}]]\nname = \"{name}\"\n{keys}");
        self
    }
}

/// A tug of 60 kg with unknown numbers, and its arm of 4 kg with known ones on a hinge `elbow`.
pub fn tug_with_arm() -> ModelText {
    ModelText::new("tug with arm")
        .body(
            "bus",
            60.0,
            [0.03, -0.02, 0.05],
            [8.2, 9.5, 11.0, 0.35, -0.2, 0.4],
            "estimate = true",
        )
        .body(
            "arm",
            4.0,
            [0.3, 0.0, 0.0],
            [0.02, 0.2, 0.2, 0.0, 0.0, 0.0],
            "",
        )
        .joint(
            ("elbow", "revolute"),
            ["bus", "arm"],
            [0.3, 0.1, 0.2],
            "axis = [0.0, 0.0, 1.0]",
        )
}
