//! A rater's panels: the codebook, which is always visible, and the list of errors with their codes.

use ratatui::layout::Rect;

use super::paint::Painter;
use super::regions::{PanelAreas, ScreenSize, top};
use super::theme::TextRole;
use crate::console::coding::{self, CodebookEntry, CodingRaters, ErrorListLayout, ROOMY_LIST, RaterSession};
use crate::console::console_model::ConsoleModel;
use crate::console::mouse::ClickAction;
use crate::console::text_columns::{fit, width, wrap};
use tomcom_core::measures::raters::ErrorCauseCode;
use tomcom_session::Session;
use tomcom_session::error_list::ListedError;
use tomcom_session::history::wording;

/// Columns of the number of an error in a rater's list, and of the error's time.
const NUMBER: u16 = 4;
const CLOCK: u16 = 6;
/// Least width, in columns, of an error list that shows codes in full.
const WIDE: u16 = 62;
/// Least columns of a code.
const LEAST_CODE: u16 = 4;
/// Columns of the bar for the coding progress.
const BAR: u16 = 16;

/// Draws the codebook and the list of errors, while a rater codes errors.
pub fn draw(brush: &mut Painter, regions: &PanelAreas, session: &Session, model: &ConsoleModel) {
    let Some(coding) = &model.coding else { return };
    let events = model.playback.as_ref().map_or(0, |playback| playback.event);
    let is_panel = regions.screen_size != ScreenSize::Small && model.alone.is_none();
    draw_codebook(brush, regions.codebook, session, model, is_panel);
    draw_errors(brush, regions, coding, events);
}

/// Draws the codebook as lines across the screen, or as a panel in a column beside the kitchen.
fn draw_codebook(brush: &mut Painter, area: Rect, session: &Session, model: &ConsoleModel, is_panel: bool) {
    if area.area() == 0 {
        return;
    }
    let inside = match is_panel {
        true => brush.panel(area, "Codebook", "why did the error happen?"),
        false => area,
    };
    let (left, columns) = (inside.x + 1, inside.width.saturating_sub(2));
    let lines = match is_panel {
        // No code is left out: where there is no room, the definitions are.
        true if coding::full(&model.keys, &session.kitchen, columns).len() <= usize::from(inside.height) => {
            coding::full(&model.keys, &session.kitchen, columns)
        }
        _ => coding::compact(&model.keys, &session.kitchen, columns),
    };
    for (row, line) in lines.iter().enumerate().take(usize::from(inside.height)) {
        for (before, CodebookEntry { key, words }) in line {
            let x = left + before;
            let y = inside.y + row as u16;
            let name = key.map_or(String::new(), |key| format!("{key} "));
            let role = if key.is_none() { TextRole::Quiet } else { TextRole::Text };
            let parts = [(name.as_str(), TextRole::Signal), (words.as_str(), role)];
            let end = brush.parts(x, y, inside.right().saturating_sub(x), &parts);
            if let Some(key) = key {
                brush.key_target(x, y, end, *key);
            }
        }
    }
}

fn draw_errors(brush: &mut Painter, regions: &PanelAreas, coding: &RaterSession, events: usize) {
    let area = regions.errors;
    if area.area() == 0 {
        return;
    }
    let list = ErrorListLayout::new(regions, coding, events);
    match list.head.y > area.y {
        true => {
            brush.panel(area, &coding.progress(), "");
            draw_head(brush, list.head, area, coding, events);
        }
        false => draw_lines(brush, list.head, coding, events),
    }
    let at = coding.at(events);
    // The presses come whole; the codes get what is left, since the line above the list has the present one in full.
    let widest = |words: &dyn Fn(&ListedError) -> u16| coding.errors.iter().map(words).max().unwrap_or(0);
    let codes = widest(&|error| width(&code_words(coding, error, area.width)));
    let presses = widest(&|error| width(&press_words(brush, error, area.width)));
    let room = area.width.saturating_sub(NUMBER + CLOCK + 5);
    let codes_columns = codes.min(room.saturating_sub(presses).max(LEAST_CODE));
    for (row, index) in (list.first..coding.errors.len()).enumerate().take(usize::from(list.rows.height)) {
        let error = &coding.errors[index];
        let line = Rect { y: list.rows.y + row as u16, height: 1, ..list.rows };
        draw_row(brush, line, codes_columns, coding, error, (coding.chosen == Some(index), at == Some(index)));
        brush.target(line, ClickAction::Error(index));
    }
}

/// Share of errors that have a rater's code, from 0 to 1.
fn share(coding: &RaterSession) -> f64 {
    coding.coded() as f64 / coding.errors.len().max(1) as f64
}

