//! `view(&Session, &Model, &mut Frame)`: draws the console from session and model, and changes neither.

use paint::Painter;
use ratatui::Frame;
use regions::{LEAST, PanelAreas};
use theme::TextRole;

use super::beliefs::beliefs;
use super::console_model::{ConsoleModel, Dialog};
use super::mouse::ClickTarget;
use super::text_columns::wrap;
use tomcom_session::Session;

pub mod belief_panel;
mod cards;
mod coding_panel;
pub mod comparison_panel;
pub mod dialog;
mod events;
pub mod footer;
pub mod gaze;
pub mod head;
pub mod help;
pub mod kitchen;
pub mod offers;
mod orders;
pub mod paint;
pub mod recordings_page;
pub mod regions;
pub mod sheet;
pub mod side_panels;
pub mod theme;
pub mod timeline;

pub fn view(session: &Session, model: &ConsoleModel, frame: &mut Frame) {
    draw(&mut Painter::new(frame.buffer_mut(), model.theme), session, model);
}

/// Cells of the console, as it is drawn now, that can be clicked.
pub fn click_targets(session: &Session, model: &ConsoleModel) -> Vec<ClickTarget> {
    paint::targets(model.theme, model.size, |brush| draw(brush, session, model))
}

fn draw(brush: &mut Painter, session: &Session, model: &ConsoleModel) {
    let area = *brush.buffer.area();
    if area.width < LEAST.0 || area.height < LEAST.1 {
        too_small(brush, session, model);
        return;
    }
    let regions = PanelAreas::showing((area.width, area.height), session, model);
    brush.focus = model.focus.map(|panel| regions.panel_area(panel)).unwrap_or_default();
    head::draw(brush, &regions, session, model);
    let believed = beliefs(session, model);
    offers::draw_offer(brush, &regions, session, model, &believed);
    kitchen::draw(brush, &regions, session, model, &believed);
    belief_panel::draw(brush, &regions, session, model, &believed);
    offers::draw_signals(brush, &regions, session, model);
    gaze::draw_map(brush, &regions, session, model);
    side_panels::draw_training(brush, &regions, model);
    side_panels::draw_display(brush, &regions, session, model);
    side_panels::draw_robot(brush, &regions, session, model);
    gaze::draw(brush, &regions, session, model);
    events::draw_presses(brush, &regions, session, model);
    events::draw(brush, &regions, session, model);
    timeline::draw(brush, &regions, session, model);
    comparison_panel::draw(brush, &regions, session, model);
    coding_panel::draw(brush, &regions, session, model);
    timeline::draw_position(brush, &regions, session, model);
    if regions.screen_size == regions::ScreenSize::Small && brush.focus.area() > 0 {
        // There are no frames on small terminals.
        let (focus, sign) = (brush.focus, brush.theme.signs().to);
        brush.text(focus.x, focus.y, 1, sign, TextRole::Strong);
    }
    footer::message(brush, &regions, session, model);
    cards::draw(brush, &regions, session, model);
    sheet::hide_probe(brush, regions.middle(), session, model);
    sheet::draw(brush, area, session, model);
    dialog::draw(brush, area, &regions, session, model);
    footer::draw(brush, &regions, session, model);
}

fn too_small(brush: &mut Painter, session: &Session, model: &ConsoleModel) {
    let area = *brush.buffer.area();
    let need =
        format!("terminal {}x{} is too small: the console needs {}x{}", area.width, area.height, LEAST.0, LEAST.1);
    brush.text(0, 0, area.width, &need, TextRole::Text);
    let stop = match session.robot.stopped {
        true => session.robot.safety_mode().name(),
        false => "the space bar stops the robot",
    };
    brush.text(0, 1, area.width, stop, TextRole::Alarm);
    let question = match &model.dialog {
        Some(Dialog::Quit) => "Quit tomcom? y or the same key again: yes; any other key: no",
        Some(Dialog::EndTrial) => "End the trial? y or the same key again: yes; any other key: no",
        Some(Dialog::EndTutorial) => "End the tutorial? y: yes; any other key: no",
        Some(Dialog::Help(_)) => "The terminal is too small for the help; any key closes it",
        Some(Dialog::Pick(_) | Dialog::Palette(_)) => "The terminal is too small for the list; esc closes it",
        Some(Dialog::Send(_)) => "Send the clicked signal? enter sends, esc cancels",
        Some(Dialog::Preflight) => "The terminal is too small for the preflight checks; esc closes them",
        Some(Dialog::Calibration) if session.is_calibrating() => "Gaze accuracy check is running; esc ends it",
        Some(Dialog::Calibration) => {
            "Gaze accuracy check: o offset subtracted, u without correction, enter accepts, r repeats, esc cancels"
        }
        Some(Dialog::Note(_)) => "Note: enter saves it, esc cancels",
        Some(Dialog::Reason(..)) => "Words beside the reason: enter gives it, esc goes back",
        Some(Dialog::Answer(_)) => "Answer: enter saves it, esc cancels",
        Some(Dialog::Details(..)) => "The terminal is too small for the details; any key closes them",
        Some(Dialog::Report(_)) => "The terminal is too small for the training report; enter continues",
        None => return,
    };
    for (row, line) in wrap(question, area.width).iter().enumerate() {
        brush.text(0, 2 + row as u16, area.width, line, TextRole::Strong);
    }
}
