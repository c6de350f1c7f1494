//! Turns a panic into a one-line error and exit code 4.

use poinsot::Error;
use std::panic::{AssertUnwindSafe, PanicHookInfo, catch_unwind, set_hook};
use std::sync::Mutex;

/// Texts in the message of a panic after a failed allocation.
const NO_MEMORY: [&str; 2] = ["AllocError", "capacity overflow"];

/// Message and source location of the last panic.
static LAST: Mutex<String> = Mutex::new(String::new());

/// Runs a verb; a panic inside becomes a failure. Panics caught deeper (by the Parquet decoder) print
/// nothing.
///
/// # Errors
/// Those of the verb, or E0009 and E0006 of a panic.
pub fn guarded<T>(verb: impl FnOnce() -> Result<T, Error>) -> Result<T, Error> {
    set_hook(Box::new(remember));
    catch_unwind(AssertUnwindSafe(verb)).unwrap_or_else(|_| {
        let what = match LAST.lock() {
            Ok(text) => text.clone(),
            Err(poisoned) => poisoned.into_inner().clone(),
        };
        Err(match NO_MEMORY.iter().any(|text| what.contains(text)) {
            true => Error::memory("out of memory".to_owned()),
            false => Error::internal(what),
        })
    })
}

fn remember(info: &PanicHookInfo<'_>) {
    let payload = info.payload();
    let text = payload.downcast_ref::<&str>().copied();
    let message = text
        .or_else(|| payload.downcast_ref::<String>().map(String::as_str))
        .unwrap_or("no message")
        .split_whitespace()
        .collect::<Vec<_>>()
        .join(" ");
    let place = info.location().map_or(String::new(), |l| {
        // The last three path components are enough; the rest is the path on the build machine.
        let parts: Vec<&str> = l.file().rsplit(['/', '\\']).take(3).collect();
        let parts: Vec<&str> = parts.into_iter().rev().collect();
        format!(" ({}:{})", parts.join("/"), l.line())
    });
    if let Ok(mut last) = LAST.lock() {
        *last = format!("{message}{place}");
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    #[allow(clippy::panic)]
    fn exact_a_panic_is_one_line_and_exit_code_4() {
        let failure = guarded::<u8>(|| panic!("two\nlines")).err();
        let failure = failure.unwrap_or_default();
        assert_eq!(failure.kind(), poinsot::ErrorKind::Internal);
        let message = failure.to_string();
        let line = message.rsplit_once(':').map_or("", |m| m.0);
        assert!(
            line.starts_with("E0009 internal error: two lines (poinsot-cli/src/guard.rs"),
            "{message}"
        );
        assert!(message.ends_with(
            ": this is a bug in poinsot; please report it with the command and, if possible, the input"
        ));
        assert!(!message.contains('\n'));
    }
}
