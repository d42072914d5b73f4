//! libFuzzer target for the entry `directio`.
#![no_main]

libfuzzer_sys::fuzz_target!(|input: &[u8]| rpi_fuzz::run("directio", input));
