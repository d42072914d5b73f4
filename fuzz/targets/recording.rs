//! libFuzzer target for the entry `recording`.
#![no_main]

libfuzzer_sys::fuzz_target!(|input: &[u8]| rpi_fuzz::run("recording", input));
