//! Suggests the key or name that was probably meant.

use poinsot_files::nearest;

/// Units that end keys of the format, longest first.
const UNITS: &str = "N_m_s_per_rad N_m_per_rad N_s_per_m N_per_m kg_m2 m3_s2 kg05_m N_m_s rad_s \
    m_s2 kg05 N_m N_s rad m_s xyzw matrix kg Hz m s N";

/// Suffixes of form, not unit: two ways to write a rotation.
const FORMS: [&str; 2] = ["xyzw", "matrix"];

/// Suffixes used instead of the correct unit.
const UNIT_PARTS: &str = "kg05 hz khz mhz kg g mg t lb lbm slug m mm cm km in ft s ms us ns min h rad mrad deg arcsec rpm n mn kn lbf nm ns nms \
    kgm2 gmm2 kgmm2 m2 mm2 cm2 in2 ft2 s2 m3 km3 per xyzw wxyz quat quaternion matrix euler rpy dcm zyx xyz si sec degrees \
    meters radians";

/// A unit that ends a key, as it is printed: `kg_m2` is `kg m2`; none for a form.
pub(crate) fn printed_unit(suffix: &str) -> Option<String> {
    let text = match suffix {
        suffix if FORMS.contains(&suffix) => return None,
        "rad_s" | "m_s" | "m_s2" | "m3_s2" => suffix.replace('_', "/"),
        _ => suffix
            .replace("_per_", "/")
            .replace('_', " ")
            .replace("kg05", "kg^1/2"),
    };
    Some(text)
}

/// Whether two words differ by at most a typing error.
pub(crate) fn similar(a: &str, b: &str) -> bool {
    nearest(a, &[b]).is_some()
}

/// A key without its unit.
pub(crate) fn stem(key: &str) -> Option<&str> {
    let mut units = UNITS.split(' ');
    units.find_map(|unit| key.strip_suffix(unit)?.strip_suffix('_'))
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
                            let known = |part: &str| {
                                let part = part.to_lowercase();
                                UNIT_PARTS.split_whitespace().any(|unit| unit == part)
                            };
                            rest.split('_').all(known)
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

/// For an unknown key: whether only its unit or form is wrong, problem and remedy.
pub(crate) fn unknown_key(key: &str, known: &[&str]) -> (bool, String, String) {
    let units = other_units(key, known);
    if let Some(first) = units.first() {
        let write = format!("write {}", units.join(" or "));
        let form = FORMS.iter().any(|form| first.ends_with(form));
        let (problem, remedy) = match (stem(first) == Some(key), form) {
            (true, false) => ("missing unit", write),
            (true, true) => ("missing form", write),
            (false, false) => ("wrong unit", write + " and convert the number"),
            (false, true) => ("wrong form", write + " and convert the numbers"),
        };
        return (true, problem.to_owned(), remedy);
    }
    let remedy = match nearest(key, known) {
        Some(near) => format!("did you mean {near}?"),
        None if known.is_empty() => "remove it".to_owned(),
        None => format!("remove it; known here: {}", known.join(", ")),
    };
    (false, "unknown key".to_owned(), remedy)
}
