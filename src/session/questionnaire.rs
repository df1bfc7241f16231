//! Questionnaires: items that participants answer on a rating scale (Likert 1932) or in another format.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::ranges;
use crate::settings::{Condition, SettingError, is_code};

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

/// Largest number of answer options of a questionnaire item: each option is chosen by a digit key.
const MOST_OPTIONS: usize = 9;

impl Questionnaire {
    /// Checks ranges and consistency of the questionnaire's settings.
    ///
    /// # Errors
    /// An error names the first invalid setting.
    pub fn check(&self) -> Result<(), SettingError> {
        let wrong = |key: &str, found, remedy| Err(SettingError::new(key, found, remedy));
        if !is_code(&self.name) {
            let remedy = "a short name of letters, digits, - and _, such as \"acceptance\"";
            return wrong("name", format!("name = \"{}\"", self.name), remedy);
        }
        ranges::check_questionnaire(self)?;
        if self.items.is_empty() {
            return wrong("item", "a questionnaire without items".to_string(), "at least one [[item]]");
        }
        self.check_ids()?;
        for (index, item) in self.items.iter().enumerate() {
            self.check_item(item).map_err(|(key, found, remedy)| {
                // Index of the invalid setting among items that have this setting in the file.
                let nth = self.items[..index].iter().filter(|before| has(before, key)).count();
                SettingError { nth, ..SettingError::new(format!("item.{key}"), found, remedy) }
            })?;
        }
        self.check_score()
    }

    fn check_ids(&self) -> Result<(), SettingError> {
        let wrong = |nth, found, remedy| Err(SettingError { nth, ..SettingError::new("item.id", found, remedy) });
        if let Some(nth) = self.items.iter().position(|item| !is_code(&item.id)) {
            let remedy = "a short id of letters, digits, - and _, such as \"too_often\"";
            return wrong(nth, format!("id = \"{}\"", self.items[nth].id), remedy);
        }
        let is_twice = |&nth: &usize| self.items[..nth].iter().any(|item| item.id == self.items[nth].id);
        match (1..self.items.len()).find(is_twice) {
            Some(nth) => wrong(nth, format!("the id \"{}\" twice", self.items[nth].id), "each id once"),
            None => Ok(()),
        }
    }

    /// Checks that a questionnaire item has the settings that its kind needs, and no others.
    fn check_item(&self, item: &QuestionnaireItem) -> Result<(), WrongItem> {
        let kind = item.kind.unwrap_or(QuestionnaireItemKind::Scale);
        if let Some((key, owner)) = OWNED.into_iter().find(|(key, owner)| *owner != kind && has(item, key)) {
            return Err((key, format!("{key} in an item of the kind \"{}\"", kind.name()), remedy_for(owner)));
        }
        // Key of the line that the error message names if a setting is missing.
        let line = if item.kind.is_some() { "kind" } else { "id" };
        let found = format!("kind = \"{}\" in the item \"{}\"", kind.name(), item.id);
        match kind {
            QuestionnaireItemKind::Scale => match &item.scale {
                Some(name) if !self.scales.contains_key(name) => {
                    let remedy = "the name of a scale: [scales.NAME] in this file";
                    Err(("scale", format!("scale = \"{name}\""), remedy))
                }
                None if self.scale.is_none() => {
                    let remedy = "a [scale] for all items, or scale = \"NAME\" with [scales.NAME]";
                    Err((line, format!("the item \"{}\" without a scale", item.id), remedy))
                }
                _ => Ok(()),
            },
            QuestionnaireItemKind::Choice => check_options(item, line),
            QuestionnaireItemKind::Number => match (item.min, item.max) {
                (Some(min), Some(max)) if min < max => Ok(()),
                (Some(min), Some(max)) => {
                    Err(("max", format!("max = {max}, with min = {min}"), "a greatest number above the least one"))
                }
                _ => Err((line, format!("{found} without min or max"), "the least and the greatest number: min, max")),
            },
            QuestionnaireItemKind::Slider if item.low.is_none() || item.high.is_none() => {
                Err((line, format!("{found} without low or high"), "what 0 and 100 mean: low, high"))
            }
            QuestionnaireItemKind::Slider => {
                match item.step.filter(|&step| step == 0 || SLIDER_END % i64::from(step) != 0) {
                    Some(step) => Err(("step", format!("step = {step}"), "a number that divides 100, such as 5")),
                    None => Ok(()),
                }
            }
            QuestionnaireItemKind::Text => Ok(()),
        }
    }

