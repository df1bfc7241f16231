//! The mouse and pasted text: clicks do what keys do, the pointer is a place on the display, a paste is text and no keys.

use crossterm::event::KeyCode;
use ratatui::layout::Rect;
use tomcom::console::console_model::{Dialog, Playback, ReplayAction};
use tomcom::console::kitchen_map::{KitchenMap, KitchenMapElement};
use tomcom::console::lists::{Picker, PickerKind, ReasonFor};
use tomcom::console::view::click_targets;
use tomcom::console::view::regions::PanelAreas;
use tomcom::console::{ConsoleCommand, ConsoleMessage, mouse, update};
use tomcom_core::communication::offer::OfferedAdvice;
use tomcom_session::replay::ReplayLandmark;

use super::{SIZES, Stage, input, panels};
use crate::support::*;

impl Stage {
    /// Clicks on the first cell of a text on the screen.
    pub fn click(&mut self, text: &str) -> Option<ConsoleCommand> {
        let screen = self.screen(self.model.size);
        let found = screen.lines().enumerate().find_map(|(row, line)| Some((row, line.find(text)?, line)));
        let (row, at, line) = found.unwrap_or_else(|| panic!("no {text:?} in\n{screen}"));
        // Lines begin with a quotation mark.
        let column = line[..at].chars().count() as u16 - 1;
        update(&mut self.model, &self.session, ConsoleMessage::Click(column, row as u16))
    }

    fn asks_to_send(&self) -> bool {
        matches!(self.model.dialog, Some(Dialog::Send(_)))
    }
}

fn highlight(place: &str) -> Signal {
    Signal::Highlight(place.to_string())
}

fn signal(command: Option<ConsoleCommand>) -> Option<Signal> {
    match input(command) {
        Some(Event::SignalShown { signal, .. }) => Some(signal),
        _ => None,
    }
}

#[test]
fn a_click_on_a_signal_asks_once_and_enter_or_a_second_click_sends_it() {
    for size in SIZES {
        let mut stage = Stage::sushi(ParticipantKind::Simulated);
        stage.model.size = size;
        stage.wait(0.0);
        assert_eq!(stage.click("[a]"), None);
        assert!(stage.asks_to_send(), "{size:?}");
        stage.shows(size, &["Send highlight assembly board? enter"]);
        stage.wait(0.1);
        assert_eq!(stage.click("[a]"), None, "a double click confirms nothing");
        stage.wait(1.0);
        assert_eq!(signal(stage.click("[a]")), Some(highlight("assembly_board")));
        assert_eq!(stage.model.dialog, None);
        stage.wait(1.0);
        stage.click("[n]");
        assert_eq!(signal(stage.key(KeyCode::Enter)), Some(highlight("counter")));
    }
}

#[test]
fn the_question_of_a_click_gives_way_to_a_newer_offer_that_the_wizard_sees() {
    // The console's clock runs ahead of the session in a training, and beside it in a running session.
    for ahead_s in [0.0, 100.0] {
        for (visible, shows, closes) in [
            (true, WizardVisibility::Recommendation, true),
            (false, WizardVisibility::Recommendation, false),
            (true, WizardVisibility::State, false),
            (false, WizardVisibility::State, false),
        ] {
            let mut stage = Stage::sushi(ParticipantKind::Simulated);
            stage.wait(0.0);
            let ahead = |stage: &mut Stage| stage.model.clock = stage.model.now + at(ahead_s);
            ahead(&mut stage);
            stage.click("[a]");
            assert!(stage.asks_to_send(), "clock ahead by {ahead_s} s");
            stage.session.spec.console.visibility = shows;
            let what = highlight("counter");
            let advice = OfferedAdvice { what, for_seq: 17, worth: None, reason: None, words: None, visible };
            stage.at(23.5, Event::OfferOpened(advice));
            ahead(&mut stage);
            mouse::expire(&mut stage.model, &stage.session);
            assert_eq!(!stage.asks_to_send(), closes, "visible {visible}, {shows:?}, clock ahead by {ahead_s} s");
            assert_eq!(stage.notice().contains("another signal is on offer"), closes, "{}", stage.notice());
        }
    }
}

#[test]
fn the_question_of_a_click_waits_five_seconds() {
    let mut stage = Stage::sushi(ParticipantKind::Simulated);
    stage.wait(0.0);
    stage.click("[a]");
    stage.wait(4.9);
    mouse::expire(&mut stage.model, &stage.session);
    assert!(stage.asks_to_send());
    stage.wait(0.2);
    assert_eq!(stage.key(KeyCode::Enter), None, "an enter so late is not meant for it");
    assert!(stage.notice().contains("not sent"), "{}", stage.notice());
}

