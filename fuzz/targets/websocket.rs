//! libFuzzer target for the entry `websocket`.
#![no_main]

libfuzzer_sys::fuzz_target!(|input: &[u8]| rpi_fuzz::run("websocket", input));
