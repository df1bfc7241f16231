//! Raters' codes of error causes, and other sources of knowledge about beliefs. The beliefs of people are unknown, so two
//! raters independently code the errors of a trial, Cohen's kappa (1960, "A coefficient of agreement for nominal scales")
//! measures the agreement of their codes, and the two settle the rest together.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::attribution::{ErrorCause, FalseBeliefTarget};
use super::errors::JudgedPress;
use super::matching::kappa;
use crate::base::text::did_you_mean;
use crate::kitchen::{Kitchen, State};

/// Cause of an error as coded by a rater.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub enum ErrorCauseCode {
    /// A false belief caused the error; contains the location's name. An order location stands for the recipe of its
    /// dish.
    Belief(String),
    /// A slip of hand or attention, without a false belief, caused the error.
    Slip,
    /// A race caused the error: the robot changed the location shortly before the press, too late for the participant
    /// to react.
    Race,
    /// Another cause of the error than those with a code of their own.
    Other,
    /// Confused buttons: the participant wanted to press another button.
    Buttons,
}

/// Kinds of causes of an error, without what a false belief is about.
#[allow(missing_docs, reason = "as in `ErrorCauseCode`")]
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ErrorCauseKind {
    Belief,
    Slip,
    Race,
    Other,
    Buttons,
}

impl ErrorCauseKind {
    /// All kinds of error causes, in the order of the keys that code them.
    pub const ALL: [ErrorCauseKind; 5] = [
        ErrorCauseKind::Belief,
        ErrorCauseKind::Slip,
        ErrorCauseKind::Race,
        ErrorCauseKind::Other,
        ErrorCauseKind::Buttons,
    ];

    /// Name of the cause kind in files.
    pub fn name(self) -> &'static str {
        match self {
            ErrorCauseKind::Belief => "belief",
            ErrorCauseKind::Slip => "slip",
            ErrorCauseKind::Race => "race",
            ErrorCauseKind::Other => "other",
            ErrorCauseKind::Buttons => "buttons",
        }
    }

    /// Name of the cause kind in the raters' codebook.
    pub fn title(self) -> &'static str {
        match self {
            ErrorCauseKind::Belief => "wrong about",
            ErrorCauseKind::Slip => "slip",
            ErrorCauseKind::Race => "race",
            ErrorCauseKind::Other => "other cause",
            ErrorCauseKind::Buttons => "mixed up buttons",
        }
    }

    /// Definition of the cause kind in the raters' codebook, in one line.
    pub fn definition(self) -> &'static str {
        match self {
            ErrorCauseKind::Belief => "order: or its recipe",
            ErrorCauseKind::Slip => "nothing was believed wrong",
            ErrorCauseKind::Race => "the robot was quicker",
            ErrorCauseKind::Other => "none of these causes",
            ErrorCauseKind::Buttons => "wanted another",
        }
    }

    /// The definition of the cause kind in two words, for narrow screens; `None` where the title suffices.
    pub fn short_definition(self) -> Option<&'static str> {
        match self {
            ErrorCauseKind::Slip => Some("belief right"),
            ErrorCauseKind::Race => Some("robot first"),
            ErrorCauseKind::Belief | ErrorCauseKind::Other | ErrorCauseKind::Buttons => None,
        }
    }

    /// The kind of error cause with this name.
    pub fn named(name: &str) -> Option<ErrorCauseKind> {
        ErrorCauseKind::ALL.into_iter().find(|kind| kind.name() == name)
    }
}

impl ErrorCauseCode {
    /// The code for a kind of error cause; `aspect` names the location of a false belief and is given for false beliefs
    /// only.
    pub fn new(kind: ErrorCauseKind, aspect: Option<&str>) -> Option<ErrorCauseCode> {
        match (kind, aspect) {
            (ErrorCauseKind::Belief, Some(aspect)) => Some(ErrorCauseCode::Belief(aspect.to_string())),
            (ErrorCauseKind::Slip, None) => Some(ErrorCauseCode::Slip),
            (ErrorCauseKind::Race, None) => Some(ErrorCauseCode::Race),
            (ErrorCauseKind::Other, None) => Some(ErrorCauseCode::Other),
            (ErrorCauseKind::Buttons, None) => Some(ErrorCauseCode::Buttons),
            _ => None,
        }
    }

