//! libFuzzer target for the entry `image`.
#![no_main]

libfuzzer_sys::fuzz_target!(|input: &[u8]| rpi_fuzz::run("image", input));
