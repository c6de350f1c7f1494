//! Thresholds of the tests of an answer: each of them acts, and a value out of range is refused.

use crate::shared::sigma_factor;
use crate::trust::{STSAT3, example, with_prior};
use poinsot::bind::bind;
use poinsot::identify::read_options;
use poinsot_dynamics::Tree;
use poinsot_identify::{Effect, Estimate, ProblemError, Remark, Settings, maximum_likelihood_with};
use poinsot_model::{Model, parse_model, read_model};
use poinsot_telemetry::read;

fn asked(model: &Model, settings: Settings) -> Result<Estimate, ProblemError> {
    let options = read_options(model, &model.telemetry, false, false);
    let table = read(&[example(STSAT3)], &options).unwrap();
    let tree = Tree::new(model);
    let bound = bind(model, &tree, &[table]).unwrap();
    let problem = bound.problem(model, &tree);
    maximum_likelihood_with(&problem, settings)
}

/// Without the search for causes, which takes longer than the fit.
fn undiagnosed() -> Settings {
    Settings {
        undiagnosed: true,
        ..Settings::default()
    }
}

fn row<'a>(e: &'a Estimate, test: &str) -> &'a Remark {
    e.tests().find(|row| row.test == test).unwrap()
}

/// The gyro has three times its declared noise; white, so that a higher limit leaves it to wider sigmas.
#[test]
fn unit_the_limits_of_an_excess_decide() {
    let text = std::fs::read_to_string(example("stsat3/model.toml")).unwrap();
    let text = text.replace("noise_rad_s = 0.0001", "noise_rad_s = 0.00003333");
    let model = parse_model(&text, "model.toml").unwrap();
    let default = asked(&model, undiagnosed()).unwrap();
    let gyro = "residual of the gyro";
    assert_eq!(row(&default, gyro).effect, Effect::AgainstAnswer);
    assert!(!default.passes());
    let lenient = Settings {
        white_excess: 20.0,
        misfit: 20.0,
        rejection: 20.0,
        ..undiagnosed()
    };
    let wider = asked(&model, lenient).unwrap();
    assert_eq!(row(&wider, gyro).effect, Effect::WidensSigmas);
    assert_eq!(sigma_factor(&wider), sigma_factor(&default));
    assert!(wider.passes(), "{:?}", wider.doubts());
    let blind = Settings {
        negligible_excess: 20.0,
        ..lenient
    };
    let blind = asked(&model, blind).unwrap();
    assert_eq!(row(&blind, gyro).effect, Effect::None);
    assert!(sigma_factor(&blind) < sigma_factor(&default));
    let strict = Settings {
        negligible_excess: 20.0,
        white_excess: 20.0,
        ..undiagnosed()
    };
    let strict = asked(&model, strict).unwrap();
    assert_eq!(row(&strict, "all residuals").effect, Effect::AgainstAnswer);
}

#[test]
fn unit_the_limit_of_a_contradiction_decides() {
    let folder = tempfile::tempdir().unwrap();
    let model = read_model(with_prior(folder.path(), 0.5)).unwrap();
    let prior = "priors of mass properties against the data";
    let default = asked(&model, undiagnosed()).unwrap();
    assert_eq!(row(&default, prior).effect, Effect::None);
    let strict = Settings {
        contradiction_sigmas: 1.0e-6,
        ..undiagnosed()
    };
    let strict = asked(&model, strict).unwrap();
    assert_eq!(row(&strict, prior).effect, Effect::AgainstAnswer);
    assert_eq!(strict.doubts(), ["a prior is inconsistent with the data"]);
}

#[test]
fn unit_a_threshold_out_of_range_is_refused() {
    let model = read_model(example("stsat3/model.toml")).unwrap();
    let wrong = Settings {
        misfit: 0.5,
        ..Settings::default()
    };
    let why = asked(&model, wrong).unwrap_err().to_string();
    assert_eq!(
        why,
        "E0407 setting 'misfit' = 0.5: out of its range; give a finite number above 1"
    );
}
