//! `tomcom export`: what it tells, what it refuses, and what `tomcom forget` says of an export.

use crate::forgetting::{RecordingsFolder, ended};

#[test]
fn an_export_is_told_and_goes_into_an_empty_folder_only() {
    let lab = RecordingsFolder::of_two_people("export");
    lab.give("seed1-P01-2", "P-01");
    let [root, tree] = [lab.root.clone(), lab.at("../bids")].map(|path| path.display().to_string());
    let _ = std::fs::remove_dir_all(&tree);
    let told = ended(lab.run(&["export", &root, "--bids", &tree]), 0, &[]);
    assert!(told.contains("4 recordings") && told.contains("the code P-01 is sub-P01x2"), "{told}");
    assert!(lab.at("../bids/sub-P01x2/ses-trial2/beh/sub-P01x2_ses-trial2_task-sushi_events.tsv").exists(), "{told}");
    let people = lab.text("../bids/participants.tsv");
    assert!(people.contains("sub-P01x2\tP-01\tsimulated\t"), "{people}");
    ended(lab.run(&["export", &root, "--bids", &tree]), 2, &["not empty", "a new or empty folder"]);
    ended(lab.run(&["export", &root]), 2, &["--bids"]);
}

#[test]
fn a_data_set_with_somebody_who_is_forgotten_is_named_and_left() {
    let lab = RecordingsFolder::of_two_people("exported");
    let root = lab.root.display().to_string();
    let tree = lab.at("bids").display().to_string();
    ended(lab.run(&["export", &root, "--bids", &tree]), 0, &[]);
    ended(lab.forget(&["P01", "--yes"]), 1, &["bids: a BIDS data set of tomcom export"]);
    assert!(lab.at("bids/sub-P01").exists() && !lab.at("seed1-P01-1").exists());
    let told = ended(lab.forget(&["P03", "--yes"]), 1, &[]);
    assert!(!told.contains("BIDS"), "{told}");
    std::fs::remove_dir_all(lab.at("bids")).expect("deleted by hand");
    ended(lab.forget(&["P02", "--yes"]), 0, &[]);
}
