//! File input and output. Inputs are opened by [`open`], outputs are put in place by a [`Stage`], and text from files
//! is printed by [`escaped`] and [`error_line`].

mod input;
mod plain;
mod stage;

pub use input::{InputError, open, read, read_text, spooled, standard_input};
pub use plain::{
    LONGEST_LINE, error_line, escaped, escaped_lines, excerpt, is_unprintable, json_escaped,
};
pub use stage::{Stage, StageError, check_target, folder_of, is_same_file, remove_stages};
