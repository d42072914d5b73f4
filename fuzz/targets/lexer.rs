//! The entry `lexer` under a fuzzer.
#![no_main]

libfuzzer_sys::fuzz_target!(|input: &[u8]| rpi_fuzz::run("lexer", input));
