//! The committed book: generated pages are current, it builds, and no link is broken.
#![allow(clippy::unwrap_used, clippy::panic)]

use poinsot_book::{bad_input, links, pages, site};
use poinsot_testkit::advice::says_what_to_do;

#[test]
fn cli_generated_pages_are_what_the_program_says() {
    if let Err(why) = pages::check() {
        panic!("{why}");
    }
}

#[test]
fn cli_the_book_builds_and_its_links_lead_somewhere() {
    let folder = tempfile::tempdir().unwrap();
    site::build(folder.path()).unwrap();
    let found = links::check(folder.path()).unwrap();
    assert!(found.pages > 15, "{found:?}");
    let page = |name: &str| std::fs::read_to_string(folder.path().join(name)).unwrap();
    // Formulas are rendered without a script, snippets are included, and methods are listed without a line in
    // SUMMARY.md.
    let state = page("explanation/state.html");
    assert!(state.contains("<math display=\"block\"") || state.contains("display=\"block\""));
    assert!(!state.contains("$$"));
    assert!(state.contains("twist_from_momentum"));
    assert!(!state.contains("ANCHOR"));
    assert!(page("methods/kim2010.html").contains("kim2010/fig1_euler_angles.svg"));
}

#[test]
fn exact_every_code_has_an_example_that_says_what_to_do() {
    let messages = bad_input::messages().unwrap();
    for code in poinsot::explain::error_codes() {
        let (message, _) = messages
            .get(code.code)
            .unwrap_or_else(|| panic!("no case prints {}", code.code));
        assert!(says_what_to_do(message), "no advice: {message}");
    }
}
