//! Text from outside reaches a terminal only as text: what could command it is written out.

use std::borrow::Cow;

use miette::{GraphicalReportHandler, GraphicalTheme};
use ratatui::Terminal;
use ratatui::backend::TestBackend;
use tomcom::console::console_model::NoticeLevel;
use tomcom::console::view;
use tomcom_core::base::text::{printable, printable_lines};
use tomcom_session::apply;
use tomcom_session::files::file_error::FileError;
use tomcom_session::tracker::TrackerEvent;

use crate::support::*;

/// Clears the screen, sets the title of the window, reverses the direction of writing, and begins a sequence in one byte.
const HOSTILE: &str = "a\x1b[2J\x1b]0;title\x07b\u{202e}c\u{9b}31md\r\ne";
/// What is left of it on one line.
const WRITTEN_OUT: &str = "a\\u001b[2J\\u001b]0;title\\u0007b\\u202ec\\u009b31md\\r\\ne";

fn is_harmless(text: &str) -> bool {
    !text.chars().any(|letter| letter.is_control() && letter != '\n') && !text.contains('\u{202e}')
}

fn session() -> Session {
    let spec = default_settings();
    Session::new(kitchen("sushi"), spec, 0)
}

#[test]
fn control_characters_are_written_out_and_all_else_stays() {
    assert_eq!(printable(HOSTILE), WRITTEN_OUT);
    assert_eq!(printable_lines("a\tb\r\nc\rd\n\x1be"), "a\tb\r\nc\\rd\n\\u001be");
    assert_eq!(printable("\u{7f}\u{85}\u{2028}\u{2066}\u{61c}"), "\\u007f\\u0085\\u2028\\u2066\\u061c");
    for text in ["", "press \u{00e4} \u{4e2d}\u{6587} \u{1f363} e\u{301} \u{2026}", "\\u001b is written so"] {
        assert!(matches!(printable(text), Cow::Borrowed(same) if same == text), "{text}");
    }
    let json = serde_json::to_string(&HOSTILE).expect("a string");
    let read: String = serde_json::from_str(&printable_lines(&json)).expect("it is JSON still");
    assert_eq!(read, HOSTILE, "in JSON no value changes");
}

#[test]
fn the_console_shows_notes_devices_and_messages_written_out() {
    let mut session = session();
    let mut model = console_model(&session.kitchen, &session.spec, (200, 60));
    let events = [
        Event::TrialStarted,
        Event::Tracker(TrackerEvent::Connected { device: HOSTILE.to_string() }),
        Event::Marker { note: HOSTILE.to_string(), observer: None },
    ];
    for (seq, event) in events.into_iter().enumerate() {
        let stamped = TimestampedEvent { seq: seq as u64, time: SessionTime(seq as u64), event };
        apply(&mut session, &stamped).expect("the event fits");
    }
    model.say(NoticeLevel::Alarm, format!("cannot write {HOSTILE}"));
    let mut terminal = Terminal::new(TestBackend::new(200, 60)).expect("a terminal");
    terminal.draw(|frame| view(&session, &model, frame)).expect("drawn");
    let buffer = terminal.backend().buffer();
    let rows: Vec<String> =
        buffer.content.chunks(200).map(|row| row.iter().map(|cell| cell.symbol()).collect()).collect();
    assert!(rows.iter().all(|row| is_harmless(row)), "{rows:#?}");
    assert!(rows.iter().any(|row| row.contains(&format!("cannot write {WRITTEN_OUT}"))), "{rows:#?}");
    assert!(rows.iter().any(|row| row.contains("a\\u001b[2J") && !row.contains("cannot write")), "the note: {rows:#?}");
}

/// How an error is shown, without colours.
fn shown(error: &FileError) -> String {
    let mut text = String::new();
    GraphicalReportHandler::new_themed(GraphicalTheme::unicode_nocolor())
        .render_report(&mut text, error)
        .expect("text");
    text
}

#[test]
fn an_error_shows_the_place_in_the_file_written_out() {
    let text = format!("name = \"{}\"\nwidth = x\x1b[31m # \u{e4}\n", HOSTILE.replace("\r\n", ""));
    let error = FileError::at(
        Path::new("lay\x1b[0mout.toml"),
        &text,
        text.find("x\x1b[31m").map(|at| at..at + 6),
        format!("x\x1b{HOSTILE}"),
        "a number".to_string(),
    );
    let text = shown(&error);
    assert!(is_harmless(&text), "{text}");
    assert!(text.contains("lay\\u001b[0mout.toml:2"), "{text}");
    let lines: Vec<&str> = text.lines().collect();
    let place = lines.iter().position(|line| line.contains("width = x\\u001b[31m")).expect("the line");
    let column = |line: &str, of: char| line.chars().position(|letter| letter == of);
    let marked = lines[place + 1];
    assert_eq!(column(lines[place], 'x'), marked.chars().position(|letter| "─┬".contains(letter)), "{text}");
    assert_eq!(marked.chars().filter(|letter| "─┬".contains(*letter)).count(), "x\\u001b[31m".len(), "{text}");
}
