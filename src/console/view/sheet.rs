//! Sheets around a trial: instruction, questionnaire, debriefing, and questions before a recording.

use crossterm::event::KeyCode;
use ratatui::Frame;
use ratatui::layout::Rect;

use super::paint::{KeyHint, Painter, width, wrap};
use super::popup::open;
use super::theme::{TextRole, Theme};
use crate::console::chord::KeyChord;
use crate::console::console_model::ConsoleModel;
use crate::console::form::{SheetContent, WAIVERS, sheet};
use crate::console::question::QuestionPage;
use crate::session::Session;
use crate::session::plan::Questionnaire;
use crate::session::protocol::{ItemAnswer, Protocol};

/// Largest line width, for readability.
const WIDEST: u16 = 84;

/// Drawing context of a sheet.
struct Pen<'a, 'b> {
    brush: &'a mut Painter<'b>,
    with_keys: bool,
}

/// Lines of a sheet with indent and style.
#[derive(Default)]
struct Page {
    columns: u16,
    lines: Vec<(u16, String, TextRole)>,
    /// Index of the line that must be visible.
    focus: usize,
    /// Lines that can be clicked, each with its key.
    keys: Vec<(usize, KeyChord)>,
}

impl Page {
    fn new(screen: Rect) -> Page {
        Page { columns: screen.width.saturating_sub(4).min(WIDEST).saturating_sub(4), ..Page::default() }
    }

    fn text(&mut self, indent: u16, text: &str, role: TextRole) {
        let lines = wrap(text, self.columns.saturating_sub(indent));
        self.lines.extend(lines.into_iter().map(|line| (indent, line, role)));
    }

    /// Adds a text with a mark before its first line.
    fn marked(&mut self, mark: &str, text: &str, role: TextRole) {
        let first = self.lines.len();
        self.text(width(mark) + 1, text, role);
        if let Some(line) = self.lines.get_mut(first) {
            *line = (0, format!("{mark} {}", line.1), role);
        }
    }

    /// Adds a choice with its digit, which can be clicked.
    fn choice(&mut self, index: usize, mark: &str, text: &str, role: TextRole) {
        let digit = char::from_digit(index as u32 + 1, 10).unwrap_or(' ');
        self.keys.push((self.lines.len(), KeyChord::char(digit)));
        self.marked(mark, text, role);
    }

    fn space(&mut self) {
        self.lines.push((0, String::new(), TextRole::Text));
    }

    /// Draws the visible part of the page around its focus, with key hints on the last line.
    fn draw(self, pen: &mut Pen, screen: Rect, title: &str, remark: &str, keys: &[KeyHint]) {
        let rows = (self.lines.len() as u16 + 5).min(screen.height.saturating_sub(2));
        let brush = &mut *pen.brush;
        let inside = open(brush, screen, (self.columns + 4, rows), title, remark);
        let room = usize::from(inside.height.saturating_sub(3));
        let last = self.lines.len().saturating_sub(room);
        let from = (self.focus + 2).saturating_sub(room).min(last);
        for (row, (indent, line, role)) in self.lines.iter().skip(from).take(room).enumerate() {
            let style = brush.style(*role);
            let (x, y) = (inside.x + 1, inside.y + 1 + row as u16);
            let end = brush.text(x + indent, y, self.columns - indent, line, style);
            let key = self.keys.iter().find(|(line, _)| *line == from + row);
            if let Some((_, chord)) = key.filter(|_| pen.with_keys) {
                brush.key_target(x, y, end, *chord);
            }
        }
        if pen.with_keys {
            brush.hints(inside.x + 1, inside.bottom().saturating_sub(1), inside.width - 1, keys);
        }
    }
}

/// Draws the sheet of the running phase, if it has one.
pub fn draw(brush: &mut Painter, screen: Rect, session: &Session, model: &ConsoleModel) {
    let (Some(sheet), Some((step, protocol))) = (sheet(session), session.step()) else { return };
    let where_ = format!("{}  {}", session.spec.participant.code, step.label());
    // In a replay the keys have other meanings.
    let pen = &mut Pen { brush, with_keys: model.playback.is_none() };
    match sheet {
        SheetContent::Steps { title, steps } => draw_steps(pen, screen, (title, &where_), steps, protocol, session),
        SheetContent::Questions(questionnaire) => {
            draw_questions(pen, screen, &where_, questionnaire, protocol, session)
        }
        SheetContent::Failed => draw_failed(pen, screen, &where_, session, model.waiver),
    }
}

/// Label of the advance key: the next phase.
fn onward(session: &Session) -> String {
    match session.next_phase() {
        Some(phase) => format!("on to the {}", phase.name()),
        None => "on to the next recording".to_string(),
    }
}

fn draw_steps(
    pen: &mut Pen,
    screen: Rect,
    heads: (&str, &str),
    steps: &[String],
    protocol: &Protocol,
    session: &Session,
) {
    let mut page = Page::new(screen);
    let open = protocol.ticks.iter().position(|done| !done);
    for (index, step) in steps.iter().enumerate() {
        let is_done = protocol.ticks.get(index) == Some(&true);
        let role = if open == Some(index) {
            TextRole::Strong
        } else if is_done {
            TextRole::Quiet
        } else {
            TextRole::Text
        };
        if open == Some(index) {
            page.focus = page.lines.len();
        }
        page.marked(if is_done { "[x]" } else { "[ ]" }, step, role);
    }
    if open.is_none() {
        page.focus = page.lines.len();
    }
    let on = if open.is_some() { "this step is done".to_string() } else { onward(session) };
    let undo = ("bksp", "takes the last tick back", plain(KeyCode::Backspace));
    let hints = [("enter", on.as_str(), plain(KeyCode::Enter)), undo];
    let has_ticks = protocol.ticks.contains(&true);
    page.draw(pen, screen, heads.0, heads.1, if has_ticks { &hints } else { &hints[..1] });
}