    /// The kind of the coded cause, without what a false belief is about.
    pub fn kind(&self) -> ErrorCauseKind {
        match self {
            ErrorCauseCode::Belief(_) => ErrorCauseKind::Belief,
            ErrorCauseCode::Slip => ErrorCauseKind::Slip,
            ErrorCauseCode::Race => ErrorCauseKind::Race,
            ErrorCauseCode::Other => ErrorCauseKind::Other,
            ErrorCauseCode::Buttons => ErrorCauseKind::Buttons,
        }
    }

    /// Name of the location that the coded false belief is about; `None` for other causes.
    pub fn aspect(&self) -> Option<&str> {
        match self {
            ErrorCauseCode::Belief(aspect) => Some(aspect),
            _ => None,
        }
    }

    /// Target of the coded false belief, in the state before the press; `None` for other causes.
    pub fn target(&self, kitchen: &Kitchen, state: State) -> Option<FalseBeliefTarget> {
        Some(FalseBeliefTarget::of_location(kitchen, state, kitchen.location_named(self.aspect()?)?))
    }
}

/// Errors and locations to which the raters' codes of one recording can refer.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CodableErrors {
    /// Log numbers of the presses that were errors, in ascending order.
    pub errors: Vec<u64>,
    /// Names of the kitchen's locations, which a code of a false belief may be about.
    pub places: Vec<String>,
}

impl CodableErrors {
    /// Collects the errors among these presses, and the locations of the kitchen.
    pub fn from_presses(kitchen: &Kitchen, presses: &[JudgedPress]) -> CodableErrors {
        CodableErrors {
            errors: presses.iter().filter(|press| press.verdict.error).map(|press| press.seq).collect(),
            places: kitchen.locations.iter().map(|location| location.name.clone()).collect(),
        }
    }

    /// Explains what is wrong with a code for the press with this log number, and the remedy; `None` for a valid code.
    pub fn fault(&self, press: u64, code: &ErrorCauseCode) -> Option<(String, String)> {
        if !self.errors.contains(&press) {
            return Some((format!("press {press}, which was no error"), self.nearest(press)));
        }
        let aspect = code.aspect().filter(|aspect| !self.places.iter().any(|place| place == aspect))?;
        let found = format!("the aspect \"{aspect}\"{}", did_you_mean(aspect, &self.places));
        Some((found, format!("one of {}", self.places.join(", "))))
    }

    fn nearest(&self, press: u64) -> String {
        let after = self.errors.partition_point(|&error| error < press);
        let around = [after.checked_sub(1).map(|before| self.errors[before]), self.errors.get(after).copied()];
        let around: Vec<String> = around.iter().flatten().map(u64::to_string).collect();
        match around.is_empty() {
            true => "no code: nothing in this recording was an error".to_string(),
            false => format!("the number of an error in its log; the nearest: {}", around.join(" and ")),
        }
    }
}

/// Codes of one rater for one recording, by log number of the erroneous press.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct RaterCodes(pub BTreeMap<u64, ErrorCauseCode>);

impl RaterCodes {
    /// The true codes of a simulated participant's errors, for comparison with raters.
    pub fn known(kitchen: &Kitchen, presses: &[JudgedPress]) -> RaterCodes {
        let code = |press: &JudgedPress| {
            Some(match press.cause? {
                ErrorCause::Slip => ErrorCauseCode::Slip,
                ErrorCause::Planning => ErrorCauseCode::Other,
                ErrorCause::Belief {
                    target: FalseBeliefTarget::Order(location, _) | FalseBeliefTarget::Place(location),
                    ..
                } => ErrorCauseCode::Belief(kitchen.location(location).name.clone()),
                // A false belief about a recipe has no location if no order requests the dish.
                ErrorCause::Belief { target: FalseBeliefTarget::Recipe(_), .. } => ErrorCauseCode::Other,
            })
        };
        RaterCodes(presses.iter().filter_map(|press| Some((press.seq, code(press)?))).collect())
    }

