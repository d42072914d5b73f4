//! libFuzzer target for the entry `parser`.
#![no_main]

libfuzzer_sys::fuzz_target!(|input: &[u8]| rpi_fuzz::run("parser", input));
