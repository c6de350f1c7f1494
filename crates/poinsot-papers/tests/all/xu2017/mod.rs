//! Xu, Hu, Zhang and Liang 2017: both steps against closed forms, MuJoCo, the printed tables; refusals.

mod bodies;
mod claims;
mod messages;
mod uses;

use poinsot::case::read_case;
use poinsot::identify::identify_tables;
use poinsot::simulate::simulate_case;
use poinsot::study::Verbs;
use poinsot::validate::{Mover, compare_motion};
use poinsot::{Identified, Question};
use poinsot_identify::{Estimate, Status, linear};
use poinsot_model::{EstimateSet, Model, read_model};
use poinsot_papers::study::{Context, without_translation};
use poinsot_papers::xu2017::studies::robot::{
    ALL, ARM, Data, IDENTIFIED, Null, Robot, errors, printed_bodies, properties, thinned,
};
use poinsot_papers::xu2017::studies::{RATE, largest_coefficients, together};
use poinsot_papers::xu2017::swarm::Swarm;
use poinsot_papers::xu2017::{Form, Kind, Order, Solver, particle, sequence};
use poinsot_spatial::{InertialParameters, MassProperties, Vector3};
use poinsot_telemetry::Table;
use std::path::{Path, PathBuf};
use std::sync::LazyLock;

fn shipped() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data")
}

/// Input of the studies.
fn context() -> Context<'static> {
    static SHIPPED: LazyLock<PathBuf> = LazyLock::new(shipped);
    Context {
        data: &SHIPPED,
        tools: &Verbs,
    }
}

fn robot() -> Robot<'static> {
    Robot::new(&context()).unwrap()
}

pub(crate) fn truth() -> Vec<InertialParameters> {
    robot().truth
}

fn model(path: &str) -> Model {
    read_model(shipped().join(path)).unwrap()
}

fn runs(model: &Model, names: &[&str]) -> Vec<Table> {
    robot().runs(model, names).unwrap()
}

fn bound(model: Model, tables: &[Table]) -> Data {
    Data::new(&context(), model, tables).unwrap()
}

fn request(method: &str, variant: Option<&str>) -> Question {
    Question {
        variant: variant.map(str::to_owned),
        ..Question::by(method)
    }
}

/// One of the 52 combinations is known to 1.7 of nominal by the declared noise, which the records do not have.
const ACCURACY: f64 = 2.0;

fn ask(model: &Model, tables: Vec<Table>, variant: &str) -> Identified {
    let question = Question {
        relative_accuracy: ACCURACY,
        ..request("xu2017", Some(variant))
    };
    identify_tables(model.clone(), tables, &question).unwrap()
}

/// Our own run of C1, with angular acceleration and specific force as in the paper's simulation.
fn own_single_body() -> (Model, Table) {
    let case = read_case(&shipped().join("cases/xu2017_c1.toml")).unwrap();
    let mut exact = read_model(&case.model).unwrap();
    exact.sensors.clear();
    let table = simulate_case(&case, &exact).unwrap().table;
    (model("xu2017/model.toml"), table)
}

/// Relative errors of the ten numbers of the locked robot.
fn worst_of_whole(estimate: &Estimate, total: &MassProperties) -> f64 {
    let (worst, n) = errors(&estimate.system.as_ref().unwrap().0, total);
    assert_eq!(n, 10);
    worst
}

fn total() -> MassProperties {
    robot().whole()
}

/// Largest error of the 52 combinations, in natural units of the leading terms.
fn worst_combination(e: &Estimate, found_truth: &[InertialParameters]) -> f64 {
    let value = |name: &str| {
        let (body, what) = name.split_once('.').unwrap();
        let b = e.bodies.iter().position(|x| x.name == body).unwrap();
        let names = [
            "m", "mc_x", "mc_y", "mc_z", "I_BBo_xx", "I_BBo_xy", "I_BBo_yy", "I_BBo_xz",
            "I_BBo_yz", "I_BBo_zz",
        ];
        let p = found_truth[b].mass_properties().unwrap();
        if let Some(element) = what.strip_prefix("I_BBcm_") {
            // The tensor of a body with known mass and mass centre.
            let at = (0..6).find(|&k| poinsot_identify::tensor_name(k) == element);
            let inertia = p.I_BBcm_B[poinsot_identify::TENSOR[at.unwrap()]];
            return (inertia, p.mass * p.radius_of_gyration().powi(2));
        }
        let k = names.iter().position(|n| *n == what).unwrap();
        let unit = [
            p.mass,
            p.mass * p.radius_of_gyration(),
            p.mass * p.radius_of_gyration().powi(2),
        ];
        (
            found_truth[b].to_array()[k],
            unit[usize::from(k > 0) + usize::from(k > 3)],
        )
    };
    let mut worst: f64 = 0.0;
    for c in &e.identifiability.determined {
        let sum: f64 = c.coefficients.iter().map(|(n, a)| a * value(n).0).sum();
        let unit = c
            .coefficients
            .iter()
            .map(|(n, a)| (a * value(n).1).abs())
            .fold(0.0, f64::max);
        worst = worst.max((c.value - sum).abs() / unit);
    }
    worst
}

/// Unobservable directions of the runs C1 to C7.
pub(crate) fn linear_null() -> Null {
    let full = robot().data(&ALL).unwrap();
    Null::new(&linear(&full.problem()).unwrap(), &properties(&truth()))
}
