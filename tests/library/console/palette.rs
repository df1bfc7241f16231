//! Lists that typing filters: the palette of all actions, and recordings.

use crossterm::event::{KeyCode, KeyEvent, KeyEventKind, KeyModifiers};
use ratatui::Terminal;
use ratatui::backend::TestBackend;
use tomcom::console::console_model::{Dialog, Playback, ReplayAction};
use tomcom::console::key_action::{KeyAction, KeyLayer, ManualAction};
use tomcom::console::lists::{ListChoice, ListCursor, RecordingPicker, actions, place};
use tomcom::console::view::recordings_page::draw_recordings;
use tomcom::console::view::theme::{TerminalBackground, Theme};
use tomcom::console::{ConsoleCommand, KeyBindings, KeyFileBindings};
use tomcom_session::replay::ReplayLandmark;
use tomcom_study::analysis::recording_summary::RecordingList;

use super::{SIZES, Stage, input, type_in};
use crate::support::*;

#[test]
fn the_palette_lists_every_action_and_keeps_head_and_stop_visible() {
    let mut stage = Stage::sushi(ParticipantKind::Simulated);
    stage.control('k');
    for size in SIZES {
        stage.model.size = size;
        stage.shows(size, &["RUNNING", "STOP ROBOT", "type to filter (no spaces)", "space stops the robot"]);
    }
    stage.model.size = (80, 24);
    check_snapshot("console", "palette_80x24", stage.screen((80, 24)));
    let layer = KeyLayer::Wizard;
    let listed = actions(&stage.model, &ListCursor::default()).len();
    let active = stage.model.keys.bindings.iter().filter(|line| line.layer.is_none_or(|only| only == layer));
    assert_eq!(listed, active.count() - 1, "all but the palette itself");
}

/// The action under the cursor of the open palette.
fn first(stage: &Stage) -> KeyAction {
    let Some(Dialog::Palette(cursor)) = &stage.model.dialog else { panic!("the palette is open") };
    actions(&stage.model, cursor)[cursor.at].action.clone()
}

#[test]
fn the_first_action_of_the_palette_is_likely_and_never_stops_or_ends_anything() {
    let ends = |action: &KeyAction| {
        let abort = KeyAction::Manual(ManualAction::Abort);
        [KeyAction::StopRobot, KeyAction::EndTrial, KeyAction::Quit, abort].contains(action)
    };
    let mut stage = Stage::new("sushi", ParticipantKind::Simulated);
    stage.control('k');
    assert_eq!(first(&stage), KeyAction::Manual(ManualAction::Preflight), "before the trial");
    let mut stage = Stage::sushi(ParticipantKind::Simulated);
    stage.control('k');
    assert_eq!(first(&stage), KeyAction::Help, "without an offer");
    let listed = actions(&stage.model, &ListCursor::default());
    assert!(listed.iter().rev().take(4).all(|line| ends(&line.action)), "what ends something is last");
    assert_eq!(listed.iter().filter(|line| ends(&line.action)).count(), 4);
    // What was chosen last is first the next time; what stops the robot is not.
    type_in(&mut stage, "hold");
    stage.wait(0.1);
    stage.key(KeyCode::Enter);
    for typed in ["", "stoprobot"] {
        stage.wait(1.0);
        stage.control('k');
        assert_eq!(first(&stage), KeyAction::Manual(ManualAction::HoldRobot));
        type_in(&mut stage, typed);
        stage.wait(0.1);
        stage.key(KeyCode::Enter);
    }
    stage.wait(1.0);
    stage.control('k');
    assert_eq!(first(&stage), KeyAction::Manual(ManualAction::HoldRobot));
    stage.model.dialog = None;
    // It is not, where it would do nothing.
    stage.at(30.0, Event::SignalEnded { reason: SignalEndReason::TakenBack });
    stage.at(30.0, Event::TrialPaused);
    stage.at(30.0, Event::SessionEnded);
    stage.control('k');
    assert_eq!(first(&stage), KeyAction::Help);
}