#[test]
fn the_question_of_a_click_is_left_by_esc_and_other_keys_mean_themselves() {
    let mut stage = Stage::sushi(ParticipantKind::Simulated);
    stage.click("[a]");
    assert_eq!(stage.key(KeyCode::Esc), None);
    assert_eq!(stage.model.dialog, None);
    stage.click("[a]");
    assert_eq!(input(stage.key(KeyCode::Char(' '))), Some(Event::RobotStopped));
    assert!(stage.asks_to_send(), "the robot stop answers nothing");
    stage.wait(1.0);
    assert_eq!(signal(stage.key(KeyCode::Char('n'))), Some(highlight("counter")));
    assert_eq!(stage.model.dialog, None);
    stage.click("[a]");
    stage.click("[c]");
    stage.wait(1.0);
    assert_eq!(signal(stage.click("[c]")), Some(highlight("cutting_board")), "the question is about the last click");
}

#[test]
fn with_click_sends_a_click_sends_at_once() {
    let mut stage = Stage::sushi(ParticipantKind::Simulated);
    stage.session.spec.console.click_sends = true;
    assert_eq!(signal(stage.click("[a]")), Some(highlight("assembly_board")));
    assert_eq!(stage.model.dialog, None);
}

#[test]
fn a_click_that_cannot_send_says_why_and_asks_nothing() {
    let mut stage = Stage::sushi(ParticipantKind::Simulated);
    stage.at(23.0, Event::TrialPaused);
    stage.click("[a]");
    assert_eq!(stage.model.dialog, None);
    assert!(stage.notice().contains("while the trial runs"), "{}", stage.notice());
}

#[test]
fn hints_buttons_of_the_participant_and_beliefs_are_clicked() {
    let mut stage = Stage::sushi(ParticipantKind::Keyboard);
    assert_eq!(input(stage.click("STOP ROBOT")), Some(Event::RobotStopped));
    assert_eq!(input(stage.click("pause")), Some(Event::TrialPaused));
    stage.wait(0.2);
    assert_eq!(stage.click("pause"), None, "a double click pauses once");
    stage.click("switch");
    assert!(matches!(input(stage.click("[x] cooking pot")), Some(Event::Press { .. })), "{}", stage.screen((120, 40)));
    stage.wait(1.0);
    stage.click("switch");
    stage.click("1-5");
    assert!(matches!(&stage.model.dialog, Some(Dialog::Palette(cursor)) if cursor.filter == "notes"));
    stage.key(KeyCode::Down);
    stage.wait(1.0);
    assert_eq!(
        input(stage.key(KeyCode::Enter)),
        Some(Event::Marker { note: "overlooked a change".to_string(), observer: None })
    );
    stage.click("90 %");
    assert!(stage.model.belief_focus.is_some());
}

#[test]
fn a_row_is_gone_to_by_a_click_and_taken_by_the_next() {
    let mut stage = Stage::sushi(ParticipantKind::Simulated);
    stage.model.dialog = Some(Dialog::Pick(Picker::new(PickerKind::Reason(ReasonFor::Abort))));
    assert_eq!(stage.click("technical failure"), None);
    assert!(matches!(&stage.model.dialog, Some(Dialog::Pick(picker)) if picker.cursor.at == 1));
    let aborted = Event::TrialAborted { reason: "technical failure".to_string() };
    assert_eq!(input(stage.click("technical failure")), Some(aborted));
    stage.model.dialog = Some(Dialog::EndTrial);
    stage.click("any other key");
    assert_eq!(stage.model.dialog, None);
    stage.model.dialog = Some(Dialog::EndTrial);
    assert!(matches!(input(stage.click("y or ^e yes")), Some(Event::TrialEnded { .. })));
}

#[test]
fn nothing_below_a_dialog_can_be_clicked() {
    let mut stage = Stage::sushi(ParticipantKind::Simulated);
    let all = click_targets(&stage.session, &stage.model).len();
    stage.model.dialog = Some(Dialog::Quit);
    let targets = click_targets(&stage.session, &stage.model);
    assert!(targets.len() < all && targets.len() <= 4, "{targets:?}");
}

