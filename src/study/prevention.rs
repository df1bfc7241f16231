//! Errors that signals and proposals would have prevented in an unassisted trial, and signals that would have been
//! useless.
//!
//! A signal is useful if it is the first about the target of a false belief episode, and at least one error that
//! follows from this false belief comes after the signal in the same episode. All other signals are useless: about a
//! right belief, about a false but harmless one, repeated, or after the last error, inside of episodes as well as
//! outside. A signal prevents the later errors of its own aspect in the same episode and no others; signals replayed on
//! a recording do not change the participant's belief.
//!
//! A proposal of k presses is one interruption with k contents. The proposal prevents the errors of the next k presses,
//! and is useless if none of these presses is an error, whatever the error's cause.

use serde::{Deserialize, Serialize};

use crate::rater_episodes::KnownFalseBeliefs;
use tomcom_core::base::time::SessionTime;
use tomcom_core::kitchen::{AspectId, Kitchen};
use tomcom_core::measures::JudgedPress;
use tomcom_core::measures::raters::BeliefSource;
use tomcom_core::measures::sequences::FalseBeliefEpisode;

const NANOS_PER_MS: u64 = 1_000_000;

#[derive(Clone, Debug, Default, PartialEq)]
pub struct TrialGroundTruth {
    pub presses: Vec<PressGroundTruth>,
    pub false_beliefs: Vec<FalseBeliefGroundTruth>,
    /// Whether `false_beliefs` includes false beliefs that led to no error (harmless ones).
    pub knows_harmless: bool,
}

