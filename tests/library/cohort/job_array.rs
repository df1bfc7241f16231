//! Parts of a job array, and folders that were begun before.

use tomcom_study::analysis::trial_summary::SimulationSummary;

use super::{folder, paper, run};
use crate::support::*;

/// Every file below a folder, with what is in it, by its path there.
fn below(folder: &Path) -> Vec<(PathBuf, Vec<u8>)> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry").path()) {
        let name = PathBuf::from(entry.file_name().expect("a name"));
        match entry.is_dir() {
            true => found.extend(below(&entry).into_iter().map(|(path, bytes)| (name.join(path), bytes))),
            false => found.push((name, fs::read(&entry).expect("a file"))),
        }
    }
    found.sort();
    found
}

#[test]
fn the_parts_of_a_job_array_are_the_whole_and_have_nothing_in_common() {
    let files = paper(30);
    let (whole, parts) = (folder("whole"), folder("parts"));
    let figures = run(&files, 5, SimulationShard::WHOLE, &whole);
    assert_eq!((figures.trials, figures.found), (5, 0));
    let mut made = Vec::new();
    for number in 1..=3 {
        let part = run(&files, 5, SimulationShard { number, of: 3 }, &parts);
        assert_eq!(part.found, 0, "no part makes what another one made");
        made.extend(part.recordings);
    }
    assert_eq!(made.len(), 5);
    assert!(below(&whole) == below(&parts), "the parts together are the whole, byte for byte");
    let empty = run(&files, 2, SimulationShard { number: 3, of: 3 }, &folder("none"));
    assert_eq!((empty.trials, empty.beliefs.mean_sequence_length), (0, None), "a part may have nothing to do");
    for text in ["0/3", "4/3", "1", "1/0", "a/b", "-1/2"] {
        assert!(text.parse::<SimulationShard>().is_err(), "{text}");
    }
}

#[test]
fn a_folder_that_was_begun_is_gone_on_with() {
    let (files, out) = (paper(30), folder("begun"));
    let first = run(&files, 4, SimulationShard::WHOLE, &out);
    let before = below(&out);
    // A kill: one log without its end, one recording that is not there yet.
    let cut = Path::new(&first.recordings[1]).join(LOG_NAME);
    let text = fs::read_to_string(&cut).expect("a log");
    fs::write(&cut, &text[..text.len() * 2 / 3]).expect("written");
    fs::remove_dir_all(&first.recordings[3]).expect("removed");
    let again = run(&files, 4, SimulationShard::WHOLE, &out);
    assert_eq!(again.found, 2, "what is whole is read");
    assert!(below(&out) == before, "and the rest is made as it would have been");
    let bare = |figures: &SimulationSummary| SimulationSummary { wall_s: 0.0, found: 0, ..figures.clone() };
    assert_eq!(bare(&first), bare(&again), "what is read counts as what is made");
}
