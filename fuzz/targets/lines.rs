//! libFuzzer target for the entry `lines`.
#![no_main]

libfuzzer_sys::fuzz_target!(|input: &[u8]| rpi_fuzz::run("lines", input));