    fn check_score(&self) -> Result<(), SettingError> {
        let wrong = |found: String, remedy| Err(SettingError::new("score", found, remedy));
        let forms = || (0..self.items.len()).map(|index| self.form(index));
        let rated = forms().filter(|form| form.is_some_and(|form| form.ends().is_some())).count();
        match self.score {
            Some(ScoreRule::Mean) if rated < self.items.len() => {
                let found = format!("score = \"mean\", with {} items that are no scale", self.items.len() - rated);
                wrong(found, "items on scales or sliders alone")
            }
            Some(ScoreRule::Sus) => {
                let is_five =
                    |form: Option<AnswerFormat>| matches!(form, Some(AnswerFormat::Scale(scale)) if scale.points == 5);
                match (self.items.len(), forms().all(is_five)) {
                    (10, true) => Ok(()),
                    (items, _) => {
                        wrong(format!("score = \"sus\", with {items} items"), "ten items on a scale of 5 points")
                    }
                }
            }
            _ => Ok(()),
        }
    }
}

/// Error in a questionnaire item: the setting, what was found, and what would be right.
type WrongItem = (&'static str, String, &'static str);

fn check_options(item: &QuestionnaireItem, line: &'static str) -> Result<(), WrongItem> {
    let options: &[ItemOption] = &item.options;
    if !(2..=MOST_OPTIONS).contains(&options.len()) {
        let found = format!("{} options in the item \"{}\"", options.len(), item.id);
        let key = if options.is_empty() { line } else { "options" };
        return Err((key, found, "2 to 9 options, such as { id = \"left\", text = \"left-handed\" }"));
    }
    if let Some(option) = options.iter().find(|option| !is_code(&option.id)) {
        let remedy = "a short id of letters, digits, - and _, such as \"left\"";
        return Err(("options", format!("the option \"{}\"", option.id), remedy));
    }
    let is_twice = |&index: &usize| options[..index].iter().any(|one| one.id == options[index].id);
    match (1..options.len()).find(is_twice) {
        Some(index) => Err(("options", format!("the option \"{}\" twice", options[index].id), "each option once")),
        None => Ok(()),
    }
}

/// The settings that only one kind of questionnaire item can have, each with that kind.
const OWNED: [(&str, QuestionnaireItemKind); 10] = [
    ("scale", QuestionnaireItemKind::Scale),
    ("options", QuestionnaireItemKind::Choice),
    ("several", QuestionnaireItemKind::Choice),
    ("min", QuestionnaireItemKind::Number),
    ("max", QuestionnaireItemKind::Number),
    ("unit", QuestionnaireItemKind::Number),
    ("length", QuestionnaireItemKind::Text),
    ("low", QuestionnaireItemKind::Slider),
    ("high", QuestionnaireItemKind::Slider),
    ("step", QuestionnaireItemKind::Slider),
];

fn remedy_for(owner: QuestionnaireItemKind) -> &'static str {
    match owner {
        QuestionnaireItemKind::Scale => "it belongs to items of the kind \"scale\"",
        QuestionnaireItemKind::Choice => "it belongs to items of kind = \"choice\"",
        QuestionnaireItemKind::Number => "it belongs to items of kind = \"number\"",
        QuestionnaireItemKind::Text => "it belongs to items of kind = \"text\"",
        QuestionnaireItemKind::Slider => "it belongs to items of kind = \"slider\"",
    }
}

/// Whether the questionnaire item has this setting in the file.
fn has(item: &QuestionnaireItem, key: &str) -> bool {
    match key {
        "kind" => item.kind.is_some(),
        "scale" => item.scale.is_some(),
        "options" => !item.options.is_empty(),
        "several" => item.several,
        "min" => item.min.is_some(),
        "max" => item.max.is_some(),
        "unit" => item.unit.is_some(),
        "length" => item.length.is_some(),
        "low" => item.low.is_some(),
        "high" => item.high.is_some(),
        "step" => item.step.is_some(),
        _ => true,
    }
}

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
