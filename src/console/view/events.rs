//! List of events in words with their times on the trial's clock, newest first, shown on large terminals.

use super::paint::Painter;
use super::regions::PanelAreas;
use super::theme::TextRole;
use crate::console::console_model::ConsoleModel;
use tomcom_core::kitchen::Agent;
use tomcom_session::history::wording;
use tomcom_session::{Session, TimelineEvent};

/// Columns for the name of the agent; the longest is "assistant".
const WHO: u16 = 10;

/// Draws the list of events.
pub fn draw(brush: &mut Painter, regions: &PanelAreas, session: &Session, model: &ConsoleModel) {
    if regions.events.area() == 0 {
        return;
    }
    let remark = match model.events_back {
        0 => "newest event first".to_string(),
        back => format!("{back} newer events hidden"),
    };
    let inside = brush.panel(regions.events, "Events", &remark);
    let clock = session.trial_clock(model.now);
    let newest = session.timeline.iter().rev().skip(model.events_back);
    for (row, entry) in newest.take(usize::from(inside.height)).enumerate() {
        let y = inside.y + row as u16;
        let at = (clock - session.age(entry.time, model.now)).to_string();
        let (who, what) = wording::happening(&session.kitchen, &entry.what);
        let is_error = model.is_error(entry);
        let role = match &entry.what {
            TimelineEvent::Press { agent: Agent::Human, .. } => TextRole::Human,
            TimelineEvent::Press { agent: Agent::Robot, .. } => TextRole::Robot,
            TimelineEvent::Signal { .. } | TimelineEvent::SignalEnded(_) => TextRole::Signal,
            TimelineEvent::RobotStopped | TimelineEvent::ArmStopped { .. } => TextRole::Alarm,
            TimelineEvent::ArmTouched { .. } => TextRole::Robot,
            _ => TextRole::Strong,
        };
        let quiet = brush.style(TextRole::Quiet);
        brush.text_right(inside.x + 6, y, 6, &at, quiet);
        let x = inside.x + 7;
        let columns = inside.right().saturating_sub(x + WHO);
        brush.parts(x, y, WHO - 1, &[(who, role)]);
        let mark = if is_error { format!("{} ", brush.theme.signs().error) } else { String::new() };
        brush.parts(x + WHO, y, columns, &[(&mark, TextRole::Strong), (&what, TextRole::Text)]);
    }
}
