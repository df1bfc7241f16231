//! The two lowest lines of the console: messages at full width, and below them hints with the keys that have an effect
//! now.

use std::borrow::Cow;

use ratatui::layout::Rect;
use ratatui::style::Style;

use super::paint::Painter;
use super::regions::PanelAreas;
use super::theme::TextRole;
use crate::console::console_model::{ConsoleModel, Dialog, Notice, NoticeLevel, Playback, ReplayAction};
use crate::console::interventions::can_redo;
use crate::console::key_action::{KeyAction, KeyBinding, KeyLayer, ManualAction, RaterAction, ViewAction};
use crate::console::mouse::ClickAction;
use crate::console::panels::{cut_landmark, is_away, opens_difference};
use crate::console::possible::is_possible;
use crate::console::text_columns::{width, wrap_to};
use tomcom_session::history::{event_words, wording};
use tomcom_session::settings::ParticipantKind;
use tomcom_session::{Session, TrialPhase};

/// A key hint in the console's lowest line: keys, the action of a click on each, and a label.
struct Hint<'a> {
    keys: Vec<(String, Option<ClickAction>)>,
    label: Cow<'a, str>,
    role: TextRole,
}

pub fn draw(brush: &mut Painter, regions: &PanelAreas, session: &Session, model: &ConsoleModel) {
    let area = regions.footer;
    if !model.focused && model.playback.is_none() {
        let alarm = brush.theme.badge(TextRole::Alarm);
        let words = " KEYBOARD FOCUS LOST: keys and robot stop do not work; click into this window ";
        brush.styled(area.x, area.y, area.width, &format!("{words:<width$}", width = usize::from(area.width)), alarm);
        return;
    }
    let mut x = area.x;
    if session.spec.participant.kind == ParticipantKind::Keyboard && model.playback.is_none() {
        let (label, role) = match model.layer {
            KeyLayer::Wizard => (" KEYS: WIZARD ", TextRole::Strong),
            KeyLayer::Participant => (" KEYS: PARTICIPANT ", TextRole::Human),
        };
        x = brush.styled(x, area.y, area.width, label, brush.theme.badge(role));
    }
    // The hints for ending the trial and for a typed note are the first to be left out if there is no room, since they
    // are rarely needed; after the trial, the hints for the next step come first.
    let is_over = is_over(session, model);
    let is_late = |binding: &&KeyBinding| match is_over {
        true => !matches!(binding.action, KeyAction::Advance | KeyAction::Quit | KeyAction::Manual(ManualAction::Redo)),
        false => matches!(
            binding.action,
            KeyAction::EndTrial
                | KeyAction::Look(ViewAction::Next | ViewAction::Open)
                | KeyAction::Manual(ManualAction::NoteInWords)
        ),
    };
    let (mut late, mut first): (Vec<&KeyBinding>, Vec<&KeyBinding>) = model.keys.bindings.iter().partition(is_late);
    late.sort_by_key(|binding| binding.action != KeyAction::Manual(ManualAction::NoteInWords));
    // The first hint is the robot stop, then the release of a held robot, then the key back to all panels while one is at
    // full size, then follow a rater's keys.
    first.sort_by_key(|binding| match binding.action {
        KeyAction::StopRobot => 0,
        KeyAction::Manual(ManualAction::HoldRobot) => 1,
        KeyAction::Look(ViewAction::All) => 2,
        KeyAction::Rate(_) => 3,
        _ => 4,
    });
    for binding in first.into_iter().chain(late) {
        let Some(hint) = hint(binding, session, model) else { continue };
        let keys: u16 = hint.keys.iter().map(|(key, _)| width(key)).sum();
        if x + keys + width(&hint.label) + 3 <= area.right() {
            x = hint.draw(brush, x + 2, area.y);
        }
    }
}

impl Hint<'_> {
    /// Draws the key hint; returns the column after it. A click on the label does what the first key does.
    fn draw(&self, brush: &mut Painter, x: u16, y: u16) -> u16 {
        let mut at = x;
        for (key, click) in &self.keys {
            let end = brush.text(at, y, width(key), key, self.role);
            if let Some(action) = click {
                brush.target(Rect { x: at, y, width: end - at, height: 1 }, *action);
            }
            at = end;
        }
        let words = format!(" {}", self.label);
        let end = brush.text(at, y, width(&words), &words, TextRole::Quiet);
        if let Some(action) = self.keys.iter().find_map(|(_, click)| *click) {
            brush.target(Rect { x: at, y, width: end - at, height: 1 }, action);
        }
        end
    }
}

