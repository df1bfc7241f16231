//! How an item of a questionnaire is answered: on a scale, by choice, with a number, in words, or on a slider.

use serde::{Deserialize, Serialize};

use super::questionnaire::{Item, ItemOption, Questionnaire, Scale};
use crate::session::answer_value::AnswerValue;
use crate::session::setting_checks::{SettingError, is_code};

/// Most characters of an answer in words, unless the item says how many.
const LENGTH: u32 = 200;
/// The greatest position of a slider; the least is 0.
pub const SLIDER_END: i64 = 100;
/// Most options of an item: each is a digit.
const MOST_OPTIONS: usize = 9;

/// The kinds of items.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ItemKind {
    /// A point of a scale.
    Scale,
    /// One of the options, or several.
    Choice,
    /// A whole number.
    Number,
    /// Words.
    Text,
    /// A position from 0 to 100.
    Slider,
}

/// How an item is answered, with what belongs to its kind.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ItemForm<'a> {
    /// A point of this scale.
    Scale(&'a Scale),
    /// One of these options, or several.
    Choice {
        /// The options in their order.
        options: &'a [ItemOption],
        /// Whether several can be chosen.
        several: bool,
    },
    /// A whole number.
    Number {
        /// The least and the greatest number.
        range: [i64; 2],
        /// What is counted; empty without a unit.
        unit: &'a str,
    },
    /// Words.
    Text {
        /// Most characters.
        length: u32,
    },
    /// A position from 0 to 100.
    Slider {
        /// What 0 means.
        low: &'a str,
        /// What 100 means.
        high: &'a str,
        /// Positions are multiples of it.
        step: i64,
    },
}

impl ItemKind {
    /// The name in files and tables.
    pub fn name(self) -> &'static str {
        match self {
            ItemKind::Scale => "scale",
            ItemKind::Choice => "choice",
            ItemKind::Number => "number",
            ItemKind::Text => "text",
            ItemKind::Slider => "slider",
        }
    }
}

impl<'a> ItemForm<'a> {
    /// How an item is answered; `None` if it lacks what its kind needs.
    pub fn for_item(questionnaire: &'a Questionnaire, item: &'a Item) -> Option<ItemForm<'a>> {
        Some(match item.kind.unwrap_or(ItemKind::Scale) {
            ItemKind::Scale => ItemForm::Scale(match &item.scale {
                Some(name) => questionnaire.scales.get(name)?,
                None => questionnaire.scale.as_ref()?,
            }),
            ItemKind::Choice => ItemForm::Choice { options: &item.options, several: item.several },
            ItemKind::Number => {
                ItemForm::Number { range: [item.min?, item.max?], unit: item.unit.as_deref().unwrap_or_default() }
            }
            ItemKind::Text => ItemForm::Text { length: item.length.unwrap_or(LENGTH) },
            ItemKind::Slider => {
                let step = i64::from(item.step.unwrap_or(1).max(1));
                ItemForm::Slider { low: item.low.as_deref()?, high: item.high.as_deref()?, step }
            }
        })
    }

    /// The least and the greatest answer of scales and sliders, whose answers can be turned round.
    pub fn ends(&self) -> Option<[i64; 2]> {
        match self {
            ItemForm::Scale(scale) => Some([1, i64::from(scale.points)]),
            ItemForm::Slider { .. } => Some([0, SLIDER_END]),
            _ => None,
        }
    }

    /// Whether the item stays after an answer, which is likely to be changed: the next one follows only when it is asked for.
    pub fn stays(&self) -> bool {
        matches!(self, ItemForm::Choice { several: true, .. } | ItemForm::Slider { .. })
    }

    /// Whether this is an answer to the item.
    ///
    /// # Errors
    /// Why it is none, in words for the wizard.
    pub fn admit(&self, answer: &AnswerValue) -> Result<(), &'static str> {
        let unless = |holds: bool, reason: &'static str| if holds { Ok(()) } else { Err(reason) };
        let is_option = |options: &[ItemOption], id: &String| options.iter().any(|option| option.id == *id);
        match (self, answer) {
            (ItemForm::Scale(scale), AnswerValue::Number(point)) => {
                unless((1..=i64::from(scale.points)).contains(point), "the scale has no such point")
            }
            (ItemForm::Slider { step, .. }, AnswerValue::Number(position)) => {
                unless((0..=SLIDER_END).contains(position), "the slider goes from 0 to 100")?;
                unless(position % step == 0, "the slider has no such position: it goes in steps")
            }
            (ItemForm::Number { range: [least, most], .. }, AnswerValue::Number(number)) => {
                unless((least..=most).contains(&number), "the number is out of the item's range")
            }
            (ItemForm::Text { length }, AnswerValue::Text(text)) => {
                unless(!text.trim().is_empty(), "there are no words in it")?;
                unless(!text.chars().any(char::is_control), "there is a sign in it that is no letter")?;
                unless(text.chars().count() <= *length as usize, "it is longer than the item allows")
            }
            (ItemForm::Choice { options, several: false }, AnswerValue::Text(id)) => {
                unless(is_option(options, id), "the item has no such option")
            }
            (ItemForm::Choice { options, several: true }, AnswerValue::Options(ids)) => {
                unless(ids.iter().all(|id| is_option(options, id)), "the item has no such option")?;
                let twice = |index: usize| ids[..index].contains(&ids[index]);
                unless(!(1..ids.len()).any(twice), "an option is chosen twice")
            }
            _ => Err("the item is answered in another way"),
        }
    }

    /// The answer after this option was chosen, or chosen once more.
    pub fn choose(&self, index: usize, given: Option<&AnswerValue>) -> Option<AnswerValue> {
        let ItemForm::Choice { options, several } = self else { return None };
        let chosen = &options.get(index)?.id;
        if !several {
            return Some(AnswerValue::Text(chosen.clone()));
        }
        let before = given.map_or(&[][..], AnswerValue::options);
        // In the order of the options, whatever the order of choosing.
        let is_chosen = |id: &String| before.contains(id) != (id == chosen);
        let ids = options.iter().map(|option| &option.id).filter(|id| is_chosen(id));
        Some(AnswerValue::Options(ids.cloned().collect()))
    }

    /// The answer as people read it: options by their texts, numbers with their unit.
    pub fn words(&self, answer: &AnswerValue) -> String {
        match (self, answer) {
            (ItemForm::Choice { options, .. }, _) => {
                let ids = answer.options();
                let texts = options.iter().filter(|option| ids.contains(&option.id)).map(|option| option.text.as_str());
                texts.collect::<Vec<_>>().join(", ")
            }
            (ItemForm::Number { unit, .. }, AnswerValue::Number(number)) if !unit.is_empty() => {
                format!("{number} {unit}")
            }
            _ => answer.cell(),
        }
    }
}