    /// The errors to which both raters gave the same code, with that code.
    pub fn agreed(&self, other: &RaterCodes) -> RaterCodes {
        let same = self.0.iter().filter(|(press, code)| other.0.get(press) == Some(code));
        RaterCodes(same.map(|(press, code)| (*press, code.clone())).collect())
    }

    /// The disagreements of two raters, which they settle: the errors that both coded, each with another code. What only
    /// one of them coded is no disagreement: the other codes it alone.
    pub fn disagreements(&self, other: &RaterCodes) -> Vec<u64> {
        let by_both = self.0.iter().filter_map(|(press, code)| Some((*press, code, other.0.get(press)?)));
        by_both.filter(|(_, one, other)| one != other).map(|(press, ..)| press).collect()
    }
}

/// Contingency table of two raters' codes over the errors that both raters coded; recordings are added to the table.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct AgreementTable {
    kinds: BTreeMap<(ErrorCauseKind, ErrorCauseKind), u64>,
    /// Counts of location pairs (as indices of location names) for errors that both raters coded as false beliefs.
    aspects: BTreeMap<(usize, usize), u64>,
    names: Vec<String>,
}

/// Agreement of two raters on the causes of errors.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct RaterAgreement {
    /// Number of errors that both raters coded.
    pub errors: u64,
    /// Number of errors to which both raters gave the same kind of cause.
    pub same_cause: u64,
    /// Cohen's kappa of the kind of cause over {belief, slip, race, other, buttons}; null without codes, or if all
    /// codes are equal.
    pub kappa_cause: Option<f64>,
    /// Number of errors that both raters attributed to a false belief.
    pub beliefs: u64,
    /// Number of errors that both raters attributed to a false belief about the same location.
    pub same_aspect: u64,
    /// Cohen's kappa of the location that the false belief is about.
    pub kappa_aspect: Option<f64>,
}

impl AgreementTable {
    /// Adds the codes of one recording by both raters to the table.
    pub fn add(&mut self, one: &RaterCodes, other: &RaterCodes) {
        for (press, a) in &one.0 {
            let Some(b) = other.0.get(press) else { continue };
            *self.kinds.entry((a.kind(), b.kind())).or_default() += 1;
            if let (Some(a), Some(b)) = (a.aspect(), b.aspect()) {
                let pair = (self.number(a), self.number(b));
                *self.aspects.entry(pair).or_default() += 1;
            }
        }
    }

    fn number(&mut self, name: &str) -> usize {
        match self.names.iter().position(|known| known == name) {
            Some(number) => number,
            None => {
                self.names.push(name.to_string());
                self.names.len() - 1
            }
        }
    }

    /// Computes the agreement of the two raters from the table.
    pub fn agreement(&self) -> RaterAgreement {
        RaterAgreement {
            errors: self.kinds.values().sum(),
            same_cause: same(&self.kinds),
            kappa_cause: kappa(&self.kinds),
            beliefs: self.aspects.values().sum(),
            same_aspect: same(&self.aspects),
            kappa_aspect: kappa(&self.aspects),
        }
    }
}

fn same<T: Ord>(pairs: &BTreeMap<(T, T), u64>) -> u64 {
    pairs.iter().filter(|((a, b), _)| a == b).map(|(_, number)| number).sum()
}

/// A code that two raters share, with the raters' own codes at the time of the decision.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ConsensusCode {
    /// The code that both raters share.
    pub code: ErrorCauseCode,
    /// Each rater's own code at the time of the decision; `None` if the rater had not coded the error.
    pub from: [Option<ErrorCauseCode>; 2],
}

/// The consensus of two raters about the errors of one recording, by log number of the erroneous press: the causes that
/// they settle together where their own codes differ. It is not a third rater: agreement is computed from the raters' own
/// codes alone.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RaterConsensus {
    /// The two raters, in the order of their codes.
    pub raters: [String; 2],
    /// The shared codes by erroneous press; the raters decided on them together, or their own codes were equal from the
    /// beginning.
    pub settled: BTreeMap<u64, ConsensusCode>,
}

/// A rater's own code that changed after the consensus on the error was reached.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PostConsensusChange {
    /// Log number of the erroneous press.
    pub press: u64,
    /// The name of the rater whose code changed.
    pub rater: String,
}

