//! Sheets (forms at full size) around a trial: instruction, questionnaire, debriefing, freeze probes, and questions
//! before a recording.

use crossterm::event::KeyCode;
use ratatui::Frame;
use ratatui::layout::Rect;

use super::dialog::{blank, open};
use super::footer;
use super::paint::{KeyHint, Painter};
use super::theme::{TextRole, Theme};
use crate::console::beliefs::visibility;
use crate::console::chord::KeyChord;
use crate::console::console_model::ConsoleModel;
use crate::console::form::{FormContent, WAIVERS, debriefing_question, sheet};
use crate::console::key_action::{KeyAction, ManualAction};
use crate::console::lists::StartPrompt;
use crate::console::preflight::{ParticipantDisplayHealth, is_wanted};
use crate::console::probe_keys::{ProbeAnswerer, ProbeEntry, answerer, status};
use crate::console::text_columns::{width, wrap};
use tomcom_core::base::text::count;
use tomcom_devices::sight::{ProbeWording, probe_left, probe_wording};
use tomcom_session::plan::{AnswerFormat, Questionnaire, RatingScale, SLIDER_END, Tutorial, TutorialStepKind};
use tomcom_session::probes::{ProbeAnswer, ProbeQuestion, StartedProbe};
use tomcom_session::protocol::{ItemAnswer, StudyProtocolState};
use tomcom_session::questionnaire::AnswerValue;
use tomcom_session::settings::WizardVisibility;
use tomcom_session::wall_display::AnswerDevice;
use tomcom_session::{Session, TrialPhase};

/// Draws the sheet of the session's present phase, if that phase has one.
pub fn draw(brush: &mut Painter, screen: Rect, session: &Session, model: &ConsoleModel) {
    // In a replay, the sheet shows no keys, since keys have other meanings there.
    let pen = &mut Pen { brush, with_keys: model.playback.is_none() };
    let sheet = sheet(session);
    if let Some(FormContent::Probe(open)) = sheet {
        return draw_probe(pen, screen, open, session, model);
    }
    let (Some(sheet), Some((step, protocol))) = (sheet, session.step()) else { return };
    let where_ = format!("{}  {}", session.spec.participant.code, step.label());
    match sheet {
        FormContent::Probe(_) => {}
        FormContent::Steps { title, steps } => {
            draw_steps(pen, screen, (title, &where_), steps, protocol, (session, model))
        }
        FormContent::Tutorial(tutorial) => draw_tutorial(pen, screen, &where_, tutorial, (session, model)),
        FormContent::Questions(questionnaire) => {
            draw_questions(pen, screen, &where_, questionnaire, protocol, (session, model))
        }
        FormContent::Failed => draw_failed(pen, screen, &where_, session, model),
    }
}

/// Label of the key that leaves the sheet: the name of the next phase.
fn onward(session: &Session, model: &ConsoleModel) -> String {
    footer::onward(session, model).unwrap_or_default()
}

fn draw_steps(
    pen: &mut Pen,
    screen: Rect,
    heads: (&str, &str),
    steps: &[String],
    protocol: &StudyProtocolState,
    (session, model): (&Session, &ConsoleModel),
) {
    let mut page = Page::of_session(screen, session, model);
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
            page.focus_here();
        }
        page.marked(if is_done { "[x]" } else { "[ ]" }, step, role);
    }
    if open.is_none() {
        page.focus_here();
    }
    let on = if open.is_some() { "tick this step as done".to_string() } else { onward(session, model) };
    let mut hints = vec![("enter", on.as_str(), plain(KeyCode::Enter))];
    if protocol.ticks.contains(&true) {
        hints.push(("bksp", "untick the last step", plain(KeyCode::Backspace)));
    }
    if debriefing_question(session).is_some() {
        hints.push(("a-z", "answer in words", None));
    }
    page.draw(pen, screen, heads.0, heads.1, &hints);
}

