//! Sheets around a trial (forms at full size): steps to tick, questionnaire items, and an unmet practice criterion.
//! Digits choose, enter goes on; arrows go between items, and the advance key leaves a completed sheet.
//! Confirmations and answers are recorded as events of the session.

use crossterm::event::KeyCode;

use super::actions::{open_dialog, refuse, send};
use super::console_model::{ConsoleCommand, ConsoleModel, Dialog};
use super::lists::{OTHER_REASON, ReasonFor};
use super::probe_keys;
use super::text_input::TextInput;
use tomcom_session::plan::{AnswerFormat, PhaseSpec, Questionnaire, Tutorial};
use tomcom_session::probes::StartedProbe;
use tomcom_session::protocol::{ItemAnswer, ProtocolEvent, StudyProtocolState};
use tomcom_session::questionnaire::AnswerValue;
use tomcom_session::tutorial::{TutorialEvent, TutorialPageTurner};
use tomcom_session::{Event, Session, TrialPhase};

/// Reasons for waiving the practice criterion.
pub const WAIVERS: [&str; 4] =
    ["the participant knows the task anyway", "no time for more practice", "technical problem", OTHER_REASON];

/// Content of a sheet, a form of the console at full size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FormContent<'a> {
    /// Questions of a freeze probe, while the trial stands still.
    Probe(&'a StartedProbe),
    /// Steps of a phase of the study plan, to be ticked in order.
    Steps {
        /// Heading of the sheet with steps.
        title: &'static str,
        /// Steps of the phase that the wizard has to do, in this order.
        steps: &'a [String],
    },
    Tutorial(&'a Tutorial),
    Questions(&'a Questionnaire),
    /// Choice after an unmet practice criterion: repeat the practice, or waive the criterion.
    Failed,
}

impl FormContent<'_> {
    /// Name of the sheet in the log, as part of the wizard's visible screen.
    pub fn name(&self) -> &'static str {
        match self {
            FormContent::Probe(_) => "probe",
            FormContent::Steps { .. } => "steps",
            FormContent::Tutorial(_) => "tutorial",
            FormContent::Questions(_) => "questionnaire",
            FormContent::Failed => "criterion",
        }
    }
}

/// The sheet of the session's present phase, if that phase has one.
pub fn sheet(session: &Session) -> Option<FormContent<'_>> {
    if let Some(open) = session.probes.open.as_ref().filter(|_| session.phase == TrialPhase::Paused) {
        return Some(FormContent::Probe(open));
    }
    let (_, protocol) = session.step()?;
    match session.study_phase()? {
        PhaseSpec::Instruction { steps } => Some(FormContent::Steps { title: "Instruction of the participant", steps }),
        PhaseSpec::Tutorial { tutorial } => Some(FormContent::Tutorial(tutorial)),
        PhaseSpec::Debriefing { steps } => Some(FormContent::Steps { title: "Debriefing of the wizard", steps }),
        PhaseSpec::Questionnaire { questionnaire } => Some(FormContent::Questions(questionnaire)),
        PhaseSpec::Familiarisation => {
            let failed = protocol.practice.as_ref().is_some_and(|practice| !practice.met && practice.waived.is_none());
            failed.then_some(FormContent::Failed)
        }
        PhaseSpec::Trial => None,
    }
}

/// The meaning of a key on the open sheet, if any; `advances` says that it is the key that starts and pauses trials.
pub(super) fn stroke(session: &Session, code: KeyCode, advances: bool) -> Option<SheetKey> {
    let shown = session.protocol.as_ref().and_then(|protocol| session.questionnaire()?.form(protocol.item));
    match code {
        _ if advances => Some(SheetKey::Leave),
        KeyCode::Enter => Some(SheetKey::Confirm),
        KeyCode::Right | KeyCode::Down => Some(SheetKey::Forward),
        KeyCode::Left | KeyCode::Up => Some(SheetKey::Back),
        KeyCode::Backspace => Some(SheetKey::Undo),
        KeyCode::Delete if shown.is_some() => Some(SheetKey::Skip),
        KeyCode::Char(digit @ '0'..='9') => Some(SheetKey::Digit(digit as u8 - b'0')),
        KeyCode::Char(letter) if letter.is_alphabetic() || letter == '-' => {
            let is_typed = input_of_sheet(session).is_some() || sheet(session) == Some(FormContent::Failed);
            is_typed.then_some(SheetKey::Letter(letter))
        }
        _ => None,
    }
}

