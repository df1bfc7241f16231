//! The two lowest lines: messages at full width, and below them the active key layer with the keys that are possible now.

use std::borrow::Cow;

use ratatui::style::Style;

use super::offer_line;
use super::paint::{Painter, width};
use super::regions::Regions;
use super::theme::TextRole;
use crate::communication::Sender;
use crate::console::console_model::{ConsoleModel, Dialog, Notice};
use crate::console::form::sheet;
use crate::console::key_action::ManualAction;
use crate::console::key_action::PanelKey;
use crate::console::key_action::{KeyAction, KeyBinding, KeyLayer};
use crate::console::notice::NoticeLevel;
use crate::console::playback::ReplayKey;
use crate::session::admit::may_send;
use crate::session::settings::ParticipantKind;
use crate::session::{Phase, Session};

/// Display time of a notice, in seconds.
const NOTICE_S: f64 = 4.0;

/// Draws the line of messages and the line of keys.
pub fn draw(brush: &mut Painter, regions: &Regions, session: &Session, model: &ConsoleModel) {
    message(brush, regions, model);
    let area = regions.footer;
    if !model.focused && model.playback.is_none() {
        let alarm = brush.theme.badge(TextRole::Alarm);
        let words = " THE KEYBOARD IS ELSEWHERE, and the robot stop with it: click into this window ";
        brush.text(area.x, area.y, area.width, &format!("{words:<width$}", width = usize::from(area.width)), alarm);
        return;
    }
    let mut x = area.x;
    if session.spec.participant.kind == ParticipantKind::Keyboard && model.playback.is_none() {
        let (label, role) = match model.layer {
            KeyLayer::Wizard => (" KEYS: WIZARD ", TextRole::Strong),
            KeyLayer::Participant => (" KEYS: PARTICIPANT ", TextRole::Human),
        };
        let badge = brush.theme.badge(role);
        x = brush.text(x, area.y, area.width, label, badge);
    }
    let end = area.right();
    // Ending the trial is rare, so its hint is dropped first; after the trial only quitting remains.
    let is_over = is_over(session, model);
    let is_late = |binding: &&KeyBinding| match is_over {
        true => !matches!(binding.action, KeyAction::Advance | KeyAction::Quit | KeyAction::Hand(ManualAction::Redo)),
        false => matches!(binding.action, KeyAction::EndTrial | KeyAction::Look(PanelKey::Next)),
    };
    let (late, mut first): (Vec<&KeyBinding>, Vec<&KeyBinding>) = model.keys.bindings.iter().partition(is_late);
    // The robot stop comes first, then the key back to all panels if one panel is at full size, and a rater's keys.
    first.sort_by_key(|binding| match binding.action {
        KeyAction::StopRobot => 0,
        KeyAction::Look(PanelKey::All) => 1,
        KeyAction::Rate(_) => 2,
        _ => 3,
    });
    for binding in first.into_iter().chain(late) {
        let Some(label) = label(binding, session, model) else { continue };
        let Some(chord) = binding.chords.first() else { continue };
        let key = match binding.action {
            KeyAction::Note(_) if session.spec.console.notes.len() > 1 => {
                format!("1-{}", session.spec.console.notes.len())
            }
            // The keys of both directions share one label.
            KeyAction::Move(ReplayKey::StepForward) => "left/right".to_string(),
            KeyAction::Move(ReplayKey::SeekForward) => "pgup/pgdn".to_string(),
            KeyAction::Move(ReplayKey::Faster) => "+/-".to_string(),
            KeyAction::Move(ReplayKey::ToEnd) => "home/end".to_string(),
            _ => chord.to_string(),
        };
        if x + width(&key) + width(&label) + 3 > end {
            continue;
        }
        let key_style = if binding.action == KeyAction::StopRobot { TextRole::Alarm } else { TextRole::Strong };
        x = brush.parts(x + 2, area.y, end - x, &[(&key, key_style), (" ", TextRole::Text), (&label, TextRole::Quiet)]);
    }
}

/// Draws the last notice.
fn message(brush: &mut Painter, regions: &Regions, model: &ConsoleModel) {
    let area = regions.message;
    let notice = model.notice.as_ref().filter(|notice| model.clock.secs_since(notice.at) < NOTICE_S);
    if let Some(notice) = notice.filter(|_| area.area() > 0) {
        let style = style_of(brush, notice);
        brush.text(area.x + 1, area.y, area.width - 1, &format!(" {} ", notice.text), style);
    }
}

