//! Whatever files hold, reading them gives a value or an error that can be shown.

use std::fs;

#[path = "../fuzz/targets/read/mod.rs"]
mod read;

/// What fuzzing does with the readers, with what it begins with, and with every file cut and changed at many places.
#[test]
fn the_readers_survive_cut_and_changed_files() {
    let seeds = [
        (0, "layouts/sushi.toml"),
        (0, "layouts/burger.toml"),
        (1, "recipes/sushi.toml"),
        (2, "sessions/default.toml"),
        (2, "sessions/study.toml"),
        (4, "sessions/questionnaires/acceptance.toml"),
    ];
    for (kind, path) in seeds {
        let text = fs::read(path).unwrap_or_else(|error| panic!("{path}: {error}"));
        for at in (0..text.len()).step_by(text.len().div_ceil(10)) {
            let mut changed = [&[kind], &text[..]].concat();
            read::read(&changed[..=at]);
            changed[at + 1] = changed[at + 1].wrapping_add(1) | 1;
            read::read(&changed);
        }
    }
    let log = fs::read("tests/golden/format-1-hand.jsonl").expect("a log");
    let events = log.splitn(2, |byte| *byte == b'\n').nth(1).expect("events after the header");
    for (kind, text) in [(3, &log[..]), (7, events)] {
        let text = &text[..text.len().min(60_000)];
        for at in (0..text.len()).step_by(text.len() / 10) {
            read::read(&[&[kind], &text[..at], b"\xff\x00}", &text[at..]].concat());
        }
    }
}
