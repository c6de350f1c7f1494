//! Files of predictions.

use super::{Prediction, prediction_file};
use crate::error::Error;
use crate::written::{check_outputs, result_json, write_file};
use std::path::{Path, PathBuf};

/// Name of the file of a prediction.
const NAME: &str = "prediction.json";

/// Paths of the predictions of some cases: in the folder itself for one case, otherwise in a subfolder named after each.
///
/// # Errors
/// Two cases have the same file name, or a path cannot be written to.
///
/// ```
/// use poinsot::predict::prediction_paths;
///
/// # let out = std::env::temp_dir().join(format!("poinsot-paths-{}", std::process::id()));
/// let paths = prediction_paths(&out, &["a.toml".into(), "b.toml".into()])?;
/// assert_eq!(paths, [out.join("a/prediction.json"), out.join("b/prediction.json")]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn prediction_paths(folder: &Path, cases: &[PathBuf]) -> Result<Vec<PathBuf>, Error> {
    let mut all: Vec<PathBuf> = Vec::new();
    for case in cases {
        let place = match cases {
            [_] => folder.join(NAME),
            _ => folder.join(case.file_stem().unwrap_or_default()).join(NAME),
        };
        if all.contains(&place) {
            let problem = "another case has the same file name, and so the same folder below --out";
            let advice = "predict them one by one";
            return Err(Error::usage("CASE", case.display(), problem, advice));
        }
        all.push(place);
    }
    let inputs: Vec<&Path> = cases.iter().map(PathBuf::as_path).collect();
    check_outputs("--out", &all, &inputs)?;
    Ok(all)
}

/// Writes predictions to the paths of [`prediction_paths`].
///
/// # Errors
/// Writing fails.
///
/// ```
#[doc = include_str!("../../doc/case.txt")]
/// use poinsot::predict::{predict_case, write_predictions};
///
/// # let out = std::env::temp_dir().join(format!("poinsot-predictions-{}", std::process::id()));
/// let path = out.join("prediction.json");
/// write_predictions(std::slice::from_ref(&path), &[predict_case(&case, model, 1.0)?])?;
/// assert!(path.exists());
/// # std::fs::remove_dir_all(&out)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn write_predictions(paths: &[PathBuf], all: &[Prediction]) -> Result<(), Error> {
    for (path, prediction) in paths.iter().zip(all) {
        let text = result_json(path, &prediction_file(prediction), true)?;
        write_file(path, text.as_bytes())?;
    }
    Ok(())
}
