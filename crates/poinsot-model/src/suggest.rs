//! Suggests the key or name that was probably meant.

/// Units that end keys of the format, longest first.
const UNITS: [&str; 19] = [
    "_N_m_s_per_rad",
    "_N_m_per_rad",
    "_N_s_per_m",
    "_N_per_m",
    "_kg_m2",
    "_m3_s2",
    "_N_m_s",
    "_rad_s",
    "_m_s2",
    "_N_m",
    "_N_s",
    "_rad",
    "_m_s",
    "_xyzw",
    "_matrix",
    "_kg",
    "_m",
    "_s",
    "_N",
];

/// Suffixes of form, not unit: two ways to write a rotation.
const FORMS: [&str; 2] = ["_xyzw", "_matrix"];

/// Suffixes used instead of the correct unit.
const UNIT_PARTS: [&str; 58] = [
    "kg",
    "g",
    "mg",
    "t",
    "lb",
    "lbm",
    "slug",
    "m",
    "mm",
    "cm",
    "km",
    "in",
    "ft",
    "s",
    "ms",
    "us",
    "ns",
    "min",
    "h",
    "rad",
    "mrad",
    "deg",
    "arcsec",
    "rpm",
    "n",
    "mn",
    "kn",
    "lbf",
    "nm",
    "ns",
    "nms",
    "kgm2",
    "gmm2",
    "kgmm2",
    "m2",
    "mm2",
    "cm2",
    "in2",
    "ft2",
    "s2",
    "m3",
    "km3",
    "per",
    "xyzw",
    "wxyz",
    "quat",
    "quaternion",
    "matrix",
    "euler",
    "rpy",
    "dcm",
    "zyx",
    "xyz",
    "si",
    "sec",
    "degrees",
    "meters",
    "radians",
];

/// The closest candidate, if it is close enough for a typing error.
pub(crate) fn nearest<'a>(word: &str, candidates: &[&'a str]) -> Option<&'a str> {
    if word.chars().count() > 64 {
        return None;
    }
    candidates
        .iter()
        .map(|c| {
            (
                strsim::jaro_winkler(&word.to_lowercase(), &c.to_lowercase()),
                *c,
            )
        })
        .filter(|(score, _)| *score > 0.75)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, c)| c)
}

/// Whether two words differ by at most a typing error.
pub(crate) fn similar(a: &str, b: &str) -> bool {
    nearest(a, &[b]).is_some()
}

/// A key without its unit.
fn stem(key: &str) -> Option<&str> {
    UNITS.iter().find_map(|unit| key.strip_suffix(unit))
}

/// Known keys that equal an unknown one up to a missing or different unit.
fn other_units<'a>(key: &str, known: &[&'a str]) -> Vec<&'a str> {
    known
        .iter()
        .copied()
        .filter(|k| {
            stem(k).is_some_and(|stem| {
                key == stem
                    || key
                        .strip_prefix(stem)
                        .and_then(|rest| rest.strip_prefix('_'))
                        .is_some_and(|rest| {
                            rest.split('_')
                                .all(|part| UNIT_PARTS.contains(&part.to_lowercase().as_str()))
                        })
            })
        })
        .collect()
}

/// Known keys that an unknown one probably means.
pub(crate) fn meant<'a>(key: &str, known: &[&'a str]) -> Vec<&'a str> {
    let units = other_units(key, known);
    if units.is_empty() {
        nearest(key, known).into_iter().collect()
    } else {
        units
    }
}

/// Code, problem and remedy for an unknown key.
pub(crate) fn unknown_key(key: &str, known: &[&str]) -> (&'static str, String, String) {
    let units = other_units(key, known);
    if let Some(first) = units.first() {
        let write = format!("write {}", units.join(" or "));
        let form = FORMS.iter().any(|form| first.ends_with(form));
        return match (stem(first) == Some(key), form) {
            (true, false) => ("E0105", "missing unit".to_owned(), write),
            (true, true) => ("E0105", "missing form".to_owned(), write),
            (false, false) => (
                "E0105",
                "wrong unit".to_owned(),
                format!("{write} and convert the number"),
            ),
            (false, true) => (
                "E0105",
                "wrong form".to_owned(),
                format!("{write} and convert the numbers"),
            ),
        };
    }
    let remedy = match nearest(key, known) {
        Some(near) => format!("did you mean {near}?"),
        None if known.is_empty() => "remove it".to_owned(),
        None => format!("remove it; known here: {}", known.join(", ")),
    };
    ("E0104", "unknown key".to_owned(), remedy)
}
