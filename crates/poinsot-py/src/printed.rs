//! What a verb hands over to Python.

use crate::fault::Fault;
use poinsot_figures::Document;

/// JSON, text, exit code.
pub(crate) type Printed = (String, String, u8);

/// What a verb hands over: its file, what the command prints, and the exit code.
pub(crate) fn printed<T: poinsot_formats::Serialize>(
    file: &T,
    document: &Document,
    passes: bool,
) -> Result<Printed, Fault> {
    let text = document.to_string();
    Ok((json(file)?, text, poinsot_cli::exit_of(passes)))
}

/// A document as the text that crosses into Python.
pub(crate) fn json<T: poinsot_formats::Serialize>(document: &T) -> Result<String, Fault> {
    serde_json::to_string(document)
        .map_err(|error| Fault::from(poinsot::Error::internal(error.to_string())))
}