impl RaterConsensus {
    /// Creates a consensus without any settled errors. The order of the two raters has no meaning.
    pub fn new(one: &str, other: &str) -> RaterConsensus {
        let mut raters = [one.to_string(), other.to_string()];
        raters.sort();
        RaterConsensus { raters, settled: BTreeMap::new() }
    }

    /// Name of the consensus in tables: "R1+R2". No single rater has such a name.
    pub fn name(&self) -> String {
        self.raters.join("+")
    }

    /// The first of the two raters who has coded no error: without codes of both, there is nothing to settle.
    pub fn without_codes(&self, codes: [&RaterCodes; 2]) -> Option<&str> {
        self.raters.iter().zip(codes).find(|(_, codes)| codes.0.is_empty()).map(|(rater, _)| rater.as_str())
    }

    /// Adds the errors that both raters coded alike.
    pub fn with_agreed(self, codes: [&RaterCodes; 2]) -> RaterConsensus {
        self.with_decided(&codes[0].agreed(codes[1]), codes)
    }

    /// Adds codes that the two raters decided together; `codes` are the raters' own codes at that time.
    pub fn with_decided(mut self, decided: &RaterCodes, codes: [&RaterCodes; 2]) -> RaterConsensus {
        for (press, code) in &decided.0 {
            let from = codes.map(|codes| codes.0.get(press).cloned());
            self.settled.insert(*press, ConsensusCode { code: code.clone(), from });
        }
        self
    }

    /// The raters' own codes that changed since the consensus; each changed code makes the consensus on its error
    /// stale.
    pub fn changed(&self, codes: [&RaterCodes; 2]) -> Vec<PostConsensusChange> {
        let mut changed = Vec::new();
        for (press, settled) in &self.settled {
            for (index, rater) in self.raters.iter().enumerate() {
                if codes[index].0.get(press) != settled.from[index].as_ref() {
                    changed.push(PostConsensusChange { press: *press, rater: rater.clone() });
                }
            }
        }
        changed
    }

    /// The shared codes for errors whose codes by the two raters have not changed since the consensus.
    pub fn current(&self, codes: [&RaterCodes; 2]) -> RaterCodes {
        let stale = self.changed(codes);
        let holds = |press: &u64| stale.iter().all(|changed| changed.press != *press);
        let settled = self.settled.iter().filter(|(press, _)| holds(press));
        RaterCodes(settled.map(|(press, settled)| (*press, settled.code.clone())).collect())
    }

    /// Number of errors that both raters had coded alike before the discussion.
    pub fn agreed(&self) -> usize {
        self.settled.values().filter(|settled| settled.is_agreed()).count()
    }
}

impl ConsensusCode {
    /// Whether both raters had given this code before they talked about the error.
    pub fn is_agreed(&self) -> bool {
        self.from.iter().all(|from| from.as_ref() == Some(&self.code))
    }

    /// Why a shared code is invalid: the shared code contradicts a code on which both raters agreed. `None` for a valid
    /// code.
    pub fn fault(&self) -> Option<&'static str> {
        let [one, other] = &self.from;
        let overrules = one.is_some() && one == other && one.as_ref() != Some(&self.code);
        overrules.then_some("the code that both raters gave: what they agree on needs no other decision")
    }
}

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

/// The source from which an analysis takes causes of errors and false beliefs; the most reliable source first.
#[allow(missing_docs, reason = "`words` says each")]
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum BeliefSource {
    Recorded,
    Probes,
    Consensus,
    Raters,
    Estimate,
}

impl BeliefSource {
    /// Name of the source of beliefs in tables.
    pub fn name(self) -> &'static str {
        match self {
            BeliefSource::Recorded => "recorded",
            BeliefSource::Probes => "probes",
            BeliefSource::Consensus => "consensus",
            BeliefSource::Raters => "raters",
            BeliefSource::Estimate => "estimate",
        }
    }

    /// The source of beliefs in words.
    pub fn words(self) -> &'static str {
        match self {
            BeliefSource::Recorded => "the recorded beliefs of simulated participants",
            BeliefSource::Probes => "the participants' answers to probes",
            BeliefSource::Consensus => "the consensus of two raters",
            BeliefSource::Raters => "the codes of two raters",
            BeliefSource::Estimate => "the assistant's estimate",
        }
    }
}
