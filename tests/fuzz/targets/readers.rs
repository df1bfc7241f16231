//! The fuzz target of one reader, which the environment names: [`read`].
#![no_main]

use std::sync::OnceLock;

mod read;

static READER: OnceLock<read::Reader> = OnceLock::new();

/// The reader that `TOMCOM_READER` names.
fn chosen() -> read::Reader {
    let name = std::env::var("TOMCOM_READER").unwrap_or_default();
    let found = read::READERS.into_iter().find(|(known, _)| *known == name);
    found.unwrap_or_else(|| panic!("TOMCOM_READER=\"{name}\" names no reader of targets/read/mod.rs")).1
}

libfuzzer_sys::fuzz_target!(|data: &[u8]| READER.get_or_init(chosen)(data));
