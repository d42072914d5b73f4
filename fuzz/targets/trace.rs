//! libFuzzer target for the entry `trace`.
#![no_main]

libfuzzer_sys::fuzz_target!(|input: &[u8]| rpi_fuzz::run("trace", input));
