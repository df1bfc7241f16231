//! Position in a recording: a bar over the whole length, with the time reached and the total time on the trial's clock,
//! as in the head line.

use ratatui::layout::Rect;

use super::paint::Painter;
use super::regions::PanelAreas;
use super::theme::TextRole;
use crate::console::click::ClickAction;
use crate::console::console_model::ConsoleModel;
use crate::console::text_columns::width;
use tomcom_core::base::time::SessionTime;
use tomcom_session::{Session, TrialPhase};

/// Words before the times while the trial has not started: the longest of all phases.
const BEFORE: &str = " before the trial, ";

/// Draws the bar of the position in the recording.
pub fn draw(brush: &mut Painter, regions: &PanelAreas, session: &Session, model: &ConsoleModel) {
    let (area, Some(playback)) = (regions.scrub, &model.playback) else { return };
    if area.area() == 0 {
        return;
    }
    let clock = session.trial_clock(model.now);
    let part = match session.phase {
        TrialPhase::Ready => BEFORE,
        TrialPhase::Over(_) | TrialPhase::Closed => " after the trial, ",
        TrialPhase::Running | TrialPhase::Paused => " ",
    };
    let times = format!("{clock} of {} ", playback.trial_length.max(clock));
    let end = format!("{part}{times}");
    let quiet = brush.style(TextRole::Quiet);
    brush.text(area.x, area.y, area.width, " recording ", quiet);
    brush.text_right(area.right(), area.y, area.width, &end, quiet);
    let x = area.x + 11;
    // The bar has one length in all phases, so that a place on it always means the same time.
    let columns = area.right().saturating_sub(x + width(BEFORE) + width(&times) + 1);
    let share = session.time.as_secs_f64() / playback.length.as_secs_f64().max(1e-3);
    let line = brush.theme.signs().frame[4].repeat(usize::from(columns));
    let (thin, strong) = (brush.style(TextRole::Frame), brush.style(TextRole::Strong));
    brush.text(x, area.y, columns, &line, thin);
    let here = (share.clamp(0.0, 1.0) * f64::from(columns.saturating_sub(1))) as u16;
    brush.text(x, area.y, here, &brush.theme.signs().frame[4].repeat(usize::from(here)), strong);
    let sign = brush.theme.signs().recording;
    brush.text(x + here, area.y, 1, sign, strong);
    if model.lesson.is_some() {
        return;
    }
    let length_s = playback.length.max(session.time).as_secs_f64();
    for column in 0..columns {
        let share = f64::from(column) / f64::from(columns.saturating_sub(1).max(1));
        let time = SessionTime::from_secs_f64(length_s * share);
        brush.target(Rect { x: x + column, width: 1, ..area }, ClickAction::Seek(time));
    }
}
