//! Sheets around a trial: instruction, questionnaire, debriefing, and questions before a recording.

use crossterm::event::KeyCode;
use ratatui::Frame;
use ratatui::layout::Rect;

use super::paint::{KeyHint, Painter, width, wrap};
use super::popup::open;
use super::probe_sheet;
use super::theme::{TextRole, Theme};
use crate::console::chord::KeyChord;
use crate::console::console_model::ConsoleModel;
use crate::console::display_status::DisplayHealth;
use crate::console::form::{SheetContent, WAIVERS, sheet};
use crate::console::question::QuestionPage;
use crate::session::Session;
use crate::session::answer_value::AnswerValue;
use crate::session::plan::{ItemForm, Questionnaire, SLIDER_END, Scale, Tutorial, TutorialStepKind};
use crate::session::protocol::{ItemAnswer, Protocol};

/// Largest line width, for readability.
const WIDEST: u16 = 84;

/// Drawing context of a sheet.
pub(super) struct Pen<'a, 'b> {
    brush: &'a mut Painter<'b>,
    with_keys: bool,
}

/// A text of a line with its indent and style.
type PagePart = (u16, String, TextRole);

/// Lines of a sheet.
#[derive(Default)]
pub(super) struct Page {
    columns: u16,
    lines: Vec<Vec<PagePart>>,
    /// Index of the line that must be visible.
    focus: usize,
    /// Lines that can be clicked, each with its key.
    keys: Vec<(usize, KeyChord)>,
}

impl Page {
    /// An empty page for a screen.
    pub(super) fn new(screen: Rect) -> Page {
        Page { columns: screen.width.saturating_sub(4).min(WIDEST).saturating_sub(4), ..Page::default() }
    }

    /// Width of its text.
    pub(super) fn columns(&self) -> u16 {
        self.columns
    }

    /// Adds a text, in as many lines as it needs.
    pub(super) fn text(&mut self, indent: u16, text: &str, role: TextRole) {
        let lines = wrap(text, self.columns.saturating_sub(indent));
        self.lines.extend(lines.into_iter().map(|line| vec![(indent, line, role)]));
    }

    /// Adds a line of texts in columns of this width.
    pub(super) fn cells(&mut self, width: u16, cells: Vec<(&str, TextRole)>) {
        let part = |(index, (text, role)): (usize, (&str, TextRole))| (index as u16 * width, text.to_string(), role);
        self.lines.push(cells.into_iter().enumerate().map(part).collect());
    }

    /// The next line must be visible, or the last where none follows.
    pub(super) fn focus_here(&mut self) {
        self.focus = self.lines.len();
    }

    /// Adds a text with a mark before its first line.
    fn marked(&mut self, mark: &str, text: &str, role: TextRole) {
        let first = self.lines.len();
        self.text(width(mark) + 1, text, role);
        if let Some([(indent, text, _)]) = self.lines.get_mut(first).map(Vec::as_mut_slice) {
            (*indent, *text) = (0, format!("{mark} {text}"));
        }
    }

    /// Adds a choice with its digit, which can be clicked.
    fn choice(&mut self, index: usize, mark: &str, text: &str, role: TextRole) {
        let digit = char::from_digit(index as u32 + 1, 10).unwrap_or(' ');
        self.keys.push((self.lines.len(), KeyChord::char(digit)));
        self.marked(mark, text, role);
    }

    /// Adds an empty line.
    pub(super) fn space(&mut self) {
        self.lines.push(Vec::new());
    }

