//! Which actions have an effect now: the line of key hints shows only those.

use super::actions::{preset_notes, refusal, shown};
use super::beliefs::{beliefs, visibility};
use super::console_model::{ComparisonAction, ConsoleModel, Dialog, Playback, ReplayAction, SPEEDS};
use super::form::sheet;
use super::interventions::{can_redo, skippable};
use super::key_action::{KeyAction, KeyBinding, ManualAction, RaterAction, ViewAction};
use super::key_press::is_right_after_list;
use super::panels::{cut_landmark, opens_difference};
use super::preflight;
use tomcom_core::communication::Sender;
use tomcom_session::admit::admit;
use tomcom_session::event::SignalEndReason;
use tomcom_session::gaze_check::GazeCheckEvent;
use tomcom_session::probes::ProbeEvent;
use tomcom_session::settings::WizardVisibility;
use tomcom_session::{Event, Session, TrialPhase, offers};

/// Whether an action would have an effect now, given the dialog or sheet that covers the console.
pub(super) fn is_possible(session: &Session, model: &ConsoleModel, action: &KeyAction) -> bool {
    reaches(session, model, action) && does(session, model, action)
}

/// Whether an action would have an effect once the open dialog is closed.
pub(super) fn is_possible_behind(session: &Session, model: &ConsoleModel, action: &KeyAction) -> bool {
    (!has_sheet(session, model) || acts_on_sheet(session, action)) && does(session, model, action)
}

/// For each entry of the key table, whether its key has an effect now.
pub(super) fn effects(session: &Session, model: &ConsoleModel) -> Vec<bool> {
    let has_layer = |binding: &KeyBinding| binding.layer.is_none_or(|layer| layer == model.layer);
    let has_effect = |binding: &KeyBinding| has_layer(binding) && is_possible_behind(session, model, &binding.action);
    model.keys.bindings.iter().map(has_effect).collect()
}

/// Whether a sheet (a form at full size) covers the console and takes the keys.
fn has_sheet(session: &Session, model: &ConsoleModel) -> bool {
    model.playback.is_none() && sheet(session).is_some()
}

/// Whether an action is possible while a sheet covers the console: help, quitting, the robot stop, and repairs.
pub(super) fn acts_on_sheet(session: &Session, action: &KeyAction) -> bool {
    // During a freeze probe, the trial can also be ended or aborted.
    let in_probe = matches!(
        action,
        KeyAction::EndTrial
            | KeyAction::Manual(ManualAction::SkipProbe | ManualAction::Abort | ManualAction::NoteInWords)
    );
    (in_probe && session.is_frozen())
        || matches!(
            action,
            KeyAction::Help
                | KeyAction::Look(ViewAction::All)
                | KeyAction::Palette
                | KeyAction::Quit
                | KeyAction::StopRobot
                | KeyAction::ResumeRobot
                | KeyAction::Manual(ManualAction::Calibrate | ManualAction::ConfirmArm)
        )
}

fn reaches(session: &Session, model: &ConsoleModel, action: &KeyAction) -> bool {
    let has_control = || model.keys.chord_for(action).is_some_and(|chord| chord.ctrl);
    let stops = *action == KeyAction::StopRobot;
    match &model.dialog {
        None if has_sheet(session, model) => acts_on_sheet(session, action),
        None => true,
        // Enter answers the question whether to send, and esc closes it, so both keys lose their usual action.
        Some(Dialog::Send(_)) => !matches!(action, KeyAction::Accept | KeyAction::Look(ViewAction::All)),
        // In text input the space bar types a space instead of stopping the robot, unless the trial goes on.
        Some(Dialog::Note(_) | Dialog::Reason(..) | Dialog::Answer(_)) => stops && session.is_running(),
        Some(Dialog::Report(_)) => false,
        Some(Dialog::Preflight) => match action {
            KeyAction::Advance => preflight::all_ok(&preflight::checks(session, model)),
            KeyAction::ResumeRobot | KeyAction::Manual(ManualAction::HoldRobot | ManualAction::ConfirmArm) => true,
            KeyAction::Quit => has_control(),
            _ => stops,
        },
        Some(Dialog::Pick(_) | Dialog::Palette(_) | Dialog::Help(_) | Dialog::Details(..)) => {
            stops || (*action == KeyAction::Quit && has_control())
        }
        Some(Dialog::Quit | Dialog::EndTrial | Dialog::EndTutorial | Dialog::Calibration) => stops,
    }
}

