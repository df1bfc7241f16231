//! Judges the signals of a running trial as they are sent, for the summary at the trial's end: was the belief that a
//! signal corrects false?
//!
//! The measures of a study look at the whole trial and leave out false beliefs that led to no error
//! ([`tomcom_core::measures::wizard_performance`]); this module judges a signal by the beliefs at the time the signal was
//! sent.

use crate::event::SignalEndReason;
use crate::{Event, Session, TimestampedEvent};
use tomcom_core::communication::recommendation::aspects_told;
use tomcom_core::communication::{Sender, Signal};
use tomcom_core::kitchen::{Agent, AspectId};
use tomcom_core::measures::wizard_performance::LATE_PRESSES;

/// Counts of a sender's signals by the judgement of the signals.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SignalJudgementCounts {
    /// Number of signals about a false belief of the participant.
    pub hits: u64,
    /// Number of signals about a belief that became right at most [`LATE_PRESSES`] presses of the human before.
    pub late: u64,
    /// Number of signals about a belief that was right already.
    pub needless: u64,
    /// Number of signals that the sender took back; these signals also count among hits, late and needless ones.
    pub taken_back: u64,
}

impl SignalJudgementCounts {
    /// Number of signals that the sender sent.
    pub fn sent(&self) -> u64 {
        self.hits + self.late + self.needless
    }
}

/// Whether the participant's belief about one state aspect is false, and when it became right.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Standing {
    is_false: bool,
    /// Number of the human's presses at the time the belief became right; `None` if the belief was not corrected.
    corrected: Option<u32>,
}

/// Judges each signal by the participant's beliefs at the time it is sent.
#[derive(Clone, Debug, Default)]
pub struct SignalJudge {
    beliefs: Vec<Standing>,
    wizard: SignalJudgementCounts,
    assistant: SignalJudgementCounts,
    /// Who sent the last signal, the wizard or the assistant; `None` before the first signal of the trial, and after
    /// the last signal was taken back.
    last: Option<Sender>,
}

impl SignalJudge {
    /// Judges the signal in an event that has been applied to the session, by the beliefs noted before the event.
    pub fn judge(&mut self, stamped: &TimestampedEvent, session: &Session) {
        match &stamped.event {
            Event::TrialStarted => *self = SignalJudge::default(),
            // A proposal of presses is not about beliefs, so it is not judged.
            Event::SignalShown { by, signal: Signal::Propose(_), .. } => self.last = Some(*by),
            Event::SignalShown { by, signal, .. } => {
                let told = aspects_told(&session.kitchen, session.state, signal);
                let presses = session.presses[Agent::Human.index()];
                self.last = Some(*by);
                let beliefs = || told.iter().filter_map(|aspect| self.beliefs.get(aspect.index()));
                let is_late = |belief: &Standing| belief.corrected.is_some_and(|at| presses <= at + LATE_PRESSES);
                let (is_hit, is_late) = (beliefs().any(|belief| belief.is_false), beliefs().any(is_late));
                let tally = self.tally_mut(*by);
                match () {
                    () if is_hit => tally.hits += 1,
                    () if is_late => tally.late += 1,
                    () => tally.needless += 1,
                }
            }
            Event::SignalEnded { reason: SignalEndReason::TakenBack } => {
                if let Some(by) = self.last.take() {
                    self.tally_mut(by).taken_back += 1;
                }
            }
            _ => {}
        }
    }

    /// Stores which of the participant's beliefs are false now.
    pub fn note(&mut self, session: &Session, is_false: impl Fn(AspectId) -> bool) {
        let presses = session.presses[Agent::Human.index()];
        self.beliefs.resize(session.kitchen.aspects.len(), Standing::default());
        for (index, belief) in self.beliefs.iter_mut().enumerate() {
            let now = is_false(AspectId(index as u8));
            if belief.is_false && !now {
                belief.corrected = Some(presses);
            }
            belief.is_false = now;
        }
    }

    /// Counts of the judged signals of a sender so far.
    pub fn tally(&self, by: Sender) -> SignalJudgementCounts {
        match by {
            Sender::Wizard => self.wizard,
            Sender::Assistant => self.assistant,
        }
    }

    fn tally_mut(&mut self, by: Sender) -> &mut SignalJudgementCounts {
        match by {
            Sender::Wizard => &mut self.wizard,
            Sender::Assistant => &mut self.assistant,
        }
    }
}
