//! The experimenter's manual interventions at the console: keys that correct the recorded state of the kitchen and
//! steer the robot, and the lists that they open.

use crossterm::event::KeyCode;

use super::actions::{open_dialog, refuse, send};
use super::console_model::{ConsoleCommand, ConsoleModel, Dialog, NoticeLevel};
use super::key_action::ManualAction;
use super::lists::{OTHER_REASON, Picker, PickerAnswer, PickerKind, PickerOutcome, ReasonFor};
use super::text_input::TextInput;
use tomcom_core::communication::Sender;
use tomcom_core::kitchen::Agent;
use tomcom_session::history::wording;
use tomcom_session::probes::ProbeEvent;
use tomcom_session::protocol::ProtocolEvent;
use tomcom_session::{Event, Session, TrialPhase};

pub(super) fn act(model: &mut ConsoleModel, session: &Session, action: ManualAction) -> Option<ConsoleCommand> {
    let by = Sender::Wizard;
    match action {
        ManualAction::Correct if !matches!(session.phase, TrialPhase::Running | TrialPhase::Paused) => {
            refuse(model, "the kitchen can be corrected only during a trial")
        }
        ManualAction::Correct => ask(model, PickerKind::Place),
        ManualAction::HoldRobot if session.robot.held => {
            let words = match session.robot.stopped {
                true => "the robot is no longer held, but still stopped",
                false => "the robot is released and continues",
            };
            send(model, session, Event::RobotReleased { by }, words)
        }
        ManualAction::HoldRobot => send(model, session, Event::RobotHeld { by }, "the robot is held"),
        ManualAction::SkipPress => send(model, session, Event::RobotSkipped { by }, "the robot's press is skipped"),
        ManualAction::DriveRobot if !session.is_running() => {
            refuse(model, "the robot's press can be chosen only while the trial runs")
        }
        ManualAction::DriveRobot if session.robot.stopped => refuse(model, "the robot is stopped: resume it first"),
        ManualAction::DriveRobot => ask(model, PickerKind::Button),
        ManualAction::ConfirmArm => match session.robot.arm.stage {
            Some((stage, _)) => {
                let words = format!("confirmed: {}", stage.asks().unwrap_or("nothing"));
                send(model, session, Event::RobotConfirmed { stage }, words)
            }
            None => refuse(model, "the arm's controller has not answered yet"),
        },
        ManualAction::Abort if !matches!(session.phase, TrialPhase::Running | TrialPhase::Paused) => {
            refuse(model, "no trial runs that could be aborted")
        }
        // The trial stands while the wizard chooses a reason and adds words: the space bar types a space in them.
        ManualAction::Abort if session.is_running() => {
            ask(model, PickerKind::Reason(ReasonFor::Abort));
            send(model, session, Event::TrialPaused, "the trial is paused; esc keeps it")
        }
        ManualAction::Abort => ask(model, PickerKind::Reason(ReasonFor::Abort)),
        ManualAction::Preflight if session.phase != TrialPhase::Ready => {
            refuse(model, "preflight checks are shown only before the trial starts")
        }
        ManualAction::Preflight => open_dialog(model, Dialog::Preflight),
        ManualAction::NoteInWords if session.is_running() => {
            let mark = Event::Marker { note: String::new(), observer: None };
            send(model, session, mark, "time marked: its words are typed when the trial stands")
        }
        ManualAction::NoteInWords if session.phase == TrialPhase::Closed => refuse(model, "the session is over"),
        ManualAction::NoteInWords => open_dialog(model, Dialog::Note(TextInput::default())),
        ManualAction::Calibrate => super::gaze_check::begin(model, session),
        ManualAction::Redo => redo(model, session),
        ManualAction::Exclude if session.excluded.is_some() => {
            send(model, session, Event::TrialIncluded, "the trial is no longer excluded")
        }
        ManualAction::Exclude if matches!(session.phase, TrialPhase::Ready | TrialPhase::Closed) => {
            refuse(model, "no trial has begun that could be excluded")
        }
        ManualAction::Exclude if session.aborted.is_some() => refuse(model, "an aborted trial is left out already"),
        ManualAction::Exclude => ask(model, PickerKind::Reason(ReasonFor::Exclude)),
        ManualAction::AskProbe => {
            send(model, session, Event::Probe(ProbeEvent::Requested), "a freeze probe is requested")
        }
        ManualAction::SkipProbe => match skippable(session) {
            Some(probe) => ask(model, PickerKind::Reason(ReasonFor::SkipProbe(probe))),
            None => refuse(model, "no freeze probe is open"),
        },
    }
}

/// Number of the freeze probe whose remaining questions can be skipped now.
pub(super) fn skippable(session: &Session) -> Option<u32> {
    let open = session.probes.open.as_ref()?;
    (open.closed.is_none() && session.phase == TrialPhase::Paused).then_some(open.number)
}

/// Closes the list of reasons for skipping a freeze probe, or the field for its words, once that probe is over, so that
/// the reason does not skip the next probe.
pub fn expire(model: &mut ConsoleModel, session: &Session) {
    if let Some(
        Dialog::Pick(Picker { kind: PickerKind::Reason(ReasonFor::SkipProbe(probe)), .. })
        | Dialog::Reason(ReasonFor::SkipProbe(probe), ..),
    ) = model.dialog
        && skippable(session) != Some(probe)
    {
        model.dialog = None;
        model.say(NoticeLevel::Refused, format!("freeze probe {probe} ended before it was skipped"));
    }
}