/// The key hint of a key binding, if its action has an effect now.
fn hint<'a>(binding: &'a KeyBinding, session: &Session, model: &'a ConsoleModel) -> Option<Hint<'a>> {
    let label = label(binding, session, model)?;
    let role = if binding.action == KeyAction::StopRobot { TextRole::Alarm } else { TextRole::Strong };
    let is_pair = matches!(binding.action, KeyAction::Move(_));
    if !is_pair && !is_possible(session, model, &binding.action) {
        return None;
    }
    let part = |action: &KeyAction| {
        let chord = model.keys.chord_for(action).filter(|_| is_possible(session, model, action))?;
        Some((chord.to_string(), Some(ClickAction::Key(chord))))
    };
    // Keys for two opposite directions share a key hint, and so do keys of one kind.
    let pair = |[back, on]: [ReplayAction; 2]| {
        let parts = [back, on].map(KeyAction::Move).iter().filter_map(part).collect::<Vec<_>>();
        match parts.as_slice() {
            [back, on] => vec![back.clone(), ("/".to_string(), None), on.clone()],
            _ => parts,
        }
    };
    let group = |words: String, filter: &'static str| vec![(words, Some(ClickAction::Palette(filter)))];
    let keys = match binding.action {
        KeyAction::Note(_) if session.spec.console.notes.len() > 1 => {
            group(format!("1-{}", session.spec.console.notes.len()), "notes")
        }
        KeyAction::Rate(RaterAction::Belief(_)) => group("letters".to_string(), "wrongabout"),
        KeyAction::Move(ReplayAction::StepForward) => pair([ReplayAction::StepBack, ReplayAction::StepForward]),
        KeyAction::Move(ReplayAction::SeekForward) => pair([ReplayAction::SeekBack, ReplayAction::SeekForward]),
        KeyAction::Move(ReplayAction::Faster) => pair([ReplayAction::Faster, ReplayAction::Slower]),
        KeyAction::Move(ReplayAction::ToEnd) => pair([ReplayAction::ToStart, ReplayAction::ToEnd]),
        _ => part(&binding.action).into_iter().collect(),
    };
    (!keys.is_empty()).then_some(Hint { keys, label, role })
}

/// Draws the line of messages: the question whether to send a clicked signal, or the latest notice, or else what stays:
/// the landmark or event at which a replay stands, or the reason for which the robot arm stopped itself.
pub fn message(brush: &mut Painter, regions: &PanelAreas, session: &Session, model: &ConsoleModel) {
    let area = regions.message;
    if area.area() == 0 {
        return;
    }
    if let Some(Dialog::Send(confirmation)) = &model.dialog {
        let words = wording::signal(&confirmation.signal);
        let strong = brush.theme.badge(TextRole::Strong);
        let text = format!(" Send {words}? enter or a second click sends it, esc cancels ");
        brush.styled(area.x + 1, area.y, area.width - 1, &text, strong);
        return;
    }
    if let Some(check) = session.calibration.as_ref().filter(|check| check.result.is_none()) {
        let (at, all) = (check.shown.map_or(0, |(index, _)| index + 1), check.targets.len());
        let who = match session.spec.participant.kind {
            ParticipantKind::Simulated => "the simulated participant looks at the cross",
            ParticipantKind::Display => "ask the participant to look at the dot on the page",
            ParticipantKind::Keyboard | ParticipantKind::External => "ask the participant to look at the cross",
        };
        let text = format!(" Gaze check, target {at} of {all}: {who}; esc ends it ");
        brush.text(area.x + 1, area.y, area.width - 1, &text, TextRole::Strong);
        return;
    }
    if let Some(notice) = model.shown_notice() {
        let style = style_of(brush, notice);
        brush.styled(area.x + 1, area.y, area.width - 1, &format!(" {} ", notice.text), style);
    } else if let Some((_, landmark)) = model.playback.as_ref().and_then(Playback::stands_at) {
        let (columns, ellipsis) = (area.width.saturating_sub(3), brush.theme.signs().ellipsis);
        let open = cut_landmark(model, session).and(model.keys.chord_for(&KeyAction::Look(ViewAction::Open)));
        let ellipsis = open.map_or(ellipsis.to_string(), |open| format!("{ellipsis} {open} shows all"));
        for (row, line) in wrap_to(landmark, columns, area.height, &ellipsis).iter().enumerate() {
            brush.text(area.x + 2, area.y + row as u16, columns, line, TextRole::Strong);
        }
    } else if session.robot.stopped && !session.robot.is_stopped_by_wizard() {
        let why = event_words::why_stopped(&session.robot.arm);
        let resume = model.keys.chord_for(&KeyAction::ResumeRobot).filter(|_| model.playback.is_none());
        let resume = resume.map_or(String::new(), |key| format!("; {key} resumes the arm"));
        brush.text(area.x + 2, area.y, area.width - 2, &format!("Arm stopped: {why}{resume}"), TextRole::Alarm);
    }
}

