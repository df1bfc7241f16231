//! The questionnaire item that the participant answers on the display.

use serde::Serialize;

use super::page_language::DisplayWords;
use tomcom_core::kitchen::{Agent, ButtonAction, Kitchen};
use tomcom_session::Session;
use tomcom_session::plan::{AnswerFormat, ItemOption};
use tomcom_session::protocol::ItemAnswer;
use tomcom_session::questionnaire::AnswerValue;
use tomcom_session::wall_display::AnswerDevice;

/// A questionnaire item as the participant's display shows it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DisplayedQuestionnaireItem {
    pub title: String,
    /// Name of the item; `None` when all items are answered and the participant only has to confirm the answers.
    pub item: Option<String>,
    /// Statement of the item; once all items are answered, an instruction to confirm the answers.
    pub text: String,
    /// Number of the item, counted from 1.
    pub number: usize,
    pub of: usize,
    /// Kind of answer that the item takes; `None` when all items are answered.
    pub form: Option<DisplayedAnswerForm>,
    pub answer: Option<AnswerValue>,
    /// Whether the participant left the item out.
    pub skipped: bool,
    pub before: Option<String>,
    /// When all items are answered: each item with its answer, if it got one.
    pub given: Vec<DisplayedAnswer>,
}

/// Kind of answer that a questionnaire item takes.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum DisplayedAnswerForm {
    Scale {
        points: u8,
        /// Meaning of the scale's first point.
        low: String,
        /// Meaning of the scale's highest point.
        high: String,
    },
    /// One or several options of a list.
    Choice {
        /// Options from which to choose, in their order.
        options: Vec<ItemOption>,
        several: bool,
    },
    /// A whole number that the participant enters.
    Number {
        /// Least number that may be entered.
        min: i64,
        /// Greatest number that may be entered.
        max: i64,
        /// Unit of the number; empty if the number has no unit.
        unit: String,
    },
    /// Text that the participant writes.
    Text {
        /// Largest number of characters of the text.
        length: u32,
    },
    /// No answer to a questionnaire item, but consent to a text, given by holding a button.
    Consent {
        /// Time for which the button has to be held, in seconds.
        hold_s: f64,
    },
    /// A position on a slider from 0 to 100.
    Slider {
        /// Meaning of the slider's position 0.
        low: String,
        /// Meaning of the slider's position 100.
        high: String,
        /// Step of the slider: positions are multiples of it.
        step: i64,
    },
}

/// A questionnaire item with the participant's answer.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DisplayedAnswer {
    /// Name of the item, to which a touch goes back.
    pub item: String,
    pub text: String,
    /// The answer in words; `None` if the participant left the item out.
    pub answer: Option<String>,
    /// Kind of answer that the item takes, and the answer: a point of a scale or slider is shown as it was given.
    pub form: Option<DisplayedAnswerForm>,
    pub point: Option<i64>,
}

impl From<AnswerFormat<'_>> for DisplayedAnswerForm {
    fn from(form: AnswerFormat) -> DisplayedAnswerForm {
        match form {
            AnswerFormat::Scale(scale) => {
                DisplayedAnswerForm::Scale { points: scale.points, low: scale.low.clone(), high: scale.high.clone() }
            }
            AnswerFormat::Choice { options, several } => {
                DisplayedAnswerForm::Choice { options: options.to_vec(), several }
            }
            AnswerFormat::Number { range: [min, max], unit } => {
                DisplayedAnswerForm::Number { min, max, unit: unit.to_string() }
            }
            AnswerFormat::Text { length } => DisplayedAnswerForm::Text { length },
            AnswerFormat::Slider { low, high, step } => {
                DisplayedAnswerForm::Slider { low: low.to_string(), high: high.to_string(), step }
            }
        }
    }
}

/// The item that the participant has to answer on the display now; `None` also where the wizard reads the items to the
/// participant.
pub(super) fn question(session: &Session) -> Option<DisplayedQuestionnaireItem> {
    if session.spec.display.questionnaire == AnswerDevice::Console {
        return None;
    }
    let (questionnaire, protocol) = (session.questionnaire()?, session.protocol.as_ref()?);
    if protocol.confirmed {
        return None;
    }
    let words = DisplayWords::for_display(&session.spec.display);
    let item = questionnaire.items.get(protocol.item);
    let before = protocol.item.checked_sub(1).and_then(|before| questionnaire.items.get(before));
    let in_words = |index: usize| Some(questionnaire.form(index)?.words(protocol.given(index)?));
    let items = questionnaire.items.iter().enumerate().filter(|_| item.is_none());
    let given = items.map(|(index, item)| DisplayedAnswer {
        item: item.id.clone(),
        text: item.text.clone(),
        answer: in_words(index),
        form: questionnaire.form(index).map(DisplayedAnswerForm::from),
        point: protocol.given(index).and_then(AnswerValue::number),
    });
    Some(DisplayedQuestionnaireItem {
        title: questionnaire.title.clone(),
        item: item.map(|item| item.id.clone()),
        text: item.map_or_else(|| words.of_name("answers done"), |item| item.text.clone()),
        number: (protocol.item + 1).min(questionnaire.items.len()),
        of: questionnaire.items.len(),
        form: questionnaire.form(protocol.item).map(DisplayedAnswerForm::from),
        answer: protocol.given(protocol.item).cloned(),
        skipped: protocol.answers.get(protocol.item).is_some_and(|one| matches!(one, Some(ItemAnswer::Skipped))),
        given: given.collect(),
        before: before.map(|item| item.id.clone()),
    })
}

/// A location or a storage on the participant's display, by its index in the scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum SceneElement {
    /// A location, by its index in the scene.
    Location(usize),
    /// A storage, by its index in the scene.
    Storage(usize),
}

/// The location or storage where a press of an agent happens.
pub(super) fn spot(kitchen: &Kitchen, agent: Agent, action: ButtonAction) -> SceneElement {
    let hand = kitchen.hands[agent.index()];
    let location = match action {
        ButtonAction::Take(item) => {
            let is_it =
                |storage: &tomcom_core::kitchen::IngredientStorage| storage.agent == agent && storage.item == item;
            // Every button that takes an item belongs to a storage (`src/core/kitchen/compile/buttons.rs`).
            match kitchen.storages.iter().position(is_it) {
                Some(storage) => return SceneElement::Storage(storage),
                None => hand,
            }
        }
        ButtonAction::Use(location) => location,
        ButtonAction::Process(process) => kitchen.processes[usize::from(process)].place.unwrap_or(hand),
        ButtonAction::Trash => hand,
        ButtonAction::Serve(order) => order,
    };
    SceneElement::Location(location.index())
}
