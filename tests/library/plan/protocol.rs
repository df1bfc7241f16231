//! What happens around a trial: steps, items, and recordings that are cut or left.

use crossterm::event::{KeyCode, KeyEvent, KeyModifiers};
use tomcom::console::{ConsoleCommand, ConsoleMessage, update};
use tomcom_session::plan::{NextRecording, ParticipantProgress, PhaseSpec, RecordingOutcome};
use tomcom_study::files::recordings;

use super::{Run, files, folder, study};
use crate::support::*;

/// A recording of the plan, driven as a wizard would.
impl Run {
    fn new(out: &Path, wanted: WantedRecording) -> Run {
        let mut files = files();
        files.spec.trial.presses = 40;
        let plan = files.spec.plan.as_mut().expect("a plan");
        plan.familiarisation.as_mut().expect("practice").presses = 30;
        let study = files.study().expect("a plan");
        let (spec, trial) = study.settings(wanted);
        files.spec = spec;
        Run::begin(files, trial, out)
    }

    fn takes(&mut self, event: ProtocolEvent) {
        let refused = self.input(Event::Protocol(event.clone()));
        assert_eq!(refused, None, "{event:?}");
    }

    fn refuses(&mut self, event: ProtocolEvent) {
        let refused = self.input(Event::Protocol(event.clone()));
        assert!(refused.is_some(), "{event:?} is taken");
    }

    fn next_phase(&mut self) {
        let phase = self.session().next_phase().expect("one more phase");
        let number = self.session().protocol.as_ref().expect("a plan").number + 1;
        self.takes(ProtocolEvent::PhaseStarted { phase, number });
    }

    /// Runs the trial to its end by itself.
    fn trial(&mut self) {
        assert_eq!(self.input(Event::TrialStarted), None);
        while self.session().phase == TrialPhase::Running {
            let events = self.engine.fire();
            events.iter().for_each(|stamped| self.log.append(stamped).expect("the log can be written"));
        }
        self.now_s = self.session().time.as_secs_f64();
    }

    /// Goes through everything that is left, as it is meant.
    fn go_through(&mut self) {
        while self.session().next_phase().is_some() {
            self.next_phase();
            match self.session().study_phase().cloned().expect("a phase") {
                PhaseSpec::Instruction { steps } | PhaseSpec::Debriefing { steps } => {
                    (1..=steps.len()).for_each(|step| self.takes(ProtocolEvent::Ticked { step, done: true }));
                }
                PhaseSpec::Tutorial { .. } => panic!("no display takes part"),
                PhaseSpec::Trial | PhaseSpec::Familiarisation => self.trial(),
                PhaseSpec::Questionnaire { questionnaire } => {
                    for item in questionnaire.items {
                        self.takes(ProtocolEvent::ItemAnswered { item: item.id, answer: 5_u8.into() });
                    }
                    self.takes(ProtocolEvent::AnswersConfirmed);
                }
            }
        }
        if self.session().protocol.as_ref().is_some_and(|it| it.practice.as_ref().is_some_and(|it| !it.met)) {
            self.takes(ProtocolEvent::CriterionWaived { reason: "no time".to_string() });
        }
    }

    fn close(mut self) -> PathBuf {
        assert_eq!(self.input(Event::SessionEnded), None);
        self.log.folder().to_path_buf()
    }
}

fn consent() -> ProtocolEvent {
    study(|_| ()).consent_given(AnswerDevice::Console)
}

fn wanted(slot: usize, instructed: bool) -> WantedRecording {
    WantedRecording { participant: 0, slot, attempt: 1, instructed }
}

#[test]
fn what_happens_around_a_trial_keeps_its_order() {
    let out = folder("order");
    let mut run = Run::new(&out, wanted(0, false));
    assert!(run.input(Event::TrialStarted).is_some(), "no trial before its phase");
    run.takes(consent());
    run.refuses(consent());
    run.next_phase();
    run.refuses(ProtocolEvent::Ticked { step: 0, done: true });
    run.refuses(ProtocolEvent::Ticked { step: 99, done: true });
    run.refuses(ProtocolEvent::Ticked { step: 1, done: false });
    assert!(run.input(Event::TrialStarted).is_some(), "no trial in the instruction");
    let (phase, number) = (run.session().next_phase().expect("practice"), 2);
    run.refuses(ProtocolEvent::PhaseStarted { phase, number });
    let steps = run.session().study_phase().expect("a phase").steps().len();
    (1..=steps).for_each(|step| run.takes(ProtocolEvent::Ticked { step, done: true }));
    run.refuses(ProtocolEvent::PhaseStarted { phase, number: 3 });
    run.next_phase();
    run.refuses(ProtocolEvent::CriterionWaived { reason: "too early".to_string() });
    run.trial();
    let practice = run.session().protocol.clone().and_then(|it| it.practice).expect("it was judged");
    assert!(!practice.met, "nobody serves two orders in 30 presses: {practice:?}");
    assert!(run.session().is_step_done());
    run.refuses(ProtocolEvent::CriterionWaived { reason: String::new() });
    let folder = run.close();
    assert!(verify(&folder).expect("readable").verified);
    let made = recordings::of_plan(&out, "study").expect("readable").0;
    assert!(matches!(&made[0].outcome, RecordingOutcome::Void { reason } if reason == "criterion not met"), "{made:?}");
    assert!(made[0].consent && made[0].instructed);
}