fn style_of(brush: &Painter, notice: &Notice) -> Style {
    match notice.level {
        NoticeLevel::Done => brush.style(TextRole::Strong),
        NoticeLevel::Refused => brush.theme.badge(TextRole::Strong),
        NoticeLevel::Alarm => brush.theme.badge(TextRole::Alarm),
    }
}

/// Whether a live trial is over.
fn is_over(session: &Session, model: &ConsoleModel) -> bool {
    model.playback.is_none() && matches!(session.phase, Phase::Over(_) | Phase::Closed)
}

/// The next step after the trial, in a plan.
pub(super) fn onward(session: &Session) -> Option<String> {
    session.protocol.as_ref().filter(|_| session.phase != Phase::Closed)?;
    Some(match session.next_phase() {
        _ if session.aborted.is_some() => "do it again".to_string(),
        Some(phase) => format!("on to the {}", phase.name()),
        None => "done: next recording".to_string(),
    })
}

/// Label of a key in the footer, if the key is possible now.
fn label<'a>(binding: &'a KeyBinding, session: &Session, model: &ConsoleModel) -> Option<Cow<'a, str>> {
    if is_over(session, model)
        && binding.action == KeyAction::Advance
        && model.dialog.is_none()
        && sheet(session).is_none()
    {
        return onward(session).map(Cow::Owned);
    }
    fixed_label(binding, session, model).map(Cow::Borrowed)
}

/// The same for a key whose label does not name what comes next.
fn fixed_label<'a>(binding: &'a KeyBinding, session: &Session, model: &ConsoleModel) -> Option<&'a str> {
    match &model.dialog {
        // In text input the space bar types a space.
        Some(Dialog::Note(_)) => return None,
        Some(_) if binding.action != KeyAction::StopRobot => return None,
        _ => {}
    }
    let can_redo = session.aborted.is_some() || session.excluded.is_some();
    if binding.action == KeyAction::Hand(ManualAction::Redo) && matches!(session.phase, Phase::Over(_)) && can_redo {
        return Some("do it again");
    }
    let label = binding.footer?;
    if binding.layer.is_some_and(|layer| layer != model.layer) {
        return None;
    }
    if model.playback.is_none() && sheet(session).is_some() {
        // The sheet shows its own key hints.
        return matches!(binding.action, KeyAction::Quit | KeyAction::Help | KeyAction::StopRobot).then_some(label);
    }
    let runs = matches!(session.phase, Phase::Running | Phase::Paused);
    if is_over(session, model) {
        return match binding.action {
            KeyAction::Quit if !session.is_step_done() => Some(label),
            KeyAction::Quit => Some("closes the session"),
            KeyAction::Note(_) if session.phase != Phase::Closed => Some(label),
            KeyAction::Help => Some(label),
            _ => None,
        };
    }
    match binding.action {
        KeyAction::Advance if model.lesson.is_some() => {
            let runs = model.playback.as_ref().is_some_and(|playback| playback.playing);
            let begun = model.lesson.as_ref().is_some_and(|lesson| lesson.begun);
            Some(if runs {
                "pause"
            } else if begun {
                "go on"
            } else {
                "start"
            })
        }
        KeyAction::Advance => match session.phase {
            Phase::Ready => Some("start"),
            Phase::Running => Some("pause"),
            Phase::Paused => Some("resume"),
            Phase::Over(_) | Phase::Closed => None,
        },
        KeyAction::EndTrial => runs.then_some(label),
        KeyAction::StopRobot => (!session.robot.stopped).then_some(label),
        KeyAction::ResumeRobot => session.robot.stopped.then_some(label),
        KeyAction::Accept => can_accept(session).then_some(label),
        KeyAction::TakeBack => session.shown.is_some().then_some(label),
        KeyAction::Look(PanelKey::All) => {
            (model.alone.is_some() || model.events_back > 0 || model.timeline_back_s > 0).then_some(label)
        }
        _ => Some(label),
    }
}

/// Whether there is an offer that can be sent now.
fn can_accept(session: &Session) -> bool {
    offer_line::shown(session).is_some_and(|offer| offer.is_signal()) && may_send(session, Sender::Wizard).is_ok()
}
