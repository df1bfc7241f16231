//! Questionnaires: items that participants answer on a rating scale (Likert 1932) or in another format.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::item_form::{AnswerFormat, ItemOption, QuestionnaireItemKind, RatingScale};
use crate::condition::Condition;

/// Largest length of a text answer in characters, unless the item sets another one.
const LENGTH: u32 = 200;

/// A questionnaire of a study, as its file has it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Questionnaire {
    /// Identifier of the questionnaire in the log and in tables.
    pub name: String,
    /// Heading above the questionnaire's items.
    pub title: String,
    /// Language code of the items: "en".
    pub language: String,
    /// How the questionnaire's score is computed from the answers; `None` if the questionnaire has no score.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub score: Option<ScoreRule>,
    /// The rating scale of all items that do not name a rating scale.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub scale: Option<RatingScale>,
    /// Further rating scales of the questionnaire, by name.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub scales: BTreeMap<String, RatingScale>,
    /// The questionnaire's items, in the order in which they are asked.
    #[serde(rename = "item")]
    pub items: Vec<QuestionnaireItem>,
}

/// How a questionnaire's score is computed from its answers. Answers to reversed items are first reversed on their
/// scale. There is no score if an item was left out.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ScoreRule {
    /// Score: mean of the answers, as in the raw task load index of Hart (2006).
    Mean,
    /// Score of the system usability scale of Brooke (1996): ten items of five points; 2.5 times the sum of the points
    /// above the lowest, so from 0 to 100.
    Sus,
}

/// An item of a questionnaire: a statement to be rated, or a question.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct QuestionnaireItem {
    /// Identifier of the item in logs and tables.
    pub id: String,
    /// The statement or question, as the participant reads it.
    pub text: String,
    /// The kind of answer to the questionnaire item; by default a point of a rating scale.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub kind: Option<QuestionnaireItemKind>,
    /// Name of the item's rating scale; by default the scale of all items.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub scale: Option<String>,
    /// The options of an item that is answered by choice.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub options: Vec<ItemOption>,
    /// Whether the participant can choose several options of the item.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub several: bool,
    /// The least number that the participant can answer.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub min: Option<i64>,
    /// The greatest number that the participant can answer.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub max: Option<i64>,
    /// Unit of the number that the participant answers: "years".
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub unit: Option<String>,
    /// Largest length of a text answer, in characters.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub length: Option<u32>,
    /// Label at the slider's left end, position 0.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub low: Option<String>,
    /// Label at the slider's right end, position 100.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub high: Option<String>,
    /// Step of the slider: its positions are multiples of this number.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub step: Option<u8>,
    /// Construct that the questionnaire item measures; items with the same construct form a scale.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub about: Option<String>,
    /// Whether the item is reverse coded: agreement means a low value of the construct.
    #[serde(default)]
    pub reversed: bool,
    /// Conditions of a trial after which the questionnaire item is asked; all conditions by default.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub conditions: Option<Vec<Condition>>,
}

impl Questionnaire {
    /// The questionnaire as asked after a trial in this condition; `None` if no item is asked then.
    pub fn after(&self, condition: Condition) -> Option<Questionnaire> {
        let is_asked =
            |item: &&QuestionnaireItem| item.conditions.as_ref().is_none_or(|only| only.contains(&condition));
        let items: Vec<QuestionnaireItem> = self.items.iter().filter(is_asked).cloned().collect();
        (!items.is_empty()).then(|| Questionnaire { items, ..self.clone() })
    }

    /// The questionnaire as asked before the first trial, without items for certain conditions; `None` if no item is
    /// left.
    pub fn before_trials(&self) -> Option<Questionnaire> {
        let items: Vec<QuestionnaireItem> =
            self.items.iter().filter(|item| item.conditions.is_none()).cloned().collect();
        (!items.is_empty()).then(|| Questionnaire { items, ..self.clone() })
    }

    /// The answer format of the questionnaire item with this index; `None` if there is no such item, or if the item
    /// lacks settings that its kind needs.
    pub fn form(&self, index: usize) -> Option<AnswerFormat<'_>> {
        let item = self.items.get(index)?;
        Some(match item.kind.unwrap_or(QuestionnaireItemKind::Scale) {
            QuestionnaireItemKind::Scale => AnswerFormat::Scale(match &item.scale {
                Some(name) => self.scales.get(name)?,
                None => self.scale.as_ref()?,
            }),
            QuestionnaireItemKind::Choice => AnswerFormat::Choice { options: &item.options, several: item.several },
            QuestionnaireItemKind::Number => {
                AnswerFormat::Number { range: [item.min?, item.max?], unit: item.unit.as_deref().unwrap_or_default() }
            }
            QuestionnaireItemKind::Text => AnswerFormat::Text { length: item.length.unwrap_or(LENGTH) },
            QuestionnaireItemKind::Slider => {
                let step = i64::from(item.step.unwrap_or(1).max(1));
                AnswerFormat::Slider { low: item.low.as_deref()?, high: item.high.as_deref()?, step }
            }
        })
    }

    /// Index of the questionnaire item with this identifier.
    pub fn position(&self, id: &str) -> Option<usize> {
        self.items.iter().position(|item| item.id == id)
    }
}