#[test]
fn the_scrub_bar_and_the_timeline_seek_in_a_replay() {
    let mut stage = Stage::sushi(ParticipantKind::Simulated);
    stage.replays(Playback { trial_length: at(40.0), event: 10, events: 90, ..Playback::new("S001".to_string()) });
    for size in SIZES {
        stage.model.size = size;
        let rows = size.1;
        let mut seek = |column: u16, row: u16| match update(
            &mut stage.model,
            &stage.session,
            ConsoleMessage::Click(column, row),
        ) {
            Some(ConsoleCommand::Move(ReplayAction::ToTime(time) | ReplayAction::ToClock(time))) => time.as_secs_f64(),
            other => panic!("{other:?} at {column}, {row} of {size:?}"),
        };
        // Above the line of keys, and two or three lines of messages.
        let row = rows - if size == SIZES[0] { 4 } else { 5 };
        assert_eq!(seek(11, row), 0.0);
        let [early, late] = [20, 35].map(|column| seek(column, row));
        assert!(0.0 < early && early < late && late < 40.0, "{early} {late}");
        if size == SIZES[0] {
            continue;
        }
        // The timeline ends at the present; ten columns are five seconds.
        let right = size.0 - 3;
        let [then, now] = [right - 10, right].map(|column| seek(column, row - 2));
        assert!((now - then - 5.0).abs() < 0.6 && (now - 22.6).abs() < 0.6, "{then} {now}");
    }
}

#[test]
fn the_scrub_bar_marks_errors_signals_and_false_beliefs_with_their_keys() {
    let mut stage = Stage::sushi(ParticipantKind::Simulated);
    let marks = [(10.0, ReplayLandmark::Signal), (21.0, ReplayLandmark::FalseBelief), (30.0, ReplayLandmark::Error)];
    let marks = marks.map(|(seconds, what)| (at(seconds), what)).into();
    stage.replays(Playback { trial_length: at(40.0), marks, ..Playback::new("S001".to_string()) });
    for size in SIZES {
        stage.model.size = size;
        let screen = stage.screen(size);
        let bar = screen.lines().find(|line| line.contains(" recording ")).expect("the bar");
        let bar = bar.split_once(" recording ").map_or("", |(_, bar)| bar);
        // By the trial's clock, which shows 0:19.
        let places = ["s", "●", "b", "e"].map(|sign| bar.find(sign).expect("a mark"));
        assert!(places.is_sorted(), "{bar}");
    }
}

#[test]
fn every_place_of_the_panel_is_its_place_on_the_display_and_back() {
    for name in ["sushi", "burger"] {
        let kitchen = kitchen(name);
        for size in SIZES {
            let areas = PanelAreas::new(size, &kitchen, WizardVisibility::Recommendation, None).kitchen_inside();
            let plan = KitchenMap::new(&kitchen, areas, size.0 == 120);
            assert_eq!(plan.spots.len(), kitchen.locations.len() + kitchen.storages.len());
            for spot in &plan.spots {
                let area = match spot.thing {
                    KitchenMapElement::Location(id) => kitchen.location(id).display,
                    KitchenMapElement::Storage(index) => kitchen.storages[index].display,
                };
                let is_inside = |panel: Rect| panel.union(spot.cells) == panel;
                assert!(is_inside(areas.orders) || is_inside(areas.places), "{name} {size:?}: inside of a panel");
                for (x, y) in [(spot.cells.x, spot.cells.y), (spot.cells.right() - 1, spot.cells.bottom() - 1)] {
                    let point = plan.display_point(x, y);
                    let distance_m = area.distance_m(point, kitchen.display_m);
                    assert_eq!(distance_m, 0.0, "{name} {size:?} {:?} {point:?} {area:?}", spot.thing);
                    assert_eq!(plan.cell(point), Some((x, y)), "{name} {size:?}");
                }
            }
            for (index, spot) in plan.spots.iter().enumerate() {
                let others = plan.spots[index + 1..].iter();
                assert!(others.clone().all(|other| !spot.cells.intersects(other.cells)), "{name} {size:?}: apart");
            }
        }
    }
}

#[test]
fn a_click_beside_the_keys_explains_a_place_or_shows_a_panel_and_the_wheel_goes_back_in_time() {
    let mut stage = Stage::sushi(ParticipantKind::Simulated);
    let regions = PanelAreas::new((120, 40), &stage.session.kitchen, WizardVisibility::Recommendation, None);
    let plan = KitchenMap::new(&stage.session.kitchen, regions.kitchen_inside(), false);
    for spot in &plan.spots {
        let KitchenMapElement::Location(location) = spot.thing else { continue };
        let click = ConsoleMessage::Click(spot.cells.x + 1, spot.cells.bottom() - 1);
        assert_eq!(update(&mut stage.model, &stage.session, click), None);
        let label = stage.session.kitchen.location(location).label();
        assert!(stage.notice().contains(&label), "{label}: {}", stage.notice());
    }
    let all = panels(&stage);
    let (column, row) = (regions.belief.x + 1, regions.belief.y);
    for expected in [["belief", "recommendation"].map(str::to_string).to_vec(), all] {
        assert_eq!(update(&mut stage.model, &stage.session, ConsoleMessage::Click(column, row)), None);
        assert_eq!(panels(&stage), expected);
    }
    let (column, row) = (regions.timeline.x + 1, regions.timeline.y);
    for (steps, back_s) in [(1, 5), (-3, 0)] {
        assert_eq!(update(&mut stage.model, &stage.session, ConsoleMessage::Wheel(column, row, steps)), None);
        assert_eq!(stage.model.timeline_back_s, back_s, "back, and not into the future");
    }
}