fn draw_tutorial(
    pen: &mut Pen,
    screen: Rect,
    where_: &str,
    tutorial: &Tutorial,
    (session, model): (&Session, &ConsoleModel),
) {
    let mut page = Page::of_session(screen, session, model);
    let Some((_, state)) = session.tutorial() else { return };
    for (index, step) in tutorial.steps.iter().enumerate() {
        let is_shown = index == state.step && !state.is_over;
        let role = match (is_shown, state.done.get(index)) {
            (true, _) => TextRole::Strong,
            (false, Some(true)) => TextRole::Quiet,
            (false, _) => TextRole::Text,
        };
        if is_shown {
            page.focus_here();
        }
        let mark = if state.done.get(index) == Some(&true) { "[x]" } else { "[ ]" };
        let wrong = state.wrong_answers.get(index).copied().unwrap_or(0);
        let more = match step.kind {
            TutorialStepKind::Press | TutorialStepKind::Order if is_shown => {
                format!(" ({} of {} presses)", state.presses, step.presses.len())
            }
            TutorialStepKind::Question | TutorialStepKind::Probe if wrong > 0 => format!(" (wrong answers: {wrong})"),
            _ => String::new(),
        };
        page.marked(mark, &format!("{}{more}", step.title), role);
    }
    let on = onward(session, model);
    let over = [("enter", on.as_str(), plain(KeyCode::Enter))];
    let skip = ("0", "ends the tutorial", Some(KeyChord::char('0')));
    let (back, next) =
        (("\u{2190}", "previous page", plain(KeyCode::Left)), ("\u{2192}", "next page", plain(KeyCode::Right)));
    let title = "Tutorial of the participant";
    let open = [next, back, skip];
    page.draw(pen, screen, title, where_, if state.is_over { &over } else { &open });
}

