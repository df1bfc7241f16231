//! The sheet of a freeze probe: the question, its choices, the answers so far, and the time that is left. The sheet
//! does not show whether an answer is right, because the wizard may sit beside the participant.

use crossterm::event::KeyCode;
use ratatui::layout::Rect;

use super::paint::{KeyHint, Painter};
use super::popup::blank;
use super::sheet_page::{Page, Pen, plain};
use super::theme::TextRole;
use crate::console::beliefs::visibility;
use crate::console::console_model::ConsoleModel;
use crate::console::display_status::{ParticipantDisplayHealth, is_wanted};
use crate::console::key_action::{KeyAction, ManualAction};
use crate::console::probe_entry::ProbeEntry;
use crate::console::probe_keys::{ProbeAnswerer, answerer, status};
use crate::console::text_columns::width;
use tomcom_devices::sight::{ProbeWording, probe_left, probe_wording};
use tomcom_session::probes::{ProbeAnswer, ProbeQuestion, StartedProbe};
use tomcom_session::settings::WizardVisibility;
use tomcom_session::{Session, TrialPhase};

/// Confidence of the participant in an answer, in words.
const SURE: [&str; 3] = ["a guess", "fairly sure", "certain"];

/// Clears the area under a freeze probe's sheet where the participant answers at the console, so that the state that is
/// asked about is not visible.
pub(super) fn hide(brush: &mut Painter, area: Rect, session: &Session, model: &ConsoleModel) {
    let is_open = session.probes.open.is_some() && session.phase == TrialPhase::Paused;
    if is_open && model.playback.is_none() && answerer(session, model) == ProbeAnswerer::Console {
        blank(brush, area);
    }
}

/// Draws the sheet of a freeze probe.
pub(super) fn draw(pen: &mut Pen, screen: Rect, open: &StartedProbe, session: &Session, model: &ConsoleModel) {
    let mut page = Page::new(screen);
    let who = answerer(session, model);
    if let Some(address) =
        model.display.as_ref().and_then(ParticipantDisplayHealth::to_open).filter(|_| is_wanted(session))
    {
        page.text(0, &format!("the participant's page is not connected: {address}"), TextRole::Alarm);
    }
    let question =
        open.shown.filter(|_| open.closed.is_none()).and_then(|shown| Some((shown, open.questions.get(shown)?)));
    match question {
        _ if open.is_paused() => page.text(0, "The probe is paused, and so is its time limit.", TextRole::Strong),
        Some((index, question)) => ask(&mut page, (open, index, question), (session, model), who),
        None if open.closed.is_some() => {
            page.text(0, "No more questions: the trial continues by itself after the count-down.", TextRole::Text);
        }
        None => page.text(0, "The kitchen is hidden on the display; the first question follows.", TextRole::Text),
    }
    answers(&mut page, open, session, model);
    let title = status(session, model).unwrap_or_default();
    let left = probe_left(session, model.now)
        .map_or(String::new(), |left| format!("{:.0} s left to answer", left.as_secs_f64().ceil()));
    let chord = |action| model.keys.chord_for(&action);
    let (pause, skip) = (chord(KeyAction::Advance), chord(KeyAction::Hand(ManualAction::SkipProbe)));
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
fn ask(
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
        .map(|(number, words)| (number, cell(number, words, is_chosen(number))))
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

fn cell(number: usize, words: &str, is_chosen: bool) -> String {
    match is_chosen {
        true => format!("[{number:>2}] {words}"),
        false => format!(" {number:>2}  {words}"),
    }
}

fn sure(page: &mut Page, entry: ProbeEntry) {
    let steps = SURE.iter().zip(1..).map(|(words, step)| cell(step, words, entry.sure == Some(step as u8)));
    page.text(0, &format!("How sure? {}", steps.collect::<Vec<_>>().join("  ")), TextRole::Strong);
    page.focus_here();
}

/// Draws the progress of the answers. Their content is shown only where the study shows beliefs to the wizard, and
/// never to raters.
fn answers(page: &mut Page, open: &StartedProbe, session: &Session, model: &ConsoleModel) {
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
