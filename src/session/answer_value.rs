//! The participant's answer to an item of a questionnaire, as logs and the participant's page contain it.

use serde::{Deserialize, Serialize};

/// An answer to an item of a questionnaire; in JSON a number, a text, or a list of texts.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum AnswerValue {
    /// A numeric answer: a point of a rating scale, from 1; the position of a slider, from 0 to 100; or another number.
    Number(i64),
    /// A text answer: the participant's words, or the id of the chosen option.
    Text(String),
    /// The ids of the chosen options of a questionnaire item that allows several.
    Options(Vec<String>),
}

impl AnswerValue {
    /// The answer as a number; `None` if the answer is a text or a list.
    pub fn number(&self) -> Option<i64> {
        match self {
            AnswerValue::Number(number) => Some(*number),
            AnswerValue::Text(_) | AnswerValue::Options(_) => None,
        }
    }

    /// The ids of the chosen options; a text answer counts as a single option.
    pub fn options(&self) -> &[String] {
        match self {
            AnswerValue::Number(_) => &[],
            AnswerValue::Text(option) => std::slice::from_ref(option),
            AnswerValue::Options(options) => options,
        }
    }

    /// The questionnaire answer as one cell of a table: several options are separated by spaces.
    pub fn cell(&self) -> String {
        match self {
            AnswerValue::Number(number) => number.to_string(),
            AnswerValue::Text(text) => text.clone(),
            AnswerValue::Options(options) => options.join(" "),
        }
    }
}

impl From<u8> for AnswerValue {
    fn from(point: u8) -> AnswerValue {
        AnswerValue::Number(i64::from(point))
    }
}
