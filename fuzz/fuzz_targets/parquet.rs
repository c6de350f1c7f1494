#![no_main]
use std::panic::{catch_unwind, set_hook};
use std::sync::Mutex;

/// What the last panic said.
static LAST: Mutex<String> = Mutex::new(String::new());

// The reader catches the panics of the Parquet decoder and makes an error of them; only what gets past it is a finding.
libfuzzer_sys::fuzz_target!(
    init: set_hook(Box::new(|panic| {
        if let Ok(mut last) = LAST.lock() {
            *last = panic.to_string();
        }
    })),
    |bytes: &[u8]| {
        if catch_unwind(|| poinsot_fuzz::parquet(bytes)).is_err() {
            if let Ok(last) = LAST.lock() {
                eprintln!("{last}");
            }
            std::process::abort();
        }
    }
);
