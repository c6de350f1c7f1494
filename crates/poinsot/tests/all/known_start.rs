//! A record whose start is known: no momentum, and no sensor that an attitude or position would matter to.

use poinsot::case::parse_case;
use poinsot::identify::Question;
use poinsot::identify_tables;
use poinsot::simulate::simulate_case;
use poinsot_identify::Status;
use poinsot_model::parse_model;
use poinsot_testkit::vehicles::ModelText;

const CASE: &str = r#"
schema = "poinsot.case/2"
model = "m.toml"
duration_s = 20.0
[initial]
omega_rad_s = [0.0, 0.0, 0.0]
[[wheel_motion]]
wheel = "wheel"
time_s = [0.0, 10.0, 20.0]
speed_rad_s = [0.0, 50.0, 20.0]
[output]
rate_hz = 5
sensors_only = true
seed = 1
"#;

/// No start is unknown, so nothing can restart: the diagnosis has no column for it. One element of the tensor follows
/// from `I_zz w_z + J_s W = 0`, the other two of its column from the axes that stay at rest.
#[test]
fn exact_a_known_start_is_answered_and_diagnosed() {
    let text = ModelText::new("box")
        .body(
            "box",
            10.0,
            [0.0; 3],
            [1.0, 2.0, 2.5, 0.0, 0.0, 0.0],
            "estimate = [\"inertia\"]",
        )
        .wheel("wheel", "box", [0.0, 0.0, 1.0], 0.01)
        .sensor("gyro", "gyro", "noise_rad_s = 1.0e-4")
        .text();
    let start = "[momentum]\nlinear_N_s = [0.0, 0.0, 0.0]\nangular_N_m_s = [0.0, 0.0, 0.0]\n";
    let model = parse_model(&(text + start), "m.toml").unwrap();
    let case = parse_case("c.toml".as_ref(), CASE.to_owned()).unwrap();
    let table = simulate_case(&case, &model).unwrap().table;
    let answer = identify_tables(model, vec![table], &Question::by("maximum_likelihood")).unwrap();
    assert_eq!(answer.estimate.status, Status::Partial);
    assert_eq!(answer.estimate.identifiability.rank, 3);
    assert!(answer.estimate.diagnostics.is_some());
    let zz = answer.estimate.bodies[0].inertia[5];
    let (value, sigma) = (zz.value.unwrap(), zz.sigma.unwrap());
    assert!(
        (value - 2.5).abs() < 4.0 * sigma && sigma < 0.01,
        "{value} {sigma}"
    );
}
