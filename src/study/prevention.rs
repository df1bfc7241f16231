//! What signals and proposals would have prevented in an unassisted trial.
//!
//! One signal that targets the aspect of a false belief episode prevents the rest of its sequence; what is replayed does not
//! change the belief. A signal on an aspect that was believed right is a false positive, one on a wrong but harmless belief is
//! counted by itself. A proposal of k presses counts as k signals and spares the errors of the next k presses; those of them
//! outside of episodes are its false positives.

use serde::Serialize;

use crate::base::time::SessionTime;
use crate::kitchen::AspectId;

/// What was true in a trial.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TrialTruth {
    pub presses: Vec<PressTruth>,
    pub spells: Vec<FalseBeliefTruth>,
    pub sequences: Vec<SequenceTruth>,
}

/// A press of the human.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PressTruth {
    pub time: SessionTime,
    pub error: bool,
    /// It was one because of a false belief.
    pub related: bool,
}

/// A time in which an aspect was believed wrong.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FalseBeliefTruth {
    pub aspect: AspectId,
    pub began: SessionTime,
    pub ended: Option<SessionTime>,
    /// It led to an error: an episode.
    pub harmful: bool,
}

/// Belief related errors that belong together.
#[derive(Clone, Debug, PartialEq)]
pub struct SequenceTruth {
    /// What it is about.
    pub aspects: Vec<AspectId>,
    /// When its errors were.
    pub errors: Vec<SessionTime>,
}

/// A signal that a concept would have sent.
#[derive(Clone, Debug, PartialEq)]
pub struct ConceptSignal {
    pub time: SessionTime,
    /// Presses of the human before it.
    pub press: usize,
    /// What it tells.
    pub aspects: Vec<AspectId>,
}

/// What a concept would have done in a trial, or in several.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct PreventionCounts {
    /// Presses of the human.
    pub presses: u64,
    /// Signals, or presses proposed.
    pub signals: u64,
    /// Belief related errors.
    pub related: u64,
    /// Of those, prevented.
    pub prevented: u64,
    /// Presses of the human outside of episodes.
    pub outside: u64,
    /// Of those, with a false signal before them.
    pub false_presses: u64,
    /// Signals on an aspect that was believed right while another one had an episode.
    pub false_inside: u64,
    /// Signals on a wrong but harmless belief.
    pub harmless: u64,
}

impl PreventionCounts {
    /// The same of both together.
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

    /// False positive rate, true positive rate, signals per 100 presses of the human; none without what they are rates of.
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
        self.spells.iter().filter(move |spell| spell.began <= time && spell.ended.is_none_or(|end| time < end))
    }

    fn is_in_episode(&self, time: SessionTime) -> bool {
        self.open_at(time).any(|spell| spell.harmful)
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

    /// What these signals would have done.
    pub fn count_signals(&self, sent: &[ConceptSignal]) -> PreventionCounts {
        let mut count = self.empty_count(sent.len() as u64);
        let mut prevented: Vec<Vec<bool>> =
            self.sequences.iter().map(|sequence| vec![false; sequence.errors.len()]).collect();
        let mut is_false = vec![false; self.presses.len()];
        for signal in sent {
            let mut wrong = self.open_at(signal.time).filter(|spell| signal.aspects.contains(&spell.aspect)).peekable();
            if wrong.peek().is_none() {
                match self.presses.get(signal.press) {
                    Some(press) if self.is_in_episode(press.time) => count.false_inside += 1,
                    Some(_) => is_false[signal.press] = true,
                    // Nothing comes after it.
                    None => {}
                }
                continue;
            }
            let mut is_harmful = false;
            for spell in wrong.filter(|spell| spell.harmful) {
                is_harmful = true;
                for (sequence, prevented) in self.sequences.iter().zip(&mut prevented) {
                    sequence.prevent(spell, signal.time, prevented);
                }
            }
            count.harmless += u64::from(!is_harmful);
        }
        count.prevented = prevented.iter().flatten().filter(|prevented| **prevented).count() as u64;
        count.false_presses = is_false.iter().filter(|is_false| **is_false).count() as u64;
        count
    }

    /// What proposals of `k` presses after every error that is not itself spared would have done.
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
    /// Marks the errors that a signal about this spell's aspect prevents: those after it, if the sequence is about the aspect
    /// and the spell lasts into it.
    fn prevent(&self, spell: &FalseBeliefTruth, sent: SessionTime, prevented: &mut [bool]) {
        let (Some(&first), Some(&last)) = (self.errors.first(), self.errors.last()) else { return };
        let lasts = spell.began <= last && spell.ended.is_none_or(|end| end > first);
        if !lasts || !self.aspects.contains(&spell.aspect) {
            return;
        }
        for (&error, prevented) in self.errors.iter().zip(prevented) {
            *prevented |= error > sent;
        }
    }
}
