//! libFuzzer target for the entry `http`.
#![no_main]

libfuzzer_sys::fuzz_target!(|input: &[u8]| rpi_fuzz::run("http", input));
