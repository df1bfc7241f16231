//! Keys during a freeze probe: the wizard pauses the probe, or enters the answers of a participant who has no display.

use crossterm::event::KeyCode;

use super::actions::{refuse, send};
use super::console_model::{ConsoleCommand, ConsoleModel};
use super::form::SheetKey;
use tomcom_session::probes::{ProbeEvent, ProbeOrigin, StartedProbe};
use tomcom_session::settings::ParticipantKind;
use tomcom_session::wall_display::AnswerDevice;
use tomcom_session::{Event, Session, TrialPhase};

/// Who enters the answers to a freeze probe's questions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ProbeAnswerer {
    Display,
    Console,
    Simulated,
}

/// Who enters the answers now; the wizard does if no page of the participant's display is connected.
pub fn answerer(session: &Session, model: &ConsoleModel) -> ProbeAnswerer {
    match session.spec.participant.kind {
        ParticipantKind::Simulated => ProbeAnswerer::Simulated,
        _ if model.display.as_ref().is_some_and(|display| display.page.is_some()) => ProbeAnswerer::Display,
        _ => ProbeAnswerer::Console,
    }
}

/// Number of a probe in words: "probe 2 of 4"; the second number is how many the trial is expected to have.
pub fn numbered(session: &Session, number: u32) -> String {
    let book = &session.probes;
    let asked_for = book.over.iter().chain(&book.open).filter(|probe| probe.origin == ProbeOrigin::Wizard).count()
        + usize::from(book.waiting.as_ref().is_some_and(|waiting| waiting.origin == ProbeOrigin::Wizard));
    let all = (book.schedule.len() + asked_for).max(number as usize);
    format!("probe {number} of {all}")
}

/// Status of the trial's freeze probes in words: "probe 2 of 4 · question 1 of 3", or when the next one is due.
pub fn status(session: &Session, model: &ConsoleModel) -> Option<String> {
    let book = &session.probes;
    if let Some(open) = &book.open {
        let name = numbered(session, open.number);
        let question = open.shown.filter(|_| open.closed.is_none());
        return Some(match question {
            Some(shown) => format!("{name} \u{b7} question {} of {}", shown + 1, open.questions.len()),
            None => name,
        });
    }
    if let Some(waiting) = &book.waiting {
        return Some(format!("{} is delayed", numbered(session, waiting.number)));
    }
    // A participant who reads the console must not know when the next probe comes.
    let foresees = session.spec.participant.kind == ParticipantKind::Keyboard;
    let next = book.schedule.get(book.came_due).filter(|_| session.is_running() && !foresees)?;
    let in_s = next.at.as_secs_f64() - session.trial_clock(model.now).as_secs_f64();
    Some(format!("{} in {:.0} s", numbered(session, book.numbered + 1), in_s.max(0.0).ceil()))
}

pub(super) fn takes_digit(model: &ConsoleModel, session: &Session, code: KeyCode) -> bool {
    let is_digit = matches!(code, KeyCode::Char('0'..='9'));
    let is_free = model.dialog.is_none() && model.playback.is_none();
    let is_asked = session.probes.open.as_ref().is_some_and(|open| open.question().is_some());
    is_digit
        && is_free
        && is_asked
        && session.phase == TrialPhase::Paused
        && answerer(session, model) == ProbeAnswerer::Console
}

/// Carries out a key on the sheet of a freeze probe.
pub(super) fn write(
    model: &mut ConsoleModel,
    session: &Session,
    open: &StartedProbe,
    stroke: SheetKey,
) -> Option<ConsoleCommand> {
    if stroke == SheetKey::Leave {
        let (event, words) = match session.can_be_paused() {
            true => (Event::TrialPaused, "the freeze probe is paused"),
            false => (Event::TrialResumed, "the freeze probe continues"),
        };
        return send(model, session, event, words);
    }
    match answerer(session, model) {
        ProbeAnswerer::Simulated => return refuse(model, "the simulated participant answers"),
        ProbeAnswerer::Display => return refuse(model, "the participant answers on the display"),
        ProbeAnswerer::Console => {}
    }
    let Some((index, question)) = open.question() else { return refuse(model, "the probe asks no question now") };
    let (mut entry, choices) = (model.probe_entry.for_question(open.number, index), question.choices.len());
    let confidence = session.spec.probes.as_ref().is_some_and(|probes| probes.confidence);
    match stroke {
        SheetKey::Digit(digit @ 1..=3) if entry.asks_sure => entry.sure = Some(digit),
        SheetKey::Digit(_) | SheetKey::Forward | SheetKey::Back if entry.asks_sure => {
            return refuse(model, "how sure is the participant? 1, 2 or 3");
        }
        SheetKey::Digit(digit) => {
            let begun = entry.choice.filter(|_| entry.is_typed).unwrap_or(0);
            let number = 10 * begun + usize::from(digit);
            if number > choices {
                return refuse(model, format!("the question has no choice {number}; backspace deletes a digit"));
            }
            (entry.choice, entry.is_typed) = (Some(number), true);
        }
        SheetKey::Forward | SheetKey::Back => {
            let by = if stroke == SheetKey::Forward { 1 } else { -1 };
            let to = entry.choice.map_or(0, |choice| choice.saturating_add_signed(by)).min(choices);
            // If no choice is selected yet, the down arrow selects the first choice.
            let to = if entry.choice.is_none() && by > 0 { 1 } else { to };
            (entry.choice, entry.is_typed) = (Some(to), false);
        }
        SheetKey::Undo if entry.asks_sure => (entry.asks_sure, entry.sure) = (false, None),
        SheetKey::Undo => entry.choice = entry.choice.filter(|&choice| choice > 9).map(|choice| choice / 10),
        SheetKey::Confirm => match entry.choice {
            None => return refuse(model, "enter the number of the choice first; 0: the participant does not know"),
            Some(1..) if confidence && !entry.asks_sure => entry.asks_sure = true,
            Some(1..) if confidence && entry.sure.is_none() => {
                return refuse(model, "how sure is the participant? 1, 2 or 3");
            }
            Some(number) => {
                let answer = number.checked_sub(1).and_then(|index| question.choices.get(index)).cloned();
                let (probe, question, on) = (open.number, index as u32 + 1, AnswerDevice::Console);
                let event = ProbeEvent::Answered { probe, question, answer, confidence: entry.sure, on };
                entry.is_typed = false;
                model.probe_entry = entry;
                return send(model, session, Event::Probe(event), "");
            }
        },
        SheetKey::Leave | SheetKey::Skip | SheetKey::Letter(_) => {}
    }
    model.probe_entry = entry;
    None
}

/// Answer to a freeze probe's question while the wizard enters it at the console.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ProbeEntry {
    of: (u32, usize),
    /// Number of the selected answer; 0 is "I don't know".
    pub choice: Option<usize>,
    /// Whether the last key was a digit, so that another digit continues the number.
    pub is_typed: bool,
    /// Whether the choice is confirmed, so that the participant's confidence is entered next.
    pub asks_sure: bool,
    /// How sure the participant is of the answer, from 1 (a guess) to 3 (certain).
    pub sure: Option<u8>,
}

impl ProbeEntry {
    /// The entry for this question: unchanged if it belongs to this question, else empty.
    pub fn for_question(self, probe: u32, question: usize) -> ProbeEntry {
        let of = (probe, question);
        if self.of == of { self } else { ProbeEntry { of, ..ProbeEntry::default() } }
    }
}
