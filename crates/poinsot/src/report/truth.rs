//! The truth of a simulation, where it lies beside the telemetry.

use serde_json::Value;

/// True numbers by body.
pub(crate) struct Truth(Option<Value>);

impl Truth {
    pub fn new(value: Option<&Value>) -> Self {
        Self(value.cloned())
    }

    /// Whether any truth is known.
    pub fn is_known(&self) -> bool {
        self.0.is_some()
    }

    /// The ten numbers in the order of a body's table; `None` where the truth does not say.
    pub fn body(&self, name: &str) -> [Option<f64>; 10] {
        self.ten(|v| &v["bodies"][name])
    }

    /// The same of the whole vehicle.
    pub fn system(&self) -> [Option<f64>; 10] {
        self.ten(|v| &v["system"][0])
    }

    fn ten(&self, find: impl Fn(&Value) -> &Value) -> [Option<f64>; 10] {
        let Some(body) = self.0.as_ref().map(find) else {
            return [None; 10];
        };
        let com = &body["com_m"]["value"];
        let inertia = &body["inertia_kg_m2"]["value"];
        let all = [
            &body["mass_kg"]["value"],
            &com[0],
            &com[1],
            &com[2],
            &inertia["xx"],
            &inertia["yy"],
            &inertia["zz"],
            &inertia["xy"],
            &inertia["xz"],
            &inertia["yz"],
        ];
        all.map(Value::as_f64)
    }
}
