//! Errors that signals and proposals would have prevented in an unassisted trial.
//!
//! One signal that targets the aspect of a false belief episode prevents the rest of its error sequence; replayed signals do not
//! change the belief. A signal about a correctly believed aspect is a false positive; a signal about a false but harmless belief is
//! counted separately. A proposal of k presses counts as k signals and prevents the errors of the next k presses; those of the k
//! presses that are outside of episodes are false positives.

use serde::Serialize;

use crate::base::time::SessionTime;
use crate::kitchen::AspectId;

/// True errors, false beliefs and error sequences of a trial.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TrialTruth {
    /// The human's presses, in order.
    pub presses: Vec<PressTruth>,
    /// The times in which an aspect was believed wrong.
    pub spells: Vec<FalseBeliefTruth>,
    /// The error sequences.
    pub sequences: Vec<SequenceTruth>,
}

/// Truth about one human press.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PressTruth {
    /// Session time of the press.
    pub time: SessionTime,
    /// It was an error.
    pub error: bool,
    /// Whether the press is a belief related error.
    pub related: bool,
}

/// Period in which the participant held a false belief about one aspect.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FalseBeliefTruth {
    /// What was believed wrong.
    pub aspect: AspectId,
    /// Session time from which it was believed wrong.
    pub began: SessionTime,
    /// Until when; none: until the end of the trial.
    pub ended: Option<SessionTime>,
    /// Whether the false belief led to an error, which makes it an episode.
    pub harmful: bool,
}

/// Sequence of belief related errors.
#[derive(Clone, Debug, PartialEq)]
pub struct SequenceTruth {
    /// Aspects of the false belief behind the sequence.
    pub aspects: Vec<AspectId>,
    /// Time of each error.
    pub errors: Vec<SessionTime>,
}

/// A signal that a concept would have sent.
#[derive(Clone, Debug, PartialEq)]
pub struct ConceptSignal {
    /// Session time of the signal.
    pub time: SessionTime,
    /// Number of human presses before the signal.
    pub press: usize,
    /// Aspects that the signal communicates.
    pub aspects: Vec<AspectId>,
}

/// Counts of prevented errors and false positives of a concept, in one or several trials.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct PreventionCounts {
    /// Number of human presses.
    pub presses: u64,
    /// Number of signals, or of proposed presses.
    pub signals: u64,
    /// Number of belief related errors.
    pub related: u64,
    /// Number of belief related errors that were prevented.
    pub prevented: u64,
    /// Number of human presses outside of false belief episodes.
    pub outside: u64,
    /// Number of human presses outside of episodes with a false positive signal before them.
    pub false_presses: u64,
    /// Number of signals about a correctly believed aspect during an episode of another aspect.
    pub false_inside: u64,
    /// Number of signals about a false but harmless belief.
    pub harmless: u64,
}

impl PreventionCounts {
    /// Sum of two counts.
    pub fn plus(self, other: &PreventionCounts) -> PreventionCounts {
        PreventionCounts {
            presses: self.presses + other.presses,
            signals: self.signals + other.signals,
            related: self.related + other.related,
            prevented: self.prevented + other.prevented,
            outside: self.outside + other.outside,
            false_presses: self.false_presses + other.false_presses,
            false_inside: self.false_inside + other.false_inside,
            harmless: self.harmless + other.harmless,
        }
    }

    /// False positive rate, true positive rate, and signals per 100 human presses; `None` if a denominator is 0.
    pub fn point(&self) -> Option<[f64; 3]> {
        if self.outside == 0 || self.related == 0 {
            return None;
        }
        let (false_positive, true_positive) =
            (self.false_presses as f64 / self.outside as f64, self.prevented as f64 / self.related as f64);
        Some([false_positive, true_positive, 100.0 * self.signals as f64 / self.presses as f64])
    }
}

impl TrialTruth {
    fn open_at(&self, time: SessionTime) -> impl Iterator<Item = &FalseBeliefTruth> {
        self.spells
            .iter()
            .filter(move |false_belief| false_belief.began <= time && false_belief.ended.is_none_or(|end| time < end))
    }

    fn is_in_episode(&self, time: SessionTime) -> bool {
        self.open_at(time).any(|false_belief| false_belief.harmful)
    }

    fn empty_count(&self, signals: u64) -> PreventionCounts {
        PreventionCounts {
            presses: self.presses.len() as u64,
            signals,
            related: self.presses.iter().filter(|press| press.related).count() as u64,
            outside: self.presses.iter().filter(|press| !self.is_in_episode(press.time)).count() as u64,
            ..PreventionCounts::default()
        }
    }

    /// Counts of a concept that sends these signals.
    pub fn count_signals(&self, sent: &[ConceptSignal]) -> PreventionCounts {
        let mut count = self.empty_count(sent.len() as u64);
        let mut prevented: Vec<Vec<bool>> =
            self.sequences.iter().map(|sequence| vec![false; sequence.errors.len()]).collect();
        let mut is_false = vec![false; self.presses.len()];
        for signal in sent {
            let mut wrong = self
                .open_at(signal.time)
                .filter(|false_belief| signal.aspects.contains(&false_belief.aspect))
                .peekable();
            if wrong.peek().is_none() {
                match self.presses.get(signal.press) {
                    Some(press) if self.is_in_episode(press.time) => count.false_inside += 1,
                    Some(_) => is_false[signal.press] = true,
                    // A signal after the last press precedes no press.
                    None => {}
                }
                continue;
            }
            let mut is_harmful = false;
            for false_belief in wrong.filter(|false_belief| false_belief.harmful) {
                is_harmful = true;
                for (sequence, prevented) in self.sequences.iter().zip(&mut prevented) {
                    sequence.prevent(false_belief, signal.time, prevented);
                }
            }
            count.harmless += u64::from(!is_harmful);
        }
        count.prevented = prevented.iter().flatten().filter(|prevented| **prevented).count() as u64;
        count.false_presses = is_false.iter().filter(|is_false| **is_false).count() as u64;
        count
    }

    /// Counts of a concept that proposes `k` presses after every error that no proposal prevents.
    pub fn count_proposals(&self, k: usize) -> PreventionCounts {
        let mut count = self.empty_count(0);
        let mut spared = 0;
        for press in &self.presses {
            if spared > 0 {
                spared -= 1;
                count.prevented += u64::from(press.related);
                count.false_presses += u64::from(!self.is_in_episode(press.time));
            } else if press.error {
                spared = k;
                count.signals += k as u64;
            }
        }
        count
    }
}

impl SequenceTruth {
    /// Marks the errors that a signal about a false belief's aspect prevents: errors after the signal, if their sequence is about
    /// the aspect and the false belief lasts into the sequence.
    fn prevent(&self, false_belief: &FalseBeliefTruth, sent: SessionTime, prevented: &mut [bool]) {
        let (Some(&first), Some(&last)) = (self.errors.first(), self.errors.last()) else { return };
        let lasts = false_belief.began <= last && false_belief.ended.is_none_or(|end| end > first);
        if !lasts || !self.aspects.contains(&false_belief.aspect) {
            return;
        }
        for (&error, prevented) in self.errors.iter().zip(prevented) {
            *prevented |= error > sent;
        }
    }
}
