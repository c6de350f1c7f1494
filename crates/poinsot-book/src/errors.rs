//! The page of error codes, from `poinsot explain`.

use crate::commands::{GENERATED, cell};
use poinsot::explain::error_codes;
use std::fmt::Write;

/// The page `errors.md`.
pub fn page() -> String {
    let mut out = "# Error codes\n\n".to_owned();
    out.push_str(GENERATED);
    out.push_str(
        "An error is one line: code, place, the value as read, what is wrong, what to do. `poinsot explain CODE` says in the \
         terminal what stands here. Codes stay what they are.\n\n\
         | code | meaning | usual cause | what to do |\n|---|---|---|---|\n",
    );
    for c in error_codes() {
        let _ = writeln!(
            out,
            "| `{}` | {} | {} | {} |",
            c.code,
            cell(c.meaning),
            cell(c.cause),
            cell(c.remedy)
        );
    }
    out
}
