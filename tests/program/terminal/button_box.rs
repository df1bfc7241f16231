//! A participant's button box: the program reads it at a pseudo terminal, as from a serial line.

use std::fs::{self, File};
use std::io::Write;
use std::os::unix::fs::symlink;
use std::path::{Path, PathBuf};

use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};

use crate::pseudo_terminal::Terminal;

/// The box's end of the line, with its path, which is the same when the box is plugged in again, as those below
/// /dev/serial/by-id are.
struct ButtonBox(File, PathBuf);

impl ButtonBox {
    fn plugged_in(path: &Path) -> ButtonBox {
        let line = openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY | OpenptFlags::CLOEXEC).expect("a pseudo terminal");
        grantpt(&line).and_then(|()| unlockpt(&line)).expect("it opens");
        let name = ptsname(&line, Vec::new()).expect("a name").into_string().expect("UTF-8");
        symlink(name, path).expect("a path");
        ButtonBox(File::from(line), path.to_path_buf())
    }

    /// The path goes first: its terminal's number is given to the next one that is opened.
    fn unplugged(self) {
        fs::remove_file(self.1).expect("removed");
    }

    fn sends(&self, bytes: &[u8]) {
        (&self.0).write_all(bytes).expect("written");
    }
}

/// The default session with a button box at this path.
fn session_with_box(terminal: &Terminal, path: &Path) -> String {
    let layouts = format!("{}/layouts", env!("CARGO_MANIFEST_DIR"));
    let text = fs::read_to_string("sessions/default.toml").expect("the default session");
    let text = text.replace("../layouts", &layouts).replace("\"simulated\"", "\"keyboard\"");
    let text = text.replace("gaze = \"keyboard\"", "gaze = \"none\"");
    let text = text.replace("[tracker]", &format!("button_box = {:?}\n[tracker]", path.display().to_string()));
    let session = terminal.folder.join("session.toml");
    fs::write(&session, text).expect("written");
    session.display().to_string()
}

fn press_of(button: &str) -> String {
    format!("\"kind\":\"press\",\"agent\":\"human\",\"button\":\"{button}\",\"at_ns\":")
}

#[test]
fn presses_of_a_box_count_what_is_none_is_told_and_a_box_plugged_in_again_goes_on() {
    let terminal = Terminal::open("button-box");
    let path: PathBuf = terminal.folder.join("ttyACM0");
    let session = session_with_box(&terminal, &path);
    let out = terminal.recordings();
    terminal.run(&["operate", &session, "--out", &out]);
    terminal.see("READY");
    terminal.see("NO BUTTONS");
    terminal.key("C-f");
    terminal.see("FAILED   button box");
    terminal.key("Escape");
    let button_box = ButtonBox::plugged_in(&path);
    terminal.see("buttons ok");
    button_box.sends(b"take rice\r\n");
    terminal.see("the button box pressed take rice: it counts while the trial runs");
    terminal.key("C-f");
    terminal.see("ok       button box");
    terminal.key("Escape");

    terminal.begin();
    button_box.sends(b"take rice\r\n");
    terminal.wait("a press", || terminal.count(&press_of("take rice")) == 2);
    terminal.see("1/304");
    button_box.sends(b"take the rice\r\n");
    terminal.see("the button box sent no press: \"take the rice\", which is no button of the layout");
    // The cooking pot's number in the layout.
    button_box.sends(b"4\n");
    terminal.wait("a press by number", || terminal.count(&press_of("cooking_pot")) == 1);
    terminal.see("2/304");

    button_box.unplugged();
    terminal.see("NO BUTTONS");
    terminal.see("the button box is not there, and connects by itself once it is");
    let button_box = ButtonBox::plugged_in(&path);
    terminal.see("buttons ok");
    button_box.sends(b"cook\n");
    terminal.wait("a press of the box that is back", || terminal.count(&press_of("cook")) == 1);
    // A box that sends as fast as it can stops neither the console nor the trial.
    button_box.sends(&b"trash\n".repeat(500));
    terminal.wait("the refused flood", || terminal.count("\"found\":\"more than 20 presses within a second\"") > 0);
    terminal.quit();
    terminal.verifies();

    let log = terminal.log();
    let presses = log.lines().filter(|line| line.contains("\"agent\":\"human\""));
    assert!(presses.clone().count() > 4 && presses.clone().all(|line| line.contains("\"button_box\":true")), "{log}");
    let kinds = |what: &str| terminal.count(&format!("\"kind\":\"button_box\",\"what\":\"{what}\""));
    assert_eq!((kinds("connected"), kinds("lost")), (2, 2), "{log}");
}

#[test]
fn doctor_opens_the_box() {
    let terminal = Terminal::open("button-box-doctor");
    let path = terminal.folder.join("ttyACM0");
    let session = session_with_box(&terminal, &path);
    let found = || {
        let output = crate::program::tomcom(&["doctor", &session, "--format", "json"]);
        let told: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
        let checks = told["checks"].as_array().expect("checks").clone();
        checks.into_iter().find(|check| check["name"] == "button box").expect("a check")
    };
    let missing = found();
    assert_eq!(missing["verdict"], "failed");
    assert!(missing["found"].as_str().is_some_and(|text| text.contains("No such file")), "{missing}");
    let _button_box = ButtonBox::plugged_in(&path);
    assert_eq!(found()["verdict"], "ok");
}
