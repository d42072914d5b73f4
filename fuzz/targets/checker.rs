//! libFuzzer target for the entry `checker`.
#![no_main]

libfuzzer_sys::fuzz_target!(|input: &[u8]| rpi_fuzz::run("checker", input));
