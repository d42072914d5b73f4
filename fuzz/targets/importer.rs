//! libFuzzer target for the entry `importer`.
#![no_main]

libfuzzer_sys::fuzz_target!(|input: &[u8]| rpi_fuzz::run("importer", input));
