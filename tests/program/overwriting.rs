//! Commands that write a file or a folder that they are told: what others have written there stays.

use std::fs;
use std::process::{Command, Stdio};

use tomcom_session::log::LogWriter;

use crate::forgetting::{RecordingsFolder, ended, header};
use crate::program::TOMCOM;

#[test]
fn what_others_wrote_is_not_overwritten_and_what_tomcom_wrote_is() {
    let lab = RecordingsFolder::of_two_people("overwriting");
    let root = lab.root.display().to_string();
    let (recording, other) = (format!("{root}/seed1-P01-1"), format!("{root}/seed1-P01-2"));
    let study = format!("{root}/results");
    let save = format!("--save={root}/stream");
    let (codes, fitted) = (format!("{root}/codes"), format!("{root}/fitted"));
    let commands: [(&[&str], &str); 5] = [
        (&["codes", &recording, "--export", &codes], "codes"),
        (&["fit", &recording, "--parameters", "tau", "--tries", "10", "--out", &fitted], "fitted"),
        (&["review", &recording, &other, &save], "stream"),
        (&["study", &root, "--skip", "concepts", "--out", &study], "results/participants.csv"),
        (&["study", &root, "--skip", "concepts", "--out", &study], "results/report.html"),
    ];
    for (arguments, file) in commands {
        lab.put(file, "of somebody else\n");
        ended(lab.run(arguments), 1, &[file, "a file is there that is not"]);
        assert_eq!(lab.text(file), "of somebody else\n", "{arguments:?}");
        fs::remove_file(lab.at(file)).expect("removed");
        if file != "results/participants.csv" {
            for _ in ["for the first time", "again"] {
                ended(lab.run(arguments), 0, &[]);
            }
        }
    }
    lab.put("results/.rows/notes.txt", "of somebody else\n");
    ended(lab.run(commands[3].0), 1, &[]);
    assert_eq!(lab.text("results/.rows/notes.txt"), "of somebody else\n");
    lab.put("trials/seed1-S001/session.toml", "# of somebody else\n");
    let out = format!("{root}/trials");
    ended(
        lab.run(&["simulate", "sessions/default.toml", "--arm", "timed", "--trials", "1", "--out", &out]),
        1,
        &["a session.toml that tomcom did not write"],
    );
    assert_eq!(lab.text("trials/seed1-S001/session.toml"), "# of somebody else\n");
}

#[test]
fn a_stream_that_is_saved_elsewhere_overwrites_nothing_whatever_its_name_is() {
    let lab = RecordingsFolder::of_two_people("stream-elsewhere");
    let recording = lab.at("seed1-P01-1").display().to_string();
    lab.put("elsewhere/recording.rrd", "of somebody else\n");
    let save = format!("--save={}", lab.at("elsewhere/recording.rrd").display());
    ended(lab.run(&["review", &recording, &save]), 1, &["a file is there that is not a stream"]);
    assert_eq!(lab.text("elsewhere/recording.rrd"), "of somebody else\n");
    // Beside its log a damaged stream is made anew.
    lab.put("seed1-P01-1/recording.rrd", "damaged\n");
    ended(lab.run(&["review", &recording, "--save"]), 0, &[]);
    assert!(fs::read(lab.at("seed1-P01-1/recording.rrd")).expect("a stream").len() > 1000);
}

/// Runs a command that cannot write more than 512 bytes into a file, as on a full disk; all that it prints.
#[cfg(unix)]
fn run_on_a_full_disk(arguments: &[&str]) -> String {
    // In blocks of 512 bytes (POSIX); the signal that would end the program is ignored.
    let script = "trap '' XFSZ; ulimit -f 1; exec \"$@\"";
    let done = Command::new("sh").args(["-c", script, "sh", TOMCOM]).args(arguments).stdin(Stdio::null()).output();
    let done = done.expect("a shell");
    let told = String::from_utf8_lossy(&[done.stdout, done.stderr].concat()).into_owned();
    assert!(matches!(done.status.code(), Some(1 | 2)), "{arguments:?}: {told}");
    told
}

#[cfg(unix)]
#[test]
fn a_full_disk_destroys_no_earlier_results_and_leaves_no_half_file() {
    let lab = RecordingsFolder::of_two_people("full-disk");
    let recording = lab.at("seed1-P01-1").display().to_string();
    let path = |name: &str| lab.at(name).display().to_string();
    let fit = ["fit", &recording, "--parameters", "tau", "--tries", "10", "--out", &path("fitted.toml")];
    ended(lab.run(&fit), 0, &[]);
    let before = lab.files();
    assert!(before["fitted.toml"].len() > 512);
    run_on_a_full_disk(&fit);
    assert!(lab.files() == before, "the earlier file is whole, and nothing stands beside it");
    let freeze = ["plan", "sessions/study.toml", "--freeze", &path("frozen")];
    let told = run_on_a_full_disk(&freeze);
    assert!(told.contains("frozen: cannot be written"), "{told}");
    assert!(lab.files() == before, "no half of a frozen plan is left");
    ended(lab.run(&freeze), 0, &[]);
}