#[test]
fn an_action_is_found_by_typing_and_done_as_by_its_key() {
    for (typed, expected) in [
        ("hold", Event::RobotHeld { by: tomcom_core::communication::Sender::Wizard }),
        ("stoprobot", Event::RobotStopped),
        ("pause", Event::TrialPaused),
    ] {
        let mut stage = Stage::sushi(ParticipantKind::Simulated);
        stage.key(KeyCode::Char(':'));
        type_in(&mut stage, typed);
        stage.wait(0.1);
        assert_eq!(input(stage.key(KeyCode::Enter)), Some(expected), "{typed}: {}", stage.notice());
        assert_eq!(stage.model.dialog, None);
    }
    // What is no word of an action, nor part of one, runs nothing.
    for mut stage in [Stage::sushi(ParticipantKind::Simulated), replayed()] {
        stage.control('k');
        type_in(&mut stage, "abc");
        stage.shows_everywhere(&["no such command; bksp deletes a letter"]);
        stage.wait(0.1);
        assert_eq!(stage.key(KeyCode::Enter), None);
        assert!(matches!(stage.model.dialog, Some(Dialog::Palette(_))));
    }
    // A key is found by its name, but a single letter begins words.
    for expected in [KeyAction::Manual(ManualAction::HoldRobot), KeyAction::SwitchLayer, KeyAction::Quit] {
        let mut stage = Stage::sushi(ParticipantKind::Keyboard);
        let key = stage.model.keys.chord_for(&expected).expect("a key").to_string();
        stage.control('k');
        type_in(&mut stage, &key);
        assert_eq!(first(&stage), expected, "{key}");
    }
    for typed in ["endthetrial", "finish"] {
        let mut stage = Stage::sushi(ParticipantKind::Simulated);
        stage.control('k');
        type_in(&mut stage, typed);
        assert_eq!(stage.key(KeyCode::Enter), None);
        assert_eq!(stage.model.dialog, Some(Dialog::EndTrial), "{typed}: it asks as its key does");
    }
}

#[test]
fn enter_in_the_palette_sends_no_signal_and_neither_does_the_next_one() {
    let mut stage = Stage::sushi(ParticipantKind::Simulated);
    stage.control('k');
    type_in(&mut stage, "highlightcounter");
    stage.wait(0.1);
    // A terminal that reports releases tells two presses apart.
    assert_eq!(stage.kind(KeyCode::Enter, KeyEventKind::Press), None);
    assert_eq!(stage.kind(KeyCode::Enter, KeyEventKind::Release), None);
    assert_eq!(stage.model.dialog, None);
    assert!(stage.notice().contains("press n to highlight counter"), "{}", stage.notice());
    stage.wait(0.3);
    assert_eq!(stage.key(KeyCode::Enter), None);
    assert!(stage.notice().contains("right after a list"), "{}", stage.notice());
}

#[test]
fn space_stops_the_robot_in_the_palette_and_esc_goes_back() {
    let mut stage = Stage::sushi(ParticipantKind::Simulated);
    stage.control('k');
    type_in(&mut stage, "pan");
    assert_eq!(input(stage.key(KeyCode::Char(' '))), Some(Event::RobotStopped));
    stage.at(23.0, Event::RobotStopped);
    assert_eq!(stage.key(KeyCode::Char(' ')), None);
    stage.key(KeyCode::Char('?'));
    assert!(matches!(&stage.model.dialog, Some(Dialog::Palette(cursor)) if cursor.filter == "pan"));
    stage.key(KeyCode::Esc);
    assert_eq!(stage.model.dialog, None);
}

/// A recording of 90 events, after the tenth.
fn replayed() -> Stage {
    let mut stage = Stage::sushi(ParticipantKind::Simulated);
    stage.replays(Playback { event: 10, events: 90, ..Playback::new("S001".to_string()) });
    stage
}

#[test]
fn a_replay_has_its_actions_in_the_palette_and_the_space_bar_does_nothing() {
    let mut stage = replayed();
    stage.control('k');
    assert_eq!(stage.key(KeyCode::Char(' ')), None);
    type_in(&mut stage, "faster");
    stage.wait(0.1);
    assert_eq!(stage.key(KeyCode::Enter), Some(ConsoleCommand::Move(ReplayAction::Faster)));
}

#[test]
fn words_that_are_typed_in_a_replay_find_events() {
    let mut stage = replayed();
    let event = |seconds, words: &str| (ReplayAction::ToTime(at(seconds)), words.to_string());
    let long = "   0:15  human cutting board: the hand and the place are empty; order 1 needs cut tuna";
    let told = [(12.0, "   0:12  human take tuna"), (14.0, "   0:14  note tuna is wrong"), (15.0, long)];
    let told: Vec<_> = told.map(|(seconds, words)| event(seconds, words)).into();
    stage.model.playback.as_mut().expect("a replay").told = told.into();
    stage.control('k');
    type_in(&mut stage, "tuna");
    stage.shows_everywhere(&["0:12  human take tuna", "0:14  note tuna is wrong"]);
    stage.shows((120, 40), &[long.trim()]);
    type_in(&mut stage, " wrong");
    stage.wait(0.1);
    assert_eq!(stage.key(KeyCode::Enter), Some(ConsoleCommand::Move(ReplayAction::ToTime(at(14.0)))));
    assert_eq!(stage.model.dialog, None);
    // Numbers are not those of the clock.
    stage.wait(1.0);
    stage.control('k');
    type_in(&mut stage, "tuna 14");
    stage.hides((120, 40), &["note tuna is wrong"]);
    stage.key(KeyCode::Esc);
    stage.control('k');
    type_in(&mut stage, "tuna 0:14");
    stage.shows((120, 40), &["note tuna is wrong"]);
}

