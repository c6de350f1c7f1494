//! Every error code with meaning, usual cause and remedy: one registry for all crates.
//!
//! The texts are files of Markdown, one a code: `explanations/` of this crate, and of the papers' crate for theirs.
//! Tests compare the list with the files and with the codes in the sources; another prints every message.

pub use poinsot_formats::CodeFile as ErrorCode;
use poinsot_formats::{CODES, CodesFile};

/// Texts of codes that no method owns.
const TEXTS: &[&str] = &poinsot_papers::explanations![
    "E0001", "E0002", "E0003", "E0004", "E0005", "E0006", "E0009", "E0101", "E0102", "E0103",
    "E0104", "E0105", "E0106", "E0107", "E0108", "E0109", "E0110", "E0111", "E0112", "E0113",
    "E0114", "E0115", "E0116", "E0117", "E0118", "E0119", "E0120", "E0121", "E0122", "E0201",
    "E0202", "E0203", "E0204", "E0205", "E0206", "E0207", "E0208", "E0209", "E0210", "E0211",
    "E0212", "E0213", "E0214", "E0215", "E0216", "E0217", "E0218", "E0219", "E0220", "E0221",
    "E0301", "E0302", "E0303", "E0304", "E0305", "E0306", "E0307", "E0401", "E0402", "E0403",
    "E0404", "E0405", "E0406", "E0407", "E0408", "E0410", "E0411", "E0501", "E0502", "E0503",
    "E0504", "E0505", "E0506", "E0507", "E0508", "E0509", "E0511", "E0541", "E0542", "E0601",
    "E0602", "E0603", "E0604", "E0605", "E0701", "E0702", "E0703"
];

/// Starts of the lines of a text, and what is between its paragraphs.
const TITLE: &str = "# ";
const CAUSE: &str = "- Usual cause: ";
const REMEDY: &str = "- What to do: ";
const BETWEEN: &str = "\n\n";

/// Reads a text; what it lacks is empty, which a test forbids.
fn parse(text: &'static str) -> ErrorCode {
    let (title, rest) = text.split_once(BETWEEN).unwrap_or_default();
    let (meaning, list) = rest.split_once(BETWEEN).unwrap_or_default();
    let line = |start: &str| list.lines().find_map(|l| l.strip_prefix(start));
    ErrorCode {
        code: title.strip_prefix(TITLE).unwrap_or_default(),
        meaning,
        cause: line(CAUSE).unwrap_or_default(),
        remedy: line(REMEDY).unwrap_or_default(),
    }
}

/// All codes, ascending.
///
/// ```
/// let codes = poinsot::explain::error_codes();
/// assert!(codes.iter().any(|c| c.code == "E0103" && !c.remedy.is_empty()));
/// ```
pub fn error_codes() -> Vec<ErrorCode> {
    let published = poinsot_papers::METHODS.iter().flat_map(|m| m.codes);
    let texts = TEXTS.iter().chain(published);
    let mut all: Vec<ErrorCode> = texts.map(|text| parse(text)).collect();
    all.sort_by_key(|c| c.code);
    all
}

/// Codes as a file.
///
/// ```
/// use poinsot::explain::{codes_file, error_codes};
///
/// assert_eq!(codes_file(error_codes()).codes[0].code, "E0001");
/// ```
pub fn codes_file(codes: Vec<ErrorCode>) -> CodesFile {
    CodesFile {
        schema: CODES.to_owned(),
        codes,
    }
}

/// Looks up a code, ignoring case, with or without `E`.
///
/// ```
/// use poinsot::explain::explain;
///
/// assert_eq!(explain("e103").unwrap().code, "E0103");
/// assert!(explain("E9999").is_none());
/// ```
pub fn explain(code: &str) -> Option<ErrorCode> {
    let digits = code.trim().trim_start_matches(['E', 'e']);
    let wanted = format!("E{digits:0>4}");
    error_codes().into_iter().find(|c| c.code == wanted)
}
