//! Consensus codes: the causes of errors that two raters settle together where their own codes differ. A consensus is
//! not a third rater: agreement is computed from the raters' own codes alone.

use std::collections::BTreeMap;

use super::cause_codes::{ErrorCauseCode, RaterCodes};

/// A code that two raters share, with the raters' own codes at the time of the decision.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ConsensusCode {
    /// The code that both raters share.
    pub code: ErrorCauseCode,
    /// Each rater's own code at the time of the decision; `None` if the rater had not coded the error.
    pub from: [Option<ErrorCauseCode>; 2],
}

/// The consensus of two raters about the errors of one recording, by log number of the erroneous press.
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
    pub fn with_agreed(mut self, codes: [&RaterCodes; 2]) -> RaterConsensus {
        for (press, code) in codes[0].agreed(codes[1]).0 {
            let from = [Some(code.clone()), Some(code.clone())];
            self.settled.insert(press, ConsensusCode { code, from });
        }
        self
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

/// The errors that two raters still have to settle: the raters' codes differ, or one of the codes is missing.
pub fn unsettled(errors: &[u64], codes: [&RaterCodes; 2]) -> Vec<u64> {
    let [one, other] = codes;
    let differs = |press: &u64| match (one.0.get(press), other.0.get(press)) {
        (Some(a), Some(b)) => a != b,
        _ => true,
    };
    errors.iter().copied().filter(differs).collect()
}
