//! The item of a questionnaire that the participant answers on the display.

use serde::Serialize;

use super::page_language::DisplayWords;
use crate::session::Session;
use crate::session::answer_value::AnswerValue;
use crate::session::plan::{ItemForm, ItemOption};
use crate::session::wall_display::Answering;

/// An item of a questionnaire that the participant answers.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DisplayedItem {
    /// The heading above the items.
    pub title: String,
    /// The item; nothing: all are answered, and are to be confirmed.
    pub item: Option<String>,
    /// The statement; once all are answered, what to do.
    pub text: String,
    /// Counted from 1.
    pub number: usize,
    /// Number of items.
    pub of: usize,
    /// How the item is answered; nothing when all are.
    pub form: Option<DisplayedForm>,
    /// What was answered before.
    pub answer: Option<AnswerValue>,
    /// The item before, to go back to.
    pub before: Option<String>,
    /// When all are answered: each item and its answer, if it got one.
    pub given: Vec<GivenAnswer>,
}

/// How an item is answered.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum DisplayedForm {
    /// A point of a scale.
    Scale {
        /// Number of points.
        points: u8,
        /// What 1 means.
        low: String,
        /// What the highest point means.
        high: String,
    },
    /// One of the options, or several.
    Choice {
        /// The options in their order.
        options: Vec<ItemOption>,
        /// Whether several can be chosen.
        several: bool,
    },
    /// A whole number.
    Number {
        /// The least number.
        min: i64,
        /// The greatest number.
        max: i64,
        /// What is counted; empty without a unit.
        unit: String,
    },
    /// Words.
    Text {
        /// Most characters.
        length: u32,
    },
    /// No item: consent to the text, by holding a button.
    Consent {
        /// For how long, in seconds.
        hold_s: f64,
    },
    /// A position from 0 to 100.
    Slider {
        /// What 0 means.
        low: String,
        /// What 100 means.
        high: String,
        /// Positions are multiples of it.
        step: i64,
    },
}

/// An item with what the participant answered.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct GivenAnswer {
    /// The statement.
    pub text: String,
    /// The answer in words; none: left out.
    pub answer: Option<String>,
}

impl From<ItemForm<'_>> for DisplayedForm {
    fn from(form: ItemForm) -> DisplayedForm {
        match form {
            ItemForm::Scale(scale) => {
                DisplayedForm::Scale { points: scale.points, low: scale.low.clone(), high: scale.high.clone() }
            }
            ItemForm::Choice { options, several } => DisplayedForm::Choice { options: options.to_vec(), several },
            ItemForm::Number { range: [min, max], unit } => DisplayedForm::Number { min, max, unit: unit.to_string() },
            ItemForm::Text { length } => DisplayedForm::Text { length },
            ItemForm::Slider { low, high, step } => {
                DisplayedForm::Slider { low: low.to_string(), high: high.to_string(), step }
            }
        }
    }
}

/// The item that is to be answered here; nothing where the wizard reads it out.
pub(super) fn question(session: &Session) -> Option<DisplayedItem> {
    if session.spec.display.questionnaire == Answering::Console {
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
    let given = items.map(|(index, item)| GivenAnswer { text: item.text.clone(), answer: in_words(index) });
    Some(DisplayedItem {
        title: questionnaire.title.clone(),
        item: item.map(|item| item.id.clone()),
        text: item.map_or_else(|| words.of_name("answers done"), |item| item.text.clone()),
        number: (protocol.item + 1).min(questionnaire.items.len()),
        of: questionnaire.items.len(),
        form: questionnaire.form(protocol.item).map(DisplayedForm::from),
        answer: protocol.given(protocol.item).cloned(),
        given: given.collect(),
        before: before.map(|item| item.id.clone()),
    })
}