#[test]
fn items_are_answered_back_and_forth_and_confirmed() {
    // Of P01, the trial with signals has the items about them.
    let study = study(|_| ());
    let slot = study.slots(0).iter().position(|slot| slot.condition == StudyArm::Wizard).expect("one");
    let out = folder("items");
    let mut run = Run::new(&out, wanted(slot, true));
    run.next_phase();
    run.trial();
    run.next_phase();
    let items = run.session().questionnaire().expect("it is asked").items.clone();
    let id = |index: usize| items[index].id.clone();
    assert_eq!((id(0), id(1)), ("too_often".to_string(), "annoyed".to_string()));
    let at = |run: &Run| run.session().protocol.as_ref().expect("a plan").item;
    run.refuses(ProtocolEvent::ItemAnswered { item: id(0), answer: 0_u8.into() });
    run.refuses(ProtocolEvent::ItemAnswered { item: id(0), answer: 8_u8.into() });
    run.refuses(ProtocolEvent::ItemAnswered { item: id(1), answer: 3_u8.into() });
    run.takes(ProtocolEvent::ItemAnswered { item: id(0), answer: 7_u8.into() });
    assert_eq!(at(&run), 1);
    run.takes(ProtocolEvent::ItemShown { item: id(2) });
    for item in 2..items.len() {
        run.takes(ProtocolEvent::ItemSkipped { item: id(item) });
    }
    assert_eq!(at(&run), 1, "after the last comes the one that was left out");
    run.refuses(ProtocolEvent::AnswersConfirmed);
    run.takes(ProtocolEvent::ItemAnswered { item: id(1), answer: 1_u8.into() });
    assert_eq!(at(&run), items.len(), "all answers");
    run.takes(ProtocolEvent::ItemShown { item: id(0) });
    run.takes(ProtocolEvent::ItemAnswered { item: id(0), answer: 2_u8.into() });
    assert_eq!(at(&run), items.len(), "one was changed, the others stand");
    run.takes(ProtocolEvent::AnswersConfirmed);
    run.refuses(ProtocolEvent::ItemShown { item: id(0) });
    run.go_through();
    assert!(verify(&run.close()).expect("readable").verified);
}

/// A terminal that reports no releases: the same digit again after 0.3 s is no held key. Enter is, which goes on.
#[test]
fn hasty_answers_are_all_taken() {
    let mut run = Run::new(&folder("hasty"), wanted(1, true));
    run.next_phase();
    run.trial();
    run.next_phase();
    let mut model = console_model(&run.session().kitchen, &run.session().spec, (80, 24));
    let items = run.session().questionnaire().expect("it is asked").items.clone();
    let mut now_s = 5.0;
    for item in &items {
        for (code, after_s) in [(KeyCode::Char('4'), 0.3), (KeyCode::Char('5'), 0.3), (KeyCode::Enter, 1.0)] {
            now_s += after_s;
            model.clock = at(now_s);
            let key = ConsoleMessage::Key(KeyEvent::new(code, KeyModifiers::NONE));
            let command = update(&mut model, run.session(), key);
            let answered = ProtocolEvent::ItemAnswered { item: item.id.clone(), answer: 5_u8.into() };
            let wanted = (code == KeyCode::Enter).then_some(ConsoleCommand::Input(Event::Protocol(answered)));
            assert_eq!(command, wanted, "item {}: {:?}", item.id, model.notice);
            if let Some(ConsoleCommand::Input(event)) = command {
                assert_eq!(run.input(event), None);
            }
        }
    }
    for (gap_s, counts) in [(1.0, true), (0.3, false), (0.3, false), (0.3, true)] {
        model.clock = at(model.clock.as_secs_f64() + gap_s);
        let key = ConsoleMessage::Key(KeyEvent::new(KeyCode::Enter, KeyModifiers::NONE));
        let command = update(&mut model, run.session(), key);
        assert_eq!(command.is_some(), counts, "after {gap_s} s: {command:?}");
        if let Some(ConsoleCommand::Input(event)) = command {
            assert_eq!(run.input(event), None);
        }
    }
}