/// Checks that items have what their kinds need, and nothing else.
///
/// # Errors
/// The first invalid setting.
pub(super) fn check_items(questionnaire: &Questionnaire) -> Result<(), SettingError> {
    let items = &questionnaire.items;
    for (index, item) in items.iter().enumerate() {
        let wrong = |key: &str, found: String, remedy: &'static str| {
            // Among several settings of one name, those count that the file has.
            let nth = items[..index].iter().filter(|before| has(before, key)).count();
            Err(SettingError { nth, ..SettingError::new(format!("item.{key}"), found, remedy) })
        };
        let kind = item.kind.unwrap_or(ItemKind::Scale);
        if let Some((key, owner)) = OWNED.into_iter().find(|(key, owner)| *owner != kind && has(item, key)) {
            let found = format!("{key} in an item of the kind \"{}\"", kind.name());
            return wrong(key, found, remedy_for(owner));
        }
        let place = if item.kind.is_some() { "kind" } else { "id" };
        let found = format!("kind = \"{}\" in the item \"{}\"", kind.name(), item.id);
        match kind {
            ItemKind::Scale => match &item.scale {
                Some(name) if !questionnaire.scales.contains_key(name) => {
                    return wrong(
                        "scale",
                        format!("scale = \"{name}\""),
                        "the name of a scale: [scales.NAME] in this file",
                    );
                }
                None if questionnaire.scale.is_none() => {
                    let found = format!("the item \"{}\" without a scale", item.id);
                    return wrong(place, found, "a [scale] for all items, or scale = \"NAME\" with [scales.NAME]");
                }
                _ => {}
            },
            ItemKind::Choice => {
                if !(2..=MOST_OPTIONS).contains(&item.options.len()) {
                    let found = format!("{} options in the item \"{}\"", item.options.len(), item.id);
                    let key = if item.options.is_empty() { place } else { "options" };
                    return wrong(key, found, "2 to 9 options, such as { id = \"left\", text = \"left-handed\" }");
                }
                if let Some(option) = item.options.iter().find(|option| !is_code(&option.id)) {
                    let remedy = "a short id of letters, digits, - and _, such as \"left\"";
                    return wrong("options", format!("the option \"{}\"", option.id), remedy);
                }
                let twice = |&index: &usize| item.options[..index].iter().any(|one| one.id == item.options[index].id);
                if let Some(index) = (1..item.options.len()).find(twice) {
                    return wrong(
                        "options",
                        format!("the option \"{}\" twice", item.options[index].id),
                        "each option once",
                    );
                }
            }
            ItemKind::Number => match (item.min, item.max) {
                (Some(min), Some(max)) if min < max => {}
                (Some(min), Some(max)) => {
                    return wrong(
                        "max",
                        format!("max = {max}, with min = {min}"),
                        "a greatest number above the least one",
                    );
                }
                _ => {
                    return wrong(
                        place,
                        format!("{found} without min or max"),
                        "the least and the greatest number: min, max",
                    );
                }
            },
            ItemKind::Slider => {
                if item.low.is_none() || item.high.is_none() {
                    return wrong(place, format!("{found} without low or high"), "what 0 and 100 mean: low, high");
                }
                if let Some(step) = item.step.filter(|&step| step == 0 || SLIDER_END % i64::from(step) != 0) {
                    return wrong("step", format!("step = {step}"), "a number that divides 100, such as 5");
                }
            }
            ItemKind::Text => {}
        }
    }
    Ok(())
}

/// The settings of one kind of items, with that kind.
const OWNED: [(&str, ItemKind); 10] = [
    ("scale", ItemKind::Scale),
    ("options", ItemKind::Choice),
    ("several", ItemKind::Choice),
    ("min", ItemKind::Number),
    ("max", ItemKind::Number),
    ("unit", ItemKind::Number),
    ("length", ItemKind::Text),
    ("low", ItemKind::Slider),
    ("high", ItemKind::Slider),
    ("step", ItemKind::Slider),
];

fn remedy_for(owner: ItemKind) -> &'static str {
    match owner {
        ItemKind::Scale => "it belongs to items of the kind \"scale\"",
        ItemKind::Choice => "it belongs to items of kind = \"choice\"",
        ItemKind::Number => "it belongs to items of kind = \"number\"",
        ItemKind::Text => "it belongs to items of kind = \"text\"",
        ItemKind::Slider => "it belongs to items of kind = \"slider\"",
    }
}

/// Whether the file has this setting in the item.
fn has(item: &Item, key: &str) -> bool {
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