/// Whether the trial may be repeated, since it was aborted or excluded.
pub(super) fn can_redo(session: &Session) -> bool {
    matches!(session.phase, TrialPhase::Over(_)) && (session.aborted.is_some() || session.excluded.is_some())
}

fn redo(model: &mut ConsoleModel, session: &Session) -> Option<ConsoleCommand> {
    match session.phase {
        _ if can_redo(session) => Some(ConsoleCommand::Redo),
        TrialPhase::Over(_) => refuse(model, "only an aborted or excluded trial can be repeated"),
        _ => refuse(model, "abort the trial before you repeat it"),
    }
}

pub(super) fn ask(model: &mut ConsoleModel, kind: PickerKind) -> Option<ConsoleCommand> {
    open_dialog(model, Dialog::Pick(Picker::new(kind)))
}

/// Saves a typed note: as the words of the oldest time mark that has none, or else as a new note.
pub(super) fn save_note(model: &mut ConsoleModel, session: &Session, note: String) -> Option<ConsoleCommand> {
    match session.open_marks.as_slice() {
        [] if note.is_empty() => None,
        [] => send(model, session, Event::Marker { note, observer: None }, "the note is saved"),
        [(marker, _), others @ ..] => {
            let event = Event::MarkerWorded { marker: *marker, note };
            model.dialog = (!others.is_empty()).then(|| Dialog::Note(TextInput::default()));
            send(model, session, event, "the words of the time mark are saved")
        }
    }
}

/// Gives a chosen reason with the words that were typed beside it. Another reason than the preset ones needs words.
pub(super) fn word_reason(
    model: &mut ConsoleModel,
    session: &Session,
    what: ReasonFor,
    reason: String,
    line: TextInput,
) -> Option<ConsoleCommand> {
    match line.text() {
        words if words.is_empty() && reason == OTHER_REASON => {
            model.dialog = Some(Dialog::Reason(what, reason, line));
            refuse(model, "another reason needs words: type them, or esc goes back")
        }
        words if words.is_empty() => give_reason(model, session, what, reason),
        words => give_reason(model, session, what, format!("{reason}: {words}")),
    }
}

/// Aborts or excludes the trial, skips the rest of a probe, or waives the practice criterion, for this reason.
fn give_reason(model: &mut ConsoleModel, session: &Session, what: ReasonFor, reason: String) -> Option<ConsoleCommand> {
    let (event, words) = match what {
        ReasonFor::Abort => (Event::TrialAborted { reason }, "the trial is aborted".to_string()),
        ReasonFor::SkipProbe(probe) => {
            let words = "the other questions of the freeze probe are skipped";
            (Event::Probe(ProbeEvent::Skipped { probe, reason }), words.to_string())
        }
        ReasonFor::Exclude => {
            let words = format!("the trial is excluded: {reason}");
            (Event::TrialExcluded { reason }, words)
        }
        ReasonFor::Waive => (Event::Protocol(ProtocolEvent::CriterionWaived { reason }), String::new()),
    };
    send(model, session, event, words)
}

pub(super) fn pick(
    model: &mut ConsoleModel,
    session: &Session,
    mut picker: Picker,
    code: KeyCode,
) -> Option<ConsoleCommand> {
    let answer = match picker.key(session, code) {
        PickerOutcome::Nothing => return open_dialog(model, Dialog::Pick(picker)),
        PickerOutcome::Left => {
            // Esc in the list of contents goes back to the list of places.
            let back = matches!(picker.kind, PickerKind::Content(_)).then(|| Picker::new(PickerKind::Place));
            model.dialog = back.map(Dialog::Pick);
            return None;
        }
        PickerOutcome::Words(words) => {
            let PickerKind::Reason(what) = picker.kind else { return None };
            let field = TextInput::with_text(&words);
            return open_dialog(model, Dialog::Reason(what, OTHER_REASON.to_string(), field));
        }
        PickerOutcome::This(answer) => answer,
    };
    let takes_words = picker.takes_words(session);
    model.dialog = None;
    model.answered = Some(model.clock);
    let kitchen = &session.kitchen;
    match (picker.kind, answer) {
        (_, PickerAnswer::Place(place)) => ask(model, PickerKind::Content(place)),
        (PickerKind::Content(place), PickerAnswer::Content(content)) => {
            let (location, content) = (kitchen.location(place), kitchen.content(content).name.clone());
            let words = format!("kitchen corrected: {} holds {}", location.label(), kitchen.worded(&content));
            let event = Event::KitchenCorrected { location: location.name.clone(), content };
            send(model, session, event, words)
        }
        (_, PickerAnswer::Button(button)) => {
            let words = format!("the robot's next press: {}", wording::button(kitchen, Agent::Robot, button));
            let button = kitchen.button(Agent::Robot, button).name.clone();
            send(model, session, Event::RobotDriven { by: Sender::Wizard, button }, words)
        }
        (PickerKind::Reason(what), PickerAnswer::Reason(reason)) if takes_words => {
            open_dialog(model, Dialog::Reason(what, reason, TextInput::default()))
        }
        (PickerKind::Reason(what), PickerAnswer::Reason(reason)) => give_reason(model, session, what, reason),
        (_, PickerAnswer::Reason(_) | PickerAnswer::Content(_)) => None,
    }
}
