//! The wizard training's panel: the task, then feedback on signals, newest first.

use super::paint::Painter;
use super::regions::{PanelAreas, ScreenSize};
use super::theme::TextRole;
use crate::console::console_model::ConsoleModel;
use crate::console::lesson::{TrainingFeedback, TrainingPanel};
use crate::console::notice::NoticeLevel;
use crate::console::text_columns::wrap;

/// Columns for the clock time of a line of feedback.
const CLOCK: u16 = 6;

/// Draws the panel of a wizard training.
pub fn draw(brush: &mut Painter, regions: &PanelAreas, model: &ConsoleModel) {
    let area = regions.lesson;
    let Some(lesson) = model.lesson.as_ref().filter(|_| area.area() > 0) else { return };
    let inside = match regions.room {
        ScreenSize::Small => area,
        _ => brush.panel(area, "Training", &lesson.score),
    };
    let (x, columns) = (inside.x + 1, inside.width.saturating_sub(2));
    let mut y = inside.y;
    for (clock, text, role) in lines(lesson) {
        let indent = if clock.is_empty() { 0 } else { CLOCK };
        for (row, line) in wrap(&text, columns.saturating_sub(indent)).iter().enumerate() {
            if y >= inside.bottom() {
                return;
            }
            if row == 0 {
                let quiet = brush.style(TextRole::Quiet);
                brush.text(x, y, indent, &clock, quiet);
            }
            let style = brush.style(role);
            brush.text(x + indent, y, columns.saturating_sub(indent), line, style);
            y += 1;
        }
    }
}

/// Lines of the training panel, each with or without a time on the trial's clock.
fn lines(lesson: &TrainingPanel) -> Vec<(String, String, TextRole)> {
    if lesson.feedback.is_empty() {
        return lesson.task.iter().map(|text| (String::new(), text.clone(), TextRole::Text)).collect();
    }
    let newest = lesson.feedback.iter().rev().enumerate();
    let line = |(back, TrainingFeedback { clock, level, text }): (usize, &TrainingFeedback)| {
        let role = match (back, level) {
            (_, NoticeLevel::Refused | NoticeLevel::Alarm) => TextRole::Strong,
            (0, NoticeLevel::Done) => TextRole::Strong,
            (_, NoticeLevel::Done) => TextRole::Text,
        };
        (format!("{:>5}", clock.to_string()), text.clone(), role)
    };
    newest.map(line).collect()
}
