//! Locks of recordings, files that are replaced as a whole, and the places of settings in their files.

use std::io::Write;

use tomcom_session::files::file_error::place_of;
use tomcom_session::files::replace_file::{Replacement, put, replace, replaced_name};
use tomcom_session::log::{LOCK_NAME, LockHolder, RecordingLock};

use crate::support::*;

#[test]
fn a_lock_tells_who_writes_and_where_viewers_look_on_until_it_is_dropped() {
    let home = tempfile::tempdir().unwrap();
    let folder = home.path();
    assert_eq!(RecordingLock::holder(folder), None);
    let mut lock = RecordingLock::take(folder).unwrap();
    let pid = Some(std::process::id());
    assert_eq!(RecordingLock::holder(folder), Some(LockHolder { pid, viewers: None }));
    lock.announce("rerun+http://127.0.0.1:9876/proxy").unwrap();
    let viewers = Some("rerun+http://127.0.0.1:9876/proxy".to_string());
    assert_eq!(RecordingLock::holder(folder), Some(LockHolder { pid, viewers }));
    drop(lock);
    assert_eq!(RecordingLock::holder(folder), None);
    fs::write(folder.join(LOCK_NAME), "1\n").unwrap();
    assert_eq!(RecordingLock::holder(folder), None, "what a killed program left behind is held by nobody");
}

#[cfg(unix)]
#[test]
fn a_file_that_a_link_leads_to_is_left_as_it_is() {
    let home = tempfile::tempdir().unwrap();
    let folder = home.path();
    let other = folder.join("notes.txt");
    fs::write(&other, "of somebody else").unwrap();
    std::os::unix::fs::symlink(&other, folder.join(LOCK_NAME)).unwrap();
    let refusal = RecordingLock::take(folder).unwrap_err().to_string();
    assert!(refusal.contains("a link"), "{refusal}");
    assert_eq!(fs::read_to_string(&other).unwrap(), "of somebody else");
}

fn names(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> =
        fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    names
}

#[test]
fn a_file_is_replaced_when_it_is_complete_and_what_stands_beside_it_stays() {
    let folder = tempfile::tempdir().unwrap();
    let (path, beside) = (folder.path().join("codes.csv"), folder.path().join("codes.csv.new"));
    fs::write(&path, "old").unwrap();
    fs::write(&beside, "of somebody else").unwrap();
    let mut begun = Replacement::begin(&path).unwrap();
    let name = begun.new_path().file_name().unwrap().to_str().unwrap().to_string();
    assert_eq!(replaced_name(&name), "codes.csv", "{name}: a file that a killed program leaves is known");
    begun.write_all(b"half").unwrap();
    begun.complete().unwrap();
    assert_eq!(fs::read_to_string(&path).unwrap(), "old");
    drop(begun);
    assert_eq!(names(folder.path()), ["codes.csv", "codes.csv.new"], "nothing is left of what was not completed");
    replace(&path, b"new").unwrap();
    assert_eq!(fs::read_to_string(&path).unwrap(), "new");
    assert_eq!(fs::read_to_string(&beside).unwrap(), "of somebody else");
    assert_eq!(names(folder.path()).len(), 2);
}

#[cfg(unix)]
#[test]
fn the_new_file_has_the_permissions_of_the_old_one() {
    use std::os::unix::fs::PermissionsExt;
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("codes.csv");
    fs::write(&path, "old").unwrap();
    fs::set_permissions(&path, fs::Permissions::from_mode(0o640)).unwrap();
    replace(&path, b"new").unwrap();
    assert_eq!(fs::metadata(&path).unwrap().permissions().mode() & 0o777, 0o640);
    let (made, put_there) = (folder.path().join("made"), folder.path().join("put"));
    fs::write(&made, "").unwrap();
    put(&put_there, b"").unwrap();
    let mode = |path: &Path| fs::metadata(path).unwrap().permissions().mode() & 0o777;
    assert_eq!(mode(&put_there), mode(&made), "a new file has the permissions that the system gives to new files");
}

#[test]
fn a_file_that_a_killed_program_left_is_known_by_the_name_that_it_was_to_get() {
    for name in ["codes.csv", "codes.csv.new", "codes.csv.tomcom-a1B2c3.new"] {
        assert_eq!(replaced_name(name), "codes.csv", "{name}");
    }
    assert_eq!(replaced_name("codes.tomcom-x.new"), "codes.tomcom-x");
}

const TEXT: &str = "name = \"a\"\n[tracker]\naddress = \"b\"\n[rerun]\naddress = \"c\"\n[human.decision]\ntau = 1\n\
                    [[item]]\nid = \"d\"\n[[item]]\nid = \"e\"\n[plan]\nform = { after = [2] }\n";

fn line(path: &str, nth: usize) -> Option<&str> {
    place_of(TEXT, path, nth).map(|place| &TEXT[place])
}

#[test]
fn a_setting_is_found_in_its_own_table() {
    assert_eq!(line("rerun.address", 0), Some("address = \"c\""));
    assert_eq!(line("tracker.address", 0), Some("address = \"b\""));
    assert_eq!(line("human.tau", 0), Some("tau = 1"));
    assert_eq!(line("item.id", 1), Some("id = \"e\""));
    assert_eq!(line("form.after", 0), Some("after = [2]"));
    assert_eq!(line("name", 0), Some("name = \"a\""));
    assert_eq!(line("display.address", 0), None);
}