#[cfg(unix)]
#[test]
fn results_go_where_a_link_leads_and_into_a_pipe() {
    let lab = RecordingsFolder::of_two_people("links-and-pipes");
    let recording = lab.at("seed1-P01-1").display().to_string();
    lab.put("codes.csv", "");
    std::os::unix::fs::symlink("codes.csv", lab.at("link.csv")).expect("a link");
    ended(lab.run(&["codes", &recording, "--export", &lab.at("link.csv").display().to_string()]), 0, &[]);
    assert!(lab.at("link.csv").is_symlink() && lab.text("codes.csv").starts_with("recording,rater,press"));
    ended(lab.run(&["codes", &recording, "--export", "/dev/stdout"]), 0, &["recording,rater,press,cause,aspect"]);
}

#[test]
fn the_next_part_of_a_recording_overwrites_nothing() {
    let lab = RecordingsFolder::of_two_people("parts");
    let (header, recording) = (header(), lab.at("seed1-P01-1"));
    lab.put("seed1-P01-1-part2/session.toml", "# of somebody else\n");
    lab.put("seed1-P01-1-part3/recording.rrd", "of somebody else");
    fs::write(lab.at("seed1-P01-1-part4"), "of somebody else").expect("written");
    // What a kill before the log leaves behind.
    lab.put("seed1-P01-1-part5/session.toml", lab.text("seed1-P02-1/session.toml"));
    lab.put("seed1-P01-1-part5/events.jsonl.new", "{");
    lab.put("seed1-P01-1-part5/lock", "1\n");
    let part = LogWriter::create_part(&recording, &header).expect("a part").folder().to_path_buf();
    assert_eq!(part, lab.at("seed1-P01-1-part5"));
    assert_eq!(lab.text("seed1-P01-1-part2/session.toml"), "# of somebody else\n");
    assert_eq!(fs::read_dir(lab.at("seed1-P01-1-part2")).expect("a folder").count(), 1);
    assert_eq!(lab.text("seed1-P01-1-part4"), "of somebody else");
    let again = LogWriter::create_part(&recording, &header).expect_err("continued already").to_string();
    assert!(again.contains("continued already"), "{again}");
    let next = LogWriter::create_part(&part, &header).expect("the part after it");
    assert_eq!(next.folder(), lab.at("seed1-P01-1-part6"));
}

/// Whatever name a recording's files have while they are written: a link of that name is not followed.
#[cfg(unix)]
#[test]
fn no_file_of_a_recording_goes_where_a_link_leads() {
    use std::os::unix::fs::symlink;
    let lab = RecordingsFolder::of_two_people("no-link-followed");
    let (header, recording) = (header(), lab.at("seed1-P01-1"));
    lab.put("victim", "of somebody else");
    let plant = |folder: &str, name: &str| {
        fs::create_dir_all(lab.at(folder)).expect("a folder");
        symlink(lab.at("victim"), lab.at(folder).join(name)).expect("a link");
    };
    let names = ["events.jsonl.new", "session.toml", "session.toml.new", "recording.rrd", "lock"];
    for (nth, name) in names.into_iter().enumerate() {
        plant(&format!("seed1-P01-1-part{}", nth + 2), name);
    }
    fs::create_dir_all(lab.at("empty")).expect("a folder");
    symlink(lab.at("empty"), lab.at(&format!("seed1-P01-1-part{}", names.len() + 2))).expect("a link");
    let part = LogWriter::create_part(&recording, &header).expect("a part").folder().to_path_buf();
    assert_eq!(part, lab.at(&format!("seed1-P01-1-part{}", names.len() + 3)));
    assert_eq!(fs::read_dir(lab.at("empty")).expect("a folder").count(), 0);

    let out = lab.at("trials");
    let simulate = ["simulate", "sessions/burger.toml", "--seed", "1", "--arm", "timed", "--trials", "1", "--out"];
    let simulate = [&simulate[..], &[out.to_str().expect("UTF-8"), "--rerun"]].concat();
    for name in ["events.jsonl.new", "session.toml.new", "recording.rrd.new", "recording.rrd.toml", "recording.rrd"] {
        plant("trials/seed1-S001", name);
    }
    ended(lab.run(&simulate), 0, &[]);
    let made = out.join("seed1-S001");
    for name in ["events.jsonl", "session.toml", "recording.rrd", "recording.rrd.toml"] {
        assert!(made.join(name).symlink_metadata().is_ok_and(|data| data.is_file()), "{name} is a file");
    }
    plant("trials/seed1-S001", "recording.mcap.new");
    ended(lab.run(&["export", made.to_str().expect("UTF-8"), "--mcap"]), 0, &[]);
    assert_eq!(lab.text("victim"), "of somebody else");
}

#[cfg(unix)]
#[test]
fn a_recording_is_saved_among_the_temporary_files_into_a_folder_of_its_own_that_others_cannot_read() {
    use std::os::unix::fs::PermissionsExt;
    let lab = RecordingsFolder::of_two_people("saved");
    let saved = lab.rescued("gone");
    let folder = saved.parent().expect("a folder");
    assert_eq!(fs::metadata(folder).expect("a folder").permissions().mode() & 0o777, 0o700);
    assert!(saved.join("events.jsonl").is_file());
    fs::remove_dir_all(folder).expect("removed");
}
