//! Thousands of noisy repetitions of each experiment: is the stated uncertainty the true one?
//!
//!     cargo run --release -p poinsot --example campaign -- --trials 1000 [--setup NAME] [--method linear]
//!
//! Further words find out what does harm: `--perfect SENSOR` takes the errors of a sensor away but not its declared
//! noise; `--white SENSOR` replaces its rounding by white noise of the same variance, `--offset SENSOR` by a constant
//! error of that variance; `--noise SENSOR=FACTOR` makes a sensor that much worse, as declared; `--fixed-phase` rounds
//! alike in every trial; `--stride N` keeps every N-th sample.

mod setups;

use poinsot::trials::{Study, TrialMethod, statistics, statistics_document};
use poinsot_model::{Nuisance, Sensor};
use poinsot_spatial::Matrix3;
use std::error::Error;
use std::time::Instant;

struct Options {
    trials: u64,
    setup: Option<String>,
    method: TrialMethod,
    stride: usize,
    fixed_phase: bool,
    perfect: Vec<String>,
    white: Vec<String>,
    offset: Vec<String>,
    noise: Vec<(String, f64)>,
}

fn main() -> Result<(), Box<dyn Error>> {
    let options = options()?;
    for name in setups::NAMES {
        if options.setup.as_deref().is_some_and(|only| only != name) {
            continue;
        }
        let Some(setup) = setups::setup(name, options.stride) else {
            continue;
        };
        let setup = setup?;
        let mut study = Study {
            method: options.method,
            draw_phase: !options.fixed_phase,
            ..setup.study
        };
        change_sensors(&mut study, &options);
        let started = Instant::now();
        let bound = study.bound()?;
        let trials = study.run(0..options.trials);
        let title = format!("{}: {}", setup.name, setup.about);
        print!(
            "{}",
            statistics_document(&title, &statistics(&trials, Some(&bound)))
        );
        println!("  {:.0} s\n", started.elapsed().as_secs_f64());
    }
    Ok(())
}

fn change_sensors(study: &mut Study, options: &Options) {
    for (name, factor) in &options.noise {
        let own = |s: &&mut Sensor| s.name == *name;
        let declared = study.model.sensors.iter_mut().filter(own);
        for sensor in declared.chain(study.sensors.iter_mut().filter(own)) {
            sensor.quantisation *= factor;
            sensor.noise_covariance = sensor.noise_covariance.map(|c| c * (factor * factor));
        }
    }
    for sensor in &mut study.sensors {
        if options.perfect.contains(&sensor.name) {
            sensor.quantisation = 0.0;
            sensor.noise_covariance = None;
        }
        if options.white.contains(&sensor.name) {
            let step = sensor.quantisation * sensor.quantisation / 12.0;
            let own = sensor.noise_covariance.unwrap_or_default();
            sensor.noise_covariance = Some(own + Matrix3::identity() * step);
            sensor.quantisation = 0.0;
        }
        if options.offset.contains(&sensor.name) {
            sensor.bias = Nuisance::Prior(sensor.quantisation / 12.0_f64.sqrt());
            sensor.quantisation = 0.0;
        }
    }
}

fn options() -> Result<Options, Box<dyn Error>> {
    let mut options = Options {
        trials: 1000,
        setup: None,
        method: TrialMethod::Auto,
        stride: 1,
        fixed_phase: false,
        perfect: Vec::new(),
        white: Vec::new(),
        offset: Vec::new(),
        noise: Vec::new(),
    };
    let mut words = std::env::args().skip(1);
    while let Some(word) = words.next() {
        if word == "--fixed-phase" {
            options.fixed_phase = true;
            continue;
        }
        let value = words.next().ok_or(format!("{word}: a value is missing"))?;
        match (word.as_str(), value.as_str()) {
            ("--trials", n) => options.trials = n.parse()?,
            ("--stride", n) => options.stride = n.parse::<usize>()?.max(1),
            ("--setup", name) if setups::NAMES.contains(&name) => options.setup = Some(value),
            ("--setup", name) => {
                let known = setups::NAMES.join(", ");
                return Err(format!("--setup {name}: known are {known}").into());
            }
            ("--method", "auto") => options.method = TrialMethod::Auto,
            ("--method", "linear") => options.method = TrialMethod::Linear,
            ("--perfect", _) => options.perfect.push(value),
            ("--white", _) => options.white.push(value),
            ("--offset", _) => options.offset.push(value),
            ("--noise", pair) => {
                let (name, factor) = pair.split_once('=').ok_or("--noise SENSOR=FACTOR")?;
                options.noise.push((name.to_owned(), factor.parse()?));
            }
            _ => {
                return Err(format!(
                    "{word} {value}: known are --trials N, --setup NAME, --method auto|linear, --stride N, --fixed-phase, --perfect SENSOR, --white SENSOR, --offset SENSOR, --noise SENSOR=FACTOR"
                )
                .into());
            }
        }
    }
    Ok(options)
}
