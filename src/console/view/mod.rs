//! `view(&Session, &Model, &mut Frame)`: reads, draws, and changes nothing.

pub mod belief_panel;
mod cards;
mod coding_panel;
pub mod comparison_panel;
pub mod dialog;
pub mod events;
pub mod footer;
pub mod gaze;
mod gaze_targets;
pub mod hands;
pub mod head;
pub mod kitchen;
pub mod lesson;
pub mod offer_line;
pub mod paint;
pub mod picker;
mod popup;
pub mod recommendation_panel;
pub mod recordings_page;
pub mod regions;
pub mod robot_panel;
mod scrub;
pub mod sheet;
pub mod shown;
pub mod theme;
pub mod timeline;

use ratatui::Frame;

use super::console_model::{ConsoleModel, Dialog};
use crate::session::Session;
use paint::Painter;
use regions::{LEAST, Regions};
use theme::TextRole;

/// Draws the console.
pub fn view(session: &Session, model: &ConsoleModel, frame: &mut Frame) {
    let area = frame.area();
    let mut brush = Painter { buffer: frame.buffer_mut(), theme: model.theme };
    if area.width < LEAST.0 || area.height < LEAST.1 {
        too_small(&mut brush, session, model);
        return;
    }
    let regions = Regions::showing((area.width, area.height), session, model);
    head::draw(&mut brush, &regions, session, model);
    offer_line::draw(&mut brush, &regions, session, model);
    kitchen::draw(&mut brush, &regions, session, model);
    belief_panel::draw(&mut brush, &regions, session, model);
    recommendation_panel::draw(&mut brush, &regions, session, model);
    gaze::draw_map(&mut brush, &regions, session, model);
    lesson::draw(&mut brush, &regions, model);
    shown::draw(&mut brush, &regions, session, model);
    robot_panel::draw(&mut brush, &regions, session, model);
    gaze::draw(&mut brush, &regions, session, model);
    events::draw(&mut brush, &regions, session, model);
    timeline::draw(&mut brush, &regions, session, model);
    comparison_panel::draw(&mut brush, &regions, session, model);
    coding_panel::draw(&mut brush, &regions, session, model);
    scrub::draw(&mut brush, &regions, session, model);
    footer::draw(&mut brush, &regions, session, model);
    cards::draw(&mut brush, &regions, session, model);
    sheet::draw(&mut brush, area, session, model);
    dialog::draw(&mut brush, area, session, model);
}

fn too_small(brush: &mut Painter, session: &Session, model: &ConsoleModel) {
    let area = *brush.buffer.area();
    let (alarm, text) = (brush.style(TextRole::Alarm), brush.style(TextRole::Text));
    let need = format!("{}x{} is too small: the console needs {}x{}", area.width, area.height, LEAST.0, LEAST.1);
    brush.text(0, 0, area.width, &need, text);
    let stop = if session.robot.stopped { "ROBOT STOPPED" } else { "the space bar stops the robot" };
    brush.text(0, 1, area.width, stop, alarm);
    let question = match &model.dialog {
        Some(Dialog::Quit) => "Quit tomcom? y yes, any other key no",
        Some(Dialog::EndTrial) => "End the trial? y yes, any other key no",
        Some(Dialog::Help) => "The help needs more room; any key closes it",
        Some(Dialog::Pick(_)) => "The list needs more room; esc leaves it",
        Some(Dialog::Preflight) => "Not all is ok for the trial; more room shows what; esc leaves",
        Some(Dialog::Calibration) if session.is_calibrating() => "The gaze is being checked; esc ends the check",
        Some(Dialog::Calibration) => {
            "The check of the gaze: enter does what is marked, o offset off, u as it is, r repeats, esc leaves"
        }
        Some(Dialog::Note(_)) => "A note: enter keeps it, esc leaves",
        Some(Dialog::Difference(_)) => "What each knew needs more room; any key closes it",
        Some(Dialog::Report(_)) => "What came of the training needs more room; enter goes on",
        None => return,
    };
    let strong = brush.style(TextRole::Strong);
    for (row, line) in paint::wrap(question, area.width).iter().enumerate() {
        brush.text(0, 2 + row as u16, area.width, line, strong);
    }
}
