//! Labels of participants, sessions and tasks: letters and digits only, and no two alike.

use std::collections::{BTreeMap, BTreeSet};

use crate::session::plan::StepSpec;

/// What is left of a name in a label.
pub fn letters_and_digits(name: &str) -> String {
    let kept: String = name.chars().filter(char::is_ascii_alphanumeric).collect();
    if kept.is_empty() { "x".to_string() } else { kept }
}

/// The labels of names. Labels that differ only in capitals count as alike, since they would be one folder on some disks.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Labels(BTreeMap<String, String>);

impl Labels {
    /// The labels of these names: the name itself where it is one, otherwise its letters and digits. Where another name has that label,
    /// `x2`, `x3` and so on follow.
    pub fn from_names<'a>(names: impl IntoIterator<Item = &'a str>) -> Labels {
        let all: BTreeSet<&str> = names.into_iter().collect();
        let (plain, others): (Vec<&str>, Vec<&str>) =
            all.into_iter().partition(|name| letters_and_digits(name) == *name);
        let mut taken = BTreeSet::new();
        let mut labels = BTreeMap::new();
        for name in plain.into_iter().chain(others) {
            labels.insert(name.to_string(), free(&letters_and_digits(name), "x", &mut taken));
        }
        Labels(labels)
    }

    /// The label of a name.
    pub fn label(&self, name: &str) -> Option<&str> {
        self.0.get(name).map(String::as_str)
    }

    /// Names whose label is another text, with the label.
    pub fn changed(&self) -> Vec<(String, String)> {
        self.0.iter().filter(|(name, label)| name != label).map(|(name, label)| (name.clone(), label.clone())).collect()
    }
}

/// The label, or the first of its continuations that nobody has yet; takes it.
pub(super) fn free(label: &str, between: &str, taken: &mut BTreeSet<String>) -> String {
    let tried = |number: usize| match number {
        1 => label.to_string(),
        number => format!("{label}{between}{number}"),
    };
    let mut number = 1;
    while !taken.insert(tried(number).to_ascii_lowercase()) {
        number += 1;
    }
    tried(number)
}

/// The label of a recording among those of its participant: the place in the plan, or else its number. `taken` are the labels of the
/// recordings before it.
pub fn session_label(step: Option<&StepSpec>, taken: &mut BTreeSet<String>) -> String {
    let attempt = |step: &StepSpec| match step.attempt {
        0 | 1 => String::new(),
        attempt => format!("attempt{attempt}"),
    };
    let label = match step {
        Some(step) => match step.period {
            Some(period) => format!("trial{period}{}", attempt(step)),
            None => format!("practice{}", attempt(step)),
        },
        None => format!("{:02}", taken.len() + 1),
    };
    free(&label, "again", taken)
}
