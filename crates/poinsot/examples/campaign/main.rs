//! Thousands of noisy repetitions of each experiment: is the stated uncertainty the true one?
//!
//!     cargo run --release -p poinsot --example campaign -- --trials 10000 --out DIR
//!
//! runs every set-up on all cores, prints progress and time left on stderr and its table on stdout, and writes the sums
//! of each set-up to `DIR/SETUP_FIRST.json`. In pieces, on one machine or several: `--first N` is the number of the first
//! trial, which is also its random stream; `--seconds S` stops a set-up after S seconds with what is done (the file says
//! how far it came); `--merge FILE...`, the last of all words, prints the tables of pieces put
//! together and with `--out` writes their sums, one file a set-up. The exit code is 1 where a set-up misses
//! what is asked of 10^4 trials.
//!
//! `--setup NAME` chooses (may be given several times), `--method linear` judges the linear method, `--threads N`.
//! Further words find out what does harm: `--perfect SENSOR` takes the errors of a sensor away but not its declared
//! noise; `--white SENSOR` replaces its rounding by white noise of the same variance, `--offset SENSOR` by a constant
//! error of that variance; `--noise SENSOR=FACTOR` makes a sensor that much worse, as declared; `--fixed-phase` rounds
//! alike in every trial, `--fixed-step` with the declared step where a set-up draws it; `--stride N` keeps every N-th sample. `--diagnose` adds to every trial the look for what would
//! explain a misfit: it changes no number and takes a quarter of the time.

mod options;
mod setups;

use options::Options;
use poinsot::trials::{Study, Sums, statistics_document, statistics_of};
use poinsot_model::{Nuisance, Sensor};
use poinsot_spatial::Matrix3;
use std::error::Error;
use std::process::ExitCode;
use std::time::Instant;

fn main() -> Result<ExitCode, Box<dyn Error>> {
    let options = options::read()?;
    if options.threads > 0 {
        rayon::ThreadPoolBuilder::new()
            .num_threads(options.threads)
            .build_global()?;
    }
    let all = if options.merge.is_empty() {
        campaign(&options)?
    } else {
        merged(&options)?
    };
    let mut misses = 0;
    for sums in &all {
        misses += report(sums);
    }
    Ok(if misses == 0 {
        ExitCode::SUCCESS
    } else {
        ExitCode::from(1)
    })
}

fn campaign(options: &Options) -> Result<Vec<Sums>, Box<dyn Error>> {
    let mut all = Vec::new();
    for name in setups::NAMES {
        if !options.setups.is_empty() && !options.setups.iter().any(|s| s == name) {
            continue;
        }
        let Some(setup) = setups::setup(name, options.stride) else {
            continue;
        };
        let setup = setup?;
        let mut study = Study {
            method: options.method,
            diagnose: options.diagnose,
            draw_phase: !options.fixed_phase,
            ..setup.study
        };
        if options.fixed_step {
            study.step_spread = 0.0;
        }
        change_sensors(&mut study, options);
        let title = format!("{}{}: {}", setup.name, options.changes(), setup.about);
        all.push(run(&study, name, &title, options)?);
    }
    Ok(all)
}

/// The trials asked for, batch by batch; after each the file holds what is done so far.
fn run(study: &Study, name: &str, title: &str, options: &Options) -> Result<Sums, Box<dyn Error>> {
    let started = Instant::now();
    let threads = rayon::current_num_threads();
    let mut sums = Sums::new(title, Some(&study.bound()?));
    let (first, last) = (options.first, options.first + options.trials);
    let batch = 8 * threads as u64;
    let mut at = first;
    while at < last {
        let next = (at + batch).min(last);
        study.run(at..next).iter().for_each(|trial| sums.add(trial));
        at = next;
        let gone = started.elapsed().as_secs_f64();
        sums.seconds = gone * threads as f64;
        let left = gone / (at - first) as f64 * (last - at) as f64;
        eprintln!(
            "{name}: {} of {} trials, {gone:.0} s, {left:.0} s left",
            at - first,
            options.trials
        );
        if let Some(folder) = &options.out {
            sums.write(&folder.join(format!("{name}_{first:06}.json")))?;
        }
        if options.seconds.is_some_and(|most| gone >= most) {
            break;
        }
    }
    Ok(sums)
}

fn merged(options: &Options) -> Result<Vec<Sums>, Box<dyn Error>> {
    let mut all: Vec<Sums> = Vec::new();
    for path in &options.merge {
        let piece = Sums::read(path)?;
        match all.iter_mut().find(|s| s.setup == piece.setup) {
            Some(sums) => sums
                .merge(&piece)
                .map_err(|why| format!("{}: {why}", path.display()))?,
            None => all.push(piece),
        }
    }
    all.sort_by(|a, b| a.setup.cmp(&b.setup));
    if let Some(folder) = &options.out {
        for sums in &all {
            let name = sums.setup.split([':', ' ']).next().unwrap_or("sums");
            sums.write(&folder.join(format!("{name}.json")))?;
        }
    }
    Ok(all)
}

/// Prints the table and what it misses; the number of misses.
fn report(sums: &Sums) -> usize {
    let statistics = statistics_of(sums);
    print!("{}", statistics_document(&sums.setup, &statistics));
    let misses = statistics.misses();
    for (first, past) in &sums.ranges {
        println!("  trials {first} to {}", past - 1);
    }
    println!(
        "  {:.3} s a trial, wall time by threads",
        sums.seconds / sums.trials.max(1) as f64
    );
    if misses.is_empty() {
        println!(
            "  holds what is asked: RMSE/bound <= 1.05, |bias| < 0.1 sigma, coverage 94 to 96 %, NEES in its band, spread within 5 % of the prediction\n"
        );
    }
    for miss in &misses {
        println!("  missed: {miss}");
    }
    println!();
    misses.len()
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
