//! Answer formats of questionnaire items: a scale, a choice, a number, words, or a slider.

use serde::{Deserialize, Serialize};

use crate::answer_value::AnswerValue;

/// The greatest position of a slider in a questionnaire; the least is 0.
pub const SLIDER_END: i64 = 100;

/// The kinds of questionnaire items, by their answers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum QuestionnaireItemKind {
    /// Questionnaire item whose answer is a point of a rating scale.
    Scale,
    /// Questionnaire item whose answer is one of its options, or several.
    Choice,
    /// Questionnaire item whose answer is a whole number.
    Number,
    /// Questionnaire item whose answer is a text.
    Text,
    /// Questionnaire item whose answer is a slider's position from 0 to 100.
    Slider,
}

/// A rating scale of a questionnaire, with points from 1 to `points`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RatingScale {
    /// Number of points of the rating scale.
    pub points: u8,
    /// Label of the scale's lowest point, 1.
    pub low: String,
    /// Label of the scale's highest point.
    pub high: String,
}

/// An answer option of a questionnaire item.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ItemOption {
    /// Identifier of the option in logs and tables, the same in all languages.
    pub id: String,
    /// Text of the answer option, as the participant reads it.
    pub text: String,
}

/// The answer format of a questionnaire item, with the settings of its kind.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum AnswerFormat<'a> {
    /// The answer is a point of this rating scale.
    Scale(&'a RatingScale),
    /// The answer is one of these options, or several.
    Choice {
        /// The answer options in their order on the page.
        options: &'a [ItemOption],
        /// Whether the participant can choose several options.
        several: bool,
    },
    /// The answer is a whole number.
    Number {
        /// The least and the greatest number that the answer can be.
        range: [i64; 2],
        /// The unit of the answered number; empty if the number has no unit.
        unit: &'a str,
    },
    /// The answer is a text.
    Text {
        /// Largest length of the answered text, in characters.
        length: u32,
    },
    /// The answer is a slider's position from 0 to 100.
    Slider {
        /// Label of the slider's position 0.
        low: &'a str,
        /// Label of the slider's position 100.
        high: &'a str,
        /// Slider positions are multiples of this number.
        step: i64,
    },
}

impl QuestionnaireItemKind {
    /// Name of the kind of questionnaire item in files and tables.
    pub fn name(self) -> &'static str {
        match self {
            QuestionnaireItemKind::Scale => "scale",
            QuestionnaireItemKind::Choice => "choice",
            QuestionnaireItemKind::Number => "number",
            QuestionnaireItemKind::Text => "text",
            QuestionnaireItemKind::Slider => "slider",
        }
    }
}

impl<'a> AnswerFormat<'a> {
    /// The least and the greatest answer on a rating scale or slider, needed to reverse an answer; `None` for other
    /// kinds.
    pub fn ends(&self) -> Option<[i64; 2]> {
        match self {
            AnswerFormat::Scale(scale) => Some([1, i64::from(scale.points)]),
            AnswerFormat::Slider { .. } => Some([0, SLIDER_END]),
            _ => None,
        }
    }

    /// Whether the questionnaire item stays on the page after an answer, because participants are likely to change the
    /// answer; the next item then follows only on request.
    pub fn stays(&self) -> bool {
        matches!(self, AnswerFormat::Choice { several: true, .. } | AnswerFormat::Slider { .. })
    }

    /// Whether a value is a valid answer to the questionnaire item.
    ///
    /// # Errors
    /// Why the answer is invalid, in words for the wizard.
    pub fn admit(&self, answer: &AnswerValue) -> Result<(), &'static str> {
        let unless = |holds: bool, reason: &'static str| if holds { Ok(()) } else { Err(reason) };
        let is_option = |options: &[ItemOption], id: &String| options.iter().any(|option| option.id == *id);
        match (self, answer) {
            (AnswerFormat::Scale(scale), AnswerValue::Number(point)) => {
                unless((1..=i64::from(scale.points)).contains(point), "the scale has no such point")
            }
            (AnswerFormat::Slider { step, .. }, AnswerValue::Number(position)) => {
                unless((0..=SLIDER_END).contains(position), "the slider goes from 0 to 100")?;
                unless(position % step == 0, "the slider has no such position: it goes in steps")
            }
            (AnswerFormat::Number { range: [least, most], .. }, AnswerValue::Number(number)) => {
                unless((least..=most).contains(&number), "the number is out of the item's range")
            }
            (AnswerFormat::Text { length }, AnswerValue::Text(text)) => {
                unless(!text.trim().is_empty(), "the answer has no words")?;
                unless(!text.chars().any(char::is_control), "the answer has a sign that cannot be typed")?;
                unless(text.chars().count() <= *length as usize, "the answer is longer than the item allows")
            }
            (AnswerFormat::Choice { options, several: false }, AnswerValue::Text(id)) => {
                unless(is_option(options, id), "the item has no option with this name")
            }
            (AnswerFormat::Choice { options, several: true }, AnswerValue::Options(ids)) => {
                unless(ids.iter().all(|id| is_option(options, id)), "the item has no option with this name")?;
                let twice = |index: usize| ids[..index].contains(&ids[index]);
                unless(!(1..ids.len()).any(twice), "the answer has an option twice")
            }
            _ => Err("the item takes answers of another kind"),
        }
    }

    /// The item's answer after the participant selects the option with this index, or deselects it.
    pub fn choose(&self, index: usize, given: Option<&AnswerValue>) -> Option<AnswerValue> {
        let AnswerFormat::Choice { options, several } = self else { return None };
        let chosen = &options.get(index)?.id;
        if !several {
            return Some(AnswerValue::Text(chosen.clone()));
        }
        let before = given.map_or(&[][..], AnswerValue::options);
        // The chosen ids keep the order of the item's options, whatever the order in which they were chosen.
        let is_chosen = |id: &String| before.contains(id) != (id == chosen);
        let ids = options.iter().map(|option| &option.id).filter(|id| is_chosen(id));
        Some(AnswerValue::Options(ids.cloned().collect()))
    }

    /// The questionnaire answer in words: options by their texts, numbers with their unit.
    pub fn words(&self, answer: &AnswerValue) -> String {
        match (self, answer) {
            (AnswerFormat::Choice { options, .. }, _) => {
                let ids = answer.options();
                let texts = options.iter().filter(|option| ids.contains(&option.id)).map(|option| option.text.as_str());
                texts.collect::<Vec<_>>().join(", ")
            }
            (AnswerFormat::Number { unit, .. }, AnswerValue::Number(number)) if !unit.is_empty() => {
                format!("{number} {unit}")
            }
            _ => answer.cell(),
        }
    }
}
