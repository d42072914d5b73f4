//! libFuzzer target for the entry `cell`.
#![no_main]

libfuzzer_sys::fuzz_target!(|input: &[u8]| rpi_fuzz::run("cell", input));