/// Carries out a key of the open sheet (a form at full size).
pub(super) fn write(model: &mut ConsoleModel, session: &Session, stroke: SheetKey) -> Option<ConsoleCommand> {
    let sheet = sheet(session)?;
    if let FormContent::Probe(open) = sheet {
        return probe_keys::write(model, session, open, stroke);
    }
    let protocol = session.protocol.as_ref()?;
    match (sheet, stroke) {
        (FormContent::Probe(_), _) => None,
        (FormContent::Failed, SheetKey::Leave) => Some(ConsoleCommand::Next),
        (FormContent::Tutorial(tutorial), stroke) => read(model, session, tutorial, stroke),
        (_, SheetKey::Leave) => leave(model, session),
        (FormContent::Steps { .. }, SheetKey::Confirm) => match protocol.ticks.iter().position(|done| !done) {
            Some(open) => send_protocol(model, session, ProtocolEvent::Ticked { step: open + 1, done: true }),
            None => leave(model, session),
        },
        (FormContent::Steps { .. }, SheetKey::Undo) => {
            let last = protocol.ticks.iter().rposition(|done| *done)?;
            send_protocol(model, session, ProtocolEvent::Ticked { step: last + 1, done: false })
        }
        (FormContent::Steps { .. }, SheetKey::Letter(letter)) => begin_typing(model, protocol, letter),
        (FormContent::Steps { .. }, _) => refuse(model, "enter ticks the step, backspace unticks the last one"),
        (FormContent::Questions(_), _) if protocol.confirmed => match stroke {
            SheetKey::Confirm => leave(model, session),
            _ => refuse(model, "the answers are already confirmed"),
        },
        (FormContent::Questions(questionnaire), stroke) => ask(model, session, questionnaire, protocol, stroke),
        (FormContent::Failed, SheetKey::Confirm) => match model.waiver.take().and_then(|index| WAIVERS.get(index)) {
            Some(reason) => word_waiver(model, reason, TextInput::default()),
            None => Some(ConsoleCommand::Next),
        },
        (FormContent::Failed, SheetKey::Letter(letter)) => {
            let reason = model.waiver.take().and_then(|index| WAIVERS.get(index)).unwrap_or(&OTHER_REASON);
            word_waiver(model, reason, TextInput::with_text(&letter.to_string()))
        }
        (FormContent::Failed, SheetKey::Digit(digit)) => {
            let chosen = usize::from(digit).checked_sub(1).filter(|index| *index < WAIVERS.len());
            model.waiver = chosen.or(model.waiver);
            None
        }
        (FormContent::Failed, _) => {
            model.waiver = None;
            None
        }
    }
}

/// Opens the field for further words to the reason for which the practice criterion is waived.
fn word_waiver(model: &mut ConsoleModel, reason: &str, field: TextInput) -> Option<ConsoleCommand> {
    open_dialog(model, Dialog::Reason(ReasonFor::Waive, reason.to_string(), field))
}

/// Carries out a sheet key during the tutorial: the wizard turns the participant's page, or ends the tutorial.
fn read(model: &mut ConsoleModel, session: &Session, tutorial: &Tutorial, stroke: SheetKey) -> Option<ConsoleCommand> {
    let by = TutorialPageTurner::Wizard;
    let Some((_, state)) = session.tutorial_step() else { return leave(model, session) };
    let to = match stroke {
        SheetKey::Forward | SheetKey::Confirm => state.step + 1,
        SheetKey::Back | SheetKey::Undo => match state.step.checked_sub(1) {
            Some(before) => before,
            None => return refuse(model, "this is the first page of the tutorial"),
        },
        SheetKey::Digit(0) => return open_dialog(model, Dialog::EndTutorial),
        SheetKey::Digit(_) | SheetKey::Letter(_) | SheetKey::Skip => {
            return refuse(model, "arrows turn the participant's page, 0 asks whether to end the tutorial");
        }
        SheetKey::Leave => return leave(model, session),
    };
    let event = match tutorial.steps.get(to) {
        Some(step) => TutorialEvent::Shown { step: step.id.clone(), by },
        None => TutorialEvent::Ended { by },
    };
    send_protocol(model, session, ProtocolEvent::Tutorial(event))
}

