//! A data set of NIST: data, certified answer, starting values.

use std::path::Path;

/// One data set; numbers are kept as text until their precision is chosen.
pub struct Data {
    /// Starting values of the parameters: two sets for a nonlinear problem, none for a linear one.
    pub starts: Vec<Vec<f64>>,
    pub certified: Vec<f64>,
    /// Certified standard deviations of the parameters.
    pub sigma: Vec<f64>,
    /// Certified residual sum of squares.
    pub rss: f64,
    /// Response, then predictors.
    pub rows: Vec<Vec<String>>,
}

impl Data {
    pub fn read(name: &str) -> Data {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../validation/nist");
        let text = std::fs::read_to_string(folder.join(format!("{name}.txt"))).unwrap();
        let field = |key: &str| {
            let line = text.lines().find_map(|l| l.strip_prefix(key));
            line.map(|l| numbers(l.split_whitespace()))
        };
        let data = text.lines().skip_while(|l| !l.starts_with("data ")).skip(1);
        let rows: Vec<Vec<String>> = data
            .map(|l| l.split_whitespace().map(str::to_owned).collect())
            .collect();
        assert_eq!(rows.len() as f64, field("data ").unwrap()[0], "{name}");
        Data {
            starts: ["start1 ", "start2 "]
                .iter()
                .filter_map(|k| field(k))
                .collect(),
            certified: field("certified ").unwrap(),
            sigma: field("sigma ").unwrap(),
            rss: field("rss ").unwrap()[0],
            rows,
        }
    }

    /// Rows in double precision.
    pub fn numbers(&self) -> Vec<Vec<f64>> {
        let row = |r: &Vec<String>| numbers(r.iter().map(String::as_str));
        self.rows.iter().map(row).collect()
    }
}

fn numbers<'a>(words: impl Iterator<Item = &'a str>) -> Vec<f64> {
    words.map(|w| w.parse().unwrap()).collect()
}

/// Correct significant digits (log relative error of NIST), at most `cap`, the printed digits of the certified value;
/// absolute if it is zero.
pub fn digits(value: f64, certified: f64, cap: f64) -> f64 {
    let scale = if certified == 0.0 { 1.0 } else { certified };
    let error = ((value - certified) / scale).abs();
    if error.is_nan() {
        return 0.0;
    }
    (-error.log10()).clamp(0.0, cap)
}

/// The smallest number of digits.
pub fn fewest(digits: impl IntoIterator<Item = f64>) -> f64 {
    digits.into_iter().fold(f64::INFINITY, f64::min)
}
