//! The training of a wizard: its task, its feedback and its report.

use crossterm::event::KeyCode;
use tomcom::console::console_model::Dialog;
use tomcom::console::console_model::NoticeLevel;
use tomcom::console::console_model::Playback;
use tomcom::console::console_model::{TrainingFeedback, TrainingPanel};
use tomcom_core::base::time::SessionTime;
use tomcom_session::settings::{ParticipantKind, WizardVisibility};

use super::{SIZES, Stage};
use crate::check_snapshot;

#[test]
fn a_training_says_what_to_do_keeps_what_it_said_and_ends_when_that_is_read() {
    let mut stage = Stage::sushi(ParticipantKind::Simulated);
    stage.session.spec.console.visibility = WizardVisibility::State;
    stage.model.playback = Some(Playback::new("seed1-S001".to_string()));
    let task = ["Press . to start.", "A hit is the first signal about a false belief that leads to an error."];
    let lesson = TrainingPanel {
        task: task.map(str::to_string).to_vec(),
        score: "0 hit".to_string(),
        ..TrainingPanel::default()
    };
    stage.model.lesson = Some(lesson.clone());
    assert!(stage.screen((120, 40)).contains("A hit is the first signal"));
    let said = |seconds: f64, level: NoticeLevel, text: &str| {
        let clock = SessionTime::from_secs_f64(seconds);
        TrainingFeedback { clock, level, text: text.to_string() }
    };
    let long = "missed, with 2 errors: recipe of tuna nigiri: believed salmon nigiri, truly tuna nigiri; right would have been: recipe of order 1";
    let feedback = vec![
        said(4.0, NoticeLevel::Done, "highlight plate: a signal already told this"),
        said(9.0, NoticeLevel::Refused, long),
        said(12.0, NoticeLevel::Done, "recipe of order 1: hit: the belief has been false for 3.1 s"),
    ];
    stage.model.lesson = Some(TrainingPanel { feedback, begun: true, ..lesson });
    for size in SIZES {
        stage.shows(size, &["0:12 recipe of order 1: hit:", "0:09 missed, with 2 errors"]);
    }
    check_snapshot("console", "training_120x40", stage.screen((120, 40)));
    stage.control('b');
    assert!(stage.notice().contains("not shown in this session"), "{}", stage.notice());
    stage.model.dialog = Some(Dialog::Report(vec!["1 of 2 hit".to_string(), "    missed; ".to_string() + long]));
    let report = ["The training is over", "1 of 2 hit", "would have been: recipe of order 1", "this report is saved"];
    stage.shows((120, 40), &report);
    stage.wait(1.0);
    stage.key(KeyCode::Char('q'));
    assert!(stage.model.dialog.is_some(), "a signal that came too late closes nothing");
    stage.key(KeyCode::Enter);
    assert_eq!(stage.model.dialog, None);
}