impl Stage {
    pub fn paste(&mut self, text: Option<&str>) -> Option<ConsoleCommand> {
        update(&mut self.model, &self.session, ConsoleMessage::Paste(text.map(str::to_string)))
    }
}

const REFUSED: &str = "pasted text is not taken for keys";

#[test]
fn pasted_text_sends_nothing_and_stops_nothing_outside_of_a_field() {
    for participant in [ParticipantKind::Simulated, ParticipantKind::Keyboard] {
        let mut stage = Stage::sushi(participant);
        for (text, told) in [(Some("please call me"), REFUSED), (Some(" "), REFUSED), (None, "a paste did not end")] {
            assert_eq!(stage.paste(text), None);
            assert!(stage.notice().contains(told), "{text:?}: {}", stage.notice());
        }
        // Nor does it answer a question.
        stage.wait(1.0);
        assert_eq!(stage.control('c'), None);
        assert_eq!(stage.model.dialog, Some(Dialog::Quit));
        assert_eq!(stage.paste(Some("y")), None);
        assert_eq!(stage.model.dialog, Some(Dialog::Quit), "the question stays open");
    }
}

#[test]
fn pasted_text_moves_no_replay() {
    let mut stage = Stage::sushi(ParticipantKind::Simulated);
    stage.replays(Playback::new("2026-03-14-P01-1".to_string()));
    assert_eq!(stage.paste(Some("seven mbwq")), None);
    assert!(stage.notice().contains(REFUSED), "{}", stage.notice());
}

#[test]
fn in_a_note_a_paste_is_text_also_while_the_trial_runs_on() {
    let mut stage = Stage::sushi(ParticipantKind::Simulated);
    stage.at(23.0, Event::TrialPaused);
    stage.wait(1.0);
    assert_eq!(stage.key(KeyCode::Char('0')), None);
    stage.at(24.0, Event::TrialResumed);
    assert_eq!(stage.paste(Some("please call me\r\nat once\n")), None, "the robot goes on");
    assert_eq!(stage.key(KeyCode::Char('!')), None);
    let Some(Dialog::Note(note)) = &stage.model.dialog else { panic!("{:?}", stage.model.dialog) };
    assert_eq!(note.text(), "please call me at once!");
    // The space bar itself does stop it.
    assert_eq!(stage.key(KeyCode::Char(' ')), Some(ConsoleCommand::Input(Event::RobotStopped)));
    // What does not fit is refused as a whole.
    assert_eq!(stage.paste(Some(&"x".repeat(478))), None);
    assert_eq!(stage.notice(), "nothing pasted: the text has 478 characters, the field has room for 477");
    assert_eq!(stage.paste(Some(&"x".repeat(477))), None);
    let Some(Dialog::Note(note)) = &stage.model.dialog else { panic!("{:?}", stage.model.dialog) };
    assert_eq!(note.text().len(), 500);
}

#[test]
fn a_paste_filters_a_list_and_chooses_nothing() {
    let mut stage = Stage::sushi(ParticipantKind::Simulated);
    stage.wait(1.0);
    assert_eq!(stage.control('k'), None);
    assert_eq!(stage.paste(Some("stop the robot\n")), None);
    let Some(Dialog::Palette(cursor)) = &stage.model.dialog else { panic!("{:?}", stage.model.dialog) };
    assert_eq!(cursor.filter, "stop the robot");
    assert_eq!(stage.key(KeyCode::Esc), None);
    stage.wait(1.0);
    assert_eq!(stage.control('x'), Some(ConsoleCommand::Input(Event::TrialPaused)));
    assert_eq!(stage.paste(Some("tech")), None);
    let Some(Dialog::Pick(picker)) = &stage.model.dialog else { panic!("{:?}", stage.model.dialog) };
    assert_eq!(picker.cursor.filter, "tech");
}
