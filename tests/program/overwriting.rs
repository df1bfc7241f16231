//! Commands that write a file or a folder that they are told: what others have written there stays.

use std::fs;

use serial_test::serial;

use crate::forgetting::RecordingsFolder;

#[test]
#[serial]
fn what_others_wrote_is_not_overwritten_and_what_tomcom_wrote_is() {
    let lab = RecordingsFolder::of_two_people("overwriting");
    let root = lab.root.display().to_string();
    let (recording, other) = (format!("{root}/seed1-P01-1"), format!("{root}/seed1-P01-2"));
    let study = format!("{root}/results");
    let sweep = format!("{root}/sweep");
    let save = format!("--save={root}/stream");
    let (codes, fitted) = (format!("{root}/codes"), format!("{root}/fitted"));
    let commands: [(&[&str], &str); 6] = [
        (&["codes", &recording, "--export", &codes], "codes"),
        (&["fit", &recording, "--parameters", "lapse", "--tries", "10", "--out", &fitted], "fitted"),
        (&["review", &recording, &other, &save], "stream"),
        (&["study", &root, "--skip", "concepts", "--out", &study], "results/participants.csv"),
        (&["study", &root, "--skip", "concepts", "--out", &study], "results/report.html"),
        (
            &[
                "simulate",
                "sessions/burger.toml",
                "--arm",
                "timed",
                "--sweep",
                "gaze=off",
                "--concept",
                "none",
                "--out",
                &sweep,
            ],
            "sweep/sweep.csv",
        ),
    ];
    for (arguments, file) in commands {
        lab.put(file, "of somebody else\n");
        let (code, told) = lab.run(arguments);
        assert!(
            code == Some(1) && told.contains(file) && told.contains("a file is there that is not"),
            "{arguments:?}: {told}"
        );
        assert_eq!(lab.text(file), "of somebody else\n", "{arguments:?}");
        fs::remove_file(lab.at(file)).expect("removed");
        if file != "results/participants.csv" {
            for time in ["for the first time", "again"] {
                let (code, told) = lab.run(arguments);
                assert_eq!(code, Some(0), "{arguments:?} {time}: {told}");
            }
        }
    }
    lab.put("results/.rows/notes.txt", "of somebody else\n");
    assert_eq!(lab.run(commands[3].0).0, Some(1));
    assert_eq!(lab.text("results/.rows/notes.txt"), "of somebody else\n");
    lab.put("trials/seed1-S001/session.toml", "# of somebody else\n");
    let out = format!("{root}/trials");
    let (code, told) =
        lab.run(&["simulate", "sessions/default.toml", "--arm", "timed", "--trials", "1", "--out", &out]);
    assert!(code == Some(1) && told.contains("a session.toml that tomcom did not write"), "{told}");
    assert_eq!(lab.text("trials/seed1-S001/session.toml"), "# of somebody else\n");
}
