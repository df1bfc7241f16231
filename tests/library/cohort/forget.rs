//! A participant is forgotten in every recording and file.

use std::fs;

use tomcom::edge::forget;
use tomcom::run::simulate::Shard;

use super::{folder, paper, run};

#[test]
fn a_participant_is_forgotten_everywhere_and_nobody_else() {
    let out = folder("forget");
    run(&paper(10), 4, Shard::WHOLE, &out);
    let is_there = |name: &str| out.join(name).exists();
    let put = |name: &str, text: &str| {
        let path = out.join(name);
        fs::create_dir_all(path.parent().expect("a folder")).expect("made");
        fs::write(path, text).expect("written");
    };
    put("exports/trials.csv", "participant,note\nP01,\"two\nlines\"\nP02,\"of P011\"\nP01,x\n");
    put("exports/clean.csv", "participant\nP02\n");
    put("report.html", "<td>P01</td>");
    put("other.html", "<td>P011</td>");
    put("seed1-P01-2.rrd", "");
    put("study.toml", "participants = [\"P01\"]");
    put("seed1-P01-1/recording.rrd", "");
    put("seed1-P01-1-part2/session.toml", "[participant]\ncode = \"P01\"");
    let found = forget::find(&out, "P01").expect("readable");
    assert_eq!((found.recordings.len(), found.files.len(), found.tables.len()), (3, 2, 1), "{found:?}");
    // Nothing goes while one of the recordings is being written.
    let lock = tomcom::edge::log::RecordingLock::take(&out.join("seed1-P01-2")).expect("a lock");
    assert!(forget::delete(&found, "P01").expect_err("in use").to_string().contains("writes this recording"));
    assert!(is_there("report.html") && is_there("seed1-P01-1"));
    drop(lock);
    forget::delete(&found, "P01").expect("deleted");
    for gone in ["seed1-P01-1", "seed1-P01-2", "seed1-P01-1-part2", "report.html", "seed1-P01-2.rrd"] {
        assert!(!is_there(gone), "{gone}");
    }
    for stays in ["seed1-P02-1", "seed1-P02-2", "other.html", "study.toml", "exports/clean.csv"] {
        assert!(is_there(stays), "{stays}");
    }
    let table = fs::read_to_string(out.join("exports/trials.csv")).expect("a table");
    assert_eq!(table, "participant,note\nP02,\"of P011\"\n");
    assert!(forget::find(&out, "P01").expect("readable").is_empty());
}