/// Whether an action would have an effect in the present state of session and console, apart from open dialogs.
fn does(session: &Session, model: &ConsoleModel, action: &KeyAction) -> bool {
    let admits = |event: Event| admit(session, &event).is_ok();
    let runs = matches!(session.phase, TrialPhase::Running | TrialPhase::Paused);
    match action {
        KeyAction::Signal(_, signal) => refusal(session, model.now, &shown(signal.clone())).is_none(),
        KeyAction::Accept => !is_right_after_list(model) && offers::enter(session, model.now).is_ok(),
        KeyAction::TakeBack => admits(Event::SignalEnded { reason: SignalEndReason::TakenBack }),
        KeyAction::Press(_) => session.is_running(),
        KeyAction::Note(_) => session.phase != TrialPhase::Closed && preset_notes(session),
        KeyAction::Advance => advances(session, model),
        KeyAction::EndTrial => runs,
        KeyAction::StopRobot => admits(Event::RobotStopped),
        KeyAction::ResumeRobot => admits(Event::RobotResumed),
        KeyAction::Manual(action) => intervenes(session, *action),
        KeyAction::Move(to) => model.playback.as_ref().is_some_and(|playback| moves(playback, *to)),
        KeyAction::Belief => {
            visibility(session, model) >= WizardVisibility::Belief && !beliefs(session, model).is_empty()
        }
        KeyAction::Differ(step) => differs(model, *step),
        KeyAction::Rate(rate) => rates(model, *rate),
        KeyAction::Look(ViewAction::Open) if opens_difference(model) => differs(model, ComparisonAction::Open),
        KeyAction::Look(ViewAction::Open) => model.focus.is_some() || cut_landmark(model, session).is_some(),
        KeyAction::SwitchLayer | KeyAction::Look(_) | KeyAction::Help | KeyAction::Palette | KeyAction::Quit => true,
    }
}

/// Whether the key that starts, pauses and resumes a trial has an effect now.
fn advances(session: &Session, model: &ConsoleModel) -> bool {
    match session.phase {
        _ if model.lesson.is_some() => true,
        TrialPhase::Ready => admit(session, &Event::TrialStarted).is_ok(),
        TrialPhase::Running => true,
        TrialPhase::Paused => admit(session, &Event::TrialResumed).is_ok(),
        TrialPhase::Over(_) => {
            session.protocol.is_some() && (session.aborted.is_some() || session.phase_lacks().is_none())
        }
        TrialPhase::Closed => false,
    }
}

fn intervenes(session: &Session, action: ManualAction) -> bool {
    let (phase, by) = (session.phase, Sender::Wizard);
    let admits = |event: Event| admit(session, &event).is_ok();
    match action {
        ManualAction::Correct | ManualAction::Abort => matches!(phase, TrialPhase::Running | TrialPhase::Paused),
        ManualAction::HoldRobot => phase != TrialPhase::Closed,
        ManualAction::SkipPress => admits(Event::RobotSkipped { by }),
        ManualAction::DriveRobot => session.is_running() && !session.robot.stopped,
        ManualAction::ConfirmArm => {
            let stage = session.robot.arm.stage.as_ref().map(|(stage, _)| *stage);
            stage.is_some_and(|stage| admits(Event::RobotConfirmed { stage }))
        }
        ManualAction::Redo => can_redo(session),
        ManualAction::Preflight => phase == TrialPhase::Ready,
        ManualAction::Calibrate => admits(Event::Calibration(GazeCheckEvent::begin())),
        ManualAction::NoteInWords => phase != TrialPhase::Closed,
        ManualAction::AskProbe => admits(Event::Probe(ProbeEvent::Requested)),
        ManualAction::SkipProbe => skippable(session).is_some(),
        ManualAction::Exclude => {
            let is_there = !matches!(phase, TrialPhase::Ready | TrialPhase::Closed);
            is_there && (session.aborted.is_none() || session.excluded.is_some())
        }
    }
}

fn moves(playback: &Playback, to: ReplayAction) -> bool {
    let (at_start, at_end) = (playback.event == 0, playback.event == playback.events);
    match to {
        ReplayAction::StepBack | ReplayAction::SeekBack | ReplayAction::ToStart | ReplayAction::BackTo(_) => !at_start,
        // A replay that already follows a growing recording cannot go further to its end.
        ReplayAction::ToEnd => !playback.follows && playback.events > 0,
        ReplayAction::StepForward | ReplayAction::SeekForward | ReplayAction::On(_) => !at_end,
        ReplayAction::Faster => playback.speed + 1 < SPEEDS.len(),
        ReplayAction::Slower => playback.speed > 0,
        ReplayAction::PlayPause => playback.events > 0,
        ReplayAction::ToEvent(_) | ReplayAction::ToTime(_) | ReplayAction::ToClock(_) | ReplayAction::ToNth(..) => true,
    }
}

fn differs(model: &ConsoleModel, step: ComparisonAction) -> bool {
    let chosen = model.comparison.as_ref().and_then(|compared| compared.chosen());
    chosen.is_some_and(|(at, seen)| match step {
        ComparisonAction::Open => true,
        ComparisonAction::Next => at + 1 < seen.differences.len(),
        ComparisonAction::Last => at > 0,
    })
}

fn rates(model: &ConsoleModel, rate: RaterAction) -> bool {
    let (Some(coding), Some(playback)) = (&model.coding, &model.playback) else { return false };
    let at = coding.at(playback.event);
    match rate {
        RaterAction::Next if coding.chosen.is_some() => true,
        RaterAction::Next => at.map_or(0, |at| at + 1) < coding.errors.len(),
        RaterAction::Last => at.is_some_and(|at| at > 0),
        RaterAction::Clear => at.is_some_and(|at| coding.code(&coding.errors[at]).is_some()),
        RaterAction::Undo => coding.can_undo(),
        RaterAction::Redo => coding.can_redo(),
        RaterAction::ChooseLater | RaterAction::ChooseEarlier => !coding.errors.is_empty(),
        RaterAction::Belief(_) | RaterAction::Cause(_) => at.is_some(),
    }
}