#[test]
fn a_time_or_a_number_that_is_typed_in_a_replay_leads_there() {
    let nth = |what, number| Some(ReplayAction::ToNth(what, number));
    // After all that the console shows with this time.
    let clock = |ns| Some(ReplayAction::ToClock(SessionTime(ns)));
    let places = [
        ("2:13", clock(133_999_999_999)),
        ("0:05.5", clock(5_599_999_999)),
        ("5.123456789", clock(5_123_456_789)),
        ("133", clock(133_999_999_999)),
        ("2:61", None),
        ("error 7", nth(ReplayLandmark::Error, 7)),
        ("note 2", nth(ReplayLandmark::Marker, 2)),
        ("signal 3", nth(ReplayLandmark::Signal, 3)),
        ("belief 4", nth(ReplayLandmark::FalseBelief, 4)),
        ("go to the next 4", None),
    ];
    let mut stage = Stage::sushi(ParticipantKind::Simulated);
    // A live session has no such places.
    let typed = |text: &str| ListCursor { filter: text.to_string(), at: 0 };
    assert_eq!(place(&stage.model, &typed("2:13")), None);
    stage.replays(Playback { event: 10, events: 90, ..Playback::new("S001".to_string()) });
    for (text, to) in places {
        assert_eq!(place(&stage.model, &typed(text)).map(|(to, _)| to), to, "{text}");
    }
    stage.control('k');
    type_in(&mut stage, "2:13");
    stage.shows_everywhere(&["go to 2:13 on the trial's clock"]);
    stage.wait(0.1);
    assert_eq!(stage.key(KeyCode::Enter), clock(133_999_999_999).map(ConsoleCommand::Move));
    assert_eq!(stage.model.dialog, None);
    // Raters are not led to what would tell them whether the participant was assisted, nor to what they have no key for.
    let (kitchen, map) = (stage.session.kitchen.clone(), KeyFileBindings::default());
    stage.model.keys = KeyBindings::replay(&kitchen, &map).expect("the keys are free").with_coding(&kitchen);
    for (text, to) in places {
        let to = to.filter(|to| !matches!(to, ReplayAction::ToNth(what, _) if *what != ReplayLandmark::Error));
        assert_eq!(place(&stage.model, &typed(text)).map(|(to, _)| to), to, "{text}");
    }
}

/// The rows that are found, the best first.
fn found<'a>(typed: &str, rows: &[&'a str]) -> Vec<&'a str> {
    let cursor = ListCursor { filter: typed.to_string(), at: 0 };
    cursor.found(rows.iter().map(|row| row.to_string())).into_iter().map(|index| rows[index]).collect()
}

#[test]
fn whole_words_and_beginnings_go_before_letters_within_words() {
    for typed in ["", "tuna", "tunaraw", "una", "TunaR", "raw", "raw tuna", "una aw"] {
        assert_eq!(found(typed, &["tuna raw"]), ["tuna raw"], "{typed}");
    }
    for typed in ["rawtuna", "tx", "tunaraws", "raw salmon", "tr", "traw", "naraw"] {
        assert!(found(typed, &["tuna raw"]).is_empty(), "{typed}");
    }
    assert_eq!(found("20260314", &["2026-03-15 P04", "2026-03-14 P07"]), ["2026-03-14 P07"], "signs do not count");
    assert_eq!(found("rec", &["next record", "recipe", "tear candle", "rec"]), ["rec", "next record", "recipe"]);
    assert_eq!(found("ir", &["tear in ruins", "third"]), ["third"], "within a word");
}

#[test]
fn a_typed_code_leaves_its_own_recordings() {
    let rows = (1..=21).map(|number| {
        let name = format!("2026-11-28-P{number:02}-7");
        [&format!("P{number:02}"), "wizard", "person", "2026-11-28 09:21", "9:07", "-", "whole", &name]
            .map(str::to_string)
            .to_vec()
    });
    let headings = RecordingList::HEADINGS.map(str::to_string).to_vec();
    let mut picker = RecordingPicker::new("Which recording?".to_string(), headings, rows.collect(), "replay");
    for (typed, code) in
        [("p21", "P21"), ("p07", "P07"), ("P1", "P10"), ("p07 wizard", "P07"), ("p07-7", "P07"), ("28-p07", "P07")]
    {
        picker.cursor = ListCursor { filter: typed.to_string(), at: 0 };
        let left = picker.left();
        assert_eq!(picker.rows[left[0]][0], code, "{typed}");
        assert_eq!(left.len(), if typed == "P1" { 10 } else { 1 }, "{typed}");
    }
}

