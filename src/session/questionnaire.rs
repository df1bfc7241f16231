//! Questionnaires: items that participants answer on a rating scale (Likert 1932) or in another format, and the
//! answers.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::admit::unless;
use crate::ranges;
use crate::settings::{Condition, SettingError, is_code};

/// Each option is chosen by a digit key.
const MOST_OPTIONS: usize = 9;
/// Largest length of a text answer, unless the item sets another one.
const LENGTH: u32 = 200;

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Questionnaire {
    /// In the log and in tables.
    pub name: String,
    pub title: String,
    /// Language code: "en".
    pub language: String,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub score: Option<ScoreRule>,
    /// Of all items that name none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub scale: Option<RatingScale>,
    /// Further rating scales, by name.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub scales: BTreeMap<String, RatingScale>,
    #[serde(rename = "item")]
    pub items: Vec<QuestionnaireItem>,
}

/// Answers to reversed items are first reversed on their scale. There is no score if an item was left out.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ScoreRule {
    /// As in the raw task load index of Hart (2006).
    Mean,
    /// System usability scale of Brooke (1996): ten items of five points; 2.5 times the sum of the points above the
    /// lowest, so from 0 to 100.
    Sus,
}

/// A statement to be rated, or a question.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct QuestionnaireItem {
    /// In logs and tables.
    pub id: String,
    pub text: String,
    /// By default a point of a rating scale.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub kind: Option<QuestionnaireItemKind>,
    /// Name of its rating scale; by default that of all items.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub scale: Option<String>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub options: Vec<ItemOption>,
    /// Whether several options can be chosen.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub several: bool,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub min: Option<i64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub max: Option<i64>,
    /// Of the number: "years".
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub unit: Option<String>,
    /// Largest length of a text, in characters.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub length: Option<u32>,
    /// Label at the slider's position 0.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub low: Option<String>,
    /// Label at the slider's position 100.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub high: Option<String>,
    /// The slider's positions are multiples of this.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub step: Option<u8>,
    /// Construct that the item measures; items with the same construct form a scale.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub about: Option<String>,
    /// Agreement means a low value of the construct.
    #[serde(default)]
    pub reversed: bool,
    /// Conditions of a trial after which it is asked; by default all.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub conditions: Option<Vec<Condition>>,
}

impl Questionnaire {
    /// As asked after a trial in this condition; `None` if no item is.
    pub fn after(&self, condition: Condition) -> Option<Questionnaire> {
        self.with(|item| item.conditions.as_ref().is_none_or(|only| only.contains(&condition)))
    }

    /// Without items for certain conditions; `None` if no item is left.
    pub(crate) fn before_trials(&self) -> Option<Questionnaire> {
        self.with(|item| item.conditions.is_none())
    }

    fn with(&self, is_asked: impl Fn(&QuestionnaireItem) -> bool) -> Option<Questionnaire> {
        let items: Vec<QuestionnaireItem> = self.items.iter().filter(|item| is_asked(item)).cloned().collect();
        (!items.is_empty()).then(|| Questionnaire { items, ..self.clone() })
    }

    /// `None` if there is no such item, or if it lacks settings that its kind needs.
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

    pub fn position(&self, id: &str) -> Option<usize> {
        self.items.iter().position(|item| item.id == id)
    }

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

