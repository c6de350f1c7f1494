//! One file per verb.

pub mod check;
pub mod explain;
pub mod export;
pub mod identify;
pub mod import;
pub mod inspect;
pub mod predict;
pub mod report;
pub mod schema;
pub mod simulate;
pub mod validate;

use std::sync::Mutex;

/// Why a verb failed, ready for the terminal.
pub struct Failure {
    /// One line or several findings, each with its code.
    pub message: String,
    /// Exit code.
    pub exit_code: u8,
}

/// Exit code of an answer.
pub type Outcome = Result<u8, Failure>;

impl<E: Into<poinsot::Error>> From<E> for Failure {
    fn from(error: E) -> Self {
        let error = error.into();
        Self {
            exit_code: error.exit_code(),
            message: error.to_string(),
        }
    }
}

/// Why standard output could not be written, if it could not.
static REFUSED: Mutex<Option<std::io::Error>> = Mutex::new(None);

/// Prints to standard output; a closed pipe is not an error, anything else is one in the end.
pub fn print(text: &str) {
    use std::io::{ErrorKind, Write};
    let mut out = std::io::stdout().lock();
    let plain = crate::guard::plain_lines(text);
    let done = out.write_all(plain.as_bytes()).and_then(|()| out.flush());
    if let Err(error) = done
        && error.kind() != ErrorKind::BrokenPipe
        && let Ok(mut refused) = REFUSED.lock()
    {
        refused.get_or_insert(error);
    }
}

/// The exit code, unless standard output was refused.
pub fn printed(code: u8) -> Outcome {
    match REFUSED.lock().ok().and_then(|mut refused| refused.take()) {
        None => Ok(code),
        Some(source) => Err(Failure::from(poinsot::Error::Output { source })),
    }
}

/// Prints a value as JSON.
pub fn print_json<T: serde::Serialize>(value: &T) {
    let text = serde_json::to_string_pretty(value).unwrap_or_default();
    print(&format!("{text}\n"));
}