/// Ends the tutorial before its last page.
pub(super) fn end_tutorial(model: &mut ConsoleModel, session: &Session) -> Option<ConsoleCommand> {
    let by = TutorialPageTurner::Wizard;
    send_protocol(model, session, ProtocolEvent::Tutorial(TutorialEvent::Ended { by }))
}

fn ask(
    model: &mut ConsoleModel,
    session: &Session,
    questionnaire: &Questionnaire,
    protocol: &StudyProtocolState,
    stroke: SheetKey,
) -> Option<ConsoleCommand> {
    let id = |index: usize| questionnaire.items.get(index).map(|item| item.id.clone());
    let (shown, form) = (id(protocol.item), questionnaire.form(protocol.item));
    let is_typed = form.is_some_and(|form| is_typed(&form));
    let chosen = model.item_choice.take_if(|choice| shown.as_ref() != Some(&choice.item) || stroke.ends_choice());
    if let Some(choice) = chosen.filter(|choice| shown.as_ref() == Some(&choice.item)) {
        return match stroke {
            SheetKey::Undo => None,
            _ => send_protocol(model, session, choice.event()),
        };
    }
    match (stroke, shown) {
        (SheetKey::Back, Some(_)) if model.item_choice.is_some() => {
            refuse(model, "enter keeps the answer, backspace takes it back")
        }
        (SheetKey::Digit(digit), Some(_)) if is_typed => begin_typing(model, protocol, char::from(b'0' + digit)),
        (SheetKey::Letter(letter), Some(_)) if is_typed => begin_typing(model, protocol, letter),
        (SheetKey::Digit(0) | SheetKey::Skip, Some(item)) => {
            model.item_choice = Some(ItemChoice { item, answer: ItemAnswer::Skipped });
            None
        }
        (SheetKey::Digit(digit), Some(item)) => {
            let index = usize::from(digit - 1);
            let form = form?;
            let option = form.choose(index, protocol.given(protocol.item));
            let is_choice = matches!(form, AnswerFormat::Choice { .. });
            let Some(answer) = option.or((!is_choice).then(|| AnswerValue::from(digit))) else {
                return refuse(model, "the item has no option with this number");
            };
            if let Err(reason) = form.admit(&answer) {
                return refuse(model, reason);
            }
            let choice = ItemChoice { item, answer: ItemAnswer::Given(answer) };
            if form.stays() {
                // Of several options each is an answer of its own, after which the item stays.
                return send_protocol(model, session, choice.event());
            }
            model.item_choice = Some(choice);
            None
        }
        (SheetKey::Digit(_) | SheetKey::Letter(_) | SheetKey::Skip, _) => {
            refuse(model, "to change an answer, go back to its item first")
        }
        (SheetKey::Back | SheetKey::Undo, _) => {
            let item = id(protocol.item.checked_sub(1)?)?;
            send_protocol(model, session, ProtocolEvent::ItemShown { item })
        }
        (SheetKey::Confirm | SheetKey::Forward, Some(_)) => {
            let next = session.next_item()?;
            send_protocol(model, session, next)
        }
        (SheetKey::Confirm, None) => match protocol.open_item().and_then(id) {
            Some(item) => send_protocol(model, session, ProtocolEvent::ItemShown { item }),
            None => send_protocol(model, session, ProtocolEvent::AnswersConfirmed),
        },
        (SheetKey::Forward, None) => refuse(model, "enter confirms the answers"),
        (SheetKey::Leave, _) => leave(model, session),
    }
}

/// The chosen answer to a questionnaire item, before enter records it.
#[derive(Clone, Debug, PartialEq)]
pub struct ItemChoice {
    pub item: String,
    pub answer: ItemAnswer,
}

impl ItemChoice {
    fn event(self) -> ProtocolEvent {
        let item = self.item;
        match self.answer {
            ItemAnswer::Given(answer) => ProtocolEvent::ItemAnswered { item, answer },
            ItemAnswer::Skipped => ProtocolEvent::ItemSkipped { item },
        }
    }
}

/// Whether a questionnaire item is answered by typing text or a number, instead of by one digit key.
fn is_typed(form: &AnswerFormat) -> bool {
    matches!(form, AnswerFormat::Number { .. } | AnswerFormat::Text { .. } | AnswerFormat::Slider { .. })
}