    /// An item has the settings that its kind needs, and no others.
    fn check_item(&self, item: &QuestionnaireItem) -> Result<(), WrongItem> {
        let kind = item.kind.unwrap_or(QuestionnaireItemKind::Scale);
        let is_foreign = |(_, owner, is_there): &OwnedSetting| *owner != kind && is_there(item);
        if let Some((key, owner, _)) = OWNED.into_iter().find(is_foreign) {
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

/// The setting, what was found, and what would be right.
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
    if let Some(option) = options.iter().find(|option| option.alone && !item.several) {
        let remedy = "alone in items with several = true: else every option stands alone";
        return Err(("options", format!("alone in the option \"{}\"", option.id), remedy));
    }
    let is_twice = |&index: &usize| options[..index].iter().any(|one| one.id == options[index].id);
    match (1..options.len()).find(is_twice) {
        Some(index) => Err(("options", format!("the option \"{}\" twice", options[index].id), "each option once")),
        None => Ok(()),
    }
}

/// A setting, the only kind of item that can have it, and whether an item has it in the file.
type OwnedSetting = (&'static str, QuestionnaireItemKind, fn(&QuestionnaireItem) -> bool);

const OWNED: [OwnedSetting; 10] = [
    ("scale", QuestionnaireItemKind::Scale, |item| item.scale.is_some()),
    ("options", QuestionnaireItemKind::Choice, |item| !item.options.is_empty()),
    ("several", QuestionnaireItemKind::Choice, |item| item.several),
    ("min", QuestionnaireItemKind::Number, |item| item.min.is_some()),
    ("max", QuestionnaireItemKind::Number, |item| item.max.is_some()),
    ("unit", QuestionnaireItemKind::Number, |item| item.unit.is_some()),
    ("length", QuestionnaireItemKind::Text, |item| item.length.is_some()),
    ("low", QuestionnaireItemKind::Slider, |item| item.low.is_some()),
    ("high", QuestionnaireItemKind::Slider, |item| item.high.is_some()),
    ("step", QuestionnaireItemKind::Slider, |item| item.step.is_some()),
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

/// Whether the item has this setting in the file; every item has an id.
fn has(item: &QuestionnaireItem, key: &str) -> bool {
    match OWNED.into_iter().find(|(owned, ..)| *owned == key) {
        Some((.., is_there)) => is_there(item),
        None => key == "id" || item.kind.is_some(),
    }
}

/// The greatest position of a slider; the least is 0.
pub const SLIDER_END: i64 = 100;

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, strum::IntoStaticStr)]
#[serde(rename_all = "snake_case")]
#[strum(serialize_all = "snake_case")]
pub enum QuestionnaireItemKind {
    Scale,
    Choice,
    Number,
    Text,
    Slider,
}

/// Its points are 1 to `points`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RatingScale {
    pub points: u8,
    /// Label of the lowest point.
    pub low: String,
    /// Label of the highest point.
    pub high: String,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ItemOption {
    /// In logs and tables, the same in all languages.
    pub id: String,
    pub text: String,
    /// Whether no other option can be chosen beside it, where several can: "nothing", "none of these".
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub alone: bool,
}

/// With the settings of the item's kind.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum AnswerFormat<'a> {
    Scale(&'a RatingScale),
    Choice {
        options: &'a [ItemOption],
        several: bool,
    },
    Number {
        /// Least and greatest.
        range: [i64; 2],
        /// Empty if there is none.
        unit: &'a str,
    },
    Text {
        /// Largest, in characters.
        length: u32,
    },
    Slider {
        low: &'a str,
        high: &'a str,
        /// Positions are multiples of this.
        step: i64,
    },
}

named!(QuestionnaireItemKind);

impl<'a> AnswerFormat<'a> {
    /// Least and greatest answer on a rating scale or slider, to reverse an answer.
    pub fn ends(&self) -> Option<[i64; 2]> {
        match self {
            AnswerFormat::Scale(scale) => Some([1, i64::from(scale.points)]),
            AnswerFormat::Slider { .. } => Some([0, SLIDER_END]),
            _ => None,
        }
    }

    /// Whether the item stays on the page after an answer, because participants are likely to change it; the next one
    /// then follows only on request.
    pub fn stays(&self) -> bool {
        matches!(self, AnswerFormat::Choice { several: true, .. } | AnswerFormat::Slider { .. })
    }

    pub fn admit(&self, answer: &AnswerValue) -> Result<(), &'static str> {
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
                unless(!(1..ids.len()).any(twice), "the answer has an option twice")?;
                let is_alone = |option: &ItemOption| option.alone && ids.contains(&option.id);
                unless(ids.len() < 2 || !options.iter().any(is_alone), "the answer has an option that stands alone")
            }
            _ => Err("the item takes answers of another kind"),
        }
    }

    /// The answer after the participant selects, or deselects, the option with this index.
    pub fn choose(&self, index: usize, given: Option<&AnswerValue>) -> Option<AnswerValue> {
        let AnswerFormat::Choice { options, several } = self else { return None };
        let chosen = &options.get(index)?.id;
        if !several {
            return Some(AnswerValue::Text(chosen.clone()));
        }
        let before = given.map_or(&[][..], AnswerValue::options);
        let is_taken_back = before.contains(chosen);
        // The chosen ids keep the order of the item's options, whatever the order in which they were chosen.
        let stays = |option: &ItemOption| {
            before.contains(&option.id) && (is_taken_back || !(option.alone || options[index].alone))
        };
        let is_chosen = |option: &&ItemOption| stays(option) != (option.id == *chosen);
        Some(AnswerValue::Options(options.iter().filter(is_chosen).map(|option| option.id.clone()).collect()))
    }

    /// Options by their texts, numbers with their unit.
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

/// The participant's answer to an item, as logs and the participant's page contain it; in JSON a number, a text, or a
/// list of texts.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum AnswerValue {
    /// A point of a rating scale, from 1; the position of a slider, from 0 to 100; or another number.
    Number(i64),
    /// The participant's words, or the id of the chosen option.
    Text(String),
    /// The ids of the chosen options, where several can be chosen.
    Options(Vec<String>),
}

impl AnswerValue {
    pub fn number(&self) -> Option<i64> {
        match self {
            AnswerValue::Number(number) => Some(*number),
            AnswerValue::Text(_) | AnswerValue::Options(_) => None,
        }
    }

    /// A text answer counts as a single option.
    pub fn options(&self) -> &[String] {
        match self {
            AnswerValue::Number(_) => &[],
            AnswerValue::Text(option) => std::slice::from_ref(option),
            AnswerValue::Options(options) => options,
        }
    }

    /// Of a table: several options are separated by spaces.
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