/// Draws one line with the coding progress or the next step, and in the last line the codes that two raters gave alone.
fn draw_lines(brush: &mut Painter, head: Rect, coding: &RaterSession, events: usize) {
    let words = coding.next_step().unwrap_or_else(|| coding.progress());
    let (x, columns) = (head.x + 1, head.width.saturating_sub(1));
    let end = brush.text(x, head.y, columns, &format!("{}: {words}", coding.name()), TextRole::Strong);
    if end + BAR + 3 < head.right() {
        brush.bar(end + 2, head.y, BAR, share(coding), TextRole::Strong);
    }
    let own = coding.present(events).map(|error| coding.own(error)).unwrap_or_default();
    if !own.is_empty() {
        let words = format!("{:columns$}", own.join("   "), columns = usize::from(columns));
        brush.text(x, head.bottom().saturating_sub(1), columns, &words, TextRole::Text);
    }
}

/// Draws the progress bar, where the list has room, and below it the present error in words, or the next step.
fn draw_head(brush: &mut Painter, mut head: Rect, list: Rect, coding: &RaterSession, events: usize) {
    let (x, columns) = (head.x + 1, head.width.saturating_sub(2));
    if list.height >= ROOMY_LIST {
        brush.bar(x, head.y, columns, share(coding), TextRole::Strong);
        (_, head) = top(head, 1);
    }
    let mut lines: Vec<(String, TextRole)> = Vec::new();
    if let Some(next) = coding.next_step() {
        lines.extend(wrap(&next, columns).into_iter().map(|line| (line, TextRole::Strong)));
    } else if let Some(error) = coding.chosen.and_then(|chosen| coding.errors.get(chosen)).or(coding.present(events)) {
        let code = RaterSession::words(coding.code(error));
        let told = wrap(&format!("{} {}", error.error, reasoned(error)), columns);
        lines.extend(told.into_iter().map(|line| (line, TextRole::Strong)));
        match coding.party {
            CodingRaters::Rater(_) => lines.push((format!("  {code}"), TextRole::Text)),
            CodingRaters::Pair { .. } => {
                let own = coding.own(error);
                let beside = own.join("   ");
                let lines_of_own = if width(&beside) + 2 <= columns { vec![beside] } else { own };
                lines.extend(lines_of_own.into_iter().map(|own| (format!("  {own}"), TextRole::Text)));
            }
        }
        let shown = wrap(&format!("before: {}", error.shown), columns.saturating_sub(2));
        lines.extend(shown.into_iter().map(|line| (format!("  {line}"), TextRole::Quiet)));
    } else {
        lines.push(("enter goes to the human's first error".to_string(), TextRole::Quiet));
    }
    for (row, (line, role)) in lines.iter().enumerate().take(usize::from(head.height)) {
        brush.text(x, head.y + row as u16, columns, line, *role);
    }
}

/// Draws a row of the error list: number, time, press and codes; with a mark where the arrow keys have selected it, or the
/// replay stands at its error.
fn draw_row(
    brush: &mut Painter,
    line: Rect,
    code_columns: u16,
    coding: &RaterSession,
    error: &ListedError,
    (is_chosen, is_present): (bool, bool),
) {
    let signs = brush.theme.signs();
    let role = if is_chosen || is_present { TextRole::Strong } else { TextRole::Text };
    let sign = match (is_chosen, is_present) {
        (true, _) => signs.cursor,
        (false, true) => signs.to,
        (false, false) => " ",
    };
    brush.text(line.x, line.y, 1, sign, TextRole::Strong);
    let style = if is_chosen { brush.theme.badge(role) } else { brush.style(role) };
    let mut x = line.x + 1;
    brush.styled(x, line.y, NUMBER, &format!("{:>3} ", error.error), style);
    x += NUMBER;
    brush.text(x, line.y, CLOCK, &format!("{:>5}", error.clock()), TextRole::Quiet);
    x += CLOCK;
    let right = line.right().saturating_sub(1);
    let press_columns = right.saturating_sub(x + code_columns + 1);
    let whole = reasoned(error);
    let press = if width(&whole) <= press_columns {
        whole
    } else {
        fit(&press_words(brush, error, line.width), press_columns, signs.ellipsis)
    };
    brush.text(x, line.y, press_columns, &press, role);
    x += press_columns + 1;
    let words = code_words(coding, error, line.width);
    let role = if coding.code(error).is_some() { TextRole::Strong } else { TextRole::Quiet };
    let words = fit(&words, right.saturating_sub(x), signs.ellipsis);
    brush.text(x, line.y, right.saturating_sub(x), &words, role);
}

/// The press with the reason why it was an error: "take salmon: order 1 needs tuna".
fn reasoned(error: &ListedError) -> String {
    format!("{}: {}", error.words(), error.why)
}

/// The press in a list of this width; in a narrow one, a sign says that it had no effect.
fn press_words(brush: &Painter, error: &ListedError, columns: u16) -> String {
    match error.effective || columns >= WIDE {
        true => error.words(),
        false => format!("{} {}", error.button, brush.theme.signs().no_effect),
    }
}

/// An error's code in a list of this width; in a narrow one, of a false belief only the place.
fn code_words(coding: &RaterSession, error: &ListedError, columns: u16) -> String {
    let code = coding.code(error);
    match code.and_then(ErrorCauseCode::aspect).filter(|_| columns < WIDE) {
        Some(place) => wording::location(place),
        None => RaterSession::words(code),
    }
}
