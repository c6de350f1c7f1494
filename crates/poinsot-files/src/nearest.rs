//! The name that was meant.

/// Longest word for which one is sought, characters.
const LONGEST: usize = 64;
/// Likeness (Jaro and Winkler 1990) from which a name may be meant.
const ALIKE: f64 = 0.75;

/// The name most like a word, if it is close enough for a typing error.
///
/// ```
/// use poinsot_files::nearest;
///
/// assert_eq!(nearest("omega_X", &["omega_x", "q_x"]), Some("omega_x"));
/// assert_eq!(nearest("bos", &["b", "bus", "bas"]), Some("bus"));
/// assert_eq!(nearest("speed", &["omega_x", "q_x"]), None);
/// ```
pub fn nearest<'n>(word: &str, names: &[&'n str]) -> Option<&'n str> {
    let searched = word.chars().count() <= LONGEST;
    let word = word.to_lowercase();
    let alike = |name: &&'n str| (strsim::jaro_winkler(&word, &name.to_lowercase()), *name);
    let last_first = names.iter().rev().filter(|_| searched).map(alike);
    // Of equally alike ones that with the fewest edits.
    let edits = |name: &str| strsim::damerau_levenshtein(&word, name);
    let best = last_first.max_by(|a, b| (a.0.total_cmp(&b.0)).then(edits(b.1).cmp(&edits(a.1))));
    best.filter(|best| best.0 > ALIKE).map(|best| best.1)
}
