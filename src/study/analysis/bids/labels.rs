//! Labels of participants, sessions and tasks for BIDS file names: letters and digits only, and no two labels alike.

use std::collections::{BTreeMap, BTreeSet};

use tomcom_session::plan::PlanPosition;

/// The letters and digits of a name; a BIDS label may contain nothing else.
pub fn letters_and_digits(name: &str) -> String {
    let kept: String = name.chars().filter(char::is_ascii_alphanumeric).collect();
    if kept.is_empty() { "x".to_string() } else { kept }
}

/// BIDS labels by name. Labels that differ only in capitals count as alike, since they would be the same folder on some
/// disks.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct BidsLabelMap(BTreeMap<String, String>);

impl BidsLabelMap {
    /// The BIDS labels of these names: the label consists of the letters and digits of the name. A label that another
    /// name has already is followed by `x2`, `x3` and so on.
    pub fn from_names<'a>(names: impl IntoIterator<Item = &'a str>) -> BidsLabelMap {
        let all: BTreeSet<&str> = names.into_iter().collect();
        let (plain, others): (Vec<&str>, Vec<&str>) =
            all.into_iter().partition(|name| letters_and_digits(name) == *name);
        let mut taken = BTreeSet::new();
        let mut labels = BTreeMap::new();
        for name in plain.into_iter().chain(others) {
            labels.insert(name.to_string(), free(&letters_and_digits(name), "x", &mut taken));
        }
        BidsLabelMap(labels)
    }

    /// The BIDS label that a name got.
    pub fn label(&self, name: &str) -> Option<&str> {
        self.0.get(name).map(String::as_str)
    }

    /// Names that differ from their BIDS label, together with the label.
    pub fn changed(&self) -> Vec<(String, String)> {
        self.0.iter().filter(|(name, label)| name != label).map(|(name, label)| (name.clone(), label.clone())).collect()
    }
}

/// A free label: `label`, with a number behind it if that label is taken; the returned label counts as taken.
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

/// The session label of a recording of a participant: its place in the study plan, or else its number. `taken` are the
/// session labels of the participant's earlier recordings.
pub fn session_label(step: Option<&PlanPosition>, taken: &mut BTreeSet<String>) -> String {
    let attempt = |step: &PlanPosition| match step.attempt {
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
