//! Questionnaires: items that are answered on a rating scale (Likert 1932).

use serde::{Deserialize, Serialize};

use crate::session::condition::Condition;
use crate::session::ranges;
use crate::session::setting_checks::{SettingError, is_code};

/// A questionnaire file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Questionnaire {
    /// Stands for the questionnaire in the log and in tables.
    pub name: String,
    /// Heading above the items.
    pub title: String,
    /// The language of the items, as in "en".
    pub language: String,
    /// The scale of all items.
    pub scale: Scale,
    /// The items, in the order in which they are asked.
    #[serde(rename = "item")]
    pub items: Vec<Item>,
}

/// The scale: 1 to `points`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Scale {
    /// Number of points.
    pub points: u8,
    /// What 1 means.
    pub low: String,
    /// What the highest point means.
    pub high: String,
}

/// A statement to be rated.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Item {
    /// Identifier of the item in logs and tables.
    pub id: String,
    /// The statement, as the participant reads it.
    pub text: String,
    /// Construct that the item measures; items with the same construct form a scale.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub about: Option<String>,
    /// Whether the item is reverse coded.
    #[serde(default)]
    pub reversed: bool,
    /// Conditions after which the item is asked; all by default.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub conditions: Option<Vec<Condition>>,
}

impl Questionnaire {
    /// The questionnaire after a trial in this condition; `None` if it has no items.
    pub fn after(&self, condition: Condition) -> Option<Questionnaire> {
        let is_asked = |item: &&Item| item.conditions.as_ref().is_none_or(|only| only.contains(&condition));
        let items: Vec<Item> = self.items.iter().filter(is_asked).cloned().collect();
        (!items.is_empty()).then(|| Questionnaire { items, ..self.clone() })
    }

    /// Index of an item.
    pub fn position(&self, id: &str) -> Option<usize> {
        self.items.iter().position(|item| item.id == id)
    }

    /// Checks ranges and consistency.
    ///
    /// # Errors
    /// The first invalid setting.
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
        let wrong_id = |nth, found, remedy| Err(SettingError { nth, ..SettingError::new("item.id", found, remedy) });
        if let Some(nth) = self.items.iter().position(|item| !is_code(&item.id)) {
            let remedy = "a short id of letters, digits, - and _, such as \"too_often\"";
            return wrong_id(nth, format!("id = \"{}\"", self.items[nth].id), remedy);
        }
        match (1..self.items.len()).find(|&nth| self.items[..nth].iter().any(|item| item.id == self.items[nth].id)) {
            Some(nth) => wrong_id(nth, format!("the id \"{}\" twice", self.items[nth].id), "each id once"),
            None => Ok(()),
        }
    }
}
