//! libFuzzer target for the entry `lexer`.
#![no_main]

libfuzzer_sys::fuzz_target!(|input: &[u8]| rpi_fuzz::run("lexer", input));