fn draw_questions(
    pen: &mut Pen,
    screen: Rect,
    where_: &str,
    questionnaire: &Questionnaire,
    protocol: &StudyProtocolState,
    (session, model): (&Session, &ConsoleModel),
) {
    let items = questionnaire.items.len();
    let mut page = Page::of_session(screen, session, model);
    if let Some(item) = questionnaire.items.get(protocol.item) {
        page.text(0, &format!("item {} of {items}", protocol.item + 1), TextRole::Quiet);
        if is_wanted(session) && session.spec.display.questionnaire == AnswerDevice::Display {
            page.text(0, "The participant answers on the page. The keys answer here in their place.", TextRole::Quiet);
        }
        page.space();
        page.text(0, &item.text, TextRole::Strong);
        page.space();
        let chosen = model.item_choice.as_ref().filter(|choice| choice.item == item.id);
        let given = chosen.map(|choice| &choice.answer);
        let given = given.or(protocol.answers.get(protocol.item).and_then(Option::as_ref));
        let (keys, does) = match questionnaire.form(protocol.item) {
            Some(form) => item_form(&mut page, &form, given.and_then(ItemAnswer::value)),
            None => (String::new(), "answer"),
        };
        if given == Some(&ItemAnswer::Skipped) {
            page.space();
            page.text(0, "no answer", TextRole::Strong);
        }
        let skip = match questionnaire.form(protocol.item) {
            Some(AnswerFormat::Scale(_) | AnswerFormat::Choice { .. }) => ("0", "no answer", plain(KeyCode::Char('0'))),
            _ => ("del", "no answer", plain(KeyCode::Delete)),
        };
        let keys = [
            (keys.as_str(), does, None),
            skip,
            ("enter", "next item", plain(KeyCode::Enter)),
            ("arrows", "other item", None),
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
        // Answers of more than three columns stand below their item.
        if width(&answer) <= 3 {
            page.marked(&format!("{answer:>3}"), &item.text, TextRole::Text);
        } else {
            page.marked("   ", &item.text, TextRole::Text);
            page.text(6, &answer, TextRole::Strong);
        }
    }
    page.focus_here();
    let on = match (protocol.confirmed, protocol.open_item()) {
        (true, _) => onward(session, model),
        (false, Some(_)) => "go to the item without an answer".to_string(),
        (false, None) => "confirm the answers".to_string(),
    };
    let hints =
        [("enter", on.as_str(), plain(KeyCode::Enter)), ("left", "back to the last item", plain(KeyCode::Left))];
    let hints = if protocol.confirmed { &hints[..1] } else { &hints };
    page.draw(pen, screen, &questionnaire.title, where_, hints);
}

/// Draws how a questionnaire item is answered, with the answer so far; returns the keys that answer it, and what they
/// do.
fn item_form(page: &mut Page, form: &AnswerFormat, given: Option<&AnswerValue>) -> (String, &'static str) {
    match form {
        AnswerFormat::Scale(of) => {
            scale(page, of, given);
            (format!("1-{}", of.points), "answer")
        }
        AnswerFormat::Choice { options, several } => {
            let chosen = given.map_or(&[][..], AnswerValue::options);
            for (index, option) in options.iter().enumerate() {
                let is_chosen = chosen.contains(&option.id);
                let mark = if is_chosen { format!("[{}]", index + 1) } else { format!(" {} ", index + 1) };
                page.choice(index, &mark, &option.text, if is_chosen { TextRole::Strong } else { TextRole::Text });
            }
            (format!("1-{}", options.len()), if *several { "choose several" } else { "choose one" })
        }
        AnswerFormat::Number { range: [least, most], unit } => {
            let unit = if unit.is_empty() { String::new() } else { format!(" ({unit})") };
            page.text(0, &format!("a number from {least} to {most}{unit}"), TextRole::Quiet);
            typed(page, form, given);
            ("0-9".to_string(), "type number")
        }
        AnswerFormat::Text { length } => {
            page.text(0, &format!("an answer in words, at most {length} characters"), TextRole::Quiet);
            typed(page, form, given);
            ("letters".to_string(), "type answer")
        }
        AnswerFormat::Slider { low, high, step } => {
            let by = if *step > 1 { format!(", in steps of {step}") } else { String::new() };
            page.text(0, &format!("from 0 ({low}) to {SLIDER_END} ({high}){by}"), TextRole::Quiet);
            typed(page, form, given);
            ("0-9".to_string(), "type position")
        }
    }
}

/// Adds the typed answer to the questionnaire page, if there is one.
fn typed(page: &mut Page, form: &AnswerFormat, given: Option<&AnswerValue>) {
    page.space();
    page.text(0, &given.map_or_else(|| "_".to_string(), |given| form.words(given)), TextRole::Strong);
}

/// Draws a rating scale with the given answer marked. The scale's end labels stand under its first and last point.
fn scale(page: &mut Page, of: &RatingScale, given: Option<&AnswerValue>) {
    let point = |point: u8| match given == Some(&AnswerValue::from(point)) {
        true => format!("[{point}]"),
        false => format!(" {point} "),
    };
    let points: Vec<String> = (1..=of.points).map(point).collect();
    let line = points.join("   ");
    page.cells(0, vec![(&line, TextRole::Strong)]);
    let gap = usize::from(width(&line).saturating_sub(width(&of.low) + width(&of.high)).max(3));
    let anchors = format!("{}{}{}", of.low, " ".repeat(gap), of.high);
    page.cells(0, vec![(&anchors, TextRole::Quiet)]);
}

fn draw_failed(pen: &mut Pen, screen: Rect, where_: &str, session: &Session, model: &ConsoleModel) {
    let waiver = model.waiver;
    let Some((step, protocol)) = session.step() else { return };
    let (Some(criterion), Some(practice)) = (step.criterion, &protocol.practice) else { return };
    let mut page = Page::of_session(screen, session, model);
    let required = count(criterion.orders, "order", "orders");
    let required = match criterion.error_rate {
        None => format!("Required: {required} served."),
        Some(rate) => format!("Required: {required} served, errors in at most {:.0} % of presses.", 100.0 * rate),
    };
    page.text(0, &required, TextRole::Text);
    let share = 100.0 * f64::from(practice.errors) / f64::from(practice.presses.max(1));
    let errors = count(practice.errors, "error", "errors");
    let (orders, presses) = (practice.orders, count(practice.presses, "press", "presses"));
    let found = format!("Reached: {orders} served, {errors} in {presses} ({share:.0} %).");
    page.text(0, &found, TextRole::Strong);
    page.space();
    page.text(0, "To waive the criterion and start the first trial, choose a reason:", TextRole::Text);
    for (index, reason) in WAIVERS.iter().enumerate() {
        let is_chosen = waiver == Some(index);
        let mark = if is_chosen { format!(" [{}]", index + 1) } else { format!("  {} ", index + 1) };
        page.choice(index, &mark, reason, if is_chosen { TextRole::Strong } else { TextRole::Text });
    }
    let waivers = format!("1-{}", WAIVERS.len());
    let (others, words) = if waiver.is_some() { ("another", "words") } else { ("choose a reason", "its words") };
    let hints = [
        ("enter", if waiver.is_some() { "waive for this reason" } else { "practise again" }, plain(KeyCode::Enter)),
        (waivers.as_str(), others, None),
        ("letters", words, None),
        ("bksp", "none", plain(KeyCode::Backspace)),
    ];
    let hints = if waiver.is_some() { &hints } else { &hints[..3] };
    page.draw(pen, screen, "The practice criterion is not met", where_, hints);
}

/// Draws a question to the user before a recording, and a notice below it, on an otherwise empty screen.
pub fn draw_question(question: &StartPrompt, notice: Option<&str>, theme: Theme, frame: &mut Frame) {
    let screen = frame.area();
    let mut brush = Painter::new(frame.buffer_mut(), theme);
    let mut page = Page::new(screen);
    if let Some(missing) = &question.missing_page {
        page.head(missing);
    }
    for paragraph in &question.text {
        page.text(0, paragraph, TextRole::Text);
        page.space();
    }
    for (index, answer) in question.answers.iter().enumerate() {
        let is_chosen = question.chosen == Some(index);
        let mark = if is_chosen { format!(" [{}]", index + 1) } else { format!("  {} ", index + 1) };
        page.marked(&mark, answer, if is_chosen { TextRole::Strong } else { TextRole::Text });
    }
    page.focus_here();
    if let Some(notice) = notice {
        page.space();
        page.text(0, notice, TextRole::Alarm);
    }
    let digits = format!("1-{}", question.answers.len());
    let keys = [
        (digits.as_str(), "choose", None),
        ("enter", "go on", plain(KeyCode::Enter)),
        ("esc", "quit without recording", plain(KeyCode::Esc)),
    ];
    page.draw(&mut Pen { brush: &mut brush, with_keys: true }, screen, &question.title, "", &keys);
}

/// Largest width of a line, in columns, for readability.
const WIDEST: u16 = 84;

/// Drawing context of a sheet (a form at full size).
pub(super) struct Pen<'a, 'b> {
    pub brush: &'a mut Painter<'b>,
    pub with_keys: bool,
}

/// A text within a line: its indent in columns, the text, and its style.
type PagePart = (u16, String, TextRole);

/// Text page of a sheet (a form at full size).
#[derive(Default)]
pub(super) struct Page {
    columns: u16,
    lines: Vec<Vec<PagePart>>,
    /// Number of first lines that stay where they are if the page is longer than the screen.
    heads: usize,
    /// Index of the line that must be visible if the page is longer than the screen.
    focus: usize,
    keys: Vec<(usize, KeyChord)>,
}

impl Page {
    /// An empty text page that fits this screen area.
    pub(super) fn new(screen: Rect) -> Page {
        Page { columns: screen.width.saturating_sub(4).min(WIDEST).saturating_sub(4), ..Page::default() }
    }

    /// The page of a sheet of the session. While the participant's page is wanted and none is connected, it begins with
    /// what is to be opened.
    pub(super) fn of_session(screen: Rect, session: &Session, model: &ConsoleModel) -> Page {
        let mut page = Page::new(screen);
        let display = model.display.as_ref().filter(|_| is_wanted(session));
        if let Some(missing) = display.and_then(ParticipantDisplayHealth::missing) {
            page.head(&missing);
        }
        page
    }

    /// Adds an alarm to the top of the page, where it stays.
    fn head(&mut self, text: &str) {
        self.text(0, text, TextRole::Alarm);
        self.heads = self.lines.len();
    }

    /// Width of the page's text, in columns.
    pub(super) fn columns(&self) -> u16 {
        self.columns
    }

    /// Adds a text to the page, wrapped to its width.
    pub(super) fn text(&mut self, indent: u16, text: &str, role: TextRole) {
        let lines = wrap(text, self.columns.saturating_sub(indent));
        self.lines.extend(lines.into_iter().map(|line| vec![(indent, line, role)]));
    }

    /// Adds a line whose texts stand in columns of this width.
    pub(super) fn cells(&mut self, width: u16, cells: Vec<(&str, TextRole)>) {
        let part = |(index, (text, role)): (usize, (&str, TextRole))| (index as u16 * width, text.to_string(), role);
        self.lines.push(cells.into_iter().enumerate().map(part).collect());
    }

    /// Marks the next line as the one that must be visible, or the last line if none follows.
    pub(super) fn focus_here(&mut self) {
        self.focus = self.lines.len();
    }

    /// Adds a text with a mark before its first line.
    pub(super) fn marked(&mut self, mark: &str, text: &str, role: TextRole) {
        let first = self.lines.len();
        self.text(width(mark) + 1, text, role);
        if let Some([(indent, text, _)]) = self.lines.get_mut(first).map(Vec::as_mut_slice) {
            (*indent, *text) = (0, format!("{mark} {text}"));
        }
    }

    /// Adds a numbered choice, which can be clicked.
    pub(super) fn choice(&mut self, index: usize, mark: &str, text: &str, role: TextRole) {
        let digit = char::from_digit(index as u32 + 1, 10).unwrap_or(' ');
        self.keys.push((self.lines.len(), KeyChord::char(digit)));
        self.marked(mark, text, role);
    }

    /// Adds an empty line to the page.
    pub(super) fn space(&mut self) {
        self.lines.push(Vec::new());
    }

    /// Draws the part of the page around the line that must be visible, with key hints in the last line.
    pub(super) fn draw(self, pen: &mut Pen, screen: Rect, title: &str, remark: &str, keys: &[KeyHint]) {
        let rows = (self.lines.len() as u16 + 5).min(screen.height.saturating_sub(2));
        let brush = &mut *pen.brush;
        let inside = open(brush, screen, (self.columns + 4, rows), title, remark);
        let room = usize::from(inside.height.saturating_sub(3));
        let last = self.lines.len().saturating_sub(room);
        let from = (self.focus + 2).saturating_sub(room).min(last);
        let shown = (0..self.heads).chain(self.heads + from..self.lines.len()).take(room);
        for (row, index) in shown.enumerate() {
            let (line, x, y) = (&self.lines[index], inside.x + 1, inside.y + 1 + row as u16);
            let end = line
                .iter()
                .fold(x, |_, (indent, text, role)| brush.text(x + indent, y, self.columns - indent, text, *role));
            let key = self.keys.iter().find(|(line, _)| *line == index);
            if let Some((_, chord)) = key.filter(|_| pen.with_keys) {
                brush.key_target(x, y, end, *chord);
            }
        }
        if pen.with_keys {
            brush.hints(inside.x + 1, inside.bottom().saturating_sub(1), inside.width - 1, keys);
        }
    }
}

/// The key that a click on a key hint stands for.
pub(super) fn plain(code: KeyCode) -> Option<KeyChord> {
    Some(KeyChord::plain(code))
}

/// Confidence of the participant in an answer, in words.
const SURE: [&str; 3] = ["a guess", "fairly sure", "certain"];

/// Clears the area under a freeze probe's sheet where the participant answers at the console, so that the state that is
/// asked about is not visible.
pub(super) fn hide_probe(brush: &mut Painter, area: Rect, session: &Session, model: &ConsoleModel) {
    let is_open = session.probes.open.is_some() && session.phase == TrialPhase::Paused;
    if is_open && model.playback.is_none() && answerer(session, model) == ProbeAnswerer::Console {
        blank(brush, area);
    }
}

pub(super) fn draw_probe(pen: &mut Pen, screen: Rect, open: &StartedProbe, session: &Session, model: &ConsoleModel) {
    let mut page = Page::of_session(screen, session, model);
    let who = answerer(session, model);
    let question =
        open.shown.filter(|_| open.closed.is_none()).and_then(|shown| Some((shown, open.questions.get(shown)?)));
    match question {
        _ if open.is_paused() => page.text(0, "The probe is paused, and so is its time limit.", TextRole::Strong),
        Some((index, question)) => draw_probe_question(&mut page, (open, index, question), (session, model), who),
        None if open.closed.is_some() => {
            page.text(0, "No more questions: the trial continues by itself after the count-down.", TextRole::Text);
        }
        None => page.text(0, "The kitchen is hidden on the display; the first question follows.", TextRole::Text),
    }
    draw_probe_answers(&mut page, open, session, model);
    let title = status(session, model).unwrap_or_default();
    let left = probe_left(session, model.now)
        .map_or(String::new(), |left| format!("{:.0} s left to answer", left.as_secs_f64().ceil()));
    let chord = |action| model.keys.chord_for(&action);
    let (pause, skip) = (chord(KeyAction::Advance), chord(KeyAction::Manual(ManualAction::SkipProbe)));
    let [pause_key, skip_key] = [pause, skip].map(|chord| chord.map(|chord| chord.to_string()).unwrap_or_default());
    let mut hints: Vec<KeyHint> = Vec::new();
    if question.is_some() && who == ProbeAnswerer::Console && !open.is_paused() {
        hints.push(("0-9", "type number", None));
        hints.push(("enter", "confirm answer", plain(KeyCode::Enter)));
    }
    if open.closed.is_none() && skip.is_some() {
        hints.push((&skip_key, "skip the probe", skip));
    }
    if pause.is_some() {
        hints.push((&pause_key, if open.is_paused() { "resume" } else { "pause" }, pause));
    }
    page.draw(pen, screen, &capital(&title), &left, &hints);
}

fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or(String::new(), |first| first.to_uppercase().chain(letters).collect())
}

