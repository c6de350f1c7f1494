//! File input and output. Inputs are opened by [`open`], outputs are put in place by a [`Stage`], and text from files
//! is printed by [`escaped`] and [`error_line`]. Numbers in text: [`short`], [`rounded`], [`number_with_sigma`].
//!
//! Every error of the project is a [`Fault`]; [`Faults`] is the error type of all crates that read or write files.
//!
//! # Files
//! - `fault.rs`: code, place, value, problem and advice of an error as data, and its line of text.
//! - `budget.rs`: refuses work whose estimated memory or time is above a limit.
//! - `input.rs`: opens every input: a regular file, up to a size limit.
//! - `stage.rs`: drafts in a hidden folder. Earlier files are kept until all drafts are in place, and restored on
//!   failure. Folders of killed runs are removed.
//! - `plain.rs`: escapes unprintable characters and shortens error lines to 300 characters.
//! - `numbers.rs`: numbers in text: significant digits, with a sigma. `once.rs`: a list without repetition.

mod budget;
mod fault;
mod input;
mod nearest;
mod numbers;
mod once;
mod plain;
mod stage;

pub use budget::{
    Pace, check_memory, check_time, given_memory_limit, limit_hours, limit_memory, memory_limit,
    stated, time_limit,
};
pub use fault::{Fault, FaultKind, Faults, MOST_FAULTS, Place, io_advice};
pub use input::{InputError, open, read, read_text, read_tree, spooled, standard_input};
pub use nearest::nearest;
pub use numbers::{
    HALF_WIDTH_95, as_read, counted, list, number_with_sigma, probability, rounded, short,
    significant, to_digits,
};
pub use once::each_once;
pub use plain::{
    LONGEST_LINE, error_line, escaped, escaped_lines, excerpt, is_unprintable, json_escaped,
};
pub use stage::{Stage, check_target, folder_of, growing, is_same_file, remove_stages};