#[test]
fn where_a_recording_ended_is_told_by_the_presses_of_the_trial_and_by_the_phase() {
    let (study, out) = (study(|_| ()), folder("ended-where"));
    let mut run = Run::new(&out, wanted(1, true));
    run.next_phase();
    run.trial();
    run.next_phase();
    let item = run.session().questionnaire().expect("a questionnaire").items[0].id.clone();
    run.takes(ProtocolEvent::ItemAnswered { item, answer: 5_u8.into() });
    let recording = run.close();
    // Somebody pressed a button before the start.
    let log = fs::read_to_string(recording.join(LOG_NAME)).expect("a log");
    let press = log.lines().find(|line| line.contains("\"kind\":\"press\"")).expect("a press").to_string();
    let start = log.lines().find(|line| line.contains("\"trial_started\"")).expect("a start");
    fs::write(recording.join(LOG_NAME), log.replacen(start, &format!("{press}\n{start}"), 1)).expect("written");
    let made = recordings::of_plan(&out, "study").expect("readable").0;
    assert_eq!((made[0].presses, made[0].outcome.clone()), (40, RecordingOutcome::Open));
    let progress = ParticipantProgress::from_recordings(&study, 0, &made).expect("a recording of the plan");
    let ended_where = &progress.steps[1].recordings[0].ended_where;
    let words = "the trial is over after 40 of 304 presses; of the questionnaire ";
    assert!(ended_where.starts_with(words) && ended_where.contains(" 1 of "), "{ended_where}");
    // A practice criterion that was waived is told, too.
    let mut run = Run::new(&out, wanted(0, false));
    run.takes(consent());
    run.go_through();
    run.close();
    let made = recordings::of_plan(&out, "study").expect("readable").0;
    assert!(made.iter().any(|one| one.waived.as_deref() == Some("no time")), "{made:?}");
}

/// Copies a recording, cut after `bytes` of its log.
fn cut(recording: &Path, out: &Path, bytes: usize) -> PathBuf {
    let folder = out.join(recording.file_name().expect("a name"));
    let _ = fs::remove_dir_all(out);
    fs::create_dir_all(&folder).expect("a folder");
    let text = fs::read(recording.join(LOG_NAME)).expect("a log");
    fs::write(folder.join(LOG_NAME), &text[..bytes.min(text.len())]).expect("written");
    folder
}

#[test]
fn wherever_a_recording_is_cut_it_is_open_verified_and_known() {
    let study = study(|_| ());
    let mut run = Run::new(&folder("whole"), wanted(2, false));
    run.takes(consent());
    run.go_through();
    let whole = run.close();
    let text = fs::read(whole.join(LOG_NAME)).expect("a log");
    let ends: Vec<usize> = (1..=text.len()).filter(|&end| text[end - 1] == b'\n').collect();
    let cuts = folder("cuts");
    let is_gaze = |end: usize| {
        text[end..].starts_with(b"{\"seq\"")
            && text[end..][..80.min(text.len() - end)].windows(13).any(|part| part == b"\"kind\":\"gaze\"")
    };
    let places = ends.iter().copied().filter(|&end| end < text.len() && !is_gaze(end));
    for (index, end) in places.enumerate() {
        // Between two lines, and within one.
        for bytes in [end, end + 9] {
            let recording = cut(&whole, &cuts, bytes);
            let made = recordings::of_plan(&cuts, "study").expect("readable").0;
            assert_eq!((made.len(), &made[0].outcome), (1, &RecordingOutcome::Open), "cut after {bytes} bytes");
            // To run it again each time would take long.
            if index % 40 == 0 {
                let found = verify(&recording).expect("readable");
                assert!(found.verified && found.cut, "cut after {bytes} bytes: {found:?}");
            }
        }
    }
    let recording = cut(&whole, &cuts, text.len());
    let made = recordings::of_plan(&cuts, "study").expect("readable").0;
    assert_eq!(made[0].outcome, RecordingOutcome::Complete);
    assert!(verify(&recording).expect("readable").verified);
    // A recording that was killed before its header was there is none; nor is one of another plan, or a simulated one.
    cut(&whole, &cuts, 100);
    assert_eq!(recordings::of_plan(&cuts, "study").expect("readable").0, Vec::new());
    assert_eq!(recordings::of_plan(whole.parent().expect("a folder"), "other").expect("readable").0, Vec::new());
    let progress = ParticipantProgress::from_recordings(&study, 0, &[]).expect("nothing recorded");
    assert_eq!(progress.next, NextRecording::Begin { slot: 0, attempt: 1 });
    check_damaged_headers(&text, &cuts);
}

