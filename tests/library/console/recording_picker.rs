//! The list from which a recording is chosen.

use crossterm::event::{KeyCode, KeyEvent, KeyModifiers};
use ratatui::Terminal;
use ratatui::backend::TestBackend;
use tomcom::console::lists::{RecordingPicker, RecordingReply};
use tomcom::console::view::recordings_page::draw_recordings;
use tomcom::console::view::theme::{TerminalBackground, Theme};

use crate::check_snapshot;

fn picker() -> RecordingPicker {
    let row = |code: &str, condition: &str, state: &str, name: &str| {
        [code, condition, "2026-03-14 10:22", "15:00", state, name].map(str::to_string).to_vec()
    };
    let headings = ["code", "condition", "date", "length", "state", "recording"].map(str::to_string).to_vec();
    let rows = vec![
        row("P07", "unassisted", "whole", "2026-03-14-P07-1"),
        row("P07", "wizard", "cut", "2026-03-14-P07-2"),
        row("P08", "wizard", "excluded", "2026-03-15-P08-1"),
    ];
    RecordingPicker::new("Which recording of sessions?".to_string(), headings, rows)
}

fn press(picker: &mut RecordingPicker, code: KeyCode) -> Option<RecordingReply> {
    picker.key(&KeyEvent::new(code, KeyModifiers::NONE))
}

#[test]
fn typing_filters_without_spaces_and_enter_takes_the_row() {
    let mut picker = picker();
    assert_eq!(picker.left(), [0, 1, 2]);
    for letter in "p07 wiz".chars() {
        assert_eq!(press(&mut picker, KeyCode::Char(letter)), None);
    }
    assert_eq!((picker.cursor.filter.as_str(), picker.left()), ("p07wiz", vec![1]));
    assert_eq!(press(&mut picker, KeyCode::Enter), Some(RecordingReply::Chosen(1)));
    assert_eq!(press(&mut picker, KeyCode::Char('x')), None);
    assert_eq!(press(&mut picker, KeyCode::Enter), None, "nothing is left, nothing is taken");
    assert_eq!(press(&mut picker, KeyCode::Esc), None, "the filter goes first");
    assert_eq!(press(&mut picker, KeyCode::Backspace), None, "nothing is left to delete, and the list stays");
    assert_eq!(picker.left(), [0, 1, 2]);
    press(&mut picker, KeyCode::End);
    press(&mut picker, KeyCode::Down);
    assert_eq!(press(&mut picker, KeyCode::Enter), Some(RecordingReply::Chosen(2)));
    assert_eq!(press(&mut picker, KeyCode::Esc), Some(RecordingReply::Leave));
    let quit = KeyEvent::new(KeyCode::Char('c'), KeyModifiers::CONTROL);
    assert_eq!(picker.key(&quit), Some(RecordingReply::Leave));
}

/// The list as it is drawn at 80x24.
fn screen(picker: &RecordingPicker) -> String {
    let theme = Theme { colour: true, unicode: true, ground: TerminalBackground::Dark };
    let mut terminal = Terminal::new(TestBackend::new(80, 24)).expect("a test terminal");
    terminal.draw(|frame| draw_recordings(picker, theme, frame)).expect("drawn");
    terminal.backend().to_string()
}

#[test]
fn columns_that_tell_recordings_apart_stay_where_not_all_fit() {
    for code in ["P07", "GROUP-B-P0007"] {
        let mut picker = picker();
        picker.rows = (1..=3)
            .map(|trial| {
                let name = format!("2026-03-14-{code}-{trial}");
                [code, "wizard with advice", "2026-03-14 10:22", "15:00", "unreadable", &name]
                    .map(str::to_string)
                    .to_vec()
            })
            .collect();
        let screen = screen(&picker);
        assert!(!screen.contains("length") && screen.contains("wizard with advice"), "{screen}");
        for trial in 1..=3 {
            assert!(screen.contains(&format!("{code}-{trial} ")), "trial {trial} in\n{screen}");
        }
    }
}

#[test]
fn the_list_is_a_table_with_its_filter_above() {
    let mut picker = picker();
    press(&mut picker, KeyCode::Char('w'));
    check_snapshot("console", "recordings_80x24", screen(&picker));
}