fn style_of(brush: &Painter, notice: &Notice) -> Style {
    match notice.level {
        NoticeLevel::Done => brush.style(TextRole::Strong),
        NoticeLevel::Refused => brush.theme.badge(TextRole::Strong),
        NoticeLevel::Alarm => brush.theme.badge(TextRole::Alarm),
    }
}

fn is_over(session: &Session, model: &ConsoleModel) -> bool {
    model.playback.is_none() && matches!(session.phase, TrialPhase::Over(_) | TrialPhase::Closed)
}

/// The next step of the study plan, in words.
pub(super) fn onward(session: &Session, model: &ConsoleModel) -> Option<String> {
    let (step, _) = session.step().filter(|_| session.phase != TrialPhase::Closed)?;
    Some(match session.next_phase() {
        _ if session.aborted.is_some() => "repeat the trial".to_string(),
        Some(phase) => format!("next phase: {}", phase.title()),
        None if step.is_tutorial_alone() => "leave the tutorial".to_string(),
        None if model.is_last_recording => "end the series".to_string(),
        None => "next recording".to_string(),
    })
}

/// The key that repeats an aborted or excluded trial: after an aborted one of a plan, the one that goes on.
pub(super) fn repeats(session: &Session) -> Option<KeyAction> {
    can_redo(session).then_some(match session.aborted.is_some() && session.protocol.is_some() {
        true => KeyAction::Advance,
        false => KeyAction::Manual(ManualAction::Redo),
    })
}

/// Label of a key binding in the line of key hints, if it may stand there; whether its action has an effect now is not
/// checked here.
fn label<'a>(binding: &'a KeyBinding, session: &Session, model: &ConsoleModel) -> Option<Cow<'a, str>> {
    if binding.layer.is_some_and(|layer| layer != model.layer) {
        return None;
    }
    let label = binding.footer.map(Cow::Borrowed);
    let plays = model.playback.as_ref().is_some_and(|playback| playback.playing);
    let is_over = is_over(session, model);
    let word = match binding.action {
        KeyAction::Manual(ManualAction::Redo) => {
            (repeats(session).as_ref() == Some(&binding.action)).then_some("repeat the trial")
        }
        KeyAction::Advance if model.lesson.is_some() => {
            let begun = model.lesson.as_ref().is_some_and(|lesson| lesson.begun);
            Some(if plays {
                "pause"
            } else if begun {
                "resume"
            } else {
                "start"
            })
        }
        KeyAction::Advance if is_over => return onward(session, model).map(Cow::Owned),
        KeyAction::Advance => match session.phase {
            TrialPhase::Running => Some("pause"),
            TrialPhase::Paused => Some("resume"),
            _ => Some("start"),
        },
        KeyAction::Move(ReplayAction::PlayPause) => Some(if plays { "pause" } else { "play" }),
        KeyAction::Manual(ManualAction::NoteInWords) if session.is_running() => Some("mark"),
        KeyAction::Manual(ManualAction::HoldRobot) if session.robot.held && !is_over => Some("release robot"),
        // Where nothing is to be undone, one step back leaves; live, the key that quits says so.
        KeyAction::Look(ViewAction::All) if !is_away(model) => {
            let is_saved = model.coding.as_ref().is_some_and(|coding| coding.is_saved);
            model.playback.as_ref().map(|_| if is_saved { "leave (saved)" } else { "leave" })
        }
        KeyAction::Look(ViewAction::Open) if opens_difference(model) => Some("difference"),
        KeyAction::Look(ViewAction::Open) if cut_landmark(model, session).is_some() => Some("whole text"),
        KeyAction::Quit if is_over && session.is_step_done() => Some("close the session"),
        // After the trial the robot rests, and the line of key hints offers only the next step.
        KeyAction::StopRobot
        | KeyAction::ResumeRobot
        | KeyAction::SwitchLayer
        | KeyAction::TakeBack
        | KeyAction::Look(ViewAction::Next | ViewAction::Open)
            if is_over =>
        {
            None
        }
        _ => return label,
    };
    word.map(Cow::Borrowed)
}
