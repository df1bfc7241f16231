//! Observers of the wizard's screen: what they see and remark.

use std::net::{Ipv4Addr, SocketAddr};

use serde_json::json;

use crate::program::done;
use crate::pseudo_terminal::Terminal;
use crate::raw_page::RawObserver;

impl RawObserver {
    /// Sends a remark; why it is in no recording, `None` if it is.
    fn remark(&mut self, number: u64, note: &str) -> Option<String> {
        self.page.say(&json!({"kind": "remark", "number": number, "note": note}));
        let answer = self.page.hear("remark").expect("an answer");
        answer["refused"].as_str().map(str::to_string)
    }
}

#[test]
fn an_observer_sees_the_wizards_screen_and_remarks_in_the_recording() {
    let terminal = Terminal::open("observers");
    terminal.operate("default.toml", &["--observe=127.0.0.1:0"]);
    terminal.key("C-f");
    let url = "0 of at most 20 watch this screen at http://127.0.0.1:";
    terminal.see(url);
    let screen = terminal.screen();
    let port: String =
        screen.split(url).nth(1).map(|rest| rest.chars().take_while(char::is_ascii_digit).collect()).expect("a port");
    let address = SocketAddr::new(Ipv4Addr::LOCALHOST.into(), port.parse().expect("a number"));
    let mut observer = RawObserver::open(address);
    assert_eq!(observer.joins("page", "O1", None).as_deref(), Some("welcome"));
    let text = |screen: String| screen.lines().map(str::trim_end).collect::<Vec<_>>().join("\n").trim_end().to_string();
    let mut same = |what: &str, words: &str| {
        terminal.wait(what, || {
            let seen = observer.screen();
            seen.contains(words) && seen == text(terminal.screen())
        });
    };
    same("the list of checks on the observer's page", "1 of at most 20 watch");
    terminal.key("Escape");
    same("the console on the observer's page", "Ready to start");
    terminal.key(".");
    let mut overridden = false;
    // It is asked all the time, since who says nothing for long is gone.
    terminal.wait("the trial on the observer's page", || {
        let seen = observer.screen();
        if !overridden && seen.contains("start the trial anyway") {
            terminal.key("o");
            overridden = true;
        }
        seen.contains("RUNNING")
    });
    assert_eq!(observer.remark(1, "looks at the pot"), None);
    assert_eq!(terminal.count(r#""kind":"marker","note":"looks at the pot","observer":"O1""#), 1);
    terminal.quit();
    terminal.verifies();
    let recording = terminal.recording().display().to_string();
    assert!(done(&["replay", &recording]).contains("remark of O1: looks at the pot"));
}
