//! The fuzz target of the readers: [`read`].
#![no_main]

mod read;

libfuzzer_sys::fuzz_target!(|data: &[u8]| read::read(data));