/// Draws the question with its numbered choices, in as many columns as have room.
fn draw_probe_question(
    page: &mut Page,
    (open, index, question): (&StartedProbe, usize, &ProbeQuestion),
    (session, model): (&Session, &ConsoleModel),
    who: ProbeAnswerer,
) {
    let ProbeWording { question: asked, choices } = probe_wording(session, question);
    page.text(0, &asked, TextRole::Strong);
    page.text(
        0,
        match who {
            ProbeAnswerer::Display => "The participant answers on the display.",
            ProbeAnswerer::Console => "Read the question out, and enter the number of the answer.",
            ProbeAnswerer::Simulated => "The simulated participant answers.",
        },
        TextRole::Quiet,
    );
    page.space();
    let entry = model.probe_entry.for_question(open.number, index);
    let is_chosen = |number: usize| who == ProbeAnswerer::Console && entry.choice == Some(number);
    let numbered = choices.iter().enumerate().map(|(index, choice)| (index + 1, choice.as_str()));
    let cells: Vec<(usize, String)> = numbered
        .chain([(0, "does not know")])
        .map(|(number, words)| (number, choice_cell(number, words, is_chosen(number))))
        .collect();
    let widest = cells.iter().map(|(_, text)| width(text)).max().unwrap_or(1) + 2;
    let columns = usize::from((page.columns() / widest).clamp(1, if cells.len() > 8 { 4 } else { 1 }));
    let rows = cells.len().div_ceil(columns);
    for row in 0..rows {
        let line: Vec<&(usize, String)> = (0..columns).filter_map(|column| cells.get(column * rows + row)).collect();
        let parts = line
            .iter()
            .map(|(number, text)| (text.as_str(), if is_chosen(*number) { TextRole::Strong } else { TextRole::Text }));
        if line.iter().any(|(number, _)| is_chosen(*number)) {
            page.focus_here();
        }
        page.cells(widest, parts.collect());
    }
    if entry.asks_sure {
        page.space();
        sure(page, entry);
    }
}

