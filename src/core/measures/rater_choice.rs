//! Chooses the two raters whose codes an analysis uses; the choice never depends on the raters' names.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::cause_codes::RaterCodes;

/// Two raters with their codes of one recording. The raters are in alphabetical order, which has no meaning.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct RaterPair {
    /// The names of the raters.
    pub raters: [String; 2],
    /// The codes of errors by each rater.
    pub codes: [RaterCodes; 2],
}

/// The choice of the two raters who coded most errors of a recording.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum RaterChoice {
    /// The chosen two raters with their codes.
    Pair(RaterPair),
    /// No choice: fewer than two raters coded errors of the recording.
    TooFew,
    /// No choice: more than two raters qualify, since they coded equally many errors.
    Tied {
        /// The names of the raters who qualify.
        raters: Vec<String>,
        /// The least number of errors that each of the qualified raters coded.
        coded: usize,
    },
}

impl RaterPair {
    /// The two raters with these names. A rater without codes gets an empty list of codes.
    pub fn named(all: &BTreeMap<String, RaterCodes>, raters: &[String; 2]) -> RaterPair {
        let mut raters = raters.clone();
        raters.sort();
        let codes = raters.each_ref().map(|rater| all.get(rater).cloned().unwrap_or_default());
        RaterPair { raters, codes }
    }

    /// Name of the pair of raters in tables: "R1+R2".
    pub fn name(&self) -> String {
        self.raters.join("+")
    }

    /// Whether both raters gave the same codes to all of this many errors: then one file may be a copy of the other.
    pub fn is_identical(&self, errors: usize) -> bool {
        let [one, other] = &self.codes;
        // One error that both coded alike says nothing.
        errors > 1 && one.0.len() == errors && one == other
    }
}

impl RaterChoice {
    /// Chooses the two raters who coded most errors.
    pub fn most_complete(all: &BTreeMap<String, RaterCodes>) -> RaterChoice {
        let numbers = all.iter().map(|(rater, codes)| (rater.clone(), codes.0.len() as u64)).collect();
        let Some((of_most, coded)) = of_most(&numbers) else { return RaterChoice::TooFew };
        let coded = coded as usize;
        match <[String; 2]>::try_from(of_most) {
            Ok(raters) => RaterChoice::Pair(RaterPair::named(all, &raters)),
            Err(raters) => RaterChoice::Tied { raters, coded },
        }
    }
}

/// The raters who coded most errors, with the least number of errors that each of them coded: two raters, or more if
/// these coded equally many; `None` of fewer than two raters.
pub fn of_most(numbers: &BTreeMap<String, u64>) -> Option<(Vec<String>, u64)> {
    let mut sorted: Vec<u64> = numbers.values().copied().collect();
    sorted.sort_unstable_by_key(|&number| std::cmp::Reverse(number));
    let coded = *sorted.get(1)?;
    Some((numbers.iter().filter(|(_, number)| **number >= coded).map(|(rater, _)| rater.clone()).collect(), coded))
}