/// A recording that cannot be read is told: otherwise its trial would be offered again.
fn check_damaged_headers(log: &[u8], out: &Path) {
    let log = String::from_utf8_lossy(log).into_owned();
    let told = |text: &str| {
        let damaged = out.join("damaged");
        fs::create_dir_all(&damaged).expect("a folder");
        fs::write(damaged.join(LOG_NAME), text).expect("written");
        let found = recordings::of_plan(out, "study").map(|(made, _)| made.len());
        fs::remove_dir_all(damaged).expect("removed");
        found.map_err(|error| error.to_string())
    };
    let ours = "{\"format\":\"tomcom-session\",";
    assert!(log.starts_with(ours));
    assert_eq!(told(&log), Ok(1));
    for damage in ["\"version\":99,", "\"trial\":\"first\",", "\u{0}\u{0}"] {
        let found = told(&log.replacen(ours, &format!("{ours}{damage}"), 1)).expect_err(damage);
        assert!(found.contains("damaged/events.jsonl:1:"), "{damage}: {found}");
    }
    let of_another = log.replacen("\"plan\":\"study\"", "\"plan\":\"other\"", 1).replacen(
        ours,
        &format!("{ours}\"trial\":\"first\","),
        1,
    );
    assert_eq!(told(&of_another), Ok(0), "the trials of this plan are not in it");
    // A file of another program, and a folder without a recording.
    assert_eq!(told("{\"format\":\"of another program\"}\n"), Ok(0));
    fs::create_dir_all(out.join("notes")).expect("a folder");
    fs::write(out.join("notes.txt"), "notes").expect("written");
    assert_eq!(told(&log), Ok(1));
    // The log cannot be opened.
    fs::create_dir_all(out.join("odd").join(LOG_NAME)).expect("a folder");
    let found = told(&log).expect_err("a folder instead of a log");
    assert!(found.contains("odd/events.jsonl: cannot be read"), "{found}");
    fs::remove_dir_all(out.join("odd")).expect("removed");
}

#[test]
fn a_trial_of_a_plan_that_the_wizard_ends_counts_and_one_that_is_left_stays_open() {
    let out = folder("left");
    let mut run = Run::new(&out, wanted(1, true));
    run.next_phase();
    assert_eq!(run.input(Event::TrialStarted), None);
    let outcome = || recordings::of_plan(&out, "study").expect("readable").0[0].outcome.clone();
    assert_eq!(outcome(), RecordingOutcome::Running, "while it is written");
    let cut = folder("left-cut");
    let name = run.log.folder().file_name().expect("a name").to_owned();
    fs::create_dir_all(cut.join(&name)).expect("a folder");
    fs::copy(run.log.folder().join(LOG_NAME), cut.join(&name).join(LOG_NAME)).expect("copied");
    assert_eq!(recordings::of_plan(&cut, "study").expect("readable").0[0].outcome, RecordingOutcome::Open);
    assert!(!run.session().is_step_done(), "left now, it can be continued");
    let press = Event::Press { agent: Agent::Human, button: "take rice".to_string(), at_ns: None, button_box: false };
    assert_eq!(run.input(press), None);
    assert_eq!(run.input(Event::TrialEnded { reason: TrialEndReason::Wizard }), None);
    run.go_through();
    run.close();
    assert_eq!(outcome(), RecordingOutcome::Complete);
    // What the study leaves out is to be recorded again.
    for (ends, void) in [
        (Event::TrialAborted { reason: "fire alarm".to_string() }, "aborted (fire alarm)"),
        (Event::TrialEnded { reason: TrialEndReason::Wizard }, "no press in it"),
    ] {
        let out = folder("void");
        let mut run = Run::new(&out, wanted(1, true));
        run.next_phase();
        assert_eq!(run.input(Event::TrialStarted), None);
        assert_eq!(run.input(ends), None);
        if run.session().aborted.is_none() {
            run.go_through();
        }
        assert!(run.session().is_step_done(), "left now, it is over");
        run.close();
        let outcome = recordings::of_plan(&out, "study").expect("readable").0[0].outcome.clone();
        assert_eq!(outcome, RecordingOutcome::Void { reason: void.to_string() });
    }
}