fn choice_cell(number: usize, words: &str, is_chosen: bool) -> String {
    match is_chosen {
        true => format!("[{number:>2}] {words}"),
        false => format!(" {number:>2}  {words}"),
    }
}

fn sure(page: &mut Page, entry: ProbeEntry) {
    let steps = SURE.iter().zip(1..).map(|(words, step)| choice_cell(step, words, entry.sure == Some(step as u8)));
    page.text(0, &format!("How sure? {}", steps.collect::<Vec<_>>().join("  ")), TextRole::Strong);
    page.focus_here();
}

/// Draws the progress of the answers. Their content is shown only where the study shows beliefs to the wizard, and
/// never to raters.
fn draw_probe_answers(page: &mut Page, open: &StartedProbe, session: &Session, model: &ConsoleModel) {
    let is_shown = visibility(session, model) >= WizardVisibility::Belief && model.coding.is_none();
    let given =
        open.questions.iter().zip(&open.answers).filter_map(|(question, given)| Some((question, given.as_ref()?)));
    for (index, (question, given)) in given.enumerate() {
        if index == 0 {
            page.space();
        }
        let wording = probe_wording(session, question);
        let answer = if is_shown { answered(&wording, question, given) } else { "answered".to_string() };
        page.text(0, &format!("{} {} {answer}", index + 1, wording.question), TextRole::Quiet);
    }
}

fn answered(wording: &ProbeWording, question: &ProbeQuestion, given: &ProbeAnswer) -> String {
    let Some(name) = &given.answer else { return "does not know".to_string() };
    let index = question.choices.iter().position(|choice| choice == name);
    let words = index.and_then(|index| wording.choices.get(index)).unwrap_or(name);
    let sure = given.confidence.and_then(|step| SURE.get(usize::from(step).checked_sub(1)?));
    sure.map_or(words.clone(), |sure| format!("{words} ({sure})"))
}