/// Opens the text input for an answer with its first letter.
fn begin_typing(model: &mut ConsoleModel, protocol: &StudyProtocolState, letter: char) -> Option<ConsoleCommand> {
    let mut line = answer_input(protocol);
    line.key(KeyCode::Char(letter));
    open_dialog(model, Dialog::Answer(line))
}

/// The text input for the answer to the shown item. A text that was answered before is kept in it to be corrected.
fn answer_input(protocol: &StudyProtocolState) -> TextInput {
    match protocol.given(protocol.item) {
        Some(AnswerValue::Text(words)) => TextInput::with_text(words),
        _ => TextInput::default(),
    }
}

/// The text input that a typed letter would open on the sheet, if the sheet shows an item that is answered by typing, or
/// a question of the debriefing.
pub(super) fn input_of_sheet(session: &Session) -> Option<TextInput> {
    if debriefing_question(session).is_some() {
        return Some(TextInput::default());
    }
    let Some(FormContent::Questions(questionnaire)) = sheet(session) else { return None };
    let protocol = session.protocol.as_ref().filter(|protocol| !protocol.confirmed)?;
    questionnaire.form(protocol.item).filter(is_typed).map(|_| answer_input(protocol))
}

/// The open step of the debriefing. Words typed there become a note that begins with the step.
pub fn debriefing_question(session: &Session) -> Option<&str> {
    let PhaseSpec::Debriefing { steps } = session.study_phase()? else { return None };
    let open = session.protocol.as_ref()?.ticks.iter().position(|done| !done)?;
    steps.get(open).map(String::as_str)
}

/// Gives the answer of a text input. An invalid answer stays in the input, and a notice gives the reason.
pub(super) fn give_answer(model: &mut ConsoleModel, session: &Session, line: TextInput) -> Option<ConsoleCommand> {
    let text = line.text();
    if let Some(question) = debriefing_question(session) {
        let note = Event::Marker { note: format!("{question} {text}"), observer: None };
        return send(model, session, note, "recorded as a note; enter ticks the step");
    }
    let (questionnaire, protocol) = (session.questionnaire()?, session.protocol.as_ref()?);
    let (item, form) = (questionnaire.items.get(protocol.item)?.id.clone(), questionnaire.form(protocol.item)?);
    let answer = match (&form, text.parse()) {
        (AnswerFormat::Text { .. }, _) => Ok(AnswerValue::Text(text)),
        (_, Ok(number)) => Ok(AnswerValue::Number(number)),
        (_, Err(_)) => Err("the answer has to be a whole number"),
    };
    match answer.and_then(|answer| form.admit(&answer).map(|()| answer)) {
        Ok(answer) => send_protocol(model, session, ProtocolEvent::ItemAnswered { item, answer }),
        Err(reason) => {
            model.dialog = Some(Dialog::Answer(line));
            refuse(model, reason)
        }
    }
}

/// Leaves a finished phase for the next phase or for the next recording.
pub(super) fn leave(model: &mut ConsoleModel, session: &Session) -> Option<ConsoleCommand> {
    if session.protocol.is_some() && session.aborted.is_some() {
        return Some(ConsoleCommand::Redo);
    }
    if let Some(lacks) = session.phase_lacks() {
        return refuse(model, lacks);
    }
    let Some(number) = session.protocol.as_ref().map(|protocol| protocol.number + 1) else {
        return refuse(model, "the trial is over");
    };
    match session.next_phase() {
        Some(phase) => send_protocol(model, session, ProtocolEvent::PhaseStarted { phase, number }),
        None => Some(ConsoleCommand::Next),
    }
}

fn send_protocol(model: &mut ConsoleModel, session: &Session, event: ProtocolEvent) -> Option<ConsoleCommand> {
    send(model, session, Event::Protocol(event), "")
}

/// Meaning of a key on a sheet (a form at full size).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum SheetKey {
    /// Tick the present step, go on from the present item, or confirm the sheet.
    Confirm,
    /// Go on to the session's next phase, if the sheet is complete.
    Leave,
    Forward,
    Back,
    /// Take back the last tick, or show the previous item.
    Undo,
    /// Leave the sheet's present item unanswered.
    Skip,
    Digit(u8),
    /// A letter or a minus sign, which begins a typed answer or the words of a reason.
    Letter(char),
}

impl SheetKey {
    /// Whether the key records the chosen answer to an item, or takes it back.
    fn ends_choice(self) -> bool {
        matches!(self, SheetKey::Confirm | SheetKey::Forward | SheetKey::Undo)
    }
}
