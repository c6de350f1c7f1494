#![no_main]
libfuzzer_sys::fuzz_target!(|bytes: &[u8]| poinsot_fuzz::onboard(bytes));
