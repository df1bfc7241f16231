//! Pasted text: text in a field, refused everywhere else. Only its letters would be keys.

use crossterm::event::KeyCode;
use tomcom::console::console_model::Dialog;
use tomcom::console::console_model::Playback;
use tomcom::console::{ConsoleCommand, ConsoleMessage, KeyBindings, KeyFileBindings, update};
use tomcom_session::event::Event;
use tomcom_session::settings::ParticipantKind;

use super::Stage;

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
    stage.model.keys =
        KeyBindings::replay(&stage.session.kitchen, &KeyFileBindings::default()).expect("the keys are free");
    stage.model.playback = Some(Playback::new("2026-03-14-P01-1".to_string()));
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
    assert_eq!(cursor.filter, "stoptherobot");
    assert_eq!(stage.key(KeyCode::Esc), None);
    assert_eq!(stage.key(KeyCode::Esc), None);
    stage.wait(1.0);
    assert_eq!(stage.control('x'), None);
    assert_eq!(stage.paste(Some("tech")), None);
    let Some(Dialog::Pick(picker)) = &stage.model.dialog else { panic!("{:?}", stage.model.dialog) };
    assert_eq!(picker.cursor.filter, "tech");
}
