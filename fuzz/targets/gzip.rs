//! libFuzzer target for the entry `gzip`.
#![no_main]

libfuzzer_sys::fuzz_target!(|input: &[u8]| rpi_fuzz::run("gzip", input));
