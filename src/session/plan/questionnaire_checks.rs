//! Checks of a questionnaire file for valid and consistent settings.

use super::item_form::{AnswerFormat, ItemOption, QuestionnaireItemKind, SLIDER_END};
use super::questionnaire::{Questionnaire, QuestionnaireItem, ScoreRule};
use crate::ranges;
use crate::setting_checks::{SettingError, is_code};

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