/// The key of a hint that can be clicked.
fn plain(code: KeyCode) -> Option<KeyChord> {
    Some(KeyChord::plain(code))
}

fn draw_questions(
    pen: &mut Pen,
    screen: Rect,
    where_: &str,
    questionnaire: &Questionnaire,
    protocol: &Protocol,
    session: &Session,
) {
    let items = questionnaire.items.len();
    let mut page = Page::new(screen);
    if let Some(item) = questionnaire.items.get(protocol.item) {
        let given = protocol.answers.get(protocol.item).copied().flatten();
        page.text(0, &format!("{} of {items}", protocol.item + 1), TextRole::Quiet);
        page.space();
        page.text(0, &item.text, TextRole::Strong);
        page.space();
        scale(&mut page, questionnaire, given);
        let points = format!("1-{}", questionnaire.scale.points);
        let keys = [
            (points.as_str(), "answer", None),
            ("0", "no answer", plain(KeyCode::Char('0'))),
            ("enter", "next item", plain(KeyCode::Enter)),
            ("left/right", "go between items", None),
        ];
        return page.draw(pen, screen, &questionnaire.title, where_, &keys);
    }
    for (item, answer) in questionnaire.items.iter().zip(&protocol.answers) {
        let answer = match answer {
            Some(ItemAnswer::Rated(points)) => points.to_string(),
            Some(ItemAnswer::Skipped) => "-".to_string(),
            None => "?".to_string(),
        };
        page.marked(&format!("{answer:>3}"), &item.text, TextRole::Text);
    }
    page.focus = page.lines.len();
    let on = match (protocol.confirmed, protocol.open_item()) {
        (true, _) => onward(session),
        (false, Some(_)) => "to the item without an answer".to_string(),
        (false, None) => "confirm the answers".to_string(),
    };
    let hints = [("enter", on.as_str(), plain(KeyCode::Enter)), ("left", "back", plain(KeyCode::Left))];
    let hints = if protocol.confirmed { &hints[..1] } else { &hints };
    page.draw(pen, screen, &questionnaire.title, where_, hints);
}

/// Draws the scale with its end labels and the given answer marked.
fn scale(page: &mut Page, questionnaire: &Questionnaire, given: Option<ItemAnswer>) {
    let point = |point: u8| match given == Some(ItemAnswer::Rated(point)) {
        true => format!("[{point}]"),
        false => format!(" {point} "),
    };
    let points: Vec<String> = (1..=questionnaire.scale.points).map(point).collect();
    let line = points.join("   ");
    let (low, high) = (&questionnaire.scale.low, &questionnaire.scale.high);
    page.lines.push((0, line.clone(), TextRole::Strong));
    let gap = usize::from(width(&line).saturating_sub(width(low) + width(high)).max(3));
    page.lines.push((0, format!("{low}{}{high}", " ".repeat(gap)), TextRole::Quiet));
    if given == Some(ItemAnswer::Skipped) {
        page.space();
        page.text(0, "no answer", TextRole::Strong);
    }
}

fn draw_failed(pen: &mut Pen, screen: Rect, where_: &str, session: &Session, waiver: Option<usize>) {
    let Some((step, protocol)) = session.step() else { return };
    let (Some(criterion), Some(practice)) = (step.criterion, &protocol.practice) else { return };
    let mut page = Page::new(screen);
    let rate = criterion.error_rate.map_or(String::new(), |rate| format!(", at most {:.0} % errors", 100.0 * rate));
    page.text(0, &format!("Asked for: {} orders served{rate}.", criterion.orders), TextRole::Text);
    let share = 100.0 * f64::from(practice.errors) / f64::from(practice.presses.max(1));
    let (orders, presses, errors) = (practice.orders, practice.presses, practice.errors);
    let found = format!("Found: {orders} served, {errors} errors in {presses} presses ({share:.0} %).");
    page.text(0, &found, TextRole::Strong);
    page.space();
    page.text(0, "To go on to the first trial all the same, say why:", TextRole::Text);
    for (index, reason) in WAIVERS.iter().enumerate() {
        let is_chosen = waiver == Some(index);
        let mark = if is_chosen { format!(" [{}]", index + 1) } else { format!("  {} ", index + 1) };
        page.choice(index, &mark, reason, if is_chosen { TextRole::Strong } else { TextRole::Text });
    }
    let waivers = format!("1-{}", WAIVERS.len());
    let hints = [
        ("enter", if waiver.is_some() { "go on for this reason" } else { "practise again" }, plain(KeyCode::Enter)),
        (waivers.as_str(), "choose a reason", None),
        ("left", "choose none", plain(KeyCode::Left)),
    ];
    let hints = if waiver.is_some() { &hints } else { &hints[..2] };
    page.draw(pen, screen, "The criterion is not met", where_, hints);
}

/// Draws a question before a recording, on an otherwise empty screen.
pub fn draw_question(question: &QuestionPage, theme: Theme, frame: &mut Frame) {
    let screen = frame.area();
    let mut brush = Painter::new(frame.buffer_mut(), theme);
    let mut page = Page::new(screen);
    for paragraph in &question.text {
        page.text(0, paragraph, TextRole::Text);
        page.space();
    }
    for (index, answer) in question.answers.iter().enumerate() {
        page.marked(&format!("  {}", index + 1), answer, TextRole::Strong);
    }
    page.focus = page.lines.len();
    let keys = [("esc", "leave: nothing is recorded", plain(KeyCode::Esc))];
    page.draw(&mut Pen { brush: &mut brush, with_keys: true }, screen, &question.title, "", &keys);
}