#[test]
fn exit_is_for_leaving() {
    let mut burger = Stage::new("burger", ParticipantKind::Keyboard);
    burger.at(1.0, Event::TrialStarted);
    // Neither trial was aborted or excluded, so that there is nothing to repeat.
    for mut stage in [Stage::sushi(ParticipantKind::Simulated), burger] {
        let exclude = KeyAction::Manual(ManualAction::Exclude);
        for (typed, first) in [("exit", KeyAction::Quit), ("exclude", exclude.clone()), ("excl", exclude)] {
            stage.control('k');
            type_in(&mut stage, typed);
            let Some(Dialog::Palette(cursor)) = &stage.model.dialog else { panic!("no palette") };
            assert_eq!(actions(&stage.model, cursor)[0].action, first, "{typed}");
            stage.model.dialog = None;
        }
    }
}

#[test]
fn a_key_file_that_has_the_palettes_key_for_something_else_is_still_read() {
    let map: KeyFileBindings = toml::from_str("[console]\ncorrect = \"ctrl+k\"\n").expect("a key file");
    let mut stage = Stage::sushi(ParticipantKind::Simulated);
    let kitchen = stage.session.kitchen.clone();
    stage.model.keys = KeyBindings::live(&kitchen, &stage.session.spec, &map).expect("the palette has another key");
    stage.control('k');
    assert!(matches!(stage.model.dialog, Some(Dialog::Pick(_))));
    stage.model.dialog = None;
    stage.key(KeyCode::Char(':'));
    assert!(matches!(stage.model.dialog, Some(Dialog::Palette(_))));
}

#[test]
fn the_list_takes_what_is_typed_while_the_recordings_are_read() {
    let mut picker = picker();
    let rows = std::mem::take(&mut picker.rows);
    picker.reading = Some(rows.len());
    for letter in "p07 1/2".chars() {
        assert_eq!(press(&mut picker, KeyCode::Char(letter)), None);
    }
    assert_eq!(press(&mut picker, KeyCode::Enter), None, "no row is chosen unseen");
    let reads = screen(&picker, 80);
    assert!(reads.contains("reading 3 recordings") && reads.contains("p07 1/2_"), "{reads}");
    (picker.rows, picker.reading) = (rows, None);
    picker.rows[1][1] = "1/2 of study".to_string();
    assert_eq!(picker.left(), [1], "the filter keeps signs that codes and steps have");
}

fn picker() -> RecordingPicker {
    let row = |code: &str, condition: &str, kind: &str, state: &str, name: &str| {
        [code, kind, condition, "2026-03-14 10:22", "15:00", "7", state, name].map(str::to_string).to_vec()
    };
    let headings = RecordingList::HEADINGS.map(str::to_string).to_vec();
    let rows = vec![
        row("P08", "wizard", "person", "excluded", "2026-03-15-P08-1"),
        row("P07", "wizard", "person", "ended early", "2026-03-14-P07-2"),
        row("P07", "unassisted", "practice", "whole", "2026-03-14-P07-1"),
    ];
    RecordingPicker::new("Which recording of sessions?".to_string(), headings, rows, "exclude")
}

fn press(picker: &mut RecordingPicker, code: KeyCode) -> Option<ListChoice> {
    picker.key(&KeyEvent::new(code, KeyModifiers::NONE))
}

/// The list as it is drawn with this many columns.
fn screen(picker: &RecordingPicker, columns: u16) -> String {
    let theme = Theme { colour: true, unicode: true, ground: TerminalBackground::Dark };
    let mut terminal = Terminal::new(TestBackend::new(columns, 24)).expect("a test terminal");
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
                [code, "practice", "wizard with advice", "2026-03-14 10:22", "15:00", "12", "ended early", &name]
                    .map(str::to_string)
                    .to_vec()
            })
            .collect();
        let [narrow, wide] = [80, 120].map(|columns| screen(&picker, columns));
        picker.rows.iter_mut().for_each(|row| row[5] = "-".to_string());
        assert!(!screen(&picker, 120).contains("errors"), "they were never counted");
        let screen = narrow;
        assert!(!screen.contains("length") && !screen.contains("errors"), "{screen}");
        if code == "P07" {
            let whole = ["wizard with advice", "practice", "2026-03-14 10:22", "ended early"];
            assert!(whole.iter().all(|words| screen.contains(words)), "{screen}");
            let all = ["length", "15:00", "errors", " 12 "];
            assert!(all.iter().all(|words| wide.contains(words)), "{wide}");
        }
        for trial in 1..=3 {
            assert!(screen.contains(&format!("-{trial} ")), "trial {trial} in\n{screen}");
        }
    }
}

#[test]
fn the_list_is_a_table_with_its_filter_above() {
    let mut picker = picker();
    press(&mut picker, KeyCode::Char('w'));
    check_snapshot("console", "recordings_80x24", screen(&picker, 80));
}
