//! Known false beliefs of the participant in a trial: from recorded beliefs of simulated participants, or from raters'
//! codes.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::belief_trace::BeliefEvidence;
use super::rater_episodes::rater_episodes;
use tomcom_core::kitchen::Kitchen;
use tomcom_core::kitchen::cost_to_go::CostToGo;
use tomcom_core::measures::JudgedPress;
use tomcom_core::measures::attribution::{ErrorCause, FalseBeliefTarget};
use tomcom_core::measures::raters::BeliefSource;
use tomcom_core::measures::raters::RaterCodes;
use tomcom_core::measures::sequences::FalseBeliefEpisode;

/// Known false beliefs of a participant in one trial.
#[derive(Clone, Debug, PartialEq)]
pub struct KnownFalseBeliefs {
    /// Source from which the false beliefs are known: recorded beliefs, or raters.
    pub basis: BeliefSource,
    /// For each error that follows from a false belief, the belief's target, by sequence number of the press.
    pub targets: BTreeMap<u64, FalseBeliefTarget>,
    /// False belief episodes of the trial; for people, only episodes that led to errors.
    pub episodes: Vec<FalseBeliefEpisode>,
}

/// Agreement of two raters about the false beliefs behind the errors of a trial, by the codes that each gave alone.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct RaterFalseBeliefAgreement {
    /// Number of errors that both raters attribute to the same false belief.
    pub same: u64,
    /// Number of errors that the raters attribute to different false beliefs.
    pub differing: u64,
    /// Number of errors that only one of the two raters attributes to a false belief.
    pub of_one: u64,
}

impl KnownFalseBeliefs {
    /// The false beliefs that a simulated participant recorded; `judged` are the participant's judged presses.
    pub fn recorded(judged: &[JudgedPress], episodes: Vec<FalseBeliefEpisode>) -> KnownFalseBeliefs {
        let target = |press: &JudgedPress| match press.cause {
            Some(ErrorCause::Belief { target, .. }) => Some((press.seq, target)),
            _ => None,
        };
        let targets = judged.iter().filter_map(target).collect();
        KnownFalseBeliefs { basis: BeliefSource::Recorded, targets, episodes }
    }

    /// The false beliefs that follow from codes on which two raters agree (see [`super::rater_episodes::RULE`]).
    pub fn coded(
        basis: BeliefSource,
        kitchen: &Kitchen,
        cost: &mut CostToGo,
        trace: &BeliefEvidence,
        judged: &[JudgedPress],
        codes: &RaterCodes,
    ) -> KnownFalseBeliefs {
        let errors = judged.iter().filter(|press| press.verdict.error);
        let target = |press: &JudgedPress| Some((press.seq, codes.0.get(&press.seq)?.target(kitchen, press.before)?));
        let targets: Vec<(u64, FalseBeliefTarget)> = errors.filter_map(target).collect();
        let episodes = rater_episodes(kitchen, cost, trace, judged, &targets);
        KnownFalseBeliefs { basis, targets: targets.into_iter().collect(), episodes }
    }
}

impl KnownFalseBeliefs {
    /// The false belief episode to which an error belongs.
    pub fn episode(&self, kitchen: &Kitchen, press: &JudgedPress) -> Option<&FalseBeliefEpisode> {
        let target = self.targets.get(&press.seq)?;
        let is_in =
            |one: &FalseBeliefEpisode| one.began <= press.time && one.corrected.is_none_or(|end| press.time <= end);
        self.episodes
            .iter()
            .find(|one| one.errors > 0 && is_in(one) && target.aspects(kitchen).any(|aspect| aspect == one.aspect))
    }
}

impl RaterFalseBeliefAgreement {
    /// Counts the agreement of two raters over errors that both coded.
    pub fn count([one, other]: &[RaterCodes; 2]) -> RaterFalseBeliefAgreement {
        let mut shared = RaterFalseBeliefAgreement::default();
        for (press, code) in &one.0 {
            let Some(of_other) = other.0.get(press) else { continue };
            match (code.aspect(), of_other.aspect()) {
                (Some(one), Some(other)) if one == other => shared.same += 1,
                (Some(_), Some(_)) => shared.differing += 1,
                (Some(_), None) | (None, Some(_)) => shared.of_one += 1,
                (None, None) => {}
            }
        }
        shared
    }

    /// Sum of two counts of agreement about false beliefs.
    pub fn plus(self, other: RaterFalseBeliefAgreement) -> RaterFalseBeliefAgreement {
        RaterFalseBeliefAgreement {
            same: self.same + other.same,
            differing: self.differing + other.differing,
            of_one: self.of_one + other.of_one,
        }
    }
}
