//! Sheets (forms at full size) around a trial: instruction, questionnaire, debriefing, and questions before a
//! recording.

use crossterm::event::KeyCode;
use ratatui::Frame;
use ratatui::layout::Rect;

use super::paint::Painter;
use super::probe_sheet;
use super::sheet_page::{Page, Pen, plain};
use super::theme::{TextRole, Theme};
use crate::console::chord::KeyChord;
use crate::console::console_model::ConsoleModel;
use crate::console::display_status::ParticipantDisplayHealth;
use crate::console::form::{FormContent, WAIVERS, sheet};
use crate::console::question::StartQuestion;
use crate::console::text_columns::width;
use tomcom_core::base::text::count;
use tomcom_session::Session;
use tomcom_session::questionnaire::AnswerValue;
use tomcom_session::plan::{AnswerFormat, Questionnaire, RatingScale, SLIDER_END, Tutorial, TutorialStepKind};
use tomcom_session::protocol::{ItemAnswer, StudyProtocolState};

/// Draws the sheet of the session's present phase, if that phase has one.
pub fn draw(brush: &mut Painter, screen: Rect, session: &Session, model: &ConsoleModel) {
    // In a replay, the sheet shows no keys, since keys have other meanings there.
    let pen = &mut Pen { brush, with_keys: model.playback.is_none() };
    let sheet = sheet(session);
    if let Some(FormContent::Probe(open)) = sheet {
        return probe_sheet::draw(pen, screen, open, session, model);
    }
    let (Some(sheet), Some((step, protocol))) = (sheet, session.step()) else { return };
    let where_ = format!("{}  {}", session.spec.participant.code, step.label());
    match sheet {
        FormContent::Probe(_) => {}
        FormContent::Steps { title, steps } => draw_steps(pen, screen, (title, &where_), steps, protocol, session),
        FormContent::Tutorial(tutorial) => draw_tutorial(pen, screen, &where_, tutorial, (session, model)),
        FormContent::Questions(questionnaire) => draw_questions(pen, screen, &where_, questionnaire, protocol, session),
        FormContent::Failed => draw_failed(pen, screen, &where_, session, model.waiver),
    }
}

/// Label of the key that leaves the sheet: the name of the next phase.
fn onward(session: &Session) -> String {
    match session.next_phase() {
        Some(phase) => format!("next phase: {}", phase.name()),
        None if session.step().is_some_and(|(step, _)| step.is_tutorial_alone()) => "leave the tutorial".to_string(),
        None => "next recording".to_string(),
    }
}

fn draw_steps(
    pen: &mut Pen,
    screen: Rect,
    heads: (&str, &str),
    steps: &[String],
    protocol: &StudyProtocolState,
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
            page.focus_here();
        }
        page.marked(if is_done { "[x]" } else { "[ ]" }, step, role);
    }
    if open.is_none() {
        page.focus_here();
    }
    let on = if open.is_some() { "tick this step as done".to_string() } else { onward(session) };
    let undo = ("bksp", "untick the last step", plain(KeyCode::Backspace));
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
    if let Some(address) = model.display.as_ref().and_then(ParticipantDisplayHealth::to_open) {
        page.text(0, &format!("the participant's page is not connected: {address}"), TextRole::Alarm);
    }
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
            TutorialStepKind::Question if wrong > 0 => format!(" (wrong answers: {wrong})"),
            _ => String::new(),
        };
        page.marked(mark, &format!("{}{more}", step.title), role);
    }
    let on = onward(session);
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
    session: &Session,
) {
    let items = questionnaire.items.len();
    let mut page = Page::new(screen);
    if let Some(item) = questionnaire.items.get(protocol.item) {
        page.text(0, &format!("item {} of {items}", protocol.item + 1), TextRole::Quiet);
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
        (true, _) => onward(session),
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
            let unit = if unit.is_empty() { String::new() } else { format!(" {unit}") };
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

fn draw_failed(pen: &mut Pen, screen: Rect, where_: &str, session: &Session, waiver: Option<usize>) {
    let Some((step, protocol)) = session.step() else { return };
    let (Some(criterion), Some(practice)) = (step.criterion, &protocol.practice) else { return };
    let mut page = Page::new(screen);
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
    let hints = [
        ("enter", if waiver.is_some() { "waive for this reason" } else { "practise again" }, plain(KeyCode::Enter)),
        (waivers.as_str(), "choose a reason", None),
        ("left", "deselect the reason", plain(KeyCode::Left)),
    ];
    let hints = if waiver.is_some() { &hints } else { &hints[..2] };
    page.draw(pen, screen, "The practice criterion is not met", where_, hints);
}

/// Draws a question to the user before a recording, and a notice below it, on an otherwise empty screen.
pub fn draw_question(question: &StartQuestion, notice: Option<&str>, theme: Theme, frame: &mut Frame) {
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
    page.focus_here();
    if let Some(notice) = notice {
        page.space();
        page.text(0, notice, TextRole::Alarm);
    }
    let keys = [("esc", "quit without recording", plain(KeyCode::Esc))];
    page.draw(&mut Pen { brush: &mut brush, with_keys: true }, screen, &question.title, "", &keys);
}
