//! The command `sweep`: one case with varied numbers and several methods, run as a campaign of one case.

use crate::error::Error;
use poinsot_formats::{
    Address, ExperimentFile, MethodFile, PLAN, PlanFile, ScaleFile, SettingFile, VaryFile,
};
use std::path::PathBuf;

/// Arguments of `sweep`.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct SweepRequest {
    /// Case.
    pub case: PathBuf,
    /// Nominal model; default: the model of the case.
    pub model: Option<PathBuf>,
    /// `ADDRESS=VALUES`: a list `1,2,5`, or a range `from:to:count` with equal differences, or `from:to:count:log`.
    pub vary: Vec<String>,
    /// `NAME`, or `NAME/VARIANT`.
    pub methods: Vec<String>,
    /// `KEY=VALUE` for every published method with this key, or `METHOD.KEY=VALUE`.
    pub settings: Vec<String>,
    /// Trials of every point.
    pub trials: u64,
    /// Seed.
    pub seed: Option<u64>,
}

/// The plan of a sweep.
///
/// # Errors
/// A text is not a list, range or setting.
///
/// ```
/// use poinsot::sweep::{SweepRequest, sweep_plan};
///
/// // Three rates of the rows, with equal ratios.
/// let request = SweepRequest {
///     case: "case.toml".into(),
///     vary: vec!["output.rate_hz=1:100:3:log".to_owned()],
///     methods: vec!["linear".to_owned()],
///     trials: 10,
///     ..SweepRequest::default()
/// };
/// let plan = sweep_plan(&request)?;
/// assert_eq!((plan.vary.len(), plan.trials), (1, Some(10)));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn sweep_plan(request: &SweepRequest) -> Result<PlanFile, Error> {
    let vary = request.vary.iter().map(|text| vary(text));
    let mut methods: Vec<MethodFile> = request.methods.iter().map(|m| method(m)).collect();
    for text in &request.settings {
        set(text, &mut methods)?;
    }
    Ok(PlanFile {
        schema: PLAN.to_owned(),
        name: "sweep".to_owned(),
        trials: Some(request.trials),
        seed: request.seed,
        experiment: vec![ExperimentFile {
            case: Some(request.case.clone()),
            model: request.model.clone(),
            ..ExperimentFile::default()
        }],
        method: methods,
        vary: vary.collect::<Result<_, _>>()?,
        ..PlanFile::default()
    })
}

fn vary(text: &str) -> Result<VaryFile, Error> {
    let parse = |t: &str| t.trim().parse::<f64>().ok().filter(|x| x.is_finite());
    let parsed = || {
        let (number, values) = text.split_once('=')?;
        let mut vary = VaryFile {
            number: number.trim().to_owned(),
            ..VaryFile::default()
        };
        match values.split(':').collect::<Vec<_>>()[..] {
            [list] => vary.values = Some(list.split(',').map(parse).collect::<Option<_>>()?),
            [from, to, count, ref log @ ..] if matches!(log, [] | ["log"]) => {
                (vary.from, vary.to) = (Some(parse(from)?), Some(parse(to)?));
                vary.count = Some(count.trim().parse().ok()?);
                if !log.is_empty() {
                    vary.scale = ScaleFile::Log;
                }
            }
            _ => return None,
        }
        Some(vary)
    };
    let wanted = "write ADDRESS=1,2,5, ADDRESS=FROM:TO:COUNT or ADDRESS=FROM:TO:COUNT:log";
    parsed().ok_or_else(|| Error::usage("--vary", text, "it has another form", wanted))
}

fn method(text: &str) -> MethodFile {
    let (name, variant) = text.split_once('/').unzip();
    MethodFile {
        name: name.unwrap_or(text).to_owned(),
        variant: variant.map(str::to_owned),
        ..MethodFile::default()
    }
}

/// Sets a value for every method that has the key, or for the named method.
fn set(text: &str, methods: &mut [MethodFile]) -> Result<(), Error> {
    let wanted = "write KEY=VALUE, or METHOD.KEY=VALUE for one of several methods";
    let (key, value) = text
        .split_once('=')
        .ok_or_else(|| Error::usage("--set", text, "it has another form", wanted))?;
    let address = Address::parse(key.trim());
    let (only, key) = (address.owner(), address.quantity());
    let known = crate::methods::methods();
    let has = |m: &MethodFile| {
        let found = known.iter().find(|k| k.name == m.name);
        found.is_some_and(|k| k.settings.iter().any(|s| s.key == key))
    };
    let mut taken = false;
    let own = |m: &&mut MethodFile| ["", m.name.as_str()].contains(&only) && has(m);
    for method in methods.iter_mut().filter(own) {
        let value = SettingFile::Text(value.trim().to_owned());
        method.set.insert(key.to_owned(), value);
        taken = true;
    }
    let problem = "no method of this sweep has this setting";
    let advice = "`poinsot methods NAME` lists settings";
    let refuse = || Error::usage("--set", text, problem, advice);
    taken.then_some(()).ok_or_else(refuse)
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    fn request(vary: &str, set: &str) -> SweepRequest {
        SweepRequest {
            case: "case.toml".into(),
            vary: vec![vary.to_owned()],
            methods: vec!["auto".to_owned(), "xu2017/linear".to_owned()],
            settings: vec![set.to_owned()],
            trials: 10,
            ..SweepRequest::default()
        }
    }

    #[test]
    fn unit_words_become_a_plan() {
        let plan = sweep_plan(&request("noise=1,2,5", "range=2")).unwrap();
        assert_eq!(plan.vary[0].values, Some(vec![1.0, 2.0, 5.0]));
        assert_eq!(plan.method[1].variant.as_deref(), Some("linear"));
        assert_eq!(
            plan.method[1].set["range"],
            SettingFile::Text("2".to_owned())
        );
        assert!(plan.method[0].set.is_empty());
        let plan = sweep_plan(&request("a.b=1:100:3:log", "xu2017.seed=4")).unwrap();
        assert_eq!(
            (plan.vary[0].from, plan.vary[0].count),
            (Some(1.0), Some(3))
        );
        assert_eq!(plan.vary[0].scale, ScaleFile::Log);
    }

    #[test]
    fn unit_words_that_make_no_plan_say_what_to_write() {
        for (vary, set, says) in [
            ("noise", "range=2", "ADDRESS=1,2,5"),
            ("noise=1,x", "range=2", "ADDRESS=1,2,5"),
            ("noise=1:2", "range=2", "FROM:TO:COUNT"),
            ("noise=1", "ranges=2", "no method of this sweep"),
            ("noise=1", "auto.range=2", "no method of this sweep"),
            ("noise=1", "range", "METHOD.KEY=VALUE"),
        ] {
            let why = sweep_plan(&request(vary, set)).unwrap_err().to_string();
            assert!(why.starts_with("E0001 --") && why.contains(says), "{why}");
        }
    }
}
