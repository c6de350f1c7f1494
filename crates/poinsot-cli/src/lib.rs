//! The words of the command line, for the program, its man pages and the book.

pub mod arguments;
mod words;
