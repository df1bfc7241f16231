//! Which two raters' codes an analysis takes. The raters' names never decide it.

use std::collections::BTreeMap;

use super::cause_codes::Codes;

/// Two raters with their codes of one recording, in the order of their names, which has no meaning.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RaterPair {
    /// The raters.
    pub raters: [String; 2],
    /// What each of them coded.
    pub codes: [Codes; 2],
}

/// The two raters who coded most errors of a recording.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum RaterChoice {
    /// These two.
    Pair(RaterPair),
    /// There are fewer than two raters.
    TooFew,
    /// More than two raters could be these two, since they coded equally many errors.
    Tied {
        /// These raters.
        raters: Vec<String>,
        /// How many errors each of them coded at least.
        coded: usize,
    },
}

impl RaterPair {
    /// Two raters out of all. A rater without codes has none.
    pub fn named(all: &BTreeMap<String, Codes>, raters: &[String; 2]) -> RaterPair {
        let mut raters = raters.clone();
        raters.sort();
        let codes = raters.each_ref().map(|rater| all.get(rater).cloned().unwrap_or_default());
        RaterPair { raters, codes }
    }
}

impl RaterChoice {
    /// The two with the most complete codes.
    pub fn most_complete(all: &BTreeMap<String, Codes>) -> RaterChoice {
        let mut numbers: Vec<usize> = all.values().map(|codes| codes.0.len()).collect();
        numbers.sort_unstable_by_key(|&number| std::cmp::Reverse(number));
        let Some(&coded) = numbers.get(1) else { return RaterChoice::TooFew };
        let of_most = all.iter().filter(|(_, codes)| codes.0.len() >= coded).map(|(rater, _)| rater.clone());
        match <[String; 2]>::try_from(of_most.collect::<Vec<String>>()) {
            Ok(raters) => RaterChoice::Pair(RaterPair::named(all, &raters)),
            Err(raters) => RaterChoice::Tied { raters, coded },
        }
    }
}
