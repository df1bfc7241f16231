//! `tomcom export`: what it tells, what it refuses, and what `tomcom forget` says of an export.

use crate::forgetting::RecordingsFolder;

#[test]
fn an_export_is_told_and_goes_into_an_empty_folder_only() {
    let lab = RecordingsFolder::of_two_people("export");
    lab.give("seed1-P01-2", "P-01");
    let [root, tree] = [lab.root.clone(), lab.at("../bids")].map(|path| path.display().to_string());
    let _ = std::fs::remove_dir_all(&tree);
    let (code, told) = lab.run(&["export", &root, "--bids", &tree]);
    assert_eq!(code, Some(0), "{told}");
    assert!(told.contains("4 recordings") && told.contains("the code P-01 is sub-P01x2"), "{told}");
    assert!(lab.at("../bids/sub-P01x2/ses-trial2/beh/sub-P01x2_ses-trial2_task-sushi_events.tsv").exists(), "{told}");
    let people = lab.text("../bids/participants.tsv");
    assert!(people.contains("sub-P01x2\tP-01\tsimulated\t"), "{people}");
    let (code, told) = lab.run(&["export", &root, "--bids", &tree]);
    assert!(code == Some(2) && told.contains("not empty") && told.contains("a new or empty folder"), "{told}");
    let (code, told) = lab.run(&["export", &root]);
    assert!(code == Some(2) && told.contains("--bids"), "{told}");
}

#[test]
fn a_data_set_with_somebody_who_is_forgotten_is_named_and_left() {
    let lab = RecordingsFolder::of_two_people("exported");
    let root = lab.root.display().to_string();
    let tree = lab.at("bids").display().to_string();
    assert_eq!(lab.run(&["export", &root, "--bids", &tree]).0, Some(0));
    let (code, told) = lab.forget(&["P01", "--yes"]);
    assert!(code == Some(1) && told.contains("bids: a BIDS data set of tomcom export"), "{told}");
    assert!(lab.at("bids/sub-P01").exists() && !lab.at("seed1-P01-1").exists());
    let (code, told) = lab.forget(&["P03", "--yes"]);
    assert!(code == Some(1) && !told.contains("BIDS"), "{told}");
    std::fs::remove_dir_all(lab.at("bids")).expect("deleted by hand");
    assert_eq!(lab.forget(&["P02", "--yes"]).0, Some(0));
}