#[derive(Clone, Debug, PartialEq)]
pub struct PressGroundTruth {
    pub time: SessionTime,
    pub error: bool,
    /// State aspects of the false belief that caused the error; empty for all other presses. An order and the recipe of
    /// the ordered dish are one target with two aspects.
    pub aspects: Vec<AspectId>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FalseBeliefGroundTruth {
    pub aspect: AspectId,
    pub began: SessionTime,
    /// Session time at which the false belief ended; `None` if the false belief lasted until the end of the trial.
    pub ended: Option<SessionTime>,
    pub harmful: bool,
}

#[derive(Clone, Debug, PartialEq)]
pub struct HypotheticalSignal {
    pub time: SessionTime,
    pub press: usize,
    pub aspects: Vec<AspectId>,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct PreventionCounts {
    pub presses: u64,
    /// Number of interruptions: one for each signal or proposal.
    pub signals: u64,
    /// Number of contents that were told: 1 for a signal, the number of proposed presses for a proposal.
    pub contents: u64,
    pub related: u64,
    pub prevented: u64,
    pub useless: u64,
    /// From useful signals to the first errors that they prevent; 0 for proposals.
    pub lead_ms: u64,
    pub outside: u64,
    pub false_presses: u64,
    pub false_inside: u64,
    /// About a false belief that led to no error; useless, too. Null where such beliefs are not known.
    pub harmless: Option<u64>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PreventionRates {
    /// False positive rate: useless signals per human press.
    pub fpr: f64,
    /// True positive rate: share of the errors from false beliefs that are prevented.
    pub tpr: f64,
    /// Signals or proposals per 100 human presses.
    pub signals_per_100: f64,
}

impl PreventionCounts {
    pub fn plus(self, other: &PreventionCounts) -> PreventionCounts {
        PreventionCounts {
            presses: self.presses + other.presses,
            signals: self.signals + other.signals,
            contents: self.contents + other.contents,
            related: self.related + other.related,
            prevented: self.prevented + other.prevented,
            useless: self.useless + other.useless,
            lead_ms: self.lead_ms + other.lead_ms,
            outside: self.outside + other.outside,
            false_presses: self.false_presses + other.false_presses,
            false_inside: self.false_inside + other.false_inside,
            harmless: self.harmless.zip(other.harmless).map(|(one, other)| one + other),
        }
    }

    /// The rates of the counts; `None` without presses or without errors from false beliefs.
    pub fn rates(&self) -> Option<PreventionRates> {
        let presses = self.presses as f64;
        (self.presses > 0 && self.related > 0).then(|| PreventionRates {
            fpr: self.useless as f64 / presses,
            tpr: self.prevented as f64 / self.related as f64,
            signals_per_100: 100.0 * self.signals as f64 / presses,
        })
    }

    /// Mean time from a useful signal to the first error that it prevents; `None` without useful signals.
    pub fn lead_s(&self) -> Option<f64> {
        let useful = self.signals - self.useless;
        (useful > 0).then(|| self.lead_ms as f64 / 1000.0 / useful as f64)
    }

    /// Share of useless signals among all signals; `None` without signals.
    pub fn useless_share(&self) -> Option<f64> {
        (self.signals > 0).then(|| self.useless as f64 / self.signals as f64)
    }
}

impl FalseBeliefGroundTruth {
    fn is_open(&self, time: SessionTime) -> bool {
        self.began <= time && self.ended.is_none_or(|end| time < end)
    }

    /// A press at the time of the correction was decided before the correction.
    fn caused(&self, press: &PressGroundTruth) -> bool {
        let is_inside = self.began <= press.time && self.ended.is_none_or(|end| press.time <= end);
        is_inside && press.aspects.contains(&self.aspect)
    }
}

impl TrialGroundTruth {
    pub fn new(kitchen: &Kitchen, judged: &[JudgedPress], known: &KnownFalseBeliefs) -> TrialGroundTruth {
        let press = |press: &JudgedPress| PressGroundTruth {
            time: press.time,
            error: press.verdict.error,
            aspects: known.targets.get(&press.seq).map_or(Vec::new(), |target| target.aspects(kitchen).collect()),
        };
        let false_belief = |episode: &FalseBeliefEpisode| FalseBeliefGroundTruth {
            aspect: episode.aspect,
            began: episode.began,
            ended: episode.corrected,
            harmful: episode.errors > 0,
        };
        TrialGroundTruth {
            presses: judged.iter().map(press).collect(),
            false_beliefs: known.episodes.iter().map(false_belief).collect(),
            knows_harmless: known.basis == BeliefSource::Recorded,
        }
    }

    fn is_in_episode(&self, time: SessionTime) -> bool {
        self.false_beliefs.iter().any(|false_belief| false_belief.harmful && false_belief.is_open(time))
    }

    fn empty_count(&self, signals: u64) -> PreventionCounts {
        PreventionCounts {
            presses: self.presses.len() as u64,
            signals,
            contents: signals,
            related: self.presses.iter().filter(|press| !press.aspects.is_empty()).count() as u64,
            outside: self.presses.iter().filter(|press| !self.is_in_episode(press.time)).count() as u64,
            harmless: self.knows_harmless.then_some(0),
            ..PreventionCounts::default()
        }
    }

    /// Prevention counts for a concept that sends these signals, which are ordered by time.
    pub fn count_signals(&self, sent: &[HypotheticalSignal]) -> PreventionCounts {
        let mut count = self.empty_count(sent.len() as u64);
        let mut is_prevented = vec![false; self.presses.len()];
        let mut is_told = vec![false; self.false_beliefs.len()];
        let mut is_false = vec![false; self.presses.len()];
        for signal in sent {
            let (mut prevents_at, mut about) = (None::<SessionTime>, Vec::new());
            for (index, false_belief) in self.false_beliefs.iter().enumerate() {
                if !signal.aspects.contains(&false_belief.aspect) || !false_belief.is_open(signal.time) {
                    continue;
                }
                about.push(false_belief);
                if std::mem::replace(&mut is_told[index], true) {
                    continue;
                }
                for (press, is_prevented) in self.presses.iter().zip(&mut is_prevented) {
                    if press.time > signal.time && false_belief.caused(press) {
                        *is_prevented = true;
                        prevents_at = Some(prevents_at.map_or(press.time, |first| first.min(press.time)));
                    }
                }
            }
            let is_harmless = !about.is_empty() && about.iter().all(|one| !one.harmful);
            count.harmless = count.harmless.map(|harmless| harmless + u64::from(is_harmless));
            match prevents_at {
                Some(at) => count.lead_ms += (at - signal.time).0 / NANOS_PER_MS,
                None => {
                    self.count_useless(&mut count, signal.time);
                    // A signal after the last press of the trial precedes no press.
                    is_false.get_mut(signal.press).into_iter().for_each(|press| *press = true);
                }
            }
        }
        let number = |of: &[bool]| of.iter().filter(|one| **one).count() as u64;
        PreventionCounts { prevented: number(&is_prevented), false_presses: number(&is_false), ..count }
    }

    fn count_useless(&self, count: &mut PreventionCounts, time: SessionTime) {
        count.useless += 1;
        count.false_inside += u64::from(self.is_in_episode(time));
    }

    /// Prevention counts for a concept that proposes `k` presses after every error that no earlier proposal prevents.
    pub fn count_proposals(&self, k: usize) -> PreventionCounts {
        let mut count = self.empty_count(0);
        let mut after = 0;
        while let Some(press) = self.presses.get(after) {
            after += 1;
            if !press.error {
                continue;
            }
            let spared = &self.presses[after..self.presses.len().min(after + k)];
            count.signals += 1;
            count.contents += k as u64;
            count.prevented += spared.iter().filter(|press| !press.aspects.is_empty()).count() as u64;
            if !spared.iter().any(|press| press.error) {
                self.count_useless(&mut count, press.time);
                count.false_presses += u64::from(!spared.is_empty());
            }
            after += spared.len();
        }
        count
    }
}
