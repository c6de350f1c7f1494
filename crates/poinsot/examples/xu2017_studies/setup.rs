//! The robot of the paper and its seven runs, as the shipped example has them.

use poinsot::bind::{Bound, acceleration_channels, bind};
use poinsot::identify::read_options;
use poinsot_dynamics::{Kinematics, Tree};
use poinsot_identify::Problem;
use poinsot_model::{Model, read_model};
use poinsot_spatial::{InertialParameters, MassProperties};
use poinsot_telemetry::{Table, read};
use std::path::{Path, PathBuf};

pub fn examples() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples")
}

/// Model, tree and bound telemetry.
pub struct Data {
    pub model: Model,
    pub tree: Tree,
    pub bound: Bound,
}

impl Data {
    pub fn new(model: Model, tables: &[Table]) -> Self {
        let tree = Tree::new(&model);
        let bound = bind(&model, &tree, tables).expect("the example binds");
        Self { model, tree, bound }
    }

    pub fn problem(&self) -> Problem<'_> {
        Problem {
            model: &self.model,
            tree: &self.tree,
            segments: &self.bound.segments,
            noise: &self.bound.noise,
            relative_accuracy: 1.0,
        }
    }
}

pub fn model(path: &str) -> Model {
    read_model(examples().join(path)).expect("the example is there")
}

/// The runs named, each one segment.
pub fn runs(model: &Model, names: &[&str]) -> Vec<Table> {
    let mut options = read_options(model, &model.telemetry, false, false);
    if let Some(wanted) = &mut options.wanted {
        wanted.extend(acceleration_channels());
    }
    let path = |name: &&str| examples().join(format!("xu2017/{name}/telemetry.parquet"));
    names
        .iter()
        .map(|n| read(&[path(n)], &options).expect("the run is there"))
        .collect()
}

/// Samples taken for the swarms of many seeds: every fifth, 0.25 s apart, so that the firings of 5 s still begin
/// and end on a sample. The runs are free of noise.
pub const EVERY: usize = 5;

pub const ALL: [&str; 7] = ["C1", "C2", "C3", "C4", "C5", "C6", "C7"];

/// The nominal model, 2 to 6 % off, with the runs named.
pub fn data(names: &[&str]) -> Data {
    let model = model("xu2017/model.toml");
    let tables = runs(&model, names);
    Data::new(model, &tables)
}

/// True bodies: the numbers of Table 1.
pub fn truth() -> Vec<InertialParameters> {
    let model = model("cases/xu2017_truth.toml");
    model
        .bodies
        .iter()
        .map(|b| b.nominal.parameters())
        .collect()
}

pub fn properties(bodies: &[InertialParameters]) -> Vec<MassProperties> {
    bodies
        .iter()
        .map(|b| b.mass_properties().unwrap_or(MassProperties::ZERO))
        .collect()
}

/// All bodies as one in the normal configuration.
pub fn whole(tree: &Tree, bodies: &[InertialParameters]) -> MassProperties {
    let mut kinematics = Kinematics::new(tree);
    kinematics.place(tree, &vec![0.0; tree.dof()]);
    let c = poinsot_dynamics::composite(bodies, &kinematics);
    MassProperties {
        mass: c.mass,
        p_BoBcm_B: c.p_BoScm_B(),
        I_BBcm_B: c.I_SScm_B(),
    }
}

/// The example's model with the true numbers as nominal ones, every body unknown.
pub fn all_unknown(example: &Model) -> Model {
    let mut model = example.clone();
    for (body, pi) in model.bodies.iter_mut().zip(truth()) {
        body.nominal = pi.mass_properties().unwrap_or(MassProperties::ZERO);
    }
    model
}

/// Every n-th sample.
pub fn thinned(mut tables: Vec<Table>, every: usize) -> Vec<Table> {
    for channel in tables.iter_mut().flat_map(|t| &mut t.channels) {
        channel.time_s = channel.time_s.iter().copied().step_by(every).collect();
        channel.values = channel.values.iter().copied().step_by(every).collect();
    }
    tables
}

/// The value below which a share of the list lies.
pub fn fraction(list: &[f64], share: f64) -> f64 {
    let mut sorted = list.to_vec();
    sorted.sort_by(f64::total_cmp);
    let at = share * (sorted.len().max(1) - 1) as f64;
    sorted.get(at.round() as usize).copied().unwrap_or(f64::NAN)
}
