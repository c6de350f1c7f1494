//! The words of the command line.

use crate::setups::NAMES;
use poinsot::trials::TrialMethod;
use std::error::Error;
use std::path::PathBuf;

pub struct Options {
    pub first: u64,
    pub trials: u64,
    pub seconds: Option<f64>,
    pub threads: usize,
    pub out: Option<PathBuf>,
    pub merge: Vec<PathBuf>,
    pub setups: Vec<String>,
    pub method: TrialMethod,
    pub stride: usize,
    pub diagnose: bool,
    pub fixed_phase: bool,
    pub fixed_step: bool,
    pub perfect: Vec<String>,
    pub white: Vec<String>,
    pub offset: Vec<String>,
    pub noise: Vec<(String, f64)>,
}

const USAGE: &str = "known are --trials N, --first N, --seconds S, --out DIR, --merge FILE..., --setup NAME, --threads N, --method auto|linear, --stride N, --fixed-phase, --fixed-step, --diagnose, --perfect SENSOR, --white SENSOR, --offset SENSOR, --noise SENSOR=FACTOR";

impl Options {
    /// What makes the experiments other than they are, in words.
    pub fn changes(&self) -> String {
        let mut words = Vec::new();
        if self.method == TrialMethod::Linear {
            words.push("linear".to_owned());
        }
        if self.stride > 1 {
            words.push(format!("every {}th sample", self.stride));
        }
        if self.fixed_phase {
            words.push("fixed phase".to_owned());
        }
        if self.fixed_step {
            words.push("fixed step".to_owned());
        }
        let lists = [
            ("perfect", &self.perfect),
            ("white", &self.white),
            ("offset", &self.offset),
        ];
        for (what, names) in lists {
            words.extend(names.iter().map(|name| format!("{what} {name}")));
        }
        words.extend(self.noise.iter().map(|(name, f)| format!("{name} x {f}")));
        if words.is_empty() {
            String::new()
        } else {
            format!(" ({})", words.join(", "))
        }
    }
}

pub fn read() -> Result<Options, Box<dyn Error>> {
    let mut options = Options {
        first: 0,
        trials: 1000,
        seconds: None,
        threads: 0,
        out: None,
        merge: Vec::new(),
        setups: Vec::new(),
        method: TrialMethod::Auto,
        stride: 1,
        diagnose: false,
        fixed_phase: false,
        fixed_step: false,
        perfect: Vec::new(),
        white: Vec::new(),
        offset: Vec::new(),
        noise: Vec::new(),
    };
    let mut words = std::env::args().skip(1);
    while let Some(word) = words.next() {
        match word.as_str() {
            "--fixed-phase" => {
                options.fixed_phase = true;
                continue;
            }
            "--fixed-step" => {
                options.fixed_step = true;
                continue;
            }
            "--diagnose" => {
                options.diagnose = true;
                continue;
            }
            "--merge" => {
                options.merge = words.by_ref().map(PathBuf::from).collect();
                continue;
            }
            _ => {}
        }
        let value = words
            .next()
            .ok_or(format!("{word}: a value is missing; {USAGE}"))?;
        match (word.as_str(), value.as_str()) {
            ("--trials", n) => options.trials = n.parse()?,
            ("--first", n) => options.first = n.parse()?,
            ("--seconds", s) => options.seconds = Some(s.parse()?),
            ("--threads", n) => options.threads = n.parse()?,
            ("--out", folder) => options.out = Some(PathBuf::from(folder)),
            ("--stride", n) => options.stride = n.parse::<usize>()?.max(1),
            ("--setup", name) if NAMES.contains(&name) => options.setups.push(value),
            ("--setup", name) => {
                let known = NAMES.join(", ");
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
            _ => return Err(format!("{word} {value}: {USAGE}").into()),
        }
    }
    options
        .first
        .checked_add(options.trials)
        .ok_or("--first and --trials: too large")?;
    Ok(options)
}
