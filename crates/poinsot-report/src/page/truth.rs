//! True values of a simulation, if they lie next to the telemetry.

use poinsot_formats::TrueBodyFile;
use poinsot_formats::TrueNumbers;

/// True values by body.
pub(crate) struct Truth(Option<TrueNumbers>);

impl Truth {
    pub fn new(truth: Option<TrueNumbers>) -> Self {
        Self(truth)
    }

    /// Whether any truth is known.
    pub fn is_known(&self) -> bool {
        self.0.is_some()
    }

    /// The ten true values in the order of a body's table; `None` if unknown.
    pub fn body(&self, name: &str) -> [Option<f64>; 10] {
        ten(self.0.as_ref().and_then(|t| t.bodies.get(name)))
    }

    /// The ten true values of the whole vehicle.
    pub fn system(&self) -> [Option<f64>; 10] {
        ten(self.0.as_ref().and_then(|t| t.system.as_ref()))
    }
}

fn ten(body: Option<&TrueBodyFile>) -> [Option<f64>; 10] {
    let Some(body) = body else { return [None; 10] };
    let mass = &body.mass;
    let centre = mass.com_m.named().map(|(_, n)| n);
    let inertia = mass.inertia_kg_m2.named().map(|(_, n)| n);
    let mut all = std::iter::once(&mass.mass_kg).chain(centre).chain(inertia);
    std::array::from_fn(|_| all.next().map(|n| n.value))
}