    /// Draws the visible part of the page around its focus, with key hints on the last line.
    pub(super) fn draw(self, pen: &mut Pen, screen: Rect, title: &str, remark: &str, keys: &[KeyHint]) {
        let rows = (self.lines.len() as u16 + 5).min(screen.height.saturating_sub(2));
        let brush = &mut *pen.brush;
        let inside = open(brush, screen, (self.columns + 4, rows), title, remark);
        let room = usize::from(inside.height.saturating_sub(3));
        let last = self.lines.len().saturating_sub(room);
        let from = (self.focus + 2).saturating_sub(room).min(last);
        for (row, line) in self.lines.iter().skip(from).take(room).enumerate() {
            let (x, y) = (inside.x + 1, inside.y + 1 + row as u16);
            let end = line.iter().fold(x, |_, (indent, text, role)| {
                let style = brush.style(*role);
                brush.text(x + indent, y, self.columns - indent, text, style)
            });
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
    // In a replay the keys have other meanings.
    let pen = &mut Pen { brush, with_keys: model.playback.is_none() };
    let sheet = sheet(session);
    if let Some(SheetContent::Probe(open)) = sheet {
        return probe_sheet::draw(pen, screen, open, session, model);
    }
    let (Some(sheet), Some((step, protocol))) = (sheet, session.step()) else { return };
    let where_ = format!("{}  {}", session.spec.participant.code, step.label());
    match sheet {
        SheetContent::Probe(_) => {}
        SheetContent::Steps { title, steps } => draw_steps(pen, screen, (title, &where_), steps, protocol, session),
        SheetContent::Tutorial(tutorial) => draw_tutorial(pen, screen, &where_, tutorial, (session, model)),
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
        None if session.step().is_some_and(|(step, _)| step.is_tutorial_alone()) => "leaves the tutorial".to_string(),
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

fn draw_tutorial(
    pen: &mut Pen,
    screen: Rect,
    where_: &str,
    tutorial: &Tutorial,
    (session, model): (&Session, &ConsoleModel),
) {
    let mut page = Page::new(screen);
    let Some((_, state)) = session.tutorial() else { return };
    if let Some(address) = model.display.as_ref().and_then(DisplayHealth::to_open) {
        page.text(0, &format!("no page is connected: {address}"), TextRole::Alarm);
    }
    for (index, step) in tutorial.steps.iter().enumerate() {
        let is_shown = index == state.step && !state.is_over;
        let role = match (is_shown, state.done.get(index)) {
            (true, _) => TextRole::Strong,
            (false, Some(true)) => TextRole::Quiet,
            (false, _) => TextRole::Text,
        };
        if is_shown {
            page.focus = page.lines.len();
        }
        let mark = if state.done.get(index) == Some(&true) { "[x]" } else { "[ ]" };
        let wrong = state.wrong_answers.get(index).copied().unwrap_or(0);
        let more = match step.kind {
            TutorialStepKind::Press | TutorialStepKind::Order if is_shown => {
                format!(" ({} of {} presses)", state.presses, step.presses.len())
            }
            TutorialStepKind::Question if wrong > 0 => format!(" (wrong answers: {wrong})"),
            _ => String::new(),
        };
        page.marked(mark, &format!("{}{more}", step.title), role);
    }
    let on = onward(session);
    let over = [("enter", on.as_str(), plain(KeyCode::Enter))];
    let skip = ("0", "skips the rest", Some(KeyChord::char('0')));
    let (back, next) =
        (("\u{2190}", "back", plain(KeyCode::Left)), ("\u{2192}", "turns the page", plain(KeyCode::Right)));
    let title = "Tutorial of the participant";
    let open = [next, back, skip];
    page.draw(pen, screen, title, where_, if state.is_over { &over } else { &open });
}

/// The key of a hint that can be clicked.
pub(super) fn plain(code: KeyCode) -> Option<KeyChord> {
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
        page.text(0, &format!("{} of {items}", protocol.item + 1), TextRole::Quiet);
        page.space();
        page.text(0, &item.text, TextRole::Strong);
        page.space();
        let given = protocol.answers.get(protocol.item).and_then(Option::as_ref);
        let (keys, does) = match questionnaire.form(protocol.item) {
            Some(form) => item_form(&mut page, &form, given.and_then(ItemAnswer::value)),
            None => (String::new(), "answer"),
        };
        if given == Some(&ItemAnswer::Skipped) {
            page.space();
            page.text(0, "no answer", TextRole::Strong);
        }
        let skip = match questionnaire.form(protocol.item) {
            Some(ItemForm::Scale(_) | ItemForm::Choice { .. }) => ("0", "no answer", plain(KeyCode::Char('0'))),
            _ => ("del", "no answer", plain(KeyCode::Delete)),
        };
        let keys = [
            (keys.as_str(), does, None),
            skip,
            ("enter", "next item", plain(KeyCode::Enter)),
            ("left/right", "go between items", None),
        ];
        return page.draw(pen, screen, &questionnaire.title, where_, &keys);
    }
    for (index, item) in questionnaire.items.iter().enumerate() {
        let form = questionnaire.form(index);
        let words = |value| form.map_or_else(String::new, |form| form.words(value));
        let answer = match protocol.answers.get(index).and_then(Option::as_ref) {
            Some(ItemAnswer::Given(value)) => words(value),
            Some(ItemAnswer::Skipped) => "-".to_string(),
            None => "?".to_string(),
        };
        // What is longer than a number stands below its item.
        if width(&answer) <= 3 {
            page.marked(&format!("{answer:>3}"), &item.text, TextRole::Text);
        } else {
            page.marked("   ", &item.text, TextRole::Text);
            page.text(6, &answer, TextRole::Strong);
        }
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

/// Draws how an item is answered, with the given answer; returns the keys that answer it, and what they do.
fn item_form(page: &mut Page, form: &ItemForm, given: Option<&AnswerValue>) -> (String, &'static str) {
    match form {
        ItemForm::Scale(of) => {
            scale(page, of, given);
            (format!("1-{}", of.points), "answer")
        }
        ItemForm::Choice { options, several } => {
            let chosen = given.map_or(&[][..], AnswerValue::options);
            for (index, option) in options.iter().enumerate() {
                let is_chosen = chosen.contains(&option.id);
                let mark = if is_chosen { format!("[{}]", index + 1) } else { format!(" {} ", index + 1) };
                page.choice(index, &mark, &option.text, if is_chosen { TextRole::Strong } else { TextRole::Text });
            }
            (format!("1-{}", options.len()), if *several { "choose any" } else { "choose" })
        }
        ItemForm::Number { range: [least, most], unit } => {
            let unit = if unit.is_empty() { String::new() } else { format!(" {unit}") };
            page.text(0, &format!("{least} to {most}{unit}"), TextRole::Quiet);
            typed(page, form, given);
            ("0-9".to_string(), "type the number")
        }
        ItemForm::Text { length } => {
            page.text(0, &format!("words, at most {length} characters"), TextRole::Quiet);
            typed(page, form, given);
            ("letters".to_string(), "type the answer")
        }
        ItemForm::Slider { low, high, step } => {
            let by = if *step > 1 { format!(", in steps of {step}") } else { String::new() };
            page.text(0, &format!("0 {low}   to   {SLIDER_END} {high}{by}"), TextRole::Quiet);
            typed(page, form, given);
            ("0-9".to_string(), "type the position")
        }
    }
}

/// Adds the answer that was typed, if one was.
fn typed(page: &mut Page, form: &ItemForm, given: Option<&AnswerValue>) {
    page.space();
    page.text(0, &given.map_or_else(|| "_".to_string(), |given| form.words(given)), TextRole::Strong);
}

/// Draws the scale with the given answer marked. Its anchors stand under the first and the last point.
fn scale(page: &mut Page, of: &Scale, given: Option<&AnswerValue>) {
    let point = |point: u8| match given == Some(&AnswerValue::from(point)) {
        true => format!("[{point}]"),
        false => format!(" {point} "),
    };
    let points: Vec<String> = (1..=of.points).map(point).collect();
    let line = points.join("   ");
    page.lines.push(vec![(0, line.clone(), TextRole::Strong)]);
    let gap = usize::from(width(&line).saturating_sub(width(&of.low) + width(&of.high)).max(3));
    page.lines.push(vec![(0, format!("{}{}{}", of.low, " ".repeat(gap), of.high), TextRole::Quiet)]);
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
