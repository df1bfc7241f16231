//! An external concept beside a live session: a program that answers, and programs that do all they can to disturb.

use std::fs;

use crate::pseudo_terminal::Terminal;

/// A program in `sh` that sends the first signal of every question, and tells its process number.
const ANSWERS: &str = r#"echo $$ > pid; while read -r line; do rest=${line#*\"id\":}; id=${rest%%,*}; case $line in *'"ask":"begin"'*) echo '{"id":0,"protocol":1,"name":"mine"}';; *'"ask":"end"'*) exit 0;; *'"signals":[]'*) echo "{\"id\":$id}";; *) rest=${line#*\"signals\":\[}; echo "{\"id\":$id,\"send\":${rest%%\}*}},\"reason\":\"it comes first\"}";; esac; done"#;

#[test]
fn a_wizard_is_offered_what_a_program_recommends_and_it_ends_with_the_session() {
    let terminal = Terminal::open("external-offers");
    let pid = terminal.recordings() + "/pid";
    fs::create_dir_all(terminal.recordings()).expect("a folder");
    let program = ANSWERS.replace("> pid", &format!("> '{pid}'"));
    terminal.operate("default.toml", &["--condition", "wizard", "--concept", &program]);
    terminal.see("external concept began: mine");
    terminal.begin();
    terminal.see("it comes first");
    terminal.see("SHOW RECIPE OF ORDER 1");
    // The key does not take an offer that has only just opened.
    terminal.wait("the signal", || {
        terminal.key("Enter");
        terminal.count("signal_shown") > 0
    });
    terminal.quit();
    terminal.verifies();
    let pid = fs::read_to_string(pid).expect("the program ran");
    let stat = fs::read_to_string(format!("/proc/{}/stat", pid.trim())).unwrap_or_default();
    assert!(stat.is_empty() || stat.contains(") Z "), "{stat}");
}

/// A participant in `sh` that wants rice three times, and fails then.
const WANTS_RICE: &str = r#"n=0; while read -r line; do rest=${line#*\"id\":}; id=${rest%%,*}; case $line in *'"ask":"begin"'*) echo '{"id":0,"protocol":1,"name":"mine"}';; *) n=$((n+1)); if [ $n -gt 3 ]; then echo tired >&2; exit 4; fi; echo "{\"id\":$id,\"press\":\"take rice\",\"after_s\":0.2}";; esac; done"#;

#[test]
fn a_program_takes_the_participants_part_until_it_fails() {
    let terminal = Terminal::open("external-participant");
    fs::create_dir_all(terminal.recordings()).expect("a folder");
    let session = terminal.recordings() + "/program.toml";
    let layout = concat!(env!("CARGO_MANIFEST_DIR"), "/layouts/sushi.toml");
    let participant = format!("kind = \"external\"\ngaze = \"none\"\nexternal = '''{WANTS_RICE}'''\n");
    let settings = format!("layout = {layout:?}\nseed = 1\n[robot]\narm = \"timed\"\n[participant]\n{participant}");
    fs::write(&session, settings).expect("a session file");
    terminal.run(&["operate", &session, "--out", &terminal.recordings()]);
    terminal.see("READY");
    terminal.wait("its name", || terminal.count("\"role\":\"participant\",\"name\":\"mine\"") > 0);
    terminal.begin();
    terminal.wait("its end", || terminal.count("exit code 4: tired") > 0);
    assert_eq!(terminal.count("\"kind\":\"press\",\"agent\":\"human\""), 3);
    let presses = || terminal.count("\"kind\":\"press\",\"agent\":\"robot\"");
    let before = presses();
    terminal.wait("the session goes on", || presses() > before);
    terminal.quit();
    terminal.verifies();
}

#[test]
fn programs_that_crash_flood_and_hang_leave_the_session_running() {
    for (name, program, told) in [
        ("crash", "echo oh dear >&2; exit 3", "exit code 3: oh dear"),
        ("flood", "yes '{}'", "\"fault\":\"given_up\""),
        ("line", "head -c 100000000 /dev/zero; sleep 1000", "a line of more than 1 MB"),
        ("hang", "sleep 1000", "\"fault\":\"silent\""),
    ] {
        let terminal = Terminal::open(&format!("external-{name}"));
        terminal.operate("default.toml", &["--condition", "assistant", "--concept", program]);
        terminal.begin();
        terminal.wait(told, || terminal.count(told) > 0);
        if name == "crash" {
            terminal.see("external concept has ended: exit code 3: oh dear");
        }
        let presses = || terminal.count("\"kind\":\"press\"");
        let before = presses();
        terminal.wait("the session goes on", || presses() > before + 3);
        terminal.quit();
        terminal.verifies();
    }
}

#[test]
fn a_killed_session_leaves_no_program_behind_that_ignores_the_end_of_its_input() {
    let terminal = Terminal::open("external-killed");
    let pid = terminal.recordings() + "/pid";
    fs::create_dir_all(terminal.recordings()).expect("a folder");
    // Neither the end of its input nor a request to end stops it.
    let stubborn =
        format!("trap '' TERM HUP; {}; sleep 1000 & sleep 1000", ANSWERS.replace("> pid", &format!("> '{pid}'")));
    terminal.operate("default.toml", &["--condition", "wizard", "--concept", &stubborn]);
    terminal.see("external concept began: mine");
    terminal.kill();
    let pid = fs::read_to_string(pid).expect("the program ran");
    terminal.wait("the program's end", || {
        let stat = fs::read_to_string(format!("/proc/{}/stat", pid.trim())).unwrap_or_default();
        stat.is_empty() || stat.contains(") Z ")
    });
}
